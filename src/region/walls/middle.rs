//! Layout -> middle beads: one bead along the middle of places too thin for one more loop.
//!
//! Words: a *sample* is a place of the contour that has a middle bead opposite; a *lap* is all
//! samples of one contour, with `None` where it has none. An *arc* is a sequence of neighbouring
//! samples of a lap. Its places are the centres of circles inside the part, so they lie on the
//! medial axis, but for corners on which a bead turns.
//!
//! Algorithm:
//! 1. Sample each side of the contour, and fan out at corners that stick into the part.
//! 2. Both sides of a thin place see the same middle. The one whose side has the lower index
//!    *leads* and lays the bead. So the arcs of all leading samples cover nearly everything once.
//! 3. Where sides of different length look at each other, none may lead. Samples that are still
//!    far from all arcs make arcs of their own.
//! 4. Join arcs whose ends meet, or between which their strip turns (`arcs`). Where it turns, the bead
//!    does so where its two sides meet. Drop short arcs. Where walls cross, their ends run on
//!    (`junctions`).

use super::arcs::{Arc, NEIGHBOURS, Sample, arcs, is_ring, join_ends, length, meet};
use super::patches::Doubt;
use super::{Layout, Share, Wall};
use crate::geom::segment::{along, dot, way};
use crate::geom::{Contour, Point, edges, side};
use crate::region::near::Near;
use crate::region::taper::{Place, distance, go_on, tapered};
use crate::units::Bounded as _;

/// Distance of samples along the contour, in line widths. A larger value cuts corners; a smaller
/// one costs time.
const STEP: f64 = 0.75;

/// Turn between two samples at a corner, radians: 15°. See [`STEP`].
const TURN: f64 = 0.26;

/// Sharper corners that stick into the part keep loops away from what lies behind them, radians: 40°.
const SHARP: f64 = 0.7;

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

/// Samples nearer than this part of their bead's width to an arc already have their bead.
const SAME: f64 = 0.6;

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
    join_ends(&mut all, layout);
    for arc in &mut all {
        if !is_ring(arc) {
            onwards(arc, w, &mut doubts);
        }
        mitre(arc, layout);
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

/// Takes away the places from which a bead would turn back. Where it would go there and back, much may be open.
fn onwards(arc: &mut Arc, w: f64, doubts: &mut Vec<Doubt>) {
    let (all, known) = (arc.len(), doubts.len());
    doubts.extend(arc.iter().map(|sample| sample.from));
    go_on(arc, w / 2.0, |sample| sample.place.at);
    if arc.len() == all {
        doubts.truncate(known);
    }
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
                    (Doubt { at: float(p), normal, sharp: false, deep: 0.0 }, true),
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
                (Doubt { at, normal, sharp: false, deep: 0.0 }, false),
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
    (from, at_corner): (Doubt, bool),
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
    let turns = at_corner || opposite.corner;
    Some(Sample { place, loops, leads: index < opposite.side, turns, from })
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

/// Where a strip turns, the middle of its room cuts the corner. The bead turns where its two sides meet instead,
/// as the loops beside it do.
fn mitre(arc: &mut Arc, layout: &Layout<'_>) {
    let mut from = 1;
    while let Some(first) = (from..arc.len()).find(|&k| arc[k].turns && !arc[k - 1].turns) {
        let Some(end) = (first..arc.len()).find(|&k| !arc[k].turns) else { return };
        from = end;
        let (a, b) = (arc[first - 1], arc[end]);
        let width = f64::midpoint(a.place.width, b.place.width);
        if let Some(corner) = a.turning_to(&b, layout)
            && layout.is_clear(corner, a.loops, width)
        {
            arc.splice(first..end, [Sample { place: Place { at: corner, width }, ..a }]);
            from = first + 1;
        }
    }
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
            && let Some(corner) = arc[k]
                .turning_to(&arc[k + 1], layout)
                .or_else(|| meet(a, before, b, after, NEIGHBOURS * w))
            && let width = f64::midpoint(arc[k].place.width, arc[k + 1].place.width)
            && layout.is_clear(corner, arc[k].loops, width)
        {
            arc.insert(k + 1, Sample { place: Place { at: corner, width }, ..arc[k] });
            k += 1;
        }
        k += 1;
    }
}
