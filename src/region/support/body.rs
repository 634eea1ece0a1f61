//! Rows -> sparse lines and outlines: how the body of support is laid, so that it hangs together.
//!
//! Words: a *tie* is an outline that is printed on every few layers, so that no line between two of
//! them is too high to stand alone. A piece is *held* if all of it lies near its lines
//! ([`mod@super::held`]).
//!
//! Lines that are joined at their ends to a zigzag stand like a folded sheet. So a piece that its
//! lines hold, and that is broad enough with them alone, needs no outline: only ties, unless its lines
//! are one zigzag. Any other piece, and one with short lines that are part of no zigzag, gets an
//! outline on every layer. Its lines end there; where they are short they brace the two sides, and a
//! few of them do.

use super::held::is_held;
use super::outline::outlines;
use super::params::SupportParams;
use super::pieces::Pieces;
use crate::geom::Contour;
use crate::geom::polyline::{Polyline, length};
use crate::geom::section::Section;
use crate::geom::spans::{Rows, Span};
use crate::pattern::SparsePattern as _;
use crate::units::{Coord, to_mm};

/// The ends of support lines lie this far inside the outline, in hundredths of a line's width: their
/// round ends just reach into it. More leaves a gap, less piles up plastic there.
const LINES_FROM_OUTLINE: Coord = 60;

/// Places narrower than this are left out where there is an outline, in hundredths of a line's
/// width: its two sides would lie on each other.
const NARROW: Coord = 95;

/// A zigzag of fewer points is a single line.
const LEAST_POINTS: usize = 4;

/// Lines inside an outline that are no longer than this, in spacings, are printed on one layer of
/// [`SELDOM`] only: between two sides so near to each other they need nothing below.
const BRACE: Coord = 2;

/// See [`BRACE`]. More layers save little; the sides are held at this many layer heights.
const SELDOM: usize = 4;

/// Ties lie on one layer of so many: of 0.2 mm, a line of 0.4 mm between two is four times as high
/// as it is wide.
const TIED: usize = 8;

/// How a piece hangs together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Hold {
    /// All of its lines are one zigzag.
    Zigzag,
    /// Its lines need ties.
    Ties,
    /// It needs an outline.
    Outline,
}

/// The outlines of `rows` of layer `k`, and the rows of zigzags and of lines that end at the outlines.
pub(super) fn lay(rows: &Rows, k: usize, params: &SupportParams) -> (Vec<Contour>, [Rows; 2]) {
    if !params.has_outline || rows.is_empty() {
        return (Vec::new(), [rows.clone(), Rows::default()]);
    }
    let (w, raster) = (params.least, params.raster());
    let half = w * NARROW / 200;
    let rows = rows.erode(half, raster.pitch).dilate(half, raster.pitch).and(rows);
    let pieces = Pieces::new(&rows);
    let is_outlined: Vec<bool> = (0..pieces.count())
        .map(|piece| match hold(&pieces.keep(&rows, |other| other == piece), params) {
            Hold::Zigzag => false,
            Hold::Ties => k.is_multiple_of(TIED),
            Hold::Outline => true,
        })
        .collect();
    let zigzags = pieces.keep(&rows, |piece| !is_outlined[piece]);
    let outlined = pieces.keep(&rows, |piece| is_outlined[piece]);

    let outlines = outlines(&outlined, raster.pitch, raster.frame, 4 * w);
    let lines = outlined.erode(w * LINES_FROM_OUTLINE / 100, raster.pitch);
    let lines = lines.filter(|_, span| k.is_multiple_of(SELDOM) || span.len() > brace(params));
    (outlines, [zigzags, lines])
}

/// The longest brace, grid units.
fn brace(params: &SupportParams) -> i64 {
    i64::from(BRACE * params.lines.stride * params.raster().pitch)
}

/// How `piece` hangs together.
fn hold(piece: &Rows, params: &SupportParams) -> Hold {
    let (lines, w) = (&params.lines, params.least);
    if !is_broad(piece, params) || !is_held(lines, piece) {
        return Hold::Outline;
    }
    let strands = lines.strands(piece, w, w);
    let is_stub =
        |strand: &Polyline| strand.len() < LEAST_POINTS && length(strand) <= brace(params);
    if strands.iter().any(is_stub) {
        Hold::Outline
    } else if strands.len() == 1 && strands[0].len() >= LEAST_POINTS {
        Hold::Zigzag
    } else {
        Hold::Ties
    }
}

/// Whether the lines of a piece alone are as thick as support must be, and at least two.
fn is_broad(piece: &Rows, params: &SupportParams) -> bool {
    let (lines, pitch) = (&params.lines, params.raster().pitch);
    let long = |span: &&Span| span.len() >= i64::from(params.least);
    let mut section: Option<Section> = None;
    for (j, row) in piece.iter().filter(|(j, _)| lines.prints(*j)) {
        let y = to_mm(j * pitch);
        for &span in row.iter().filter(long) {
            let near = || Section::near([to_mm(span.start), y]);
            section.get_or_insert_with(near).add(span, y, to_mm(params.least));
        }
    }
    let least = to_mm((params.min_width - params.least).max(2 * params.least));
    section.is_some_and(|section| section.thickness() >= least)
}
