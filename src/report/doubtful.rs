//! Settings -> findings: values that are allowed and hardly meant, or more than printer and material bear.
//!
//! - *Doubtful* is a value that is allowed, and that prints something else than people mean, or nothing good: it
//!   gives a warning and fails no run but one with `--strict`.
//! - What the settings alone tell is in [`warnings`]: speeds, temperatures and flow beyond what printer or
//!   material bear, and an end block that moves aside before it lifts the nozzle.
//! - What only the profiles tell, by which the settings came about, each has a function of its own: a printer that
//!   nobody chose, a bed that stays cold, a number of skin layers that a thickness outdoes.

use crate::profile::{Settings, Sources};
use crate::warning::Warning;

/// Multipliers of the flow that are used to calibrate an extruder; others are hardly meant.
const FLOWS: [f64; 2] = [0.7, 1.4];

/// No nozzle is hotter, °C.
const MOST_CELSIUS: f64 = 500.0;

/// A material that asks for a bed at least so hot comes loose from a cold one, °C: ABS, ASA, nylon, PC. PLA, TPU
/// and, with care, PETG hold on.
const HOT_BED: u32 = 90;

/// A material that the printer's bed is too cold for.
pub fn cold_bed(settings: &Settings, sources: &Sources) -> Option<Warning> {
    let asked_celsius = sources.left_cold.filter(|asked| *asked >= HOT_BED)?;
    let (material, machine) = (settings.filament.name.clone(), settings.machine.name.clone());
    Some(Warning::ColdBed { material, asked_celsius, machine })
}

/// Numbers of skin layers in a profile of one's own that a thickness outdoes.
pub fn outdone(sources: &Sources) -> impl Iterator<Item = Warning> {
    sources.outdone.iter().map(|one| {
        let why = format!(
            "{} = {} mm asks for more, {} layers; set {} = 0 beside it",
            one.by, one.thickness_mm, one.layers, one.by
        );
        Warning::void([one.key], &why)
    })
}

/// A printer that nobody chose: the file may be for another than the one that gets it.
pub fn no_printer(settings: &Settings, sources: &Sources) -> Option<Warning> {
    // A program that embeds the library may have settings without profiles.
    let is_open = !sources.is_printer_chosen && !sources.list.is_empty();
    is_open.then(|| Warning::NoPrinter { machine: settings.machine.name.clone() })
}

/// An end block that moves aside before it lifts the nozzle.
fn drags(settings: &Settings) -> Option<Warning> {
    let lines = settings.machine.end_gcode.lines().enumerate();
    for (index, line) in lines {
        let written = line.split(';').next().unwrap_or_default().trim();
        let code = written.to_ascii_uppercase();
        let mut words = code.split_whitespace();
        match words.next() {
            Some("G0" | "G1") => {}
            // They lift it before they park.
            Some("G27" | "M125" | "M600") => return None,
            // What is not numbered may be a macro, which lifts it.
            Some(word) if word.chars().nth(1).is_none_or(|second| !second.is_ascii_digit()) => {
                return None;
            }
            _ => continue,
        }
        let has = |axes: &[char]| code.split_whitespace().skip(1).any(|w| w.starts_with(axes));
        if has(&['Z']) {
            return None;
        }
        if has(&['X', 'Y']) {
            return Some(Warning::EndDrags { line: index + 1, command: written.to_owned() });
        }
    }
    None
}

/// Speeds, flow and temperatures to think about again.
#[must_use]
pub fn warnings(settings: &Settings) -> Vec<Warning> {
    let mut found: Vec<Warning> = slow(settings).collect();
    found.extend(fast(settings));
    found.extend(heat(settings));
    found.extend(drags(settings));
    let flow = ("extrusion.multiplier", settings.extrusion.multiplier, "times");
    found.extend(outside(flow, FLOWS, "what makes up for a filament or an extruder"));
    found
}

/// Speeds that are hardly meant.
fn slow(settings: &Settings) -> impl Iterator<Item = Warning> {
    settings
        .slow_speeds()
        .into_iter()
        .map(|(setting, speed_mm_s)| Warning::SlowSpeed { setting: setting.to_owned(), speed_mm_s })
}

/// Speeds that the printer goes below, whatever it is told.
fn fast(settings: &Settings) -> impl Iterator<Item = Warning> {
    let (speed, limits) = (&settings.speed, &settings.limits);
    let flat = limits.speed_x.max(limits.speed_y);
    [
        ("speed.z", speed.z, limits.speed_z, "what limits.speed_z lets the printer do"),
        ("speed.travel", speed.travel, flat, "what limits.speed_x and speed_y let the printer do"),
        (
            "retraction.speed",
            settings.retraction.speed,
            limits.speed_e,
            "what limits.speed_e lets the printer do",
        ),
    ]
    .into_iter()
    .filter_map(|(key, asked, most, what)| outside((key, asked, "mm/s"), [0.0, most], what))
}

