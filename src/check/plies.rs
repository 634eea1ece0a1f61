//! Lines of a patch in the file's order -> Plies: which of them are laid on which.
//!
//! Words used here: a *stroke* is lines one after the other in about one direction; a *ply* is strokes of
//! which none lies on another, a skin mostly, or the same skin of several places.
//!
//! No file tells where a skin ends. A stroke that lies for most of its length on strokes of the last ply
//! begins a new one. What was laid just before it and has nothing of the new ply on it belongs to that,
//! too: where a patch ends, its upper skin may reach further than the lower one.

use super::relief::{CELL, footprint};
use crate::geom::segment;
use crate::reader::print::Step;
use std::ops::Range;

/// Cosine of the angle from which on lines are strokes of their own.
const CORNER: f64 = 0.8;

/// Shorter strokes only join others, mm.
const LEAST_STROKE: f64 = 1.0;

/// Part of its length by which a stroke lies on others.
const MOST: f64 = 0.5;

/// Part of a stroke's length that something lies on, if anything does; but for its ends, as long as it is wide,
/// over which the next line may lead.
const SOME: f64 = 0.1;

/// Part of a line's width that its neighbours do not reach.
const CORE: f32 = 0.8;

/// Part of its height by which a line is higher than what it lies on.
const HIGHER: f64 = 0.3;

/// Distance of the places of a line that are looked at, mm.
const EVERY: f64 = 0.2;

/// Cells of a patch at most: 80 cm by 80 cm.
const MOST_CELLS: i64 = 64_000_000;

/// A map of cells that holds a patch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field {
    /// The first cell.
    pub(super) low: [i32; 2],
    pub(super) count: [usize; 2],
}

impl Field {
    /// Around some lines, and by some cells more; `None` if there are none, or too many.
    pub(super) fn around(lines: &[Step], more: i32) -> Option<Self> {
        let (mut low, mut high) = ([i32::MAX; 2], [i32::MIN; 2]);
        for step in lines {
            for at in [step.from, step.to] {
                for axis in 0..2 {
                    let reach = f64::from(step.width);
                    let at = f64::from(at[axis]);
                    low[axis] = low[axis].min(((at - reach) / CELL).floor() as i32);
                    high[axis] = high[axis].max(((at + reach) / CELL).floor() as i32);
                }
            }
        }
        if lines.is_empty() {
            return None;
        }
        let side =
            |axis: usize| i64::from(high[axis]) - i64::from(low[axis]) + 1 + 2 * i64::from(more);
        let (low, sides) = (low.map(|at| at.saturating_sub(more)), [side(0), side(1)]);
        (sides[0].saturating_mul(sides[1]) <= MOST_CELLS)
            .then(|| Self { low, count: sides.map(|side| side as usize) })
    }

    /// Cells in all.
    pub(super) fn cells(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// Where a cell is on it, if it is.
    pub(super) fn index(&self, cell: [i32; 2]) -> Option<usize> {
        let [x, y] = [0, 1].map(|axis| i64::from(cell[axis]) - i64::from(self.low[axis]));
        let is_in = x >= 0 && y >= 0 && x < self.count[0] as i64 && y < self.count[1] as i64;
        is_in.then_some(x as usize + y as usize * self.count[0])
    }

    /// The cell of a place.
    pub(super) fn cell(&self, at: [f64; 2]) -> Option<usize> {
        self.index(at.map(|at| (at / CELL).floor() as i32))
    }

    /// The cell of the bed that one of this map is.
    pub(super) fn of(&self, index: usize) -> [i32; 2] {
        let (x, y) = (index % self.count[0], index / self.count[0]);
        [self.low[0] + x as i32, self.low[1] + y as i32]
    }
}

/// A stroke, and the ply that it is of, from 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stroke {
    pub(super) lines: Range<usize>,
    length: f64,
    pub(super) ply: u16,
}

/// The strokes of a patch by their plies.
pub(super) fn strokes(lines: &[Step], field: &Field) -> Vec<Stroke> {
    let mut strokes = cut(lines);
    let mut map = Map { ply: vec![0; field.cells()], top: vec![0.0; field.cells()], field };
    let mut ply = 1;
    // Where each ply but the first begins.
    let mut starts = Vec::new();
    for k in 0..strokes.len() {
        let own = &lines[strokes[k].lines.clone()];
        let is_long = strokes[k].length >= LEAST_STROKE;
        if is_long && map.share((own, 0.0), |cell| cell == ply, true) > MOST && ply < u16::MAX {
            ply += 1;
            starts.push(k);
        }
        strokes[k].ply = ply;
        map.lay(own, ply);
    }
    for start in starts {
        for k in (0..start).rev() {
            let Stroke { lines: ref range, length, ply } = strokes[k];
            let own = &lines[range.clone()];
            let covered = || map.share((own, f64::from(own[0].width)), |cell| cell > ply, false);
            if length >= LEAST_STROKE && covered() > SOME {
                break;
            }
            strokes[k].ply = strokes[start].ply;
        }
    }
    strokes
}

