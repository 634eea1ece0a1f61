//! Lines of a patch in the file's order -> Plies: which of them are laid on which.
//!
//! Words used here: a *stroke* is lines one after the other in about one direction; a *ply* is strokes of
//! which none lies on another, a skin mostly; plies are counted from what they lie on.
//!
//! No file tells where a skin ends, and the skins of one place may be laid before or after those of another.
//! So each stroke is judged by itself: it is of the ply above that on which most of its length lies. Where a
//! patch ends, its upper skin may reach further than the lower one: a stroke beside one of a higher ply, in the
//! file's order, that has nothing of a higher ply on it is of that ply, too. What crosses it at its own height, as
//! the ends of one skin's lines do along a patch's edge, does not lie on it.

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

/// Part of a stroke's length that something lies on, if anything does: without its ends, as long as it is wide,
/// over which the next line may lead.
const SOME: f64 = 0.1;

/// Part of a line's width that its neighbours do not reach.
const CORE: f32 = 0.8;

/// Part of its height by which a line is higher than what it lies on, and lower than what lies on it.
const HIGHER: f64 = 0.3;

/// Distance of the places of a line that are looked at, mm.
const EVERY: f64 = 0.2;

/// Cells of a patch at most: 80 cm by 80 cm.
const MOST_CELLS: i64 = 64_000_000;

/// A map of cells that holds a patch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Field {
    /// The first cell.
    pub(crate) low: [i32; 2],
    pub(crate) count: [usize; 2],
}

impl Field {
    /// Around some lines, and by some cells more; `None` if there are none, or too many.
    pub(crate) fn around(lines: &[Step], more: i32) -> Option<Self> {
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
    pub(crate) fn cells(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// Where a cell is on it, if it is.
    pub(crate) fn index(&self, cell: [i32; 2]) -> Option<usize> {
        let [x, y] = [0, 1].map(|axis| i64::from(cell[axis]) - i64::from(self.low[axis]));
        let is_in = x >= 0 && y >= 0 && x < self.count[0] as i64 && y < self.count[1] as i64;
        is_in.then_some(x as usize + y as usize * self.count[0])
    }

    /// The cell of a place.
    pub(crate) fn cell(&self, at: [f64; 2]) -> Option<usize> {
        self.index(at.map(|at| (at / CELL).floor() as i32))
    }

    /// The cell of the bed that one of this map is.
    pub(crate) fn of(&self, index: usize) -> [i32; 2] {
        let (x, y) = (index % self.count[0], index / self.count[0]);
        [self.low[0] + x as i32, self.low[1] + y as i32]
    }
}

/// A stroke, and the ply that it is of, from 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) lines: Range<usize>,
    length: f64,
    pub(crate) ply: u16,
}

/// The strokes of a patch by their plies.
pub(crate) fn strokes(lines: &[Step], field: &Field) -> Vec<Stroke> {
    let mut strokes = cut(lines);
    let mut map = Map { ply: vec![0; field.cells()], top: vec![0.0; field.cells()], field };
    let mut ply = 1;
    for stroke in &mut strokes {
        let own = &lines[stroke.lines.clone()];
        if stroke.length >= LEAST_STROKE {
            ply = map.below(own).saturating_add(1);
        }
        stroke.ply = ply;
        map.lay(own, ply);
    }
    // What is laid just before and just after a stroke of a higher ply.
    let is_bare = |stroke: &Stroke| {
        let own = &lines[stroke.lines.clone()];
        stroke.length < LEAST_STROKE || map.covered(own, stroke.ply) <= SOME
    };
    for k in (1..strokes.len()).rev() {
        raise(&mut strokes, [k, k - 1], is_bare);
    }
    for k in 1..strokes.len() {
        raise(&mut strokes, [k - 1, k], is_bare);
    }
    strokes
}

/// Raises a stroke to the ply of another, if that is higher, and nothing lies on it.
fn raise(strokes: &mut [Stroke], [high, low]: [usize; 2], is_bare: impl Fn(&Stroke) -> bool) {
    let ply = strokes[high].ply;
    if strokes[low].ply < ply && is_bare(&strokes[low]) {
        strokes[low].ply = ply;
    }
}

/// Which ply covers each cell last, and how high it is.
struct Map<'a> {
    ply: Vec<u16>,
    top: Vec<f32>,
    field: &'a Field,
}

