//! Skin rows of two crossing rasters -> Lines: skin closed up to the walls, slivers included.
//!
//! Words: a *line* is what is printed of a row's span; a *column* is a line of
//! the raster across. Lines lie on a fixed grid, so where an edge of the skin
//! runs nearly along them, a strip up to one line width wide stays open between
//! the edge and the last line, and a skin narrower than a line may fall between
//! two. The columns tell how wide the strip is, exactly: they hold the skin's
//! extent across the lines, and they were made for the neighbours anyway. The
//! last line is moved and widened to fill the strip; a skin without a line gets
//! a bead along its middle. Only edges at a wall are closed: an edge at the
//! infill has more skin around it than it needs.

use super::Params;
use crate::geom::spans::{Rows, Span};
use crate::units::Coord;

/// A line gets at most this many line widths wide (what a nozzle's flat still irons).
const WIDEST: f64 = 1.75;

/// Strips narrower than this stay open (20 µm): half of what positioning can tell.
const LEAST_STRIP: Coord = 200;

/// How much further the ends of lines reach that are not joined to another, in line
/// widths: two round ends leave a corner open between them that a join would cover.
const TIP: f64 = 0.25;

/// A join between two lines covers the strips this many line widths from their ends.
const SHORT_STRIP: Coord = 3;

/// Beads along thin strips that fewer columns in a row tell of are left out.
const LEAST_COLUMNS: usize = 2;

/// Changes of width or place below this are not worth a corner in a line (20 µm).
const LEAST_BEND: f64 = 200.0;

/// A point of a bead's middle, in the frame of its raster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LinePoint {
    /// Along the raster lines.
    pub u: Coord,
    /// Across them.
    pub v: Coord,
    /// Width of the bead on the way to here from the point before.
    pub width: Coord,
}

/// What is printed of one span of a row.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Index of the row.
    pub row: i32,
    /// The span.
    pub span: Span,
    /// Open strips beside it, in the order of u.
    pub strips: Vec<Strip>,
}

/// How wide the strips above and below a line are at one column, grid units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strip {
    /// The column.
    pub u: Coord,
    /// Towards the next row.
    pub above: f64,
    /// Towards the row before.
    pub below: f64,
}

/// The ends of a line that are joined to another line: the join covers the short
/// strip there. Each as (at the left end, at the right end).
#[derive(Debug, Clone, Copy, Default)]
pub struct Joined {
    above: (bool, bool),
    below: (bool, bool),
}

impl Joined {
    fn left(self) -> bool {
        self.above.0 || self.below.0
    }

    fn right(self) -> bool {
        self.above.1 || self.below.1
    }

    /// Joined to a line of the row before, at the left end or at the right.
    pub fn below(&mut self, left: bool) {
        self.below = (left, !left);
    }

    /// Joined to a line of the next row, at the left end or at the right.
    pub fn above(&mut self, left: bool) {
        self.above = (left, !left);
    }
}

/// A layer's skin on its own raster and on the one across.
#[derive(Debug, Clone, Copy)]
pub struct Crossed<'a> {
    /// The skin on the raster that is printed.
    pub skin: &'a Rows,
    /// The skin on the raster across.
    pub columns: &'a Rows,
    /// Where skin and infill may go, on the raster across.
    pub fill_columns: &'a Rows,
    /// The raster across is turned by +90° (else by −90°).
    pub left_turn: bool,
}

