//! Lines in the file's order -> Relief: how high plastic stands at each place, as wide as lines are.
//!
//! Words used here: a *cell* is a square of [`CELL`] mm; a *block* is [`BLOCK`] by [`BLOCK`] cells; a
//! *field* is [`FIELD`] by [`FIELD`] blocks; a *tile* is [`BLOCKS`] by [`BLOCKS`] blocks, and exists where
//! something stands. Blocks, fields and tiles know how high their highest cell is.
//!
//! - A cell is as high as the highest line anywhere in it: an upper bound, to judge what the head touches.
//! - A cell also keeps how high it stood before the first line of a skin covered it: what skins lie on.
//!
//! [`Standing`](crate::check::standing) is coarser and knows only the middles of lines: it is for files of which
//! nobody says what hangs around the nozzle, and judges what lies under its flat end alone.

use super::joints::{Joints, before};
use crate::check::capsule::Capsule;
use crate::geom::segment;
use crate::reader::print::Step;
use std::collections::BTreeMap;
use std::ops::Range;

/// Side of a cell, mm.
pub(crate) const CELL: f64 = 0.1;

/// Cells along a block's side, and blocks along a tile's.
pub(crate) const BLOCK: usize = 4;
pub(crate) const BLOCKS: usize = 16;

/// Blocks along a field's side, and fields along a tile's.
const FIELD: usize = 4;
const FIELDS: usize = BLOCKS / FIELD;
const SIDE: usize = BLOCK * BLOCKS;

/// From a cell's middle to its corners, mm.
const CORNER: f64 = 0.070_711 * CELL / 0.1;

/// Tiles at most: a bed of 800 by 800 mm full of plastic, or 540 MB.
const MOST_TILES: usize = 16_384;

/// Places further from 0 are on no machine, mm.
const FARTHEST: f64 = 10_000.0;

/// See the head of this file.
struct Tile {
    cells: Box<[f32]>,
    /// Before skins; not a number where there is none.
    before: Option<Box<[f32]>>,
    tops: Tops,
}

/// How high the highest cell of each block, of each field and of a tile is, mm.
struct Tops {
    blocks: [f32; BLOCKS * BLOCKS],
    fields: [f32; FIELDS * FIELDS],
    highest: f32,
}

impl Tops {
    /// A cell of a block is so high.
    fn raise(&mut self, block: usize, z: f32) {
        let (row, column) = (block / BLOCKS, block % BLOCKS);
        for top in [
            &mut self.blocks[block],
            &mut self.fields[row / FIELD * FIELDS + column / FIELD],
            &mut self.highest,
        ] {
            *top = top.max(z);
        }
    }
}

/// Plastic as it stands.
#[derive(Default)]
pub(crate) struct Relief {
    tiles: Vec<Tile>,
    map: BTreeMap<[i32; 2], usize>,
    /// The lowest and the highest column and row of tiles.
    extent: [[i32; 2]; 2],
    highest: f32,
}

/// A square of the bed from its lowest corner, and its side, mm.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Square {
    pub(crate) low: [f64; 2],
    pub(crate) side: f64,
}

/// Takes a block: its tile, that one's lowest corner, and its first column and row of cells there; whether it is
/// enough.
type Sink<'a> = dyn FnMut(&Tile, [f64; 2], [usize; 2]) -> bool + 'a;

impl Relief {
    /// The highest line so far, mm; 0 is the bed.
    pub(crate) fn highest(&self) -> f64 {
        f64::from(self.highest)
    }

    /// A line is laid; of a skin, cells keep how high they stood before.
    pub(super) fn lay(&mut self, step: &Step, is_skin: bool, joints: Joints) {
        if step.from.iter().chain(&step.to).any(|at| f64::from(at.abs()) > FARTHEST) {
            return;
        }
        self.highest = self.highest.max(step.from[2]).max(step.to[2]);
        let mut known: Option<([i32; 2], usize)> = None;
        strips(step, CORNER, joints, |strip| {
            let mut column = strip.columns.start;
            while column < strip.columns.end {
                let (at, index) = place([column, strip.row]);
                // Up to the end of the tile.
                let count = (SIDE - index % SIDE).min((strip.columns.end - column) as usize);
                let tile = match known {
                    Some((last, tile)) if last == at => Some(tile),
                    _ => self.tile(at),
                };
                let Some(tile) = tile else { return };
                known = Some((at, tile));
                let after = column - strip.columns.start;
                self.tiles[tile].raise((index, count), (strip, after), is_skin);
                column += count as i32;
            }
        });
    }

