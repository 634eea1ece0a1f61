//! Report -> lines for people: the summary, and more with -v.
//!
//! 1. For which printer, material and print, and which files had a say.
//! 2. The layers and the size of the layout.
//! 3. The filament, and how it is shared out among roles.
//! 4. How long it prints, and what dual injection did.
//! 5. Which layers are printed slower to take their least time, if any are.
//! 6. How much of the tops has skins that follow the surface, if that was asked for.
//! 7. How fast motors have to step, if the profile says how far a step goes.
//!
//! Notes, such as of what was mended or of a brim that nobody asked for, stand before it.

use slicer::mesh::{MeshReport, faults};
use slicer::profile::{Profile, dump};
use slicer::report::nonplanar::{FlatReport, NonPlanarReport};
use slicer::report::steps::{MotorReport, StepsReport};
use slicer::report::{
    BrimReport, CoolingReport, DriveReport, FlowReport, MotionReport, Report, SlowedFlowReport,
};
use slicer::warning::plural;
use std::time::Duration;

/// Layers that end nearer to the models' height end there, mm.
const LEAST_REST: f64 = 0.05;

/// For which printer, material and print, and every file that had a say in it.
fn chosen(report: &Report) -> String {
    let of = |kind: &str| {
        let last = report.profiles.iter().rev().find(|one| one.kind == Some(kind))?;
        // A warning says what to do.
        let open = kind == "printer" && !report.is_profile_chosen;
        Some(format!("{kind} {}{}", last.name, if open { " (not chosen)" } else { "" }))
    };
    let parts: Vec<String> = ["printer", "material", "print"].into_iter().filter_map(of).collect();
    let mut text = parts.join(", ");
    let files: Vec<&str> = report.profiles.iter().filter_map(|one| one.file.as_deref()).collect();
    if !files.is_empty() {
        text += &format!("; with {}", files.join(", "));
    }
    text
}

/// What was made, in four lines. The first names the models that it is `about`: a log has those of many runs.
pub(crate) fn summary(about: &str, report: &Report, took: Duration) -> String {
    let [x, y, z] = report.size_mm;
    let layers = &report.layers;
    let filament = &report.filament;
    let raft = report.raft.as_ref().map_or_else(String::new, |raft| {
        format!("; {} of them a raft of {:.2} mm", raft.layers, raft.height_mm)
    });
    let dual = report.dual.as_ref().map_or_else(String::new, |dual| {
        format!("; {} of {} groups of layers with thick infill", dual.thick_blocks, dual.blocks)
    });
    let ends = ends(report);
    format!(
        "{about}: {}\n\
         {} of {} mm, {x:.1} x {y:.1} x {z:.1} mm{ends}{raft}\n\
         filament {:.0} mm, {:.2} cm³, {:.1} g{}\n\
         prints in {}, sliced in {:.2} s{dual}\n{}",
        chosen(report),
        plural(layers.count as u64, "layer"),
        layers.height_mm,
        filament.length_mm,
        filament.volume_cm3,
        filament.weight_g,
        shares(report),
        duration(report.time.total_s),
        took.as_secs_f64(),
        report.cooling.as_ref().map_or_else(String::new, slower),
    ) + &report.nonplanar.as_ref().map_or_else(String::new, nonplanar)
        + &report.steps.as_ref().map_or_else(String::new, motors)
}

/// The highest rate of each motor, and its share of what the motor can make.
fn motors(steps: &StepsReport) -> String {
    let motor = |(axis, motor): (char, MotorReport)| {
        format!("{axis} {:.0} ({:.0} %)", motor.highest_rate_per_s, 100.0 * motor.share)
    };
    let all: Vec<String> = steps.motors().into_iter().map(motor).collect();
    format!("steps/s at most, and of what the motor can: {}\n", all.join(", "))
}

