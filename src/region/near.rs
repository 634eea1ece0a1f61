//! Walls -> Near: their edges sorted into cells, to find the nearest one or whether a place is free.
//!
//! Words: a *cell* is a square of a *grid* over an area. An edge is *in* all cells that the box around it
//! meets, grown by the *reach* of the edges. It is 0 unless most questions look equally far.
//!
//! A question looks at the edges of the cells that the box around its own places meets, grown by how far
//! it looks beyond the reach: one about a single place within the reach looks into one cell. Answers are
//! exact, and the same for any size of cells and any reach; these affect speed alone. Where edges are
//! equally near, their order by corners decides.

use crate::geom::cells::Cells;
use crate::geom::{Contour, Point, edges, segment};
use crate::units::Bounded as _;
use std::cmp::Ordering;
use std::ops::Range;

/// Maximum number of cells along each side of an area. It bounds the memory for large parts; fewer
/// cells hold more edges each, and look-ups get slower.
const MOST_CELLS: f64 = 256.0;

/// An edge of a wall, grid units: its two ends.
pub(super) type Edge = [[f64; 2]; 2];

/// A box around some places, grid units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Area {
    low: [f64; 2],
    high: [f64; 2],
}

impl Area {
    /// The box around `places`, with `margin` on all sides.
    pub(super) fn around(places: impl Iterator<Item = [f64; 2]>, margin: f64) -> Self {
        let mut out = Self { low: [f64::MAX; 2], high: [f64::MIN; 2] };
        for p in places {
            for (k, at) in p.into_iter().enumerate() {
                out.low[k] = out.low[k].at_most(at);
                out.high[k] = out.high[k].at_least(at);
            }
        }
        for k in 0..2 {
            out.low[k] -= margin;
            out.high[k] += margin;
        }
        out
    }

    /// Its lowest and highest corner.
    pub(super) fn corners(&self) -> [[f64; 2]; 2] {
        [self.low, self.high]
    }

    /// Whether the box with these corners has a place in common with it.
    pub(super) fn meets(&self, [p, q]: &Edge) -> bool {
        (0..2).all(|k| p[k].at_most(q[k]) <= self.high[k] && p[k].at_least(q[k]) >= self.low[k])
    }
}

/// The edges of closed walls that meet an area, sorted into square cells.
#[derive(Debug)]
pub(super) struct Near {
    grid: Grid,
    /// Edges whose boxes, grown by the reach, meet a cell, row by row of cells.
    cells: Cells<Edge>,
    reach: f64,
}

/// How an area is divided into cells.
#[derive(Debug)]
pub(super) struct Grid {
    low: [f64; 2],
    /// Cells per grid unit.
    scale: f64,
    /// Columns and rows of cells.
    size: [usize; 2],
}

impl Grid {
    /// Square cells of side `side` over `area`; larger ones if there would be too many.
    pub(super) fn new(area: Area, side: f64) -> Self {
        let extent = [0, 1].map(|k| (area.high[k] - area.low[k]).max(0.0));
        let side = side.max(extent[0].max(extent[1]) / MOST_CELLS);
        let size = extent.map(|x| (x / side) as usize + 1);
        Self { low: area.low, scale: 1.0 / side, size }
    }

