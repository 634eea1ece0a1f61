//! What became of a layer's lines: which of them are arcs and patches, what was joined or slowed down,
//! and what holds slopes down.

use crate::units::Thousandths;
use std::ops::Range;

/// Moves that are written as one arc: the straight pieces that the printer drives of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArcRun {
    /// Which of the layer's moves.
    pub pieces: Range<usize>,
    /// How many lines it stands for.
    pub lines: usize,
    /// From where it begins to the middle of its circle, thousandths of a mm.
    pub to_middle: [Thousandths; 2],
    /// Whether it turns right.
    pub clockwise: bool,
}

/// The paths of a patch of non-planar skin that follow each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PatchRun {
    /// Number of the patch.
    pub patch: u32,
    /// Which of the layer's paths.
    pub paths: Range<usize>,
}

/// The arcs of a layer or of a print.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Arced {
    /// How many.
    pub arcs: usize,
    /// Lines that they stand for.
    pub lines: usize,
}

/// What was done about lines shorter than the printer can be fed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Short {
    /// Lines that were joined with the next.
    pub joined: usize,
    /// Lines that were slowed down.
    pub slowed: usize,
    /// What these take longer by at full speed, s.
    pub lost: f64,
}

impl Short {
    /// Adds another layer's.
    pub fn add(&mut self, other: &Self) {
        self.joined += other.joined;
        self.slowed += other.slowed;
        self.lost += other.lost;
    }
}

/// What holds the feed of a line on a slope down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    /// Nothing but the speed that is asked for.
    Speed,
    /// What the hot end can melt.
    Flow,
    /// The highest speed of z.
    ZSpeed,
    /// The acceleration of z: the slope changes.
    ZAcceleration,
    /// The sudden change of the speed of z between two lines.
    ZJerk,
}

impl Bound {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 5] =
        [Self::Speed, Self::Flow, Self::ZSpeed, Self::ZAcceleration, Self::ZJerk];
}

/// What holds the feeds of lines down that rise and fall, by their length, mm.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SlopeFeeds([f64; Bound::ALL.len()]);

impl SlopeFeeds {
    /// The length of lines that this holds down, mm.
    #[must_use]
    pub fn of(&self, bound: Bound) -> f64 {
        self.0[bound as usize]
    }

    /// The length of all lines, mm.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.0.iter().sum()
    }

    /// Adds a line that is so long, mm.
    pub(super) fn note(&mut self, bound: Bound, length: f64) {
        self.0[bound as usize] += length;
    }

    /// Adds another layer's.
    pub fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(mine, theirs)| *mine += theirs);
    }
}
