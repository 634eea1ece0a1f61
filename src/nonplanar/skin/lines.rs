//! Piece -> Lines: the rows of a skin in plan, each widened and moved to where its band has room.
//!
//! Words: as in [`piece`](super::piece). An *edge is shallow* if it runs nearly along the lines; there a
//! band ends in a long triangle. A line is *open* where the next row has no line beside it.
//!
//! 1. A line ends half a line within the edge. At a shallow edge it runs on, until the edge leaves it
//!    too little room.
//! 2. Where it lies beside the next row's line, its band ends half way to it. Where it is open, its band
//!    ends at the edge. So a row that begins or ends in a triangle shares its room with the row beside
//!    it, and no hair line stays open. Turns fill what is open for short stretches at
//!    the ends that they join: a turn lies half within its lines, and has twice the room beyond their ends.
//! 3. The line follows the middle of its band and is as wide as the band. Corners are kept only where
//!    that bends.

use super::piece::Piece;
use crate::geom::decimate::{decimate, most_missed};
use crate::geom::spans::{Span, subtract};
use crate::units::Coord;

/// Rows end so far from the edge, in line widths: half a line, but for rounding. The first and the last
/// row of a piece lie half a line from it.
const FROM_EDGE: f64 = 0.49;

/// Rows end half a line from the edge, and at shallow edges this share of a line. A smaller share makes
/// threads in the tips of triangles, which a nozzle of 0.4 mm tears; a larger one makes the line beside them
/// wider.
const NEAREST: f64 = 0.3;

/// An edge is shallow if a row gains more by ending nearer to it, in line widths. With `NEAREST` that is
/// an edge of less than 9° to the lines.
const SHALLOW: f64 = 1.2;

/// Turns run so far along the lines at most, in line widths: then they fill the open stretches at the
/// ends that they join. Also the least length of a line that lies between others' ends.
pub(super) const LONGEST_RUN: f64 = 4.0;

/// Shorter open stretches, in line widths, stay as they are: the round ends of lines fill them.
const LEAST_OPEN: f64 = 1.25;

/// A line's band is at most so wide, in line widths, as for lines of flat skins: the flat face of a
/// nozzle still smooths a bead of this width.
pub const WIDEST: f64 = 1.75;

/// Bends of a line's middle and changes of its width up to this are left out (10 µm).
const LEAST_BEND: f64 = 100.0;

/// A line shorter than this share of a line's width is none: its neighbours' turns cover it.
const SHORTEST: f64 = 0.25;

/// A place of a line's middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    /// Along the rows, grid units.
    pub(super) u: f64,
    /// Across them.
    pub(super) v: f64,
    /// Width of the band there.
    pub(super) width: f64,
}

/// Whether a turn begins or ends at the end of a line with the lesser u, and with the greater.
pub(super) type Joined = [bool; 2];

/// The middle of the line `span` on row `j`, from the lesser u on, at least two places. `beside` are the
/// spans of the rows below and above, `joined` tells of the turns to these.
pub(super) fn spots(
    piece: &Piece,
    (j, span): (i32, Span),
    beside: [&[Span]; 2],
    joined: [Joined; 2],
    shortest: Coord,
) -> Vec<Spot> {
    let open = [0, 1].map(|side| open(piece, span, beside[side], (joined, side)));
    let all = sampled(piece, (j, span), &open, f64::from(shortest));
    let miss = |a: &Spot, b: &Spot, s: &Spot| {
        let part = (s.u - a.u) / (b.u - a.u);
        let off = |from: f64, to: f64, is: f64| (from + (to - from) * part - is).abs();
        off(a.v, b.v, s.v).max(off(a.width, b.width, s.width))
    };
    let split =
        |a: usize, b: usize| most_missed(a, b, LEAST_BEND, |k| miss(&all[a], &all[b], &all[k]));
    decimate(all.len(), split).into_iter().map(|k| all[k]).collect()
}

/// Where the lines run, row by row without a gap.
pub(super) fn rows(piece: &Piece) -> Vec<(i32, Vec<Span>)> {
    let pitch = f64::from(piece.pitch);
    let inner = piece.scan.inset((FROM_EDGE * pitch) as Coord);
    let outer = piece.scan.inset((NEAREST * pitch) as Coord);
    let of_row = |(j, spans): (i32, &[Span])| {
        let mut out = Vec::new();
        spans.iter().for_each(|&span| within(span, inner.row(j), pitch, &mut out));
        (j, out)
    };
    outer.iter().map(of_row).collect()
}

