//! Findings -> text: what does not stop a run. Each names the fact, the likely cause and what to do.
//!
//! - A *finding* is a value with the numbers that tell of it, for the report; its text is made from them.
//!   Stages return findings; only the program prints them.
//! - Its *code* in the report is its name, in small letters with dashes. It keeps its meaning.
//!
//! To add one: a variant with its numbers, each with its unit in its name, then its text in `fmt`. What
//! takes more than a few lines there is a function below. The text is one line: what was found, why, and
//! a setting or a flag that changes it.

use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// A finding. It is printed as a line on standard error and listed in the report. With `--strict`
/// any of them makes the exit code 1.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "code", rename_all = "kebab-case")]
pub enum Warning {
    /// Nobody chose a printer: the file is for the default one.
    NoPrinter {
        /// Name of that printer.
        machine: String,
    },
    /// Holes were filled, or surfaces that enclose nothing dropped.
    MeshMended {
        /// The model's file.
        file: String,
        /// How much of what was done, and where.
        what: String,
    },
    /// A mesh that is not closed.
    OpenMesh {
        /// The model's file.
        file: String,
        /// The faults that leave it open, and where.
        what: String,
    },
    /// Contours that did not close on some layers and were closed by a straight line.
    OpenContours {
        /// On how many layers.
        layers: usize,
        /// The longest such line, mm.
        longest_gap_mm: f64,
    },
    /// Places too thin for one line, which are not printed.
    ThinPlaces {
        /// On how many layers.
        layers: usize,
        /// The area left out, mm², summed over the layers.
        area_mm2: f64,
    },
    /// Islands that begin in the air and meet the part further up.
    BeginsInTheAir {
        /// Number of islands.
        places: usize,
        /// Length of their lines, mm.
        length_mm: f64,
        /// Layer of the first one, counted from 1.
        layer: usize,
        /// Top of that layer, mm.
        z_mm: f64,
        /// Its place in the machine's coordinates, mm.
        at_mm: [f64; 2],
        /// Support is asked for, but this setting keeps it away.
        #[serde(skip_serializing_if = "Option::is_none")]
        kept_away: Option<String>,
    },
    /// Outer walls that hang over nothing by their whole width, for long and not from hold to hold.
    WallsHang {
        /// Their length, mm.
        length_mm: f64,
        /// That of the longest one, mm.
        longest_mm: f64,
        /// Its layer, counted from 1.
        layer: usize,
        /// Top of that layer, mm.
        z_mm: f64,
        /// Its middle in the machine's coordinates, mm.
        at_mm: [f64; 2],
        /// Whether support is asked for.
        supported: bool,
    },
    /// Lines that are printed in the air, since the part has nothing below them.
    PartHangs {
        /// Their length, mm.
        length_mm: f64,
        /// Whether support is asked for.
        supported: bool,
    },
    /// Islands that need a brim, for which the bed has no room.
    BrimLeftOut {
        /// How many.
        islands: usize,
        /// How many islands the first layer has.
        of: usize,
    },
    /// Bytes after the last triangle of a binary STL.
    TrailingBytes {
        /// The model's file.
        file: String,
        /// How many.
        count: u64,
    },
    /// A model so small that its unit is probably not the one assumed.
    TinyModel {
        /// The model's file.
        file: String,
        /// Its largest side as placed, mm.
        size_mm: f64,
    },
    /// A print speed so low that it is hardly meant.
    SlowSpeed {
        /// The setting.
        setting: String,
        /// Its value, mm/s.
        speed_mm_s: f64,
    },
    /// A value that is hardly meant, or more than printer or material bear.
    OutsideRange {
        /// The setting.
        setting: String,
        /// Its value.
        value: f64,
        /// Its unit, and that of the range.
        unit: String,
        /// Least of what is usual or borne.
        least: f64,
        /// Most of it.
        most: f64,
        /// Whose range it is.
        what: String,
    },
    /// A material that comes loose from a bed that is not heated, as this printer's.
    ColdBed {
        /// The material.
        material: String,
        /// What it asks of the bed, °C.
        asked_celsius: u32,
        /// Name of the printer.
        machine: String,
    },
    /// The end block moves the nozzle aside before anything lifts it.
    EndDrags {
        /// Line of the block, from 1.
        line: usize,
        /// What stands there.
        command: String,
    },
    /// Lines that are printed slower than asked for, since the hot end cannot melt as fast.
    FlowLimited {
        /// What they are for, as in the report's roles.
        role: String,
        /// The setting that asked for it.
        setting: String,
        /// Highest speed asked for, mm/s.
        asked_mm_s: f64,
        /// Lowest speed given, mm/s.
        lowest_mm_s: f64,
        /// What the hot end melts, mm³/s.
        limit_mm3_s: f64,
    },
    /// Settings that the printer cannot be told.
    NoEffect {
        /// Their keys.
        settings: Vec<String>,
        /// Why not.
        why: String,
    },
    /// A jerk that the machine's command has no room for.
    JerkHeld {
        /// The setting.
        setting: String,
        /// Its value, mm/s.
        asked_mm_s: f64,
        /// What the machine gets instead, mm/s.
        given_mm_s: f64,
    },
    /// More acceleration than the machine bears.
    AccelerationHeld {
        /// The setting.
        setting: String,
        /// Its value, mm/s².
        asked_mm_s2: f64,
        /// What the file asks for instead, mm/s².
        given_mm_s2: f64,
    },
    /// Arcs are asked for, but not known to the firmware: none were written.
    ArcsUnknown {
        /// Name of the printer.
        machine: String,
    },
    /// Lines that are printed noticeably slower than asked for, since they are short.
    ShortLinesSlowed {
        /// How many.
        lines: usize,
        /// What they take longer by, s.
        lost_s: f64,
        /// Moves that the printer can be fed, 1/s.
        limit_per_s: f64,
    },
}

