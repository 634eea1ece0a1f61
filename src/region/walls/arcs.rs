//! Samples -> arcs: runs of neighbouring places of middle beads, joined where their ends meet.
//!
//! Words: a *sample* is a place of a middle bead, beside the place of the contour that found it. An *arc* is a
//! run of neighbouring samples. A *strip* is the room of a bead and the loops beside it; it *turns*
//! at a corner of the contour around which both its sides go on alike.
//!
//! Algorithm: runs of samples become arcs. Arcs whose ends are neighbours are joined, the nearest first;
//! then those between whose ends a strip turns; then arcs whose own ends meet become rings. Where a
//! bead turns, it does so where its two sides meet: the middle of the room would cut the corner, and
//! leave a hole on the outside.

use super::Layout;
use super::bridged::TURNED;
use super::patches::Doubt;
use crate::geom::Point;
use crate::geom::nearest::Nearest;
use crate::geom::segment::{along, dot, way};
use crate::region::taper::{Place, distance};
use crate::units::{Bounded as _, Coord, nearest as nearest_unit};

/// Two samples are neighbours if their middles are at most this far apart, in line widths. A
/// smaller value breaks beads on the outside of bends, a larger one bridges gaps.
pub(super) const NEIGHBOURS: f64 = 1.5;

/// How far the sides of a bead may lie from the corner where they meet, in rooms of its strip: samples of a
/// right angle lie half a room and a step from it. A larger value draws a bead out into what is no strip.
const TURNING: f64 = 1.2;

/// Cosine of the sharpest turn that a bead takes on its mitre: 104°. In a sharper corner it would lie on itself.
const SHARPEST: f64 = -0.25;

/// How near to the contour the corner of a strip lies, in line widths: its sides are not quite parallel.
const AT_CORNER: f64 = 0.1;

/// Corners nearer to a sample are rounding errors: the sample is the corner (10 µm).
const LEAST_CORNER: f64 = 100.0;

/// How many samples behind a join a ring begins: its corner needs two samples on either side.
const SEAM: usize = 3;

/// A place of a middle bead.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) place: Place,
    /// How many loops lie on either side.
    pub(super) loops: u32,
    /// Whether this side lays the bead.
    pub(super) leads: bool,
    /// Whether it or what is opposite is a corner that sticks into the part: there the strip turns.
    pub(super) turns: bool,
    /// The place of the contour.
    pub(super) from: Doubt,
}

impl Sample {
    /// The room that its bead and the loops beside it share.
    pub(super) fn room(&self) -> f64 {
        self.place.width * f64::from(2 * self.loops + 1)
    }

    /// Where a bead between loops that runs beside the contour here turns to run beside it at another sample,
    /// around one corner of a strip alike on both sides.
    pub(super) fn turning_to(&self, other: &Self, layout: &Layout<'_>) -> Option<[f64; 2]> {
        let between = way(self.place.at, other.place.at);
        let (before, after) = (self.ahead(between), other.ahead(between));
        let alike = self.loops > 0 && self.loops == other.loops;
        if !alike || !(SHARPEST..TURNED).contains(&dot(before, after)) {
            return None;
        }
        let most = TURNING * self.room().at_least(other.room());
        let met = |from: [f64; 2], to: [f64; 2], most: f64| meet(from, before, to, after, most);
        // A round bend has no corner where its sides would meet. Where walls cross, one side goes straight on.
        let w = layout.line_width;
        let is_free = |at: [f64; 2], far: f64| layout.outline.is_free(at, far);
        let ends_both = |corner: [f64; 2]| {
            let [on, back] = [along(corner, w, before), along(corner, -w, after)];
            !is_free(corner, AT_CORNER * w) && is_free(on, w / 2.0) && is_free(back, w / 2.0)
        };
        let own = met(self.from.at, other.from.at, 2.0 * most)?;
        let opposite = met(self.opposite(), other.opposite(), 2.0 * most)?;
        met(self.place.at, other.place.at, most).filter(|_| ends_both(own) && ends_both(opposite))
    }

