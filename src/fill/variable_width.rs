//! Line with open strips beside it -> points: the line moved and widened to fill them.

use crate::geom::decimate::{decimate, most_missed};
use crate::geom::polyline::LinePoint;
use crate::geom::spans::Span;
use crate::profile::Settings;
use crate::units::{Coord, nearest, to_units};

/// A line gets at most this many line widths wide (what a nozzle's flat still irons).
pub(super) const WIDEST: f64 = 1.75;

/// How much further the ends of lines reach that are not joined to another, in line
/// widths and at most the overlap: two round ends leave a corner open between them
/// that a join would cover.
const TIP: f64 = 0.25;

/// A join between two lines covers the strips this many line widths from their ends.
pub(super) const SHORT_STRIP: Coord = 3;

/// Changes of width or place below this are not worth a corner in a line (20 µm).
const LEAST_BEND: f64 = 200.0;

/// The numbers for solid lines, in grid units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineParams {
    /// Width of a line and distance between lines.
    pub line_width: Coord,
    /// How far lines reach into the innermost wall.
    pub overlap: Coord,
    /// There is a wall around the lines.
    pub walled: bool,
}

impl LineParams {
    /// The numbers that `settings` mean.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let walled = settings.walls > 0;
        let overlap = if walled { settings.infill_overlap * settings.line_width } else { 0.0 };
        let line_width = to_units(settings.line_width);
        Self { line_width, overlap: to_units(overlap), walled }
    }
}

/// What is printed of one span of a row, with the open strips above (towards the
/// next row) and below it, each in the order of u.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Index of the row.
    pub row: i32,
    /// The span.
    pub span: Span,
    /// Open strips towards the next row.
    pub above: Vec<Strip>,
    /// Open strips towards the row before.
    pub below: Vec<Strip>,
}

/// How wide an open strip beside a line is at one place, grid units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strip {
    /// The place.
    pub u: Coord,
    /// The width.
    pub open: f64,
}

/// Whether a line's ends are joined to the row before or to the next: the join
/// covers the short strip there.
#[derive(Debug, Clone, Copy, Default)]
pub struct Joined {
    above: Ends,
    below: Ends,
}

#[derive(Debug, Clone, Copy, Default)]
struct Ends {
    left: bool,
    right: bool,
}

impl Joined {
    /// Joined to a line of the row before, at the left end or at the right.
    pub fn below(&mut self, left: bool) {
        self.below = Ends { left, right: !left };
    }

    /// Joined to a line of the next row, at the left end or at the right.
    pub fn above(&mut self, left: bool) {
        self.above = Ends { left, right: !left };
    }
}

/// The points of `line` from left to right, moved and widened to fill the strips
/// beside it; widths are those at the points.
#[must_use]
pub fn points(line: &Line, joined: Joined, params: &LineParams) -> Vec<LinePoint> {
    let w = params.line_width;
    let point = |sample| filled(line.row, sample, w);
    let mut points = if line.above.is_empty() && line.below.is_empty() {
        // Most lines lie between two others.
        let ends = [line.span.start, line.span.end];
        ends.map(|u| point(Sample { u, above: 0.0, below: 0.0 })).to_vec()
    } else {
        let above = profile(&line.above, line.span, joined.above, w);
        let below = profile(&line.below, line.span, joined.below, w);
        bends(&samples(&above, &below)).iter().copied().map(point).collect()
    };
    let tip = ((f64::from(w) * TIP) as Coord).min(params.overlap);
    if let [first, .., last] = points.as_mut_slice() {
        first.u -= if joined.above.left || joined.below.left { 0 } else { tip };
        last.u += if joined.above.right || joined.below.right { 0 } else { tip };
    }
    points
}

