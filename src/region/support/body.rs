//! Rows -> sparse lines and outlines: how the body of support is laid, so that it hangs together.
//!
//! Words: a *tie* is an outline that is printed on every few layers, so that no line between two of
//! them is too high to stand alone. A place is *weak* if it lies far from its lines
//! ([`mod@super::held`]), or if its line is a *stub*: short, and part of no zigzag.
//!
//! Lines that are joined at their ends to a zigzag stand like a folded sheet. So a piece that its
//! lines hold, and that is broad enough with them alone, needs no outline: only ties, unless its lines
//! are one zigzag. What is weak of it gets an outline on every layer, and with it what lies around up to
//! the nearest line; the rest does not. Narrow strips have lines across ([`mod@super::strips`]).
//! A piece that is thin, or mostly weak, gets an outline as a whole.
//!
//! Lines end at an outline. Where they are short they brace its two sides, and a few of them do.
//! Long ones that run beside it hold nothing that it does not.

use super::held::{loose, reach};
use super::outline::outlines;
use super::params::{BODIES, SupportParams};
use super::pieces::{Pieces, turned, without_narrow};
use super::strips::{upright, whole_columns};
use crate::geom::Contour;
use crate::geom::polyline::{Polyline, length};
use crate::geom::section::Section;
use crate::geom::spans::{Rows, Span};
use crate::pattern::{Lines, SparsePattern as _};
use crate::units::{Coord, to_mm};

/// The ends of support lines lie this far inside the outline, in hundredths of a line's width: their
/// round ends just reach into it. More leaves a gap, less piles up plastic there.
const LINES_FROM_OUTLINE: Coord = 60;

/// A zigzag of fewer points is a single line.
const LEAST_POINTS: usize = 4;

/// Lines inside an outline that are no longer than this, in spacings, are printed on one layer of
/// [`SELDOM`] only: between two sides so near to each other they need nothing below.
const BRACE: Coord = 2;

/// See [`BRACE`]. More layers save little; the sides are held at this many layer heights.
const SELDOM: usize = 4;

/// Longer lines that are nowhere further than this from the outline, in line widths, are left out.
const BESIDE: Coord = 3;

/// Ties lie on one layer of so many where a line is part of no zigzag: of 0.2 mm, a line of 0.4 mm
/// between two is four times as high as it is wide.
const TIED: usize = 8;

/// Ties lie on one layer of so many elsewhere: a zigzag is at least three times as thick as a line.
const SELDOM_TIED: usize = 3 * TIED;

/// A piece gets an outline as a whole if this part of it would get one in any case.
const MOSTLY: f64 = 0.6;

/// The body of a layer, and how it hangs together.
#[derive(Debug, Default)]
pub(super) struct Body {
    rows: Rows,
    /// Where lines run across.
    strips: Rows,
    /// What carries the interface of the next layer.
    carries: Rows,
    /// The pieces that get an outline on every layer.
    thin: Rows,
    /// Those that get ties.
    tied: Rows,
    /// What of them gets more: what is near a line that is part of no zigzag.
    lone: Rows,
    /// What of them gets an outline on every layer.
    weak: Rows,
}

/// What gets an outline is left out of zigzags, and their rests are looked at again, so many times.
const MOST_PASSES: usize = 6;

impl Body {
    /// The body that covers `rows`, with lines across on `strips`. On `carries` the interface of the
    /// next layer lies on it.
    pub(super) fn new(rows: Rows, strips: Rows, carries: Rows, params: &SupportParams) -> Self {
        if !params.has_outline || rows.is_empty() {
            return Self { rows, ..Self::default() };
        }
        let rows = without_narrow(&rows, params);
        let pieces = Pieces::new(&rows);
        let is_thin = |piece: usize| {
            let piece = pieces.keep(&rows, |other| other == piece);
            !is_broad(&apart(&piece, &strips, params), params)
        };
        let mut thin: Vec<bool> = (0..pieces.count()).map(is_thin).collect();
        let broad = pieces.keep(&rows, |piece| !thin[piece]);
        let (weak, strands) = weak(&broad, &strips, params);
        // What is mostly weak gets an outline as a whole.
        let mut of_weak = vec![0; pieces.count()];
        pieces.shared(&rows, &weak, &mut of_weak);
        for (piece, length) in pieces.lengths(&rows).into_iter().enumerate() {
            thin[piece] |= of_weak[piece] as f64 >= MOSTLY * length as f64;
        }
        let heads = Pieces::new(&strands.heads);
        let mut of_heads = vec![None; heads.count()];
        pieces.meeting(&rows, &strands.heads, |piece, k| of_heads[heads.of(k)] = Some(piece));
        let mut count = vec![0; pieces.count()];
        of_heads.into_iter().flatten().for_each(|piece| count[piece] += 1);
        let mut has_lone = vec![false; pieces.count()];
        pieces.meeting(&rows, &strands.lone, |piece, _| has_lone[piece] = true);
        let is_zigzag = |k: usize| count[k] <= 1 && of_weak[k] == 0 && !has_lone[k];
        let tied = pieces.keep(&rows, |piece| !thin[piece] && !is_zigzag(piece));
        let thin = pieces.keep(&rows, |piece| thin[piece]);
        // Ties reach around the next line.
        let lone = around(&strands.lone, &tied, params.lines.stride, params);
        let weak = weak.minus(&thin);
        Self { rows, strips, carries, thin, tied, lone, weak }
    }

