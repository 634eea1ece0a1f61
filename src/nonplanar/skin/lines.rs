//! Piece -> Lines: the rows of a skin in plan, each widened and moved to where its band has room.
//!
//! Words: as in [`piece`](super::piece). An *edge is shallow* if it runs nearly along the lines; there a
//! band ends in a long triangle. A line is *open* where the next row has no line beside it.
//!
//! 1. A line ends half a line within the edge. At a shallow edge it runs on, until the edge leaves it
//!    too little room.
//! 2. Where it lies beside the next row's line, its band ends half way to it. Where it is open for long,
//!    its band ends at the edge. So a row that begins or ends in a triangle shares its room with the
//!    row beside it, and no hair line stays open. Short open places are at the ends of rows: the turns
//!    of the zigzag fill them.
//! 3. The line follows the middle of its band and is as wide as the band. Corners are kept only where
//!    that bends.

use super::piece::Piece;
use crate::geom::decimate::{decimate, most_missed};
use crate::geom::spans::{Span, subtract};

/// Rows end half a line from the edge, and at shallow edges this share of a line. A smaller share makes
/// threads in the tips of triangles; a larger one makes the line beside them wider.
const NEAREST: f64 = 0.2;

/// An edge is shallow if a row gains more by ending nearer to it, in line widths. With `NEAREST` that is
/// an edge of less than 14° to the lines.
const SHALLOW: f64 = 1.2;

/// Open stretches up to this long, in line widths, are filled by the turns. Turns run as far along the
/// lines at most: then every edge has one or the other. Also the least length of a line that lies
/// between others' ends.
pub(super) const LONGEST_RUN: f64 = 4.0;

/// A line's band is at most so wide, in line widths, as for lines of flat skins: the flat face of a
/// nozzle still smooths a bead of this width.
const WIDEST: f64 = 1.75;

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

/// A line of a skin in plan.
#[derive(Debug)]
pub(super) struct Line {
    /// Where it runs on its row.
    pub(super) span: Span,
    /// Its middle, from the lesser u on; at least two places.
    pub(super) spots: Vec<Spot>,
}

/// The lines of each row of `piece`, with the number of the row.
pub(super) fn lines(piece: &Piece) -> Vec<(i32, Vec<Line>)> {
    let rows = rows(piece);
    let row = |k: usize| rows.get(k).map_or(&[] as &[Span], |(_, spans)| spans);
    let number = |k: usize| rows[k].0;
    let line = |k: usize, span: Span| {
        let before = k.checked_sub(1).map_or(&[] as &[Span], row);
        let beside = [open(piece, span, before), open(piece, span, row(k + 1))];
        Line { span, spots: spots(piece, number(k), span, &beside) }
    };
    let of_row = |k: usize| (number(k), row(k).iter().map(|&span| line(k, span)).collect());
    (0..rows.len()).map(of_row).collect()
}

/// Where the lines run, row by row without a gap.
fn rows(piece: &Piece) -> Vec<(i32, Vec<Span>)> {
    let pitch = f64::from(piece.pitch);
    let inner = piece.scan.inset(piece.pitch / 2);
    let outer = piece.scan.inset((NEAREST * pitch) as i32);
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
    let (shallow, long) = ((SHALLOW * pitch) as i32, (LONGEST_RUN * pitch) as i32);
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
        [] => out.extend(Some(outer).filter(|outer| outer.len() >= i64::from(long))),
        [only] => stretch(only, [true, true], outer, shallow),
        [start, .., end] => {
            stretch(start, [true, false], outer, shallow);
            stretch(end, [false, true], outer, shallow);
        }
    }
}

/// Lets a line's ends run on to those of `outer`, where that is further than `shallow`.
fn stretch(span: &mut Span, [start, end]: [bool; 2], outer: Span, shallow: i32) {
    if start && span.start - outer.start > shallow {
        span.start = outer.start;
    }
    if end && outer.end - span.end > shallow {
        span.end = outer.end;
    }
}

/// Where a line is open for long towards a row with these lines.
fn open(piece: &Piece, span: Span, row: &[Span]) -> Vec<Span> {
    let mut open = Vec::new();
    subtract(&[span], row, &mut open);
    open.retain(|s| s.len() as f64 > LONGEST_RUN * f64::from(piece.pitch));
    open
}

/// The middle of the line on row `j`, open in the stretches below and above.
fn spots(piece: &Piece, j: i32, span: Span, open: &[Vec<Span>; 2]) -> Vec<Spot> {
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
    let count = ((ends[1] - ends[0]) / half).ceil().max(1.0);
    let at = |k: usize| ends[0] + (ends[1] - ends[0]) * k as f64 / count;
    let all: Vec<Spot> = (0..=count as usize).map(|k| spot(at(k))).collect();
    let miss = |a: &Spot, b: &Spot, s: &Spot| {
        let part = (s.u - a.u) / (b.u - a.u);
        let off = |from: f64, to: f64, is: f64| (from + (to - from) * part - is).abs();
        off(a.v, b.v, s.v).max(off(a.width, b.width, s.width))
    };
    let split =
        |a: usize, b: usize| most_missed(a, b, LEAST_BEND, |k| miss(&all[a], &all[b], &all[k]));
    decimate(all.len(), split).into_iter().map(|k| all[k]).collect()
}