    /// The place of the contour on the other side of the strip.
    fn opposite(&self) -> [f64; 2] {
        along(self.from.at, 2.0 * self.from.deep, self.from.normal)
    }

    /// The way along the contour that leads on as `way` does, of length 1.
    pub(super) fn ahead(&self, way: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.from.normal;
        if dot([-y, x], way) < 0.0 { [y, -x] } else { [-y, x] }
    }
}

/// A run of neighbouring samples.
pub(super) type Arc = Vec<Sample>;

/// Whether an arc ends where it begins.
pub(super) fn is_ring(arc: &Arc) -> bool {
    let ends = arc.first().zip(arc.last());
    arc.len() > 3 && ends.is_some_and(|(a, b)| a.place.at == b.place.at)
}

/// The runs of neighbouring samples that are `wanted`. A run all around ends where it begins.
pub(super) fn arcs(lap: &[Option<Sample>], w: f64, wanted: impl Fn(&Sample) -> bool) -> Vec<Arc> {
    let wanted = |s: &Option<Sample>| s.filter(|s| wanted(s));
    let n = lap.len();
    let start = lap.iter().position(|s| wanted(s).is_none());
    let around = lap.iter().cycle().skip(start.unwrap_or(0)).take(n + usize::from(start.is_none()));
    let mut out: Vec<Arc> = Vec::new();
    let mut open = false;
    for sample in around {
        let Some(sample) = wanted(sample) else {
            open = false;
            continue;
        };
        let far =
            |arc: &Arc| arc.last().map_or(f64::MAX, |s| distance(s.place.at, sample.place.at));
        match out.last_mut().filter(|arc| open && far(arc) <= NEIGHBOURS * w) {
            Some(arc) => arc.push(sample),
            None => out.push(vec![sample]),
        }
        open = true;
    }
    out
}

/// Joins arcs whose ends are neighbours, then those between which their strip turns; rings close.
pub(super) fn join_ends(arcs: &mut Vec<Arc>, layout: &Layout<'_>) {
    join(arcs, NEIGHBOURS * layout.line_width, |_, _| true);
    let widest = arcs.iter().flatten().map(Sample::room).fold(0.0, f64::max);
    join(arcs, 2.0 * TURNING * widest, |a, b| a.turning_to(b, layout).is_some());
    arcs.iter_mut().for_each(|arc| close(arc, layout));
}

/// Joins arcs whose ends are at most this far apart and fit, the nearest first for each arc in turn.
fn join(arcs: &mut Vec<Arc>, most: f64, fit: impl Fn(&Sample, &Sample) -> bool) {
    let mut ends = Nearest::new(arcs.iter().flat_map(ends_of).map(rounded).collect());
    let mut gone = vec![false; arcs.len()];
    for k in 0..arcs.len() {
        if gone[k] {
            continue;
        }
        ends.take(2 * k);
        ends.take(2 * k + 1);
        // Of those before it none is near; those after it are as they were.
        while let Some((other, turn)) = nearest(arcs, k, (&ends, most), &fit) {
            let mut more = std::mem::take(&mut arcs[other]);
            gone[other] = true;
            ends.take(2 * other);
            ends.take(2 * other + 1);
            if turn.1 {
                more.reverse();
            }
            let arc = &mut arcs[k];
            if turn.0 {
                arc.reverse();
            }
            arc.append(&mut more);
        }
    }
    arcs.retain(|arc| !arc.is_empty());
}

/// Makes a ring of an arc whose ends are neighbours.
fn close(arc: &mut Arc, layout: &Layout<'_>) {
    let w = layout.line_width;
    let ends = arc.first().zip(arc.last());
    let gap = ends.map_or(f64::MAX, |(a, b)| distance(a.place.at, b.place.at));
    let sure = sure_end(arc, false).zip(sure_end(arc, true));
    let turns = sure.is_some_and(|(a, b)| b.turning_to(a, layout).is_some());
    let near = gap <= NEIGHBOURS * w || turns;
    if gap > 0.0 && near && length(arc) > 3.0 * NEIGHBOURS * w {
        // A corner may lie between its ends: it begins a little further on.
        let seam = (SEAM..arc.len()).find(|&k| !arc[k].turns).unwrap_or(SEAM.min(arc.len()));
        arc.rotate_left(seam);
        arc.extend(arc.first().copied());
    }
}

