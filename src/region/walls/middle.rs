//! Layout -> middle beads: one bead along the middle of places too thin for one more loop.
//!
//! Words: a *sample* is a place of the contour that has a middle bead opposite; a *lap* is all
//! samples of one contour, with `None` where it has none. An *arc* is a sequence of neighbouring
//! samples of a lap. Its places are the centres of circles inside the part, so they lie on the
//! medial axis.
//!
//! Algorithm:
//! 1. Sample each side of the contour, and fan out at corners that stick into the part.
//! 2. Both sides of a thin place see the same middle. The one whose side has the lower index
//!    *leads* and lays the bead. So the arcs of all leading samples cover nearly everything once.
//! 3. Where sides of different length look at each other, none may lead. Samples that are still
//!    far from all arcs make arcs of their own.
//! 4. Join arcs whose ends meet, and drop short ones. Where walls cross, their ends run on
//!    (`junctions`).

use super::patches::Doubt;
use super::{Layout, Share, Wall};
use crate::geom::nearest::Nearest;
use crate::geom::segment::{along, dot, way};
use crate::geom::{Contour, Point, edges, side};
use crate::region::near::Near;
use crate::region::taper::{Place, distance, tapered};
use crate::units::{Bounded as _, Coord, nearest as nearest_unit};

/// Distance of samples along the contour, in line widths. A larger value cuts corners; a smaller
/// one costs time.
const STEP: f64 = 0.75;

/// Turn between two samples at a corner, radians: 15°. See [`STEP`].
const TURN: f64 = 0.26;

/// Sharper corners that stick into the part keep loops away from what lies behind them, radians: 40°.
const SHARP: f64 = 0.7;

/// Two samples are neighbours if their middles are at most this far apart, in line widths. A
/// smaller value breaks beads on the outside of bends, a larger one bridges gaps.
const NEIGHBOURS: f64 = 1.5;

/// How far a bead stays away from the end of its strip, as a part of half the strip's width. At 0.8
/// its round end covers as much as its square end misses, but the corners of the strip stay open; at
/// 0 it sticks out by half its width.
const CLEAR: f64 = 0.5;

/// The same where the other side is a corner that sticks into the part: there the strip turns, and its
/// outer sides are further away than the bead shall come. A smaller value lays beads beyond the turn.
const CLEAR_OF_CORNER: f64 = 0.9;

/// Cosine of the angle between a bead and the contour beside it: 20°. In the bluntest wedge with a middle bead
/// it is 16°; beads at larger angles do not run along their strip.
const ALONG: f64 = 0.94;

/// Shorter beads are dropped, in line widths: the outermost ones, and those between loops. They
/// leave less open than a start and a stop spoil; a letter's dot is longer.
const SHORT: [f64; 2] = [0.4, 2.0];

/// Where two neighbouring samples are further apart, in line widths, a corner may lie between them.
const CORNER: f64 = 0.6;

/// Corners nearer to a sample are rounding errors: the sample is the corner (10 µm).
const LEAST_CORNER: f64 = 100.0;

/// How many samples behind a join a ring begins: its corner needs two samples on either side.
const SEAM: usize = 3;

/// Samples nearer than this part of their bead's width to an arc already have their bead.
const SAME: f64 = 0.6;

/// A place of a middle bead.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) place: Place,
    /// How many loops lie on either side.
    pub(super) loops: u32,
    /// Whether this side lays the bead.
    leads: bool,
    /// The place of the contour.
    from: Doubt,
}

impl Sample {
    /// The way along the contour that leads on as `way` does, of length 1.
    fn ahead(&self, way: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.from.normal;
        if dot([-y, x], way) < 0.0 { [y, -x] } else { [-y, x] }
    }
}

/// A run of neighbouring samples.
pub(super) type Arc = Vec<Sample>;

/// The arcs along which middle beads run, and the places of the contour in doubt: there is no core, and
/// none of these arcs runs.
pub(super) fn beads(layout: &Layout<'_>) -> (Vec<Arc>, Vec<Doubt>) {
    let mut first = 0;
    let mut doubts = Vec::new();
    let lap = |contour: &Contour| {
        let lap = lap(contour, first, layout, &mut doubts);
        first += contour.len() as u32;
        lap
    };
    let laps: Vec<Vec<Option<Sample>>> = layout.contours.iter().map(lap).collect();
    let w = layout.line_width;
    let mut all: Vec<Arc> = laps.iter().flat_map(|lap| arcs(lap, w, |s| s.leads)).collect();
    let sides = all.iter().flat_map(|arc| arc.windows(2));
    let sides = sides.map(|s| [s[0].place.at, s[1].place.at]);
    let near = Near::of_edges(sides.collect(), 2.0 * w);
    let is_left = |s: &Sample| !s.leads && near.is_free([s.place.at], SAME * s.place.width);
    let left = laps.iter().flat_map(|lap| arcs(lap, w, is_left));
    let (left, mut short): (Vec<Arc>, Vec<Arc>) = left.partition(|arc| length(arc) >= w);
    all.extend(left);
    join(&mut all, w);
    for arc in &mut all {
        sharpen(arc, layout);
        if !is_ring(arc) {
            reach_end(arc, layout);
            arc.reverse();
            reach_end(arc, layout);
        }
    }
    let (all, dropped): (Vec<Arc>, Vec<Arc>) = all.into_iter().partition(|arc| is_long(arc, w));
    short.extend(dropped);
    doubts.extend(short.iter().flatten().map(|sample| sample.from));
    (all, doubts)
}

