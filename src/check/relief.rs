//! Lines in the file's order -> Relief: how high plastic stands at each place, as wide as lines are.
//!
//! Words used here: a *cell* is a square of [`CELL`] mm; a *block* is [`BLOCK`] by [`BLOCK`] cells; a
//! *tile* is [`BLOCKS`] by [`BLOCKS`] blocks, and exists where something stands. Blocks and tiles know how
//! high their highest cell is.
//!
//! - A cell is as high as the highest line anywhere in it: an upper bound, to judge what the head touches.
//! - A cell also keeps how high it stood before the first line of a skin covered it: what skins lie on.
//!
//! [`Standing`](super::standing) is coarser and knows only the middles of lines: it is for files of which
//! nobody says what hangs around the nozzle, and judges what lies under its flat end alone.

use crate::geom::segment;
use crate::reader::print::Step;
use std::collections::BTreeMap;

/// Side of a cell, mm.
pub(super) const CELL: f64 = 0.1;

/// Cells along a block's side, and blocks along a tile's.
pub(super) const BLOCK: usize = 4;
pub(super) const BLOCKS: usize = 16;
const SIDE: usize = BLOCK * BLOCKS;

/// From a cell's middle to its corners, mm.
const CORNER: f64 = 0.070_711 * CELL / 0.1;

/// Tiles at most: a bed of 800 by 800 mm full of plastic, or 540 MB.
const MOST_TILES: usize = 16_384;

/// Places further from 0 are on no machine, mm.
const FARTHEST: f64 = 10_000.0;

/// Length of the pieces in which a line is drawn, mm.
const PIECE: f64 = 1.0;

/// See the head of this file.
struct Tile {
    cells: Box<[f32]>,
    /// Before skins; not a number where there is none.
    before: Option<Box<[f32]>>,
    blocks: [f32; BLOCKS * BLOCKS],
    highest: f32,
}

/// Plastic as it stands.
#[derive(Default)]
pub(super) struct Relief {
    tiles: Vec<Tile>,
    map: BTreeMap<[i32; 2], usize>,
    /// The lowest and the highest column and row of tiles.
    extent: [[i32; 2]; 2],
    highest: f32,
}

/// A square of the bed from its lowest corner, and its side, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Square {
    pub(super) low: [f64; 2],
    pub(super) side: f64,
}

impl Relief {
    /// The highest line so far, mm; 0 is the bed.
    pub(super) fn highest(&self) -> f64 {
        f64::from(self.highest)
    }

    /// A line is laid; of a skin, cells keep how high they stood before.
    pub(super) fn lay(&mut self, step: &Step, is_skin: bool) {
        if step.from.iter().chain(&step.to).any(|at| f64::from(at.abs()) > FARTHEST) {
            return;
        }
        self.highest = self.highest.max(step.from[2]).max(step.to[2]);
        let mut known: Option<([i32; 2], usize)> = None;
        footprint(step, CORNER, |cell, z| {
            let (at, index) = place(cell);
            let tile = match known {
                Some((last, tile)) if last == at => Some(tile),
                _ => self.tile(at),
            };
            let Some(tile) = tile else { return };
            known = Some((at, tile));
            self.tiles[tile].raise(index, z as f32, is_skin);
        });
    }

    /// How high a cell stands, mm.
    pub(super) fn at(&self, cell: [i32; 2]) -> f64 {
        let (at, index) = place(cell);
        self.map.get(&at).map_or(0.0, |&tile| f64::from(self.tiles[tile].cells[index]))
    }

    /// How high a cell stood before the first skin on it, mm; `None` without one.
    pub(super) fn before(&self, cell: [i32; 2]) -> Option<f64> {
        let (at, index) = place(cell);
        let tile = &self.tiles[*self.map.get(&at)?];
        tile.before.as_ref().map(|before| f64::from(before[index])).filter(|z| !z.is_nan())
    }

    /// Hands cells within `reach` mm of a place to `sink`, each with its height. Of tiles and blocks those
    /// are left out for which `counts` says no to their square and their highest place.
    pub(super) fn look(
        &self,
        [x, y]: [f64; 2],
        reach: f64,
        counts: &dyn Fn(Square, f64) -> bool,
        sink: &mut dyn FnMut(Square, f64),
    ) {
        let whole = CELL * SIDE as f64;
        let [low, high] = [-reach, reach]
            .map(|by| [x + by, y + by].map(|at| (at.clamp(-FARTHEST, FARTHEST) / whole).floor()));
        // A head may reach far beyond all that stands.
        let [first, last] = self.extent;
        let span =
            |axis: usize| (low[axis] as i32).max(first[axis])..=(high[axis] as i32).min(last[axis]);
        for row in span(1) {
            for column in span(0) {
                let Some(&tile) = self.map.get(&[column, row]) else { continue };
                let tile = &self.tiles[tile];
                let corner = [column, row].map(|k| f64::from(k) * whole);
                let square = Square { low: corner, side: whole };
                if counts(square, f64::from(tile.highest)) {
                    tile.look(corner, counts, sink);
                }
            }
        }
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
            blocks: [0.0; BLOCKS * BLOCKS],
            highest: 0.0,
        });
        Some(self.tiles.len() - 1)
    }
}

