//! Point -> (u, v): rotates points into the frame of a raster, whose lines run along u at constant v.

use super::Point;
use crate::units::{Coord, nearest, sin_cos};

/// Lines whose directions differ by less than this sine are parallel: rounding of decimals gives
/// 1e-15, and no key has a step as small as this.
const PARALLEL: f64 = 1e-9;

/// A rotation that makes raster lines horizontal. Exact for multiples of 90°.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    cos: f64,
    sin: f64,
}

impl Frame {
    /// The frame of lines at `degrees` counter-clockwise from the x axis.
    #[must_use]
    pub fn new(degrees: f64) -> Self {
        let (sin, cos) = sin_cos(degrees);
        Self { cos, sin }
    }

    /// Rotates from the bed into the frame. The point has `u`, along the lines, as x and `v`, across
    /// them, as y.
    #[must_use]
    pub fn enter(&self, p: Point) -> Point {
        self.turn(p, -self.sin)
    }

    /// Rotates from the frame back to the bed.
    #[must_use]
    pub fn leave(&self, p: Point) -> Point {
        self.turn(p, self.sin)
    }

    /// Whether the lines of both frames run in the same direction.
    #[must_use]
    pub fn is_parallel(&self, other: Self) -> bool {
        (self.sin * other.cos - self.cos * other.sin).abs() < PARALLEL
    }

    fn turn(&self, p: Point, sin: f64) -> Point {
        let (x, y) = (f64::from(p.x), f64::from(p.y));
        Point {
            x: nearest(x * self.cos - y * sin) as Coord,
            y: nearest(x * sin + y * self.cos) as Coord,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let p = Point { x: 1_234_567, y: -7_654_321 };
        assert_eq!(Frame::new(0.0).enter(p), p);
        assert_eq!(Frame::new(90.0).enter(p), Point { x: p.y, y: -p.x });
        assert_eq!(Frame::new(-90.0).enter(p), Point { x: -p.y, y: p.x });
        assert_eq!(Frame::new(540.0).enter(p), Point { x: -p.x, y: -p.y });
    }

    #[test]
    fn leaving_undoes_entering() {
        for degrees in [0.0, 17.0, 45.0, 90.0, 120.0, 300.0] {
            let frame = Frame::new(degrees);
            let p = Point { x: 1_000_003, y: -2_000_001 };
            let q = frame.leave(frame.enter(p));
            assert!((p.x - q.x).abs() <= 1 && (p.y - q.y).abs() <= 1, "{degrees}: {q:?}");
        }
    }

    #[test]
    fn lines_at_an_angle_become_horizontal() {
        let frame = Frame::new(45.0);
        let p = frame.enter(Point { x: 10_000, y: 10_000 });
        assert_eq!(p, Point { x: 14_142, y: 0 });
    }
}
