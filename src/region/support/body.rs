//! Rows -> sparse lines and outlines: how the body of support is laid, so that it hangs together.
//!
//! Lines that are joined at their ends to a single zigzag stand like a folded sheet. Where they are
//! not, as in narrow or ragged pieces, each line would stand alone; there an outline holds them.

use super::outline::outlines;
use super::params::SupportParams;
use super::pieces::{Pieces, erode};
use crate::geom::Contour;
use crate::geom::spans::Rows;
use crate::pattern::SparsePattern as _;
use crate::units::Coord;

/// The ends of support lines lie this far inside the outline, in hundredths of a line's width: their
/// round ends just reach into it. More leaves a gap, less piles up plastic there.
const LINES_FROM_OUTLINE: Coord = 60;

/// Places narrower than this are left out where there is an outline, in hundredths of a line's
/// width: its two sides would lie on each other.
const NARROW: Coord = 95;

/// A zigzag of fewer points is a single line.
const LEAST_POINTS: usize = 4;

/// The outlines of `rows`, and the rows of joined lines and of lines that end at the outlines.
pub(super) fn lay(rows: &Rows, params: &SupportParams) -> (Vec<Contour>, [Rows; 2]) {
    if !params.has_outline || rows.is_empty() {
        return (Vec::new(), [rows.clone(), Rows::default()]);
    }
    let (w, raster) = (params.least, params.raster());
    let half = w * NARROW / 200;
    let rows = erode(rows, half, raster.pitch).dilate(half, raster.pitch).and(rows);
    let pieces = Pieces::new(&rows);
    let stands: Vec<bool> = (0..pieces.count())
        .map(|piece| {
            let piece = pieces.keep(&rows, |other| other == piece);
            let strands = params.lines.strands(&piece, w, w);
            strands.len() == 1 && strands[0].len() >= LEAST_POINTS
        })
        .collect();
    let joined = pieces.keep(&rows, |piece| stands[piece]);
    let others = pieces.keep(&rows, |piece| !stands[piece]);
    let outlines = outlines(&others, raster.pitch, raster.frame, 4 * w);
    (outlines, [joined, erode(&others, w * LINES_FROM_OUTLINE / 100, raster.pitch)])
}