    /// What is weak of the layer above, and has no line below it here, gets an outline here to stand on.
    pub(super) fn carry(&mut self, above: &Self, params: &SupportParams) {
        if above.weak.is_empty() {
            return;
        }
        let least = i64::from(params.least);
        let prints = |j: i32, span: Span| params.lines.prints(j) && span.len() >= least;
        let lines = self.rows.filter(prints).or(&self.strips).or(&self.weak).or(&self.thin);
        let pieces = Pieces::new(&above.weak);
        let mut carried = vec![false; pieces.count()];
        pieces.meeting(&above.weak, &lines, |piece, _| carried[piece] = true);
        let falls = pieces.keep(&above.weak, |piece| !carried[piece]);
        let falls = falls.and(&self.rows);
        if !falls.is_empty() {
            self.weak = self.weak.or(&falls);
            // Lines lose what they were joined to, and so others turn at their other ends, far from here as well.
            let pitch = params.raster().pitch;
            let left = self.rows.minus(&self.weak.dilate(inwards(params), pitch));
            let [along, across] = apart(&left, &self.strips, params);
            let strands = Strands::of([&along, &across], params);
            let alone = strands.lone.or(&strands.stubs).or(&falls);
            let near = around(&alone, &self.rows, params.lines.stride, params);
            self.lone = self.lone.or(&near.minus(&self.thin));
        }
    }

    /// The outlines of layer `k`, and where its lines run, by pattern.
    pub(super) fn lay(self, k: usize, params: &SupportParams) -> (Vec<Contour>, [Rows; BODIES]) {
        let Self { rows, strips, carries, thin, tied, lone, weak } = self;
        let always = thin.or(&weak);
        let mut outlined = always.clone();
        if k.is_multiple_of(TIED) {
            outlined = outlined.or(if k.is_multiple_of(SELDOM_TIED) { &tied } else { &lone });
        }
        if outlined.is_empty() {
            let [along, across] = apart(&rows, &strips, params);
            return (Vec::new(), [along, Rows::default(), across, Rows::default()]);
        }
        let raster = params.raster();
        let inwards = inwards(params);
        let lines = outlined.erode(inwards, raster.pitch);
        let zigzags = rows.minus(&outlined.dilate(inwards, raster.pitch));
        let outlines = outlines(&outlined, raster.pitch, raster.frame, 4 * params.least);

        // Braces reach from side to side.
        let [along, across] = apart(&lines, &whole_columns(&lines, &strips, params), params);
        let core = outlined.erode(BESIDE * params.least, raster.pitch);
        let seldom = k.is_multiple_of(SELDOM);
        let lines = along.filter(|j, span| {
            let is_brace = span.len() <= brace(params);
            let braces = || seldom || carries.overlapping(j, span).is_some();
            // Lines of the next layer lie on those inside a tie.
            let only_tied = || always.overlapping(j, span).is_none();
            if is_brace { braces() } else { core.overlapping(j, span).is_some() || only_tied() }
        });
        let carries = if seldom { Rows::default() } else { turned(&carries, raster.pitch) };
        let braces = across.filter(|j, span| seldom || carries.overlapping(j, span).is_some());
        let [zigzags, waves] = apart(&zigzags, &strips, params);
        (outlines, [zigzags, lines, waves, braces])
    }
}

/// The longest brace, grid units.
fn brace(params: &SupportParams) -> i64 {
    i64::from(BRACE * params.lines.stride * params.raster().pitch)
}

/// How far lines end inside an outline.
fn inwards(params: &SupportParams) -> Coord {
    params.least * LINES_FROM_OUTLINE / 100
}

