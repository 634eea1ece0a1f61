//! Settings + origins -> verdict: refuses values that are each in range but cannot print together.
//!
//! - *Heights* fit the nozzle and the lines; thick lines are no taller than allowed.
//! - The nozzle's *reach* holds the whole print volume.
//! - *Blocks* can be filled in, and hold nothing that their dialect takes for something else.
//!
//! An error names the origin of one of the values concerned: that of a flag before that of `--set`,
//! before that of a file. Keys at their defaults are to blame last.

use super::blame::Blame;
use super::error::{Conflict, ProfileError, Result};
use super::origin::ValueOrigin;
use super::skins;
use super::template::{self, PrintFacts};
use super::{BrimPlace, DialectName, DualMode, IroningPlace, Settings};
use std::collections::BTreeMap;

/// Slack for comparing lengths that were written as decimals, mm.
const SLACK_MM: f64 = 1e-9;

/// Lines narrower than this times the layer height do not lie, they stand.
const LEAST_WIDTH: f64 = 0.8;

/// Support on a raft may hang so far above it where its beads cannot fill the gap, mm: it still sticks.
const MOST_OPEN: f64 = 0.1;

/// A nozzle lays no wider lines than so many times its diameter: its flat rim ends there.
const MOST_WIDTH: f64 = 2.5;

/// Codes that GPX turns into host queries, on which a print from an SD card
/// stops for ever, or that it does not know and warns of.
const NOT_FOR_MAKERBOT: &[&str] = &[
    "M1", "M2", "M20", "M21", "M24", "M25", "M27", "M28", "M29", "M92", "M105", "M114", "M115",
    "M117", "M118", "M201", "M203", "M204", "M205",
];

/// Codes by which a file would heat an Ultimaker 2, which heats for the material in it, or would
/// make its E a length.
const NOT_FOR_ULTIGCODE: &[&str] = &["M104", "M109", "M140", "M190", "M200"];

/// Codes with which RepRapFirmware ends a job, heaters off.
const ENDS_RRF: &[&str] = &["M0", "M1", "M2"];

/// Checks what no single key can tell.
///
/// # Errors
/// [`ProfileError::Conflict`] or [`ProfileError::Block`], with the origin of one of the values
/// concerned.
pub(super) fn together(settings: &Settings, origins: &BTreeMap<String, ValueOrigin>) -> Result<()> {
    let blame = Blame { origins };
    infill(settings, &blame)?;
    heights(settings, &blame)?;
    reach(settings, &blame)?;
    arcs(settings, &blame)?;
    brim(settings, &blame)?;
    heat(settings, &blame)?;
    skins::check(settings, &blame)?;
    blocks(settings, &blame)
}

/// A density that was meant as a part of 1.
fn infill(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    let infill = settings.infill;
    if infill > 0.0 && infill < 1.0 {
        return Err(blame.error(&["infill"], Conflict::NextToNothing { infill }));
    }
    Ok(())
}

fn heights(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    let nozzle = settings.machine.nozzle_diameter;
    let (line, raft) = (("line_width", settings.line_width), &settings.raft);
    let first = settings.first_layer_width.map_or(line, |width| ("first_layer_width", width));
    let lines_differ = settings.first_layer_width.is_some();
    let of_raft = [
        ("raft.base_height", raft.base_height, ("raft.base_width", raft.base_width)),
        ("raft.interface_height", raft.interface_height, line),
    ];
    let heights = [
        ("layer_height", settings.layer_height, line),
        ("first_layer_height", settings.first_layer_height, first),
    ];
    let of_raft = of_raft.into_iter().filter(|_| raft.enabled);
    for (key, height, (lines, width)) in heights.into_iter().chain(of_raft) {
        if height > nozzle + SLACK_MM {
            let conflict = Conflict::HigherThanNozzle { key, height, nozzle };
            return Err(blame.error(&[key, "machine.nozzle_diameter"], conflict));
        }
        if width < LEAST_WIDTH * height - SLACK_MM {
            let least = LEAST_WIDTH;
            let conflict = Conflict::NarrowLines { lines, width, key, height, least };
            return Err(blame.error(&[lines, key], conflict));
        }
    }
    let wide = [(first, lines_differ), (("raft.base_width", raft.base_width), raft.enabled)];
    for ((lines, width), _) in wide.into_iter().filter(|(_, counts)| *counts) {
        if width > MOST_WIDTH * nozzle + SLACK_MM {
            let conflict = Conflict::WideLines { lines, width, nozzle, most: MOST_WIDTH };
            return Err(blame.error(&[lines, "machine.nozzle_diameter"], conflict));
        }
    }
    let height = raft.gap + settings.first_layer_height;
    if raft.enabled && settings.support.enabled && height > nozzle + MOST_OPEN {
        let keys = ["raft.gap", "first_layer_height", "support.enabled"];
        return Err(blame.error(&keys, Conflict::TallFirstSupport { height, nozzle }));
    }
    if settings.ironing.place != IroningPlace::Off && !settings.has_top_skins() {
        return Err(blame.error(&["ironing.where", "top_layers"], Conflict::NothingToIron));
    }
    if settings.in_first_width().is_some() && !settings.has_bottom_skins() {
        let keys = ["first_layer_width", "bottom_layers", "bottom_thickness"];
        return Err(blame.error(&keys, Conflict::NoFirstSkin));
    }
    dual(settings, blame)
}

