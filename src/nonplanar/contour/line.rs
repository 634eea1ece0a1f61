//! A path on a tread -> the same path with heights.
//!
//! 1. Places along the path, [`STEP`] apart and at its points, each with the height that it should have above
//!    the layer's top: that of the surface, within what a line may rise and fall. It is *off* where there is no
//!    surface, or where a zone forbids it: 0 there.
//! 2. From what is off, heights go away no steeper than the steepest slope: lines rise and fall smoothly. Above
//!    the layer's top they rise no steeper than [`GENTLE`].
//! 3. Heights are made straight as long as they miss none by more than the tolerance: z is slow, and each of
//!    its turns takes time.
//! 4. Segments are cut into chords that keep to these heights within the tolerance. The height of each bead is
//!    the mean over its chord.
//!
//! The way in plan stays the same: every point of the path remains, and new ones lie on its segments.

use super::super::grid::cell_around;
use super::zones::Zones;
use super::{Limits, Tread, between};
use crate::fill::{Path, PathPoint, Role, Shape};
use crate::geom::Point;
use crate::geom::decimate::{decimate, most_missed};
use crate::units::{Coord, nearest};

/// Distance of places, grid units: 0.2 mm.
const STEP: f64 = 2_000.0;

/// How steeply walls and other lines rise above their layer's top from what is off, at most. Where the layer
/// above begins they have to come down again, and z is slow. Walls beside a layer above that comes and goes
/// would climb at each turn: at 0.03 most machines pass with half of a wall's speed, and 0.06 mm take 2 mm.
/// Lines across a slope climb by themselves.
const GENTLE: [f64; 2] = [0.03, 0.1];

/// A chord changes its height by no more, if it is long enough to be divided: 0.05 mm. The flow of a chord is
/// steady, while the room below it is not.
const CHANGE: f64 = 500.0;

/// A height that differs by less than this from a chord lies on it, grid units.
const STRAIGHT: f64 = 1.0;

/// A place of a path.
#[derive(Debug, Clone, Copy)]
struct Place {
    at: Point,
    /// The way along the path up to it.
    along: f64,
    /// The nozzle's height above the layer's top.
    up: f64,
    is_off: bool,
}

/// Bends a path where it lies on a tread; it rises by no more than `rise`.
pub(super) fn bend(path: &mut Path, tread: &Tread<'_>, zones: &Zones, rise: Coord) {
    let lowest = (tread.all.limits.min_height - tread.layer.height).min(0);
    let within = [f64::from(lowest), f64::from(rise)];
    let (mut places, firsts) = places(path, tread, zones, within);
    if places.iter().all(|place| place.is_off || nearest(place.up) == 0) {
        return;
    }
    let limits = &tread.all.limits;
    ramp(&mut places, path, limits.steepest);
    straighten(&mut places, limits.tolerance);
    let keeps_height = path.role == Role::Ironing;
    let up = |place: &Place| nearest(place.up) as Coord;
    let first = path.points.first().zip(places.first());
    let mut out: Vec<PathPoint> =
        first.map(|(point, place)| PathPoint { z: up(place), ..*point }).into_iter().collect();
    for (ends, point) in firsts.windows(2).zip(&path.points[1..]) {
        let mut from = ends[0];
        for to in chords(&places, [ends[0], ends[1]], limits) {
            let more = if keeps_height { 0 } else { nearest(mean(&places[from..=to])) as Coord };
            let height = point.height + more;
            out.push(PathPoint { at: places[to].at, z: up(&places[to]), height, ..*point });
            from = to;
        }
    }
    path.points = out;
}

/// The places of a path, and which of them are its points.
fn places(
    path: &Path,
    tread: &Tread<'_>,
    zones: &Zones,
    [lowest, highest]: [f64; 2],
) -> (Vec<Place>, Vec<usize>) {
    let place = |at: Point, along: f64, hangs: bool| {
        let cell = cell_around(at);
        // Above the middle of the layer above, there is that layer.
        let bare = tread.above(at).filter(|_| !hangs);
        let up = match bare {
            Some(up) if 2.0 * up >= f64::from(tread.layer.height) => None,
            Some(up) if zones.lets(cell, up > 0.0) => Some(up.clamp(lowest, highest)),
            _ => None,
        };
        Place { at, along, up: up.unwrap_or(0.0), is_off: up.is_none() }
    };
    let hangs = |k: usize| path.points.get(k).is_some_and(|point| point.hang > 0);
    let (mut out, mut firsts, mut along) = (Vec::new(), vec![0], 0.0);
    if let Some(first) = path.points.first() {
        out.push(place(first.at, 0.0, hangs(1)));
    }
    for (k, ends) in (1..).zip(path.points.windows(2)) {
        let (a, b) = (ends[0].at, ends[1].at);
        let length = a.distance(b);
        let count = (length / STEP).ceil().max(1.0);
        for step in 1..count as usize {
            let share = step as f64 / count;
            out.push(place(between(a, b, share), along + share * length, hangs(k)));
        }
        along += length;
        out.push(place(b, along, hangs(k) || hangs(k + 1)));
        firsts.push(out.len() - 1);
    }
    (out, firsts)
}

