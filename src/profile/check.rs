//! Settings + origins -> verdict: refuses values that are each in range but cannot print together.

use super::error::{Conflict, ProfileError, Result};
use super::origin::ValueOrigin;
use super::template::{self, PrintFacts};
use super::{DialectName, DualMode, Settings};
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
/// [`ProfileError::Conflict`] or [`ProfileError::Block`], with the origin of one of the values
/// concerned.
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
    /// An error about these keys.
    fn error(&self, keys: &[&str], source: Conflict) -> ProfileError {
        ProfileError::Conflict { origin: self.origin(keys), source }
    }

    /// The origin that is most likely to blame: a flag before `--set` before a file.
    fn origin(&self, keys: &[&str]) -> Option<ValueOrigin> {
        let rank = |origin: &&ValueOrigin| match origin {
            ValueOrigin::Flag(_) => 0,
            ValueOrigin::Set | ValueOrigin::Program => 1,
            ValueOrigin::File { .. } | ValueOrigin::Recorded => 2,
            ValueOrigin::Default | ValueOrigin::Follows(_) => 3,
        };
        keys.iter().filter_map(|key| self.origins.get(*key)).min_by_key(rank).cloned()
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
            let conflict = Conflict::HigherThanNozzle { key, height, nozzle };
            return Err(blame.error(&[key, "machine.nozzle_diameter"], conflict));
        }
        if width < LEAST_WIDTH * height - SLACK_MM {
            let conflict = Conflict::NarrowLines { width, key, height, least: LEAST_WIDTH };
            return Err(blame.error(&["line_width", key], conflict));
        }
    }
    dual(settings, blame)
}

fn dual(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    for key in ["dual.ratio", "dual.parts"] {
        let given = matches!(blame.origins.get(key), Some(ValueOrigin::Flag(_)));
        if given && settings.dual.mode == DualMode::Off {
            return Err(blame.error(&[key], Conflict::DualIsOff { key }));
        }
    }
    let ratio = settings.dual_ratio();
    let height = settings.layer_height;
    let tall = f64::from(ratio.max(2)) * height;
    let most = settings.max_bead_height();
    if settings.dual.mode == DualMode::Off || ratio >= 2 && tall <= most + SLACK_MM {
        return Ok(());
    }
    let keys = [
        "dual.ratio",
        "layer_height",
        "dual.mode",
        "dual.max_bead_height",
        "machine.nozzle_diameter",
    ];
    Err(blame.error(&keys, Conflict::ThickLinesTooTall { layers: ratio.max(2), height, most }))
}

fn blocks(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    let values = template::values(settings, &PrintFacts::default());
    let machine = &settings.machine;
    for (key, block) in
        [("machine.start_gcode", &machine.start_gcode), ("machine.end_gcode", &machine.end_gcode)]
    {
        let text = template::render(key, block, &values)
            .map_err(|source| ProfileError::Block { origin: blame.origin(&[key]), source })?;
        no_control(key, &text).map_err(|conflict| blame.error(&[key], conflict))?;
        if machine.dialect == DialectName::Makerbot {
            no_host_codes(key, &text).map_err(|conflict| blame.error(&[key], conflict))?;
        }
    }
    let celsius = settings.first_bed_temperature();
    if celsius > 0.0 && !machine.start_gcode.contains("{bed_temperature}") {
        let keys = ["filament.bed_temperature", "machine.start_gcode"];
        return Err(blame.error(&keys, Conflict::BedStaysCold { celsius }));
    }
    let says_relative = ["M83", "{e_mode}"].iter().any(|code| machine.start_gcode.contains(code));
    if machine.relative_e && !says_relative {
        let keys = ["machine.relative_e", "machine.start_gcode"];
        return Err(blame.error(&keys, Conflict::RelativeEUnsaid));
    }
    Ok(())
}

fn no_control(block: &'static str, text: &str) -> Result<(), Conflict> {
    for (index, line) in text.lines().enumerate() {
        if let Some(character) = line.chars().find(|c| c.is_control() && *c != '\t') {
            return Err(Conflict::ControlCharacter { block, line: index + 1, character });
        }
    }
    Ok(())
}

fn no_host_codes(block: &'static str, text: &str) -> Result<(), Conflict> {
    for (index, line) in text.lines().enumerate() {
        let code = line.split([';', '(']).next().and_then(|code| code.split_whitespace().next());
        if let Some(code) = code.filter(|code| NOT_FOR_MAKERBOT.contains(code)) {
            let code = code.to_owned();
            return Err(Conflict::HostCommand { block, line: index + 1, code });
        }
    }
    Ok(())
}