fn reach(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    let (volume, reach) = (settings.machine.volume(), settings.machine.nozzle_reach());
    let keys = [
        ["machine.reach.min_x", "machine.reach.min_y", "machine.reach.min_z"],
        ["machine.reach.max_x", "machine.reach.max_y", "machine.reach.max_z"],
    ];
    for (end, sign) in [(0, -1.0), (1, 1.0)] {
        for axis in 0..3 {
            let (reach, volume) = (reach[end][axis], volume[end][axis]);
            if sign * (reach - volume) < -SLACK_MM {
                let key = keys[end][axis];
                let conflict = Conflict::ReachInsideVolume { key, reach, volume };
                return Err(blame.error(&[key], conflict));
            }
        }
    }
    Ok(())
}

/// Temperatures that the printer bears and its firmware prints at. An Ultimaker 2 is told none.
fn heat(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    let (machine, filament) = (&settings.machine, &settings.filament);
    if machine.dialect == DialectName::Ultigcode {
        return Ok(());
    }
    let nozzle = [machine.min_temperature, machine.max_temperature];
    let nozzle = (nozzle, "machine.min_temperature", "machine.max_temperature");
    let bed = ([0.0, machine.max_bed_temperature], "0", "machine.max_bed_temperature");
    for (key, celsius, ([least, most], low, high)) in [
        ("filament.temperature", Some(filament.temperature), nozzle),
        ("filament.first_layer_temperature", filament.first_layer_temperature, nozzle),
        ("filament.bed_temperature", Some(filament.bed_temperature), bed),
        ("filament.first_layer_bed_temperature", filament.first_layer_bed_temperature, bed),
    ] {
        let Some(celsius) = celsius else { continue };
        if !(least..=most).contains(&celsius) {
            let limit = if celsius < least { low } else { high };
            let conflict = Conflict::NotBorne { key, celsius, limit, least, most };
            return Err(blame.error(&[key, limit], conflict));
        }
    }
    Ok(())
}

/// A brim of a profile gives way to a raft; one that is asked for by its flag is missed.
fn brim(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    let asked = matches!(blame.origins.get("brim.width"), Some(ValueOrigin::Flag(_)));
    if settings.raft.enabled && asked && settings.brim.place != BrimPlace::Off {
        return Err(blame.error(&["brim.width"], Conflict::BrimAndRaft));
    }
    Ok(())
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
    let nozzle = settings.machine.nozzle_diameter;
    let layers = ratio.max(2);
    Err(blame.error(&keys, Conflict::ThickLinesTooTall { layers, height, most, nozzle }))
}

fn arcs(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    let why = match settings.machine.dialect {
        DialectName::Makerbot => "GPX drops G2 and G3, and Sailfish knows no arcs",
        // Ultimaker2Marlin's mc_arc takes angles for their sines, up to 25 times in a row.
        DialectName::Ultigcode => {
            "an Ultimaker 2 turns on small arcs by up to 0.2 mm too far, then jumps back"
        }
        DialectName::Marlin | DialectName::Klipper | DialectName::Reprapfirmware => return Ok(()),
    };
    let keys = ["machine.arcs", "machine.dialect"];
    let refused = || Err(blame.error(&keys, Conflict::NoArcs { why }));
    if settings.machine.arcs { refused() } else { Ok(()) }
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
        let starts = key == "machine.start_gcode";
        let (codes, why) = refused(machine.dialect, starts);
        without(key, &text, codes, why).map_err(|conflict| blame.error(&[key], conflict))?;
    }
    let celsius = settings.first_bed_temperature();
    let heats = machine.dialect != DialectName::Ultigcode;
    if celsius > 0.0 && heats && !machine.start_gcode.contains("{bed_temperature}") {
        let keys = ["filament.bed_temperature", "machine.start_gcode"];
        return Err(blame.error(&keys, Conflict::BedStaysCold { celsius }));
    }
    // The writer says the mode after the block. Before it only the block's own moves need one, and a
    // macro has its own.
    let says_relative = ["M83", "{e_mode}"].iter().any(|code| machine.start_gcode.contains(code));
    if machine.relative_e && !says_relative && machine.start_gcode.lines().any(moves_filament) {
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

/// Whether a line of a block is a move with a word for E.
fn moves_filament(line: &str) -> bool {
    let mut words = line.split([';', '(']).next().unwrap_or_default().split_whitespace();
    matches!(words.next(), Some("G0" | "G1")) && words.any(|word| word.starts_with('E'))
}

/// Codes that a block must not hold in this dialect, and what they would do.
fn refused(dialect: DialectName, starts: bool) -> (&'static [&'static str], &'static str) {
    match dialect {
        DialectName::Makerbot => (
            NOT_FOR_MAKERBOT,
            "a file for GPX, which drops it or makes the printer wait for a host",
        ),
        DialectName::Ultigcode => (
            NOT_FOR_ULTIGCODE,
            "a file for an Ultimaker 2, which is set for its material by itself",
        ),
        DialectName::Reprapfirmware if starts => {
            (ENDS_RRF, "a start block for RepRapFirmware, which ends the job there")
        }
        DialectName::Reprapfirmware | DialectName::Marlin | DialectName::Klipper => (&[], ""),
    }
}

fn without(
    block: &'static str,
    text: &str,
    codes: &[&str],
    why: &'static str,
) -> Result<(), Conflict> {
    for (index, line) in text.lines().enumerate() {
        let code = line.split([';', '(']).next().and_then(|code| code.split_whitespace().next());
        if let Some(code) = code.filter(|code| codes.contains(code)) {
            let code = code.to_owned();
            return Err(Conflict::ForbiddenCode { block, line: index + 1, code, why });
        }
    }
    Ok(())
}
