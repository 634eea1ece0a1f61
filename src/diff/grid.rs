//! Lines -> Grid: which lines are near a line or a place, without looking at all of them.

use super::line::{Line, Point};

/// Side of a cell at least, mm.
const LEAST_CELL: f64 = 1.0;

/// Cells that a line of mean length goes through, about.
const CELLS_OF_A_LINE: f64 = 4.0;

/// Lines by the square cells of the plane that they go through.
pub(super) struct Grid<'a> {
    pub(super) lines: &'a [Line],
    low: [f64; 2],
    cell: f64,
    /// Number of cells in x and in y.
    size: [i64; 2],
    /// Where each cell's lines begin in `members`; one more for the end.
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl<'a> Grid<'a> {
    /// Lays out `lines`, of which there is at least one.
    pub(super) fn new(lines: &'a [Line]) -> Self {
        let mut low = [f64::MAX; 2];
        let mut high = [f64::MIN; 2];
        let mut length = 0.0;
        for line in lines {
            length += line.length;
            for point in [line.from, line.to] {
                for axis in 0..2 {
                    low[axis] = low[axis].min(point[axis]);
                    high[axis] = high[axis].max(point[axis]);
                }
            }
        }
        let sides = [high[0] - low[0], high[1] - low[1]];
        let count = lines.len() as f64;
        // Neither more cells than a few for each line, nor a long line in many of them.
        let cell = [
            (sides[0] * sides[1] / count).sqrt(),
            sides[0] / count,
            sides[1] / count,
            length / count / CELLS_OF_A_LINE,
        ];
        let cell = cell.into_iter().fold(LEAST_CELL, f64::max);
        let size = sides.map(|side| (side / cell) as i64 + 1);
        let mut grid = Self { lines, low, cell, size, starts: Vec::new(), members: Vec::new() };
        grid.fill();
        grid
    }

    /// Counts each cell's lines, then puts them in.
    fn fill(&mut self) {
        let mut counts = vec![0_u32; (self.size[0] * self.size[1]) as usize + 1];
        for line in self.lines {
            self.cells(line, 0.0, &mut |cell| counts[cell + 1] += 1);
        }
        for k in 1..counts.len() {
            counts[k] += counts[k - 1];
        }
        let mut next = counts.clone();
        let mut members = vec![0; counts.last().copied().unwrap_or_default() as usize];
        for (index, line) in (0_u32..).zip(self.lines) {
            self.cells(line, 0.0, &mut |cell| {
                members[next[cell] as usize] = index;
                next[cell] += 1;
            });
        }
        (self.starts, self.members) = (counts, members);
    }

    /// Hands on every line that may come nearer than `reach` to `line`, some more than once.
    pub(super) fn near(&self, line: &Line, reach: f64, sink: &mut dyn FnMut(usize)) {
        self.cells(line, reach, &mut |cell| {
            self.members(cell).iter().for_each(|&index| sink(index as usize));
        });
    }

    /// The line that is nearest to `point`, and its distance, mm; of equals any, but always the same.
    pub(super) fn nearest(&self, point: Point) -> (f64, usize) {
        let at = [self.place(point[0], 0), self.place(point[1], 1)];
        // Rings of cells around that of the point, from the first that has cells of the grid.
        let beyond = |axis: usize| (-at[axis]).max(at[axis] - self.size[axis] + 1).max(0);
        let last = (0..2).map(|axis| at[axis].abs().max((self.size[axis] - at[axis]).abs())).max();
        let mut best = (f64::INFINITY, 0);
        for ring in beyond(0).max(beyond(1))..=last.unwrap_or(0) {
            if best.0 <= (ring - 1) as f64 * self.cell {
                break;
            }
            self.ring(at, ring, &mut |cell| {
                for &index in self.members(cell) {
                    let distance = self.lines[index as usize].distance(point);
                    if distance < best.0 {
                        best = (distance, index as usize);
                    }
                }
            });
        }
        best
    }

    /// The cells of the grid that are `ring` cells away from the one at `at`.
    fn ring(&self, at: [i64; 2], ring: i64, sink: &mut dyn FnMut(usize)) {
        let rows = (at[1] - ring).max(0)..=(at[1] + ring).min(self.size[1] - 1);
        let columns = (at[0] - ring).max(0)..=(at[0] + ring).min(self.size[0] - 1);
        for row in rows {
            let mut cell = |column: i64| sink((row * self.size[0] + column) as usize);
            if (row - at[1]).abs() == ring {
                columns.clone().for_each(&mut cell);
                continue;
            }
            for column in [at[0] - ring, at[0] + ring] {
                if columns.contains(&column) {
                    cell(column);
                }
            }
        }
    }

    /// The cells of the grid that come nearer than `reach` to `line`, and some beside them.
    fn cells(&self, line: &Line, reach: f64, sink: &mut dyn FnMut(usize)) {
        let (a, b) =
            if line.from[1] <= line.to[1] { (line.from, line.to) } else { (line.to, line.from) };
        let inside = |place: i64, axis: usize| place.clamp(0, self.size[axis] - 1);
        let first = self.place(a[1] - reach, 1).max(0);
        let last = self.place(b[1] + reach, 1).min(self.size[1] - 1);
        let slope = (b[0] - a[0]) / (b[1] - a[1]);
        // The stretch of the line in a row of cells, with a little more for rounding.
        let margin = reach + 1e-6 * self.cell;
        for row in first..=last {
            let bottom = self.low[1] + row as f64 * self.cell;
            let x = |y: f64| {
                if a[1] == b[1] { None } else { Some(a[0] + slope * (y.clamp(a[1], b[1]) - a[1])) }
            };
            let ends = [x(bottom - margin), x(bottom + self.cell + margin)];
            let [one, two] = [ends[0].unwrap_or(a[0]), ends[1].unwrap_or(b[0])];
            let (left, right) = (one.min(two) - margin, one.max(two) + margin);
            if self.place(right, 0) < 0 || self.place(left, 0) >= self.size[0] {
                continue;
            }
            for column in inside(self.place(left, 0), 0)..=inside(self.place(right, 0), 0) {
                sink((row * self.size[0] + column) as usize);
            }
        }
    }

    fn members(&self, cell: usize) -> &[u32] {
        &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Column or row of a coordinate, which may lie outside the grid.
    fn place(&self, at: f64, axis: usize) -> i64 {
        ((at - self.low[axis]) / self.cell).floor() as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diff::line::tests::line;
    use proptest::prelude::*;

    fn lines() -> impl Strategy<Value = Vec<Line>> {
        let place = || prop::array::uniform2(-30.0..30.0_f64);
        let short = (place(), prop::array::uniform2(-1.0..1.0_f64))
            .prop_map(|(a, by)| line(a, [a[0] + by[0], a[1] + by[1]]));
        let flat = (place(), -9.0..9.0_f64).prop_map(|(a, by)| line(a, [a[0] + by, a[1]]));
        let long = (place(), place()).prop_map(|(a, b)| line(a, b));
        prop::collection::vec(prop_oneof![short, flat, long], 1..60)
    }

    proptest! {
        #[test]
        fn nothing_near_is_overlooked(
            lines in lines(),
            a in prop::array::uniform2(-60.0..60.0_f64),
            b in prop::array::uniform2(-60.0..60.0_f64),
            reach in 0.0..5.0_f64,
        ) {
            let grid = Grid::new(&lines);
            let point = [a[0], a[1], 0.5];
            let least = lines.iter().map(|l| l.distance(point)).fold(f64::MAX, f64::min);
            let (distance, index) = grid.nearest(point);
            prop_assert_eq!(distance, least);
            prop_assert_eq!(lines[index].distance(point), least);
            let asked = line(a, b);
            let mut found = vec![false; lines.len()];
            grid.near(&asked, reach, &mut |index| found[index] = true);
            for (line, found) in lines.iter().zip(found) {
                prop_assert!(found || asked.part_near(line, reach).is_none());
            }
        }
    }
}
