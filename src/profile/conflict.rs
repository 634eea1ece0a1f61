//! Values that each fit their keys, but that do not go together: what is wrong, and what to do.
//!
//! Each displays as one line without its place, which [`ProfileError`](super::ProfileError) puts before it:
//!
//! - The line begins with the key and its value, then says what it does not go with.
//! - After a semicolon stands the remedy: which key to change, or what to leave out.
//! - Lengths are in mm, angles in degrees, temperatures in °C.
//!
//! `check.rs` and `skins.rs` find them. `error/details.rs` says which keys a report names for them.

/// Values that are each in range but cannot print together. Lengths in mm.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Conflict {
    /// Infill so thin that its density was meant as a part of 1.
    #[error(
        "infill = {infill} % is next to nothing: it counts in %, where 20 is a fifth; write {} for that part, 0 \
         for none, or at least 1",
        (100.0 * infill).round().max(1.0)
    )]
    NextToNothing {
        /// The density, %.
        infill: f64,
    },
    /// Layers that are higher than the nozzle is wide.
    #[error(
        "{key} = {height} mm is more than machine.nozzle_diameter = {nozzle} mm; use thinner \
         layers or a larger nozzle"
    )]
    HigherThanNozzle {
        /// Which height.
        key: &'static str,
        /// The height.
        height: f64,
        /// The nozzle's diameter.
        nozzle: f64,
    },
    /// Lines that would stand instead of lie.
    #[error(
        "{lines} = {width} mm is too little for {key} = {height} mm; use at least {least} times \
         the height"
    )]
    NarrowLines {
        /// Which width.
        lines: &'static str,
        /// The lines' width.
        width: f64,
        /// Which height.
        key: &'static str,
        /// The height.
        height: f64,
        /// Least width for each mm of height.
        least: f64,
    },
    /// Lines wider than a nozzle lays them.
    #[error(
        "{lines} = {width} mm is more than {most} times machine.nozzle_diameter = {nozzle} mm; no \
         nozzle lays such lines"
    )]
    WideLines {
        /// Which width.
        lines: &'static str,
        /// The lines' width.
        width: f64,
        /// The nozzle's diameter.
        nozzle: f64,
        /// Greatest width for each mm of nozzle.
        most: f64,
    },
    /// Support whose first beads cannot fill the gap above the raft.
    #[error(
        "support stands on the raft: its first lines would have to be {height:.2} mm high, raft.gap \
         and first_layer_height together, for machine.nozzle_diameter = {nozzle} mm; make one of the \
         two smaller"
    )]
    TallFirstSupport {
        /// Height of those lines, mm.
        height: f64,
        /// The nozzle's diameter.
        nozzle: f64,
    },
    /// Ironing without a top.
    #[error(
        "ironing goes over tops, and there are none without a skin at the top; leave it out, or set \
         top_layers = 1"
    )]
    NothingToIron,
    /// Skins that follow the surface, without a top.
    #[error(
        "nonplanar.enabled lets tops follow the surface, and there are none without a skin at the top; leave it \
         out, or set top_layers = 1"
    )]
    NothingToFollow,
    /// Lines that fall within their layer, to more than its height.
    #[error(
        "nonplanar.min_height = {least} mm is more than layer_height = {height} mm; make it smaller, or set \
         nonplanar.contour = false"
    )]
    ContourTooHigh {
        /// Least height of a line, mm.
        least: f64,
        /// Height of a layer, mm.
        height: f64,
    },
    /// Slopes that are too steep for skins before they are steep enough.
    #[error(
        "nonplanar.min_slope = {least} degrees is more than the {most:.1} degrees that {by}; make it smaller, \
         or {remedy}"
    )]
    NoSlope {
        /// The least slope, degrees.
        least: f64,
        /// The steepest one that skins can follow, degrees.
        most: f64,
        /// What limits it.
        by: &'static str,
        /// What else would help.
        remedy: &'static str,
    },
    /// A part of the head that there cannot be.
    #[error("{key}, number {number} of them: {why}")]
    NoSuchPart {
        /// The key of the list.
        key: &'static str,
        /// Which one of it, from 1.
        number: usize,
        /// What is wrong with it.
        why: &'static str,
    },
    /// Wide lines for a first layer without a skin.
    #[error(
        "first_layer_width widens the skin at the bottom, and there is none; leave it out, or set \
         bottom_layers = 1"
    )]
    NoFirstSkin,
    /// A nozzle that does not get to every place of the print volume.
    #[error(
        "{key} = {reach} mm lies inside the print volume, which ends at {volume} mm; let the nozzle \
         reach all of it, or make machine.bed_width, bed_depth or bed_height smaller"
    )]
    ReachInsideVolume {
        /// Which end of the reach.
        key: &'static str,
        /// Where it is, mm.
        reach: f64,
        /// Where the print volume ends, mm.
        volume: f64,
    },
    /// Steps are asked for of a machine that takes none.
    #[error(
        "{key} is not set: for this printer no steps can be made; set steps.x, y, z and e (steps for \
         a mm), or choose a printer that has [steps] with -p"
    )]
    NoSteps {
        /// The key that is missing.
        key: &'static str,
    },
    /// A brim is asked for by its flag, and a raft.
    #[error("has no effect with a raft, which takes the place of a brim; leave one of them out")]
    BrimAndRaft,
    /// A flag of dual injection without dual injection.
    #[error("has no effect while dual.mode is off; add --dual")]
    DualIsOff {
        /// The key that has no effect.
        key: &'static str,
    },
    /// Thick lines that are higher than allowed.
    #[error(
        "{layers} layers of layer_height = {height} mm make thick lines {} mm tall, above the {} mm that \
         dual.max_bead_height allows; {}",
        short(f64::from(*layers) * height),
        short(*most),
        thinner(*layers, *height, *most, *nozzle)
    )]
    ThickLinesTooTall {
        /// Layers printed at once.
        layers: u32,
        /// The layers' height.
        height: f64,
        /// Height of a thick line, at most.
        most: f64,
        /// Diameter of the nozzle.
        nozzle: f64,
    },
    /// A temperature that the printer does not bear, or does not print at.
    #[error(
        "{key} = {celsius} °C, but this printer takes {least} to {most} °C; set another, or {limit} if \
         it takes more or less"
    )]
    NotBorne {
        /// The key of the temperature.
        key: &'static str,
        /// The temperature.
        celsius: f64,
        /// The key of the limit that it passes.
        limit: &'static str,
        /// The coldest that the printer takes, °C.
        least: f64,
        /// The hottest that it takes, °C.
        most: f64,
    },
    /// A bed temperature that nothing asks the printer for.
    #[error(
        "filament.bed_temperature = {celsius} °C would have no effect: machine.start_gcode does \
         not contain {{bed_temperature}}; put it there, or set 0"
    )]
    BedStaysCold {
        /// The temperature.
        celsius: f64,
    },
    /// A start block that pushes filament without saying how E counts.
    #[error(
        "machine.relative_e = true, but machine.start_gcode moves E and contains neither M83 nor \
         {{e_mode}}; put {{e_mode}} on a line of its own before that"
    )]
    RelativeEUnsaid,
    /// Arcs for printers that have none, or bad ones.
    #[error("machine.arcs = true, but {why}; set machine.arcs = false")]
    NoArcs {
        /// What would become of them.
        why: &'static str,
    },
    /// A character that printers may take for anything, and terminals obey.
    #[error("{block}, line {line} of it: there is a control character ({character:?}); remove it")]
    ControlCharacter {
        /// The block's key.
        block: &'static str,
        /// Line, from 1.
        line: usize,
        /// The character.
        character: char,
    },
    /// A command that the dialect cannot have in this block.
    #[error("{block}, line {line} of it: {code} must not be in {why}; remove the line")]
    ForbiddenCode {
        /// The block's key.
        block: &'static str,
        /// Line, from 1.
        line: usize,
        /// The command.
        code: String,
        /// In what, and what it would do there.
        why: &'static str,
    },
}

/// Thousandths, without zeros at the end.
fn short(mm: f64) -> f64 {
    (mm * 1000.0).round() / 1000.0
}

/// What makes thick lines lower, or lets them be as tall; lengths in mm. The least is two layers at once, and
/// no line should be taller than the nozzle is wide.
fn thinner(layers: u32, height: f64, most: f64, nozzle: f64) -> String {
    let layer = (most / f64::from(layers) * 1000.0 + 1e-6).floor() / 1000.0;
    let mut ways = vec![format!("use layer_height = {layer} mm or less")];
    if layers > 2 {
        ways.push("a lower dual.ratio".to_owned());
    }
    let tall = f64::from(layers) * height;
    if tall <= nozzle + 1e-9 {
        let percent = (tall / nozzle * 100.0 - 1e-6).ceil();
        ways.push(format!("dual.max_bead_height = {percent} % of the nozzle"));
    }
    format!("{}, or dual.mode = \"off\", without --dual", ways.join(", "))
}
