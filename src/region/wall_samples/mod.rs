//! Wall and exposed rows -> Samples: how deep the exposed skin is behind each place of a wall.
//!
//! Words: a *wall sample* is a place on a wall's centre line, with the *depth* of the skin behind
//! it, measured from the wall's inner edge at right angles to it. A *strip* is the room between
//! two walls; its samples are *shared*, and one of the two walls *leads*: it lays a bead in the
//! middle. The *position* of a sample is its distance from the wall's first point along the
//! wall; the *perimeter* is the length of the wall. A *stretch* is a sequence of equal samples.
//!
//! Algorithm, for each closed wall:
//! 1. Sample each edge where rows cross the inner edge of the wall ([`measured`]). Of the two
//!    rasters take the one whose rows cross the edge at 45° or steeper. The exposed span behind
//!    the crossing, times the sine of the angle, is the depth. If little infill would remain
//!    before the skin of the opposite wall, the sample is shared and its depth is half the room.
//! 2. Choose the number of beads: as many as cover the depth, or 0 if it is too deep.
//! 3. Measure shared samples anew at right angles to the wall, confirm that the opposite wall really lies
//!    there, and decide which of the two leads: of two walls the first, within one wall by direction
//!    ([`WallSample::confirm`]).
//! 4. Bridge short gaps without beads, leave short stretches beside deep skin to lines, and smooth short changes
//!    of the number of beads.
//! 5. Add the wall's own corners, with the interpolated depth, so that beads follow them.
//!
//! The constants are in line widths unless they say otherwise. Most are as old as this file, and
//! the history records no measurements of them. So each says what it trades off.

mod corners;
mod measured;

use super::crossed::Crossed;
use super::near::{Area, Edge, Near};
use super::params::BeadParams;
use crate::geom::segment::way;
use crate::geom::{Contour, Point, edges};
use crate::units::Bounded as _;
use hashbrown::HashMap;
use std::f64::consts::FRAC_1_SQRT_2;

/// Maximum number of beads beside each other along one wall. More would replace zigzags that are
/// wide enough to be fast; fewer leave rings of skin to zigzags that are nearly all turns.
pub(super) const MOST_BEADS: usize = 3;

/// Minimum width of a bead, where there is room. Thinner skin gets a bead that reaches
/// beyond the skin. A smaller value makes beads too thin to flow evenly; a larger one
/// wastes plastic.
const NARROWEST: f64 = 0.75;

/// Shorter beads are dropped and left to lines; shorter gaps in a bead are closed. A smaller value
/// makes many short beads with a travel each. A larger one lays beads where there is no skin.
pub(super) const SHORT: f64 = 2.5;

/// Maximum depth for each bead, which is also its width. A larger value needs fewer beads but makes
/// them wider than what a nozzle lays evenly; a smaller one needs a second bead earlier.
const WIDEST: f64 = 1.5;

/// Maximum number of beads across a strip between two walls. Wider ones are left to lines. A smaller
/// value fills the walls of shells by zigzags that are nearly all turns; a larger one lays many beads
/// beside each other that all change their width where the strip does.
const MOST_ACROSS: usize = 5;

/// A narrower strip gets a single bead, of its full width. From this width on two beads of 0.8 fit.
/// A larger value makes single beads too wide; a smaller one makes pairs that are too thin.
const SINGLE: f64 = 1.6;

/// A narrower strip gets no more than two beads. A larger value makes them too wide; with a smaller one more
/// strips get a third, which within one wall does not turn with them.
const PAIR: f64 = 3.2;

/// Maximum depth for each bead on a short stretch where one bead more would be needed: stretching
/// the others avoids a short extra bead. It is as wide as lines may get in gap closing. At
/// [`WIDEST`] short extra beads would stay; a larger value makes bulges.
const STRETCHED: f64 = 1.75;

/// A strip gets a further bead when it is this much narrower than so many lines. At 0.5, walls of round sizes,
/// such as 3.4 mm with lines of 0.4, would change their number from facet to facet of a circle.
const UNEVEN: f64 = 0.42;

