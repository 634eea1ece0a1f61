//! Walls and the layer below -> overhangs: which stretches of a wall hang over nothing, and how far.
//!
//! A wall *hangs* by the share of its width that the layer below does not cover: by half where its
//! centre line is above the edge below. Stretches that hang further are overhangs. They are
//! printed more slowly, the further they hang.
//!
//! Algorithm: on most layers no place reaches half a line beyond the layer below. Then this is all.
//! Else sample each wall where it crosses a row of one of the two rasters of skins, the one that it
//! crosses more steeply. The nearest covered place on that row tells how far the wall is out.
//! Between samples of different steps the wall gets a new point.

use super::Wall;
use super::params::RegionParams;
use super::prepare::LayerRows;
use crate::geom::Point;
use crate::geom::spans::{Span, subtract};
use crate::units::{Bounded as _, Coord, between, nearest};

/// Steps from half to the whole width. Each change of speed costs a move; with more steps walls
/// break into short ones, with fewer the speed jumps.
const STEPS: f64 = 4.0;

/// Overhangs seen by fewer samples, about a line's width apart, are left out: the nozzle cannot
/// slow down for a stretch this short.
const LEAST_SAMPLES: usize = 3;

/// A wall with its overhangs.
#[derive(Debug, Clone)]
pub struct Hanging {
    /// The wall, with a point where the step changes.
    pub wall: Wall,
    /// How far the way to each point hangs, % of the width; 0 up to half. Empty if none does.
    pub hangs: Vec<u8>,
}

/// The `walls` of layer `k` with their overhangs; `None` if there are none. `layers(k)` is `None`
/// outside the part.
#[must_use]
pub fn overhangs<'a>(
    k: usize,
    walls: &[Wall],
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    params: &RegionParams,
) -> Option<Vec<Hanging>> {
    let (here, below) = (layers(k)?, layers(k.checked_sub(1)?)?);
    let half = i64::from(params.walls.line_width / 2);
    let mut left = Vec::new();
    let mut beyond = |r: usize| {
        let below = &below.skin(r).cover;
        here.skin(r).cover.iter().any(|(j, row)| {
            left.clear();
            subtract(row, below.row(j), &mut left);
            left.iter().any(|span| span.len() > half)
        })
    };
    if !params.overhangs || !(beyond(0) || beyond(1)) {
        return None;
    }
    let out: Vec<Hanging> = walls.iter().map(|wall| hanging(wall, below, params)).collect();
    out.iter().any(|wall| !wall.hangs.is_empty()).then_some(out)
}

/// A place of a wall.
#[derive(Debug, Clone, Copy)]
struct Sample {
    /// The place is on the way to this point.
    to: usize,
    /// How far on that way, 0 to 1.
    at: f64,
    /// Steps beyond half the width.
    step: u8,
}

fn hanging(wall: &Wall, below: &LayerRows, params: &RegionParams) -> Hanging {
    let n = wall.path.len();
    let from = |to: usize| wall.path[(to + n - 1) % n];
    let mut samples = Vec::new();
    for to in usize::from(!wall.closed)..n {
        way((from(to), wall.path[to]), below, params, |at, step| {
            samples.push(Sample { to, at, step });
        });
    }
    for run in samples.chunk_by_mut(|a, b| (a.step > 0) == (b.step > 0)) {
        if run.len() < LEAST_SAMPLES {
            run.iter_mut().for_each(|sample| sample.step = 0);
        }
    }
    if samples.iter().all(|sample| sample.step == 0) {
        return Hanging { wall: wall.clone(), hangs: Vec::new() };
    }
    let mut out = Wall { path: Vec::with_capacity(n), widths: Vec::new(), ..wall.clone() };
    let mut hangs = Vec::with_capacity(n);
    let mut push = |point: Point, to: usize, step: u8| {
        out.path.push(point);
        out.widths.extend(wall.widths.get(to));
        hangs.push(if step == 0 { 0 } else { (50.0 + 50.0 * f64::from(step) / STEPS) as u8 });
    };
    let (mut step, mut next) = (0, 0);
    for to in 0..n {
        let mut last: Option<Sample> = None;
        while let Some(sample) = samples.get(next).copied().filter(|sample| sample.to == to) {
            if let Some(last) = last.filter(|last| last.step != sample.step) {
                let (p, q) = (from(to), wall.path[to]);
                let t = f64::midpoint(last.at, sample.at);
                let on = |p: Coord, q: Coord| p + nearest(t * f64::from(q - p)) as Coord;
                push(Point { x: on(p.x, q.x), y: on(p.y, q.y) }, to, last.step);
            }
            (step, last) = (sample.step, Some(sample));
            next += 1;
        }
        push(wall.path[to], to, step);
    }
    Hanging { wall: out, hangs }
}

/// Samples the way between two points of a wall.
fn way(
    (p, q): (Point, Point),
    below: &LayerRows,
    params: &RegionParams,
    mut sample: impl FnMut(f64, u8),
) {
    let enter = |r: usize| [p, q].map(|p| params.rasters.skin(r).frame.enter(p));
    let rise = |[p, q]: [Point; 2]| (i64::from(q.y) - i64::from(p.y)).abs();
    let r = usize::from(rise(enter(1)) > rise(enter(0)));
    let [p, q] = enter(r);
    let (low, high) = if p.y < q.y { (p, q) } else { (q, p) };
    let pitch = params.rasters.skin(r).pitch;
    let rows = params.rasters.skin(r).rows(low.y, high.y);
    let steep = rise([p, q]) as f64 / p.distance(q).at_least(1.0);
    let w = f64::from(params.walls.line_width);
    let mut see = |j: i32| {
        let v = j * pitch;
        let u = between(low.x, high.x, (v, low.y, high.y));
        let out = f64::from(distance(below.skin(r).cover.row(j), u).unwrap_or(Coord::MAX)) * steep;
        // The cover ends inside the contour.
        let out = if out > 0.0 { out - f64::from(params.insets.cover) } else { 0.0 };
        let step = (2.0 * STEPS * out / w).ceil().at_least(0.0).at_most(STEPS) as u8;
        sample(f64::from(v - p.y) / f64::from(q.y - p.y), step);
    };
    if p.y < q.y { rows.for_each(&mut see) } else { rows.rev().for_each(&mut see) }
}

/// The distance from `u` to the nearest place of a row.
fn distance(row: &[Span], u: Coord) -> Option<Coord> {
    let next = row.partition_point(|span| span.end < u);
    let after = row.get(next).map(|span| (span.start - u).max(0));
    let before = next.checked_sub(1).map(|k| u - row[k].end);
    after.into_iter().chain(before).min()
}