/// How high the nozzle gets, where that is not the models' height: layers are whole.
fn ends(report: &Report) -> String {
    let raft = report.raft.as_ref().map_or(0.0, |raft| raft.height_mm + raft.gap_mm);
    let top = report.layers.top_mm - raft;
    let differs = report.nonplanar.is_none() && (top - report.size_mm[2]).abs() >= LEAST_REST;
    if differs { format!("; the last layer ends at {top:.2} mm") } else { String::new() }
}

/// How much of the tops follows the surface, and why the rest does not.
fn nonplanar(report: &NonPlanarReport) -> String {
    let areas = &report.areas;
    let mut flat: Vec<&FlatReport> = areas.flat.iter().filter(|flat| flat.mm2 >= 0.5).collect();
    flat.sort_by(|a, b| b.mm2.total_cmp(&a.mm2));
    let reason =
        |flat: &&FlatReport| format!("{} {:.0} ({})", flat.reason, flat.mm2, why(flat.reason));
    let reasons: Vec<String> = flat.iter().map(reason).collect();
    let reasons =
        if reasons.is_empty() { String::new() } else { format!(": {}", reasons.join(", ")) };
    let contour = if areas.contour_mm2 < 0.5 {
        String::new()
    } else {
        format!(", {:.0} rise and fall within their layer", areas.contour_mm2)
    };
    let sloped = areas.top_mm2 - areas.level_mm2;
    // Nobody measured that head: it is hardly why somebody wants level tops.
    let is_unknown = report.head == Some("cautious") && sloped - areas.skin_mm2 >= 0.5;
    let head = if is_unknown { UNKNOWN_HEAD } else { "" };
    format!(
        "non-planar skin on {:.0} of {sloped:.0} mm² of sloped tops{contour}, {:.0} flat{reasons}\n{head}",
        areas.skin_mm2, areas.flat_mm2,
    )
}

/// What is said where a head counts that may be any.
const UNKNOWN_HEAD: &str = "the head is `cautious`, which takes little, since nobody said what hangs there: \
    measure yours for [head], or name one with --head\n";

/// A reason for level tops, in words.
fn why(reason: &str) -> &str {
    match reason {
        "slope" => "too steep for the head",
        "press" => "the nozzle would press too deep",
        "cone" => "the head would touch the surface",
        "obstacle" => "the head would touch the rest of the part",
        "neighbour" => "the head would touch another part, support or skirt",
        "overhang" => "too little under it, or too much",
        "support" => "support would stand on it",
        "z-limit" => "no room above",
        "area" => "too small",
        "thin" => "too narrow",
        other => other,
    }
}

/// Which layers are slower than asked for, if any is.
fn slower(cooling: &CoolingReport) -> String {
    if cooling.slowed_layers + cooling.waits + cooling.quick_layers == 0 {
        return String::new();
    }
    let mut line = format!(
        "{} printed slower, down to {:.0} % of their speed, to take {} s each",
        plural(cooling.slowed_layers as u64, "layer"),
        100.0 * cooling.lowest_factor,
        cooling.min_layer_time_s
    );
    if cooling.waits > 0 {
        line += &format!("; waits after {} of them, {}", cooling.waits, duration(cooling.waited_s));
    }
    if cooling.quick_layers > 0 {
        line += &format!("; {} still take less, at cooling.min_speed", cooling.quick_layers);
    }
    line + "\n"
}

/// A time for people, such as `1 h 23 min`.
fn duration(seconds: f64) -> String {
    let minutes = (seconds / 60.0).round() as u64;
    match (minutes / 60, minutes % 60) {
        (0, 0 | 1) if seconds < 59.5 => format!("{seconds:.0} s"),
        (0, minutes) => format!("{minutes} min"),
        (hours, minutes) => format!("{hours} h {minutes} min"),
    }
}

/// Mendings that leave no doubt, one line a model; then a brim that nobody asked for.
pub(crate) fn notes(about: &str, report: &Report) -> String {
    let note = |model: &MeshReport| {
        let what = faults::tidied(&model.mended)?;
        Some(format!("note: {}: mended: {what}\n", model.file))
    };
    let mended: String = report.models.iter().filter_map(note).collect();
    let of_all = report.brim.as_ref().map(brim).into_iter().chain(slowed(&report.flow));
    let of_all: String = of_all.map(|what| format!("note: {about}: {what}\n")).collect();
    mended + &of_all
}

