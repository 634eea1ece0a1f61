//! Lines in the file's order -> Standing: how high plastic stands at each place of the bed.
//!
//! It is a map of *cells*, squares of [`CELL`] mm; a cell is as high as the highest line whose middle
//! goes through it, where it goes through it. Cells lie in *tiles* of [`SIDE`] by [`SIDE`], which exist where something stands:
//! the map grows with the print, and needs to know nothing of it before.
//!
//! Lines are only kept, and are drawn when somebody asks for a place. Flat files hardly ever ask. So
//! that many lines take no memory they are drawn when there are [`MOST_KEPT`] of them.

use crate::reader::print::Step;
use crate::units::Bounded as _;
use std::collections::BTreeMap;

/// Side of a cell, mm.
pub(super) const CELL: f64 = 0.5;

/// Cells along the side of a tile, a power of two.
const SIDE: usize = 32;
const _: () = assert!(SIDE.is_power_of_two());

/// Lines that are kept until they are drawn.
const MOST_KEPT: usize = 200_000;

/// Tiles at most: a bed of 2 m by 2 m full of plastic, or 64 MB.
const MOST_TILES: usize = 16_384;

/// Places further from 0 are on no machine, mm.
const FARTHEST: f32 = 10_000.0;

/// A line's ends, x, y and z of each, mm.
type Kept = [[f32; 3]; 2];

/// The cells of a tile.
type Tile = Box<[f32]>;

/// Plastic as it stands.
#[derive(Default)]
pub(super) struct Standing {
    kept: Vec<Kept>,
    tiles: Vec<Tile>,
    /// Which tile lies where.
    map: BTreeMap<[i32; 2], usize>,
    highest: f32,
}

impl Standing {
    /// The highest line so far, mm; 0 is the bed.
    pub(super) fn highest(&self) -> f64 {
        f64::from(self.highest)
    }

    /// A line is laid.
    pub(super) fn lay(&mut self, step: &Step) {
        let top = step.from[2].max(step.to[2]);
        let [x, y, to_x, to_y] = [step.from[0], step.from[1], step.to[0], step.to[1]];
        if [x, y, to_x, to_y].iter().any(|at| at.abs() > FARTHEST) {
            return;
        }
        self.highest = self.highest.max(top);
        self.kept.push([step.from, step.to]);
        if self.kept.len() >= MOST_KEPT {
            self.draw();
        }
    }

    /// How high plastic stands within `radius` mm of a place.
    pub(super) fn around(&mut self, [x, y]: [f64; 2], radius: f64) -> f64 {
        self.draw();
        let mut most = 0.0_f32;
        // Nearly always they lie in one tile.
        let mut known: Option<([i32; 2], Option<usize>)> = None;
        for row in cell(y - radius)..=cell(y + radius) {
            for column in cell(x - radius)..=cell(x + radius) {
                let middle = [column, row].map(|k| (f64::from(k) + 0.5) * CELL);
                let [dx, dy] = [middle[0] - x, middle[1] - y];
                if dx * dx + dy * dy > radius * radius {
                    continue;
                }
                let (at, index) = place([column, row]);
                let tile = match known {
                    Some((last, tile)) if last == at => tile,
                    _ => self.map.get(&at).copied(),
                };
                known = Some((at, tile));
                most = most.max(tile.map_or(0.0, |tile| self.tiles[tile][index]));
            }
        }
        f64::from(most)
    }

    /// Draws what is kept.
    fn draw(&mut self) {
        for line in std::mem::take(&mut self.kept) {
            self.draw_line(line);
        }
    }

    fn draw_line(&mut self, [from, to]: Kept) {
        let ([x, y, z], [to_x, to_y, to_z]) = (from.map(f64::from), to.map(f64::from));
        let way = [to_x - x, to_y - y, to_z - z];
        let longest = way[0].abs().at_least(way[1].abs()) / CELL;
        // Rounded up, which `f64::ceil` does by a call on some processors.
        let whole = longest as usize;
        let count = (whole + usize::from(longest > whole as f64)).max(1);
        let mut known: Option<([i32; 2], usize)> = None;
        for k in 0..=count {
            let part = k as f64 / count as f64;
            let (at, index) = place([cell(x + part * way[0]), cell(y + part * way[1])]);
            let tile = match known {
                Some((last, tile)) if last == at => tile,
                _ => match self.tile(at) {
                    Some(tile) => tile,
                    None => return,
                },
            };
            known = Some((at, tile));
            let (cell, top) = (&mut self.tiles[tile][index], (z + part * way[2]) as f32);
            if top > *cell {
                *cell = top;
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
        self.map.insert(at, self.tiles.len());
        self.tiles.push(vec![0.0; SIDE * SIDE].into_boxed_slice());
        Some(self.tiles.len() - 1)
    }
}

/// The row or column of a place: rounded down, which `f64::floor` does by a call on some processors.
fn cell(at: f64) -> i32 {
    let at = at / CELL;
    let towards_zero = at as i32;
    towards_zero - i32::from(at < f64::from(towards_zero))
}

/// The tile of a cell, and which of its cells it is.
fn place(cell: [i32; 2]) -> ([i32; 2], usize) {
    let side = SIDE as i32;
    let [column, row] = cell;
    let (x, y) = ((column & (side - 1)) as usize, (row & (side - 1)) as usize);
    ([column.div_euclid(side), row.div_euclid(side)], y * SIDE + x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reader::Role;

    #[test]
    fn lines_stand_where_they_were_laid() {
        let mut standing = Standing::default();
        let step = Step {
            from: [-20.0, 5.0, 3.0],
            to: [20.0, 5.0, 3.0],
            filament: 1.0,
            feed: 30.0,
            width: 0.4,
            height: 0.2,
            role: Role::OuterWall,
            line: 1,
        };
        standing.lay(&step);
        standing.lay(&Step { from: [0.0, 5.0, 2.0], to: [0.0, 9.0, 2.0], ..step });
        assert_eq!((standing.highest(), standing.around([-15.0, 5.4], 0.5)), (3.0, 3.0));
        assert_eq!(standing.around([0.0, 8.0], 0.5), 2.0);
        assert_eq!(standing.around([0.0, 5.2], 0.5), 3.0);
        for beside in [[-15.0, 7.0], [-21.5, 5.0], [2.0, 8.0], [900.0, 0.0]] {
            assert_eq!(standing.around(beside, 0.5), 0.0, "{beside:?}");
        }
        // As high as the line is there.
        standing.lay(&Step { from: [50.0, 5.0, 1.0], to: [60.0, 5.0, 3.0], ..step });
        let [low, high] = [51.0, 59.0].map(|x| standing.around([x, 5.2], 0.5));
        assert!((1.0..1.5).contains(&low) && (2.6..3.0).contains(&high), "{low} {high}");
        standing.lay(&Step { to: [9e8, 0.0, 3.0], ..step });
        assert_eq!(standing.around([1000.0, 5.0], 0.5), 0.0);
    }
}
