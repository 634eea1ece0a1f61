//! Curves -> winding numbers: rejects curves that cross, and computes winding numbers of the others.
//!
//! - A *curve* is a closed polygon; a *side* is one of its edges.
//! - The *winding number* of a place is how often the curves run around it counter-clockwise.
//! - The *sweep line* is horizontal and moves from low to high y. It holds the sides that it crosses,
//!   from left to right, each with the winding number to its right.
//!
//! 1. Sort all corners by y, then by x.
//! 2. At each corner the sweep line gains two sides, loses two, or replaces one by the next.
//! 3. Compare each new neighbour with the side beside it. Curves cross only if two sides that were
//!    neighbours on the sweep line do (Shamos and Hoey 1976).
//! 4. Where a curve begins, its winding number follows from the side to the left.
//!
//! This takes one search and two comparisons for each corner. A library's union does far more work,
//! as it must be ready for crossings.

use super::{Contour, Point, side};

/// Sides nearer than about this many grid units count as crossing. The library rounds crossings to whole
/// units, so that it may change sides that are this near. At lower values results could differ
/// from the library's; higher ones only send more curves to it, which takes longer.
const LEAST_GAP: i64 = 2;

/// The winding number of all curves together to the left of each curve; to its right it is one less.
/// Curves are closed and have no equal points in a row. `None` if any two sides cross, touch or nearly
/// touch, or if a curve goes straight on or folds back at a vertex.
#[must_use]
pub fn windings(curves: &[Contour]) -> Option<Vec<i32>> {
    let mut corners = Vec::with_capacity(curves.iter().map(Vec::len).sum());
    for (curve, points) in curves.iter().enumerate() {
        let mut before = *points.last()?;
        for (k, &at) in points.iter().enumerate() {
            let after = points[(k + 1) % points.len()];
            corners.push(Corner { at, before, after, curve });
            before = at;
        }
    }
    corners.sort_unstable_by_key(|c| key(c.at));
    if corners.windows(2).any(|pair| pair[0].at == pair[1].at) {
        return None;
    }
    let mut sweep = Sweep { sides: Vec::new(), windings: vec![0; curves.len()] };
    corners.iter().all(|corner| sweep.pass(corner).is_some()).then_some(sweep.windings)
}

/// A corner of a curve, and the corners before and after it.
struct Corner {
    at: Point,
    before: Point,
    after: Point,
    curve: usize,
}

/// Whether the curve turns at `at`, by less than 173°.
fn is_corner(before: Point, at: Point, after: Point) -> bool {
    let by =
        |a: Point, b: Point| [i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y)];
    let ([ax, ay], [bx, by]) = (by(before, at), by(at, after));
    let (cross, dot) = (ax * by - ay * bx, ax * bx + ay * by);
    cross != 0 && (dot > 0 || -dot < 8 * cross.abs())
}

/// The order in which the sweep line meets points. Horizontal sides count as rising to the right.
fn key(p: Point) -> (i32, i32) {
    (p.y, p.x)
}

/// A side that the sweep line crosses.
#[derive(Debug, Clone, Copy)]
struct Side {
    low: Point,
    high: Point,
    /// The winding number to its right.
    right: i32,
}

impl Side {
    /// Whether another side keeps [`LEAST_GAP`] from this one, or shares an end with it.
    fn is_clear_of(&self, other: &Self) -> bool {
        self.low == other.low
            || self.high == other.high
            || self.is_beside(other)
            || other.is_beside(self)
    }

    /// Whether both ends of `other` lie on one side of the line along this side, and keep
    /// [`LEAST_GAP`] from it.
    fn is_beside(&self, other: &Self) -> bool {
        let run = i64::from(self.high.x) - i64::from(self.low.x);
        let rise = i64::from(self.high.y) - i64::from(self.low.y);
        let least = LEAST_GAP * (run.abs() + rise);
        let (a, b) = (side(self.low, self.high, other.low), side(self.low, self.high, other.high));
        (a > least && b > least) || (a < -least && b < -least)
    }
}

/// The sweep line.
struct Sweep {
    /// The sides that the line crosses, from left to right.
    sides: Vec<Side>,
    /// The winding number to the left of each curve, once known.
    windings: Vec<i32>,
}

impl Sweep {
    /// Passes a corner. `None` if curves cross.
    fn pass(&mut self, corner: &Corner) -> Option<()> {
        let &Corner { at, before, after, .. } = corner;
        if !is_corner(before, at, after) {
            return None;
        }
        let k = self.sides.partition_point(|s| side(s.low, s.high, at) < 0);
        match (key(before) > key(at), key(after) > key(at)) {
            (true, true) => self.begin(k, corner),
            (false, false) => self.end(k, at),
            (true, false) => self.replace(k, at, before),
            (false, true) => self.replace(k, at, after),
        }
    }

