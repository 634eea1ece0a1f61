//! Contours -> contours: loops without the places that are too thin for both of their passes.
//!
//! Where the room for a loop is hardly wider than a line, it would run out and back on itself: two
//! beads in the room of one, up to twice the plastic. There the loop is cut off, and the room gets
//! one bead (`super::middle`).

use crate::geom::boxes::Around;
use crate::geom::spans::{Rows, Span};
use crate::geom::{Contour, double_area, edges, polygon};
use crate::region::params::WallParams;
use crate::units::{Coord, nearest};
use std::cell::LazyCell;

/// Shorter thin places stay in a loop, in line widths: they are corners. With a smaller value
/// corners lose their wall; with a larger one the strokes of small letters get both passes. A wedge
/// blunter than 20° is shorter than this.
const SHORT: f64 = 2.0;

/// Loops are grown by this (2 µm) before they are compared or cut, so that rounding to the grid
/// leaves no slivers along their edges.
const ROUNDING: Coord = 20;

/// Passes may be this much (5 µm) nearer to each other. So a wall of exactly the limit gets one
/// bead on every layer, whichever way its contours were rounded.
pub(super) const LIMIT: Coord = 50;

/// Room in line widths from which on one more loop fits inside another: its two passes then are
/// three quarters of a line wide.
pub(super) const ONE_MORE: f64 = 1.5;

/// Whether a layer may have such thin places, given its contours and its inside on two crossing
/// rasters. This is a cheap test to skip most layers: a thin place longer than a few lines has
/// short spans on two neighbouring rows of at least one raster; shorter ones are contours of their
/// own or corners.
#[must_use]
pub fn may_be_thin(contours: &[Contour], insides: [&Rows; 2], params: &WallParams) -> bool {
    let limit = f64::from(2 * params.inset_of_narrow()) * std::f64::consts::SQRT_2;
    let is_short = |s: &&Span| (s.len() as f64) < limit;
    // A strip that rows cross at 45° or steeper moves on by at most their distance from row to row.
    let meets = |a: &Span, b: &Span| {
        a.start - params.line_width <= b.end && b.start - params.line_width <= a.end
    };
    let is_small = |contour: &Contour| {
        let extent = |of: fn(&crate::geom::Point) -> Coord| {
            let (low, high) = (contour.iter().map(of).min(), contour.iter().map(of).max());
            low.zip(high).map_or(0.0, |(low, high)| f64::from(high) - f64::from(low))
        };
        extent(|p| p.x).min(extent(|p| p.y)) < limit
    };
    params.count > 0
        && (contours.iter().any(is_small)
            || insides.iter().any(|rows| {
                rows.iter().any(|(j, row)| {
                    let next = rows.row(j + 1);
                    let mut short = row.iter().filter(is_short);
                    short.any(|a| next.iter().filter(is_short).any(|b| meets(a, b)))
                })
            }))
}

/// Cuts off the places where two passes of the loops of this `depth` are too near to each other, and
/// whether there are any. `outer` is what the loops are insets of, by `distance`.
#[must_use]
pub fn open(
    loops: Vec<Contour>,
    (outer, distance): (&[Contour], Coord),
    depth: u32,
    params: &WallParams,
) -> (Vec<Contour>, bool) {
    let half = (params.least_apart(depth) / 2).max(1);
    let short = SHORT * f64::from(params.line_width);
    // Shrunk by half, the passes of a thin place would meet or vanish. If none do, nothing is thin.
    let (mut kept, mut rest) = sorted_out(loops, |group| {
        polygon::sharpest(group) * f64::from(half) <= short
            && polygon::keep_shape(group, half, short)
    });
    if rest.is_empty() {
        return (kept, false);
    }
    let shrunk = polygon::inset(&rest, half);
    // Of a loop without anything left inside it, all is thin: a strip, a bulge of one, or a dot.
    let outers = outers(&rest);
    let mut holds = vec![false; rest.len()];
    shrunk.iter().flat_map(|inner| outers.of(inner[0])).for_each(|k| holds[k] = true);
    let dots = LazyCell::new(|| Around::new(outer.iter().enumerate()));
    let vanishes = |(k, path): (usize, &Contour)| {
        double_area(path) > 0
            && !holds[k]
            && (perimeter(path) >= 2.0 * short || !is_dot(path, (outer, &dots), distance))
    };
    let vanished: Vec<bool> = rest.iter().enumerate().map(vanishes).collect();
    let cut = vanished.contains(&true);
    if cut {
        let left = (0..rest.len()).filter(|&k| !vanished[around(&rest, &outers, k)]);
        rest = left.map(|k| rest[k].clone()).collect();
    }
    if rest.is_empty() {
        return (kept, cut);
    }
    let opened = polygon::outset(&shrunk, half + ROUNDING);
    let mut thin = polygon::difference(&rest, &opened, ROUNDING);
    thin.retain(|c| perimeter(c) >= 2.0 * short);
    if thin.is_empty() {
        kept.extend(rest);
        return (kept, cut);
    }
    kept.extend(polygon::difference(&rest, &polygon::outset(&thin, ROUNDING), 2 * ROUNDING));
    (kept, true)
}