    /// The number of cells.
    pub(super) fn count(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// The cells that meet the box with corners `p` and `q`, row by row of cells.
    pub(super) fn cells(
        &self,
        [p, q]: [[f64; 2]; 2],
    ) -> impl Iterator<Item = Range<usize>> + use<> {
        let range = |k: usize| {
            let (a, b) = (self.at(p[k], k), self.at(q[k], k));
            (a.min(b), a.max(b) + 1)
        };
        let (columns, rows) = (range(0), range(1));
        let width = self.size[0];
        (rows.0..rows.1).map(move |row| row * width + columns.0..row * width + columns.1)
    }

    /// The cell that holds `p`.
    fn cell(&self, p: [f64; 2]) -> usize {
        self.at(p[1], 1) * self.size[0] + self.at(p[0], 0)
    }

    /// The column of cells at `x`, or for the axis 1 the row. Places beyond the area count to its
    /// border cells.
    fn at(&self, x: f64, axis: usize) -> usize {
        // A cast clamps negative numbers to 0. To u32 it takes half the instructions that it takes
        // to usize.
        let cell = ((x - self.low[axis]) * self.scale) as u32 as usize;
        cell.min(self.size[axis] - 1)
    }
}

impl Near {
    /// Sorts the edges into cells of side `side`; larger ones if there would be too many.
    pub(super) fn new(walls: &[Contour], area: Area, side: f64) -> Self {
        let point = |p: Point| [f64::from(p.x), f64::from(p.y)];
        let all = walls.iter().flat_map(|w| edges(w)).map(|(p, q)| [point(p), point(q)]);
        let mut edges = Vec::with_capacity(walls.iter().map(Vec::len).sum());
        edges.extend(all.filter(|edge| area.meets(edge)));
        Self::sorted(edges, area, side, 0.0)
    }

    /// Sorts all edges, with this `reach`, into cells of side `side`, for places anywhere.
    pub(super) fn of_all(walls: &[Contour], side: f64, reach: f64) -> Self {
        let point = |p: Point| [f64::from(p.x), f64::from(p.y)];
        let mut all = Vec::with_capacity(walls.iter().map(Vec::len).sum());
        all.extend(walls.iter().flat_map(|w| edges(w)).map(|(p, q)| [point(p), point(q)]));
        let area = Area::around(all.iter().flatten().copied(), 0.0);
        Self::sorted(all, area, side, reach)
    }

    /// Sorts `edges` into cells of side `side`, for places anywhere.
    pub(super) fn of_edges(edges: Vec<Edge>, side: f64) -> Self {
        let area = Area::around(edges.iter().flatten().copied(), 0.0);
        Self::sorted(edges, area, side, 0.0)
    }

    fn sorted(edges: Vec<Edge>, area: Area, side: f64, reach: f64) -> Self {
        let grid = Grid::new(area, side);
        let grown = |edge: Edge| Area::around(edge.into_iter(), reach).corners();
        let within = |edge: Edge| grid.cells(grown(edge)).flatten();
        let cells = Cells::new(grid.count(), || edges.iter().copied(), within);
        Self { grid, cells, reach }
    }

    /// The edge nearest to `p`, which lies within the area, among those nearer than `distance`. Of
    /// equally near edges it is the one that begins, or ends, further left or lower.
    pub(super) fn nearest(&self, p: [f64; 2], distance: f64) -> Option<Edge> {
        let square = distance * distance;
        let near = self.around(&[p], distance).flatten().filter(|edge| is_nearer(p, edge, square));
        let nearest = near.map(|edge| (segment::distance2(p, *edge), edge));
        let order =
            |a: &(f64, &Edge), b: &(f64, &Edge)| a.partial_cmp(b).unwrap_or(Ordering::Equal);
        nearest.min_by(order).map(|(_, edge)| *edge)
    }

    /// Whether no wall is nearer than `distance` to any of `places`, which lie within the area.
    pub(super) fn is_free<const N: usize>(&self, places: [[f64; 2]; N], distance: f64) -> bool {
        let square = distance * distance;
        let far = |edge: &Edge| places.iter().all(|&p| !is_nearer(p, edge, square));
        self.around(&places, distance).all(|edges| edges.iter().all(far))
    }

    /// Whether an edge that `counts` is nearer than `distance` to `p`, which lies within the area.
    pub(super) fn has(&self, p: [f64; 2], distance: f64, counts: impl Fn(Edge) -> bool) -> bool {
        let square = distance * distance;
        let mut near = self.around(&[p], distance).flatten();
        near.any(|edge| is_nearer(p, edge, square) && counts(*edge))
    }

