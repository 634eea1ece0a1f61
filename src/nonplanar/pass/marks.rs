//! Places of a surface -> why each gets no skin.

use crate::geom::Point;
use crate::geom::spans::Rows;
use crate::nonplanar::field::Field;
use crate::nonplanar::grid::{self, STEP, Spot, cell_of, counted, place_at};
use crate::nonplanar::surface::Surface;
use crate::nonplanar::tally::Reason;
use crate::units::{Coord, nearest, to_mm};

/// Beside the surface.
const BESIDE: u8 = 0;

/// Nothing is said of it yet.
const OPEN: u8 = 1;

/// Flat without a tread: nothing is gained.
const LEVEL: u8 = u8::MAX;

/// The places of a surface, each with the first reason why it gets no skin.
#[derive(Debug, Clone, Default)]
pub(super) struct Marks {
    low: Spot,
    size: [usize; 2],
    of: Vec<u8>,
    /// Places near where the part ends upright.
    upright: Vec<bool>,
}

impl Marks {
    /// The places of a surface with this field, with nothing said of them.
    pub(super) fn new(field: &Field, surface: &Surface) -> Self {
        let [x, y] = [0, 1].map(|axis| {
            let [low, high] = field.range(axis);
            [low.div_euclid(2), high.div_euclid(2)]
        });
        let size = [x, y].map(|[low, high]| usize::try_from(high - low + 1).unwrap_or(0));
        let low = [x[0], y[0]];
        let all = size[0] * size[1];
        let mut marks = Self { low, size, of: vec![BESIDE; all], upright: vec![false; all] };
        surface.upright().iter().for_each(|&[a, b]| marks.raise(a, b));
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
        let [x, y] = counted(place, self.low)?;
        (x < self.size[0] && y < self.size[1]).then_some(y * self.size[0] + x)
    }

    /// The part ends upright along this way.
    fn raise(&mut self, a: Point, b: Point) {
        for at in along(a, b) {
            let [x, y] = place_at([to_mm(at.x), to_mm(at.y)]);
            for beside in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy])) {
                if let Some(at) = self.index(beside) {
                    self.upright[at] = true;
                }
            }
        }
    }

    /// Whether the part ends upright near a straight way.
    pub(super) fn is_upright(&self, a: Point, b: Point) -> bool {
        let is = |at: Point| self.index(place_at([to_mm(at.x), to_mm(at.y)]));
        along(a, b).filter_map(is).any(|at| self.upright[at])
    }

    /// A place gets no skin for this reason, unless another one was told before.
    pub(super) fn mark(&mut self, place: Spot, reason: Reason) {
        if let Some(at) = self.index(place).filter(|&at| self.of[at] == OPEN) {
            self.of[at] = OPEN + 1 + reason as u8;
        }
    }

    /// Places that are printed as well flat, unless something was told of them before.
    pub(super) fn mark_level(&mut self, rows: &Rows) {
        for place in grid::spots(rows, STEP) {
            if let Some(at) = self.index(place).filter(|&at| self.of[at] == OPEN) {
                self.of[at] = LEVEL;
            }
        }
    }

    /// Whether a place is printed as well flat.
    pub(super) fn is_level(&self, place: Spot) -> bool {
        self.index(place).is_some_and(|at| self.of[at] == LEVEL)
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

/// Points along a straight way, no further apart than places; both ends.
fn along(a: Point, b: Point) -> impl Iterator<Item = Point> {
    let count = (a.distance(b) / f64::from(STEP)).ceil().max(1.0);
    let at = move |k: usize| {
        let on = |a: Coord, b: Coord| {
            nearest(f64::from(a) + f64::from(b - a) * k as f64 / count) as Coord
        };
        Point { x: on(a.x, b.x), y: on(a.y, b.y) }
    };
    (0..=count as usize).map(at)
}
