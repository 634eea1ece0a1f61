//! Lines of a layer -> Laid: which of them lie near a line, and over which part of it.
//!
//! Words used here: a *chain* is lines one after the other without a break; a *bead* is a line as it is
//! laid ([`bead`](super::bead)); a *cell* is a square of the bed.
//!
//! Beads are sorted into the cells that they reach into. Those near a line are in the cells that the
//! line reaches into, itself as wide as it is. So what a line costs is how many lines are near it, not
//! how long it is.

use super::bead::{Bead, both, within};
use crate::geom::cells::Cells;
use crate::geom::segment;
use crate::reader::print::Step;
use crate::units::Bounded as _;
use std::ops::Range;

/// Side of a cell, mm: four lines. Long lines lie in many smaller ones, and are seen in each.
const CELL: f64 = 2.0;

/// How far around a bead it is sorted into cells, mm: lines of one layer touch within it, so that a line finds
/// those that it touches in its own cells.
pub(crate) const AROUND: f64 = 0.07;

/// Cells for each bead at most, and at least so many.
const MOST_CELLS: (f64, f64) = (4.0, 256.0);

/// The lines of a layer, but for those that iron.
#[derive(Debug, Default)]
pub(crate) struct Laid {
    pub(crate) beads: Vec<Bead>,
    /// The beads of each chain.
    pub(crate) chains: Vec<Range<usize>>,
    field: Field,
    cells: Option<Cells<u32>>,
    /// What each bead covers at most.
    boxes: Vec<Extent>,
    /// The cells of each bead, row by row, and where those of each bead end.
    rows: Vec<Range<u32>>,
    ends: Vec<u32>,
    /// The highest that its beads carry something at, and what each carries at least, mm.
    pub(crate) top: f64,
    pub(crate) least_top: f64,
    /// The highest way of the nozzle, mm.
    pub(crate) highest: f64,
}

/// Lowest x and y of what a line covers, and the highest, negative, so that all four are compared alike; mm,
/// rounded outwards to half the bytes.
#[derive(Debug, Clone, Copy)]
struct Extent([f32; 4]);

/// Where cells lie.
#[derive(Debug, Default, Clone, Copy)]
struct Field {
    low: [f64; 2],
    side: f64,
    count: [usize; 2],
}

impl Laid {
    /// All of it may carry with the gap of support.
    pub(crate) fn into_support(mut self) -> Self {
        self.beads.iter_mut().for_each(|bead| bead.is_support = true);
        self.top = self.beads.iter().map(Bead::top).fold(self.top, f64::max);
        self
    }

    /// Of the chains of a layer, by its moves.
    pub(crate) fn new(moves: &[Step], chains: impl Iterator<Item = Range<usize>>) -> Self {
        let mut laid = Self::default();
        for chain in chains {
            let (first, mut reach) = (laid.beads.len(), 0.0);
            for step in chain {
                let bead = Bead::of(&moves[step]);
                reach += bead.length;
                let chain = laid.chains.len() as u32;
                laid.beads.push(Bead { chain, step: step as u32, reach, ..bead });
            }
            laid.chains.push(first..laid.beads.len());
        }
        laid.sorted()
    }

    /// Of beads in any order, each a chain of its own.
    pub(crate) fn of(beads: Vec<Bead>) -> Self {
        let chains = (0..beads.len()).map(|bead| bead..bead + 1).collect();
        Self { beads, chains, ..Self::default() }.sorted()
    }

    fn sorted(mut self) -> Self {
        self.least_top = f64::INFINITY;
        for bead in &self.beads {
            self.top = self.top.max(bead.top());
            self.least_top = self.least_top.min(bead.top());
            self.highest = self.highest.max(bead.highest());
        }
        self.boxes = self.beads.iter().map(|bead| Extent::of(bead, 0.0)).collect();
        self.field = Field::over(&self.boxes);
        for bead in &self.beads {
            let cells = self.field.reach(bead, AROUND).filter(|cells| !cells.is_empty());
            self.rows.extend(cells.map(|cells| cells.start as u32..cells.end as u32));
            self.ends.push(self.rows.len() as u32);
        }
        let count = self.field.count[0] * self.field.count[1];
        let beads = || 0..self.beads.len() as u32;
        let reach = |bead: u32| self.rows_of(bead as usize).iter().cloned().flatten();
        let reach = |bead: u32| reach(bead).map(|cell| cell as usize);
        self.cells = Some(Cells::new(count, beads, reach));
        self
    }

    /// The cells that a bead is sorted into.
    fn rows_of(&self, bead: usize) -> &[Range<u32>] {
        let first = bead.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.rows[first as usize..self.ends[bead] as usize]
    }