impl Warning {
    /// That these keys change nothing, and why.
    #[must_use]
    pub fn void<'a>(keys: impl IntoIterator<Item = &'a str>, why: &str) -> Self {
        let settings = keys.into_iter().map(str::to_owned).collect();
        Self::NoEffect { settings, why: why.to_owned() }
    }

    /// The model's file that its text names, if it names one.
    #[must_use]
    pub fn file(&self) -> Option<&str> {
        match self {
            Self::MeshMended { file, .. }
            | Self::OpenMesh { file, .. }
            | Self::TrailingBytes { file, .. }
            | Self::TinyModel { file, .. } => Some(file),
            _ => None,
        }
    }

    /// Where it is on the bed, in the machine's coordinates, mm, if it is at one place.
    #[must_use]
    pub fn at_mm(&self) -> Option<[f64; 2]> {
        match self {
            Self::BeginsInTheAir { at_mm, .. } | Self::WallsHang { at_mm, .. } => Some(*at_mm),
            _ => None,
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPrinter { machine } => f.write_str(&no_printer(machine)),
            Self::MeshMended { file, what } => f.write_str(&mended(file, what)),
            Self::OpenMesh { file, what } => f.write_str(&open(file, what)),
            Self::OpenContours { layers, longest_gap_mm } => {
                f.write_str(&closed(*layers, *longest_gap_mm))
            }
            Self::ThinPlaces { layers, area_mm2 } => f.write_str(&too_thin(*layers, *area_mm2)),
            Self::BeginsInTheAir { places, length_mm, layer, z_mm, at_mm, kept_away } => {
                let kept_away = kept_away.as_deref();
                f.write_str(&in_the_air((*places, *length_mm), (*layer, *z_mm), *at_mm, kept_away))
            }
            Self::WallsHang { length_mm, longest_mm, layer, z_mm, at_mm: [x, y], supported } => {
                write!(
                    f,
                    "{length_mm:.0} mm of outer walls hang over nothing, {longest_mm:.0} mm in one on layer {layer} at \
                     {z_mm:.2} mm, x {x:.1} y {y:.1}; {}turn the part with --rotate",
                    out_of_reach(*supported)
                )
            }
            Self::PartHangs { length_mm, supported } => f.write_str(&hangs(*length_mm, *supported)),
            Self::BrimLeftOut { islands, of } => f.write_str(&left_out(*islands, *of)),
            Self::TrailingBytes { file, count } => {
                write!(f, "{file}: ignored {} after the last triangle", plural(*count, "byte"))
            }
            Self::TinyModel { file, size_mm } => write!(
                f,
                "{file}: the model is only {size_mm:.3} mm large; if its unit is not mm, \
                 use --unit or --scale"
            ),
            Self::SlowSpeed { setting, speed_mm_s } => {
                write!(f, "{setting} = {speed_mm_s} is very slow; speeds are in mm/s")
            }
            Self::OutsideRange { setting, value, unit, least, most, what } => write!(
                f,
                "{setting} = {value} {unit} lies outside {least} to {most}, {what}; change one"
            ),
            Self::ColdBed { material, asked_celsius, machine } => {
                f.write_str(&cold_bed(material, *asked_celsius, machine))
            }
            Self::EndDrags { line, command } => f.write_str(&end_drags(*line, command)),
            Self::FlowLimited { role, setting, asked_mm_s, lowest_mm_s, limit_mm3_s } => {
                let speeds = [*asked_mm_s, *lowest_mm_s].map(short);
                f.write_str(&flow_limited(role, setting, speeds, *limit_mm3_s))
            }
            Self::NoEffect { settings, why } => f.write_str(&no_effect(settings, why)),
            Self::JerkHeld { setting, asked_mm_s, given_mm_s } => {
                f.write_str(&jerk_held(setting, *asked_mm_s, *given_mm_s))
            }
            Self::AccelerationHeld { setting, asked_mm_s2, given_mm_s2 } => {
                f.write_str(&held(setting, *asked_mm_s2, *given_mm_s2))
            }
            Self::ArcsUnknown { machine } => f.write_str(&arcs_unknown(machine)),
            Self::ShortLinesSlowed { lines, lost_s, limit_per_s } => {
                f.write_str(&short_lines(*lines, *lost_s, *limit_per_s))
            }
        }
    }
}