impl Map<'_> {
    /// The highest ply that lies under most of some lines' length; 0 for none.
    fn below(&self, lines: &[Step]) -> u16 {
        let mut plies: Vec<u16> = Vec::new();
        self.places(lines, 0.0, |cell, z, slack| {
            let is_lower = |cell: &usize| f64::from(self.top[*cell]) < z - slack;
            plies.push(cell.filter(is_lower).map_or(0, |cell| self.ply[cell]));
        });
        // More than a part lies on what comes after that part from the highest on.
        plies.sort_unstable_by(|a, b| b.cmp(a));
        let most = (MOST * plies.len() as f64) as usize;
        plies.get(most).copied().unwrap_or_default()
    }

    /// The part of some lines' length, but for their ends, that higher plies lie on.
    fn covered(&self, lines: &[Step], ply: u16) -> f64 {
        let (mut covered, mut all) = (0_u32, 0_u32);
        self.places(lines, f64::from(lines[0].width), |cell, z, slack| {
            all += 1;
            let lies_on =
                |cell: usize| self.ply[cell] > ply && f64::from(self.top[cell]) > z + slack;
            covered += u32::from(cell.is_some_and(lies_on));
        });
        f64::from(covered) / f64::from(all.max(1))
    }

    /// Hands the places of some lines, but for their `ends`, mm, to `sink`: the cell, if it is on the map, how high
    /// the line is there, and by how much what it lies on is lower, mm.
    fn places(&self, lines: &[Step], ends: f64, mut sink: impl FnMut(Option<usize>, f64, f64)) {
        let whole: f64 = lines.iter().map(Step::plan_length).sum();
        let mut before = 0.0;
        for step in lines {
            let (from, to) = (step.from.map(f64::from), step.to.map(f64::from));
            let (way, length) = (segment::way(from, to), step.plan_length());
            let count = (length / EVERY).ceil().max(1.0) as u32;
            for part in (0..count).map(|k| (f64::from(k) + 0.5) / f64::from(count)) {
                if (ends..=whole - ends).contains(&(before + part * length)) {
                    let [x, y, z] = segment::along(from, part, way);
                    sink(self.field.cell([x, y]), z, HIGHER * f64::from(step.height));
                }
            }
            before += length;
        }
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
    fn a_skin_that_reaches_far_is_one_though_an_edge_of_it_is_crossed() {
        // A level skin along x, and one across it that reaches three times as far: first lines of which the lower
        // skin carries a third, then one along the edge of the patch, and lines that lie on it as a whole.
        let level = |z: f32, places: &[[f32; 2]]| -> Vec<Step> {
            let at = |[x, y]: [f32; 2]| [x, y, z];
            places.windows(2).map(|two| line(at(two[0]), at(two[1]))).collect()
        };
        let zigzag = |count: u8, from: f32, ends: [f32; 2]| -> Vec<[f32; 2]> {
            let across = |k: u8| (from + 0.4 * f32::from(k), usize::from(k % 2));
            (0..count).map(across).flat_map(|(at, k)| [[at, ends[k]], [at, ends[1 - k]]]).collect()
        };
        let turned: Vec<[f32; 2]> =
            zigzag(10, 0.0, [0.0, 8.0]).into_iter().map(|[y, x]| [x, y]).collect();
        let mut lines = level(1.0, &turned);
        let first = lines.len();
        lines.extend(level(1.2, &zigzag(10, 0.0, [0.0, 12.0])));
        // Along the edge, over nothing, and crossed at its own height by the lines after it.
        lines.extend(level(1.2, &[[3.9, 8.0], [4.7, 5.0]]));
        lines.extend(level(1.2, &zigzag(6, 4.0, [0.0, 7.0])));
        let field = Field::around(&lines, 0).unwrap();
        for stroke in strokes(&lines, &field).iter().filter(|one| one.length >= LEAST_STROKE) {
            let right = if stroke.lines.start < first { 1 } else { 2 };
            assert_eq!(stroke.ply, right, "{stroke:?} {:?}", lines[stroke.lines.start]);
        }
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
        // Beside them all of it again, in the file after them: the same two plies.
        let beside = |step: &Step| {
            let by = |[x, y, z]: [f32; 3]| [x + 11.0, y, z];
            Step { from: by(step.from), to: by(step.to), ..*step }
        };
        let both: Vec<Step> = lines.iter().copied().chain(lines.iter().map(beside)).collect();
        let field = Field::around(&both, 0).unwrap();
        for stroke in strokes(&both, &field).iter().filter(|one| one.length >= LEAST_STROKE) {
            let right = if stroke.lines.start % lines.len() < first { 1 } else { 2 };
            assert_eq!(stroke.ply, right, "{stroke:?}");
        }
        // Printed again at the same height it is no other ply.
        let twice = [lines[0], lines[0]];
        assert!(strokes(&twice, &Field::around(&twice, 0).unwrap()).iter().all(|one| one.ply == 1));
    }
}
