//! A line with round ends -> what it covers, row by row.

use super::grid::Grid;
use super::rows::Lattice;
use crate::reader::print::Step;
use nalgebra::Vector2;

/// All places within `radius` of the stretch from `from` to `to`, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Capsule {
    pub(super) from: [f64; 2],
    pub(super) to: [f64; 2],
    pub(super) radius: f64,
}

impl Capsule {
    /// What a line covers, as wide as the part `share` of its width.
    pub(super) fn of(step: &Step, share: f64) -> Self {
        let flat = |at: [f32; 3]| [f64::from(at[0]), f64::from(at[1])];
        let radius = f64::from(step.width) * share / 2.0;
        Self { from: flat(step.from), to: flat(step.to), radius }
    }

    /// Lowest and highest x and y.
    pub(super) fn extent(&self) -> ([f64; 2], [f64; 2]) {
        let (from, to) = (Vector2::from(self.from), Vector2::from(self.to));
        let (low, high) = from.inf_sup(&to);
        (low.add_scalar(-self.radius).into(), high.add_scalar(self.radius).into())
    }

    /// Hands each row's pixels to `sink`.
    pub(super) fn rows(&self, grid: &Grid, mut sink: impl FnMut(usize, std::ops::Range<usize>)) {
        let (low, high) = self.extent();
        for row in grid.span(1, low[1], high[1]) {
            let y = grid.middle(0, row)[1];
            if let Some((from, to)) = self.chord(y) {
                let span = grid.span(0, from, to);
                if !span.is_empty() {
                    sink(row, span);
                }
            }
        }
    }

    /// Hands what it covers of each row to `sink`: from and to, mm.
    pub(super) fn chords(&self, lattice: Lattice, mut sink: impl FnMut(i32, f64, f64)) {
        let (low, high) = self.extent();
        for row in lattice.range(low[1], high[1]) {
            if let Some((from, to)) = self.chord(lattice.middle(row)) {
                sink(row, from, to);
            }
        }
    }

    /// What of the line at height `y` lies within: one stretch, since the shape has no dents.
    fn chord(&self, y: f64) -> Option<(f64, f64)> {
        let mut found: Option<(f64, f64)> = None;
        let mut join = |from: f64, to: f64| {
            let (low, high) = found.unwrap_or((from, to));
            found = Some((low.min(from), high.max(to)));
        };
        for end in [self.from, self.to] {
            let square = self.radius * self.radius - (y - end[1]) * (y - end[1]);
            if square > 0.0 {
                let half = square.sqrt();
                join(end[0] - half, end[0] + half);
            }
        }
        if let Some((from, to)) = self.chord_between(y) {
            join(from, to);
        }
        found
    }

    /// As [`Self::chord`], of the rectangle between the ends.
    fn chord_between(&self, y: f64) -> Option<(f64, f64)> {
        let way = [self.to[0] - self.from[0], self.to[1] - self.from[1]];
        let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
        if length == 0.0 {
            return None;
        }
        let along = way.map(|side| side / length);
        let up = y - self.from[1];
        // Along the line between its ends, and across it within the radius.
        let (a, b) = limits(along[0], along[1] * up, 0.0, length)?;
        let (c, d) = limits(-along[1], along[0] * up, -self.radius, self.radius)?;
        let (from, to) = (a.max(c), b.min(d));
        (from < to).then_some((self.from[0] + from, self.from[0] + to))
    }
}

/// Where `low <= slope · x + rest <= high`; all x, without end, if the slope is 0 and it holds.
fn limits(slope: f64, rest: f64, low: f64, high: f64) -> Option<(f64, f64)> {
    if slope.abs() < 1e-12 {
        return (low..=high).contains(&rest).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (a, b) = ((low - rest) / slope, (high - rest) / slope);
    Some((a.min(b), a.max(b)))
}