/// Which ply covers each cell last, and how high it is.
struct Map<'a> {
    ply: Vec<u16>,
    top: Vec<f32>,
    field: &'a Field,
}

impl Map<'_> {
    /// The part of some lines' length, but for their `ends`, mm, at which the map's ply is such; `is_over`: and
    /// lower than they are.
    fn share(
        &self,
        (lines, ends): (&[Step], f64),
        is_such: impl Fn(u16) -> bool,
        is_over: bool,
    ) -> f64 {
        let (mut such, mut all) = (0_u32, 0_u32);
        let whole: f64 = lines.iter().map(Step::plan_length).sum();
        let mut before = 0.0;
        for step in lines {
            let (from, to) = (step.from.map(f64::from), step.to.map(f64::from));
            let (way, length) = (segment::way(from, to), step.plan_length());
            let count = (length / EVERY).ceil().max(1.0) as u32;
            for part in (0..count).map(|k| (f64::from(k) + 0.5) / f64::from(count)) {
                if !(ends..=whole - ends).contains(&(before + part * length)) {
                    continue;
                }
                all += 1;
                let [x, y, z] = segment::along(from, part, way);
                let Some(cell) = self.field.cell([x, y]) else { continue };
                let least = z - HIGHER * f64::from(step.height);
                let is_higher = !is_over || f64::from(self.top[cell]) < least;
                such += u32::from(is_such(self.ply[cell]) && is_higher);
            }
            before += length;
        }
        f64::from(such) / f64::from(all.max(1))
    }

    fn lay(&mut self, lines: &[Step], ply: u16) {
        for step in lines {
            let core = Step { width: CORE * step.width, ..*step };
            footprint(&core, 0.0, |cell, z| {
                let Some(cell) = self.field.index(cell) else { return };
                self.ply[cell] = ply;
                self.top[cell] = z as f32;
            });
        }
    }
}

/// Lines as strokes, all of ply 0.
fn cut(lines: &[Step]) -> Vec<Stroke> {
    let mut strokes: Vec<Stroke> = Vec::new();
    let mut last: Option<([f32; 3], [f64; 2])> = None;
    for (k, step) in lines.iter().enumerate() {
        let length = step.plan_length();
        let along = [0, 1].map(|axis| f64::from(step.to[axis] - step.from[axis]) / length);
        let goes_on = last.is_some_and(|(to, way)| {
            to == step.from && way[0] * along[0] + way[1] * along[1] > CORNER
        });
        match strokes.last_mut() {
            Some(stroke) if goes_on => {
                stroke.lines.end = k + 1;
                stroke.length += length;
            }
            _ => strokes.push(Stroke { lines: k..k + 1, length, ply: 0 }),
        }
        last = Some((step.to, along));
    }
    strokes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reader::Role;

    fn line(from: [f32; 3], to: [f32; 3]) -> Step {
        let (filament, feed, width, height) = (1.0, 30.0, 0.4, 0.2);
        Step { from, to, filament, feed, width, height, role: Role::NonPlanar, line: 1 }
    }

    #[test]
    fn lines_on_others_are_of_the_next_ply() {
        // A level skin along x; one across that reaches further to both sides; each one zigzag.
        let mut places = Vec::new();
        for k in 0..10_u8 {
            let y = 0.4 * f32::from(k);
            let ends = [[0.0, y, 1.0], [8.0, y, 1.0]];
            places.extend(if k % 2 == 0 { ends } else { [ends[1], ends[0]] });
        }
        let first = places.len() - 1;
        for k in 0..30_u8 {
            let x = 0.4 * f32::from(k) - 2.0;
            let ends = [[x, 0.0, 1.2], [x, 3.6, 1.2]];
            places.extend(if k % 2 == 0 { ends } else { [ends[1], ends[0]] });
        }
        let lines: Vec<Step> = places.windows(2).map(|two| line(two[0], two[1])).collect();
        let field = Field::around(&lines, 0).unwrap();
        for stroke in strokes(&lines, &field) {
            let length = lines[stroke.lines.start].plan_length();
            if length >= LEAST_STROKE {
                let right = if stroke.lines.start < first { 1 } else { 2 };
                assert_eq!(stroke.ply, right, "{stroke:?}");
            }
        }
        // Printed again at the same height it is no other ply.
        let twice = [lines[0], lines[0]];
        assert!(strokes(&twice, &Field::around(&twice, 0).unwrap()).iter().all(|one| one.ply == 1));
    }
}