/// Lets heights go away from what is off no steeper than `steepest`. Round a loop, too.
fn ramp(places: &mut [Place], path: &Path, steepest: f64) {
    let is_closed = matches!(path.shape, Shape::Loop { .. }) && path.start() == path.end();
    let whole = places.last().map_or(0.0, |last| last.along);
    let way = |along: f64, off: f64| (along - off).abs();
    let offs: Vec<f64> =
        places.iter().filter(|place| place.is_off).map(|place| place.along).collect();
    let Some((&first, &last)) = offs.first().zip(offs.last()) else { return };
    let is_wall = matches!(path.role, Role::OuterWall | Role::InnerWall);
    let rises = steepest.min(GENTLE[usize::from(!is_wall)]);
    for place in places.iter_mut() {
        let after = offs.partition_point(|&off| off <= place.along);
        let mut near = f64::MAX;
        for off in [after.checked_sub(1), Some(after)].into_iter().flatten() {
            near = offs.get(off).map_or(near, |&off| near.min(way(place.along, off)));
        }
        if is_closed {
            near = near.min(way(place.along + whole, last)).min(way(place.along, first + whole));
        }
        place.up = place.up.clamp(-steepest * near, rises * near);
    }
}

/// Makes heights straight between as few places as keep to them within the tolerance.
fn straighten(places: &mut [Place], tolerance: f64) {
    let on = |a: &Place, b: &Place, along: f64| {
        let length = b.along - a.along;
        if length > 0.0 { a.up + (b.up - a.up) * (along - a.along) / length } else { b.up }
    };
    let off = |a: usize, b: usize, k: usize| {
        (places[k].up - on(&places[a], &places[b], places[k].along)).abs()
    };
    let kept = decimate(places.len(), |a, b| most_missed(a, b, tolerance, |k| off(a, b, k)));
    for ends in kept.windows(2) {
        let (a, b) = (places[ends[0]], places[ends[1]]);
        for place in &mut places[ends[0] + 1..ends[1]] {
            place.up = on(&a, &b, place.along);
        }
    }
}

/// The places at which chords end, from the first of a segment to its last.
fn chords(places: &[Place], [first, last]: [usize; 2], limits: &Limits) -> Vec<usize> {
    let (mut out, mut open) = (Vec::new(), vec![[first, last]]);
    while let Some([from, to]) = open.pop() {
        match divided(places, [from, to], limits) {
            Some(at) => open.extend([[at, to], [from, at]]),
            None => out.push(to),
        }
    }
    out
}

/// The place where a chord is divided, if it has to be and is long enough.
fn divided(places: &[Place], [from, to]: [usize; 2], limits: &Limits) -> Option<usize> {
    let (a, b) = (places[from], places[to]);
    let length = b.along - a.along;
    if length < 2.0 * limits.shortest {
        return None;
    }
    let off = |k: &usize| {
        let on = a.up + (b.up - a.up) * (places[*k].along - a.along) / length;
        (places[*k].up - on).abs()
    };
    let furthest = (from + 1..to).max_by(|j, k| off(j).total_cmp(&off(k)))?;
    let miss = off(&furthest);
    let wanted = if miss > limits.tolerance {
        places[furthest].along
    } else if (b.up - a.up).abs() > CHANGE || (miss > STRAIGHT && length > limits.segment) {
        f64::midpoint(a.along, b.along)
    } else {
        return None;
    };
    let fits = |k: &usize| {
        let along = places[*k].along;
        along >= a.along + limits.shortest && along <= b.along - limits.shortest
    };
    let far = |k: &usize| (places[*k].along - wanted).abs();
    (from + 1..to).filter(fits).min_by(|j, k| far(j).total_cmp(&far(k)))
}

/// The mean height of some places along their way.
fn mean(places: &[Place]) -> f64 {
    let Some((first, last)) = places.first().zip(places.last()) else { return 0.0 };
    let length = last.along - first.along;
    if length <= 0.0 {
        return f64::midpoint(first.up, last.up);
    }
    let part = |ends: &[Place]| (ends[1].along - ends[0].along) * (ends[0].up + ends[1].up) / 2.0;
    places.windows(2).map(part).sum::<f64>() / length
}
