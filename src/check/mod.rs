//! Print + Terms + model -> Verdict: an independent witness of what a G-code file prints.
//!
//! It reads the finished text and shares no code with what slices, plans or writes, so that it does
//! not repeat their faults. What it does share decides nothing there: the mesh as it was read, the
//! head and the settings of a profile, and of [`geom`](crate::geom) distances to segments, sorting into
//! cells, booleans of spans and union-find, which have laws of their own. It works on any slicer's files; what a file gives no means to judge is
//! listed as not judged.
//!
//! - A *finding* is one thing that is wrong, with a place, a measure and a severity: errors fail the
//!   check, warnings do not.
//! - A *witness* is a file here that looks for a few kinds of findings. Each gets the moves of the
//!   print, and some the model, and returns what it found.
//! - *Terms* are what the file or a profile says of the machine and the beads.
//! - The *verdict* is all findings, sorted, and what was measured on the way.
//!
//! Layers are judged as they come, some side by side, so that a file need not be held (`judge`). How
//! lines lie on each other is worked out between those that are near (`laid`); what they fill is drawn on
//! rows of spans. A thick bead fills the layers below it too.

mod asked;
mod beads;
mod belongs;
mod capsule;
mod filled;
pub mod finding;
mod judge;
mod model;
mod moves;
mod rows;
mod samples;
mod slopes;
mod stack;
mod standing;
mod survey;
pub mod terms;
mod window;

use crate::mesh::Mesh;
use crate::reader::{Print, Stream};
use finding::{Count, Finding};
use schemars::JsonSchema;
use serde::Serialize;
use std::io;
use terms::Terms;

/// Version of the JSON schema; raised when a field changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// What was meant to be printed.
#[derive(Debug, Clone, Copy)]
pub struct Model<'a> {
    /// As it lies on the bed, but for `offset`.
    pub mesh: &'a Mesh,
    /// Where its middle is expected, in the machine's coordinates, mm. A file may have it elsewhere.
    pub offset: [f64; 2],
}

/// The report on a file.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Verdict {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Layers of the file.
    pub layers: usize,
    /// Moves of the file.
    pub moves: usize,
    /// What is wrong: by kind, errors and the largest of each first, at most [`finding::MOST_LISTED`] of each.
    pub findings: Vec<Finding>,
    /// How many findings there are of each kind.
    pub counts: Vec<Count>,
    /// What could not be judged, and why.
    pub not_judged: Vec<String>,
    /// What was measured on the way.
    pub measures: Measures,
}

/// What was measured on the way; `None` where the model is needed and not given.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct Measures {
    /// Plastic of all lines of the layers, mm³.
    pub plastic_mm3: f64,
    /// Longest stretch of a line that only its ends carry, mm.
    pub longest_bridge_mm: f64,
    /// Longest end of a line with nothing below that only the line itself and its neighbours hold, mm.
    pub longest_end_mm: f64,
    /// Length of lines in the air where the part itself has nothing below, mm.
    pub part_hangs_mm: f64,
    /// Volume of the model's cuts, mm³.
    pub part_mm3: Option<f64>,
    /// What of the printable outline is printed, part of 1.
    pub outline: Option<f64>,
    /// What of the printable top and bottom surfaces is closed, part of 1.
    pub surface: Option<f64>,
    /// Plastic of walls and skins for the room that they cover.
    pub solid: Option<f64>,
    /// Density of the sparse infill away from walls and skins, part of 1.
    pub infill: Option<f64>,
}

impl Verdict {
    /// Whether something is wrong that is more than a weak place.
    #[must_use]
    pub fn fails(&self) -> bool {
        self.counts.iter().any(|count| count.errors > 0)
    }

    /// How many findings are no more than a weak place.
    #[must_use]
    pub fn warnings(&self) -> usize {
        self.counts.iter().map(|count| count.count - count.errors).sum()
    }
}

/// Judges a file. `model` is what it was made from, if that is known.
#[must_use]
pub fn check(print: &Print, terms: &Terms, model: Option<Model<'_>>) -> Verdict {
    let Ok(verdict) = judge::judge(&print.facts, &|| window::of_print(print), terms, model);
    verdict
}

/// Judges a file that is read layer by layer: only some layers of it are held at a time.
///
/// # Errors
/// What reading gives, and that the file is not the same any more.
pub fn check_stream(
    stream: &Stream,
    terms: &Terms,
    model: Option<Model<'_>>,
) -> io::Result<Verdict> {
    if let Some(print) = stream.whole() {
        return Ok(check(print, terms, model));
    }
    let pages = || -> window::Pages<'_, io::Error> {
        Box::new(stream.sections().map(|section| section.map(window::Page::from)))
    };
    judge::judge(stream.facts(), &pages, terms, model)
}

/// The middle one of some values by their order; `None` of none.
fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (middle < values.len()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
