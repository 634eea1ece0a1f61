//! Rows -> sparse lines and outlines: how the body of support is laid, so that it hangs together.
//!
//! Lines that are joined at their ends to a zigzag stand like a folded sheet, if the zigzag has at
//! least two lines. So each piece gets zigzags if all of its lines are part of one. Other pieces are
//! mostly *ribbons*: long and narrow, along the outline of the part. There the lines run across
//! where the others would run along the ribbon. What still has lines that would stand alone gets an
//! outline that holds them.

use super::outline::outlines;
use super::params::SupportParams;
use super::pieces::{Pieces, erode, turned};
use crate::geom::Contour;
use crate::geom::spans::Rows;
use crate::pattern::{Lines, SparsePattern as _};
use crate::units::Coord;

/// The ends of support lines lie this far inside the outline, in hundredths of a line's width: their
/// round ends just reach into it. More leaves a gap, less piles up plastic there.
const LINES_FROM_OUTLINE: Coord = 60;

/// Places narrower than this are left out where there is an outline, in hundredths of a line's
/// width: its two sides would lie on each other.
const NARROW: Coord = 95;

/// A zigzag of fewer points is a single line.
const LEAST_POINTS: usize = 4;

/// Longer lines do not cross a ribbon, but run along it, in spacings. Ribbons are hardly wider than
/// a post has to be.
const LONG: Coord = 2;

/// Lines inside an outline that are no longer than this, in spacings, are printed on one layer of
/// [`SELDOM`] only: between two sides so near to each other they need nothing below.
const BRACE: Coord = 2;

/// See [`BRACE`]. More layers save little; the sides are held at this many layer heights.
const SELDOM: usize = 4;

/// The outlines of `rows`, and the rows of zigzags, of zigzags across, and of lines that end at the
/// outlines.
pub(super) fn lay(rows: &Rows, k: usize, params: &SupportParams) -> (Vec<Contour>, [Rows; 3]) {
    if !params.has_outline || rows.is_empty() {
        return (Vec::new(), [rows.clone(), Rows::default(), Rows::default()]);
    }
    let (w, raster) = (params.least, params.raster());
    let spacing = params.lines.stride * raster.pitch;
    let half = w * NARROW / 200;
    let rows = erode(rows, half, raster.pitch).dilate(half, raster.pitch).and(rows);
    let stands = |piece: &Rows| is_folded(&params.lines, piece, w);
    let stands_across = |piece: &Rows| is_folded(&params.crossing, &turned(piece, raster.pitch), w);

    let (whole, others) = split(&rows, stands);
    // Ribbons: lines cross each stretch of them on the shorter way.
    let short = others.filter(|_, span| span.len() <= i64::from(LONG * spacing));
    let (short, left) = split(&short, stands);
    let long = others.filter(|_, span| span.len() > i64::from(LONG * spacing));
    let (long, left_long) = split(&long, stands_across);
    // An outline would lie on the zigzags beside it.
    let beside = short.or(&long).dilate(w, raster.pitch);
    let outlined = left.or(&left_long).minus(&beside);

    let outlines = outlines(&outlined, raster.pitch, raster.frame, 4 * w);
    let lines = erode(&outlined, w * LINES_FROM_OUTLINE / 100, raster.pitch);
    let lines = lines.filter(|_, span| k % SELDOM == 0 || span.len() > i64::from(BRACE * spacing));
    (outlines, [whole.or(&short), turned(&long, raster.pitch), lines])
}

/// The pieces of `rows` that stand, and the others.
fn split(rows: &Rows, stands: impl Fn(&Rows) -> bool) -> (Rows, Rows) {
    let pieces = Pieces::new(rows);
    let stands: Vec<bool> = (0..pieces.count())
        .map(|piece| stands(&pieces.keep(rows, |other| other == piece)))
        .collect();
    (pieces.keep(rows, |piece| stands[piece]), pieces.keep(rows, |piece| !stands[piece]))
}

/// Whether all lines in a piece are part of zigzags, none of them alone.
fn is_folded(lines: &Lines, piece: &Rows, width: Coord) -> bool {
    let strands = lines.strands(piece, width, width);
    !strands.is_empty() && strands.iter().all(|strand| strand.len() >= LEAST_POINTS)
}