    /// Hands the beads that may lie within `more` mm of a line to `sink`, each once, in any order.
    pub(crate) fn near(
        &self,
        line: &Bead,
        more: f64,
        seen: &mut Seen,
        sink: impl FnMut(usize, &Bead),
    ) {
        let cells = self.field.reach(line, more);
        self.among((self.beads.len(), Extent::of(line, more)), cells, seen, sink);
    }

    /// Hands the beads before one of them that may lie within [`AROUND`] of it to `sink`, as [`Self::near`].
    pub(crate) fn before(&self, bead: usize, seen: &mut Seen, sink: impl FnMut(usize, &Bead)) {
        let cells = self.rows_of(bead).iter().map(|row| row.start as usize..row.end as usize);
        self.among((bead, Extent::of(&self.beads[bead], AROUND)), cells, seen, sink);
    }

    /// Hands the beads before `end` in some cells that may reach into a box to `sink`, each once.
    #[inline]
    fn among(
        &self,
        (end, own): (usize, Extent),
        rows: impl Iterator<Item = Range<usize>>,
        seen: &mut Seen,
        mut sink: impl FnMut(usize, &Bead),
    ) {
        let Some(cells) = &self.cells else { return };
        seen.next(self.beads.len());
        for row in rows {
            let (among, mut count) = (cells.of(row), 0);
            let found = seen.room(among.len());
            for &bead in among {
                found[count] = bead;
                let one = bead as usize;
                count += usize::from((one < end) & self.boxes[one].meets(&own));
            }
            for k in 0..count {
                let bead = seen.found[k] as usize;
                if seen.is_new(bead) {
                    sink(bead, &self.beads[bead]);
                }
            }
        }
    }

    /// Whether beads of both layers may lie on one another.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        let ends = |laid: &Self, axis: usize| {
            let field = laid.field;
            [field.low[axis], field.low[axis] + field.side * field.count[axis] as f64]
        };
        (0..2).all(|axis| both(ends(self, axis), ends(other, axis)).is_some())
    }

    /// Whether some bead that `counts` covers a place.
    pub(crate) fn covers(&self, at: [f64; 2], counts: impl Fn(usize, &Bead) -> bool) -> bool {
        let Some(cells) = &self.cells else { return false };
        let Some(cell) = self.field.cell(at) else { return false };
        cells.of(cell..cell + 1).iter().any(|&bead| {
            let one = &self.beads[bead as usize];
            counts(bead as usize, one) && one.is_near(at, one.radius)
        })
    }
}

/// Which beads have been handed out for a line.
#[derive(Debug, Default)]
pub(crate) struct Seen {
    last: Vec<u32>,
    line: u32,
    /// Those of some cells that may be near a line.
    found: Vec<u32>,
}

impl Seen {
    fn next(&mut self, count: usize) {
        if self.last.len() < count {
            self.last.resize(count, 0);
        }
        self.line += 1;
    }

    /// Room for so many beads.
    fn room(&mut self, count: usize) -> &mut [u32] {
        if self.found.len() < count {
            self.found.resize(count, 0);
        }
        &mut self.found[..count]
    }

    fn is_new(&mut self, bead: usize) -> bool {
        std::mem::replace(&mut self.last[bead], self.line) != self.line
    }
}

impl Extent {
    /// Of all places within `more` mm of a bead.
    fn of(bead: &Bead, more: f64) -> Self {
        let ([x, y], [to_x, to_y]) = (bead.from, bead.place(1.0));
        let radius = bead.radius + more;
        let low = [x.at_most(to_x) - radius, y.at_most(to_y) - radius];
        let high = [x.at_least(to_x) + radius, y.at_least(to_y) + radius];
        Self([low[0], low[1], -high[0], -high[1]].map(rounded_down))
    }

    /// Lowest and highest of an axis.
    fn ends(self, axis: usize) -> [f64; 2] {
        [f64::from(self.0[axis]), f64::from(-self.0[axis + 2])]
    }

    /// Whether it has a place in common with another. No way is taken before all is compared: which one cannot be
    /// foreseen.
    #[inline]
    fn meets(&self, other: &Self) -> bool {
        let ([x, y, to_x, to_y], own) = (other.0, self.0);
        let most = [-to_x, -to_y, -x, -y];
        (0..4).fold(true, |all, k| all & (own[k] <= most[k]))
    }
}

/// The next lower number of 32 bits, or the same.
fn rounded_down(mm: f64) -> f32 {
    let near = mm as f32;
    if f64::from(near) > mm { near.next_down() } else { near }
}