/// That lines are slower where they are wider than usual, if any are.
fn slowed(flow: &FlowReport) -> Option<String> {
    let share = |one: &SlowedFlowReport| one.lowest_mm_s / one.asked_mm_s;
    let least = flow.slowed.iter().map(share).reduce(f64::min)?;
    let roles: Vec<&str> = flow.slowed.iter().map(|one| one.role.as_str()).collect();
    Some(format!(
        "wide places of {} are printed slower, down to {:.0} % of their speed: the hot end melts no more than \
         {} mm³/s",
        roles.join(", "),
        100.0 * least,
        flow.limit_mm3_s
    ))
}

/// Where a brim was printed, and why.
fn brim(brim: &BrimReport) -> String {
    let BrimReport { width_mm, islands, of, why } = brim;
    let places =
        if of == islands { String::new() } else { format!(" around {islands} of {of} islands") };
    format!("a brim of {width_mm} mm{places}, for {} (--brim 0 leaves it out)", why.join(", "))
}

/// How the filament is shared out, such as ` (outer wall 30 %, skin 70 %)`.
fn shares(report: &Report) -> String {
    let total: f64 = report.roles.iter().map(|role| role.filament_mm).sum();
    if total <= 0.0 {
        return String::new();
    }
    let used = report.roles.iter().filter(|role| role.filament_mm > 0.0);
    let parts: Vec<_> = used
        .map(|role| format!("{} {:.0} %", role.role, 100.0 * role.filament_mm / total))
        .collect();
    format!(" ({})", parts.join(", "))
}

/// Lengths and filament by role, and the travels.
pub(crate) fn roles(report: &Report) -> String {
    let mut lines: Vec<_> = report
        .roles
        .iter()
        .map(|role| {
            format!(
                "{:<16} {:>12.0} mm of path {:>10.1} mm of filament {:>10.1} s",
                role.role, role.length_mm, role.filament_mm, role.time_s
            )
        })
        .collect();
    let travel = &report.travel;
    lines.push(format!(
        "{:<16} {:>12.0} mm of path in {} moves, {} with retraction, {:.1} s",
        "travel",
        travel.length_mm,
        travel.count,
        travel.retractions,
        travel.time_s + travel.retraction_time_s
    ));
    let (time, flow) = (&report.time, &report.flow);
    lines.push(format!(
        "layers take {:.1} to {:.1} s, with a spread of {:.2}; the largest flow is {:.1} mm³/s",
        time.shortest_layer_s, time.longest_layer_s, time.layer_spread, flow.largest_mm3_s
    ));
    lines.extend(report.motion.as_ref().map(driven).unwrap_or_default());
    if let Some(arcs) = &report.arcs {
        lines.push(format!("{} arcs stand for {} lines", arcs.count, arcs.lines));
    }
    if let Some(short) = &report.segments {
        lines.push(format!(
            "for {} moves/s at most, {} short lines were joined and {} slowed down, by {:.1} s in all",
            short.max_rate_per_s, short.joined, short.slowed, short.lost_s
        ));
    }
    lines.join("\n") + "\n"
}

/// The accelerations, jerks and pressure advance that the file sets, a line each.
fn driven(motion: &MotionReport) -> Vec<String> {
    let line = |what: &str, unit: &str, value: fn(&DriveReport) -> Option<f64>| {
        let rows = motion.drives.iter();
        let parts = rows.filter_map(|row| Some(format!("{} {}", row.of, value(row)?)));
        let parts: Vec<_> = parts.collect();
        (!parts.is_empty()).then(|| format!("{what}: {} {unit}", parts.join(", ")))
    };
    let acceleration = line("accelerations", "mm/s²", |row| row.acceleration_mm_s2);
    let jerk = line("jerk", "mm/s", |row| row.jerk_mm_s);
    let advance = motion.pressure_advance_s.map(|s| format!("pressure advance: {s} s"));
    [acceleration, jerk, advance].into_iter().flatten().collect()
}

