//! Faults -> counts and places: names what is wrong with a mesh and what was done about it, for the report.

use crate::warning::plural;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// Places in the report for each kind of fault, at most: enough to find the faults in an editor.
pub const MOST_PLACES: usize = 8;

/// What is wrong with a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Fault {
    /// Triangles with two equal corners, or with three on one line.
    Degenerate,
    /// Triangles over the same three corners as another.
    Duplicate,
    /// Edges of a single triangle.
    OpenEdge,
    /// Edges of more than two triangles.
    CrowdedEdge,
    /// Edges whose two triangles are wound against each other.
    FlippedEdge,
    /// Corners in the middle of another triangle's edge.
    TJunction,
    /// Openings in the surface, each with one closed rim.
    Hole,
    /// Missing strips all around the surface, each between two rims.
    Gap,
    /// Surfaces that enclose nothing.
    Sheet,
    /// Closed surfaces turned inside out.
    InvertedShell,
    /// Triangles whose stored normal contradicts their winding, which counts.
    WrongNormal,
    /// Pairs of triangles that pass through each other.
    Crossing,
    /// Bodies that lie wholly within another, and vanish in it.
    NestedShell,
    /// Corners that stick out like needles.
    Spike,
}

impl Fault {
    /// The name of one of them, and of several.
    fn names(self) -> [&'static str; 2] {
        match self {
            Self::Degenerate => ["triangle without area", "triangles without area"],
            Self::Duplicate => ["copy of a triangle", "copies of triangles"],
            Self::OpenEdge => ["open edge", "open edges"],
            Self::CrowdedEdge => {
                ["edge of more than two triangles", "edges of more than two triangles"]
            }
            Self::FlippedEdge => [
                "edge of two triangles wound against each other",
                "edges of two triangles wound against each other",
            ],
            Self::TJunction => {
                ["corner on another triangle's edge", "corners on other triangles' edges"]
            }
            Self::Hole => ["hole", "holes"],
            Self::Gap => ["gap between two rims", "gaps between two rims"],
            Self::Sheet => ["triangle that encloses nothing", "triangles that enclose nothing"],
            Self::InvertedShell => ["shell turned inside out", "shells turned inside out"],
            Self::WrongNormal => ["wrong normal", "wrong normals"],
            Self::Crossing => ["pair of triangles that cross", "pairs of triangles that cross"],
            Self::NestedShell => ["body within another", "bodies within others"],
            Self::Spike => ["spike", "spikes"],
        }
    }

    /// The name of one of them.
    #[must_use]
    pub fn one(self) -> &'static str {
        self.names()[0]
    }
}

/// What was done to a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Mending {
    /// Corners moved onto another one nearby.
    Welded,
    /// Triangles without area dropped.
    DroppedDegenerate,
    /// Copies of triangles dropped.
    DroppedDuplicate,
    /// Triangles split at corners that lie on their edges.
    SplitTJunction,
    /// Triangles turned, so that they are wound like their neighbours.
    Turned,
    /// Holes closed by new triangles.
    FilledHole,
    /// Gaps between two rims closed by a band of new triangles.
    Bridged,
    /// Triangles of surfaces that enclose nothing dropped.
    DroppedSheet,
    /// Closed surfaces turned, so that they face outward.
    TurnedShell,
}

impl Mending {
    /// The words for what was done, and to what.
    fn deed(self) -> (&'static str, &'static str) {
        match self {
            Self::Welded => ("welded", "corner"),
            Self::DroppedDegenerate => ("dropped without area", "triangle"),
            Self::DroppedDuplicate => ("dropped as copies", "triangle"),
            Self::SplitTJunction => ("split at corners on their edges", "triangle"),
            Self::Turned => ("turned like their neighbours", "triangle"),
            Self::FilledHole => ("filled", "hole"),
            Self::Bridged => ("joined across", "gap"),
            Self::DroppedSheet => ("dropped since they enclose nothing", "triangle"),
            Self::TurnedShell => ("turned outside out", "shell"),
        }
    }

    /// Whether it guesses what was meant, and so can be wrong; the rest changes no surface.
    fn is_guess(self) -> bool {
        matches!(self, Self::FilledHole | Self::Bridged | Self::DroppedSheet)
    }
}

/// How many of a kind, and where the first of them are.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Counted<K> {
    /// The kind.
    pub kind: K,
    /// How many.
    pub count: usize,
    /// The size of the largest, or the distance that the furthest was moved, mm; 0 where that
    /// means nothing.
    pub largest_mm: f64,
    /// Where the first [`MOST_PLACES`] are, in the file's own coordinates and unit.
    pub places: Vec<[f64; 3]>,
}

impl fmt::Display for Counted<Fault> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.kind.names()[usize::from(self.count != 1)];
        write!(f, "{} {name}", self.count)?;
        size(f, self.largest_mm)
    }
}

impl fmt::Display for Counted<Mending> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (deed, thing) = self.kind.deed();
        write!(f, "{} {deed}", plural(self.count as u64, thing))?;
        size(f, self.largest_mm)
    }
}

fn size(f: &mut fmt::Formatter<'_>, largest_mm: f64) -> fmt::Result {
    if largest_mm > 0.0 { write!(f, " (up to {largest_mm:.3} mm)") } else { Ok(()) }
}

/// Formats a list, with the place of its first item; `None` if it is empty.
fn listed<K: Copy>(list: &[&Counted<K>]) -> Option<String>
where
    Counted<K>: fmt::Display,
{
    let first = list.first()?;
    let words: Vec<String> = list.iter().map(ToString::to_string).collect();
    let place = first.places.first();
    let place =
        place.map_or_else(String::new, |&place| format!(", the first at {}", place_text(place)));
    Some(words.join(", ") + &place)
}

/// Formats a place, to a thousandth of the file's unit.
#[must_use]
pub fn place_text(place: [f64; 3]) -> String {
    // Adding zero turns -0 into 0.
    let rounded = place.map(|side| ((side * 1e3).round() / 1e3 + 0.0).to_string());
    rounded.join(", ")
}

/// Formats the mending that guesses what was meant.
#[must_use]
pub fn guessed(mended: &[Counted<Mending>]) -> Option<String> {
    listed(&mended.iter().filter(|one| one.kind.is_guess()).collect::<Vec<_>>())
}

/// Formats the mending that changes no surface.
#[must_use]
pub fn tidied(mended: &[Counted<Mending>]) -> Option<String> {
    listed(&mended.iter().filter(|one| !one.kind.is_guess()).collect::<Vec<_>>())
}

/// Formats the faults that leave layers open.
#[must_use]
pub fn open(left: &[Counted<Fault>]) -> Option<String> {
    let is_open =
        |fault: &&Counted<Fault>| matches!(fault.kind, Fault::OpenEdge | Fault::FlippedEdge);
    listed(&left.iter().filter(is_open).collect::<Vec<_>>())
}