/// The lines of a skin, and the beads along strips too thin for a line.
#[must_use]
pub fn close(crossed: &Crossed<'_>, params: &Params) -> (Vec<Line>, Vec<Vec<LinePoint>>) {
    let mut strips = Strips::new(crossed.skin.range());
    let mut thin = Vec::new();
    // Columns in the order of u, which falls with v where the raster across is turned left.
    let columns = crossed.columns.range();
    let ordered: Box<dyn Iterator<Item = i32>> =
        if crossed.left_turn { Box::new(columns.rev()) } else { Box::new(columns) };
    for c in ordered {
        let at = c * params.line_width;
        let u = if crossed.left_turn { -at } else { at };
        for &span in crossed.columns.row(c) {
            let walls = crossed.fill_columns.row(c);
            let (low, high) =
                if crossed.left_turn { (span.start, span.end) } else { (-span.end, -span.start) };
            let (at_start, at_end) = (
                walls.iter().any(|w| w.start == span.start),
                walls.iter().any(|w| w.end == span.end),
            );
            let (wall_low, wall_high) =
                if crossed.left_turn { (at_start, at_end) } else { (at_end, at_start) };
            let extent = Extent { u, low, high, wall_low, wall_high };
            if !strips.add(&extent, params) && (wall_low || wall_high) {
                thin.push(extent);
            }
        }
    }
    let lines = crossed
        .skin
        .iter()
        .flat_map(|(row, spans)| spans.iter().map(move |&span| (row, span)))
        .map(|(row, span)| Line { row, span, strips: strips.beside(row, span) })
        .collect();
    (lines, slivers(thin, params))
}

/// The skin's extent across the lines at one column, and which of its ends are at a wall.
#[derive(Debug, Clone, Copy)]
struct Extent {
    u: Coord,
    low: Coord,
    high: Coord,
    wall_low: bool,
    wall_high: bool,
}

/// The strips beside the lines of each row, in the order of u.
struct Strips {
    first: i32,
    rows: Vec<Vec<Strip>>,
}

impl Strips {
    fn new(range: std::ops::Range<i32>) -> Self {
        Self { first: range.start, rows: vec![Vec::new(); range.len()] }
    }

    /// The strips beside `span` of `row`.
    fn beside(&self, row: i32, span: Span) -> Vec<Strip> {
        let row = usize::try_from(row - self.first).ok().and_then(|k| self.rows.get(k));
        let strips = row.map_or(&[] as &[Strip], |s| s);
        let from = strips.partition_point(|s| s.u <= span.start);
        let to = strips.partition_point(|s| s.u < span.end);
        strips.get(from..to).unwrap_or_default().to_vec()
    }

    /// Notes the strips above the highest and below the lowest line within `extent`;
    /// says no if there is no line in it.
    fn add(&mut self, extent: &Extent, params: &Params) -> bool {
        let pitch = params.line_width;
        let highest = extent.high.div_euclid(pitch);
        let lowest = -(-extent.low).div_euclid(pitch);
        if lowest > highest {
            return false;
        }
        // Lines reach `overlap` beyond the extent's ends already.
        let above = extent.high - highest * pitch - params.overlap;
        let below = lowest * pitch - extent.low - params.overlap;
        if extent.wall_high && above > LEAST_STRIP {
            self.note(highest, extent.u, f64::from(above), 0.0);
        }
        if extent.wall_low && below > LEAST_STRIP {
            self.note(lowest, extent.u, 0.0, f64::from(below));
        }
        true
    }

    fn note(&mut self, row: i32, u: Coord, above: f64, below: f64) {
        let Some(strips) =
            usize::try_from(row - self.first).ok().and_then(|k| self.rows.get_mut(k))
        else {
            return;
        };
        match strips.last_mut() {
            Some(last) if last.u == u => {
                last.above = last.above.max(above);
                last.below = last.below.max(below);
            }
            _ => strips.push(Strip { u, above, below }),
        }
    }
}

/// The points of `line` from left to right, moved and widened to fill the strips
/// beside it; widths are those at the points.
#[must_use]
pub fn points(line: &Line, joined: Joined, params: &Params) -> Vec<LinePoint> {
    let Line { row, span, .. } = *line;
    let strips = open_strips(line, joined, params.line_width);
    let samples = samples(&strips, span, params.line_width);
    let mut kept = vec![0];
    keep_bends(&samples, 0, samples.len() - 1, &mut kept);
    kept.push(samples.len() - 1);
    let mut points: Vec<LinePoint> =
        kept.into_iter().map(|k| filled(row, samples[k], params.line_width)).collect();
    let Some(last) = points.len().checked_sub(1) else { return points };
    let tip = (params.line_width as f64 * TIP) as Coord;
    points[0].u -= if joined.left() { 0 } else { tip };
    points[last].u += if joined.right() { 0 } else { tip };
    points
}