    /// How high a cell stands, mm.
    pub(crate) fn at(&self, cell: [i32; 2]) -> f64 {
        let (at, index) = place(cell);
        self.map.get(&at).map_or(0.0, |&tile| f64::from(self.tiles[tile].cells[index]))
    }

    /// How high a cell stood before the first skin on it, mm; `None` without one.
    pub(crate) fn before(&self, cell: [i32; 2]) -> Option<f64> {
        let (at, index) = place(cell);
        let tile = &self.tiles[*self.map.get(&at)?];
        tile.before.as_ref().map(|before| f64::from(before[index])).filter(|z| !z.is_nan())
    }

    /// Hands cells of blocks within `reach` mm of a place to `sink`, each with its height. Of tiles and blocks
    /// those are left out for which `counts` says no to their square and their highest place.
    pub(crate) fn look(
        &self,
        [x, y]: [f64; 2],
        reach: f64,
        counts: &dyn Fn(Square, f64) -> bool,
        sink: &mut dyn FnMut(Square, f64),
    ) {
        let area = [-reach, reach].map(|by| [x + by, y + by]);
        self.blocks(area, counts, &mut |tile, corner, [column, row]| {
            for j in row..row + BLOCK {
                for i in column..column + BLOCK {
                    let low = [corner[0] + CELL * i as f64, corner[1] + CELL * j as f64];
                    sink(Square { low, side: CELL }, f64::from(tile.cells[j * SIDE + i]));
                }
            }
            false
        });
    }

    /// Whether `counts` says yes to a block of an area from its lowest to its highest corner, mm: to its square
    /// and its highest place, and to its tile's.
    pub(crate) fn any(&self, area: [[f64; 2]; 2], counts: &dyn Fn(Square, f64) -> bool) -> bool {
        self.blocks(area, counts, &mut |_, _, _| true)
    }

    /// Hands blocks of an area that `counts` to `sink` until that says that it is enough.
    fn blocks(
        &self,
        [low, high]: [[f64; 2]; 2],
        counts: &dyn Fn(Square, f64) -> bool,
        sink: &mut Sink<'_>,
    ) -> bool {
        let (whole, side) = (CELL * SIDE as f64, CELL * BLOCK as f64);
        let tile_of =
            |corner: [f64; 2]| corner.map(|at| (at.clamp(-FARTHEST, FARTHEST) / whole).floor());
        let (from, to) = (tile_of(low), tile_of(high));
        // A head may reach far beyond all that stands.
        let [first, last] = self.extent;
        let span =
            |axis: usize| (from[axis] as i32).max(first[axis])..=(to[axis] as i32).min(last[axis]);
        for (row, column) in span(1).flat_map(|row| span(0).map(move |column| (row, column))) {
            let Some(&tile) = self.map.get(&[column, row]) else { continue };
            let tile = &self.tiles[tile];
            let corner = [column, row].map(|k| f64::from(k) * whole);
            if !counts(Square { low: corner, side: whole }, f64::from(tile.tops.highest)) {
                continue;
            }
            let block_of = |at: f64| ((at / side).max(0.0) as usize).min(BLOCKS - 1);
            let span = |axis: usize| {
                block_of(low[axis] - corner[axis])..=block_of(high[axis] - corner[axis])
            };
            // Most fields lie lower than whatever is looked for: none of their blocks is asked.
            let field_counts: [bool; FIELDS * FIELDS] = std::array::from_fn(|field| {
                let at = [field % FIELDS, field / FIELDS].map(|k| side * (k * FIELD) as f64);
                let low = [corner[0] + at[0], corner[1] + at[1]];
                let square = Square { low, side: side * FIELD as f64 };
                counts(square, f64::from(tile.tops.fields[field]))
            });
            for (j, i) in span(1).flat_map(|j| span(0).map(move |i| (j, i))) {
                if !field_counts[j / FIELD * FIELDS + i / FIELD] {
                    continue;
                }
                let low = [corner[0] + side * i as f64, corner[1] + side * j as f64];
                let highest = f64::from(tile.tops.blocks[j * BLOCKS + i]);
                if counts(Square { low, side }, highest)
                    && sink(tile, corner, [i * BLOCK, j * BLOCK])
                {
                    return true;
                }
            }
        }
        false
    }

