//! Points with widths -> Polyline: a bead in the frame of its raster, before it is rotated to the bed.

use super::Point;
use crate::units::Coord;

/// A point of a bead's centre line, in the frame of its raster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LinePoint {
    /// Along the raster lines.
    pub u: Coord,
    /// Across them.
    pub v: Coord,
    /// Width of the bead from the previous point to this one.
    pub width: Coord,
}

/// A bead in the frame of its raster.
pub type Polyline = Vec<LinePoint>;

/// The length of a polyline, grid units.
#[must_use]
pub fn length(polyline: &[LinePoint]) -> i64 {
    let at = |p: &LinePoint| Point { x: p.u, y: p.v };
    polyline.windows(2).map(|w| at(&w[0]).distance(at(&w[1])) as i64).sum()
}

/// The area that a polyline covers, grid units squared: each segment has the width at its end.
#[must_use]
pub fn area(polyline: &[LinePoint]) -> f64 {
    let at = |p: &LinePoint| Point { x: p.u, y: p.v };
    polyline.windows(2).map(|w| at(&w[0]).distance(at(&w[1])) * f64::from(w[1].width)).sum()
}