/// The open width along a whole span: what no join covers of `known`, nothing where
/// none is known, and at the span's ends what the last two places lead one to expect.
fn profile(known: &[Strip], span: Span, joined: Ends, pitch: Coord) -> Vec<Strip> {
    let from = span.start + if joined.left { SHORT_STRIP * pitch } else { 0 };
    let to = span.end - if joined.right { SHORT_STRIP * pitch } else { 0 };
    let first = known.partition_point(|s| s.u < from);
    let known = known.get(first..known.partition_point(|s| s.u <= to)).unwrap_or_default();
    let none = |u| Strip { u, open: 0.0 };
    let ([first, ..], [.., last]) = (known, known) else {
        return vec![none(span.start), none(span.end)];
    };
    let (first, last) = (*first, *last);
    let mut out = Vec::with_capacity(known.len() + 4);
    if first.u - pitch > span.start {
        out.extend([none(span.start), none(first.u - pitch)]);
    } else if first.u > span.start {
        out.push(beyond(known.get(1), first, span.start, pitch));
    }
    for (k, &strip) in known.iter().enumerate() {
        if k > 0 && strip.u - known[k - 1].u > 2 * pitch {
            out.extend([none(known[k - 1].u + pitch), none(strip.u - pitch)]);
        }
        out.push(strip);
    }
    if last.u + pitch < span.end {
        out.extend([none(last.u + pitch), none(span.end)]);
    } else if last.u < span.end {
        let before = known.len().checked_sub(2).map(|k| &known[k]);
        out.push(beyond(before, last, span.end, pitch));
    }
    out
}

/// The strip at `u`, just beyond `last`: going on as from `before` to `last`, but
/// never wider than `last`, since a span ends where the strip does or at a corner.
fn beyond(before: Option<&Strip>, last: Strip, u: Coord, pitch: Coord) -> Strip {
    let near = before.filter(|b| (b.u - last.u).abs() <= pitch);
    let far = f64::from((u - last.u).abs()) / f64::from(pitch);
    let before = near.map_or(0.0, |b| b.open);
    Strip { u, open: (last.open + (last.open - before) * far).clamp(0.0, last.open) }
}

/// The open widths on both sides of a line at one place.
#[derive(Debug, Clone, Copy)]
struct Sample {
    u: Coord,
    above: f64,
    below: f64,
}

/// Both sides at every place where one of them is given. Both begin and end at the
/// span's ends.
fn samples(above: &[Strip], below: &[Strip]) -> Vec<Sample> {
    let mut places: Vec<Coord> = above.iter().chain(below).map(|s| s.u).collect();
    places.sort_unstable();
    places.dedup();
    places.into_iter().map(|u| Sample { u, above: at(above, u), below: at(below, u) }).collect()
}

/// The value of a profile at `u`, which is not beyond its ends.
fn at(profile: &[Strip], u: Coord) -> f64 {
    let next = profile.partition_point(|s| s.u < u);
    match (next.checked_sub(1).map(|k| profile[k]), profile.get(next)) {
        (Some(a), Some(b)) => {
            let t = f64::from(u - a.u) / f64::from(b.u - a.u);
            a.open + t * (b.open - a.open)
        }
        (None, Some(b)) => b.open,
        (Some(a), None) => a.open,
        (None, None) => 0.0,
    }
}

/// The middle of a line and its width where it fills the strips beside it.
fn filled(row: i32, sample: Sample, line_width: Coord) -> LinePoint {
    let w = f64::from(line_width);
    let Sample { u, above, below } = sample;
    let spare = (WIDEST - 1.0) * w;
    let share = if above + below > spare { spare / (above + below) } else { 1.0 };
    LinePoint {
        u,
        v: nearest(f64::from(row) * w + share * (above - below) / 2.0) as Coord,
        width: nearest(w + share * (above + below)) as Coord,
    }
}

/// The samples without those between which everything changes evenly.
fn bends(samples: &[Sample]) -> Vec<Sample> {
    let kept = decimate(samples.len(), |a, b| {
        let (first, last) = (samples[a], samples[b]);
        let run = f64::from(last.u - first.u).max(1.0);
        most_missed(a, b, LEAST_BEND, |k| {
            let t = f64::from(samples[k].u - first.u) / run;
            let above = first.above + t * (last.above - first.above) - samples[k].above;
            let below = first.below + t * (last.below - first.below) - samples[k].below;
            above.abs().max(below.abs())
        })
    });
    kept.into_iter().map(|k| samples[k]).collect()
}