    /// The tile there, which begins if there is none; `None` if there are too many.
    fn tile(&mut self, at: [i32; 2]) -> Option<usize> {
        if let Some(&tile) = self.map.get(&at) {
            return Some(tile);
        }
        if self.tiles.len() >= MOST_TILES {
            return None;
        }
        if self.tiles.is_empty() {
            self.extent = [at; 2];
        }
        let [low, high] = &mut self.extent;
        for axis in 0..2 {
            (low[axis], high[axis]) = (low[axis].min(at[axis]), high[axis].max(at[axis]));
        }
        self.map.insert(at, self.tiles.len());
        self.tiles.push(Tile {
            cells: vec![0.0; SIDE * SIDE].into_boxed_slice(),
            before: None,
            tops: Tops {
                blocks: [0.0; BLOCKS * BLOCKS],
                fields: [0.0; FIELDS * FIELDS],
                highest: 0.0,
            },
        });
        Some(self.tiles.len() - 1)
    }
}

impl Tile {
    /// Raises some cells of a row from one on to a line, as much of it as lies `after` its strip's first.
    fn raise(
        &mut self,
        (first, count): (usize, usize),
        (strip, after): (&Strip, i32),
        is_skin: bool,
    ) {
        let cells = &mut self.cells[first..first + count];
        if is_skin {
            let nothing = || vec![f32::NAN; SIDE * SIDE].into_boxed_slice();
            let before = &mut self.before.get_or_insert_with(nothing)[first..first + count];
            for (before, cell) in before.iter_mut().zip(&*cells) {
                if before.is_nan() {
                    *before = *cell;
                }
            }
        }
        if strip.by == 0.0 {
            let z = strip.height(0) as f32;
            cells.iter_mut().for_each(|cell| *cell = cell.max(z));
            let row = first / SIDE / BLOCK * BLOCKS;
            let columns = first % SIDE / BLOCK..=(first + count - 1) % SIDE / BLOCK;
            for column in columns {
                self.tops.raise(row + column, z);
            }
            return;
        }
        for (k, cell) in cells.iter_mut().enumerate() {
            let z = strip.height(after + k as i32) as f32;
            if z > *cell {
                *cell = z;
                let (row, column) = ((first + k) / SIDE, (first + k) % SIDE);
                self.tops.raise(row / BLOCK * BLOCKS + column / BLOCK, z);
            }
        }
    }
}

/// The tile of a cell, and which of its cells it is.
fn place(cell: [i32; 2]) -> ([i32; 2], usize) {
    let side = SIDE as i32;
    let [x, y] = cell.map(|k| k.rem_euclid(side) as usize);
    (cell.map(|k| k.div_euclid(side)), y * SIDE + x)
}

/// Cells of a row that a line covers, and its height over the first of them and how it changes, mm.
#[derive(Debug, Clone)]
struct Strip {
    row: i32,
    columns: Range<i32>,
    first: f64,
    by: f64,
    /// The line's own lowest and highest place.
    ends: [f64; 2],
}

impl Strip {
    /// The line's height over a cell, as many columns after the first, mm.
    fn height(&self, after: i32) -> f64 {
        (self.first + f64::from(after) * self.by).clamp(self.ends[0], self.ends[1])
    }
}