    /// Inserts the two sides that begin at a corner, before side `k`.
    fn begin(&mut self, k: usize, corner: &Corner) -> Option<()> {
        let &Corner { at, before, after, curve } = corner;
        let outside = k.checked_sub(1).map_or(0, |left| self.sides[left].right);
        let turns_left = side(before, at, after) > 0;
        // If the curve turns left at its lowest point, its left is between the two sides.
        let inside = if turns_left { outside + 1 } else { outside - 1 };
        self.windings[curve] = if turns_left { inside } else { outside };
        let (left, right) = if turns_left { (before, after) } else { (after, before) };
        let new = [
            Side { low: at, high: left, right: inside },
            Side { low: at, high: right, right: outside },
        ];
        self.sides.splice(k..k, new);
        self.check(k)?;
        self.check(k + 2)
    }

    /// Replaces a side that ends by the next one of its curve.
    fn replace(&mut self, k: usize, at: Point, high: Point) -> Option<()> {
        let here = self.sides.get_mut(k).filter(|s| s.high == at)?;
        *here = Side { low: at, high, right: here.right };
        self.check(k)?;
        self.check(k + 1)
    }

    /// Removes two sides that end at a corner.
    fn end(&mut self, k: usize, at: Point) -> Option<()> {
        let both = self.sides.get(k..k + 2)?;
        if both.iter().any(|s| s.high != at) {
            return None;
        }
        self.sides.drain(k..k + 2);
        self.check(k)
    }

    /// `None` if side `k` and the one to its left are not clear of each other.
    fn check(&self, k: usize) -> Option<()> {
        let (Some(left), Some(here)) =
            (k.checked_sub(1).map(|l| &self.sides[l]), self.sides.get(k))
        else {
            return Some(());
        };
        here.is_clear_of(left).then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::edges;
    use proptest::prelude::*;

    fn p(x: i32, y: i32) -> Point {
        Point { x, y }
    }

    fn square(low: i32, high: i32) -> Contour {
        vec![p(low, low), p(high, low), p(high, high), p(low, high)]
    }

    fn turned(mut curve: Contour) -> Contour {
        curve.reverse();
        curve
    }

    #[test]
    fn winding_numbers_count_nested_curves() {
        let curves = [
            square(0, 1000),
            turned(square(100, 900)),
            square(200, 800),
            square(300, 700),
            turned(square(-100, -50)),
        ];
        assert_eq!(windings(&curves), Some(vec![1, 1, 1, 2, 0]));
    }

    #[test]
    fn curves_that_meet_have_no_windings() {
        let far = square(0, 1000);
        // Crossing, a corner on a corner, on a side, along a side, and nearly so.
        for (x, y) in [(500, 500), (1000, 1000), (1000, 500), (1001, 0), (-1001, 500)] {
            let moved = far.iter().map(|q| p(q.x + x, q.y + y)).collect();
            assert_eq!(windings(&[far.clone(), moved]), None, "{x} {y}");
        }
        let bow_tie = vec![p(0, 0), p(1000, 1000), p(1000, 0), p(0, 900)];
        assert_eq!(windings(&[bow_tie]), None);
        let spike = vec![p(0, 0), p(1000, 0), p(500, 0), p(500, 900)];
        assert_eq!(windings(&[spike]), None);
    }

    /// Whether two sides share a point.
    fn meet((a, b): (Point, Point), (c, d): (Point, Point)) -> bool {
        let apart = |a, b, c, d| side(a, b, c).signum() * side(a, b, d).signum() > 0;
        let box_apart = |f: fn(Point) -> i32| {
            f(a).max(f(b)) < f(c).min(f(d)) || f(c).max(f(d)) < f(a).min(f(b))
        };
        !apart(a, b, c, d) && !apart(c, d, a, b) && !box_apart(|p| p.x) && !box_apart(|p| p.y)
    }

    proptest! {
        #[test]
        fn curves_have_windings_if_no_sides_meet(
            curves in prop::collection::vec(
                prop::collection::vec((0..12, 0..12), 3..6), 1..4),
        ) {
            let curve = |c: &Vec<(i32, i32)>| c.iter().map(|q| p(q.0 * 1000, q.1 * 1000)).collect();
            let curves: Vec<Contour> = curves.iter().map(curve).collect();
            let sides: Vec<(Point, Point)> = curves.iter().flat_map(|c| edges(c)).collect();
            let pairs = || (0..sides.len()).flat_map(|k| (0..k).map(move |l| (k, l)));
            // Successive sides of a curve share a corner.
            let clear = pairs().map(|(k, l)| (sides[k], sides[l])).all(|(a, b)| {
                if a.1 == b.0 {
                    is_corner(a.0, a.1, b.1)
                } else if b.1 == a.0 {
                    is_corner(b.0, b.1, a.1)
                } else {
                    !meet(a, b)
                }
            });
            prop_assert_eq!(windings(&curves).is_some(), clear);
        }
    }
}