/// What of `rows` gets lines along, and what of it lines across, on their rasters.
fn apart(rows: &Rows, strips: &Rows, params: &SupportParams) -> [Rows; 2] {
    if strips.is_empty() {
        return [rows.clone(), Rows::default()];
    }
    [rows.minus(strips), turned(&rows.and(strips), params.raster().pitch)]
}

/// The weak places of `rows` with what lies around them, and how lines lie in the rest.
fn weak(rows: &Rows, strips: &Rows, params: &SupportParams) -> (Rows, Strands) {
    let [along, across] = apart(rows, strips, params);
    let mut strands = Strands::of([&along, &across], params);
    let loose = [loose(&params.lines, &along), upright(&loose(&params.crossing, &across), params)];
    let mut found = loose[0].or(&loose[1]).or(&strands.stubs);
    let mut weak = Rows::default();
    for _ in 0..MOST_PASSES {
        if found.is_empty() {
            break;
        }
        // Up to the next line, which is left out: so others may lose what they were joined to.
        weak = weak.or(&around(&found, rows, reach(&params.lines) + 1, params));
        let left = rows.minus(&weak.dilate(inwards(params), params.raster().pitch));
        let [along, across] = apart(&left, strips, params);
        strands = Strands::of([&along, &across], params);
        found = std::mem::take(&mut strands.stubs);
    }
    (weak, strands)
}

/// What of the pieces of `rows` that have some of `places` lies around these, by so many pitches and a
/// line's width.
fn around(places: &Rows, rows: &Rows, far: i32, params: &SupportParams) -> Rows {
    if places.is_empty() {
        return Rows::default();
    }
    let pitch = params.raster().pitch;
    let near = places.dilate(far * pitch + params.least, pitch).and(rows);
    let pieces = Pieces::new(&near);
    let mut meets = vec![false; pieces.count()];
    pieces.meeting(&near, places, |piece, _| meets[piece] = true);
    pieces.keep(&near, |piece| meets[piece])
}

/// How lines along and across lie.
#[derive(Debug, Default)]
struct Strands {
    /// A line of each zigzag, and each single line.
    heads: Rows,
    /// The short ones of the single lines, and the others.
    stubs: Rows,
    lone: Rows,
}

impl Strands {
    /// Of lines on these rows along and across.
    fn of([along, across]: [&Rows; 2], params: &SupportParams) -> Self {
        let (rows, columns) =
            (Self::on(&params.lines, along, params), Self::on(&params.crossing, across, params));
        Self {
            heads: rows.heads.or(&upright(&columns.heads, params)),
            stubs: rows.stubs.or(&upright(&columns.stubs, params)),
            lone: rows.lone.or(&upright(&columns.lone, params)),
        }
    }

    /// Of these lines on their rows.
    fn on(lines: &Lines, rows: &Rows, params: &SupportParams) -> Self {
        if rows.is_empty() {
            return Self::default();
        }
        let strands = lines.strands(rows, params.least, params.least);
        let (stubs, lone): (Vec<&Polyline>, Vec<&Polyline>) = strands
            .iter()
            .filter(|strand| strand.len() < LEAST_POINTS)
            .partition(|strand| length(strand) <= brace(params));
        let [heads, stubs, lone] = [strands.iter().collect(), stubs, lone]
            .map(|which: Vec<&Polyline>| on_rows(&which, lines.raster.pitch));
        Self { heads, stubs, lone }
    }
}

/// The first line of each strand as a row, with a row on each side for what looks at them across.
fn on_rows(strands: &[&Polyline], pitch: Coord) -> Rows {
    let line = |strand: &&Polyline| {
        let (a, b) = (strand.first()?, strand.get(1)?);
        let span = Span { start: a.u.min(b.u), end: a.u.max(b.u) };
        (a.v == b.v).then_some((a.v.div_euclid(pitch), span))
    };
    let mut spans: Vec<(i32, Span)> = strands.iter().filter_map(line).collect();
    spans.sort_unstable_by_key(|(j, span)| (*j, span.start));
    let mut out = Rows::starting_at(spans.first().map_or(0, |(j, _)| *j));
    for row in spans.chunk_by(|a, b| a.0 == b.0) {
        while out.range().end < row[0].0 {
            out.push_row(|_| ());
        }
        out.push_row(|spans| spans.extend(row.iter().map(|(_, span)| *span)));
    }
    out.dilate(pitch, pitch)
}

