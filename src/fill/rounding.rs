//! Path -> Path: sharp turns cut into a few flat ones, which the nozzle takes without stopping.
//!
//! A machine brakes for a corner the more, the sharper it is, and a zig-zag is
//! nothing but lines and corners. Each corner sharper than `SHARPEST` gives way
//! to equal ones along an arc within the triangle that it spans. The arc is shorter
//! than the way round the corner; the material that this saves is spread over the
//! whole path, since a wider arc would be more at once than a hot end melts.

use super::path::PathPoint;
use crate::geom::Point;
use crate::units::{Bounded as _, Coord, nearest};

/// Corners of arcs turn by at most this much, degrees. Where a machine allows a change of
/// velocity by 15 mm/s at once, it passes them at 48 mm/s.
const FLAT: f64 = 18.0;

/// Cosine of the sharpest corner that is left as it is, 25°.
const SHARPEST: f64 = 0.9063;

/// Cosine of the sharpest corner that is rounded, 165°: a line that all but comes back
/// on itself has no room for an arc.
const FOLDED: f64 = -0.9659;

/// Arcs take at most this share of a line between two corners: what is left of it keeps
/// their ends from meeting in a corner of twice the angle.
const MOST_TAKEN: f64 = 0.84;

/// Segments of an arc are at least this long (0.12 mm): shorter ones are more than
/// firmware keeps up with and look-ahead profits from.
const LEAST_SEGMENT: f64 = 1200.0;

/// An arc takes at most this many radii of a line: those of sharp corners become
/// smaller, since they save so much way that its material would make a blob.
const MOST_TANGENT: f64 = 1.2;

/// A path gets at most this many times as wide to carry what its arcs save.
const MOST_MORE: f64 = 1.04;

/// Joins up to this many radii long are laid with one width together with the arcs at their ends.
const LONGEST_LEVELLED: f64 = 2.5;

/// A way of rounding corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    /// Radius of the arcs where the lines have room for it, grid units; 0 leaves corners sharp.
    pub radius: Coord,
}

impl Rounding {
    /// Rounds the corners of `points`. Its ends and the middles of its lines stay.
    #[must_use]
    pub fn round(self, points: Vec<PathPoint>) -> Vec<PathPoint> {
        if self.radius <= 0 || points.len() < 3 {
            return points;
        }
        let lines: Vec<Line> = points.windows(2).map(|w| Line::new(w[0].at, w[1].at)).collect();
        let wanted: Vec<f64> = lines.windows(2).map(|w| self.tangent(w[0], w[1])).collect();
        if wanted.iter().all(|&t| t <= 0.0) {
            return points;
        }
        // What each line can give of what the corners at its two ends want.
        let at = |k: Option<usize>| k.and_then(|k| wanted.get(k)).copied().unwrap_or(0.0);
        let share = |k: usize| {
            let asked = at(k.checked_sub(1)) + at(Some(k));
            (MOST_TAKEN * lines[k].length / asked.at_least(1.0)).at_most(1.0)
        };
        let mut out = Vec::with_capacity(4 * points.len());
        out.extend(points.first());
        let mut last = 0;
        for (k, corner) in points.windows(3).enumerate() {
            let first = out.len();
            // A line's end without a corner keeps half of it for itself.
            let half = lines[k].length.at_most(lines[k + 1].length) / 2.0;
            let t = (wanted[k] * share(k).at_most(share(k + 1))).at_most(half);
            round_off(corner, (lines[k], lines[k + 1]), t, &mut out);
            if k > 0 && lines[k].length <= LONGEST_LEVELLED * f64::from(self.radius) {
                level(&mut out[last..]);
            }
            last = first;
        }
        out.extend(points.last());
        let more = (volume(&points) / volume(&out)).clamp(1.0, MOST_MORE);
        for point in &mut out {
            point.width = nearest(f64::from(point.width) * more) as Coord;
        }
        out
    }

    /// How much of both lines an arc of the whole radius takes; none of a flat corner.
    fn tangent(self, a: Line, b: Line) -> f64 {
        let cos = a.cos(b);
        if cos >= SHARPEST || cos <= FOLDED {
            return 0.0;
        }
        // tan(θ/2) of the turn θ.
        f64::from(self.radius) * ((1.0 - cos) / (1.0 + cos)).sqrt().at_most(MOST_TANGENT)
    }
}

