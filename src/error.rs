//! Errors of the stages -> Error: all ways in which a run can fail, to match on.
//!
//! Each stage has an error type of its own; [`Error`] composes them. The rules of all of them:
//! - A variant for each cause that a program may treat differently, with the numbers that its
//!   message is made of.
//! - The message is one line that names the file or the flag, the cause and what to do. It holds
//!   the text of its causes: print the error alone, not its chain of sources.
//! - The cause, such as the system's error, is the `source()`.
//! - [`details`] gives each a stable word, and the place, for programs.
//! - Wrong command lines are errors of the program, not of the library.

pub mod details;

use crate::profile::ProfileError;
use crate::warning::plural;
use crate::{gcode, mesh, progress, reader, steps};
use std::io;

/// A failure that ends the run. [`Error::exit_code`] gives the exit code of the program.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A profile that cannot be read, or a setting that is unknown or out of range (exit 2).
    /// The text starts with the file and line, or with `--set` or the flag that gave it.
    #[error(transparent)]
    Profile(#[from] ProfileError),

    /// A model cannot be read, mended or placed (exit 3), or a placement makes no sense (exit 2).
    #[error(transparent)]
    Mesh(#[from] mesh::Error),

    /// A G-code file that cannot be read or prints nothing (exit 3).
    #[error(transparent)]
    Reader(#[from] reader::Error),

    /// A stream of steps that cannot be played, or G-code that none can be made of (exit 3).
    #[error(transparent)]
    Steps(#[from] steps::Error),

    /// A stream that could not be sent to a board, or not to its end (exit 3 if the board refuses it, else 4).
    #[error(transparent)]
    Send(#[from] steps::send::Error),

    /// The models can be read but not be printed (exit 3).
    #[error(transparent)]
    Refused(#[from] Refusal),

    /// The run was told to stop: see [`Progress::cancel`](crate::progress::Progress::cancel).
    #[error("the run was cancelled")]
    Cancelled,

    /// The output cannot be written (exit 4), or a start or end block not be filled in (exit 2).
    #[error(transparent)]
    Gcode(#[from] gcode::Error),

    /// The thumbnails cannot be drawn (exit 4).
    #[error("cannot draw the thumbnails: {0}")]
    Thumbnails(#[source] io::Error),
}

impl Error {
    /// The documented process exit code: 2 usage or configuration, 3 input, 4 output; 130, as of
    /// an interrupted program, if the run was cancelled.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Profile(_) | Self::Gcode(gcode::Error::Block(_)) => 2,
            Self::Mesh(error) if error.is_usage() => 2,
            Self::Mesh(_) | Self::Reader(_) | Self::Steps(_) | Self::Refused(_) => 3,
            Self::Send(error) => error.exit_code(),
            Self::Gcode(_) | Self::Thumbnails(_) => 4,
            Self::Cancelled => 130,
        }
    }
}

/// A contour that is open by more than this, mm, is refused unless the mesh is to be sliced as
/// it is. A straight line across a longer gap would be a guess that shows on the print; one
/// across a shorter gap is about as long as the lines are wide.
pub const MOST_GAP_MM: f64 = 2.0;

/// A body that begins no higher than this, mm, may be set down by cutting off the bottom of all. More
/// would spoil the others.
const MOST_SINK_MM: f64 = 1.0;

/// Why a model that can be read is not printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The models are lower than half a layer.
    #[error(
        "nothing to print: {height_mm:.3} mm is less than half a layer high; use thinner layers, \
         --scale or --unit"
    )]
    TooLow {
        /// Height of the highest model, mm.
        height_mm: f64,
    },
    /// A model is smaller than the machine prints.
    #[error(
        "{file}: the model is {:.2} × {:.2} × {:.2} mm, and the machine prints nothing with a side below \
         {least_mm} mm (machine.min_part_size); use a larger --scale or another --unit",
        .size_mm[0], .size_mm[1], .size_mm[2]
    )]
    TooSmall {
        /// The model's file.
        file: String,
        /// Its size as placed, mm.
        size_mm: [f64; 3],
        /// The least of each side, mm.
        least_mm: f64,
    },
    /// The last layer, with the nozzle lifted above it, ends above the machine's height.
    #[error(
        "the print would end at {top_mm:.2} mm{}{}, where the machine ends at {height_mm} mm; use \
         another --layer-height, a smaller --scale{}{}",
        if *.raft_mm > 0.0 { format!(" on {} mm of raft", .raft_mm) } else { String::new() },
        if *.hop_mm > 0.0 { format!(" with the nozzle lifted by {} mm", .hop_mm) } else { String::new() },
        if *.raft_mm > 0.0 { ", no --raft" } else { "" },
        if *.hop_mm > 0.0 { " or a smaller retraction.z_hop" } else { "" }
    )]
    TooTall {
        /// Top of the last layer and the lift above it, mm.
        top_mm: f64,
        /// How far the nozzle is lifted above the last layer, mm.
        hop_mm: f64,
        /// How far a raft lifts the part, mm.
        raft_mm: f64,
        /// Height of the machine, mm.
        height_mm: f64,
    },
    /// Contours are open by more than [`MOST_GAP_MM`].
    #[error(
        "{}: the mesh cannot be mended: contours are open on {}, most on layer {layer} by \
         {gap_mm:.1} mm; mend the model, or slice it as it is with --mesh warn",
        .models.join(", "),
        plural(*.layers as u64, "layer")
    )]
    Open {
        /// Names of the models.
        models: Vec<String>,
        /// Number of layers with open contours.
        layers: usize,
        /// Layer with the longest gap, counted from 1.
        layer: usize,
        /// The longest gap, mm.
        gap_mm: f64,
    },
    /// No line fits anywhere.
    #[error(
        "nothing to print: everything is too thin for a line of {line_width_mm} mm; use a smaller \
         --line-width, a larger --scale or another --unit"
    )]
    TooThin {
        /// Width of a line, mm.
        line_width_mm: f64,
    },
    /// The first layer lies where the start block primes the nozzle.
    #[error(
        "the start block primes the nozzle at x {:.1} y {:.1}, where the first layer lies; move the \
         models with --at X,Y, use fewer --copies or a smaller --scale, or change machine.start_gcode",
        .at_mm[0], .at_mm[1]
    )]
    Primed {
        /// Place in the machine's coordinates, mm.
        at_mm: [f64; 2],
    },
    /// Skirt, brim or raft reach beyond the bed.
    #[error(
        "the {what} would reach {} beyond the bed; use a smaller {}, another place (--at) or a \
         smaller --scale",
        sides(*.over_mm),
        match *.what {
            "brim" => "brim, fewer --copies",
            "raft" => "raft.margin, fewer --copies",
            _ => "skirt, skirt.distance",
        }
    )]
    BesideBed {
        /// Which of them.
        what: &'static str,
        /// How far they reach beyond the left and right, then the front and back; 0 where they do
        /// not.
        over_mm: [[f64; 2]; 2],
    },
    /// The print would begin in the air.
    #[error("{0}")]
    Hanging(Hanging),
}

