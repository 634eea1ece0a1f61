//! Places of a surface -> why each gets no skin.

use crate::geom::spans::Rows;
use crate::nonplanar::field::Field;
use crate::nonplanar::grid::{self, STEP, Spot, cell_of};
use crate::nonplanar::tally::Reason;

/// Beside the surface.
const BESIDE: u8 = 0;

/// Nothing is said of it yet.
const OPEN: u8 = 1;

/// The places of a surface, each with the first reason why it gets no skin.
#[derive(Debug)]
pub(super) struct Marks {
    low: Spot,
    size: [usize; 2],
    of: Vec<u8>,
}

impl Marks {
    /// The places of a field, with nothing said of them.
    pub(super) fn new(field: &Field) -> Self {
        let [x, y] = [0, 1].map(|axis| {
            let [low, high] = field.range(axis);
            [low.div_euclid(2), high.div_euclid(2)]
        });
        let size = [x, y].map(|[low, high]| usize::try_from(high - low + 1).unwrap_or(0));
        let low = [x[0], y[0]];
        let mut marks = Self { low, size, of: vec![BESIDE; size[0] * size[1]] };
        for (j, row) in (y[0]..=y[1]).enumerate() {
            for (i, column) in (x[0]..=x[1]).enumerate() {
                if field.at(cell_of([column, row])).is_some() {
                    marks.of[j * size[0] + i] = OPEN;
                }
            }
        }
        marks
    }

    fn index(&self, place: Spot) -> Option<usize> {
        let [x, y] = [0, 1].map(|axis| usize::try_from(place[axis] - self.low[axis]).ok());
        let (x, y) = (x.filter(|x| *x < self.size[0])?, y.filter(|y| *y < self.size[1])?);
        Some(y * self.size[0] + x)
    }

    /// A place gets no skin for this reason, unless another one was told before.
    pub(super) fn mark(&mut self, place: Spot, reason: Reason) {
        if let Some(at) = self.index(place).filter(|&at| self.of[at] == OPEN) {
            self.of[at] = OPEN + 1 + reason as u8;
        }
    }

    /// The reason that was told for a place.
    pub(super) fn reason(&self, place: Spot) -> Option<Reason> {
        let of = self.of[self.index(place)?];
        Reason::ALL.get(usize::from(of.checked_sub(OPEN + 1)?)).copied()
    }

    /// The places of the surface, row by row.
    pub(super) fn places(&self) -> impl Iterator<Item = Spot> + use<'_> {
        let wide = self.size[0].max(1);
        let spot =
            move |at: usize| [self.low[0] + (at % wide) as i32, self.low[1] + (at / wide) as i32];
        (0..self.of.len()).filter(|&at| self.of[at] != BESIDE).map(spot)
    }

    /// Marks all places in some rows.
    pub(super) fn mark_all(&mut self, rows: &Rows, reason: impl Fn(Spot) -> Reason) {
        for place in grid::spots(rows, STEP) {
            self.mark(place, reason(place));
        }
    }
}
