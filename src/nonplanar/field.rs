//! Surface -> Field: its height over the middle of every cell.

use super::grid::{CELL, Spot, cells, columns};
use super::surface::Surface;
use crate::geom::Point;
use crate::geom::spans::{Rows, Span};
use crate::units::Coord;
use rayon::prelude::*;
use std::sync::Arc;

/// So many rows of cells are filled in one go.
const BAND: usize = 16;

/// How high a surface lies over the cells inside its outline, grid units.
#[derive(Debug)]
pub(super) struct Field {
    low: Spot,
    size: [usize; 2],
    /// Row by row; not a number beside the surface.
    heights: Vec<f32>,
}

/// The fields of some surfaces, in their order.
#[derive(Debug, Default)]
pub struct Fields(Vec<(Arc<Surface>, Field)>);

impl Fields {
    /// Of these surfaces.
    pub(super) fn new(known: impl Iterator<Item = (Arc<Surface>, Field)>) -> Self {
        Self(known.collect())
    }

    /// The fields of `surfaces`, in their order: those that are known, if they come in the same order, and
    /// new ones of the others.
    pub(super) fn of(self, surfaces: &[Arc<Surface>]) -> Vec<Field> {
        let mut known = self.0.into_iter().peekable();
        let known = surfaces.iter().map(|surface| {
            known.next_if(|(other, _)| Arc::ptr_eq(other, surface)).map(|(_, field)| field)
        });
        let known: Vec<Option<Field>> = known.collect();
        let all = known.into_par_iter().zip(surfaces);
        all.map(|(field, surface)| field.unwrap_or_else(|| Field::new(surface))).collect()
    }
}

impl Field {
    /// One walk over the surface for some rows of cells at a time.
    pub(super) fn new(surface: &Surface) -> Self {
        let rows = cells(surface.outline());
        let all = || rows.iter().flat_map(|(_, row)| row.iter());
        let start = all().map(|span| columns(*span, CELL).start).min().unwrap_or(0);
        let end = all().map(|span| columns(*span, CELL).end).max().unwrap_or(0);
        let range = rows.range();
        let size = [usize::try_from(end - start).unwrap_or(0), range.len()];
        let mut heights = vec![f32::NAN; size[0] * size[1]];
        let bands = heights.par_chunks_mut(BAND * size[0].max(1)).enumerate();
        bands.for_each(|(k, band)| {
            let first = range.start + (k * BAND) as i32;
            fill(band, surface, [start, first], size[0].max(1), &rows);
        });
        Self { low: [start, range.start], size, heights }
    }

    /// Its first and last column, or row.
    pub(super) fn range(&self, axis: usize) -> [i32; 2] {
        let last = i32::try_from(self.size[axis]).unwrap_or(0) - 1;
        [self.low[axis], self.low[axis] + last]
    }

    /// How high the surface lies over a cell; `None` beside it.
    pub(super) fn at(&self, cell: Spot) -> Option<f64> {
        let z = self.known(cell);
        (!z.is_nan()).then_some(f64::from(z))
    }

    /// How it rises along x and y at a cell, from those beside it.
    pub(super) fn rise(&self, [x, y]: Spot) -> [f64; 2] {
        if let Some([_, left, right, below, above]) = self.around([x, y]) {
            return [between(left, right), between(below, above)];
        }
        let across = |before: f32, here: f32, after: f32| {
            let (from, to, cells) = match [before, here, after].map(f32::is_nan) {
                [false, _, false] => (before, after, 2.0),
                [false, false, true] => (before, here, 1.0),
                [true, false, false] => (here, after, 1.0),
                _ => return 0.0,
            };
            (f64::from(to) - f64::from(from)) / (cells * f64::from(CELL))
        };
        let here = self.known([x, y]);
        [
            across(self.known([x - 1, y]), here, self.known([x + 1, y])),
            across(self.known([x, y - 1]), here, self.known([x, y + 1])),
        ]
    }

    /// How high it lies over a cell and how it rises there, as [`Self::at`] and [`Self::rise`].
    pub(super) fn plane(&self, cell: Spot) -> Option<(f64, [f64; 2])> {
        match self.around(cell) {
            Some([here, left, right, below, above]) => {
                Some((f64::from(here), [between(left, right), between(below, above)]))
            }
            None => Some((self.at(cell)?, self.rise(cell))),
        }
    }

    /// How high it lies over a cell and those to the left and right, below and above, if it lies over all of
    /// them: nearly everywhere.
    fn around(&self, [x, y]: Spot) -> Option<[f32; 5]> {
        let [x, y] = self.counted([x, y]);
        let [columns, rows] = self.size;
        if x == 0 || y == 0 || x + 1 >= columns || y + 1 >= rows {
            return None;
        }
        let at = y * columns + x;
        let z = |at: usize| self.heights[at];
        let all = [z(at), z(at - 1), z(at + 1), z(at - columns), z(at + columns)];
        // A sum with one that is no number is none.
        let sum = all[0] + all[1] + all[2] + all[3] + all[4];
        (!sum.is_nan()).then_some(all)
    }

    /// How high the surface lies over a cell; not a number beside it.
    #[inline]
    fn known(&self, cell: Spot) -> f32 {
        let [x, y] = self.counted(cell);
        if x < self.size[0] && y < self.size[1] {
            self.heights[y * self.size[0] + x]
        } else {
            f32::NAN
        }
    }

    /// The column and the row of a cell, from the first ones. What lies before these is far beyond the last ones
    /// as a number without sign.
    #[inline]
    fn counted(&self, [x, y]: Spot) -> [usize; 2] {
        [x.wrapping_sub(self.low[0]) as u32 as usize, y.wrapping_sub(self.low[1]) as u32 as usize]
    }
}

/// How a surface rises at a cell between these two beside it.
fn between(before: f32, after: f32) -> f64 {
    (f64::from(after) - f64::from(before)) / (2.0 * f64::from(CELL))
}

/// The heights in some rows of so many cells, from the cell `low` on.
fn fill(band: &mut [f32], surface: &Surface, low: Spot, columns: usize, rows: &Rows) {
    let lines = || (low[1]..).take(BAND).map(|j| (j, rows.row(j)));
    let ends = |(_, row): (i32, &[Span])| {
        let (first, last) = row.first().zip(row.last())?;
        Some([first.start - CELL, last.end + CELL])
    };
    let ways: Vec<Option<[Coord; 2]>> = lines().map(ends).collect();
    let profiles = surface.profiles((low[1], CELL), &ways);
    let all = band.chunks_mut(columns).zip(lines()).zip(ways).zip(profiles);
    for (((line, (j, row)), way), profile) in all {
        if let Some(way) = way {
            fill_row(line, (surface, &profile), (way, [low[0], j]), row);
        }
    }
}

/// The heights along a row of cells from the cell `low` on. The profile is that of the way from `a` to `b`.
fn fill_row(
    line: &mut [f32],
    (surface, profile): (&Surface, &[(f64, f64)]),
    ([a, b], low): ([Coord; 2], Spot),
    row: &[Span],
) {
    let length = f64::from(b - a);
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
            _ => surface.z(Point { x, y: low[1] * CELL }),
        };
        let at = usize::try_from(column - low[0]).ok();
        if let (Some(place), Some(z)) = (at.and_then(|at| line.get_mut(at)), z) {
            *place = z as f32;
        }
    }
}
