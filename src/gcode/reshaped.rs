//! What became of a layer's lines: which moves are written as arcs, and what was joined or slowed down.

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
