//! Contours -> Crossings: tells which travels cross the outline of the part, and how near they pass to its outline.
//!
//! - A *band* is a stretch of y; a *cell* is a stretch of x in a band.
//!
//! 1. The edges of a layer are sorted into bands. Those of a layer with very many are sorted in each band
//!    into cells as well: an edge is in all cells that it passes.
//! 2. A travel is tested only against the edges of the cells near which it passes.
//! 3. Whether a place is inside is counted from the edges of its band.
//!
//! Answers do not depend on how many bands and cells there are.

use crate::geom::cells::Cells;
use crate::geom::nest::extent;
use crate::geom::segment::distance2;
use crate::geom::{Contour, Point, edges, encloses, side};
use crate::units::{Bounded as _, Coord, between};
use std::ops::Range;

/// Most bands of a layer. A trade-off: with more bands a travel is tested against fewer edges, but a
/// steep edge is stored in each band that it reaches into. The result does not depend on it.
const MOST_BANDS: usize = 256;

/// Most cells of a band, and the edges of which there is a band or cell for each. They affect speed
/// only, too.
const MOST_COLUMNS: usize = 256;
const PER_CELL: usize = 4;

/// An edge of the layer.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Edge {
    /// Its ends.
    pub(super) ends: (Point, Point),
    /// Its contour, and its number in it.
    pub(super) of: (u32, u32),
}

/// A layer's edges in cells: finds those that a travel may cross.
pub(super) struct Crossings {
    low: Point,
    /// Each cell is 2 to these powers wide and high.
    shifts: (u32, u32),
    /// Cells of a band, and bands.
    size: (usize, usize),
    /// Band by band.
    cells: Cells<Edge>,
}

impl Crossings {
    /// Sorts the edges of `contours`, which do not overlap.
    pub(super) fn new(contours: &[Contour]) -> Self {
        let (low, high) = extent(contours.iter().flatten()).unwrap_or_default();
        let count = contours.iter().map(Vec::len).sum::<usize>().div_ceil(PER_CELL);
        let shift = |extent: Coord, most: usize| {
            (0..Coord::BITS).find(|&shift| (extent >> shift) < most as Coord).unwrap_or_default()
        };
        let wished = (count / MOST_BANDS).clamp(1, MOST_COLUMNS);
        let (wide, deep) = (high.x - low.x, high.y - low.y);
        let shifts = (shift(wide, wished), shift(deep, count.clamp(1, MOST_BANDS)));
        let size = ((wide >> shifts.0) as usize + 1, (deep >> shifts.1) as usize + 1);
        let blank = Self { low, shifts, size, cells: Cells::new(0, std::iter::empty, |_| 0..0) };
        let edges = || (0..).zip(contours).flat_map(|(c, contour)| numbered(c, contour));
        let cells = if size.0 == 1 {
            Cells::new(size.1, edges, |edge: Edge| blank.bands(edge.ends.0, edge.ends.1, 0))
        } else {
            let reach = |edge: Edge| blank.near(edge.ends.0, edge.ends.1, 0).flatten();
            Cells::new(size.0 * size.1, edges, reach)
        };
        Self { cells, ..blank }
    }

    /// Whether the travel from `a` to `b` crosses an edge. One that lies outside as a whole does not:
    /// it goes from support to support.
    pub(super) fn leaves(&self, a: Point, b: Point) -> bool {
        let meets = |edge: &Edge| meet(a, b, edge.ends.0, edge.ends.1);
        self.has(a, b, 0, meets)
    }

    /// The edges that the travel from `a` to `b` touches or crosses, some of them several times.
    pub(super) fn met(&self, a: Point, b: Point) -> impl Iterator<Item = &Edge> {
        let near = self.near(a, b, 0).flat_map(|cells| self.cells.of(cells));
        near.filter(move |edge| meet(a, b, edge.ends.0, edge.ends.1))
    }

    /// Whether the travel from `a` to `b` crosses an edge or comes nearer to one than `clearance`.
    pub(super) fn is_near(&self, a: Point, b: Point, clearance: Coord) -> bool {
        let (low, high) = (a.y.min(b.y) - clearance, a.y.max(b.y) + clearance);
        let (left, right) = (a.x.min(b.x) - clearance, a.x.max(b.x) + clearance);
        let square = f64::from(clearance).powi(2);
        let is_near = |&Edge { ends: (p, q), .. }: &Edge| {
            let beside = p.x.max(q.x) < left || p.x.min(q.x) > right;
            let over = p.y.max(q.y) < low || p.y.min(q.y) > high;
            !beside && !over && (meet(a, b, p, q) || apart2([a, b], [p, q]) < square)
        };
        self.has(a, b, clearance, is_near)
    }

    /// Whether some edge in the cells within `clearance` of a–b is what is looked for.
    fn has(&self, a: Point, b: Point, clearance: Coord, is: impl Fn(&Edge) -> bool) -> bool {
        if self.size.0 == 1 {
            return self.cells.of(self.bands(a, b, clearance)).iter().any(is);
        }
        self.near(a, b, clearance).any(|cells| self.cells.of(cells).iter().any(&is))
    }

