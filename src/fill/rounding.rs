//! Path -> Path: sharp turns cut into a few flat ones, which the nozzle takes without stopping.
//!
//! Words: a *line* is a segment of the path. A *corner* lies between two lines, a *turn* is the
//! angle between them. The *tangent length* of an arc is what it takes of each line. A *join* is
//! the short line between two long ones of a zigzag.
//!
//! The sharper a corner, the more a machine brakes for it, and a zigzag is nothing but lines and
//! corners. Algorithm: each corner sharper than `SHARPEST` is replaced by equal, flatter ones
//! along an arc inside the triangle it spans. Where two corners want more of the line between
//! them than it has, both get less. An arc is shorter than the corner it cuts off. A wider arc
//! would carry the plastic that this saves, but needs more at once than a hot end melts. So the
//! plastic is spread over the whole path instead.

use super::path::PathPoint;
use crate::geom::Point;
use crate::units::{Bounded as _, Coord, nearest};

/// Maximum turn of an arc's corners, degrees. A machine that allows a sudden change of velocity
/// of 15 mm/s passes them at 48 mm/s: 15 / (2 sin 9°). A larger value brakes more at each corner,
/// a smaller one makes more and shorter segments.
const FLAT: f64 = 18.0;

/// Cosine of the largest turn that is left as it is, 25°. An arc replaces it by at least two
/// corners, which gains little at flat turns and costs moves.
const SHARPEST: f64 = 0.9063;

/// Cosine of the largest turn that is rounded, 165°. A line that nearly returns on itself has no
/// room for an arc.
const FOLDED: f64 = -0.9659;

/// Maximum share of a line that the arcs at its two ends take. The rest keeps the arcs from
/// meeting: at 1 their last corners would merge into one with twice the turn. A smaller value
/// makes the arcs smaller and slower.
const MOST_TAKEN: f64 = 0.84;

/// Minimum length of an arc's segments (0.12 mm). Firmware cannot keep up with shorter ones, and
/// its look-ahead gains nothing from them. It was 0.15 mm until the turns of skins were rounded
/// too: their arcs are smaller and would get too few segments.
const LEAST_SEGMENT: f64 = 1200.0;

/// Maximum tangent length, in radii. It makes the arcs of sharp corners smaller: cut off further,
/// they would save so much path that the saved plastic makes a blob. It was 1.7 before that
/// plastic was spread over the path.
const MOST_TANGENT: f64 = 1.2;

/// Maximum factor by which a path gets wider to carry the plastic that its arcs save. A larger
/// value (1.1 at first) makes lines visibly wider; at 1 the print gets lighter with each arc.
const MOST_MORE: f64 = 1.04;

/// Joins up to this many radii long get one width together with the arcs at their ends, so that
/// the flow stays constant through the turn. A larger value spreads plastic further from where
/// it belongs; at 0 the flow changes within each turn.
const LONGEST_LEVELLED: f64 = 2.5;

/// A way of rounding corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    /// Radius of the arcs where the lines have room for it, grid units; 0 leaves corners sharp.
    pub radius: Coord,
}

impl Rounding {
    /// Rounds the corners of `points`. The ends of the path and the middles of its lines stay.
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
        // The share of their wanted tangent lengths that a line can give the corners at its ends.
        let at = |k: Option<usize>| k.and_then(|k| wanted.get(k)).copied().unwrap_or(0.0);
        let share = |k: usize| {
            let wanted = at(k.checked_sub(1)) + at(Some(k));
            (MOST_TAKEN * lines[k].length / wanted.at_least(1.0)).at_most(1.0)
        };
        let mut out = Vec::with_capacity(4 * points.len());
        out.extend(points.first());
        let mut last = 0;
        for (k, corner) in points.windows(3).enumerate() {
            let first = out.len();
            // At a line's end without a corner, half of the line stays as it is.
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

    /// The tangent length of an arc with the whole radius; 0 for a corner that stays.
    fn tangent(self, a: Line, b: Line) -> f64 {
        let cos = a.cos(b);
        if cos >= SHARPEST || cos <= FOLDED {
            return 0.0;
        }
        // tan(θ/2) of the turn θ.
        f64::from(self.radius) * ((1.0 - cos) / (1.0 + cos)).sqrt().at_most(MOST_TANGENT)
    }
}

/// Gives two arcs and the join between them one width, so that the flow stays constant.
fn level(turn: &mut [PathPoint]) {
    let length: f64 = turn.windows(2).map(|w| w[0].at.distance(w[1].at)).sum();
    let width = nearest(volume(turn) / length.at_least(1.0)) as Coord;
    turn.iter_mut().skip(1).for_each(|p| p.width = width);
}

/// Sum of length times width over a path, grid units².
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
    /// Number of corners, all equal; it has one segment less.
    corners: u32,
    /// The length of each segment, grid units.
    length: f64,
    /// Cosine and sine of each corner's turn.
    turn: (f64, f64),
}

impl Arc {
    /// The arc with tangent length `t`. It has as many corners as [`FLAT`] asks for, or fewer if
    /// segments would get shorter than [`LEAST_SEGMENT`]. `None` if even two are too many.
    fn new(a: Line, b: Line, t: f64) -> Option<Self> {
        let cos = a.cos(b).clamp(-1.0, 1.0);
        let whole = libm::acos(cos);
        // Sine and cosine of half the turn: the angle between either line and the chord.
        let (sin_half, cos_half) = (((1.0 - cos) / 2.0).sqrt(), ((1.0 + cos) / 2.0).sqrt());
        let chord = 2.0 * t * cos_half;
        let left = a.x * b.y - a.y * b.x >= 0.0;
        let with = |corners: u32| {
            // Sine and cosine of h, half the turn of one of n corners: 1/2n of the whole turn.
            let (sin, cos) = libm::sincos(whole / f64::from(2 * corners));
            // Law of sines between the chord and each segment: (n - 1) h is half the turn less h.
            let length = chord * sin / (sin_half * cos - cos_half * sin);
            let across = 2.0 * sin * cos;
            let turn = (1.0 - 2.0 * sin * sin, if left { across } else { -across });
            Self { corners, length, turn }
        };
        // All segments together are no longer than the 2 t that they replace.
        let most =
            ((2.0 * t / LEAST_SEGMENT) as u32 + 1).min((whole.to_degrees() / FLAT).ceil() as u32);
        (2..=most).rev().map(with).find(|arc| arc.length >= LEAST_SEGMENT)
    }
}

/// Appends the middle of three points, or the arc with tangent length `t` that replaces it.
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