/// Depth beyond what the beads cover that may stay open: the walls of the layer that ends there
/// reach over it. At 0, a depth just above the limit gets one bead more, all of them thin; a
/// larger value leaves visible gaps.
const OPEN: f64 = 0.1;

/// If no more infill than this would remain between the skins of two walls, the whole room counts
/// as a strip. A smaller value lays tiny pieces of infill, each with turns and travels; a larger
/// one makes more strips solid.
const GAP: f64 = 2.0;

/// Where a shared sample looks for the opposite wall, as a fraction of the strip's width. It must
/// be past the middle, 0.5, so that the opposite wall is the nearer one. The larger it is, the
/// smaller the circle that is searched, and the fewer tapering strips are found.
const BEYOND: f64 = 0.6;

/// How much further away the opposite wall may be there, as a fraction of the strip's width. A
/// smaller value rejects tapering strips. A larger one accepts corners, where the wall at the
/// other end of the row is not opposite; above 0.2 the sample's own wall would pass.
const SLOPE: f64 = 0.1;

/// Maximum length of a stretch that is too deep and yet gets beads, because narrow skin is on both
/// sides. Near a corner a row runs inside the skin of the other wall, so the depth seems large.
/// At a square corner each side seems deep for half a line plus the depth that [`MOST_BEADS`]
/// cover: 2 · (0.5 + 4.6) = 10.2, and samples are a line apart. It was 8 first, which broke rings
/// of three beads at corners. A larger value lays beads over skin that is really deep.
const CORNER: f64 = 11.0;

/// Minimum length of a stretch beside skin that is too deep for beads, in depths. A smaller value leaves patches
/// of beads among lines; a larger one leaves strips to zigzags that are nearly all turns.
const STRIP: f64 = 12.0;

/// Where a strip ends or turns a corner, the wall seems deep for up to twice the strip's width, and for this
/// much more: the wall itself on both sides, and the way to the next samples. A larger value takes a room for
/// the end of a strip that narrows towards it; a smaller one breaks beads at square ends and corners.
const STRIP_TURN: f64 = 5.0;

/// Where a strip turns, it is hardly wider on one side than on the other: at most this many times. A larger
/// value takes the width of its pointed end for that of a room; a smaller one breaks beads at corners.
const ALIKE: f64 = 1.5;

/// Margin around the samples with beads within which wall edges are collected. It must reach from a
/// sample to the middle of a bridged gap, and from there to the far side of the beads and to walls
/// near them. If it is too small, beads may cross walls; a larger value sorts edges for nothing.
const MARGIN: f64 = 2.0 * (MOST_ACROSS as f64 + 0.5) + STRIP_TURN + 8.0;

/// Side of the cells into which edges are sorted. It is larger than the distance of most queries, so
/// that a query looks up few cells. It affects speed only: larger cells hold more edges to test.
const CELL: f64 = 4.0;

/// A place on a wall, and the skin behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WallSample {
    /// The place, on the centre line of the wall.
    pub at: [f64; 2],
    /// Points away from the wall, into the solid. Its length is 1, or that of the mitre at a corner.
    pub normal: [f64; 2],
    /// Depth of the skin, from the wall's inner edge.
    pub depth: f64,
    /// The depth is half the distance to another wall, which lays beads as well.
    pub shared: bool,
    /// Of these two walls, this one lays a bead in the middle.
    pub leads: bool,
    /// Number of beads, in a strip up to its middle; 0 where there is no skin or too much.
    pub beads: usize,
    /// Distance from the wall's first point along the wall.
    position: f64,
    /// Whether there is skin, even if beads cannot cover it.
    skin: bool,
}

