//! Pile: how high plastic stands on a grid, and where a head would touch it.
//!
//! - A *cell* is a square of the grid. It holds a whole number of grid units, rounded up: a pile is never
//!   lower than what stands.
//! - The *pyramid* above the cells: each square of a level is as high as the highest of the four below it,
//!   up to one square over all. Heights only rise, so a cell that is raised raises the squares above
//!   it, until one is as high already: on the whole that is one more step in three.
//! - *Branch and bound*: a square is left out with all its cells if its height, less the lowest place of
//!   the head over it, is not deeper than the deepest touch so far. Where nothing is touched, few squares
//!   are looked at.
//! - A touch of less than a micrometre is none: a file's own numbers are no finer.
//!
//! Of touches equally deep the first one counts, by rows and in them by columns.

use super::shape::Shape;
use super::{DEEPEST_PRESS, Head, Part};
use crate::units::{Bounded as _, Coord, UNITS_PER_MM, to_mm};
use std::ops::Range;

/// Touches less deep are none, mm.
pub const LEAST_TOUCH: f64 = 0.001;

/// Nothing stands there.
const EMPTY: Coord = Coord::MIN;

/// Rounding of decimals must not raise a cell by a unit.
const SLACK_UNITS: f64 = 1e-3;

/// How high plastic stands on a grid of square cells; a cell is -infinity where nothing stands.
#[derive(Debug, Clone)]
pub struct Pile {
    low: [f64; 2],
    cell: f64,
    /// What stands may reach so much further sideways than its cells, mm.
    wider: f64,
    /// The cells, then each level of the pyramid up to a single square.
    levels: Vec<Level>,
}

#[derive(Debug, Clone)]
struct Level {
    columns: usize,
    rows: usize,
    /// Row by row.
    heights: Vec<Coord>,
}

/// What a head touches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The part of the head.
    pub part: Part,
    /// How far the plastic reaches above that part, mm.
    pub depth: f64,
    /// The middle of the cell that is touched, mm.
    pub at: [f64; 2],
    /// How high that cell stands, mm.
    pub height: f64,
    /// Where the tip was, mm.
    pub tip: [f64; 3],
}

impl Pile {
    /// An empty pile over the rectangle from `low` to `high`, with cells of this side, mm.
    #[must_use]
    pub fn new(low: [f64; 2], high: [f64; 2], cell: f64) -> Self {
        let count = |axis: usize| ((high[axis] - low[axis]) / cell - 1e-6).ceil().max(1.0) as usize;
        let mut levels = vec![Level::new(count(0), count(1))];
        while let Some(last) = levels.last().filter(|last| last.columns * last.rows > 1) {
            levels.push(Level::new(last.columns.div_ceil(2), last.rows.div_ceil(2)));
        }
        Self { low, cell, wider: 0.0, levels }
    }

    /// The same where what stands may reach so much further sideways than its cells, mm. It holds for what
    /// lies beyond the ring where a touch may be press.
    #[must_use]
    pub fn wider(self, by: f64) -> Self {
        Self { wider: by, ..self }
    }

    /// One with the same cells, on which nothing stands.
    #[must_use]
    pub fn emptied(&self) -> Self {
        let levels = self.levels.iter().map(|level| Level::new(level.columns, level.rows));
        Self { levels: levels.collect(), ..*self }
    }