/// Sorts loops, with their holes, into those that are `good` and the rest; all stay in their order
/// if all are good. The library is slow: it gets only the rest. What shrinks stays apart from
/// other loops, so each is judged alone.
fn sorted_out(
    loops: Vec<Contour>,
    good: impl Fn(&[Contour]) -> bool,
) -> (Vec<Contour>, Vec<Contour>) {
    let outers = outers(&loops);
    let mut order: Vec<(usize, usize)> =
        (0..loops.len()).map(|k| (around(&loops, &outers, k), k)).collect();
    order.sort_unstable();
    let is_good = |group: &[(usize, usize)]| match group {
        [(_, only)] => good(std::slice::from_ref(&loops[*only])),
        _ => good(&group.iter().map(|(_, k)| loops[*k].clone()).collect::<Vec<_>>()),
    };
    let groups: Vec<&[(usize, usize)]> = order.chunk_by(|a, b| a.0 == b.0).collect();
    let (kept, rest): (Vec<&[_]>, Vec<&[_]>) = groups.into_iter().partition(|group| is_good(group));
    if rest.is_empty() {
        return (loops, Vec::new());
    }
    let loops_of = |groups: Vec<&[(usize, usize)]>| -> Vec<Contour> {
        groups.into_iter().flatten().map(|(_, k)| loops[*k].clone()).collect()
    };
    (loops_of(kept), loops_of(rest))
}

/// Those of `loops` that are no holes.
fn outers(loops: &[Contour]) -> Around<'_> {
    Around::new(loops.iter().enumerate().filter(|(_, path)| double_area(path) > 0))
}

/// The index of the smallest of the `outers` around the hole `k`; an outer loop's own.
fn around(loops: &[Contour], outers: &Around<'_>, k: usize) -> usize {
    let path = &loops[k];
    if double_area(path) > 0 {
        return k;
    }
    outers.of(path[0]).min_by_key(|&j| (double_area(&loops[j]), j)).unwrap_or(k)
}

/// Whether a short loop is all there is inside a contour of `outer`, and not a bulge of a strip. Around
/// a convex contour the way is longer by at most eight times the `distance`.
fn is_dot(path: &Contour, (outer, around): (&[Contour], &Around<'_>), distance: Coord) -> bool {
    let most = perimeter(path) + 10.0 * f64::from(distance);
    around.of(path[0]).any(|k| perimeter(&outer[k]) <= most)
}

fn perimeter(contour: &Contour) -> f64 {
    edges(contour).map(|(p, q)| p.distance(q)).sum()
}

impl WallParams {
    /// Minimum distance of the two passes of a loop of this depth. The outermost one takes over
    /// where a single bead would be too wide, inner ones where there is room for [`ONE_MORE`] line.
    fn least_apart(&self, depth: u32) -> Coord {
        let room = if depth == 0 { self.widest } else { ONE_MORE };
        nearest((room - 1.0) * f64::from(self.line_width)) as Coord + LIMIT
    }

    /// Inset at which the room inside all walls vanishes where one bead can fill it.
    fn inset_of_narrow(&self) -> Coord {
        self.inset_of(self.count + 1) + self.least_apart(self.count) / 2
    }
}