/// Lays two arcs and the join between them with one width: the flow need not change within.
fn level(turn: &mut [PathPoint]) {
    let length: f64 = turn.windows(2).map(|w| w[0].at.distance(w[1].at)).sum();
    let width = nearest(volume(turn) / length.at_least(1.0)) as Coord;
    turn.iter_mut().skip(1).for_each(|p| p.width = width);
}

/// Length times width of all of a path, grid units².
fn volume(points: &[PathPoint]) -> f64 {
    points.windows(2).map(|w| w[0].at.distance(w[1].at) * f64::from(w[1].width)).sum()
}

/// A line of a path: its direction (of length 1) and its length, grid units.
#[derive(Debug, Clone, Copy)]
struct Line {
    x: f64,
    y: f64,
    length: f64,
}

impl Line {
    fn new(a: Point, b: Point) -> Self {
        Self::towards(f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y))
    }

    fn towards(x: f64, y: f64) -> Self {
        let length = (x * x + y * y).sqrt();
        let by = if length > 0.0 { 1.0 / length } else { 0.0 };
        Self { x: x * by, y: y * by, length }
    }

    /// Cosine of the turn from this line to `next`.
    fn cos(self, next: Self) -> f64 {
        self.x * next.x + self.y * next.y
    }
}

/// The segments of an arc.
struct Arc {
    /// How many corners it has, all alike; one segment less.
    corners: u32,
    /// The length of each segment, grid units.
    length: f64,
    /// Cosine and sine of each corner's turn.
    turn: (f64, f64),
}

impl Arc {
    /// The arc that takes `t` of both lines: with flat corners, but no more than make
    /// segments long enough; none if two are too many.
    fn new(a: Line, b: Line, t: f64) -> Option<Self> {
        let cos = a.cos(b).clamp(-1.0, 1.0);
        let whole = libm::acos(cos);
        // Of half the turn, from here to the chord.
        let (sin_half, cos_half) = (((1.0 - cos) / 2.0).sqrt(), ((1.0 + cos) / 2.0).sqrt());
        let chord = 2.0 * t * cos_half;
        let left = a.x * b.y - a.y * b.x >= 0.0;
        let with = |corners: u32| {
            // Of half of a corner's turn: h of n corners is 1/2n of the whole.
            let (sin, cos) = libm::sincos(whole / f64::from(2 * corners));
            // By the law of sines between the chord and each segment: (n - 1) h is half the turn less h.
            let length = chord * sin / (sin_half * cos - cos_half * sin);
            let across = 2.0 * sin * cos;
            let turn = (1.0 - 2.0 * sin * sin, if left { across } else { -across });
            Self { corners, length, turn }
        };
        // All segments together are no longer than what they take the place of.
        let most =
            ((2.0 * t / LEAST_SEGMENT) as u32 + 1).min((whole.to_degrees() / FLAT).ceil() as u32);
        (2..=most).rev().map(with).find(|arc| arc.length >= LEAST_SEGMENT)
    }
}

/// Appends the way to and round the middle of three points, with `t` of both lines cut off.
fn round_off(corner: &[PathPoint], (a, b): (Line, Line), t: f64, out: &mut Vec<PathPoint>) {
    let &[_, middle, next] = corner else { return };
    let Some(arc) = Some(t).filter(|&t| t > 0.0).and_then(|t| Arc::new(a, b, t)) else {
        out.push(middle);
        return;
    };
    let (in_width, out_width) = (f64::from(middle.width), f64::from(next.width));
    let all = (in_width + out_width) * t / (f64::from(arc.corners - 1) * arc.length);
    let width = nearest(all.at_most(in_width.at_least(out_width))) as Coord;
    let (mut u, mut v) = (a.x, a.y);
    let (mut x, mut y) = (f64::from(middle.at.x) - t * u, f64::from(middle.at.y) - t * v);
    let point = |x: f64, y: f64| Point { x: nearest(x) as Coord, y: nearest(y) as Coord };
    out.push(PathPoint { at: point(x, y), ..middle });
    let (cos, sin) = arc.turn;
    for _ in 1..arc.corners {
        (u, v) = (u * cos - v * sin, u * sin + v * cos);
        (x, y) = (x + arc.length * u, y + arc.length * v);
        out.push(PathPoint { at: point(x, y), width, ..middle });
    }
}
