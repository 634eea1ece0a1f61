//! Surface -> Field: its height over the middle of every cell.

use super::grid::{CELL, Spot, cells, columns};
use super::surface::Surface;
use crate::geom::Point;
use crate::geom::spans::Span;
use crate::units::Coord;
use rayon::prelude::*;

/// How high a surface lies over the cells inside its outline, grid units.
#[derive(Debug)]
pub(super) struct Field {
    low: Spot,
    size: [usize; 2],
    /// Row by row; not a number beside the surface.
    heights: Vec<f32>,
}

impl Field {
    /// One walk over the surface for each row of cells.
    pub(super) fn new(surface: &Surface) -> Self {
        let rows = cells(surface.outline());
        let all = || rows.iter().flat_map(|(_, row)| row.iter());
        let start = all().map(|span| columns(*span, CELL).start).min().unwrap_or(0);
        let end = all().map(|span| columns(*span, CELL).end).max().unwrap_or(0);
        let range = rows.range();
        let size = [usize::try_from(end - start).unwrap_or(0), range.len()];
        let mut heights = vec![f32::NAN; size[0] * size[1]];
        let lines = heights.par_chunks_mut(size[0].max(1)).zip(range.clone().into_par_iter());
        lines.for_each(|(line, j)| fill(line, surface, (start, j), rows.row(j)));
        Self { low: [start, range.start], size, heights }
    }

    /// Its first and last column, or row.
    pub(super) fn range(&self, axis: usize) -> [i32; 2] {
        let last = i32::try_from(self.size[axis]).unwrap_or(0) - 1;
        [self.low[axis], self.low[axis] + last]
    }

    /// How high the surface lies over a cell; `None` beside it.
    pub(super) fn at(&self, cell: Spot) -> Option<f64> {
        let [x, y] = [0, 1].map(|axis| usize::try_from(cell[axis] - self.low[axis]).ok());
        let (x, y) = (x.filter(|x| *x < self.size[0])?, y.filter(|y| *y < self.size[1])?);
        let z = self.heights[y * self.size[0] + x];
        (!z.is_nan()).then_some(f64::from(z))
    }

    /// How it rises along x and y at a cell, from those beside it.
    pub(super) fn rise(&self, [x, y]: Spot) -> [f64; 2] {
        let across = |before: Spot, after: Spot| {
            let (here, before, after) = (self.at([x, y]), self.at(before), self.at(after));
            let (from, to, cells) = match (before, here, after) {
                (Some(a), _, Some(b)) => (a, b, 2.0),
                (Some(a), Some(b), None) | (None, Some(a), Some(b)) => (a, b, 1.0),
                _ => return 0.0,
            };
            (to - from) / (cells * f64::from(CELL))
        };
        [across([x - 1, y], [x + 1, y]), across([x, y - 1], [x, y + 1])]
    }
}

/// The heights along a row of cells from column `start` on.
fn fill(line: &mut [f32], surface: &Surface, (start, j): (i32, i32), row: &[Span]) {
    let ends = row.first().zip(row.last());
    let Some((first, last)) = ends else { return };
    let point = |x: Coord| Point { x, y: j * CELL };
    let (a, b) = (first.start - CELL, last.end + CELL);
    let length = f64::from(b - a);
    let profile = surface.profile(point(a), point(b));
    let mut k = 0;
    for column in row.iter().flat_map(|&span| columns(span, CELL)) {
        let x = column * CELL;
        let share = f64::from(x - a) / length;
        while profile.get(k + 1).is_some_and(|next| next.0 < share) {
            k += 1;
        }
        let z = match (profile.get(k), profile.get(k + 1)) {
            (Some(&(from, low)), Some(&(to, high)))
                if from <= share && share <= to && to > from =>
            {
                Some(low + (high - low) * (share - from) / (to - from))
            }
            _ => surface.z(point(x)),
        };
        let at = usize::try_from(column - start).ok();
        if let (Some(place), Some(z)) = (at.and_then(|at| line.get_mut(at)), z) {
            *place = z as f32;
        }
    }
}