/// Whether lines along and across alone are as thick as support must be, and at least two.
fn is_broad([along, across]: &[Rows; 2], params: &SupportParams) -> bool {
    let pitch = params.raster().pitch;
    let long = |span: &&Span| span.len() >= i64::from(params.least);
    let w = to_mm(params.least);
    let mut section: Option<Section> = None;
    let mut add = |span: Span, y: f64, wide: f64| {
        let near = || Section::near([to_mm(span.start), y]);
        section.get_or_insert_with(near).add(span, y, wide);
    };
    for (j, row) in along.iter().filter(|(j, _)| params.lines.prints(*j)) {
        row.iter().filter(long).for_each(|&span| add(span, to_mm(j * pitch), w));
    }
    let half = params.least / 2;
    for (j, row) in across.iter().filter(|(j, _)| params.crossing.prints(*j)) {
        let line = Span { start: -j * pitch - half, end: -j * pitch + half };
        for span in row.iter().filter(long) {
            add(line, 0.5 * (to_mm(span.start) + to_mm(span.end)), to_mm(span.end - span.start));
        }
    }
    let least = to_mm((params.min_width - params.least).max(2 * params.least));
    section.is_some_and(|section| section.thickness() >= least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::edges;
    use crate::profile;
    use crate::region::support::strips::strips;

    fn params() -> SupportParams {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        settings.support.enabled = true;
        SupportParams::new(&settings).unwrap()
    }

    /// A rectangle on the rows of support, which are 0.2 mm apart.
    fn block(rows: std::ops::Range<i32>, start: Coord, end: Coord) -> Rows {
        let mut out = Rows::starting_at(rows.start);
        rows.for_each(|_| out.push_row(|spans| spans.push(Span { start, end })));
        out
    }

    /// What is laid, and the length of its outlines, mm.
    fn laid(body: &Rows, carries: &Rows, k: usize) -> (f64, [Rows; BODIES]) {
        let params = params();
        let strips = strips(body, &params);
        let body = Body::new(body.clone(), strips, carries.clone(), &params);
        let (outlines, rows) = body.lay(k, &params);
        let around = outlines.iter().flat_map(|one| edges(one)).map(|(p, q)| p.distance(q));
        (around.sum::<f64>() / 10_000.0, rows)
    }

    #[test]
    fn a_ring_whose_sides_lie_between_lines_gets_ties_and_no_outlines() {
        let ring = block(3..160, 0, 450_000).minus(&block(13..151, 19_000, 431_000));
        let [(between, rows), (tied, _)] =
            [1, SELDOM_TIED].map(|k| laid(&ring, &Rows::default(), k));
        // But for a line at a corner.
        assert!(between < 15.0, "{between}");
        assert!(tied > 280.0, "{tied}");
        assert!(!rows[0].is_empty() && !rows[2].is_empty() && rows[1].is_empty());
    }

    #[test]
    fn only_what_is_weak_of_a_piece_gets_an_outline() {
        // A foot with a narrow arm, whose line no join leads to.
        let foot = block(0..91, 0, 400_000);
        let arm = block(91..112, 180_000, 220_000);
        let (around, rows) = laid(&foot.or(&arm), &Rows::default(), 1);
        assert!((10.0..30.0).contains(&around), "{around}");
        assert!(rows[0].total() > 80 * 400_000);
        // Alone it gets none.
        assert!(laid(&foot, &Rows::default(), 1).0 < 1.0);
    }

    #[test]
    fn an_outline_between_two_lines_stands_on_another() {
        let params = params();
        let body = |rows: &Rows| Body::new(rows.clone(), Rows::default(), Rows::default(), &params);
        let (mut above, mut below) =
            (body(&block(0..91, 0, 400_000)), body(&block(0..91, 0, 400_000)));
        above.weak = block(31..44, 100_000, 140_000);
        below.carry(&above, &params);
        assert_eq!(below.weak.total(), above.weak.total());
        // This one lies on a line.
        (above.weak, below.weak) = (block(28..44, 100_000, 140_000), Rows::default());
        below.carry(&above, &params);
        assert!(below.weak.is_empty());
    }

    #[test]
    fn lines_beside_an_outline_are_left_out_but_for_braces_below_an_interface() {
        // Too thin without an outline, with one line along its middle.
        let strip = block(-7..8, 0, 450_000);
        let (around, rows) = laid(&strip, &Rows::default(), 1);
        assert!(around > 90.0, "{around}");
        assert!(rows.iter().all(Rows::is_empty), "{rows:?}");
        // Across it lines are braces.
        let strip = block(3..90, 0, 28_000);
        let braces = |carries: &Rows, k: usize| laid(&strip, carries, k).1[1].total();
        assert!(braces(&Rows::default(), SELDOM) > 0);
        assert_eq!(braces(&Rows::default(), SELDOM + 1), 0);
        assert!(braces(&strip, SELDOM + 1) > 0);
    }
}