/// That nobody chose a printer.
fn no_printer(machine: &str) -> String {
    format!(
        "no printer chosen: this file is for the {machine}; choose one with -p (slicer profile list)"
    )
}

/// That the end block moves aside too early.
fn end_drags(line: usize, command: &str) -> String {
    format!(
        "machine.end_gcode, line {line} of it: `{command}` drags the nozzle over the print, since nothing lifts it \
         before; write G1 Z{{park_z}} F600 above it"
    )
}

/// That places are too thin.
fn too_thin(layers: usize, area_mm2: f64) -> String {
    format!(
        "left out {area_mm2:.1} mm² on {} that are too thin for a bead; use a smaller min_feature or nozzle",
        plural(layers as u64, "layer")
    )
}

/// That islands begin in the air: how many of what length, on which layer at which height, where.
fn in_the_air(
    (places, length_mm): (usize, f64),
    (layer, z_mm): (usize, f64),
    [x, y]: [f64; 2],
    kept_away: Option<&str>,
) -> String {
    format!(
        "{} mm of lines begin in the air at {}, first on layer {layer} at {z_mm:.2} mm, x {x:.1} y {y:.1}; {}, \
         or turn the part with --rotate",
        rough(length_mm),
        plural(places as u64, "place"),
        carried(kept_away)
    )
}

/// That a mesh was mended.
fn mended(file: &str, what: &str) -> String {
    format!(
        "{file}: the mesh was mended: {what}; look whether it is what was meant, or mend the model"
    )
}

/// That a mesh is not closed.
fn open(file: &str, what: &str) -> String {
    format!("{file}: the mesh is not closed: {what}; check the print or mend the model")
}

/// That contours were closed.
fn closed(layers: usize, longest_gap_mm: f64) -> String {
    format!(
        "closed open contours on {} by straight lines of up to {longest_gap_mm:.3} mm; check the print \
         or mend the model",
        plural(layers as u64, "layer")
    )
}

