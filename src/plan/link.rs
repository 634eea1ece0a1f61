//! Lines -> Chains: neighbouring raster lines joined end to end in zig-zags.
//!
//! A join goes from the end of one line to the same end of the next, straight
//! where that stays inside the region, else along the region's edge as the fine
//! lines between show it. Lines that cannot be joined begin a new chain.

use crate::geom::spans::{Rows, Span};
use crate::region::close::{Line, LinePoint};
use crate::units::Coord;

/// Lines joined end to end, in the frame of their raster.
pub type Chain = Vec<LinePoint>;

/// A join between two solid lines may run at most this many line widths along
/// them: a longer one would lie on its neighbours.
const LONGEST_SOLID_JOIN: Coord = 2;

/// Lines shorter than this are left out (50 µm): the bead's round end covers them.
const LEAST_LINE: i64 = 500;

/// A line of a row, as linking sees it.
#[derive(Debug, Clone)]
struct Piece {
    span: Span,
    points: Vec<LinePoint>,
}

/// Which end of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

impl Side {
    fn other(self) -> Self {
        if self == Self::Left { Self::Right } else { Self::Left }
    }
}

/// Chains of skin lines; `pitch` is the distance of rows.
#[must_use]
pub fn skin(lines: &[Line], pitch: Coord, width: Coord) -> Vec<Chain> {
    let rows = lines.chunk_by(|a, b| a.row == b.row).map(|row| {
        let pieces = row.iter().filter(|l| l.span.len() >= LEAST_LINE).map(|line| Piece {
            span: line.span,
            points: if line.bend.is_empty() {
                straight(line.span, line.row * pitch, width)
            } else {
                line.bend.clone()
            },
        });
        (row[0].row, pieces.collect())
    });
    let join = |from: &LinePoint, to: &LinePoint, _: (i32, i32), _: Side| {
        ((from.u - to.u).abs() <= LONGEST_SOLID_JOIN * width).then(Vec::new)
    };
    link(rows, 1, pitch, join)
}

/// Chains of every `stride`-th line of a sparse region; `pitch` is the distance of its rows.
#[must_use]
pub fn comb(region: &Rows, stride: i32, pitch: Coord, width: Coord) -> Vec<Chain> {
    let rows = region.iter().filter(|(j, _)| j.rem_euclid(stride) == 0).map(|(j, row)| {
        let pieces = row.iter().filter(|s| s.len() >= LEAST_LINE).map(|&span| Piece {
            span,
            points: straight(span, j * pitch, width),
        });
        (j, pieces.collect())
    });
    let join = |from: &LinePoint, to: &LinePoint, (a, b): (i32, i32), side: Side| {
        straight_join(region, from, to, a, b)
            .then(Vec::new)
            .or_else(|| edge_join(region, from, to, (a, b), side, pitch, width))
    };
    link(rows, stride, stride * pitch, join)
}

fn straight(span: Span, v: Coord, width: Coord) -> Vec<LinePoint> {
    vec![LinePoint { u: span.start, v, width }, LinePoint { u: span.end, v, width }]
}

/// Whether the straight join between rows `a` and `b` is inside `region` on every row between.
fn straight_join(region: &Rows, from: &LinePoint, to: &LinePoint, a: i32, b: i32) -> bool {
    let run = i64::from(to.u) - i64::from(from.u);
    (a + 1..b).all(|j| {
        let u = from.u + (run * i64::from(j - a) / i64::from(b - a)) as Coord;
        region.row(j).iter().any(|s| s.start <= u && u <= s.end)
    })
}

/// The points of a join along the region's edge, if it has one edge from row `a` to row `b`.
fn edge_join(
    region: &Rows,
    from: &LinePoint,
    to: &LinePoint,
    (a, b): (i32, i32),
    side: Side,
    pitch: Coord,
    width: Coord,
) -> Option<Vec<LinePoint>> {
    // Along an edge flatter than this a join would be longer than a travel is worth.
    let step = 2 * pitch;
    let mut at = from.u;
    let mut points = Vec::new();
    for j in a + 1..b {
        let end = |s: &Span| if side == Side::Right { s.end } else { s.start };
        let ends = region.row(j).iter().map(end);
        at = ends.filter(|u| (u - at).abs() <= step).min_by_key(|u| ((u - at).abs(), *u))?;
        points.push(LinePoint { u: at, v: j * pitch, width });
    }
    ((to.u - at).abs() <= step).then_some(points)
}

