//! Head: what hangs around the nozzle's tip, and what it may touch.
//!
//! All lengths are mm, seen from the middle of the nozzle's hole, z upwards from its tip. The *underside*
//! is the lowest place of the head over a point of the bed: 0 over the flat face, then the flank of the
//! cone, then discs and boxes. All above the underside is taken.

pub mod pile;

/// What hangs around the nozzle's tip.
#[derive(Debug, Clone, PartialEq)]
pub struct Head {
    /// Diameter of the level face round the hole, mm.
    pub flat: f64,
    /// Flank of the nozzle above the horizontal, degrees.
    pub cone: f64,
    /// Height of the flank, mm.
    pub cone_length: f64,
    /// Radius and underside of round parts about the nozzle's axis, mm.
    pub discs: Vec<[f64; 2]>,
    /// `[x0, y0, x1, y1, z]` of parts that hang beside it, mm.
    pub boxes: Vec<[f64; 5]>,
}

/// A part of the head.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The level face round the hole.
    Flat,
    /// The flank of the nozzle.
    Cone,
    /// A disc, counted from 0.
    Disc(usize),
    /// A box, counted from 0.
    Box(usize),
}

impl Head {
    /// The steepest plane through the tip that touches nothing but the flat face, degrees.
    #[must_use]
    pub fn steepest(&self) -> f64 {
        todo!()
    }

    /// The same head turned by half a turn: what it touches at the tip, the tip touches with it.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        todo!()
    }

    /// How far it reaches sideways, mm.
    #[must_use]
    pub fn reach(&self) -> f64 {
        todo!()
    }

    /// The underside over the place `by` beside the tip, mm above it, and its part; `None` beyond its reach.
    #[must_use]
    pub fn underside(&self, _by: [f64; 2]) -> Option<(f64, Part)> {
        todo!()
    }

    /// The lowest place of the underside over a rectangle from `low` to `high` beside the tip, mm; infinite
    /// beyond its reach.
    #[must_use]
    pub fn over(&self, _low: [f64; 2], _high: [f64; 2]) -> f64 {
        todo!()
    }
}