/// Hands the cells that a line covers to `sink`, row by row: those whose middles lie within `grow` mm of
/// it. With half a cell's diagonal they are all cells of which it covers something, as high as it is
/// anywhere in them. Beyond its ends it is as high as these; at a joint it ends, see [`Joints`].
fn strips(step: &Step, grow: f64, joints: Joints, mut sink: impl FnMut(&Strip)) {
    let (from, to) = (step.from.map(f64::from), step.to.map(f64::from));
    let way = segment::way(from, to);
    let square = way[0] * way[0] + way[1] * way[1];
    let (rise, slope) = if square > 0.0 {
        ((way[2].abs() / square.sqrt()) * grow, way.map(|by| by * way[2] / square))
    } else {
        (0.0, [0.0; 3])
    };
    let mut ends = step.heights().map(|z| z + rise);
    let radius = f64::from(step.width) / 2.0 + grow;
    // On a slope a line goes down to the line that it is joined to.
    if joints[usize::from(way[2] < 0.0)].is_some() && square > 0.0 {
        ends[0] -= radius * way[2].abs() / square.sqrt();
    }
    let line = Capsule { from: [from[0], from[1]], to: [to[0], to[1]], radius };
    let ((low, high), flanks) = (line.extent(), line.flanks());
    // Cells whose middles lie from one place to another.
    let first = |at: f64| (at / CELL - 0.5).ceil() as i32;
    for row in first(low[1])..first(high[1]) {
        let y = middle(row);
        let chord = flanks.chord(y);
        let chord =
            joints[0].map_or(chord, |[nx, ny]| before(chord?, y, (line.from, [-nx, -ny]), grow));
        let chord = joints[1].map_or(chord, |by| before(chord?, y, (line.to, by), grow));
        let Some((left, right)) = chord else { continue };
        let columns = first(left)..first(right);
        let by = [middle(columns.start) - from[0], y - from[1]];
        let first = from[2] + rise + by[0] * slope[0] + by[1] * slope[1];
        sink(&Strip { row, columns, first, by: CELL * slope[0], ends });
    }
}

/// As [`strips`], cell by cell, each with the line's height there.
pub(crate) fn footprint(step: &Step, grow: f64, mut sink: impl FnMut([i32; 2], f64)) {
    strips(step, grow, [None; 2], |strip| {
        for (after, column) in strip.columns.clone().enumerate() {
            sink([column, strip.row], strip.height(after as i32));
        }
    });
}

