//! Plane geometry on the integer grid: points, contours and spans.

use crate::units::Coord;

/// A point of the plane, in grid units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Point {
    /// To the right.
    pub x: Coord,
    /// To the back of the bed.
    pub y: Coord,
}

/// A closed polygon: counter-clockwise around solid, clockwise around a hole;
/// the last point is joined to the first, which is not repeated.
pub type Contour = Vec<Point>;
