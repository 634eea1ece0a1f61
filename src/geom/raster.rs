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

impl Raster {
    /// Lines at `degrees` no further apart than `width`, every `stride`-th of which
    /// (returned with them) lies `spacing` > 0 from the next.
    #[must_use]
    pub fn fine(degrees: f64, spacing: Coord, width: Coord) -> (Self, i32) {
        let stride = ((spacing + width - 1) / width).max(1);
        (Self { frame: Frame::new(degrees), pitch: (spacing + stride / 2) / stride }, stride)
    }

    /// The rows `j` with `low < j · pitch <= high` (on the line counts as above).
    #[must_use]
    pub fn rows(&self, low: Coord, high: Coord) -> std::ops::Range<i32> {
        low.div_euclid(self.pitch) + 1..high.div_euclid(self.pitch) + 1
    }
}
