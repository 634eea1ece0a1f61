//! Start and end blocks + values -> text: fills in `{placeholders}`.
//!
//! - A *placeholder* is a name of ours in braces; its value is a text, mostly a number.
//! - Two braces stand for one, so that RepRapFirmware's own `{expressions}` can be written.
//! - What other slicers would fill in or compute is refused, with our name for it where there is one
//!   (see `placeholders`): it would reach the printer as it is.
//! - A block is filled in line by line, so that an error can name the line. The start block gets the first
//!   layer's temperatures, the end block those of the rest.

use super::Settings;
use super::error::{BlockError, PlaceholderError};
use super::placeholders;

/// What a block may want to know of the print itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PrintFacts {
    /// Number of layers.
    pub layers: usize,
    /// Lowest x and y that is printed, in the machine's coordinates, mm.
    pub min: [f64; 2],
    /// Highest x and y that is printed, in the machine's coordinates, mm.
    pub max: [f64; 2],
    /// Top of the last layer, mm.
    pub height: f64,
}

/// How far the nozzle may be lifted off the finished print, mm.
const PARK_LIFT_MM: f64 = 10.0;

/// All placeholders with their values. Lengths in mm, temperatures in °C,
/// acceleration in mm/s²; numbers never have an exponent, because GPX reads
/// that as an E word.
#[must_use]
pub fn values(settings: &Settings, print: &PrintFacts) -> Vec<(&'static str, String)> {
    let machine = &settings.machine;
    let park = (print.height + PARK_LIFT_MM).min(machine.bed_height);
    vec![
        ("temperature", number(settings.filament.temperature)),
        ("bed_temperature", number(settings.filament.bed_temperature)),
        ("tool", machine.tool.to_string()),
        ("bed_width", number(machine.bed_width)),
        ("bed_depth", number(machine.bed_depth)),
        ("bed_height", number(machine.bed_height)),
        ("travel_acceleration", number(settings.limits.travel_acceleration)),
        ("acceleration", number(machine.acceleration)),
        ("e_mode", if machine.relative_e { "M83" } else { "M82" }.to_owned()),
        ("nozzle_diameter", number(machine.nozzle_diameter)),
        ("layer_height", number(settings.layer_height)),
        ("first_layer_height", number(settings.first_layer_height)),
        ("filament", settings.filament.name.clone()),
        ("filament_diameter", number(settings.filament.diameter)),
        ("layers", print.layers.to_string()),
        ("min_x", fixed(print.min[0])),
        ("min_y", fixed(print.min[1])),
        ("max_x", fixed(print.max[0])),
        ("max_y", fixed(print.max[1])),
        ("height", fixed(print.height)),
        ("park_z", fixed(park)),
    ]
}

/// As [`values`], for the block before the first layer: its temperatures are that layer's.
#[must_use]
pub fn start_values(settings: &Settings, print: &PrintFacts) -> Vec<(&'static str, String)> {
    let first = [
        ("temperature", settings.first_temperature()),
        ("bed_temperature", settings.first_bed_temperature()),
    ];
    let mut values = values(settings, print);
    for (name, value) in &mut values {
        if let Some((_, celsius)) = first.iter().find(|(known, _)| known == name) {
            *value = number(*celsius);
        }
    }
    values
}

/// Fills `block` in: `{name}` becomes its value, `{{` and `}}` become braces.
/// `name` is the block's key, for messages. Lines end with a newline alone, the
/// last one too.
///
/// # Errors
/// Unknown placeholders, of another slicer too, or single braces: all of them, each once.
pub fn render(name: &str, block: &str, values: &[(&str, String)]) -> Result<String, BlockError> {
    let mut text = String::with_capacity(block.len());
    let mut faults: Vec<(usize, PlaceholderError)> = Vec::new();
    for (index, line) in block.lines().enumerate() {
        let mut of_line = Vec::new();
        // What is wrong with its braces hides the rest of the line.
        let broken = render_line(line, values, &mut text, &mut of_line).err();
        for fault in of_line.into_iter().chain(broken) {
            if faults.iter().all(|(_, other)| *other != fault) {
                faults.push((index + 1, fault));
            }
        }
        text.push('\n');
    }
    if faults.is_empty() { Ok(text) } else { Err(BlockError { block: name.to_owned(), faults }) }
}