/// The first sample of an arc between two sides, or the last one: beside a corner what is opposite is the corner.
fn sure_end(arc: &Arc, last: bool) -> Option<&Sample> {
    let is_sure = |sample: &&Sample| !sample.turns;
    let sure = if last { arc.iter().rev().find(is_sure) } else { arc.iter().find(is_sure) };
    sure.or_else(|| end_of(arc, last))
}

/// The first sample of an arc, or the last one.
fn end_of(arc: &Arc, last: bool) -> Option<&Sample> {
    if last { arc.last() } else { arc.first() }
}

/// The ends of an arc, which has places.
fn ends_of(arc: &Arc) -> [[f64; 2]; 2] {
    let at = |sample: Option<&Sample>| sample.map_or([0.0; 2], |sample| sample.place.at);
    [at(arc.first()), at(arc.last())]
}

/// The point of the grid at a place.
fn rounded([x, y]: [f64; 2]) -> Point {
    Point { x: nearest_unit(x) as Coord, y: nearest_unit(y) as Coord }
}

/// The arc after `k` with the end nearest to an end of arc `k`, and which of the two to reverse so
/// that the second continues the first. `ends` are those of the arcs after `k`, two of each.
fn nearest(
    arcs: &[Arc],
    k: usize,
    (ends, most): (&Nearest, f64),
    fit: impl Fn(&Sample, &Sample) -> bool,
) -> Option<(usize, (bool, bool))> {
    let here = ends_of(&arcs[k]);
    // A grid unit more for rounding, on both sides.
    let reach = most.ceil() as Coord + 2;
    let by = |p: Point, by: Coord| Point { x: p.x + by, y: p.y + by };
    let near = |at: [f64; 2]| ends.within((by(rounded(at), -reach), by(rounded(at), reach)));
    let mut others: Vec<usize> = here.into_iter().flat_map(near).map(|end| end / 2).collect();
    others.sort_unstable();
    others.dedup();
    let mut best: Option<(f64, usize, (bool, bool))> = None;
    for j in others {
        let there = ends_of(&arcs[j]);
        for turn in [(false, false), (false, true), (true, false), (true, true)] {
            let gap = distance(here[usize::from(!turn.0)], there[usize::from(turn.1)]);
            if gap <= best.map_or(most, |(least, ..)| least)
                && best.is_none_or(|b| gap < b.0)
                && sure_end(&arcs[k], !turn.0)
                    .zip(sure_end(&arcs[j], turn.1))
                    .is_some_and(|(a, b)| fit(a, b))
            {
                best = Some((gap, j, turn));
            }
        }
    }
    best.map(|(_, j, turn)| (j, turn))
}

/// Where the way from `a` on along `before` meets the way that leads to `b` along `after`, both at
/// most `most` long.
pub(super) fn meet(
    a: [f64; 2],
    before: [f64; 2],
    b: [f64; 2],
    after: [f64; 2],
    most: f64,
) -> Option<[f64; 2]> {
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let between = way(a, b);
    let turn = cross(before, after);
    if turn.abs() < 0.2 * (dot(before, before) * dot(after, after)).sqrt() {
        return None;
    }
    let (ahead, back) = (cross(between, after) / turn, cross(between, before) / turn);
    let corner = along(a, ahead, before);
    let (from, to) = (distance(a, corner), distance(b, corner));
    // On a straight way the two meet where one of them begins.
    let between = ahead > 0.0 && back < 0.0 && from.at_most(to) > LEAST_CORNER;
    (between && from.at_least(to) <= most).then_some(corner)
}

pub(super) fn length(arc: &Arc) -> f64 {
    arc.windows(2).map(|s| distance(s[0].place.at, s[1].place.at)).sum()
}