/// Temperatures that the material is not made for.
fn heat(settings: &Settings) -> impl Iterator<Item = Warning> {
    let filament = &settings.filament;
    let least = filament.min_temperature.unwrap_or(0.0);
    let nozzle = [least, filament.max_temperature.unwrap_or(MOST_CELSIUS)];
    let bed = [0.0, filament.max_bed_temperature.unwrap_or(MOST_CELSIUS)];
    let what = |keys: &str| format!("what {} is printed at ({keys})", filament.name);
    let of_nozzle = what("filament.min_temperature, filament.max_temperature");
    let of_bed = what("filament.max_bed_temperature");
    let (own, first) = (filament.temperature, filament.first_layer_temperature);
    let (own_bed, first_bed) = (filament.bed_temperature, filament.first_layer_bed_temperature);
    [
        ("filament.temperature", Some(own), nozzle, of_nozzle.clone()),
        ("filament.first_layer_temperature", first, nozzle, of_nozzle),
        ("filament.bed_temperature", Some(own_bed), bed, of_bed.clone()),
        ("filament.first_layer_bed_temperature", first_bed, bed, of_bed),
    ]
    .into_iter()
    .filter_map(|(key, celsius, range, what)| outside((key, celsius?, "°C"), range, &what))
}

/// The finding that a value lies outside a range, if it does.
fn outside(
    (setting, value, unit): (&str, f64, &str),
    [least, most]: [f64; 2],
    what: &str,
) -> Option<Warning> {
    (value < least || value > most).then(|| Warning::OutsideRange {
        setting: setting.to_owned(),
        value,
        unit: unit.to_owned(),
        least,
        most,
        what: what.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{Profile, builtin_names, load};

    /// What is said of these settings of generic-marlin.
    fn told(set: &[(&str, &str)]) -> Vec<String> {
        let given = Profile::builder("generic-marlin");
        let given = set.iter().fold(given, |given, (key, value)| given.set(*key, *value));
        let settings = given.load().unwrap().settings;
        warnings(&settings).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn nothing_shipped_is_doubtful() {
        for name in builtin_names() {
            let profile = load([name], &[]).unwrap();
            assert_eq!(warnings(&profile.settings), [], "{name}");
            assert_eq!(cold_bed(&profile.settings, &profile.sources), None, "{name}");
        }
    }

    #[test]
    fn materials_that_need_a_hot_bed_are_told_where_none_is() {
        let told = |printer: &str, material: &str| {
            let profile = load([printer, material], &[]).unwrap();
            cold_bed(&profile.settings, &profile.sources).map(|one| one.to_string())
        };
        for material in ["abs", "asa"] {
            let text = told("replicator-2", material).unwrap();
            assert!(text.contains("asks for a bed of 100 °C") && text.contains("warps"), "{text}");
            assert_eq!(told("replicator-2x", material), None, "{material}");
        }
        for material in ["pla", "petg", "tpu", "abs-narino"] {
            assert_eq!(told("narino", material), None, "{material}");
        }
    }

    #[test]
    fn an_end_block_that_moves_aside_before_it_lifts_is_told() {
        for (block, line) in [
            ("M104 S0\nG1 X0 Y200 F3600 ; park\nM84", Some(2)),
            ("G91\nG1 E-2 F2700\ng1 x5 y5\nG1 Z10", Some(3)),
            ("M104 S0\nG1 Z{park_z} F600\nG1 X0 Y200", None),
            ("G91\nG1 E-2 Z0.2\nG1 X5 Y5", None),
            ("PRINT_END\nG1 X0", None),
            ("M104 S0", None),
        ] {
            let told = told(&[("machine.end_gcode", block)]);
            assert_eq!(told.len(), usize::from(line.is_some()), "{block}: {told:?}");
            let starts = format!("machine.end_gcode, line {}", line.unwrap_or_default());
            assert!(told.iter().all(|one| one.starts_with(&starts)), "{told:?}");
        }
    }

    #[test]
    fn each_value_is_told_with_its_range() {
        for (key, value, expected) in [
            ("extrusion.multiplier", "5", "extrusion.multiplier = 5 times lies outside 0.7 to 1.4"),
            (
                "filament.temperature",
                "290",
                "filament.temperature = 290 °C lies outside 180 to 235",
            ),
            (
                "filament.bed_temperature",
                "100",
                "filament.bed_temperature = 100 °C lies outside 0 to 80",
            ),
            ("speed.z", "100", "speed.z = 100 mm/s lies outside 0 to 16.667"),
            ("speed.travel", "400", "speed.travel = 400 mm/s lies outside 0 to 300"),
            ("speed.skin", "1", "speed.skin = 1 is very slow"),
        ] {
            let told = told(&[(key, value)]);
            assert!(told.len() == 1 && told[0].starts_with(expected), "{told:?}");
        }
        assert!(told(&[]).is_empty());
    }
}