impl Tile {
    fn raise(&mut self, index: usize, z: f32, is_skin: bool) {
        let cell = &mut self.cells[index];
        if is_skin {
            let nothing = || vec![f32::NAN; SIDE * SIDE].into_boxed_slice();
            let before = &mut self.before.get_or_insert_with(nothing)[index];
            if before.is_nan() {
                *before = *cell;
            }
        }
        if z <= *cell {
            return;
        }
        *cell = z;
        let block = &mut self.blocks[index / SIDE / BLOCK * BLOCKS + index % SIDE / BLOCK];
        *block = block.max(z);
        self.highest = self.highest.max(z);
    }

    fn look(
        &self,
        low: [f64; 2],
        counts: &dyn Fn(Square, f64) -> bool,
        sink: &mut dyn FnMut(Square, f64),
    ) {
        let side = CELL * BLOCK as f64;
        let corner =
            |column: usize, row: usize| [low[0] + CELL * column as f64, low[1] + CELL * row as f64];
        for (k, &highest) in self.blocks.iter().enumerate() {
            let (column, row) = (k % BLOCKS * BLOCK, k / BLOCKS * BLOCK);
            if !counts(Square { low: corner(column, row), side }, f64::from(highest)) {
                continue;
            }
            for j in row..row + BLOCK {
                for i in column..column + BLOCK {
                    let height = f64::from(self.cells[j * SIDE + i]);
                    sink(Square { low: corner(i, j), side: CELL }, height);
                }
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

/// Hands the cells that a line covers to `sink`, each with the line's height there: those whose middles lie
/// within `grow` mm of it. Some cells come more than once. With half a cell's diagonal they are all cells
/// of which it covers something, as high as it is anywhere in them.
pub(super) fn footprint(step: &Step, grow: f64, mut sink: impl FnMut([i32; 2], f64)) {
    let (from, to) = (step.from.map(f64::from), step.to.map(f64::from));
    let way = segment::way(from, to);
    let square = way[0] * way[0] + way[1] * way[1];
    let length = square.sqrt();
    let radius = f64::from(step.width) / 2.0 + grow;
    let rise = if length > 0.0 { (way[2] / length).abs() * grow } else { 0.0 };
    let count = (length / PIECE).ceil().max(1.0);
    let cell = |at: f64| (at / CELL).floor() as i32;
    for k in 0..count as u32 {
        let ends =
            [f64::from(k), f64::from(k) + 1.0].map(|at| segment::along(from, at / count, way));
        let span = |axis: usize| {
            let [a, b] = [ends[0][axis], ends[1][axis]];
            cell(a.min(b) - radius)..=cell(a.max(b) + radius)
        };
        for row in span(1) {
            for column in span(0) {
                let middle = [column, row].map(|k| (f64::from(k) + 0.5) * CELL);
                let by = [middle[0] - from[0], middle[1] - from[1]];
                let along = by[0] * way[0] + by[1] * way[1];
                let part = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
                let off = [by[0] - part * way[0], by[1] - part * way[1]];
                if off[0] * off[0] + off[1] * off[1] <= radius * radius {
                    sink([column, row], from[2] + part * way[2] + rise);
                }
            }
        }
    }
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
        relief.lay(&step([-20.0, 5.0, 3.0], [20.0, 5.0, 3.0]), false);
        relief.lay(&step([50.0, 5.0, 1.0], [60.0, 5.0, 3.0]), true);
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
        relief.lay(&step([0.0; 3], [9e8, 0.0, 3.0]), false);
        assert_eq!(highest(&relief, [1000.0, 0.0], 1.0), 0.0);
    }

    #[test]
    fn what_does_not_count_is_left_out() {
        let mut relief = Relief::default();
        relief.lay(&step([1.0, 1.0, 1.0], [30.0, 1.0, 1.0]), false);
        relief.lay(&step([20.0, 20.0, 2.0], [21.0, 20.0, 2.0]), false);
        let mut seen = Vec::new();
        relief.look([15.0, 15.0], 20.0, &|_, z| z > 1.5, &mut |square, z| seen.push((square, z)));
        assert!(seen.len() < 300 && seen.iter().any(|(_, z)| *z > 1.9), "{}", seen.len());
        assert!(seen.iter().all(|(square, _)| square.low[1] > 19.0));
    }
}