/// Where the middle of a row or a column lies, mm.
fn middle(cell: i32) -> f64 {
    (f64::from(cell) + 0.5) * CELL
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reader::Role;

    fn step(from: [f32; 3], to: [f32; 3]) -> Step {
        let (filament, feed, width, height) = (1.0, 30.0, 0.4, 0.2);
        Step { from, to, filament, feed, width, height, role: Role::OuterWall, line: 1 }
    }

    fn highest(relief: &Relief, at: [f64; 2], reach: f64) -> f64 {
        let mut most = 0.0_f64;
        relief.look(at, reach, &|_, _| true, &mut |square, z| {
            let near = [0, 1].map(|axis| (square.low[axis] + CELL / 2.0 - at[axis]).abs());
            most = if near[0].max(near[1]) <= reach + 1e-6 { most.max(z) } else { most };
        });
        most
    }

    #[test]
    fn lines_stand_as_wide_as_they_are_and_never_too_low() {
        let mut relief = Relief::default();
        relief.lay(&step([-20.0, 5.0, 3.0], [20.0, 5.0, 3.0]), false, [None; 2]);
        relief.lay(&step([50.0, 5.0, 1.0], [60.0, 5.0, 3.0]), true, [None; 2]);
        assert_eq!(highest(&relief, [0.05, 5.15], 0.0), 3.0);
        assert_eq!(highest(&relief, [0.05, 5.35], 0.0), 0.0);
        assert_eq!(highest(&relief, [0.05, 5.95], 0.85), 3.0);
        // As high as the line is at the cell's upper side, and hardly higher.
        for (x, y) in [(52.05, 5.05), (55.55, 4.85), (59.95, 5.15)] {
            let (z, right) = (highest(&relief, [x, y], 0.0), 1.0 + 0.2 * (x + 0.05 - 50.0));
            assert!((right - 1e-5..right + 0.02).contains(&z), "{z} {right}");
        }
        let cell = |x: f64, y: f64| [x, y].map(|at| (at / CELL).floor() as i32);
        assert_eq!(relief.before(cell(55.0, 5.0)), Some(0.0));
        assert_eq!(relief.before(cell(0.0, 5.0)), None);
        assert!((relief.at(cell(-3.0, 5.0)) - 3.0).abs() < 1e-6);
        relief.lay(&step([0.0; 3], [9e8, 0.0, 3.0]), false, [None; 2]);
        assert_eq!(highest(&relief, [1000.0, 0.0], 1.0), 0.0);
    }

    #[test]
    fn lines_that_go_on_along_a_slope_leave_no_steps() {
        // Down by 0.4 for each mm, along x, in pieces of 0.4 mm, or up the same way.
        let at = |k: u8| {
            let x = 0.4 * f32::from(k);
            [x, 5.0, 9.0 - 0.4 * x]
        };
        let laid = |turned: bool, joined: bool| {
            let mut relief = Relief::default();
            for k in 0..10 {
                let (from, to) = if turned { (at(k + 1), at(k)) } else { (at(k), at(k + 1)) };
                let (is_first, is_last) = if turned { (k == 9, k == 0) } else { (k == 0, k == 9) };
                let way = if turned { [-1.0, 0.0] } else { [1.0, 0.0] };
                let joint = |is_end: bool| Some(way).filter(|_| joined && !is_end);
                relief.lay(&step(from, to), true, [joint(is_first), joint(is_last)]);
            }
            relief
        };
        let over = |relief: &Relief, x: f64| highest(relief, [x, 5.05], 0.0) - (9.0 - 0.4 * x);
        for turned in [false, true] {
            let (whole, pieces) = (laid(turned, true), laid(turned, false));
            for k in 0..35 {
                let x = 0.25 + 0.1 * f64::from(k);
                assert!((0.0..0.05).contains(&over(&whole, x)), "{x}: {}", over(&whole, x));
            }
            assert!(over(&pieces, 1.35) > 0.08);
            // At the lowest end the nozzle has stopped.
            assert!((highest(&whole, [4.15, 5.05], 0.0) - 7.4).abs() < 0.04);
        }
    }

    #[test]
    fn a_line_ends_where_the_next_one_goes_on() {
        // Level, over an edge, and down by 0.5 for each mm; then the other way round.
        let places = [[5.0, 5.0, 3.0], [9.0, 5.0, 3.0], [13.0, 5.0, 1.0]];
        let ways = [vec![(0, 1), (1, 2)], vec![(2, 1), (1, 0)]];
        for lines in ways {
            let mut relief = Relief::default();
            for (k, &(a, b)) in lines.iter().enumerate() {
                let way = if a < b { [1.0, 0.0] } else { [-1.0, 0.0] };
                let joints = [k == 1, k == 0].map(|is_joint| Some(way).filter(|_| is_joint));
                relief.lay(&Step { width: 1.0, ..step(places[a], places[b]) }, true, joints);
            }
            for x in [9.15, 9.25, 9.45, 10.05] {
                let over = highest(&relief, [x, 5.05], 0.0) - (3.0 - 0.5 * (x - 9.0));
                assert!((0.0..0.12).contains(&over), "{x}: {over}");
            }
            assert!((highest(&relief, [8.95, 5.45], 0.0) - 3.0).abs() < 0.05);
        }
    }

    #[test]
    fn a_bend_leaves_no_gap_between_its_lines() {
        // By a third of a right angle, and as wide as wide lines are.
        let bend = [0.5_f32, 0.5 * 3.0_f32.sqrt()];
        let [a, b] = [
            step([5.0, 5.0, 2.0], [9.0, 5.0, 2.0]),
            step([9.0, 5.0, 2.0], [9.0 + 4.0 * bend[1], 5.0 + 4.0 * bend[0], 2.0]),
        ];
        let [a, b] = [a, b].map(|step| Step { width: 1.5, ..step });
        let middle = (15.0_f64.to_radians().cos(), 15.0_f64.to_radians().sin());
        let joint = Some([middle.0, middle.1]);
        let (mut whole, mut round) = (Relief::default(), Relief::default());
        for (line, joints) in [(&a, [None, joint]), (&b, [joint, None])] {
            whole.lay(line, true, joints);
            round.lay(line, true, [None; 2]);
        }
        for (x, y) in (80..110).flat_map(|x| (35..75).map(move |y| (x, y))) {
            assert_eq!(whole.at([x, y]), round.at([x, y]), "{x} {y}");
        }
    }

    #[test]
    fn what_does_not_count_is_left_out() {
        let mut relief = Relief::default();
        relief.lay(&step([1.0, 1.0, 1.0], [30.0, 1.0, 1.0]), false, [None; 2]);
        relief.lay(&step([20.0, 20.0, 2.0], [21.0, 20.0, 2.0]), false, [None; 2]);
        let mut seen = Vec::new();
        relief.look([15.0, 15.0], 20.0, &|_, z| z > 1.5, &mut |square, z| seen.push((square, z)));
        assert!(seen.len() < 300 && seen.iter().any(|(_, z)| *z > 1.9), "{}", seen.len());
        assert!(seen.iter().all(|(square, _)| square.low[1] > 19.0));
    }
}
