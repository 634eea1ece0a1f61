//! Lines of a piece in the order of printing -> places from which the head would touch those laid before.
//!
//! A surface is as steep as it is, but a line is level from one side to the other: on a slope across it, its
//! lower side stands over the surface by half its width times the slope. That is the more the wider lines
//! are, so that a head that is clear of a surface may touch the lines on it. Which of them stand when the nozzle
//! comes by is known once they are laid.
//!
//! Words used here: the *excess* of a line is what it may stand over its surface; a *joint* is where a line
//! goes on as the next one: beyond it that one is what stands.
//!
//! 1. Most places are clear at a glance, of a surface that is higher by the excess.
//! 2. Around all others lines are piled up one after the other, as `slicer check` does, and the head is tried
//!    on each before it is laid.

use super::excess::is_gentle;
use super::shrink::{Refused, refuse};
use super::touch::{cell_at, mm};
use super::trial::Trial;
use crate::fill::{Path, PathPoint};
use crate::geom::segment;
use crate::head::pile::{Hit, Pile};
use crate::head::sweep::SAMPLE;
use crate::head::{DEEPEST_PRESS, Head};
use crate::nonplanar::grid::{CELL, place_at};
use crate::nonplanar::surface::Surface;
use crate::nonplanar::tally::Reason;
use crate::units::{Coord, to_mm};
use rayon::prelude::*;

/// Half a cell's diagonal, mm: so much further a line reaches into cells than over their middles; and rounding.
const GROW: f64 = 0.0725;

/// Touches that are less deep are none, mm: less than what `slicer check` allows, for rounding.
const TOLERANCE: f64 = 0.013;

/// How much deeper than the rule a press on such an upper bound may be, mm: less than `slicer check` allows.
const BOUND: f64 = 0.05;

/// Cosine of the angle up to which a line goes on as the one before.
const STRAIGHT: f64 = 0.8;

/// A straight stretch of a line, mm.
struct Line {
    from: [f64; 3],
    to: [f64; 3],
    width: f64,
    /// Which skin it is of.
    skin: usize,
    /// Where it begins and ends, if it goes on there: the direction of both lines together.
    joints: [Option<[f64; 2]>; 2],
}

impl Line {
    /// Where the head is tried while it is laid.
    fn tips(&self) -> impl Iterator<Item = [f64; 3]> {
        let way = segment::way(self.from, self.to);
        let count = (way[0].hypot(way[1]) / SAMPLE).ceil().max(1.0);
        let first = usize::from(self.joints[0].is_some());
        let from = self.from;
        (first..=count as usize).map(move |k| segment::along(from, k as f64 / count, way))
    }
}