/// The sides of middle beads, to find whether a place has one.
pub(super) fn near(beads: &[Wall], layout: &Layout<'_>) -> Near {
    let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let closing =
        |b: &Wall| b.closed.then(|| Some([float(*b.path.last()?), float(*b.path.first()?)]));
    let open = beads.iter().flat_map(|b| b.path.windows(2)).map(|p| [float(p[0]), float(p[1])]);
    let all = open.chain(beads.iter().filter_map(|b| closing(b).flatten()));
    Near::of_edges(all.collect(), 2.0 * layout.line_width)
}

/// Whether an arc ends where it begins.
pub(super) fn is_ring(arc: &Arc) -> bool {
    let ends = arc.first().zip(arc.last());
    arc.len() > 3 && ends.is_some_and(|(a, b)| a.place.at == b.place.at)
}

fn is_long(arc: &Arc, w: f64) -> bool {
    let between = arc.iter().all(|s| s.loops > 0);
    length(arc) >= SHORT[usize::from(between)] * w
}

/// The bead along an arc.
pub(super) fn wall(arc: &Arc) -> Wall {
    let places: Vec<Place> = arc.iter().map(|s| s.place).collect();
    let depth = arc.iter().map(|s| s.loops).min().unwrap_or_default();
    let (mut path, mut widths) = tapered(&places);
    let closed = path.len() > 3 && path.first() == path.last();
    if closed {
        path.pop();
        if let (Some(last), Some(first)) = (widths.pop(), widths.first_mut()) {
            *first = last;
        }
    }
    Wall { path, widths, closed, depth, layers: 1 }
}

/// The samples of a contour whose first side has the index `first`. Those that find neither a core nor
/// what is opposite are `doubts`.
fn lap(
    contour: &Contour,
    first: u32,
    layout: &Layout<'_>,
    doubts: &mut Vec<Doubt>,
) -> Vec<Option<Sample>> {
    let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let n = contour.len();
    let mut guess = layout.line_width;
    let samples =
        |(p, q): (Point, Point)| (p.distance(q) / (STEP * layout.line_width)).ceil() as usize;
    let mut out = Vec::with_capacity(edges(contour).map(samples).sum());
    for (index, (k, (p, q))) in (first..).zip(edges(contour).enumerate()) {
        if p == q {
            continue;
        }
        let length = p.distance(q);
        let along_side = [0, 1].map(|k| (float(q)[k] - float(p)[k]) / length);
        let normal = [-along_side[1], along_side[0]];
        let before = contour[(k + n - 1) % n];
        if side(before, p, q) < 0 {
            let (from, turn) = turn((before, p), normal);
            if turn.abs() > SHARP {
                // Just between its sides: there loops are furthest from it.
                let both = [0, 1].map(|k| from[k] + normal[k]);
                let length = dot(both, both).sqrt().at_least(f64::MIN_POSITIVE);
                doubts.push(Doubt {
                    at: float(p),
                    normal: both.map(|x| x / length),
                    sharp: true,
                    deep: 0.0,
                });
            }
            fan(from, turn, |normal| {
                out.push(sample(
                    Doubt { at: float(p), normal, sharp: false, deep: 0.0 },
                    index,
                    layout,
                    (&mut guess, doubts),
                ))
            });
        }
        let count = (length / (STEP * layout.line_width)).ceil();
        out.extend((0..count as usize).map(|i| {
            let at = along(float(p), (i as f64 + 0.5) / count * length, along_side);
            sample(
                Doubt { at, normal, sharp: false, deep: 0.0 },
                index,
                layout,
                (&mut guess, doubts),
            )
        }));
    }
    out
}

/// Calls `at` with normals between that of the side before a corner, `from`, and what it is turned to.
fn fan(from: [f64; 2], turn: f64, mut at: impl FnMut([f64; 2])) {
    let count = (turn.abs() / TURN).ceil();
    for i in 0..count as usize {
        let (sin, cos) = libm::sincos((i as f64 + 0.5) / count * turn);
        at([from[0] * cos - from[1] * sin, from[0] * sin + from[1] * cos]);
    }
}

