//! Loop and layout -> loop of changing width: passes move and widen where they share the room.
//!
//! Words: a *side* is the straight way between two corners of the loop. A *sample* is a place of a side,
//! with how far the bead moves inwards there and how wide it is.
//!
//! Each side of the loop is sampled once for each line width. A sample asks for the share of the
//! beads at its place. Around a corner of a strip the loop goes on between its two sides as it comes
//! (`bridged`). Between samples the loop goes straight; at a corner it goes where its two
//! moved sides meet. Around a small nose sides that move inwards get shorter, and vanish where they
//! would turn back.

use super::bridged::{Sample, bridge};
use super::{Layout, Wall};
use crate::geom::segment::{along, dot, way};
use crate::geom::{Contour, Point, edges};
use crate::region::near::Near;
use crate::region::taper::{Place, tapered};
use crate::units::Bounded as _;

/// Smaller cross products of two sides' directions count as straight on: the corner moves along
/// the mean normal. Two nearly parallel lines meet too far away.
const STRAIGHT: f64 = 0.2;

/// How near a middle bead has to be to the middle of a place, in line widths, to lie there. Samples of
/// both are up to a line apart.
const BEAD: f64 = 0.5;

/// How fast a loop may leave its nominal place, as a part of the way along it. At the end of a thin place
/// neighbouring samples see very different rooms. A larger value lets a loop of short sides jump to and
/// fro there; a smaller one leaves the ends of thin places open.
const LEAN: f64 = 0.5;

/// How far a corner may move, in line widths, before it is looked at whether its bead stays inside.
const NEAR: f64 = 0.25;

/// How far beyond its room a bead may reach at a corner, in line widths: tips of wedges do.
const OUT: f64 = 0.25;

/// Steps on the way to a corner, in line widths.
const MARCH: f64 = 0.125;

/// What is taken of the distance that a corner should have from the outline, if no place on the way has more.
const PARTS: [f64; 4] = [1.0, 0.75, 0.5, 0.25];

/// A side of the loop with its samples, evenly spaced.
struct Sampled {
    from: [f64; 2],
    way: [f64; 2],
    normal: [f64; 2],
    /// The distance of its samples.
    step: f64,
    samples: Vec<Sample>,
}

impl Sampled {
    fn length(&self) -> f64 {
        self.step * self.samples.len() as f64
    }
}

/// Moves and widens `wall`, a loop, where it shares the room. `beads` are the middle beads.
pub(super) fn share(wall: &mut Wall, beads: &Near, layout: &Layout<'_>) {
    let mut sides = sampled(&wall.path, wall.depth, beads, layout);
    let is_plain = |s: &Sample| s.shift == 0.0 && s.width == layout.line_width;
    if sides.iter().flat_map(|s| &s.samples).all(is_plain) {
        return;
    }
    bridge_corners(&mut sides);
    steady(&mut sides, layout.line_width);
    let Some(mut corners) = corners(&mut sides) else { return };
    for (k, corner) in corners.iter_mut().enumerate() {
        let before = &sides[(k + sides.len() - 1) % sides.len()];
        *corner = inside(*corner, [before, &sides[k]], wall.depth, layout);
    }
    let count: usize = sides.iter().map(|side| side.samples.len() + 1).sum();
    let mut places = Vec::with_capacity(count + 1);
    for (k, side) in sides.iter().enumerate() {
        let count = side.samples.len() as f64;
        let (from, to) = (corners[k], corners[(k + 1) % corners.len()]);
        let ahead = |a: [f64; 2], b: [f64; 2]| dot(way(a, b), side.way) >= 0.0;
        places.push(from);
        let moved = side.samples.iter().enumerate().map(|(i, s)| {
            let on = along(side.from, (i as f64 + 0.5) / count, side.way);
            Place { at: along(on, s.shift, side.normal), width: s.width }
        });
        places.extend(moved.filter(|place| ahead(from.at, place.at) && ahead(place.at, to.at)));
    }
    places.extend(places.first().copied());
    let (mut path, mut widths) = tapered(&places);
    // The last place repeats the first. What leads to it is the width of the first.
    path.pop();
    if let (Some(last), Some(first)) = (widths.pop(), widths.first_mut()) {
        *first = last;
    }
    (wall.path, wall.widths) = (path, widths);
}