impl Field {
    /// Over all beads, by what they cover.
    fn over(boxes: &[Extent]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for one in boxes {
            for axis in 0..2 {
                let [from, to] = one.ends(axis);
                low[axis] = low[axis].at_most(from);
                high[axis] = high[axis].at_least(to);
            }
        }
        if boxes.is_empty() {
            return Self { low: [0.0; 2], side: CELL, count: [1; 2] };
        }
        let sides = segment::way(low, high);
        let most = MOST_CELLS.0 * boxes.len() as f64 + MOST_CELLS.1;
        let longest = sides[0].max(sides[1]);
        let side = CELL.max((sides[0] * sides[1] / most).sqrt()).max(longest / most);
        Self { low, side, count: sides.map(|length| (length / side) as usize + 1) }
    }

    fn cell(&self, at: [f64; 2]) -> Option<usize> {
        let x = (at[0] - self.low[0]) / self.side;
        let y = (at[1] - self.low[1]) / self.side;
        let is_in = x >= 0.0 && y >= 0.0 && x < self.count[0] as f64 && y < self.count[1] as f64;
        is_in.then_some(x as usize + y as usize * self.count[0])
    }

    /// The cells within `more` mm of a bead: those of one row after the other.
    #[inline]
    fn reach(self, bead: &Bead, more: f64) -> impl Iterator<Item = Range<usize>> {
        let radius = bead.radius + more;
        // In cells from the lowest corner.
        let scale = 1.0 / self.side;
        let (radius, length) = (radius * scale, bead.length * scale);
        let x = (bead.from[0] - self.low[0]) * scale;
        let y = (bead.from[1] - self.low[1]) * scale;
        let (dx, dy) = (bead.along[0] * length, bead.along[1] * length);
        let span = move |from: f64, to: f64, count: usize| {
            let first = (from - radius).at_least(0.0) as usize;
            let end = (to + radius + 1.0).at_least(0.0) as usize;
            first..end.min(count)
        };
        let (low, high) = (y.at_most(y + dy), y.at_least(y + dy));
        span(low, high, self.count[1]).map(move |row| {
            let bounds = [row as f64 - radius, row as f64 + 1.0 + radius];
            // Most lines are short: all of them is near the row.
            let is_whole = bounds[0] <= low && high <= bounds[1];
            let part = if is_whole { Some([0.0, 1.0]) } else { within(y, dy, bounds) };
            let Some([from, to]) = part else { return 0..0 };
            let (from, to) = (x + from * dx, x + to * dx);
            let columns = span(from.at_most(to), from.at_least(to), self.count[0]);
            let first = row * self.count[0];
            if columns.is_empty() { 0..0 } else { first + columns.start..first + columns.end }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reader::Role;
    use proptest::prelude::*;

    fn step(from: [f64; 2], to: [f64; 2], width: f64) -> Step {
        let at = |[x, y]: [f64; 2]| [x as f32, y as f32, 0.2];
        let (filament, feed, height) = (1.0, 1.0, 0.2);
        let width = width as f32;
        Step {
            from: at(from),
            to: at(to),
            filament,
            feed,
            width,
            height,
            role: Role::Skin,
            line: 1,
        }
    }

    proptest! {
        #[test]
        fn all_beads_near_a_line_are_found_once(
            lines in prop::collection::vec([0.0..30.0_f64, 0.0..30.0_f64, -9.0..9.0_f64, -9.0..9.0_f64], 1..40),
            line in [-5.0..35.0_f64, -5.0..35.0_f64, -9.0..9.0_f64, -9.0..9.0_f64],
        ) {
            let of = |[x, y, dx, dy]: [f64; 4]| step([x, y], [x + dx, y + dy], 0.5);
            let moves: Vec<Step> = lines.into_iter().map(of).collect();
            let laid = Laid::new(&moves, (0..moves.len()).map(|k| k..k + 1));
            let (line, mut seen) = (Bead::of(&of(line)), Seen::default());
            for _ in 0..2 {
                let mut found = Vec::new();
                laid.near(&line, 0.3, &mut seen, |k, _| found.push(k));
                found.sort_unstable();
                prop_assert!(found.windows(2).all(|two| two[0] < two[1]));
                for (k, bead) in laid.beads.iter().enumerate() {
                    if line.way(bead, bead.radius + line.radius + 0.3).is_some() {
                        prop_assert!(found.contains(&k));
                    }
                }
            }
            for bead in &laid.beads {
                prop_assert!(laid.covers(bead.place(0.5), |_, _| true));
            }
        }
    }
}
