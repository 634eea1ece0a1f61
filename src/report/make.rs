//! Sums, audits and tally -> Report: fills in the carriers.
//!
//! What one part of the program knows alone is made in a file of its own: `cooling`, `motion`,
//! `reshaped` (arcs and short lines), `tally` (what layers add up to).
//!
//! - Sums come from the writer: lengths, filament, times.
//! - Audits come from dual injection, one for each part that is printed thick.
//! - Lengths are in mm, times in s, layers counted from 1, those of a raft among them.

use super::cooling::cooling;
use super::motion::{self, motion};
use super::tally::Tally;
use super::{
    ApartReport, BlockReport, DualReport, FilamentReport, FlowReport, LayerTimeReport,
    LayersReport, ProfileReport, Report, RoleReport, SCHEMA, SlowedFlowReport, TimeReport,
    TravelReport,
};
use super::{doubtful, reshaped, unused};
use crate::fill::adhesion::lift::Lift;
use crate::fill::{Both, Role};
use crate::gcode::Sums;
use crate::gcode::flow::{Flows, Lowered, speed};
use crate::gcode::times::{LayerTime, Times};
use crate::gcode::usage::Material;
use crate::job::{self, Job};
use crate::mesh::MeshReport;
use crate::mesh::place::Placed;
use crate::profile::{DualMode, DualPart, Settings, Sources};
use crate::region::dual::audit::{Apart, Audit};
use crate::slice::Heights;
use crate::units::{sum_mm, to_mm, to_units};
use crate::warning::Warning;

/// The report of a run that extruded something.
#[must_use]
pub fn report(
    job: &Job,
    placed: &Placed,
    heights: &Heights,
    sums: &Sums,
    audits: &[Audit],
    tally: &Tally,
) -> Report {
    let (settings, lift) = (&job.settings, Lift::new(&job.settings));
    let Sums { usage, times, cooled } = sums;
    let Material { mm, cm3, grams, cost } = Material::new(usage.filament(), settings);
    Report {
        schema: SCHEMA,
        slicer: job::NAME.to_owned(),
        profile: job.sources.printer.clone(),
        is_profile_chosen: job.sources.is_printer_chosen,
        profiles: profiles(&job.sources),
        models: models(placed, &lift),
        size_mm: placed.size_mm,
        solid_mm3: tally.solid_mm3(),
        layers: LayersReport {
            count: heights.count() + lift.layers(),
            first_height_mm: to_mm(lift.heights.first().map_or(heights.height(0), |base| *base)),
            height_mm: to_mm(to_units(settings.layer_height)),
            top_mm: to_mm(heights.top(heights.count() - 1) + lift.by()),
        },
        roles: roles(sums, settings),
        travel: TravelReport {
            count: usage.travels,
            length_mm: usage.travel_length,
            retractions: usage.retractions,
            time_s: times.travel,
            retraction_time_s: times.retraction,
        },
        filament: FilamentReport { length_mm: mm, volume_cm3: cm3, weight_g: grams, cost },
        time: time(times),
        flow: FlowReport {
            largest_mm3_s: usage.flows.largest,
            limit_mm3_s: settings.max_volumetric_speed(),
            slowed: slowed_where_wide(&usage.flows, settings),
        },
        cooling: cooled.as_ref().and_then(|cooled| cooling(cooled, times, settings)),
        motion: motion(usage, settings),
        arcs: reshaped::arcs(usage, settings),
        segments: reshaped::segments(usage, settings),
        dual: (settings.dual.mode != DualMode::Off).then(|| dual(settings, audits, lift.layers())),
        warnings: (doubtful::no_printer(settings, &job.sources).into_iter())
            .chain(placed.warnings.iter().cloned())
            .chain(tally.warnings(job.placement.copies))
            .chain(doubtful::warnings(settings))
            .chain(doubtful::cold_bed(settings, &job.sources))
            .chain(doubtful::outdone(&job.sources))
            .chain(motion::warnings(settings))
            .chain(unused::warnings(usage, settings))
            .chain(slowed_down(&usage.flows, settings))
            .chain(reshaped::warnings(sums, settings))
            .collect(),
        ..Report::default()
    }
}

/// The models. A raft lifts them.
fn models(placed: &Placed, lift: &Lift) -> Vec<MeshReport> {
    let mut models = placed.reports.clone();
    for body in models.iter_mut().flat_map(|model| &mut model.bodies) {
        body.min_mm[2] += to_mm(lift.by());
        body.max_mm[2] += to_mm(lift.by());
    }
    models
}

fn profiles(sources: &Sources) -> Vec<ProfileReport> {
    let mut list: Vec<ProfileReport> = Vec::new();
    for source in &sources.list {
        let kind = source.kind.map(|kind| kind.name());
        let one = ProfileReport { name: source.name.clone(), kind, file: source.file.clone() };
        if !list.contains(&one) {
            list.push(one);
        }
    }
    list
}

fn roles(sums: &Sums, settings: &Settings) -> Vec<RoleReport> {
    let area = settings.filament_area();
    let mut roles = Vec::new();
    for (role, used) in sums.usage.roles.iter() {
        for (thick, used) in used.iter().filter(|(thick, _)| !thick || role.facts().may_be_thick) {
            roles.push(RoleReport {
                role: role_name(role, thick),
                length_mm: used.length,
                filament_mm: used.filament,
                volume_mm3: used.filament * area,
                time_s: *sums.times.roles[role].of(thick),
            });
        }
    }
    roles
}