fn sampled(path: &Contour, depth: u32, beads: &Near, layout: &Layout<'_>) -> Vec<Sampled> {
    let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let mut guess = layout.line_width;
    let mut sides = Vec::with_capacity(path.len());
    sides.extend(edges(path).filter(|(p, q)| p != q).map(|(p, q)| {
        let (from, length) = (float(p), p.distance(q));
        let way = way(from, float(q));
        let normal = [-way[1] / length, way[0] / length];
        let count = (length / layout.line_width).ceil();
        let sample = |i: usize| {
            let at = along(from, (i as f64 + 0.5) / count, way);
            let sample = sample(at, normal, depth, (beads, layout), &mut guess);
            Sample { step: length / count, way: [normal[1], -normal[0]], ..sample }
        };
        let samples = (0..count as usize).map(sample).collect();
        Sampled { from, way, normal, step: length / count, samples }
    }));
    sides
}

/// The bead of a loop of this `depth` at the place `at` of its nominal centre line.
fn sample(
    at: [f64; 2],
    normal: [f64; 2],
    depth: u32,
    (beads, layout): (&Near, &Layout<'_>),
    guess: &mut f64,
) -> Sample {
    let inset = layout.inset(depth);
    let foot = along(at, -inset, normal);
    let plain = Sample {
        shift: 0.0,
        width: layout.line_width,
        room: 0.0,
        bead: false,
        step: 0.0,
        way: [0.0; 2],
    };
    match layout.share(foot, normal, guess).filter(|(share, _)| share.loops > depth) {
        Some((share, opposite)) => {
            // What is laid decides, not what each place on its own would take.
            let middle = along(foot, opposite.radius, normal);
            let has_bead = !beads.is_free([middle], BEAD * layout.line_width);
            let count = f64::from(2 * share.loops + u32::from(has_bead));
            let width = share.room / count;
            let middle = (f64::from(depth) + 0.5) * width - layout.params.outside();
            let room = if opposite.corner { 0.0 } else { share.room };
            Sample { shift: middle - inset, width, room, bead: has_bead, ..plain }
        }
        None => plain,
    }
}

/// Bridges the samples around corners.
fn bridge_corners(sides: &mut [Sampled]) {
    let mut all: Vec<Sample> = sides.iter().flat_map(|side| side.samples.iter().copied()).collect();
    bridge(&mut all);
    let samples = sides.iter_mut().flat_map(|side| &mut side.samples);
    samples.zip(all).for_each(|(sample, bridged)| *sample = bridged);
}

/// Takes from the shifts what lets the loop leave its nominal place faster than it leans.
fn steady(sides: &mut [Sampled], line_width: f64) {
    let n = sides.iter().map(|side| side.samples.len()).sum();
    let (mut shifts, mut steps) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for side in &*sides {
        shifts.extend(side.samples.iter().map(|s| s.shift));
        steps.extend(side.samples.iter().map(|_| side.step));
    }
    // Only samples that have left their places may have to go back.
    let left: Vec<usize> = (0..n).filter(|&k| shifts[k] != 0.0).collect();
    let mut limit = |from: usize, to: usize| {
        let most = LEAN * f64::midpoint(steps[from], steps[to]);
        let (inwards, outwards) = (shifts[from].max(0.0) + most, shifts[from].min(0.0) - most);
        shifts[to] = shifts[to].min(inwards).max(outwards);
    };
    // Twice around: the loop is closed. Onwards the first sample comes last.
    let (first, others) = left.split_at(left.partition_point(|&k| k == 0));
    let onwards = || others.iter().chain(first);
    onwards().chain(onwards()).for_each(|&k| limit((k + n - 1) % n, k));
    left.iter().rev().chain(left.iter().rev()).for_each(|&k| limit((k + 1) % n, k));
    let all = sides.iter_mut().flat_map(|side| &mut side.samples);
    for (sample, shift) in all.zip(shifts).filter(|(sample, shift)| sample.shift != *shift) {
        let width = line_width + (sample.width - line_width) * shift / sample.shift;
        *sample = Sample { shift, width, ..*sample };
    }
}

/// The corners at which the sides begin. Sides that would turn back are taken away; `None` if too few
/// are left.
fn corners(sides: &mut Vec<Sampled>) -> Option<Vec<Place>> {
    let n = sides.len();
    let mut corners: Vec<Place> =
        (0..n).map(|k| corner(&sides[(k + n - 1) % n], &sides[k])).collect();
    let turns_back = |sides: &[Sampled], corners: &[Place], k: usize| {
        let ahead = way(corners[k].at, corners[(k + 1) % corners.len()].at);
        sides[k].samples.iter().any(|s| s.shift != 0.0) && dot(ahead, sides[k].way) < 0.0
    };
    while let Some(k) = (0..sides.len()).find(|&k| turns_back(sides, &corners, k)) {
        sides.remove(k);
        corners.remove(k);
        let n = sides.len();
        if n < 3 {
            return None;
        }
        corners[k % n] = cut(&sides[(k + n - 1) % n], &sides[k % n]);
    }
    Some(corners)
}

/// The corner between two moved sides of which what lay between was taken away.
fn cut(before: &Sampled, after: &Sampled) -> Place {
    let (Some(a), Some(b)) = (before.samples.last(), after.samples.first()) else {
        return Place { at: after.from, width: 0.0 };
    };
    let end = along(along(before.from, 1.0, before.way), a.shift, before.normal);
    let start = along(after.from, b.shift, after.normal);
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let (between, width) = (way(end, start), f64::midpoint(a.width, b.width));
    let at = if cross(before.normal, after.normal).abs() < STRAIGHT {
        along(end, 0.5, between)
    } else {
        along(end, cross(between, after.way) / cross(before.way, after.way), before.way)
    };
    Place { at, width }
}

/// A corner that its bead reaches without leaving the part, or what lies between it and the outer loops: sides that
/// are nearly parallel meet far outside.
fn inside(corner: Place, [before, after]: [&Sampled; 2], depth: u32, layout: &Layout<'_>) -> Place {
    let w = layout.line_width;
    let end = along(before.from, 1.0, before.way);
    let from = along(end, 0.5, way(end, after.from));
    let ahead = way(from, corner.at);
    let far = dot(ahead, ahead).sqrt();
    if far <= NEAR * w {
        return corner;
    }
    let outer = f64::from(depth) * corner.width.at_most(w) - layout.params.outside();
    let clear = (outer + corner.width / 2.0 - OUT * w).at_least(MARCH * w);
    let steps = (far / (MARCH * w)).ceil() as usize;
    let at = |k: usize| along(from, k as f64 / steps as f64, ahead);
    let is_free = |k: usize, clear: f64| layout.outline.is_free(at(k), clear);
    let within = (1..=steps).take_while(|&k| is_free(k, MARCH * w)).last().unwrap_or(0);
    if within == steps && is_free(steps, clear) {
        return corner;
    }
    // Where nothing is as far from the outline as it should be, what is furthest.
    let last = |part: &f64| (0..=within).rev().find(|&k| is_free(k, part * clear));
    Place { at: at(PARTS.iter().find_map(last).unwrap_or(within)), ..corner }
}

/// The corner between two sides: where the moved sides meet.
fn corner(before: &Sampled, after: &Sampled) -> Place {
    let (Some(a), Some(b)) = (before.samples.last(), after.samples.first()) else {
        return Place { at: after.from, width: 0.0 };
    };
    // A short side, such as the end of a bar, must not change the width all along a long one.
    let width = if before.samples.len() > after.samples.len() { a.width } else { b.width };
    let (m, n) = (before.normal, after.normal);
    let cross = m[0] * n[1] - m[1] * n[0];
    let met =
        [(a.shift * n[1] - b.shift * m[1]) / cross, (b.shift * m[0] - a.shift * n[0]) / cross];
    // Of two short sides that move by different widths, one would pass the samples of the other.
    let passes = dot(met, before.way) < -0.5 * before.step * before.length()
        || dot(met, after.way) > 0.5 * after.step * after.length();
    let by = if cross.abs() < STRAIGHT || passes {
        let mean = f64::midpoint(a.shift, b.shift) / (1.0 + dot(m, n)).max(STRAIGHT);
        [0, 1].map(|k| (m[k] + n[k]) * mean)
    } else {
        met
    };
    Place { at: [0, 1].map(|k| after.from[k] + by[k]), width }
}