    /// The bands within `clearance` of a–b, if each is one cell: as [`Self::near`], which most layers
    /// need not be asked with all its care.
    fn bands(&self, a: Point, b: Point, clearance: Coord) -> Range<usize> {
        let row =
            |y: Coord| (((y - self.low.y).max(0) >> self.shifts.1) as usize).min(self.size.1 - 1);
        row(a.y.min(b.y) - clearance)..row(a.y.max(b.y) + clearance) + 1
    }

    /// The cells, band by band, that hold all edges nearer to a–b than `clearance`.
    fn near(
        &self,
        a: Point,
        b: Point,
        clearance: Coord,
    ) -> impl Iterator<Item = Range<usize>> + use<> {
        let (columns, rows) = self.size;
        let (low, (across, up)) = (self.low, self.shifts);
        let cell = |at: Coord, low: Coord, shift: u32, count: usize| {
            (((at - low).max(0) >> shift) as usize).min(count - 1)
        };
        let (lower, upper) = if a.y <= b.y { (a, b) } else { (b, a) };
        let row = |y: Coord| cell(y, low.y, up, rows);
        let (first, last) = (row(lower.y - clearance), row(upper.y + clearance));
        (first..last + 1).map(move |band| {
            if columns == 1 {
                return band..band + 1;
            }
            // Where the travel passes the band, and a grid unit beyond for rounding.
            let (bottom, top) =
                (low.y + ((band as Coord) << up), low.y + ((band as Coord + 1) << up));
            let bottom = if band == 0 { Coord::MIN / 2 } else { bottom - clearance - 1 };
            let top = if band + 1 == rows { Coord::MAX / 2 } else { top + clearance + 1 };
            let [x, other] = [bottom, top].map(|y| {
                let y = y.clamp(lower.y, upper.y);
                if upper.y == lower.y {
                    lower.x
                } else {
                    between(lower.x, upper.x, (y, lower.y, upper.y))
                }
            });
            let other = if upper.y == lower.y { upper.x } else { other };
            let column = |x: Coord| cell(x, low.x, across, columns);
            let (from, to) = (x.min(other) - clearance - 1, x.max(other) + clearance + 1);
            band * columns + column(from)..band * columns + column(to) + 1
        })
    }

    /// Whether `p` is inside the contours, which do not overlap.
    pub(super) fn holds(&self, p: Point) -> bool {
        let (columns, rows) = self.size;
        let Ok(row) = usize::try_from((p.y - self.low.y) >> self.shifts.1) else { return false };
        if row >= rows {
            return false;
        }
        let edges = self.cells.of(row * columns..(row + 1) * columns);
        if columns == 1 {
            return encloses(edges.iter().map(|edge| edge.ends), p);
        }
        // An edge is in several cells of the band.
        let is_beside = |(a, b): (Point, Point)| a.y.min(b.y) <= p.y && p.y <= a.y.max(b.y);
        let mut beside: Vec<Edge> =
            edges.iter().copied().filter(|edge| is_beside(edge.ends)).collect();
        beside.sort_unstable_by_key(|edge| edge.of);
        beside.dedup_by_key(|edge| edge.of);
        encloses(beside.iter().map(|edge| edge.ends), p)
    }
}

/// The edges of contour number `c`.
fn numbered(c: u32, contour: &Contour) -> impl Iterator<Item = Edge> {
    edges(contour).zip(0..).map(move |(ends, k)| Edge { ends, of: (c, k) })
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
    use proptest::prelude::*;

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

    /// 16 rows of 40 squares: so many edges that bands have cells of their own.
    fn field() -> Vec<Contour> {
        let place = |k: i32| (k % 40 * 5_000, k / 40 * 9_000);
        let shifted = |k: i32| {
            let (x, y) = place(k);
            let corners = square(0, 3_000, false);
            corners.iter().map(|p| Point { x: p.x + x, y: p.y + y + x / 90 }).collect()
        };
        (0..640).map(shifted).collect()
    }

    proptest! {
        #[test]
        fn in_cells_are_found_the_edges_that_all_are_asked_for(
            ways in prop::collection::vec((0..200_000, 0..150_000, -30_000..30_000, -30_000..30_000), 60),
            clearance in 0..6_000,
        ) {
            let field = field();
            let crossings = Crossings::new(&field);
            prop_assert!(crossings.size.0 > 1);
            for (x, y, right, up) in ways {
                let (a, b) = (Point { x, y }, Point { x: x + right, y: y + up });
                let all = || field.iter().flat_map(|c| edges(c));
                let met = all().filter(|&(p, q)| meet(a, b, p, q));
                let mut met: Vec<_> = met.collect();
                let mut found: Vec<_> = crossings.met(a, b).map(|edge| edge.ends).collect();
                found.sort_unstable();
                found.dedup();
                met.sort_unstable();
                prop_assert_eq!(crossings.leaves(a, b), !met.is_empty());
                prop_assert_eq!(found, met);
                let square = f64::from(clearance).powi(2);
                let near = all().any(|(p, q)| meet(a, b, p, q) || apart2([a, b], [p, q]) < square);
                prop_assert_eq!(crossings.is_near(a, b, clearance), near);
                prop_assert_eq!(crossings.holds(a), encloses(all(), a));
            }
        }
    }

    #[test]
    fn without_contours_no_travel_crosses_any() {
        let crossings = Crossings::new(&[]);
        assert!(!crossings.leaves(Point { x: 1, y: 2 }, Point { x: 3, y: -4 }));
    }
}
