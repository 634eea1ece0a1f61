//! Lines -> Grid: which lines are near a line or a place, without looking at all of them.

use super::line::{Line, Point};
use crate::geom::cells::Cells;

/// Side of a cell at least, mm.
const LEAST_CELL: f64 = 1.0;

/// Cells that a line of mean length goes through, about.
const CELLS_OF_A_LINE: f64 = 4.0;

/// Lines by the square cells of the plane that they go through.
pub(super) struct Grid<'a> {
    pub(super) lines: &'a [Line],
    area: Area,
    /// The lines of each cell.
    members: Cells<u32>,
}

/// Where the cells lie.
#[derive(Debug, Clone, Copy)]
struct Area {
    low: [f64; 2],
    cell: f64,
    /// Number of cells in x and in y.
    size: [i64; 2],
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
        let area = Area { low, cell, size };
        let cells = (size[0] * size[1]) as usize;
        let members = Cells::new(
            cells,
            || (0..lines.len()).map(|index| index as u32),
            |index| area.cells(&lines[index as usize], 0.0),
        );
        Self { lines, area, members }
    }

    /// Hands on every line that may come nearer than `reach` to `line`, some more than once.
    pub(super) fn near(&self, line: &Line, reach: f64, sink: &mut dyn FnMut(usize)) {
        for cell in self.area.cells(line, reach) {
            self.members.of(cell..cell + 1).iter().for_each(|&index| sink(index as usize));
        }
    }

    /// The line that is nearest to `point`, and its distance, mm; of equals any, but always the same.
    pub(super) fn nearest(&self, point: Point) -> (f64, usize) {
        let Area { cell, size, .. } = self.area;
        let at = [self.area.place(point[0], 0), self.area.place(point[1], 1)];
        // Rings of cells around that of the point, from the first that has cells of the grid.
        let beyond = |axis: usize| (-at[axis]).max(at[axis] - size[axis] + 1).max(0);
        let last = (0..2).map(|axis| at[axis].abs().max((size[axis] - at[axis]).abs())).max();
        let mut best = (f64::INFINITY, 0);
        for ring in beyond(0).max(beyond(1))..=last.unwrap_or(0) {
            if best.0 <= (ring - 1) as f64 * cell {
                break;
            }
            self.area.ring(at, ring, &mut |cell| {
                for &index in self.members.of(cell..cell + 1) {
                    let distance = self.lines[index as usize].distance(point);
                    if distance < best.0 {
                        best = (distance, index as usize);
                    }
                }
            });
        }
        best
    }
}

impl Area {
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
    fn cells(&self, line: &Line, reach: f64) -> impl Iterator<Item = usize> + use<> {
        let area = *self;
        let (a, b) =
            if line.from[1] <= line.to[1] { (line.from, line.to) } else { (line.to, line.from) };
        let inside = move |place: i64, axis: usize| place.clamp(0, area.size[axis] - 1);
        let first = area.place(a[1] - reach, 1).max(0);
        let last = area.place(b[1] + reach, 1).min(area.size[1] - 1);
        let slope = (b[0] - a[0]) / (b[1] - a[1]);
        // The stretch of the line in a row of cells, with a little more for rounding.
        let margin = reach + 1e-6 * area.cell;
        (first..=last).flat_map(move |row| {
            let bottom = area.low[1] + row as f64 * area.cell;
            let x = |y: f64| {
                if a[1] == b[1] { None } else { Some(a[0] + slope * (y.clamp(a[1], b[1]) - a[1])) }
            };
            let ends = [x(bottom - margin), x(bottom + area.cell + margin)];
            let [one, two] = [ends[0].unwrap_or(a[0]), ends[1].unwrap_or(b[0])];
            let (left, right) = (one.min(two) - margin, one.max(two) + margin);
            let is_beside = area.place(right, 0) < 0 || area.place(left, 0) >= area.size[0];
            let columns = inside(area.place(left, 0), 0)..=inside(area.place(right, 0), 0);
            let columns = (!is_beside).then_some(columns).into_iter().flatten();
            columns.map(move |column| (row * area.size[0] + column) as usize)
        })
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
