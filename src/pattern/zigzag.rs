//! Lines on rows -> zigzags: neighbouring raster lines joined end to end.
//!
//! A join goes from the end of one line to the same end of the next. The caller decides whether
//! two ends can be joined, and gives the points between them: solid lines go straight, sparse
//! lines may follow the region's edge. A line that cannot be joined begins a new zigzag.

use crate::geom::polyline::LinePoint;
use crate::geom::spans::Span;
use crate::units::Coord;

/// Lines are joined if the distance of their rows is at most this many times the shorter line's
/// length. A larger value makes zigzags of joins only, a smaller one makes more travels.
const LONGEST_JOIN: i64 = 4;

/// Which end of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The one with the lesser `u`.
    Left,
    /// The one with the greater `u`.
    Right,
}

impl Side {
    /// The opposite end.
    #[must_use]
    pub fn other(self) -> Self {
        if self == Self::Left { Self::Right } else { Self::Left }
    }

    /// The end of `span` on this side.
    #[must_use]
    pub fn of(self, span: Span) -> Coord {
        if self == Self::Left { span.start } else { span.end }
    }
}

/// A line of a zigzag.
#[derive(Debug)]
pub struct Link {
    /// The points between the previous line and this one.
    pub join: Vec<LinePoint>,
    /// The line's row.
    pub row: i32,
    /// Index of the line in its row, as given to [`link`].
    pub index: usize,
    /// The line.
    pub span: Span,
    /// The end at which it is entered; arbitrary for a line without a neighbour.
    pub from: Side,
}

/// Joins lines of rows `stride` apart that overlap, or lie at most `slack` apart along the lines.
/// A `None` among a row's lines is not printed. `join` is given two ends as `(u, row)`. It returns
/// the points between them, or `None` if they cannot be joined.
#[must_use]
pub fn link(
    rows: impl Iterator<Item = (i32, impl Iterator<Item = Option<Span>>)>,
    stride: i32,
    slack: Coord,
    join: impl Fn((Coord, i32), (Coord, i32), Side) -> Option<Vec<LinePoint>>,
) -> Vec<Vec<Link>> {
    let mut done: Vec<Vec<Link>> = Vec::new();
    let mut open: Vec<Vec<Link>> = Vec::new();
    let (mut free, mut growing) = (Vec::new(), Vec::new());
    for (row, spans) in rows {
        free.extend(spans);
        if open.first().and_then(|z| z.last()).is_some_and(|l| l.row + stride != row) {
            done.append(&mut open);
        }
        for mut zigzag in open.drain(..) {
            match extend(&mut zigzag, row, &mut free, slack, &join) {
                Some(index) => growing.push((index, zigzag)),
                None => done.push(zigzag),
            }
        }
        for (index, span) in free.drain(..).enumerate() {
            let link = |span| Link { join: Vec::new(), row, index, span, from: Side::Left };
            growing.extend(span.map(|span| (index, vec![link(span)])));
        }
        growing.sort_by_key(|(index, _)| *index);
        open.extend(growing.drain(..).map(|(_, zigzag)| zigzag));
    }
    done.append(&mut open);
    done
}

/// Extends `zigzag` by a free line of `row` near its last line: the outermost on the side where
/// the zigzag ended. Returns the line's index, or `None` if none could be joined.
fn extend(
    zigzag: &mut Vec<Link>,
    row: i32,
    free: &mut [Option<Span>],
    slack: Coord,
    join: &impl Fn((Coord, i32), (Coord, i32), Side) -> Option<Vec<LinePoint>>,
) -> Option<usize> {
    let alone = zigzag.len() == 1;
    let last = zigzag.last_mut()?;
    let near = Span { start: last.span.start - slack, end: last.span.end + slack };
    let (both, onward) = ([Side::Right, Side::Left], [last.from.other()]);
    let sides: &[Side] = if alone { &both } else { &onward };
    let (index, side, span, points) = sides.iter().find_map(|&side| {
        let mut beside = free
            .iter()
            .enumerate()
            .filter_map(|(k, s)| s.filter(|s| s.overlaps(near)).map(|s| (k, s)));
        let (index, span) = if side == Side::Right { beside.next_back() } else { beside.next() }?;
        // Joins much longer than their lines would be an infill of their own.
        let shorter = last.span.len().min(span.len());
        let worth = i64::from(slack) <= LONGEST_JOIN * shorter;
        let ends = ((side.of(last.span), last.row), (side.of(span), row));
        let points = worth.then(|| join(ends.0, ends.1, side)).flatten()?;
        Some((index, side, span, points))
    })?;
    free[index] = None;
    last.from = side.other();
    zigzag.push(Link { join: points, row, index, span, from: side });
    Some(index)
}