/// The samples of closed walls in the order of their points, and the edges of the walls around
/// them. A wall without beads has no samples; `None` if no wall has beads.
pub(super) fn samples(
    walls: &[Contour],
    crossed: &Crossed<'_>,
    params: &BeadParams,
) -> Option<(Vec<Vec<WallSample>>, Near)> {
    let mut laps: Vec<Vec<WallSample>> =
        walls.iter().map(|w| measured::measured(w, crossed, params)).collect();
    if laps.iter().flatten().all(|s| !s.shared && s.beads == 0) {
        return None;
    }
    let with_beads = laps.iter().flatten().filter(|s| s.shared || s.beads > 0).map(|s| s.at);
    let w = f64::from(params.line_width);
    let near = Near::new(walls, Area::around(with_beads, MARGIN * w), CELL * w);
    let owners = Owners::new(walls);
    for (own, (lap, wall)) in laps.iter_mut().zip(walls).enumerate() {
        let leads = |sample: &WallSample, other: Edge| match owners.of(other) {
            Some(wall) if wall != own => own < wall,
            _ => leads(sample.normal, other, crossed.left_turn),
        };
        lap.iter_mut().filter(|s| s.shared).for_each(|s| s.confirm(&near, leads, params));
        *lap = finished(wall, std::mem::take(lap), params);
    }
    Some((laps, near))
}

/// Which wall each edge is of.
struct Owners(HashMap<[u64; 4], usize>);

impl Owners {
    fn new(walls: &[Contour]) -> Self {
        let real = |p: Point| [f64::from(p.x), f64::from(p.y)];
        let of = |(k, wall): (usize, &Contour)| -> Vec<_> {
            edges(wall).map(|(p, q)| (Self::key([real(p), real(q)]), k)).collect()
        };
        Self(walls.iter().enumerate().flat_map(of).collect())
    }

    fn of(&self, edge: Edge) -> Option<usize> {
        self.0.get(&Self::key(edge)).copied()
    }

    fn key([from, to]: Edge) -> [u64; 4] {
        [from[0], from[1], to[0], to[1]].map(f64::to_bits)
    }
}

/// Bridges and smooths the samples of a wall, and adds the wall's own corners.
fn finished(wall: &Contour, mut found: Vec<WallSample>, params: &BeadParams) -> Vec<WallSample> {
    if found.iter().all(|s| s.beads == 0) {
        return Vec::new();
    }
    let perimeter = edges(wall).map(|(p, q)| p.distance(q)).sum::<f64>();
    leave_corners(&mut found, perimeter, params);
    bridge(&mut found, perimeter, params);
    leave_patches(&mut found, perimeter);
    smooth(&mut found, perimeter, params);
    corners::with_corners(wall, &found, perimeter, params)
}

impl WallSample {
    /// How many beads this wall lays here, and how wide each is. Of an odd number across a strip, the one
    /// in the middle is laid by the wall that leads.
    pub(super) fn laid(&self, params: &BeadParams) -> (usize, f64) {
        let w = f64::from(params.line_width);
        if !self.shared || self.beads == 0 {
            return (self.beads, (self.depth / self.beads as f64).max(NARROWEST * w));
        }
        let across = 2.0 * self.depth;
        let most = 2 * self.beads;
        let is_odd = across < least_of(most) * w;
        let count = most - usize::from(is_odd);
        (count / 2 + usize::from(is_odd && self.leads), across / count as f64)
    }

    /// Whether the wall turns between this sample and another one by more than 45°.
    fn turns_to(&self, other: &Self) -> bool {
        let ([x, y], [u, v]) = (self.normal, other.normal);
        x * u + y * v < FRAC_1_SQRT_2
    }

    /// Measures a shared sample at right angles to the wall, checks that it really has another wall
    /// opposite, and decides which of the two leads. Past the middle of a strip the opposite wall is
    /// the nearer one. In a corner the wall at the other end of the row is not: then the sample loses
    /// its beads.
    fn confirm(&mut self, near: &Near, leads: impl Fn(&Self, Edge) -> bool, params: &BeadParams) {
        let faced = self.measure_across(near, params);
        let across = 2.0 * (self.depth + f64::from(params.line_width) / 2.0);
        let beyond = [0, 1].map(|k| self.at[k] + BEYOND * across * self.normal[k]);
        let nearest = near.nearest(beyond, (1.0 - BEYOND + SLOPE) * across);
        let opposite = match nearest {
            Some(other) if self.stands_across(other) => faced,
            other => other,
        };
        if let Some(other) = opposite.filter(|_| self.beads > 0) {
            self.leads = leads(self, other);
        } else {
            self.shared = false;
            self.beads = 0;
        }
    }