/// What of a print hangs in the air, judged on what would be printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Hanging {
    /// Nothing is printed on some layers, but on others above them.
    #[error(
        "nothing is printed on {}, so that what is above would hang {gap_mm:.2} mm over the {}: the \
         part is missing or too thin there; {}{}",
        layers(*.from, *.until),
        if *.from_bed { "bed" } else { "layer below" },
        carried(*.kept_away),
        if *.from_bed { format!(", or cut off the bottom with --sink {gap_mm:.2}") } else { String::new() }
    )]
    EmptyLayers {
        /// The first of these layers, counted from 1.
        from: usize,
        /// The last of them.
        until: usize,
        /// Their height, mm.
        gap_mm: f64,
        /// They lie on the bed.
        from_bed: bool,
        /// Support is asked for, but this setting keeps it away.
        kept_away: Option<&'static str>,
    },
    /// A whole body stands on nothing.
    #[error(
        "a body begins in the air on layer {layer}, {above_bed_mm:.2} mm above the bed at x {:.1} y \
         {:.1}, and stands on nothing: {}{}",
        .at_mm[0], .at_mm[1],
        carried(*.kept_away),
        if *.above_bed_mm > MOST_SINK_MM { String::new() } else {
            format!(", or cut off the bottom with --sink {above_bed_mm:.2}")
        }
    )]
    Body {
        /// The layer, counted from 1.
        layer: usize,
        /// Top of the layer, mm.
        z_mm: f64,
        /// Bottom of the layer, mm.
        above_bed_mm: f64,
        /// Place in the machine's coordinates, mm.
        at_mm: [f64; 2],
        /// Support is asked for, but this setting keeps it away.
        kept_away: Option<&'static str>,
    },
    /// Islands begin in the air that meet the part further up.
    #[error(
        "{length_mm:.0} mm of lines begin in the air at {}, first on layer {layer} at {z_mm:.2} mm, x \
         {:.1} y {:.1}: {}, or turn the part with --rotate",
        plural(*.places as u64, "place"), .at_mm[0], .at_mm[1], carried(*.kept_away)
    )]
    Places {
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
        kept_away: Option<&'static str>,
    },
}

/// Such as `2 mm at the left and 0.5 mm at the back`.
fn sides(over_mm: [[f64; 2]; 2]) -> String {
    let names = ["the left", "the right", "the front", "the back"];
    let over = over_mm.into_iter().flatten().zip(names).filter(|(over, _)| *over > 0.0);
    // Rounded up, so that moving by it is enough.
    let side =
        |(over, name): (f64, &str)| format!("{} mm at {name}", (over * 100.0).ceil() / 100.0);
    over.map(side).collect::<Vec<_>>().join(" and ")
}

/// How what hangs may be carried, where this setting keeps support away.
fn carried(kept_away: Option<&'static str>) -> String {
    match kept_away {
        None => "print with --support".to_owned(),
        Some(key) => format!("{key} keeps support away there; set another"),
    }
}

/// Such as `layer 3` or `layers 3 to 5`.
fn layers(from: usize, until: usize) -> String {
    if from == until { format!("layer {from}") } else { format!("layers {from} to {until}") }
}

impl From<progress::Cancelled> for Error {
    fn from(_: progress::Cancelled) -> Self {
        Self::Cancelled
    }
}

/// The result of everything that can fail with an [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;