    /// Whether an edge is nearer to `p` than the reach.
    pub(super) fn is_beside(&self, p: [f64; 2]) -> bool {
        let square = self.reach * self.reach;
        let cell = self.grid.cell(p);
        self.cells.of(cell..cell + 1).iter().any(|edge| is_nearer(p, edge, square))
    }

    /// The first edge within `distance` that a ray from `p` along `way` meets, of length 1, and how far away.
    /// The ray lies within the area. Edges through `p` itself do not count.
    pub(super) fn hit(&self, p: [f64; 2], way: [f64; 2], distance: f64) -> Option<(f64, Edge)> {
        let end = segment::along(p, distance, way);
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let met = |edge: &Edge| {
            let along = segment::way(edge[0], edge[1]);
            let from = segment::way(p, edge[0]);
            let steep = cross(way, along);
            let (away, part) = (cross(from, along) / steep, cross(from, way) / steep);
            let is_met = away > 1.0 && away <= distance && (0.0..=1.0).contains(&part);
            is_met.then_some((away, *edge))
        };
        let met = self.around(&[p, end], 0.0).flatten().filter_map(met);
        met.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The edges in all cells that meet the box around `places` grown by `distance` beyond the
    /// reach, by rows of cells.
    fn around(
        &self,
        places: &[[f64; 2]],
        distance: f64,
    ) -> impl Iterator<Item = &[Edge]> + use<'_> {
        let area = Area::around(places.iter().copied(), (distance - self.reach).at_least(0.0));
        // The edges of neighbouring cells in a row are contiguous.
        self.grid.cells([area.low, area.high]).map(|cells| self.cells.of(cells))
    }
}

/// Whether the squared distance from `p` to an edge is less than `square`. It runs for nearly all
/// edges of a cell, so it avoids the division.
fn is_nearer(p: [f64; 2], [a, b]: &Edge, square: f64) -> bool {
    let along = [b[0] - a[0], b[1] - a[1]];
    let from = [p[0] - a[0], p[1] - a[1]];
    let length2 = along[0] * along[0] + along[1] * along[1];
    let ahead = from[0] * along[0] + from[1] * along[1];
    if ahead <= 0.0 {
        from[0] * from[0] + from[1] * from[1] < square
    } else if ahead >= length2 {
        let from = [p[0] - b[0], p[1] - b[1]];
        from[0] * from[0] + from[1] * from[1] < square
    } else {
        let aside = from[0] * along[1] - from[1] * along[0];
        aside * aside < square * length2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_free_up_to_its_distance_from_the_nearest_wall() {
        let p = |x, y| Point { x, y };
        let square = vec![p(0, 0), p(40_000, 0), p(40_000, 40_000), p(0, 40_000)];
        let area = Area::around([[0.0; 2], [40_000.0; 2]].into_iter(), 10_000.0);
        let near = Near::new(&[square], area, 4_000.0);
        let bottom = Some([[0.0, 0.0], [40_000.0, 0.0]]);
        assert_eq!(near.nearest([20_000.0, 3_000.0], 3_001.0), bottom);
        assert_eq!(near.nearest([20_000.0, 3_000.0], 3_000.0), None);
        for (at, far) in [([20_000.0, 3_000.0], 3_000.0), ([39_000.0, 20_000.0], 1_000.0)] {
            assert!(near.is_free([at], far));
            assert!(!near.is_free([at], far + 1.0));
        }
        // A ray meets what lies ahead.
        assert_eq!(
            near.hit([20_000.0, 40_000.0], [0.0, -1.0], 40_000.0),
            bottom.map(|b| (40_000.0, b))
        );
        assert_eq!(near.hit([20_000.0, 40_000.0], [0.0, -1.0], 39_999.0), None);
        // Around a corner it is the corner itself that counts.
        assert!(near.is_free([[43_000.0, 44_000.0]], 5_000.0));
        assert!(!near.is_free([[43_000.0, 44_000.0]], 5_001.0));
    }
}