    /// Whether another wall runs away from this one, as around a corner.
    fn stands_across(&self, other: Edge) -> bool {
        facing(self.normal, other) < FRAC_1_SQRT_2 / 2.0
    }

    /// Measures the strip at right angles to the wall, and gives the wall on the other side if the two face
    /// each other. A row measures a bent strip too wide or too narrow by up to a line, and ends
    /// beside square corners at the wall around them.
    fn measure_across(&mut self, near: &Near, params: &BeadParams) -> Option<Edge> {
        let w = f64::from(params.line_width);
        let far = (1.0 + least_of(MOST_ACROSS + 1)) * w;
        let (distance, other) = near.hit(self.at, self.normal, far)?;
        let across = distance - w;
        let count =
            count_across(across / w).filter(|_| facing(self.normal, other) > FRAC_1_SQRT_2)?;
        (self.depth, self.beads) = (across / 2.0, count.div_ceil(2));
        Some(other)
    }
}

/// The cosine of the angle between a wall's normal and the outward one of another wall's edge: 1 if they
/// face each other.
pub(super) fn facing(normal: [f64; 2], [from, to]: Edge) -> f64 {
    let [x, y] = way(from, to);
    (normal[0] * y - normal[1] * x) / (x * x + y * y).sqrt().at_least(1.0)
}

/// Whether a wall with this normal leads that with edge `other`, of the same wall: of two walls the first
/// leads, so that the bead between them turns with it at corners. The sign of the difference of
/// the two normals decides. The opposite wall sees the same difference with the other sign, so
/// exactly one of the two leads, however they lean. It is the same one on layers whose lines run in the
/// other direction, so that their beads lie on each other.
fn leads(normal: [f64; 2], [from, to]: Edge, left_turn: bool) -> bool {
    let [x, y] = way(from, to);
    let length = (x * x + y * y).sqrt().at_least(1.0);
    let [x, y] = [normal[0] + y / length, normal[1] - x / length];
    let [x, y] = if left_turn { [x, y] } else { [-y, x] };
    x > 0.0 || (x == 0.0 && y > 0.0)
}

/// The least width of a strip that gets `count` beads, at least 2, in line widths.
fn least_of(count: usize) -> f64 {
    match count {
        2 => SINGLE,
        3 => PAIR,
        _ => count as f64 - UNEVEN,
    }
}

/// Number of beads across a strip of this width in line widths; `None` if it is too wide.
fn count_across(width: f64) -> Option<usize> {
    (1..=MOST_ACROSS).find(|&count| width < least_of(count + 1))
}

/// Number of beads that cover a depth; 0 if it is too deep.
fn beads(depth: f64, w: f64) -> usize {
    let count = (((depth - OPEN * w) / (WIDEST * w)).ceil() as usize).max(1);
    if count <= MOST_BEADS { count } else { 0 }
}

/// The stretches of samples with equal `key`, as index ranges. The last one may wrap around: its
/// indices then continue past the last sample.
fn stretches<K: PartialEq>(
    samples: &[WallSample],
    key: impl Fn(&WallSample) -> K,
) -> Vec<(usize, usize)> {
    let n = samples.len();
    let differs = |k: usize| key(&samples[k % n]) != key(&samples[(k + n - 1) % n]);
    let starts: Vec<usize> = (0..n).filter(|&k| differs(k)).collect();
    let ends = starts.iter().skip(1).copied().chain(starts.first().map(|k| k + n));
    starts.iter().copied().zip(ends).collect()
}

/// The length from the sample before a stretch to the one behind it.
fn span(samples: &[WallSample], (from, to): (usize, usize), perimeter: f64) -> f64 {
    let n = samples.len();
    let length = samples[to % n].position - samples[(from + n - 1) % n].position;
    if length > 0.0 { length } else { length + perimeter }
}