    /// Columns and rows of its cells.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.cells().columns, self.cells().rows]
    }

    /// The side of a cell, mm.
    #[cfg(test)]
    pub(super) fn side(&self) -> f64 {
        self.cell
    }

    /// The middle of a cell, column and row, mm.
    #[must_use]
    pub fn middle(&self, [column, row]: [usize; 2]) -> [f64; 2] {
        let [x, y] = self.corner([column, row]);
        [x + self.cell / 2.0, y + self.cell / 2.0]
    }

    /// The cell around a place; `None` beside the grid.
    #[cfg(test)]
    pub(super) fn cell(&self, at: [f64; 2]) -> Option<[usize; 2]> {
        let along = |axis: usize| ((at[axis] - self.low[axis]) / self.cell).floor();
        let (column, row, [columns, rows]) = (along(0), along(1), self.size());
        let inside = column >= 0.0 && row >= 0.0 && column < columns as f64 && row < rows as f64;
        inside.then_some([column as usize, row as usize])
    }

    /// How high a cell stands, mm.
    #[must_use]
    pub fn height(&self, [column, row]: [usize; 2]) -> f64 {
        let cells = self.cells();
        let known = column < cells.columns && row < cells.rows;
        if known { mm(cells.at([column, row])) } else { f64::NEG_INFINITY }
    }

    /// How high the highest cell stands, mm.
    #[must_use]
    pub fn highest(&self) -> f64 {
        self.levels.last().map_or(f64::NEG_INFINITY, |top| mm(top.at([0, 0])))
    }

    /// A cell stands at least so high, mm. What lies beside the grid is left out.
    pub fn raise(&mut self, [column, row]: [usize; 2], z: f64) {
        self.raise_row(row, column..column + 1, z);
    }

    /// The cells from `columns.start` on of a row stand at least so high, mm.
    pub fn raise_row(&mut self, row: usize, columns: Range<usize>, z: f64) {
        let [all, rows] = self.size();
        let (mut from, mut to, mut row) = (columns.start, columns.end.min(all), row);
        if row >= rows || from >= to || z.is_nan() || z == f64::NEG_INFINITY {
            return;
        }
        let z = raised(z);
        for level in &mut self.levels {
            let start = row * level.columns;
            let mut rises = false;
            for height in &mut level.heights[start + from..start + to] {
                rises |= *height < z;
                *height = (*height).max(z);
            }
            if !rises {
                // All above them are as high already.
                return;
            }
            (from, to, row) = (from / 2, to.div_ceil(2), row / 2);
        }
    }

    /// The cells from `column` on of a row stand at least as high as these, mm; where one is not a number, nothing
    /// is told.
    pub fn raise_cells(&mut self, [column, row]: [usize; 2], heights: impl Iterator<Item = f64>) {
        let Some((cells, above)) = self.levels.split_first_mut() else { return };
        if row >= cells.rows {
            return;
        }
        let start = row * cells.columns;
        let line = &mut cells.heights[start..start + cells.columns];
        // The columns that rise.
        let (mut from, mut to) = (line.len(), 0);
        for ((column, height), z) in line.iter_mut().enumerate().skip(column).zip(heights) {
            let z = if z.is_nan() { EMPTY } else { raised(z) };
            if z > *height {
                *height = z;
                (from, to) = (from.min(column), column + 1);
            }
        }
        let mut row = row;
        let mut below: &Level = cells;
        for level in above {
            if from >= to {
                // All above them are as high already.
                return;
            }
            let line = &below.heights[row * below.columns..(row + 1) * below.columns];
            row /= 2;
            let squares = from / 2..to.div_ceil(2);
            (from, to) = (squares.end, squares.start);
            for square in squares {
                let two = &line[2 * square..(2 * square + 2).min(line.len())];
                let highest = two.iter().copied().max().unwrap_or(EMPTY);
                let height = &mut level.heights[row * level.columns + square];
                if highest > *height {
                    *height = highest;
                    (from, to) = (from.min(square), square + 1);
                }
            }
            below = level;
        }
    }

    /// The deepest touch of `head` with its tip at `tip` (mm) among those that `spare` does not allow. A
    /// cell's whole square counts.
    #[must_use]
    pub fn hit(&self, head: &Head, tip: [f64; 3], spare: &dyn Fn(&Hit) -> bool) -> Option<Hit> {
        self.search(head, tip, [None, None], spare)
    }

    /// As [`Self::hit`] of cells that come as near to the tip as this, seen from above, mm.
    #[must_use]
    pub fn hit_within(
        &self,
        head: &Head,
        tip: [f64; 3],
        radius: f64,
        spare: &dyn Fn(&Hit) -> bool,
    ) -> Option<Hit> {
        self.search(head, tip, [None, Some(radius)], spare)
    }

    /// As [`Self::hit`] with [`Head::presses`] for `spare`, while a layer of this height is printed, mm: but
    /// several times as fast, since squares that are only pressed are left out as a whole.
    #[must_use]
    pub fn hit_printing(&self, head: &Head, tip: [f64; 3], layer_height: f64) -> Option<Hit> {
        let most = DEEPEST_PRESS * layer_height;
        self.hit_but_press(head, tip, most, &|hit| head.presses(hit, layer_height))
    }

    /// As [`Self::hit`], where `spare` allows all that is no deeper than `most`, mm, within [`Head::press_radius`] of
    /// the tip: faster, as [`Self::hit_printing`] is.
    #[must_use]
    pub fn hit_but_press(
        &self,
        head: &Head,
        tip: [f64; 3],
        most: f64,
        spare: &dyn Fn(&Hit) -> bool,
    ) -> Option<Hit> {
        self.search(head, tip, [Some(most), None], spare)
    }

    fn search(
        &self,
        head: &Head,
        tip: [f64; 3],
        [press, within]: [Option<f64>; 2],
        spare: &dyn Fn(&Hit) -> bool,
    ) -> Option<Hit> {
        let shape = Shape::of(head);
        let press = press.map(|most| [head.press_radius().powi(2), most]);
        let within2 = within.map(|radius| radius * radius);
        let mut search = Search { pile: self, shape, tip, press, within2, spare, best: None };
        let mut open: Vec<(f64, usize, [usize; 2])> = Vec::new();
        self.in_reach(&shape, tip, within, |level, square| {
            open.extend(search.depth(level, square).map(|depth| (depth, level, square)));
        });
        open.sort_by(|one, other| other.0.total_cmp(&one.0));
        for (depth, level, square) in open {
            search.down(level, square, depth);
        }
        search.best.map(|(hit, _)| hit)
    }

    /// The squares, four at most, under all of the head that may touch anything.
    fn in_reach(
        &self,
        shape: &Shape<'_>,
        tip: [f64; 3],
        within: Option<f64>,
        mut with: impl FnMut(usize, [usize; 2]),
    ) {
        let most = self.highest() - tip[2];
        if most <= LEAST_TOUCH {
            return;
        }
        // A cell more, for rounding.
        let reach = shape.reach_below(most) + self.wider;
        let reach = within.map_or(reach, |within| reach.min(within)) + self.cell;
        let top = self.levels.len() - 1;
        let side = |level: usize| self.cell * (1_u64 << level) as f64;
        let level = (0..top).find(|&level| side(level) >= 2.0 * reach).unwrap_or(top);
        let Level { columns, rows, .. } = self.levels[level];
        let along = |axis: usize, count: usize| {
            let at = |by: f64| ((tip[axis] + by - self.low[axis]) / side(level)).floor();
            let (first, last) = (at(-reach).max(0.0), at(reach).min(count as f64 - 1.0));
            if first > last { 0..0 } else { first as usize..last as usize + 1 }
        };
        for row in along(1, rows) {
            along(0, columns).for_each(|column| with(level, [column, row]));
        }
    }

    /// Whether `head` touches nothing, press neither, wherever its tip is in the box from `low` to `high`,
    /// mm. It may say no where that is so.
    #[must_use]
    pub fn is_clear(&self, head: &Head, low: [f64; 3], high: [f64; 3]) -> bool {
        let shape = Shape::of(head);
        let mut open = vec![(self.levels.len() - 1, [0, 0])];
        while let Some((level, square)) = open.pop() {
            let height = mm(self.levels[level].at(square));
            let [from, to] = self.bounds(level, square);
            let (near, far) =
                ([from[0] - high[0], from[1] - high[1]], [to[0] - low[0], to[1] - low[1]]);
            let (near, far) = (
                [near[0] - self.wider, near[1] - self.wider],
                [far[0] + self.wider, far[1] + self.wider],
            );
            if height - low[2] - shape.lowest(near, far).0 <= LEAST_TOUCH {
                continue;
            }
            if level == 0 {
                return false;
            }
            open.extend(self.below(level, square).map(|square| (level - 1, square)));
        }
        true
    }

    fn cells(&self) -> &Level {
        // There always is one.
        &self.levels[0]
    }

    /// The low corner of a cell.
    #[inline]
    fn corner(&self, [column, row]: [usize; 2]) -> [f64; 2] {
        [self.side_at(column, 0), self.side_at(row, 1)]
    }

    /// Where a column begins along x, or a row along y.
    #[inline]
    fn side_at(&self, cell: usize, axis: usize) -> f64 {
        self.low[axis] + f64::from(cell as u32) * self.cell
    }

    /// The corners of a square of the pyramid.
    #[inline]
    fn bounds(&self, level: usize, [column, row]: [usize; 2]) -> [[f64; 2]; 2] {
        let corner = |by: usize| self.corner([(column + by) << level, (row + by) << level]);
        [corner(0), corner(1)]
    }

    /// The squares below one that is no cell.
    fn below(&self, level: usize, [column, row]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
        let Level { columns, rows, .. } = self.levels[level - 1];
        let all = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| [2 * column + x, 2 * row + y]);
        all.into_iter().filter(move |[column, row]| *column < columns && *row < rows)
    }
}

