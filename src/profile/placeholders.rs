//! A placeholder of another slicer -> ours for it, and where one stands in a line of G-code.
//!
//! Blocks are pasted from other slicers, which write `[first_layer_temperature]` (PrusaSlicer, Slic3r,
//! Simplify3D) or `{material_print_temperature_layer_0}` (Cura). What nobody fills in reaches the
//! printer as it is: Marlin then reads a command without its number, and heats nothing.
//!
//! Brackets are legal in G-code: in comments, in texts for the display, in the words of macros. So a name
//! in brackets counts as a placeholder in two cases alone:
//! - another slicer has a placeholder or a setting of this name: then wherever it stands but in a comment;
//! - it is the value of a word of a numbered command, as in `M104 S[heat]`.
//!
//! A *name* is what stands between the brackets without its index: `temperature` in
//! `[temperature_0]` and `{temperature[0]}`.

use super::foreign;

/// Our placeholder, and what others call it.
#[rustfmt::skip]
const NAMES: &[(&str, &[&str])] = &[
    ("temperature", &["first_layer_temperature", "nozzle_temperature", "nozzle_temperature_initial_layer", "material_print_temperature", "material_print_temperature_layer_0", "material_initial_print_temperature", "print_temperature", "extruder0_temperature", "extruder1_temperature", "temperature_extruder1"]),
    ("bed_temperature", &["first_layer_bed_temperature", "bed_temperature_initial_layer", "bed_temperature_initial_layer_single", "hot_plate_temp", "hot_plate_temp_initial_layer", "textured_plate_temp_initial_layer", "material_bed_temperature", "material_bed_temperature_layer_0", "bed0_temperature", "temperature_heatbed"]),
    ("tool", &["initial_tool", "initial_extruder", "initial_extruder_nr", "initial_no_support_extruder", "current_extruder", "extruder_nr"]),
    ("bed_width", &["machine_width"]),
    ("bed_depth", &["machine_depth"]),
    ("bed_height", &["machine_height", "max_print_height", "printable_height"]),
    ("travel_acceleration", &["machine_max_acceleration_travel", "acceleration_travel"]),
    ("acceleration", &["machine_max_acceleration_extruding", "default_acceleration", "acceleration_print"]),
    ("nozzle_diameter", &["machine_nozzle_size"]),
    ("first_layer_height", &["layer_height_0", "initial_layer_print_height"]),
    ("filament", &["filament_type", "material_type", "material_name", "filament_preset", "filament_settings_id"]),
    ("filament_diameter", &["material_diameter"]),
    ("layers", &["total_layer_count", "total_layer_number", "layer_count"]),
    ("height", &["max_layer_z", "max_print_z"]),
];

/// Lists of an x and a y, and ours for both.
const PAIRS: &[(&str, [&str; 2])] = &[
    ("first_layer_print_min", ["min_x", "min_y"]),
    ("first_layer_print_max", ["max_x", "max_y"]),
    ("print_bed_max", ["bed_width", "bed_depth"]),
    ("print_bed_size", ["bed_width", "bed_depth"]),
];

/// Placeholders of others for which there is none here.
const NO_OTHER: &[&str] = &[
    "bed_shape",
    "build_volume_temperature",
    "chamber_minimal_temperature",
    "chamber_temperature",
    "day_name",
    "extruded_volume",
    "extruded_weight",
    "filament_extruder_id",
    "first_layer_print_convex_hull",
    "first_layer_print_size",
    "has_single_extruder_multi_material_priming",
    "has_wipe_tower",
    "input_filename",
    "input_filename_base",
    "is_extruder_used",
    "jobname",
    "layer_num",
    "layer_z",
    "material_standby_temperature",
    "next_extruder",
    "num_extruders",
    "num_instances",
    "num_objects",
    "num_printing_extruders",
    "outer_wall_volumetric_speed",
    "overall_chamber_temperature",
    "plate_name",
    "position",
    "previous_extruder",
    "print_bed_min",
    "print_preset",
    "print_time",
    "printer_preset",
    "printing_filament_types",
    "retract_length",
    "silent_print_time",
    "timelapse_pos_x",
    "timelapse_pos_y",
    "timestamp",
    "toolchange_z",
    "total_cost",
    "total_toolchanges",
    "total_weight",
    "used_filament",
    "z_offset",
    "zhop",
];