/// Takes the beads from short stretches of strips for more than two: at a corner a narrower strip seems up to
/// twice as wide.
fn leave_corners(samples: &mut [WallSample], perimeter: f64, params: &BeadParams) {
    let (n, w) = (samples.len(), f64::from(params.line_width));
    let is_wide = |s: &WallSample| s.shared && s.beads > 1;
    for (from, to) in stretches(samples, is_wide) {
        if is_wide(&samples[from % n]) && span(samples, (from, to), perimeter) < CORNER * w {
            (from..to).for_each(|k| samples[k % n].beads = 0);
        }
    }
}

/// Takes the beads from short stretches beside skin that is too deep for them. Lines run there anyway, and go on
/// over what is narrow for a short way, as behind the corner of a letter; beads would be a patch in them.
fn leave_patches(samples: &mut [WallSample], perimeter: f64) {
    let n = samples.len();
    let is_narrow = |s: &WallSample| s.beads > 0 && !s.shared;
    let is_deep = |s: &WallSample| s.beads == 0 && s.skin;
    for (from, to) in stretches(samples, is_narrow) {
        let ends = [samples[(from + n - 1) % n], samples[to % n]];
        if !is_narrow(&samples[from % n]) || !ends.iter().any(is_deep) {
            continue;
        }
        let depth = (from..to).map(|k| samples[k % n].depth).sum::<f64>() / (to - from) as f64;
        if span(samples, (from, to), perimeter) < STRIP * depth {
            (from..to).for_each(|k| samples[k % n].beads = 0);
        }
    }
}

/// Gives beads to short stretches without beads between two with beads.
fn bridge(samples: &mut [WallSample], perimeter: f64, params: &BeadParams) {
    let (n, w) = (samples.len(), f64::from(params.line_width));
    for (from, to) in stretches(samples, |s| s.beads > 0) {
        let (before, after) = (samples[(from + n - 1) % n], samples[to % n]);
        if samples[from % n].beads > 0 {
            continue;
        }
        let deep = (from..to).any(|k| samples[k % n].skin);
        let (model, other) =
            if before.depth <= after.depth { (before, after) } else { (after, before) };
        let turns = before.shared && after.shared && before.turns_to(&after);
        // A strip that narrows is no strip that turns.
        if (deep || turns) && model.shared && other.depth > ALIKE * model.depth {
            continue;
        }
        let turn = 4.0 * model.depth + STRIP_TURN * w;
        let most = match deep {
            _ if turns => turn,
            true if model.shared => turn.at_most(CORNER * w),
            true => CORNER * w,
            false => SHORT * w,
        };
        if span(samples, (from, to), perimeter) > most {
            continue;
        }
        // At the end of a strip the wall turns back: one side leads, the other does not.
        let leads = before.leads || after.leads;
        for k in from..to {
            let sample = &mut samples[k % n];
            let WallSample { depth, shared, beads, .. } = model;
            *sample = WallSample { depth, shared, leads, beads, ..*sample };
        }
    }
}

/// Smooths the number of beads: short stretches with more or fewer take that of their neighbours.
fn smooth(samples: &mut [WallSample], perimeter: f64, params: &BeadParams) {
    let (n, w) = (samples.len(), f64::from(params.line_width));
    for (from, to) in stretches(samples, |s| s.beads) {
        let (before, after) = (samples[(from + n - 1) % n].beads, samples[to % n].beads);
        let here = samples[from % n].beads;
        let (fewer, more) = (before.min(after), before.max(after));
        let other = match here {
            0 => continue,
            _ if here < fewer => fewer,
            _ if here > more => more,
            _ => continue,
        };
        if other == 0 || span(samples, (from, to), perimeter) > SHORT * w {
            continue;
        }
        let fits = |s: &WallSample| s.depth <= other as f64 * STRETCHED * w;
        if (from..to).all(|k| fits(&samples[k % n])) {
            (from..to).for_each(|k| samples[k % n].beads = other);
        }
    }
}