/// The middle of a line and its width where it fills the strips beside it.
fn filled(row: i32, strip: Strip, line_width: Coord) -> LinePoint {
    let w = f64::from(line_width);
    let Strip { u, above, below } = strip;
    let spare = (WIDEST - 1.0) * w;
    let share = if above + below > spare { spare / (above + below) } else { 1.0 };
    LinePoint {
        u,
        v: (f64::from(row) * w + share * (above - below) / 2.0).round() as Coord,
        width: (w + share * (above + below)).round() as Coord,
    }
}

/// The strips beside a line that no join covers.
fn open_strips(line: &Line, joined: Joined, pitch: Coord) -> Vec<Strip> {
    let mut strips = line.strips.clone();
    let near_left = line.span.start + SHORT_STRIP * pitch;
    let near_right = line.span.end - SHORT_STRIP * pitch;
    for strip in &mut strips {
        let (left, right) = (strip.u < near_left, strip.u > near_right);
        if left && joined.above.0 || right && joined.above.1 {
            strip.above = 0.0;
        }
        if left && joined.below.0 || right && joined.below.1 {
            strip.below = 0.0;
        }
    }
    strips
}

/// The strips along a whole span: nothing where no column tells of one, and at
/// the span's ends what the last two columns lead one to expect.
fn samples(known: &[Strip], span: Span, pitch: Coord) -> Vec<Strip> {
    let none = |u| Strip { u, above: 0.0, below: 0.0 };
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else {
        return vec![none(span.start), none(span.end)];
    };
    let mut out = Vec::with_capacity(known.len() + 4);
    if first.u - pitch > span.start {
        out.extend([none(span.start), none(first.u - pitch)]);
    } else {
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
    } else {
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
    let go = |last: f64, before: f64| (last + (last - before) * far).clamp(0.0, last);
    Strip {
        u,
        above: go(last.above, near.map_or(0.0, |b| b.above)),
        below: go(last.below, near.map_or(0.0, |b| b.below)),
    }
}

/// Between samples `a` and `b`, keeps those that a straight change from `a` to `b`
/// would miss (Ramer 1972, Douglas and Peucker 1973).
fn keep_bends(samples: &[Strip], a: usize, b: usize, kept: &mut Vec<usize>) {
    let (first, last) = (samples[a], samples[b]);
    let run = f64::from(last.u - first.u).max(1.0);
    let miss = |k: usize| {
        let t = f64::from(samples[k].u - first.u) / run;
        let above = first.above + t * (last.above - first.above) - samples[k].above;
        let below = first.below + t * (last.below - first.below) - samples[k].below;
        above.abs().max(below.abs())
    };
    let worst =
        (a + 1..b).map(|k| (miss(k), k)).max_by(|x, y| x.0.total_cmp(&y.0).then(y.1.cmp(&x.1)));
    if let Some((miss, k)) = worst.filter(|(miss, _)| *miss > LEAST_BEND) {
        let _ = miss;
        keep_bends(samples, a, k, kept);
        kept.push(k);
        keep_bends(samples, k, b, kept);
    }
}

/// Beads along the middle of extents that no line reaches, joined from column to column.
fn slivers(thin: Vec<Extent>, params: &Params) -> Vec<Vec<LinePoint>> {
    let mut beads: Vec<(Extent, Vec<LinePoint>)> = Vec::new();
    let w = params.line_width;
    for extent in thin {
        let height = extent.high - extent.low;
        let width =
            (height + w - 2 * params.overlap).clamp(w / 2, (WIDEST * f64::from(w)) as Coord);
        let point = LinePoint { u: extent.u, v: extent.low + height / 2, width };
        let joins = |last: &Extent| {
            extent.u - last.u == w && extent.low <= last.high && last.low <= extent.high
        };
        match beads
            .iter_mut()
            .rev()
            .take_while(|(e, _)| extent.u - e.u <= w)
            .find(|(e, _)| joins(e))
        {
            Some((last, bead)) => {
                *last = extent;
                bead.push(point);
            }
            None => beads.push((extent, vec![point])),
        }
    }
    beads.into_iter().map(|(_, bead)| bead).filter(|bead| bead.len() >= LEAST_COLUMNS).collect()
}
