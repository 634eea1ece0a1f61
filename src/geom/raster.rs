//! Direction + pitch -> Raster: a set of parallel lines in the plane.

use super::frame::Frame;
use crate::units::Coord;

/// A set of raster lines: row `j` runs at `v = j · pitch` in `frame`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raster {
    /// The lines' direction.
    pub frame: Frame,
    /// Distance between neighbouring lines, grid units, > 0.
    pub pitch: Coord,
}

/// The rows `j`, `pitch` > 0 apart, with `low <= j · pitch <= high`: those that a column from `low` to `high` crosses.
#[must_use]
pub fn crossed(low: Coord, high: Coord, pitch: Coord) -> std::ops::Range<i32> {
    -(-low).div_euclid(pitch)..high.div_euclid(pitch) + 1
}

impl Raster {
    /// A raster of lines at `degrees`, at most about `width` apart, and a stride: each line is
    /// `spacing` > 0 from the line `stride` rows further on. Sparse infill takes every `stride`-th
    /// row; the rows between follow the region's edge.
    #[must_use]
    pub fn fine(degrees: f64, spacing: Coord, width: Coord) -> (Self, i32) {
        let stride = ((spacing + width - 1) / width).max(1);
        (Self { frame: Frame::new(degrees), pitch: (spacing + stride / 2) / stride }, stride)
    }

    /// The rows `j` with `low < j · pitch <= high`: a point on a line counts as above it.
    #[must_use]
    pub fn rows(&self, low: Coord, high: Coord) -> std::ops::Range<i32> {
        low.div_euclid(self.pitch) + 1..high.div_euclid(self.pitch) + 1
    }
}