/// M-codes whose words are texts or names of files.
const TEXTS: &[u32] =
    &[16, 20, 23, 28, 30, 32, 34, 98, 117, 118, 291, 486, 550, 551, 552, 587, 588, 589, 928, 1002];

/// How ours for a placeholder of another slicer is written, `{temperature}`; `None` if there is none.
/// `text` is what stands between its brackets.
pub(super) fn ours(text: &str) -> Option<String> {
    let (name, index) = parted(text);
    if let Some((_, [x, y])) = PAIRS.iter().find(|(pair, _)| *pair == name) {
        return Some(match index {
            Some(0) => format!("{{{x}}}"),
            Some(1) => format!("{{{y}}}"),
            _ => format!("{{{x}}} for x, {{{y}}} for y"),
        });
    }
    let row = NAMES.iter().find(|(ours, theirs)| *ours == name || theirs.contains(&name));
    row.map(|(ours, _)| format!("{{{ours}}}"))
}

/// Whether another slicer has a placeholder or a setting with such a name.
pub(super) fn is_known(text: &str) -> bool {
    let (name, _) = parted(text);
    let is_setting = name.contains('_') && foreign::meaning(name).is_some();
    ours(text).is_some() || NO_OTHER.contains(&name) || is_setting
}

/// The first placeholder in square brackets of a line of a block, with its brackets.
pub(super) fn bracketed(line: &str) -> Option<&str> {
    let code = code(line);
    let is_value = |at: usize| takes_numbers(code) && follows_letter(&code[..at]);
    // What stands between doubled braces is the firmware's own; in others it is the index of a name.
    let is_in_braces = |at: usize| code[..at].rfind('{') > code[..at].rfind('}');
    groups(code, ['[', ']'])
        .filter(|&(at, _)| !is_in_braces(at))
        .find(|&(at, name)| is_name(name) && (is_known(name) || is_value(at)))
        .map(|(at, name)| &code[at..at + name.len() + 2])
}

/// The first placeholder that was left in a line of finished G-code, with its brackets: in square ones or in
/// braces, of other slicers or our own.
#[must_use]
pub fn left_in(line: &str) -> Option<&str> {
    let code = code(line);
    let braced = groups(code, ['{', '}']).find(|(_, name)| {
        let (bare, _) = parted(name);
        is_name(bare) && is_known(bare)
    });
    let braced = braced.map(|(at, name)| &code[at..at + name.len() + 2]);
    bracketed(line).or(braced)
}

/// What is no comment of a line. Texts of RepRapFirmware may hold a `;`, and nothing is lost then.
fn code(line: &str) -> &str {
    line.split(';').next().unwrap_or_default()
}

/// What stands between such brackets, and where each begins.
fn groups(code: &str, [open, close]: [char; 2]) -> impl Iterator<Item = (usize, &str)> {
    code.match_indices(open).filter_map(move |(at, _)| {
        let inside = &code[at + 1..];
        Some((at, &inside[..inside.find(close)?]))
    })
}

fn is_name(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_alphabetic())
        && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
}

/// The name and the index of what stands between brackets: `temperature_0`, `temperature[0]`, and Cura's
/// `temperature, 0`. Names that end with a number of their own stay whole.
fn parted(text: &str) -> (&str, Option<u32>) {
    let text = text.trim();
    if let Some((name, rest)) = text.split_once(['[', ',']) {
        return (name.trim(), rest.trim_end_matches(']').trim().parse().ok());
    }
    let is_whole = |name: &str| NAMES.iter().any(|(_, theirs)| theirs.contains(&name));
    match text.rsplit_once('_') {
        Some((name, index)) if !is_whole(text) => match index.parse() {
            Ok(index) => (name, Some(index)),
            Err(_) => (text, None),
        },
        _ => (text, None),
    }
}