/// Fills a line in. Unknown placeholders go to `faults`.
fn render_line(
    line: &str,
    values: &[(&str, String)],
    text: &mut String,
    faults: &mut Vec<PlaceholderError>,
) -> Result<(), PlaceholderError> {
    if let Some(written) = placeholders::bracketed(line) {
        return Err(unknown(written, line, values));
    }
    let mut rest = line;
    while let Some(at) = rest.find(['{', '}']) {
        text.push_str(&rest[..at]);
        let brace = &rest[at..=at];
        rest = &rest[at + 1..];
        if let Some(after) = rest.strip_prefix(brace) {
            text.push_str(brace);
            rest = after;
            continue;
        }
        if brace == "}" {
            return Err(PlaceholderError::SingleBrace);
        }
        let Some((name, after)) = rest.split_once('}') else {
            return Err(PlaceholderError::OpenBrace);
        };
        rest = after;
        if let Some((_, value)) = values.iter().find(|(known, _)| *known == name) {
            text.push_str(value);
            continue;
        }
        let fault = unknown(&format!("{{{name}}}"), line, values);
        // What stands between a condition and its end goes with it.
        if matches!(fault, PlaceholderError::Condition { .. }) {
            return Err(fault);
        }
        faults.push(fault);
    }
    text.push_str(rest);
    Ok(())
}

/// The error for a placeholder that is `written` so in a line, with its brackets.
fn unknown(written: &str, line: &str, values: &[(&str, String)]) -> PlaceholderError {
    let written = written.to_owned();
    let name = written.get(1..written.len() - 1).unwrap_or_default().trim().to_owned();
    if is_condition(&name) {
        return PlaceholderError::Condition { written, lifts: moves_z(line) };
    }
    if name.contains(['+', '*', '/', '<', '>', '(']) {
        let of_height = ["layer_z", "print_z", "print_height"].iter().any(|z| name.contains(z));
        return PlaceholderError::Sum { written, of_height };
    }
    match placeholders::ours(&name) {
        Some(ours) => PlaceholderError::Foreign { written, ours: Some(ours) },
        None if placeholders::is_known(&name) => PlaceholderError::Foreign { written, ours: None },
        None => {
            let known = values.iter().map(|(known, _)| (*known).to_owned()).collect();
            PlaceholderError::Unknown { written, known }
        }
    }
}

/// Whether it is a condition of another slicer's: `if max_layer_z < 200`, `endif`.
fn is_condition(name: &str) -> bool {
    let word = name.split_whitespace().next().unwrap_or_default();
    ["if", "elsif", "else", "endif"].contains(&word)
}

/// Whether a line holds a move of z, whatever stands around it.
fn moves_z(line: &str) -> bool {
    let code = line.split(';').next().unwrap_or_default();
    ["G0 Z", "G1 Z"].iter().any(|lift| code.contains(lift))
}

/// Shortest decimal text; Rust's `Display` for `f64` has no exponents.
fn number(value: f64) -> String {
    value.to_string()
}

