//! Rows -> sparse lines and outlines: how the body of support is laid, so that it hangs together.
//!
//! Lines that are joined at their ends to a zigzag stand like a folded sheet, if the zigzag has at
//! least two lines. So a piece gets zigzags if all of its lines are part of one. In any other piece,
//! as in narrow or ragged ones, some line would stand alone. It gets an outline that holds its lines;
//! where they are short they brace the two sides, and a few of them do.

use super::outline::outlines;
use super::params::SupportParams;
use super::pieces::Pieces;
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

/// How far a piece may reach beyond its first and last line, in hundredths of their spacing. What
/// lies on a longer overhang sags; with less, hardly any piece is a zigzag.
const BEYOND: i32 = 60;

/// Lines inside an outline that are no longer than this, in spacings, are printed on one layer of
/// [`SELDOM`] only: between two sides so near to each other they need nothing below.
const BRACE: Coord = 2;

/// See [`BRACE`]. More layers save little; the sides are held at this many layer heights.
const SELDOM: usize = 4;

/// The outlines of `rows` of layer `k`, and the rows of zigzags and of lines that end at the outlines.
pub(super) fn lay(rows: &Rows, k: usize, params: &SupportParams) -> (Vec<Contour>, [Rows; 2]) {
    if !params.has_outline || rows.is_empty() {
        return (Vec::new(), [rows.clone(), Rows::default()]);
    }
    let (w, raster) = (params.least, params.raster());
    let half = w * NARROW / 200;
    let rows = rows.erode(half, raster.pitch).dilate(half, raster.pitch).and(rows);
    let pieces = Pieces::new(&rows);
    let stands: Vec<bool> = (0..pieces.count())
        .map(|piece| stands(&params.lines, &pieces.keep(&rows, |other| other == piece), w))
        .collect();
    let zigzags = pieces.keep(&rows, |piece| stands[piece]);
    let outlined = pieces.keep(&rows, |piece| !stands[piece]);

    let outlines = outlines(&outlined, raster.pitch, raster.frame, 4 * w);
    let lines = outlined.erode(w * LINES_FROM_OUTLINE / 100, raster.pitch);
    let brace = i64::from(BRACE * params.lines.stride * raster.pitch);
    let lines = lines.filter(|_, span| k.is_multiple_of(SELDOM) || span.len() > brace);
    (outlines, [zigzags, lines])
}

/// Whether all lines in a piece are part of zigzags, none of them alone, and reach to both of its
/// ends.
fn stands(lines: &Lines, piece: &Rows, width: Coord) -> bool {
    let filled = || piece.iter().filter(|(_, row)| !row.is_empty()).map(|(j, _)| j);
    let printed = || filled().filter(|&j| lines.prints(j));
    let ends = [filled().next().zip(printed().next()), printed().last().zip(filled().last())];
    let is_near = |(a, b): (i32, i32)| 100 * (b - a) <= BEYOND * lines.stride;
    if !ends.into_iter().all(|end| end.is_some_and(is_near)) {
        return false;
    }
    let strands = lines.strands(piece, width, width);
    !strands.is_empty() && strands.iter().all(|strand| strand.len() >= LEAST_POINTS)
}