/// All settings with their origins, one a line.
pub(crate) fn settings(profile: &Profile) -> String {
    let line = |(key, value): (String, String)| {
        let origin = profile.origins.get(&key);
        let origin = origin.map_or_else(String::new, |origin| format!("  ({origin})"));
        format!("{key} = {value}{origin}\n")
    };
    dump(&profile.settings).into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use slicer::report::{
        DualReport, FilamentReport, LayersReport, ProfileReport, RoleReport, TimeReport,
        nonplanar::TopAreas,
    };

    #[test]
    fn the_summary_has_four_lines() {
        let role = |role: &str, filament_mm| RoleReport {
            role: role.to_owned(),
            filament_mm,
            ..RoleReport::default()
        };
        let profile = |name: &str, kind, file: Option<&str>| ProfileReport {
            name: name.to_owned(),
            kind,
            file: file.map(str::to_owned),
        };
        let profiles = vec![
            profile("standard", Some("print"), None),
            profile("petg", Some("material"), None),
            profile("ender-3", Some("printer"), None),
            profile("mine.toml", None, Some("a/mine.toml")),
        ];
        let report = Report {
            profiles,
            size_mm: [40.0, 30.0, 20.0],
            layers: LayersReport {
                count: 100,
                height_mm: 0.2,
                top_mm: 19.9,
                ..LayersReport::default()
            },
            roles: vec![role("outer wall", 30.0), role("skin", 0.0), role("thick infill", 90.0)],
            filament: FilamentReport {
                length_mm: 120.0,
                volume_cm3: 0.289,
                weight_g: 0.36,
                cost: None,
            },
            time: TimeReport { total_s: 4_990.0, ..TimeReport::default() },
            dual: Some(DualReport { blocks: 47, thick_blocks: 46, ..DualReport::default() }),
            ..Report::default()
        };
        assert_eq!(
            summary("a.stl", &report, Duration::from_millis(1230)),
            "a.stl: printer ender-3 (not chosen), material petg, print standard; with a/mine.toml\n\
             100 layers of 0.2 mm, 40.0 x 30.0 x 20.0 mm; the last layer ends at 19.90 mm\n\
             filament 120 mm, 0.29 cm³, 0.4 g (outer wall 25 %, thick infill 75 %)\n\
             prints in 1 h 23 min, sliced in 1.23 s; 46 of 47 groups of layers with thick infill\n"
        );
    }

    #[test]
    fn level_tops_are_told_with_their_reasons_and_a_head_that_nobody_named() {
        let flat = |reason, mm2| FlatReport { reason, mm2 };
        let areas = TopAreas {
            top_mm2: 110.0,
            skin_mm2: 60.0,
            contour_mm2: 10.0,
            level_mm2: 10.0,
            flat_mm2: 30.0,
            flat: vec![flat("area", 0.4), flat("press", 10.0), flat("slope", 19.6)],
        };
        let mut report = NonPlanarReport { head: Some("v6"), areas, patches: Vec::new() };
        let line = "non-planar skin on 60 of 100 mm² of sloped tops, 10 rise and fall within their \
                    layer, 30 flat: slope 20 (too steep for the head), press 10 (the nozzle would \
                    press too deep)\n";
        assert_eq!(nonplanar(&report), line);
        report.head = Some("cautious");
        assert_eq!(nonplanar(&report), format!("{line}{UNKNOWN_HEAD}"));
        report.areas.skin_mm2 = 100.0;
        assert!(!nonplanar(&report).contains("cautious"));
    }

    #[test]
    fn times_are_in_hours_and_minutes() {
        let cases =
            [(12.4, "12 s"), (59.6, "1 min"), (3_590.0, "1 h 0 min"), (90_000.0, "25 h 0 min")];
        for (seconds, words) in cases {
            assert_eq!(duration(seconds), words);
        }
    }
}
