//! Contours -> Crossings: tells which travels cross the outline of the part, and how near they pass to its outline.
//!
//! The edges of a layer are sorted into bands of y. A travel is tested only against the edges of the
//! bands that it passes through.

use crate::geom::cells::Cells;
use crate::geom::segment::distance2;
use crate::geom::{Contour, Point, edges, encloses, side};
use crate::units::{Bounded as _, Coord};

/// Most bands of a layer. A trade-off: with more bands a travel is tested against fewer edges, but a
/// steep edge is stored in each band that it reaches into. The result does not depend on it.
const MOST_BANDS: usize = 256;

/// A layer's edges in bands of y: finds those that a travel may cross.
pub(super) struct Crossings {
    low: Coord,
    /// Each band is 2 to the power of `shift` high.
    shift: u32,
    bands: Cells<(Point, Point)>,
}

impl Crossings {
    /// Sorts the edges of `contours`, which do not overlap.
    pub(super) fn new(contours: &[Contour]) -> Self {
        let points = || contours.iter().flatten();
        let low = points().map(|p| p.y).min().unwrap_or(0);
        let high = points().map(|p| p.y).max().unwrap_or(0);
        let wished = points().count().div_ceil(4).clamp(1, MOST_BANDS);
        let shift = (0..Coord::BITS).find(|&shift| ((high - low) >> shift) < wished as Coord);
        let shift = shift.unwrap_or_default();
        let band = |y: Coord| ((y - low) >> shift) as usize;
        let edges = || contours.iter().flat_map(|c| edges(c));
        let reach = |(a, b): (Point, Point)| band(a.y.min(b.y))..band(a.y.max(b.y)) + 1;
        Self { low, shift, bands: Cells::new(band(high) + 1, edges, reach) }
    }

    /// Whether the travel from `a` to `b` crosses an edge. One that lies outside as a whole does not:
    /// it goes from support to support.
    pub(super) fn leaves(&self, a: Point, b: Point) -> bool {
        let touched = self.between(a.y.min(b.y), a.y.max(b.y));
        touched.iter().any(|&(p, q)| meet(a, b, p, q))
    }

    /// Whether the travel from `a` to `b` crosses an edge or comes nearer to one than `clearance`.
    pub(super) fn is_near(&self, a: Point, b: Point, clearance: Coord) -> bool {
        let (low, high) = (a.y.min(b.y) - clearance, a.y.max(b.y) + clearance);
        let (left, right) = (a.x.min(b.x) - clearance, a.x.max(b.x) + clearance);
        let square = f64::from(clearance).powi(2);
        let is_near = |&(p, q): &(Point, Point)| {
            let beside = p.x.max(q.x) < left || p.x.min(q.x) > right;
            let over = p.y.max(q.y) < low || p.y.min(q.y) > high;
            !beside && !over && (meet(a, b, p, q) || apart2([a, b], [p, q]) < square)
        };
        self.between(low, high).iter().any(is_near)
    }

    /// The edges of all bands from `low` to `high`, some of them several times.
    fn between(&self, low: Coord, high: Coord) -> &[(Point, Point)] {
        let last = self.bands.count() - 1;
        let band = |y: Coord| (((y - self.low).max(0) >> self.shift) as usize).min(last);
        self.bands.of(band(low)..band(high) + 1)
    }

    /// Whether `p` is inside the contours, which do not overlap.
    pub(super) fn holds(&self, p: Point) -> bool {
        let Ok(k) = usize::try_from((p.y - self.low) >> self.shift) else { return false };
        k < self.bands.count() && encloses(self.bands.of(k..k + 1).iter().copied(), p)
    }
}

/// The squared distance of two segments that do not meet, grid units².
fn apart2(one: [Point; 2], other: [Point; 2]) -> f64 {
    let floats = |ends: [Point; 2]| ends.map(|p| [f64::from(p.x), f64::from(p.y)]);
    let (one, other) = (floats(one), floats(other));
    let from = |points: [[f64; 2]; 2], ends| points.map(|p| distance2(p, ends));
    let [[a, b], [c, d]] = [from(one, other), from(other, one)];
    a.at_most(b).at_most(c.at_most(d))
}

/// Whether segments a–b and p–q share a point.
pub(super) fn meet(a: Point, b: Point, p: Point, q: Point) -> bool {
    let (x1, x2) = (a.x.min(b.x), a.x.max(b.x));
    if p.x.max(q.x) < x1 || p.x.min(q.x) > x2 {
        return false;
    }
    let (y1, y2) = (a.y.min(b.y), a.y.max(b.y));
    if p.y.max(q.y) < y1 || p.y.min(q.y) > y2 {
        return false;
    }
    let (p_side, q_side) = (side(a, b, p).signum(), side(a, b, q).signum());
    let (a_side, b_side) = (side(p, q, a).signum(), side(p, q, b).signum());
    p_side * q_side <= 0 && a_side * b_side <= 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: Coord, high: Coord, hole: bool) -> Contour {
        let p = |x, y| Point { x, y };
        let mut square = vec![p(low, low), p(high, low), p(high, high), p(low, high)];
        if hole {
            square.reverse();
        }
        square
    }

    #[test]
    fn travels_leave_if_they_cross_a_contour() {
        let crossings = Crossings::new(&[square(0, 1000, false), square(400, 600, true)]);
        let p = |x, y| Point { x, y };
        for (a, b, leaves) in [
            (p(100, 100), p(900, 100), false),
            (p(100, 100), p(100, 900), false),
            (p(100, 500), p(900, 500), true),
            (p(100, 100), p(1100, 100), true),
            (p(-200, 500), p(-100, 500), false),
            (p(-200, 500), p(1_100, 500), true),
            (p(450, 450), p(550, 550), false),
            (p(-500, -500), p(5000, -400), false),
        ] {
            assert_eq!(crossings.leaves(a, b), leaves, "{a:?} to {b:?}");
            assert_eq!(crossings.leaves(b, a), leaves, "{b:?} to {a:?}");
        }
    }

    #[test]
    fn travels_are_near_if_they_come_closer_than_the_clearance() {
        let crossings = Crossings::new(&[square(0, 1000, false), square(400, 600, true)]);
        let p = |x, y| Point { x, y };
        for (a, b, distance) in [
            (p(100, 100), p(900, 100), 100),
            (p(200, 350), p(800, 350), 50),
            (p(100, 380), p(380, 700), 80),
            (p(200, 300), p(200, 301), 200),
        ] {
            assert!(!crossings.is_near(a, b, distance), "{a:?} to {b:?}");
            assert!(crossings.is_near(b, a, distance + 1), "{a:?} to {b:?}");
        }
        assert!(crossings.is_near(p(100, 500), p(900, 500), 1));
    }

    #[test]
    fn without_contours_no_travel_crosses_any() {
        let crossings = Crossings::new(&[]);
        assert!(!crossings.leaves(Point { x: 1, y: 2 }, Point { x: 3, y: -4 }));
    }
}