impl Level {
    fn new(columns: usize, rows: usize) -> Self {
        Self { columns, rows, heights: vec![EMPTY; columns * rows] }
    }

    fn at(&self, [column, row]: [usize; 2]) -> Coord {
        self.heights[row * self.columns + column]
    }
}

/// The height of a cell that stands so high, mm.
fn raised(z: f64) -> Coord {
    (z * UNITS_PER_MM - SLACK_UNITS).ceil() as Coord
}

fn mm(height: Coord) -> f64 {
    if height == EMPTY { f64::NEG_INFINITY } else { to_mm(height) }
}

/// The way down a pyramid to the deepest touch.
struct Search<'a> {
    pile: &'a Pile,
    shape: Shape<'a>,
    tip: [f64; 3],
    /// Squares that lie as near as this all over, squared, and are not touched deeper than this are left out.
    press: Option<[f64; 2]>,
    /// Squares further away than this all over, squared, are left out.
    within2: Option<f64>,
    spare: &'a dyn Fn(&Hit) -> bool,
    /// The deepest touch so far, and its row and column.
    best: Option<(Hit, [usize; 2])>,
}

impl Search<'_> {
    /// Looks at a square that may be touched so deep, and at what lies below it, the deepest first.
    fn down(&mut self, level: usize, square: [usize; 2], depth: f64) {
        // The row and the column of its first cell.
        let first = [square[1] << level, square[0] << level];
        let is_deepest =
            |(best, at): (Hit, [usize; 2])| depth > best.depth || depth == best.depth && first < at;
        if !self.best.is_none_or(is_deepest) {
            return;
        }
        if level == 0 {
            return self.touch(square, depth);
        }
        let Level { columns, rows, .. } = self.pile.levels[level - 1];
        let [column, row] = [2 * square[0], 2 * square[1]];
        let mut open = [(f64::NEG_INFINITY, [0, 0]); 4];
        let mut count = 0;
        // No iterators here: this is where the time goes.
        for row in row..(row + 2).min(rows) {
            for column in column..(column + 2).min(columns) {
                if let Some(depth) = self.depth(level - 1, [column, row]) {
                    let mut at = count;
                    while at > 0 && open[at - 1].0 < depth {
                        open[at] = open[at - 1];
                        at -= 1;
                    }
                    open[at] = (depth, [column, row]);
                    count += 1;
                }
            }
        }
        for (depth, square) in open.into_iter().take(count) {
            self.down(level - 1, square, depth);
        }
    }

    /// How deep a square may be touched; `None` if it is not, or only pressed. Nothing is mapped here: that is
    /// a call for each square.
    fn depth(&self, level: usize, square: [usize; 2]) -> Option<f64> {
        let height = self.pile.levels[level].at(square);
        // Most of what is looked at lies below the tip, or is empty: EMPTY is lower than any tip.
        let above = to_mm(height) - self.tip[2];
        if above <= LEAST_TOUCH {
            return None;
        }
        let [low, high] = self.beside(level, square);
        if self.within2.is_some_and(|within2| nearest2(low, high) > within2) {
            return None;
        }
        let [from, to] = self.widened([low, high]);
        let depth = above - self.shape.lowest(from, to).0;
        (depth > LEAST_TOUCH && !self.is_press(depth, low, high)).then_some(depth)
    }

    /// The corners of a square, seen from the tip.
    fn beside(&self, level: usize, square: [usize; 2]) -> [[f64; 2]; 2] {
        let ([low, high], [x, y, _]) = (self.pile.bounds(level, square), self.tip);
        [[low[0] - x, low[1] - y], [high[0] - x, high[1] - y]]
    }

    /// The same, wider by what may stand beside its cells. Where all of a square is near enough for press, its
    /// cells are as wide as they are.
    fn widened(&self, [low, high]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let wider = self.pile.wider;
        let near = self.shape.press_radius();
        if wider <= 0.0 || furthest2(low, high) <= near * near {
            return [low, high];
        }
        [[low[0] - wider, low[1] - wider], [high[0] + wider, high[1] + wider]]
    }

    /// A cell that is touched deeper than any other so far.
    fn touch(&mut self, square: [usize; 2], depth: f64) {
        let [low, high] = self.widened(self.beside(0, square));
        let Some(part) = self.shape.lowest(low, high).1 else { return };
        let (at, height) = (self.pile.middle(square), self.pile.height(square));
        let hit = Hit { part, depth, at, height, tip: self.tip };
        if !(self.spare)(&hit) {
            self.best = Some((hit, [square[1], square[0]]));
        }
    }

    /// Whether a square is only pressed.
    fn is_press(&self, depth: f64, low: [f64; 2], high: [f64; 2]) -> bool {
        let Some([near, most]) = self.press else { return false };
        depth <= most && furthest2(low, high) <= near
    }
}

/// The squared distance of a square's nearest place from the tip.
fn nearest2(low: [f64; 2], high: [f64; 2]) -> f64 {
    let nearest = |axis: usize| low[axis].at_least(-high[axis]).at_least(0.0);
    nearest(0) * nearest(0) + nearest(1) * nearest(1)
}

/// The squared distance of a square's furthest corner from the tip.
fn furthest2(low: [f64; 2], high: [f64; 2]) -> f64 {
    let furthest = |axis: usize| low[axis].abs().at_least(high[axis].abs());
    furthest(0) * furthest(0) + furthest(1) * furthest(1)
}