/// Appends the lines within `outer`, where the edge may be near: `inner` are those of the row where it
/// is half a line away.
fn within(outer: Span, inner: &[Span], pitch: f64, out: &mut Vec<Span>) {
    let long = (LONGEST_RUN * pitch) as Coord;
    let own = inner.iter().filter(|s| s.overlaps(outer) && s.len() as f64 >= SHORTEST * pitch);
    let first = out.len();
    for &span in own {
        match out[first..].last_mut() {
            // A long neck is room for a narrow line; at a short one the turns do better.
            Some(last) if span.start - last.end > long => last.end = span.end,
            _ => out.push(span),
        }
    }
    match &mut out[first..] {
        [] => {
            let less = ((FROM_EDGE - NEAREST) * pitch) as Coord;
            let short = Span::new(outer.start + less, outer.end - less);
            out.extend(short.filter(|span| span.len() >= i64::from(long)));
        }
        [only] => stretch(only, [true, true], outer, pitch),
        [start, .., end] => {
            stretch(start, [true, false], outer, pitch);
            stretch(end, [false, true], outer, pitch);
        }
    }
}

/// Lets a line's ends run on towards those of `outer`, where that is far.
fn stretch(span: &mut Span, [start, end]: [bool; 2], outer: Span, pitch: f64) {
    // The end of the row may be at a steep edge, which is not to be nearer than elsewhere.
    let [less, shallow] = [FROM_EDGE - NEAREST, SHALLOW].map(|part| (part * pitch) as Coord);
    if start && span.start - outer.start > shallow {
        span.start = outer.start + less;
    }
    if end && outer.end - span.end > shallow {
        span.end = outer.end - less;
    }
}

/// Where a line is open towards a row with these lines, but for what the turns at its ends fill.
fn open(
    piece: &Piece,
    span: Span,
    row: &[Span],
    (joined, side): ([Joined; 2], usize),
) -> Vec<Span> {
    let pitch = f64::from(piece.pitch);
    let mut open = Vec::new();
    subtract(&[span], row, &mut open);
    // Where nothing lies beside all of the line, only a turn to that side fills anything.
    let is_last = open[..] == [span];
    let turns =
        |end: usize| if is_last { joined[side][end] } else { joined[0][end] || joined[1][end] };
    open.retain(|s| {
        let at_turn = turns(0) && s.start == span.start || turns(1) && s.end == span.end;
        s.len() as f64 > pitch * if at_turn { LONGEST_RUN } else { LEAST_OPEN }
    });
    open
}

/// The middle of the line on row `j` at places half a line apart, or `shortest`; open in the stretches
/// below and above.
fn sampled(
    piece: &Piece,
    (j, span): (i32, Span),
    open: &[Vec<Span>; 2],
    shortest: f64,
) -> Vec<Spot> {
    let (pitch, half) = (f64::from(piece.pitch), f64::from(piece.pitch) / 2.0);
    let v = f64::from(piece.v(j));
    let ends = [f64::from(span.start), f64::from(span.end)];
    let most = (WIDEST - 0.5) * pitch;
    let band = |u: f64, side: usize| {
        let is_open = open[side].iter().any(|s| f64::from(s.start) <= u && u <= f64::from(s.end));
        if is_open { piece.room(j, u, [-1.0, 1.0][side], most) } else { half }
    };
    let spot = |u: f64| {
        let [below, above] = [band(u, 0), band(u, 1)];
        let widest = WIDEST * pitch;
        // What is too wide is taken from both sides alike.
        let too_wide = (below + above - widest).max(0.0) / 2.0;
        Spot { u, v: v + (above - below) / 2.0, width: below + above - 2.0 * too_wide }
    };
    if open.iter().all(Vec::is_empty) {
        return ends.map(spot).to_vec();
    }
    let count = ((ends[1] - ends[0]) / half.max(shortest)).floor().max(1.0);
    let at = |k: usize| ends[0] + (ends[1] - ends[0]) * k as f64 / count;
    (0..=count as usize).map(|k| spot(at(k))).collect()
}
