//! Settings + origins -> verdict: refuses values that are each in range but cannot print together.

use super::template::{self, PrintFacts};
use super::{DialectName, DualMode, Settings, ValueOrigin};
use crate::error::{Error, Result};
use std::collections::BTreeMap;

/// Slack for comparing lengths that were written as decimals, mm.
const SLACK_MM: f64 = 1e-9;

/// Lines narrower than this times the layer height do not lie, they stand.
const LEAST_WIDTH: f64 = 0.8;

/// Codes that GPX turns into host queries, on which a print from an SD card
/// stops for ever, or that it does not know and warns of.
const NOT_FOR_MAKERBOT: &[&str] = &[
    "M1", "M2", "M20", "M21", "M24", "M25", "M27", "M28", "M29", "M92", "M105", "M114", "M115",
    "M117", "M118", "M201", "M203", "M204", "M205",
];

/// Checks what no single key can tell.
///
/// # Errors
/// [`Error::Config`] that starts with the origin of one of the values concerned.
pub(super) fn together(settings: &Settings, origins: &BTreeMap<String, ValueOrigin>) -> Result<()> {
    let blame = Blame { origins };
    heights(settings, &blame)?;
    blocks(settings, &blame)
}

/// Makes the errors.
struct Blame<'a> {
    origins: &'a BTreeMap<String, ValueOrigin>,
}

impl Blame<'_> {
    /// An error about these keys, which starts with the origin that is most
    /// likely to blame: a flag before `--set` before a file.
    fn error(&self, keys: &[&str], why: &str) -> Error {
        let rank = |origin: &&ValueOrigin| match origin {
            ValueOrigin::Flag(_) => 0,
            ValueOrigin::Set | ValueOrigin::Program => 1,
            ValueOrigin::File { .. } | ValueOrigin::Recorded => 2,
        };
        let origin = keys.iter().filter_map(|key| self.origins.get(*key)).min_by_key(rank);
        Error::Config(origin.map_or_else(|| why.to_owned(), |origin| format!("{origin}: {why}")))
    }
}

fn heights(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    let nozzle = settings.machine.nozzle_diameter;
    let width = settings.line_width;
    for (key, height) in [
        ("layer_height", settings.layer_height),
        ("first_layer_height", settings.first_layer_height),
    ] {
        if height > nozzle + SLACK_MM {
            let why = format!(
                "{key} = {height} mm is more than machine.nozzle_diameter = {nozzle} mm; \
                 use thinner layers or a larger nozzle"
            );
            return Err(blame.error(&[key, "machine.nozzle_diameter"], &why));
        }
        if width < LEAST_WIDTH * height - SLACK_MM {
            let why = format!(
                "line_width = {width} mm is too little for {key} = {height} mm; \
                 use at least {LEAST_WIDTH} times the height"
            );
            return Err(blame.error(&["line_width", key], &why));
        }
    }
    dual(settings, blame)
}

fn dual(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    for key in ["dual.ratio", "dual.parts"] {
        let given = matches!(blame.origins.get(key), Some(ValueOrigin::Flag(_)));
        if given && settings.dual.mode == DualMode::Off {
            return Err(blame.error(&[key], "has no effect while dual.mode is off; add --dual"));
        }
    }
    let ratio = settings.dual_ratio();
    let height = settings.layer_height;
    let tall = f64::from(ratio.max(2)) * height;
    let most = settings.max_bead_height();
    if settings.dual.mode == DualMode::Off || ratio >= 2 && tall <= most + SLACK_MM {
        return Ok(());
    }
    let why = format!(
        "{} layers of layer_height = {height} mm make thick lines taller than the {most} mm that \
         dual.max_bead_height and machine.nozzle_diameter allow; use thinner layers, a lower dual.ratio, \
         or dual.mode = \"off\"",
        ratio.max(2)
    );
    let keys = [
        "dual.ratio",
        "layer_height",
        "dual.mode",
        "dual.max_bead_height",
        "machine.nozzle_diameter",
    ];
    Err(blame.error(&keys, &why))
}

fn blocks(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    let values = template::values(settings, &PrintFacts::default());
    let machine = &settings.machine;
    for (key, block) in
        [("machine.start_gcode", &machine.start_gcode), ("machine.end_gcode", &machine.end_gcode)]
    {
        let text = template::render(key, block, &values)
            .map_err(|error| blame.error(&[key], &error.to_string()))?;
        if machine.dialect == DialectName::Makerbot {
            no_host_codes(key, &text).map_err(|why| blame.error(&[key], &why))?;
        }
    }
    if settings.filament.bed_temperature > 0.0 && !machine.start_gcode.contains("{bed_temperature}")
    {
        let why = format!(
            "filament.bed_temperature = {} °C would have no effect: machine.start_gcode does not \
             contain {{bed_temperature}}; put it there, or set 0",
            settings.filament.bed_temperature
        );
        return Err(blame.error(&["filament.bed_temperature", "machine.start_gcode"], &why));
    }
    let says_relative = ["M83", "{e_mode}"].iter().any(|code| machine.start_gcode.contains(code));
    if machine.relative_e && !says_relative {
        let why = "machine.relative_e = true, but machine.start_gcode contains neither M83 nor {e_mode}; \
                   put {e_mode} on a line of its own";
        return Err(blame.error(&["machine.relative_e", "machine.start_gcode"], why));
    }
    Ok(())
}

fn no_host_codes(key: &str, text: &str) -> std::result::Result<(), String> {
    for (index, line) in text.lines().enumerate() {
        let code = line.split([';', '(']).next().and_then(|code| code.split_whitespace().next());
        if let Some(code) = code.filter(|code| NOT_FOR_MAKERBOT.contains(code)) {
            return Err(format!(
                "{key}, line {} of it: {code} must not be in a file for GPX, which drops it or \
                 makes the printer wait for a host; remove the line",
                index + 1
            ));
        }
    }
    Ok(())
}
