//! Wall and exposed rows -> Samples where rows cross the wall's inner edge, by what is behind it.

use super::{GAP, NARROWEST, WallSample, beads, count_across};
use crate::geom::spans::{Rows, Span};
use crate::geom::{Contour, Point, edges};
use crate::region::crossed::Crossed;
use crate::region::params::BeadParams;
use crate::units::{Bounded as _, Coord, between, nearest};

/// Samples a wall where rows cross its inner edge. Each edge is sampled on the raster whose rows
/// cross it at 45° or steeper.
pub(super) fn measured(
    wall: &Contour,
    crossed: &Crossed<'_>,
    params: &BeadParams,
) -> Vec<WallSample> {
    let turned = |p: Point| {
        if crossed.left_turn { Point { x: p.y, y: -p.x } } else { Point { x: -p.y, y: p.x } }
    };
    let mut out = Vec::with_capacity(wall.len());
    let mut position = 0.0;
    for (p, q) in edges(wall) {
        let steep = (q.y - p.y).abs() >= (q.x - p.x).abs();
        let edge = Side::new(p, q, position);
        position += edge.length;
        if steep {
            edge.measure((p, q), (crossed.fill, crossed.skin), params, &mut out);
        } else {
            let ends = (turned(p), turned(q));
            edge.measure(ends, (crossed.fill_columns, crossed.columns), params, &mut out);
        }
    }
    out
}

/// An edge of a wall.
pub(super) struct Side {
    pub(super) from: [f64; 2],
    /// Its direction; the solid is on its left.
    pub(super) along: [f64; 2],
    pub(super) length: f64,
    /// Position of its start.
    position: f64,
}

impl Side {
    pub(super) fn new(p: Point, q: Point, position: f64) -> Self {
        let length = p.distance(q);
        let [x, y] = [f64::from(q.x) - f64::from(p.x), f64::from(q.y) - f64::from(p.y)];
        let from = [f64::from(p.x), f64::from(p.y)];
        Self { from, along: [x / length.at_least(1.0), y / length.at_least(1.0)], length, position }
    }

    pub(super) fn normal(&self) -> [f64; 2] {
        [-self.along[1], self.along[0]]
    }

    /// Adds the samples where the rows of `fill` and `exposed` cross this edge. It runs from `p` to
    /// `q` in the frame of these rows.
    fn measure(
        &self,
        (p, q): (Point, Point),
        (fill, exposed): (&Rows, &Rows),
        params: &BeadParams,
        out: &mut Vec<WallSample>,
    ) {
        let inset = f64::from(params.wall_to_fill);
        let rise = f64::from(q.y) - f64::from(p.y);
        let run = f64::from(q.x) - f64::from(p.x);
        let by = |part: f64| nearest(inset * part / self.length.at_least(1.0)) as Coord;
        let moved = |p: Point| Point { x: p.x - by(rise), y: p.y + by(run) };
        let (a, b) = (moved(p), moved(q));
        let up = a.y < b.y;
        let (low, high) = if up { (a, b) } else { (b, a) };
        let pitch = params.line_width;
        let sine = rise.abs() / self.length.at_least(1.0);
        let first = out.len();
        for j in low.y.div_euclid(pitch) + 1..high.y.div_euclid(pitch) + 1 {
            let v = j * pitch;
            let u = between(low.x, high.x, (v, low.y, high.y));
            let t = f64::from(v - a.y) / f64::from(b.y - a.y);
            let at = [0, 1].map(|k| self.from[k] + t * self.length * self.along[k]);
            let blank = WallSample {
                at,
                normal: self.normal(),
                depth: 0.0,
                shared: false,
                leads: false,
                beads: 0,
                position: self.position + t * self.length,
                skin: false,
            };
            if exposed.row(j).is_empty() {
                out.push(blank);
                continue;
            }
            let behind = Behind::new(fill.row(j), exposed.row(j), u, !up, pitch);
            out.extend(behind.map(|b| b.sample(blank, sine, params)));
        }
        if !up {
            out[first..].reverse();
        }
    }
}

/// What a row has behind the inner edge of the walls.
struct Behind {
    /// Length of the exposed skin that begins there.
    skin: i64,
    /// Length of the exposed skin at the other end.
    other: i64,
    /// Length of the row up to the walls at the other end.
    room: i64,
}

impl Behind {
    /// For a row that crosses the edge near `u`, with the solid to the right or to the left.
    fn new(fill: &[Span], exposed: &[Span], u: Coord, right: bool, pitch: Coord) -> Option<Self> {
        let end = |s: &Span| if right { s.start } else { s.end };
        // On a plate a row has spans of all parts: few of them begin or end near here.
        let near = fill.partition_point(|s| end(s) < u - pitch / 4);
        let near = fill[near..].iter().take_while(|s| end(s) <= u + pitch / 4);
        let fill = near.min_by_key(|s| (end(s) - u).abs())?;
        let from = exposed.partition_point(|s| s.end <= fill.start);
        let to = exposed.partition_point(|s| s.start < fill.end);
        let here = exposed.get(from..to).unwrap_or_default().iter();
        let distance = |a: Coord, b: Coord| i64::from(b) - i64::from(a);
        let from_start = |s: &Span| (distance(fill.start, s.start), distance(fill.start, s.end));
        let from_end = |s: &Span| (distance(s.end, fill.end), distance(s.start, fill.end));
        let at_start = reach(here.clone().map(from_start), pitch);
        let at_end = reach(here.rev().map(from_end), pitch);
        let (skin, other) = if right { (at_start, at_end) } else { (at_end, at_start) };
        Some(Self { skin, other, room: fill.len() })
    }

    /// Completes `blank` with what is behind it. `sine` is of the angle between row and edge.
    fn sample(&self, blank: WallSample, sine: f64, params: &BeadParams) -> WallSample {
        let w = f64::from(params.line_width);
        let lead = f64::from(params.wall_to_fill) - w / 2.0;
        let skin = self.skin > 0 || self.other > 0;
        let depth = |length: i64| length as f64 * sine + lead;
        // Beads cover at least their minimum width on either side.
        let taken = |length: i64| if length > 0 { depth(length).max(NARROWEST * w) } else { 0.0 };
        let across = depth(self.room) + lead;
        if skin && across - taken(self.skin) - taken(self.other) <= GAP * w {
            let depth = across / 2.0;
            let beads = count_across(across / w).map_or(0, |count| count.div_ceil(2));
            return WallSample { depth, shared: true, beads, skin: true, ..blank };
        }
        if self.skin == 0 {
            return blank;
        }
        let depth = depth(self.skin);
        WallSample { depth, beads: beads(depth, w), skin: true, ..blank }
    }
}

/// How far exposed stretches reach, beginning at zero. A covered gap shorter than half a `pitch`
/// is noise and does not end them.
fn reach(stretches: impl Iterator<Item = (i64, i64)>, pitch: Coord) -> i64 {
    let mut end = 0;
    for (from, to) in stretches {
        if from > end + i64::from(pitch / 2) {
            break;
        }
        end = to;
    }
    end
}
