//! G-code bytes -> events in their order: moves, waits, layers, and what changes a machine's limits.
//!
//! The reader accepts the output of any slicer. No content of a file is an error: a line that it does
//! not know is counted. It shares no code with what slices, plans and writes, so that `check` can
//! rely on it as an independent witness.

mod change;
mod drive;
mod error;
mod facts;
mod firmware;
mod heat;
mod height;
mod known;
mod layers;
mod limit;
mod lines;
mod marks;
mod missing;
mod pieces;
mod places;
mod priming;
pub mod print;
mod recognise;
mod retraction;
mod role;
mod source;
mod spiral;
mod state;
mod step;
pub mod stream;
mod told;
mod words;

pub use change::Change;
pub use error::{Cause, Error};
pub use facts::{Facts, Patch};
pub use firmware::{Firmware, OwnFilament};
pub use heat::{Heater, Heating};
pub(crate) use height::Heights;
pub use limit::{DEFAULT_MAX_MOVES, Limited, TooLong};
pub use print::Print;
pub use recognise::Reading;
pub use role::Role;
pub use source::Source;
pub use stream::Stream;
pub use told::{Limit, LongWait, Told};

use crate::units::MmPerS;
use std::io::{self, BufRead};

/// A piece of a G-code file.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// A straight move.
    Move(Motion),
    /// G4: the printer stands still for this many seconds.
    Dwell(f64),
    /// The moves so far end before anything else happens.
    Wait(Wait),
    /// A layer begins.
    Layer {
        /// Whether a comment marks it; otherwise it is found from the heights of lines.
        marked: bool,
        /// Height of the level lines that it was found by, mm.
        z: Option<f64>,
    },
    /// A patch of non-planar skin begins, with its number, or one ends.
    Patch(Option<u32>),
    /// The machine's limits change.
    Change(Change),
    /// A heater is set, or waited for.
    Heating(Heating),
    /// G10 and G11: the filament is pulled back, or pushed out again, by the printer's own length.
    FirmwareRetraction {
        /// Whether it is pulled back.
        back: bool,
    },
    /// A command other than a move.
    Command {
        /// `G`, `M` or `T`, mostly.
        letter: u8,
        /// What follows the letter, without its fraction.
        number: u32,
        /// The whole line of code.
        code: Vec<u8>,
    },
    /// A word of a command has no number where it needs one, so that it does nothing.
    NoNumber {
        /// The word's letter.
        letter: u8,
        /// The whole line of code.
        code: Vec<u8>,
    },
    /// A comment without a mark, and without its `;`.
    Comment(Vec<u8>),
    /// A line of code that the reader does not know.
    Unknown(Vec<u8>),
}

/// Why the printer waits for an unknown time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wait {
    /// Until something is hot.
    Heating,
    /// While it looks for its end stops.
    Homing,
    /// Until its user, or what it was told to wait for, says so: a pause, or another filament.
    User,
    /// Only until the moves so far have ended.
    Moves,
}

/// A straight move as the file has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Where the nozzle is before it, mm.
    pub from: [f64; 3],
    /// Where the nozzle is after it, mm.
    pub to: [f64; 3],
    /// Filament pushed out, mm; below 0 it is pulled back.
    pub filament: f64,
    /// Feed asked for.
    pub feed: MmPerS,
    /// What it prints, if anything.
    pub role: Role,
    /// Width of the line by the file's comments, mm.
    pub width: Option<f64>,
    /// Height of the line by the file's comments, mm.
    pub height: Option<f64>,
}

/// What was read besides the events.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Summary {
    /// Lines in all.
    pub lines: u64,
    /// Lines of code that the reader does not know.
    pub unknown: u64,
    /// The first of them, from 1; 0 if there is none.
    pub first_unknown: u64,
    /// Lines with a word that has no number where it needs one.
    pub numberless: u64,
    /// Retractions by the printer's own settings (G10, G11), whose length is not in the file.
    pub firmware_retractions: u64,
    /// Cross-section of the filament by which volumes of E were taken for lengths, mm²; 0 where E is
    /// a length. The printer of such a file (`;FLAVOR:UltiGCode`) heats by itself.
    pub volumes_by: f64,
    /// Arcs that would have needed more pieces than a file of this length may ask for, and were read
    /// coarser, or with fewer turns.
    pub coarse_arcs: u64,
    /// The line of the first of them, from 1; 0 if there is none.
    pub first_coarse_arc: u64,
    /// By whose rules it was read.
    pub firmware: Firmware,
}

/// Hands each line to `sink` as it is, as [`read()`] counts them.
///
/// # Errors
/// What reading the bytes gives.
pub(crate) fn lines(source: &mut dyn BufRead, sink: &mut dyn FnMut(&[u8])) -> io::Result<()> {
    lines::each(source, lines::Place::default(), &mut |line, _| sink(line)).map(drop)
}

/// Reads G-code by a firmware's rules and hands each event to `sink` with its line, counted from 1, in
/// the file's order. [`Reading::of`] tells which firmware a file is for.
///
/// # Errors
/// Only what reading the bytes gives: no content is an error.
pub fn read(
    source: &mut dyn BufRead,
    reading: impl Into<Reading>,
    sink: &mut dyn FnMut(u64, Event),
) -> io::Result<Summary> {
    read_from(source, reading, [0.0; 3], sink)
}

/// As [`read`], of a machine whose nozzle is at `start` when the file begins, mm.
///
/// # Errors
/// As [`read`].
pub fn read_from(
    source: &mut dyn BufRead,
    reading: impl Into<Reading>,
    start: [f64; 3],
    sink: &mut dyn FnMut(u64, Event),
) -> io::Result<Summary> {
    let mut state = state::State::new(reading.into());
    state.places.at = start.map(Some);
    let mut layers = layers::Layers::default();
    let mut number = 0;
    lines::each(source, lines::Place::default(), &mut |line, _| {
        number += 1;
        state.line(line, &mut |event| layers.event(number, event, sink));
    })?;
    layers.finish(sink);
    Ok(state.summary)
}
