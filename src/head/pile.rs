//! Pile: how high plastic stands on a grid, and where a head would touch it.

use super::{Head, Part};

/// How high plastic stands on a grid of square cells; a cell is -infinity where nothing stands.
#[derive(Debug, Clone)]
pub struct Pile {}

/// What a head touches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The part of the head.
    pub part: Part,
    /// How far the plastic reaches above that part, mm.
    pub depth: f64,
    /// The middle of the cell that is touched, mm.
    pub at: [f64; 2],
    /// How high that cell stands, mm.
    pub height: f64,
}

impl Pile {
    /// An empty pile over the rectangle from `low` to `high`, with cells of this side, mm.
    #[must_use]
    pub fn new(_low: [f64; 2], _high: [f64; 2], _cell: f64) -> Self {
        todo!()
    }

    /// Columns and rows of its cells.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        todo!()
    }

    /// The middle of a cell, mm.
    #[must_use]
    pub fn middle(&self, _cell: [usize; 2]) -> [f64; 2] {
        todo!()
    }

    /// The cell around a place; `None` beside the grid.
    #[must_use]
    pub fn cell(&self, _at: [f64; 2]) -> Option<[usize; 2]> {
        todo!()
    }

    /// How high a cell stands, mm.
    #[must_use]
    pub fn height(&self, _cell: [usize; 2]) -> f64 {
        todo!()
    }

    /// A cell stands at least so high, mm.
    pub fn raise(&mut self, _cell: [usize; 2], _z: f64) {
        todo!()
    }

    /// The cells from `columns.start` on of a row stand at least so high, mm.
    pub fn raise_row(&mut self, _row: usize, _columns: std::ops::Range<usize>, _z: f64) {
        todo!()
    }

    /// The deepest touch of `head` with its tip at `tip` (mm) among those that `spare` does not allow. A
    /// cell's whole square counts.
    #[must_use]
    pub fn hit(&self, _head: &Head, _tip: [f64; 3], _spare: &dyn Fn(&Hit) -> bool) -> Option<Hit> {
        todo!()
    }
}
