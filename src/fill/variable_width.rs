//! Line with open strips beside it -> points: the line moved and widened to fill them.
//!
//! Words: a *strip* is the open room beside a line, given by its width at some places.
//! *Above* is towards the next row, *below* towards the previous one. A *profile* is the open
//! width along the whole span of a line. A *join* links a line to the end of one in a
//! neighbouring row; it covers the strip there itself.
//!
//! Algorithm, for each line:
//! 1. On either side, drop the strips near joined ends, and complete the rest to a profile:
//!    zero where nothing is open, extrapolated to the ends of the span.
//! 2. Sample both profiles at all places where one of them changes.
//! 3. Decimate the samples: keep only those where the width bends.
//! 4. At each sample, widen the line by both open widths and move its middle by half their
//!    difference. Beyond `WIDEST`, share what the line can take between both sides.
//! 5. Lengthen ends that are not joined by the tip.
//!
//! Most lines have no strips: they keep their width and their two ends.

use crate::geom::decimate::{decimate, most_missed};
use crate::geom::polyline::LinePoint;
use crate::geom::spans::Span;
use crate::profile::Settings;
use crate::units::{Coord, nearest, to_units};

/// Maximum width of a line, in line widths: the flat of a nozzle still smooths a bead this wide.
/// A strip is up to one line width wide less the overlap. A smaller value leaves the widest
/// strips partly open; a larger one makes beads that bulge beside the nozzle.
pub(super) const WIDEST: f64 = 1.75;

/// How much an end that is not joined is lengthened, in line widths, at most the overlap. Two
/// round ends leave a notch between them at the wall, which a join would cover. A larger value
/// presses more plastic into the wall; zero leaves the notch open.
const TIP: f64 = 0.25;

/// A join covers the strips within this many line widths of the ends it links. With a smaller
/// value the line is widened where the join already lies: too much plastic at each turn. With a
/// larger one long strips at slanted walls stay open.
pub(super) const SHORT_STRIP: Coord = 3;

/// Smaller changes of width or position give no corner in a line (20 µm): about half the
/// positioning error of a printer. A smaller value makes more, shorter moves.
const LEAST_BEND: f64 = 200.0;

/// The numbers for solid lines, in grid units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineParams {
    /// Width of a line and distance between lines.
    pub line_width: Coord,
    /// How far lines reach into the innermost wall.
    pub overlap: Coord,
    /// Whether a wall surrounds the lines.
    pub walled: bool,
}

impl LineParams {
    /// Derives the numbers from `settings`.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let walled = settings.walls > 0;
        let overlap = if walled { settings.infill_overlap * settings.line_width } else { 0.0 };
        let line_width = to_units(settings.line_width);
        Self { line_width, overlap: to_units(overlap), walled }
    }
}

impl LineParams {
    /// How much an end that is not joined is lengthened.
    fn tip(&self) -> Coord {
        ((f64::from(self.line_width) * TIP) as Coord).min(self.overlap)
    }
}

/// What is printed of one span of a row, with the open strips above (towards the next row) and
/// below it, each sorted by u.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Index of the row.
    pub row: i32,
    /// The span.
    pub span: Span,
    /// Open strips towards the next row.
    pub above: Vec<Strip>,
    /// Open strips towards the previous row.
    pub below: Vec<Strip>,
    /// The area of the strips, less that by which it lies deeper in walls beside it than lines shall.
    pub beside: f64,
    /// Whether its left and its right end are at a wall.
    pub at_wall: [bool; 2],
}

/// How wide an open strip beside a line is at one place, grid units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strip {
    /// The place.
    pub u: Coord,
    /// The width.
    pub open: f64,
}

/// Which ends of a line are joined to the previous or the next row. A join covers the short
/// strip at its end.
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
    /// Marks the left or the right end as joined to the previous row.
    pub fn below(&mut self, left: bool) {
        self.below = Ends { left, right: !left };
    }

    /// Marks the left or the right end as joined to the next row.
    pub fn above(&mut self, left: bool) {
        self.above = Ends { left, right: !left };
    }
}

/// The points of `line` from left to right, moved and widened to fill the strips beside it.
/// Widths are those at the points.
#[must_use]
pub fn points(line: &Line, joined: Joined, params: &LineParams) -> Vec<LinePoint> {
    let w = params.line_width;
    let point = |sample| filled(line.row, sample, w);
    let mut points = if line.above.is_empty() && line.below.is_empty() {
        // Most lines lie between two others and have no strips: no profile needed.
        let ends = [line.span.start, line.span.end];
        ends.map(|u| point(Sample { u, above: 0.0, below: 0.0 })).to_vec()
    } else {
        let above = profile(&line.above, line.span, joined.above, w);
        let below = profile(&line.below, line.span, joined.below, w);
        bends(&samples(&above, &below)).iter().copied().map(point).collect()
    };
    let tip = params.tip();
    if let [first, .., last] = points.as_mut_slice() {
        first.u -= if joined.above.left || joined.below.left { 0 } else { tip };
        last.u += if joined.above.right || joined.below.right { 0 } else { tip };
        if !params.walled {
            // The round end of a wider bead reaches further: here it would reach out of the part.
            first.u += (first.width - w) / 2;
            last.u -= (last.width - w) / 2;
        }
    }
    points
}

/// The open width along a whole span. Strips that a join covers are dropped. Between strips more
/// than two pitches apart the width falls to zero; at the ends of the span it is extrapolated.
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
        out.push(extrapolate(known.get(1), first, span.start, pitch));
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
        out.push(extrapolate(before, last, span.end, pitch));
    }
    out
}

/// Extrapolates the strip to `u`, just beyond `last`, with the slope from `before` to `last`.
/// The result is never wider than `last`: a span ends at a corner or where its strip ends.
fn extrapolate(before: Option<&Strip>, last: Strip, u: Coord, pitch: Coord) -> Strip {
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

/// The open widths on both sides at every place of either profile. Both profiles cover the whole
/// span.
fn samples(above: &[Strip], below: &[Strip]) -> Vec<Sample> {
    let mut places: Vec<Coord> = above.iter().chain(below).map(|s| s.u).collect();
    places.sort_unstable();
    places.dedup();
    places.into_iter().map(|u| Sample { u, above: at(above, u), below: at(below, u) }).collect()
}

/// Interpolates a profile at `u`, which lies within its ends.
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

/// The middle of a line, and its width, where it fills the strips beside it.
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

/// The samples at which a width bends. Those that interpolation gives anyway are dropped.
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