/// The normal of the side before a corner, and by how much that after it, `to`, is turned, radians.
fn turn((before, corner): (Point, Point), to: [f64; 2]) -> ([f64; 2], f64) {
    let length = before.distance(corner).at_least(1.0);
    let from = [before.y - corner.y, corner.x - before.x].map(|x| f64::from(x) / length);
    let sin = from[0] * to[1] - from[1] * to[0];
    (from, libm::atan2(sin, from[0] * to[0] + from[1] * to[1]))
}

/// The middle bead opposite to a place of the contour, if there is one.
fn sample(
    from: Doubt,
    index: u32,
    layout: &Layout<'_>,
    (guess, doubts): (&mut f64, &mut Vec<Doubt>),
) -> Option<Sample> {
    let Doubt { at, normal, .. } = from;
    if layout.has_core(at, normal) {
        return None;
    }
    let Some((share, opposite)) = layout.shared(at, normal, guess) else {
        doubts.push(Doubt { deep: *guess, ..from });
        return None;
    };
    let from = Doubt { deep: opposite.radius, ..from };
    if !share.middle {
        return None;
    }
    let Share { width, loops, .. } = share;
    let middle = along(at, opposite.radius, normal);
    let clear = if opposite.corner { CLEAR_OF_CORNER } else { CLEAR };
    if !layout.outline.is_free(middle, clear * opposite.radius) {
        doubts.push(from);
        return None;
    }
    let place = Place { at: middle, width };
    Some(Sample { place, loops, leads: index < opposite.side, from })
}

/// The runs of neighbouring samples that are `wanted`. A run all around ends where it begins.
fn arcs(lap: &[Option<Sample>], w: f64, wanted: impl Fn(&Sample) -> bool) -> Vec<Arc> {
    let wanted = |s: &Option<Sample>| s.filter(|s| wanted(s));
    let n = lap.len();
    let start = lap.iter().position(|s| wanted(s).is_none());
    let around = lap.iter().cycle().skip(start.unwrap_or(0)).take(n + usize::from(start.is_none()));
    let mut out: Vec<Arc> = Vec::new();
    let mut open = false;
    for sample in around {
        let Some(sample) = wanted(sample) else {
            open = false;
            continue;
        };
        let far =
            |arc: &Arc| arc.last().map_or(f64::MAX, |s| distance(s.place.at, sample.place.at));
        match out.last_mut().filter(|arc| open && far(arc) <= NEIGHBOURS * w) {
            Some(arc) => arc.push(sample),
            None => out.push(vec![sample]),
        }
        open = true;
    }
    out
}

/// Joins arcs whose ends are neighbours, the nearest first for each arc in turn.
fn join(arcs: &mut Vec<Arc>, w: f64) {
    let most = NEIGHBOURS * w;
    let mut ends = Nearest::new(arcs.iter().flat_map(ends_of).map(rounded).collect());
    let mut gone = vec![false; arcs.len()];
    for k in 0..arcs.len() {
        if gone[k] {
            continue;
        }
        ends.take(2 * k);
        ends.take(2 * k + 1);
        // Of those before it none is near; those after it are as they were.
        while let Some((other, turn)) = nearest(arcs, k, (&ends, most)) {
            let mut more = std::mem::take(&mut arcs[other]);
            gone[other] = true;
            ends.take(2 * other);
            ends.take(2 * other + 1);
            if turn.1 {
                more.reverse();
            }
            let arc = &mut arcs[k];
            if turn.0 {
                arc.reverse();
            }
            arc.append(&mut more);
        }
    }
    arcs.retain(|arc| !arc.is_empty());
    for arc in arcs.iter_mut() {
        let ends = arc.first().zip(arc.last());
        let gap = ends.map_or(f64::MAX, |(a, b)| distance(a.place.at, b.place.at));
        if gap > 0.0 && gap <= NEIGHBOURS * w && length(arc) > 3.0 * NEIGHBOURS * w {
            // A corner may lie between its ends: it begins a little further on.
            let seam = SEAM.min(arc.len());
            arc.rotate_left(seam);
            arc.extend(arc.first().copied());
        }
    }
}

/// The ends of an arc, which has places.
fn ends_of(arc: &Arc) -> [[f64; 2]; 2] {
    let at = |sample: Option<&Sample>| sample.map_or([0.0; 2], |sample| sample.place.at);
    [at(arc.first()), at(arc.last())]
}

/// The point of the grid at a place.
fn rounded([x, y]: [f64; 2]) -> Point {
    Point { x: nearest_unit(x) as Coord, y: nearest_unit(y) as Coord }
}