/// Whether the code is a numbered command, or a bare tool, whose words are numbers.
fn takes_numbers(code: &str) -> bool {
    let code = code.trim_start();
    let Some(letter) = code.chars().next().filter(char::is_ascii_alphabetic) else { return false };
    let rest = &code[1..];
    let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
    let number = rest[..digits].parse().ok();
    let is_text = letter.eq_ignore_ascii_case(&'M') && number.is_some_and(|m| TEXTS.contains(&m));
    (digits > 0 || letter.eq_ignore_ascii_case(&'T') && rest.starts_with('[')) && !is_text
}

/// Whether a word's letter stands at the end, with a sign or without: `S`, `X-`.
fn follows_letter(before: &str) -> bool {
    let word = before.trim_end_matches(['-', '+']);
    let mut back = word.chars().rev();
    let is_letter = back.next().is_some_and(|last| last.is_ascii_alphabetic());
    is_letter && back.next().is_none_or(|one| !one.is_ascii_alphabetic() && one != '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn others_placeholders_have_ours() {
        for (theirs, expected) in [
            ("first_layer_temperature", "{temperature}"),
            ("first_layer_temperature_0", "{temperature}"),
            ("first_layer_temperature[0]", "{temperature}"),
            ("material_print_temperature_layer_0", "{temperature}"),
            ("material_bed_temperature_layer_0, 0", "{bed_temperature}"),
            ("nozzle_temperature_initial_layer", "{temperature}"),
            ("temperature[initial_extruder]", "{temperature}"),
            ("print_bed_max[1]", "{bed_depth}"),
            ("first_layer_print_min_0", "{min_x}"),
            ("print_bed_max", "{bed_width} for x, {bed_depth} for y"),
            ("layer_height_0", "{first_layer_height}"),
        ] {
            assert_eq!(ours(theirs).as_deref(), Some(expected), "{theirs}");
        }
        assert_eq!((ours("z_offset"), ours("xyz")), (None, None));
        assert!(is_known("z_offset") && is_known("perimeter_speed") && !is_known("cooling"));
    }

    #[test]
    fn names_in_brackets_are_placeholders_where_numbers_stand() {
        for (line, expected) in [
            ("M109 S[first_layer_temperature] ; wait", Some("[first_layer_temperature]")),
            ("M104 S[heat]", Some("[heat]")),
            ("M104 S{{var.t[i]}}", None),
            ("M104 S{{heaters[tool]}} T[tool]", Some("[tool]")),
            ("G1 X-[away] Y2", Some("[away]")),
            ("T[initial_tool]", Some("[initial_tool]")),
            (
                "PRINT_START BED=[first_layer_bed_temperature]",
                Some("[first_layer_bed_temperature]"),
            ),
            ("M117 [input_filename_base]", Some("[input_filename_base]")),
            ("G28 ; home [all] axes, [first_layer_temperature]", None),
            ("M117 Heating [please wait] [1/2] [ready]", None),
            ("M118 E1 [busy]", None),
            ("START_PRINT MESH=[a] OBJECTS=[[1,2],[3,4]]", None),
            ("echo \"[done]\"", None),
            ("G1 X{{sensors.analog[i]}}", None),
            ("M98 P\"a[b].g\"", None),
        ] {
            assert_eq!(bracketed(line), expected, "{line}");
        }
    }

    #[test]
    fn what_is_left_in_a_file_is_seen_in_both_kinds_of_brackets() {
        assert_eq!(left_in("START BED={bed_temperature} E=1"), Some("{bed_temperature}"));
        assert_eq!(
            left_in("START T={material_print_temperature}"),
            Some("{material_print_temperature}")
        );
        for fine in ["M104 S{global.heat}", "if {move.axes[0].homed}", "START {a}", "{", "[", ""] {
            assert_eq!(left_in(fine), None, "{fine}");
        }
    }
}
