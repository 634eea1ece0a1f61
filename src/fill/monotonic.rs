//! Zigzags of a top -> zigzags in an order in which each line lies beside those before it.
//!
//! Light falls differently on a line that is laid between two others than on one that is laid beside the
//! last. So all lines of a top are printed in one direction of advance: a line only after all those of the
//! row before that it touches.
//!
//! 1. Zigzags go from row to row. Where rows divide or meet, around a hole, a zigzag is cut. So a
//!    piece waits for others only at its first line, and others wait only for its last.
//! 2. Of the pieces that wait for none the one nearest to the end of the last is next.

use crate::geom::spans::Span;
use crate::pattern::zigzag::{Link, Side};
use crate::units::Coord;
use std::collections::BTreeMap;

/// A line: its row and its index there.
type Place = (i32, usize);

/// The pieces of `zigzags` in the order in which they are printed. Lines are `pitch` apart.
#[must_use]
pub(super) fn in_order(zigzags: Vec<Vec<Link>>, pitch: Coord) -> Vec<Vec<Link>> {
    let pieces = pieces(zigzags, pitch);
    let heads = pieces.iter().enumerate().map(|(k, piece)| (place(&piece[0]), k));
    let heads: BTreeMap<Place, usize> = heads.collect();
    let rows = rows(&pieces);
    let mut waits = vec![0; pieces.len()];
    let mut frees = vec![Vec::new(); pieces.len()];
    for (k, piece) in pieces.iter().enumerate() {
        for above in piece.last().into_iter().flat_map(|last| beside(&rows, last, 1, pitch)) {
            if let Some(&next) = heads.get(&above).filter(|next| **next != k) {
                frees[k].push(next);
                waits[next] += 1;
            }
        }
    }
    let mut free: Vec<usize> = (0..pieces.len()).filter(|&k| waits[k] == 0).collect();
    let mut pieces: Vec<Option<Vec<Link>>> = pieces.into_iter().map(Some).collect();
    let (mut out, mut at) = (Vec::with_capacity(pieces.len()), None);
    while let Some(pick) = nearest(&free, &pieces, at, pitch) {
        let k = free.swap_remove(pick);
        let Some(mut piece) = pieces[k].take() else { continue };
        turn(&mut piece, at);
        at = piece.last().map(|last| (last.from.other().of(last.span), last.row));
        out.push(piece);
        for &next in &frees[k] {
            waits[next] -= 1;
            if waits[next] == 0 {
                free.push(next);
            }
        }
    }
    out
}

/// Zigzags, cut where rows divide or meet.
fn pieces(zigzags: Vec<Vec<Link>>, pitch: Coord) -> Vec<Vec<Link>> {
    let rows = rows(&zigzags);
    let parts = |link: &Link, by: i32| beside(&rows, link, by, pitch).count() > 1;
    let mut out: Vec<Vec<Link>> = Vec::with_capacity(zigzags.len());
    for zigzag in zigzags {
        let mut divides = true;
        for mut link in zigzag {
            let cut = divides || parts(&link, -1);
            divides = parts(&link, 1);
            match out.last_mut().filter(|_| !cut) {
                Some(piece) => piece.push(link),
                None => {
                    link.join.clear();
                    out.push(vec![link]);
                }
            }
        }
    }
    out
}

/// The lines of each row, with their indices.
type Lines = BTreeMap<i32, Vec<(usize, Span)>>;

fn rows(zigzags: &[Vec<Link>]) -> Lines {
    let mut rows = Lines::new();
    for link in zigzags.iter().flatten() {
        rows.entry(link.row).or_default().push((link.index, link.span));
    }
    rows
}

fn place(link: &Link) -> Place {
    (link.row, link.index)
}

/// The lines of the row `by` further that `link` touches, or nearly.
fn beside<'a>(
    rows: &'a Lines,
    link: &'a Link,
    by: i32,
    slack: Coord,
) -> impl Iterator<Item = Place> + 'a {
    let (row, span) = (link.row + by, link.span);
    let touches =
        move |other: Span| other.start < span.end + slack && span.start < other.end + slack;
    let lines = rows.get(&row).into_iter().flatten();
    lines.filter(move |(_, other)| touches(*other)).map(move |(index, _)| (row, *index))
}

/// Which of the pieces that are free begins nearest to `at`; without that, the first.
fn nearest(
    free: &[usize],
    pieces: &[Option<Vec<Link>>],
    at: Option<(Coord, i32)>,
    pitch: Coord,
) -> Option<usize> {
    let far = |k: usize| {
        let (Some((u, row)), Some(piece)) = (at, &pieces[k]) else { return 0 };
        let first = &piece[0];
        let end = |side: Side| i64::from(side.of(first.span) - u).abs();
        let along =
            if piece.len() == 1 { end(Side::Left).min(end(Side::Right)) } else { end(first.from) };
        let across = i64::from(first.row - row) * i64::from(pitch);
        along * along + across * across
    };
    free.iter().enumerate().min_by_key(|&(_, &k)| (far(k), k)).map(|(pick, _)| pick)
}

/// Lets a piece of one line begin at its end nearer to `at`.
fn turn(piece: &mut [Link], at: Option<(Coord, i32)>) {
    if let ([only], Some((u, _))) = (piece, at) {
        let [left, right] = [Side::Left, Side::Right].map(|side| (side.of(only.span) - u).abs());
        only.from = if left <= right { Side::Left } else { Side::Right };
    }
}