/// Three decimals, and no minus before a zero.
fn fixed(value: f64) -> String {
    let text = format!("{value:.3}");
    if text == "-0.000" { "0.000".to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Vec<(&'static str, String)> {
        vec![("temperature", "220".to_owned()), ("tool", "1".to_owned())]
    }

    #[test]
    fn placeholders_are_filled_in() {
        let text = render("b", "M104 S{temperature} T{tool}\n{{x}} ;}}\n", &sample()).unwrap();
        assert_eq!(text, "M104 S220 T1\n{x} ;}\n");
    }

    #[test]
    fn every_line_ends_with_a_newline_alone() {
        assert_eq!(render("b", "G21\r\nG90", &[]).unwrap(), "G21\nG90\n");
        assert_eq!(render("b", "", &[]).unwrap(), "");
    }

    #[test]
    fn unknown_placeholders_are_named_with_block_and_line() {
        let error = render("machine.end_gcode", "G21\nM104 S{temprature}", &sample()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "machine.end_gcode, line 2 of it: unknown placeholder {temprature}; \
             did you mean {temperature}?"
        );
        let error = render("b", "{zzzzzz}", &sample()).unwrap_err().to_string();
        assert!(error.ends_with("known are temperature, tool"), "{error}");
    }

    #[test]
    fn placeholders_of_other_slicers_are_answered_by_ours() {
        let values = values(
            &crate::profile::load([crate::profile::DEFAULT], &[]).unwrap().settings,
            &PrintFacts::default(),
        );
        for (line, expected) in [
            (
                "M109 S[first_layer_temperature] ; wait",
                "unknown placeholder [first_layer_temperature]; here it is {temperature}",
            ),
            (
                "M190 S{material_bed_temperature_layer_0}",
                "unknown placeholder {material_bed_temperature_layer_0}; here it is {bed_temperature}",
            ),
            (
                "M104 S{first_layer_temperature[0]}",
                "unknown placeholder {first_layer_temperature[0]}; here it is {temperature}",
            ),
            ("M104 S{nozzle_temperature_initial_layer}", "here it is {temperature}"),
            ("G1 Y[print_bed_max]", "here it is {bed_width} for x, {bed_depth} for y"),
            ("G1 Z[z_offset]", "unknown placeholder [z_offset]; there is none for it here"),
            ("M104 S[temprature]", "unknown placeholder [temprature]; did you mean {temperature}?"),
            (
                "{if max_layer_z < max_print_height}G1 Z9{endif}",
                "{if max_layer_z < max_print_height} is a condition",
            ),
            (
                "{if max_layer_z < max_print_height}G1 Z{z_offset+min(max_layer_z+1, 9)} F600{endif}",
                "write G1 Z{park_z} F600 in its place",
            ),
            ("{if layer_z < 9}M300{endif}", "write the line as it shall be"),
            ("G1 Z{max_layer_z + 2}", "{park_z} is 10 mm above the print"),
            ("G1 F{travel_speed*60}", "nothing is computed here; write the number that it gives"),
            ("M141 S{chamber_temperature}", "there is none for it here: write its value"),
            ("M104 S{material_standby_temperature}", "there is none for it here: write its value"),
            (
                "M104 S{first_layer_temperature[initial_extruder]}",
                "unknown placeholder {first_layer_temperature[initial_extruder]}; here it is {temperature}",
            ),
        ] {
            let error = render("b", line, &values).unwrap_err().to_string();
            assert!(error.starts_with("b, line 1 of it: ") && error.contains(expected), "{error}");
        }
        for fine in
            ["G28 ; home [all] axes [temperature]", "M117 [1/2] heating [soon]", "START A=[x]"]
        {
            assert_eq!(render("b", fine, &values).unwrap(), format!("{fine}\n"));
        }
    }

    #[test]
    fn all_faults_of_a_block_are_told_at_once_each_once_and_not_too_many() {
        let block = "M104 S{heat} T{tol}\nG28\nM109 S{heat}\n}\nM190 S[bed_temperature]\n";
        let text = render("b", block, &sample()).unwrap_err().to_string();
        assert_eq!(
            text,
            "b, line 1 of it: unknown placeholder {heat}; known are temperature, tool; line 1: unknown \
             placeholder {tol}; did you mean {tool}?; line 4: a single `}`; write `}}` for a brace; line 5: \
             unknown placeholder [bed_temperature]; here it is {bed_temperature}"
        );
        let many: String = (0..9).map(|k| format!("M104 S{{tool{k}}}\n")).collect();
        let text = render("b", &many, &sample()).unwrap_err().to_string();
        assert!(text.contains("{tool4}") && text.ends_with("; and 4 more"), "{text}");
    }

    #[test]
    fn single_braces_are_refused() {
        assert!(render("b", "a } b", &sample()).is_err());
        assert!(render("b", "a {tool", &sample()).is_err());
    }

    #[test]
    fn tiny_numbers_have_no_exponent_and_zero_no_sign() {
        assert_eq!(number(0.000_000_1), "0.0000001");
        assert_eq!(fixed(-0.000_01), "0.000");
        assert_eq!(fixed(-12.5), "-12.500");
    }
}
