//! Triangles in plan -> Index: which of them may lie over a place, or along a straight way.
//!
//! Square cells cover the box around all triangles, about as many as there are triangles. A triangle is
//! in every cell that it reaches into, found row by row: in a row of cells it reaches from the least to
//! the greatest x of what of it lies in that row. A long thin triangle that runs aslant is so in the few
//! cells under it, not in all of its box.

use crate::geom::Point;
use crate::geom::boxes::extent;
use crate::geom::cells::Cells;
use std::ops::Range;

/// Triangles are found this far beside them too, grid units.
pub(super) const NEAR: f64 = 20.0;

/// Smallest side of a cell, grid units: 0.05 mm.
const LEAST_SIDE: f64 = 500.0;

/// Triangles by the cells they reach into.
#[derive(Debug)]
pub(super) struct Index {
    grid: Grid,
    cells: Cells<u32>,
}

/// Square cells over a box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    low: [f64; 2],
    side: f64,
    columns: usize,
    rows: usize,
}

impl Index {
    /// Sorts fewer than 2³² triangles.
    #[must_use]
    pub(super) fn new(triangles: &[[Point; 3]]) -> Self {
        let (low, high) = extent(triangles.as_flattened()).unwrap_or_default();
        let area = (f64::from(high.x) - f64::from(low.x)) * (f64::from(high.y) - f64::from(low.y));
        let side = (area / triangles.len().max(1) as f64).sqrt();
        let grid = Grid::new((low, high), side.max(LEAST_SIDE));
        let all = || (0_u32..).take(triangles.len());
        let cells = Cells::new(grid.count(), all, |k| grid.under(&triangles[k as usize]));
        Self { grid, cells }
    }

    /// The triangles that may lie over a place, in their order.
    #[must_use]
    pub(super) fn at(&self, p: Point) -> &[u32] {
        let cell = self.grid.cell(p);
        cell.map_or(&[], |cell| self.cells.of(cell..cell + 1))
    }

    /// The triangles that may lie over the straight way from `a` to `b`, in their order.
    #[must_use]
    pub(super) fn along(&self, a: Point, b: Point) -> Vec<u32> {
        self.near(&[a, b])
    }

    /// The triangles that may have a place in common with a polygon without dents, in their order.
    #[must_use]
    pub(super) fn near(&self, polygon: &[Point]) -> Vec<u32> {
        let cells = self.grid.under(polygon);
        let mut found: Vec<u32> =
            cells.flat_map(|cell| self.cells.of(cell..cell + 1)).copied().collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Whether something holds for all of [`Self::near`]; asked more than once for some.
    #[must_use]
    pub(super) fn all_near(&self, polygon: &[Point], holds: impl Fn(u32) -> bool) -> bool {
        let mut cells = self.grid.under(polygon);
        cells.all(|cell| self.cells.of(cell..cell + 1).iter().all(|&k| holds(k)))
    }
}

impl Grid {
    /// Cells of this side over a box, or of a larger one if they would be more than 2²⁴.
    #[must_use]
    pub(super) fn new((low, high): (Point, Point), side: f64) -> Self {
        let wide = [
            f64::from(high.x) - f64::from(low.x) + 2.0 * NEAR,
            f64::from(high.y) - f64::from(low.y) + 2.0 * NEAR,
        ];
        let side = side.max(wide[0].max(wide[1]) / 4_095.0);
        let count = |wide: f64| (wide / side) as usize + 1;
        let low = [f64::from(low.x) - NEAR, f64::from(low.y) - NEAR];
        Self { low, side, columns: count(wide[0]), rows: count(wide[1]) }
    }

    /// The number of cells.
    #[must_use]
    pub(super) fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The cell around a place; `None` beside the grid.
    #[must_use]
    pub(super) fn cell(&self, p: Point) -> Option<usize> {
        let at = |v: i32, axis: usize, count: usize| {
            let cell = (f64::from(v) - self.low[axis]) / self.side;
            (cell >= 0.0 && cell < count as f64).then_some(cell as usize)
        };
        Some(at(p.y, 1, self.rows)? * self.columns + at(p.x, 0, self.columns)?)
    }

    /// The middle of a cell, to the nearest grid unit.
    #[must_use]
    pub(super) fn middle(&self, cell: usize) -> Point {
        let at =
            |k: usize, axis: usize| (self.low[axis] + (k as f64 + 0.5) * self.side).round() as i32;
        Point { x: at(cell % self.columns, 0), y: at(cell / self.columns, 1) }
    }

    /// The cells that a closed polygon without dents reaches into, or nearly.
    pub(super) fn under<'a>(&self, polygon: &'a [Point]) -> impl Iterator<Item = usize> + use<'a> {
        let grid = *self;
        let ys = polygon.iter().map(|p| f64::from(p.y));
        let (low, high) = ys.fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
        let rows = grid.lines(low - NEAR, high + NEAR, 1, grid.rows);
        rows.flat_map(move |row| {
            let from = grid.low[1] + row as f64 * grid.side;
            let span = span(polygon, from - NEAR, from + grid.side + NEAR);
            let columns = span.map_or(0..0, |(left, right)| {
                grid.lines(left - NEAR, right + NEAR, 0, grid.columns)
            });
            columns.map(move |column| row * grid.columns + column)
        })
    }

    /// The rows or columns of cells from `low` to `high`, of `count`.
    fn lines(&self, low: f64, high: f64, axis: usize, count: usize) -> Range<usize> {
        let at = |v: f64| ((v - self.low[axis]) / self.side).floor();
        let (first, last) = (at(low).max(0.0), at(high).min(count as f64 - 1.0));
        if first > last { 0..0 } else { first as usize..last as usize + 1 }
    }
}

/// The least and greatest x of what of a polygon lies between two y.
fn span(polygon: &[Point], low: f64, high: f64) -> Option<(f64, f64)> {
    let mut found: Option<(f64, f64)> = None;
    let mut meet = |x: f64| {
        let (left, right) = found.unwrap_or((x, x));
        found = Some((left.min(x), right.max(x)));
    };
    for (k, p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let (px, py, qx, qy) = (f64::from(p.x), f64::from(p.y), f64::from(q.x), f64::from(q.y));
        if low <= py && py <= high {
            meet(px);
        }
        for y in [low, high] {
            if (py < y) != (qy < y) {
                meet(px + (qx - px) * (y - py) / (qy - py));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn triangles_are_found_over_their_places(
            list in prop::collection::vec(prop::array::uniform6(-90_000..90_000), 1..60),
            shares in prop::collection::vec((0.0..1.0, 0.0..1.0), 5),
        ) {
            let triangle = |v: &[i32; 6]| [0, 2, 4].map(|k| Point { x: v[k], y: v[k + 1] });
            let triangles: Vec<[Point; 3]> = list.iter().map(triangle).collect();
            let index = Index::new(&triangles);
            for (k, [a, b, c]) in triangles.iter().enumerate() {
                for &(s, t) in &shares {
                    let (s, t): (f64, f64) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
                    let at = |a: i32, b: i32, c: i32| {
                        let [a, b, c] = [a, b, c].map(f64::from);
                        (a + s * (b - a) + t * (c - a)).round() as i32
                    };
                    let p = Point { x: at(a.x, b.x, c.x), y: at(a.y, b.y, c.y) };
                    let k = k as u32;
                    prop_assert!(index.at(p).contains(&k));
                    prop_assert!(index.along(p, *a).contains(&k));
                }
            }
        }
    }
}