/// The places of each skin from which the head would touch lines that are laid before, of skins from the lowest
/// up. Points of paths are relative to `layer_top`.
pub(super) fn touches(
    (trial, surface): (&Trial<'_>, &Surface),
    skins: &[Vec<Path>],
    layer_top: Coord,
) -> Vec<Refused> {
    let mut out = vec![Refused::new(); skins.len()];
    let (params, field) = (trial.scene.params, &trial.ground.field);
    let widths = skins.iter().flatten().flat_map(|path| &path.points).map(|p| p.width);
    let widest = widths.max().unwrap_or(0);
    if is_gentle(surface, widest, params) {
        return out;
    }
    let lines = lines(skins, layer_top);
    let piece = (field, &trial.piece.area[..]);
    let known = trial.of_lines.up_to(widest, piece, params);
    let is_clear = |[x, y, _]: [f64; 3]| {
        let cell = cell_at([x, y]);
        field.at(cell).is_some_and(|z| known.is_clear(cell, mm(z)))
    };
    let are_clear: Vec<bool> = lines.par_iter().map(|line| line.tips().all(is_clear)).collect();
    let open = || lines.iter().zip(&are_clear).filter(|(_, clear)| !**clear).map(|(line, _)| line);
    let Some(mut laid) = Laid::around(open(), &lines, &params.head) else { return out };
    let most = DEEPEST_PRESS * to_mm(params.height) + BOUND;
    for (line, all_clear) in lines.iter().zip(&are_clear) {
        if !all_clear {
            let is_hit = |tip: &[f64; 3]| laid.is_touched(&params.head, *tip, most);
            for tip in line.tips().filter(|tip| !is_clear(*tip) && is_hit(tip)) {
                refuse(&mut out[line.skin], place_at([tip[0], tip[1]]), Reason::Cone);
            }
        }
        laid.lay(line);
    }
    out
}

/// All lines in their order.
fn lines(skins: &[Vec<Path>], layer_top: Coord) -> Vec<Line> {
    let place = |p: &PathPoint| [to_mm(p.at.x), to_mm(p.at.y), to_mm(layer_top + p.z)];
    let mut out: Vec<Line> = Vec::new();
    for (skin, paths) in skins.iter().enumerate() {
        for path in paths {
            let first = out.len();
            for two in path.points.windows(2) {
                let [from, to] = [place(&two[0]), place(&two[1])];
                let mut line =
                    Line { from, to, width: to_mm(two[1].width), skin, joints: [None; 2] };
                if let Some(last) = out[first..].last_mut() {
                    last.joints[1] = joint(last, &line);
                    line.joints[0] = last.joints[1];
                }
                out.push(line);
            }
        }
    }
    out
}

/// The direction of two lines together, of length 1, if the second goes on as the first.
fn joint(before: &Line, line: &Line) -> Option<[f64; 2]> {
    let unit = |line: &Line| {
        let [x, y, _] = segment::way(line.from, line.to);
        [x, y].map(|by| by / x.hypot(y))
    };
    let ([ax, ay], [bx, by]) = (unit(before), unit(line));
    let (cosine, both) = (ax * bx + ay * by, [ax + bx, ay + by]);
    (cosine > STRAIGHT).then(|| both.map(|by| by / both[0].hypot(both[1])))
}

/// Lines as they stand. An upper bound: a cell is as high as any line in it is anywhere.
struct Laid {
    pile: Pile,
    low: [f64; 2],
    high: [f64; 2],
}

impl Laid {
    /// Nothing stands yet; around some of the lines, as far as the head reaches. `None` without any.
    fn around<'a>(some: impl Iterator<Item = &'a Line>, all: &[Line], head: &Head) -> Option<Self> {
        let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
        for at in some.flat_map(|line| [line.from, line.to]) {
            for axis in 0..2 {
                (low[axis], high[axis]) = (low[axis].min(at[axis]), high[axis].max(at[axis]));
            }
        }
        let zs = || all.iter().flat_map(|line| [line.from[2], line.to[2]]);
        let most = zs().fold(f64::MIN, f64::max) - zs().fold(f64::MAX, f64::min);
        let reach = head.reach_below(most) + to_mm(CELL);
        let side = to_mm(CELL);
        let low = low.map(|v| ((v - reach) / side).floor() * side);
        let high = high.map(|v| v + reach);
        (low[0] < high[0]).then(|| Self { pile: Pile::new(low, high, side), low, high })
    }

    /// Whether the head touches a line, but for press no deeper than `most`, mm.
    fn is_touched(&self, head: &Head, tip: [f64; 3], most: f64) -> bool {
        let near = head.press_radius();
        // Near the tip by a cell's middle: its nearest corner would press where nothing does.
        let spare = |hit: &Hit| {
            let by = [0, 1].map(|axis| hit.at[axis] - tip[axis]);
            let away = by[0].hypot(by[1]);
            let under = head.underside(by).filter(|_| away <= 2.0 * near);
            let depth = under.map_or(hit.depth, |(under, _)| hit.height - tip[2] - under);
            depth <= if away <= near { most } else { TOLERANCE }
        };
        self.pile.hit_but_press(head, tip, most, &spare).is_some()
    }

    /// A line stands from now on.
    fn lay(&mut self, line: &Line) {
        let (from, to, way) = (line.from, line.to, segment::way(line.from, line.to));
        let square = way[0] * way[0] + way[1] * way[1];
        let (radius, side) = (line.width / 2.0 + GROW, to_mm(CELL));
        let slope = way[2].abs() / square.sqrt();
        let mut ends = [from[2].min(to[2]), from[2].max(to[2]) + slope * GROW];
        if line.joints[usize::from(way[2] < 0.0)].is_some() {
            ends[0] -= slope * radius;
        }
        let cell = |v: f64, axis: usize| ((v - self.low[axis]) / side).floor().max(0.0) as usize;
        let span = |a: f64, b: f64| (a.min(b) - radius, a.max(b) + radius);
        let (first, last) = span(from[1], to[1]);
        if last < self.low[1] || first > self.high[1] {
            return;
        }
        for row in cell(first, 1)..=cell(last.min(self.high[1]), 1) {
            let y = self.low[1] + (row as f64 + 0.5) * side;
            // Where the middle of the line is near enough to the row.
            let share = |y: f64| {
                if way[1] == 0.0 { None } else { Some(((y - from[1]) / way[1]).clamp(0.0, 1.0)) }
            };
            let ends_x = [share(y - radius), share(y + radius)];
            let x_at = |k: usize| from[0] + ends_x[k].unwrap_or(k as f64) * way[0];
            let (left, right) = span(x_at(0), x_at(1));
            if right < self.low[0] || left > self.high[0] {
                continue;
            }
            let columns = cell(left, 0)..cell(right.min(self.high[0]), 0) + 1;
            let height = |column: usize| {
                let at = [self.low[0] + (column as f64 + 0.5) * side - from[0], y - from[1]];
                let part = (at[0] * way[0] + at[1] * way[1]) / square;
                let on = part.clamp(0.0, 1.0);
                let off = [0, 1].map(|axis| at[axis] - on * way[axis]);
                // How far beyond a joint.
                let beyond = |k: usize, [x, y]: [f64; 2]| {
                    line.joints[k].is_some_and(|by| {
                        let far = x * by[0] + y * by[1];
                        if k == 0 { far < -GROW } else { far > GROW }
                    })
                };
                let is_beyond = beyond(0, at) || beyond(1, [at[0] - way[0], at[1] - way[1]]);
                if is_beyond || off[0] * off[0] + off[1] * off[1] > radius * radius {
                    return f64::NAN;
                }
                (from[2] + part * way[2] + slope * GROW).clamp(ends[0], ends[1])
            };
            self.pile.raise_cells([columns.start, row], columns.clone().map(height));
        }
    }
}