fn role_name(role: Role, thick: bool) -> String {
    let name = role.facts().name;
    if thick { format!("thick {name}") } else { name.to_owned() }
}

fn time(times: &Times) -> TimeReport {
    let seconds = || times.layers.iter().map(|layer| layer.seconds);
    let count = times.layers.len().max(1) as f64;
    let mean = times.total() / count;
    let variance = seconds().map(|s| (s - mean) * (s - mean)).sum::<f64>() / count;
    let layer = |layer: &LayerTime| LayerTimeReport { z_mm: to_mm(layer.z), time_s: layer.seconds };
    TimeReport {
        total_s: times.total(),
        longest_layer_s: seconds().fold(0.0, f64::max),
        shortest_layer_s: seconds().reduce(f64::min).unwrap_or_default(),
        layer_spread: if mean > 0.0 { variance.sqrt() / mean } else { 0.0 },
        layers: times.layers.iter().map(layer).collect(),
    }
}

/// What was slowed down since the hot end cannot melt as fast: role, thick or not, and speeds. Where a material
/// asks for less than that, it is what it says that it needs.
fn lowered(flows: &Flows, settings: &Settings) -> Vec<(Role, bool, Lowered)> {
    if settings.max_volumetric_speed() < settings.machine.max_volumetric_speed {
        return Vec::new();
    }
    let of = |(role, lowered): (Role, &Both<Option<Lowered>>)| {
        let both: Vec<_> = lowered.iter().map(|(thick, one)| (role, thick, *one)).collect();
        both
    };
    let all = flows.lowered.iter().flat_map(of);
    all.filter_map(|(role, thick, one)| Some((role, thick, one?))).collect()
}

/// Whether a usual line of this role melts at this speed, mm/s: then only wider ones are slowed down, which
/// nobody asked to be wide. What is no line of the usual size has none.
fn usual_melts(role: Role, thick: bool, asked: f64, settings: &Settings) -> bool {
    if matches!(role, Role::Bridge | Role::RaftBase | Role::RaftInterface) {
        return false;
    }
    let layers = if thick { f64::from(settings.dual_ratio().max(2)) } else { 1.0 };
    let section = settings.line_width * layers * settings.layer_height;
    let flow = asked * section * settings.extrusion.multiplier;
    flow <= settings.max_volumetric_speed()
}

/// Lines that are slower although they are of the usual size.
fn slowed_down(flows: &Flows, settings: &Settings) -> Vec<Warning> {
    let all = lowered(flows, settings).into_iter();
    let of_usual =
        all.filter(|(role, thick, one)| !usual_melts(*role, *thick, speed(one.asked), settings));
    let warning = |(role, thick, one): (Role, bool, Lowered)| Warning::FlowLimited {
        role: role_name(role, thick),
        setting: (*(role.facts().speed_keys)(&settings.speed).of(thick)).to_owned(),
        asked_mm_s: speed(one.asked),
        lowest_mm_s: speed(one.given),
        limit_mm3_s: settings.max_volumetric_speed(),
    };
    of_usual.map(warning).collect()
}

/// Lines that are slower since they are wider than usual.
fn slowed_where_wide(flows: &Flows, settings: &Settings) -> Vec<SlowedFlowReport> {
    let all = lowered(flows, settings).into_iter();
    let wide =
        all.filter(|(role, thick, one)| usual_melts(*role, *thick, speed(one.asked), settings));
    let row = |(role, thick, one): (Role, bool, Lowered)| SlowedFlowReport {
        role: role_name(role, thick),
        asked_mm_s: speed(one.asked),
        lowest_mm_s: speed(one.given),
    };
    wide.map(row).collect()
}

/// `below` layers of a raft come before those of the audits.
fn dual(settings: &Settings, audits: &[Audit], below: usize) -> DualReport {
    let filled = || audits.iter().filter(|a| a.plain > 0);
    let infill = || filled().filter(|a| a.part == DualPart::Infill);
    let sum = |of: fn(&Audit) -> i64| filled().map(of).sum::<i64>();
    DualReport {
        ratio: settings.dual_ratio(),
        blocks: infill().count(),
        thick_blocks: infill().filter(|a| a.thick > 0).count(),
        thick_length_mm: sum_mm(sum(|a| a.thick)),
        thin_length_mm: sum_mm(sum(|a| a.thin)),
        volume_ratio: ratio(sum(|a| a.material), sum(|a| a.plain)),
        audit: filled().map(|audit| block(audit, below)).collect(),
    }
}

fn block(audit: &Audit, below: usize) -> BlockReport {
    let Apart { bounds, skin, short, ends } = audit.kept_apart;
    BlockReport {
        part: audit.part,
        first_layer: audit.first + 1 + below,
        layers: audit.layers,
        thick_length_mm: sum_mm(audit.thick),
        thin_length_mm: sum_mm(audit.thin),
        volume_ratio: ratio(audit.material, audit.plain),
        kept_apart: ApartReport {
            bounds_mm: sum_mm(bounds),
            skin_mm: sum_mm(skin),
            short_mm: sum_mm(short),
            ends_mm: sum_mm(ends),
        },
    }
}

/// `part` over `whole`; 1 if both are nothing.
fn ratio(part: i64, whole: i64) -> f64 {
    if whole == 0 { 1.0 } else { part as f64 / whole as f64 }
}
