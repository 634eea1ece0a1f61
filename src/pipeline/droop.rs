//! Outer walls of successive layers -> what droops: long stretches that hang over nothing.
//!
//! A *stretch* is a run of an outer wall that hangs by its whole width, which [`region`](crate::region) has
//! measured. It droops where it lies away from all that is printed in the layer below, and over no
//! support: what hangs by little holds on to the wall beside it. Runs that bridge straight from hold to
//! hold, and short ones, are left out. A print with some of it is usual: a figure has a chin.

use super::carried::Carried;
use super::footprint::Footprint;
use crate::fill::adhesion::lift::Lift;
use crate::fill::{Path, Role, Shape};
use crate::geom::Point;
use crate::region::Region;
use crate::units::{Coord, UNITS_PER_MM, to_mm};
use crate::warning::Warning;

/// Less of a stretch is never told, mm: the plastic of a wall holds itself that far.
const LEAST: f64 = 10.0;

/// Warn if so much of one stretch droops, mm.
const LONG: f64 = 20.0;

/// Warn if so much of all stretches droops, mm.
const MUCH: f64 = 100.0;

/// What lies as near as this to the layer below holds on to its neighbours, mm: two lines and a half.
const AWAY: f64 = 1.0;

/// A run is a bow, not a bridge, if its ends lie nearer than this part of its length: a half circle has 0.64.
const BOW: f64 = 0.7;

/// How far apart the places of a stretch are that are looked at, mm.
const STEP: f64 = 1.0;

/// A run of an outer wall that hangs by its whole width.
#[derive(Debug)]
pub struct Stretch {
    points: Vec<Point>,
    /// Whether it is all of a loop: it goes on at its first point, which its last one repeats.
    closed: bool,
    /// Whether the wall goes on before its first point and beyond its last one.
    held: [bool; 2],
}

/// The stretches of a layer's paths that may droop.
#[must_use]
pub fn stretches(paths: &[Path]) -> Vec<Stretch> {
    let outer = paths.iter().filter(|path| path.role == Role::OuterWall);
    outer.flat_map(of_wall).filter(|stretch| stretch.length() >= LEAST).collect()
}

/// The stretches of a wall.
fn of_wall(path: &Path) -> Vec<Stretch> {
    let hangs = |k: usize| path.points[k].hang >= 100;
    let n = path.points.len();
    if !(1..n).any(hangs) {
        return Vec::new();
    }
    let is_loop = matches!(path.shape, Shape::Loop { .. });
    // A loop is looked at from a place that does not hang, so that no stretch lies across its ends.
    let first = (1..n).find(|&k| is_loop && !hangs(k)).unwrap_or(0);
    let order: Vec<usize> = (first + 1..n).chain(1..=first).collect();
    let mut from = 0;
    let mut out = Vec::new();
    for run in order.chunk_by(|&a, &b| hangs(a) == hangs(b)) {
        let goes_on = [from > 0, from + run.len() < order.len()];
        from += run.len();
        if hangs(run[0]) {
            let ends = run.iter().map(|&k| path.points[k].at);
            let points = std::iter::once(path.points[run[0] - 1].at).chain(ends).collect();
            let closed = is_loop && goes_on == [false; 2];
            out.push(Stretch { points, closed, held: goes_on.map(|on| on || is_loop) });
        }
    }
    out
}

impl Stretch {
    /// mm.
    fn length(&self) -> f64 {
        length(&self.points)
    }

    /// Places on it, some [`STEP`] apart.
    fn places(&self) -> Vec<Point> {
        let between = |two: &[Point]| {
            let (from, to) = (two[0], two[1]);
            let count = (from.distance(to) / (STEP * UNITS_PER_MM)).ceil().max(1.0) as i64;
            let on = move |a: Coord, b: Coord, k: i64| {
                (i64::from(a) + (i64::from(b) - i64::from(a)) * k / count) as Coord
            };
            (0..count).map(move |k| Point { x: on(from.x, to.x, k), y: on(from.y, to.y, k) })
        };
        self.points.windows(2).flat_map(between).collect()
    }

    /// Its runs of places that hang, but for those that bridge straight from hold to hold.
    fn loose(&self, hangs: &impl Fn(Point) -> bool) -> Vec<Vec<Point>> {
        let places = self.places();
        let mut marked: Vec<(Point, bool)> = places.into_iter().map(|at| (at, hangs(at))).collect();
        let held = marked.iter().position(|(_, hangs)| !hangs).filter(|_| self.closed);
        marked.rotate_left(held.unwrap_or(0));
        let is_held = held.is_some() || !self.closed;
        let mut from = 0;
        let mut out = Vec::new();
        for run in marked.chunk_by(|a, b| a.1 == b.1) {
            let (before, after) = (from > 0, from + run.len() < marked.len());
            from += run.len();
            let ends = is_held && (before || self.held[0]) && (after || self.held[1]);
            let chord = run[0].0.distance(run[run.len() - 1].0) / UNITS_PER_MM;
            let at: Vec<Point> = run.iter().map(|(at, _)| *at).collect();
            if run[0].1 && !(ends && chord >= BOW * length(&at)) {
                out.push(at);
            }
        }
        out
    }
}

/// The length of a run of places, mm.
fn length(places: &[Point]) -> f64 {
    places.windows(2).map(|two| two[0].distance(two[1])).sum::<f64>() / UNITS_PER_MM
}

/// The longest stretch so far.
#[derive(Debug, Clone, Copy)]
struct Longest {
    length: f64,
    layer: usize,
    z: Coord,
    at: Point,
}

/// What droops of the layers so far.
#[derive(Debug, Default)]
pub struct Droop {
    /// Of all stretches, mm.
    length: f64,
    longest: Option<Longest>,
}

impl Droop {
    /// Adds the stretches of the next layer, that of `region`, over the layer below and its support.
    pub fn layer(
        &mut self,
        stretches: &[Stretch],
        region: &Region,
        below: &Footprint,
        support: &Carried,
    ) {
        let hangs =
            |place: Point| !below.is_near(place, AWAY * UNITS_PER_MM) && !support.carries(place);
        for run in stretches.iter().flat_map(|stretch| stretch.loose(&hangs)) {
            let length = length(&run);
            if length < LEAST {
                continue;
            }
            self.length += length;
            if self.longest.is_none_or(|longest| length > longest.length) {
                let (layer, z) = (region.layer.index, region.layer.z);
                self.longest = Some(Longest { length, layer, z, at: run[run.len() / 2] });
            }
        }
    }

    /// A warning, if it is much. `offset` is the middle of the layout in the machine's coordinates, mm.
    #[must_use]
    pub fn warning(&self, offset: [f64; 2], lift: &Lift, supported: bool) -> Option<Warning> {
        let longest = self.longest?;
        (longest.length > LONG || self.length > MUCH).then(|| Warning::WallsHang {
            length_mm: self.length,
            longest_mm: longest.length,
            layer: longest.layer + 1 + lift.layers(),
            z_mm: to_mm(longest.z + lift.by()),
            at_mm: [offset[0] + to_mm(longest.at.x), offset[1] + to_mm(longest.at.y)],
            supported,
        })
    }
}