/// That the hot end cannot melt as fast; speeds asked for and given, mm/s.
fn flow_limited(role: &str, setting: &str, [asked, lowest]: [f64; 2], limit: f64) -> String {
    format!(
        "{role}: slowed down from {asked} to as little as {lowest} mm/s, since the hot end melts no \
         more than {limit} mm³/s; set {setting} to that, or machine.max_volumetric_speed if it \
         melts more"
    )
}

/// That the bed stays cold.
fn cold_bed(material: &str, asked_celsius: u32, machine: &str) -> String {
    format!(
        "{material} asks for a bed of {asked_celsius} °C, which {machine} cannot heat \
         (machine.heated_bed = false): it warps and comes loose; print another material, or small flat \
         parts with a wide brim or a raft"
    )
}

/// That no arcs were written.
fn arcs_unknown(machine: &str) -> String {
    format!(
        "no arcs were written, since {machine} is not known to draw them: set machine.arcs = true if \
         its firmware does (Marlin's ARC_SUPPORT, Klipper's [gcode_arcs]), or leave out --arcs"
    )
}

/// That short lines are slower.
fn short_lines(lines: usize, lost_s: f64, limit_per_s: f64) -> String {
    let are = if lines == 1 { "is" } else { "are" };
    format!(
        "{} {are} slowed down, by {lost_s:.0} s in all, since shorter ones than the printer can be \
         fed are among them; use a larger tolerance, or a limits.max_segment_rate above \
         {limit_per_s} if it takes more moves a second",
        plural(lines as u64, "line")
    )
}

/// What carries walls that hang.
fn out_of_reach(supported: bool) -> &'static str {
    if supported {
        "no support reaches them: see support.threshold_angle and support.xy_distance, or "
    } else {
        "use --support, or "
    }
}

/// That the part has lines in the air.
fn hangs(length_mm: f64, supported: bool) -> String {
    format!(
        "{} mm of lines begin in the air, where the part has nothing below; {}turn the part with --rotate",
        rough(length_mm),
        if supported { "" } else { "use --support, or " }
    )
}

/// That settings do nothing on this printer.
fn no_effect(settings: &[String], why: &str) -> String {
    let have = if settings.len() == 1 { "has" } else { "have" };
    format!("{} {have} no effect: {why}", settings.join(", "))
}

/// That less acceleration is asked for than a setting says.
fn held(setting: &str, asked: f64, given: f64) -> String {
    format!(
        "{setting} = {asked} is held to {given} mm/s², the lesser of limits.acceleration_x and \
         limits.acceleration_y; raise these if the printer's are higher"
    )
}

/// That a jerk is another than a setting says.
fn jerk_held(setting: &str, asked: f64, given: f64) -> String {
    format!(
        "{setting} = {asked} is held to {given:.1} mm/s, since Marlin takes a junction deviation (M205 J) \
         of 0.01 to 0.3 mm; set that, or another acceleration beside it"
    )
}

/// That a brim was left out.
fn left_out(islands: usize, of: usize) -> String {
    format!(
        "{islands} of {} on the bed may come loose, but a brim would reach beyond the bed: none is \
         printed there; use another place (--at), a smaller brim.width or fewer copies",
        plural(of as u64, "island")
    )
}

/// How what hangs may be carried, where this setting keeps support away.
fn carried(kept_away: Option<&str>) -> String {
    let set = |key| format!("{key} keeps support away there; set another");
    kept_away.map_or_else(|| "use --support".to_owned(), set)
}

/// A length in whole mm, or in tenths where it is shorter than a few.
fn rough(length_mm: f64) -> String {
    if length_mm < 3.0 { format!("{:.1}", length_mm.max(0.1)) } else { format!("{length_mm:.0}") }
}

/// A speed in hundredths, rounded down: what a setting may be without being too much.
fn short(speed: f64) -> f64 {
    (speed * 100.0 + 1e-6).floor() / 100.0
}

/// A number of things, such as `1 byte` or `2 bytes`.
#[must_use]
pub fn plural(count: u64, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}