/// The arc after `k` with the end nearest to an end of arc `k`, and which of the two to reverse so
/// that the second continues the first. `ends` are those of the arcs after `k`, two of each.
fn nearest(arcs: &[Arc], k: usize, (ends, most): (&Nearest, f64)) -> Option<(usize, (bool, bool))> {
    let here = ends_of(&arcs[k]);
    // A grid unit more for rounding, on both sides.
    let reach = most.ceil() as Coord + 2;
    let by = |p: Point, by: Coord| Point { x: p.x + by, y: p.y + by };
    let near = |at: [f64; 2]| ends.within((by(rounded(at), -reach), by(rounded(at), reach)));
    let mut others: Vec<usize> = here.into_iter().flat_map(near).map(|end| end / 2).collect();
    others.sort_unstable();
    others.dedup();
    let mut best: Option<(f64, usize, (bool, bool))> = None;
    for j in others {
        let there = ends_of(&arcs[j]);
        for turn in [(false, false), (false, true), (true, false), (true, true)] {
            let gap = distance(here[usize::from(!turn.0)], there[usize::from(turn.1)]);
            if gap <= best.map_or(most, |(least, ..)| least) && best.is_none_or(|b| gap < b.0) {
                best = Some((gap, j, turn));
            }
        }
    }
    best.map(|(_, j, turn)| (j, turn))
}

/// Moves the last place of an arc on to the end of its strip: samples lie up to a step before it.
fn reach_end(arc: &mut Arc, layout: &Layout<'_>) {
    let [.., before, last] = &mut arc[..] else { return };
    let mut ahead = way(before.place.at, last.place.at);
    let mut length = dot(ahead, ahead).sqrt().at_least(1.0);
    // Two samples around a corner look across it: the strip goes on beside the contour.
    let beside = last.ahead(ahead);
    if dot(ahead, beside) < ALONG * length {
        (ahead, length) = (beside, 1.0);
    }
    let clear = CLEAR * last.place.width / 2.0 * f64::from(2 * last.loops + 1);
    let at = |far: f64| along(last.place.at, far / length, ahead);
    let step = STEP * layout.line_width;
    // Where there is still room, the strip does not end: it runs into another.
    if layout.outline.is_free(at(step), clear) {
        return;
    }
    let mut far = 0.0;
    for part in [0.5, 0.25, 0.125, 0.0625] {
        let further = far + part * step;
        far = if layout.outline.is_free(at(further), clear) { further } else { far };
    }
    last.place.at = at(far);
}

/// Adds the corners that samples leave out: near the outside of a corner nothing is opposite. The room
/// of a sharp corner may hold a loop.
fn sharpen(arc: &mut Arc, layout: &Layout<'_>) {
    let w = layout.line_width;
    let at = |arc: &Arc, k: usize| arc[k].place.at;
    let mut k = 0;
    while k + 1 < arc.len() {
        let (a, b) = (at(arc, k), at(arc, k + 1));
        // At its ends the arc runs as the contour beside it does.
        let before = if k > 0 { way(at(arc, k - 1), a) } else { arc[k].ahead(way(a, b)) };
        let after =
            if k + 2 < arc.len() { way(b, at(arc, k + 2)) } else { arc[k + 1].ahead(way(a, b)) };
        if distance(a, b) > CORNER * w
            && let Some(corner) = meet(a, before, b, after, NEIGHBOURS * w)
            && let width = f64::midpoint(arc[k].place.width, arc[k + 1].place.width)
            && layout.is_clear(corner, arc[k].loops, width)
        {
            arc.insert(k + 1, Sample { place: Place { at: corner, width }, ..arc[k] });
            k += 1;
        }
        k += 1;
    }
}

/// Where the way from `a` on along `before` meets the way that leads to `b` along `after`, both at
/// most `most` long.
fn meet(
    a: [f64; 2],
    before: [f64; 2],
    b: [f64; 2],
    after: [f64; 2],
    most: f64,
) -> Option<[f64; 2]> {
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let between = way(a, b);
    let turn = cross(before, after);
    if turn.abs() < 0.2 * (dot(before, before) * dot(after, after)).sqrt() {
        return None;
    }
    let (ahead, back) = (cross(between, after) / turn, cross(between, before) / turn);
    let corner = along(a, ahead, before);
    let (from, to) = (distance(a, corner), distance(b, corner));
    // On a straight way the two meet where one of them begins.
    let between = ahead > 0.0 && back < 0.0 && from.at_most(to) > LEAST_CORNER;
    (between && from.at_least(to) <= most).then_some(corner)
}

fn length(arc: &Arc) -> f64 {
    arc.windows(2).map(|s| distance(s[0].place.at, s[1].place.at)).sum()
}