/// A chain that can still grow.
struct Open {
    chain: Chain,
    /// The line it ended with.
    span: Span,
    /// The end that it goes on from; unknown as long as it has one line only.
    side: Option<Side>,
}

impl Open {
    /// The sides it can go on from.
    fn sides(&self) -> &'static [Side] {
        match self.side {
            None => &[Side::Right, Side::Left],
            Some(Side::Right) => &[Side::Right],
            Some(Side::Left) => &[Side::Left],
        }
    }

    /// The point at `side` of its last line.
    fn end(&self, side: Side) -> LinePoint {
        match (self.side, side) {
            (None, Side::Left) => self.chain[0],
            _ => self.chain[self.chain.len() - 1],
        }
    }

    /// Goes on from `side` over `join` along `piece`.
    fn extend(&mut self, side: Side, join: Vec<LinePoint>, piece: Piece) {
        if self.side.is_none() && side == Side::Left {
            self.chain.reverse();
        }
        self.chain.extend(join);
        let mut points = piece.points;
        if side == Side::Right {
            points.reverse();
        }
        self.chain.extend(points);
        self.span = piece.span;
        self.side = Some(side.other());
    }
}

/// Joins lines of rows `stride` apart that lie beside each other or at most `slack`
/// apart along the lines. `join` gives the points between two ends, or none.
fn link(
    rows: impl Iterator<Item = (i32, Vec<Piece>)>,
    stride: i32,
    slack: Coord,
    join: impl Fn(&LinePoint, &LinePoint, (i32, i32), Side) -> Option<Vec<LinePoint>>,
) -> Vec<Chain> {
    let mut done = Vec::new();
    let mut open: Vec<Open> = Vec::new();
    let mut last_row = i32::MIN;
    for (j, pieces) in rows {
        if last_row.checked_add(stride) != Some(j) {
            done.extend(open.drain(..).map(|o| o.chain));
        }
        let mut pieces: Vec<Option<Piece>> = pieces.into_iter().map(Some).collect();
        let mut growing = Vec::with_capacity(pieces.len());
        for mut chain in open.drain(..) {
            match next(&chain, &pieces, slack, |from, to, side| join(from, to, (last_row, j), side)) {
                Some((k, side, points)) => {
                    if let Some(piece) = pieces[k].take() {
                        chain.extend(side, points, piece);
                    }
                    growing.push((k, chain));
                }
                None => done.push(chain.chain),
            }
        }
        for (k, piece) in pieces.into_iter().enumerate() {
            if let Some(Piece { span, points }) = piece {
                growing.push((k, Open { chain: points, span, side: None }));
            }
        }
        growing.sort_by_key(|(k, _)| *k);
        open.extend(growing.into_iter().map(|(_, chain)| chain));
        last_row = j;
    }
    done.extend(open.into_iter().map(|o| o.chain));
    done
}

/// The line that `chain` goes on with: of those that lie beside its last line the
/// outermost on the side it ended, if it can be joined.
fn next(
    chain: &Open,
    pieces: &[Option<Piece>],
    slack: Coord,
    join: impl Fn(&LinePoint, &LinePoint, Side) -> Option<Vec<LinePoint>>,
) -> Option<(usize, Side, Vec<LinePoint>)> {
    let near = Span { start: chain.span.start - slack, end: chain.span.end + slack };
    let beside = || {
        pieces.iter().enumerate().filter_map(|(k, piece)| {
            piece.as_ref().filter(|p| p.span.overlaps(near)).map(|p| (k, p))
        })
    };
    chain.sides().iter().find_map(|&side| {
        let (k, piece) = if side == Side::Right { beside().last() } else { beside().next() }?;
        let to = if side == Side::Right { piece.points.last() } else { piece.points.first() }?;
        join(&chain.end(side), to, side).map(|points| (k, side, points))
    })
}
