//! Rows -> Pieces: which spans hang together.
//!
//! Words: two spans on neighbouring rows *touch* if they overlap. A *piece* is all spans that hang
//! together by touching.
//!
//! Algorithm: walk through the rows. Each span joins the pieces of all spans that it touches on the
//! row before, by [`Sets`]; a second walk numbers the pieces in the order of their first
//! spans.

use super::params::SupportParams;
use crate::geom::section::Section;
use crate::geom::sets::Sets;
use crate::geom::spans::{Rows, Span, intersect, total};
use crate::units::{Coord, to_mm};

/// Smaller pieces of support on a layer are dropped, in squares of a line's width. They hold
/// nothing, and each costs two travels.
const LEAST_AREA: i64 = 6;

/// Places narrower than this are not printed where there is an outline, in hundredths of a line's
/// width: its two sides would lie on each other.
const NARROW: Coord = 95;

/// The piece of each span, in the order of [`Rows::iter`].
pub(super) struct Pieces {
    labels: Vec<usize>,
    count: usize,
}

impl Pieces {
    /// Finds the pieces of `rows`.
    pub(super) fn new(rows: &Rows) -> Self {
        let mut sets = Sets::new(rows.iter().map(|(_, row)| row.len()).sum());
        let (mut before, mut first): (&[Span], usize) = (&[], 0);
        for (_, row) in rows.iter() {
            let next = first + before.len();
            touching(before, row, |a, b| _ = sets.join(first + a, next + b));
            (before, first) = (row, next);
        }
        let mut names = vec![usize::MAX; sets.len()];
        let mut count = 0;
        let labels = (0..sets.len()).map(|k| {
            let name = &mut names[sets.root(k)];
            if *name == usize::MAX {
                *name = count;
                count += 1;
            }
            *name
        });
        Self { labels: labels.collect(), count }
    }

    /// Number of pieces.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Of the rows that the pieces were found in, those pieces that `keep` accepts.
    pub(super) fn keep(&self, rows: &Rows, keep: impl Fn(usize) -> bool) -> Rows {
        let mut out = Rows::with_room_of(rows, rows.range().start);
        let mut labels = self.labels.iter();
        for (_, row) in rows.iter() {
            let kept = row.iter().zip(labels.by_ref()).filter(|(_, label)| keep(**label));
            out.push_row(|spans| spans.extend(kept.map(|(span, _)| *span)));
        }
        out
    }

    /// Tells `meet` of each piece and each span of `others` that overlap on the same row. `meet`
    /// gets the piece and the index of the other span, in the order of [`Rows::iter`].
    pub(super) fn meeting(&self, rows: &Rows, others: &Rows, mut meet: impl FnMut(usize, usize)) {
        let from = others.range().start;
        let starts: Vec<usize> = others
            .iter()
            .scan(0, |sum, (_, row)| Some(std::mem::replace(sum, *sum + row.len())))
            .collect();
        let mut first = 0;
        for (j, row) in rows.iter() {
            let index = usize::try_from(j - from).ok().and_then(|k| starts.get(k));
            if let Some(&start) = index {
                touching(row, others.row(j), |a, b| meet(self.labels[first + a], start + b));
            }
            first += row.len();
        }
    }

    /// Adds to the sum of each piece the length that its spans share with `others`.
    pub(super) fn shared(&self, rows: &Rows, others: &Rows, sums: &mut [i64]) {
        let mut labels = self.labels.iter();
        let mut both = Vec::new();
        for (j, row) in rows.iter() {
            for (span, label) in row.iter().zip(labels.by_ref()) {
                both.clear();
                intersect(&[*span], others.row(j), &mut both);
                sums[*label] += total(&both);
            }
        }
    }

    /// The label of a span, by its index in the order of [`Rows::iter`].
    pub(super) fn of(&self, span: usize) -> usize {
        self.labels[span]
    }

    /// The length of the spans of each piece, grid units.
    pub(super) fn lengths(&self, rows: &Rows) -> Vec<i64> {
        let mut sums = vec![0; self.count];
        let spans = rows.iter().flat_map(|(_, row)| row);
        spans.zip(&self.labels).for_each(|(span, label)| sums[*label] += span.len());
        sums
    }

    /// The section of each piece.
    pub(super) fn sections(&self, rows: &Rows, pitch: Coord) -> Vec<Section> {
        let mut sections: Vec<Option<Section>> = vec![None; self.count];
        let spans = rows.iter().flat_map(|(j, row)| row.iter().map(move |&span| (j, span)));
        for ((j, span), label) in spans.zip(&self.labels) {
            let y = to_mm(j * pitch);
            let near = || Section::near([to_mm(span.start), y]);
            sections[*label].get_or_insert_with(near).add(span, y, to_mm(pitch));
        }
        sections.into_iter().map(Option::unwrap_or_default).collect()
    }
}

/// Calls `meet` with the indices of all spans of two rows that overlap.
fn touching(a: &[Span], b: &[Span], mut meet: impl FnMut(usize, usize)) {
    let (mut i, mut j) = (0, 0);
    while let (Some(p), Some(q)) = (a.get(i), b.get(j)) {
        if p.overlaps(*q) {
            meet(i, j);
        }
        if p.end <= q.end {
            i += 1;
        } else {
            j += 1;
        }
    }
}

/// The rows without pieces that are too small to hold anything.
pub(super) fn without_specks(rows: &Rows, params: &SupportParams) -> Rows {
    let pieces = Pieces::new(rows);
    let lengths = pieces.lengths(rows);
    let (w, pitch) = (i64::from(params.least), i64::from(params.raster().pitch));
    pieces.keep(rows, |piece| lengths[piece] * pitch >= LEAST_AREA * w * w)
}

/// The rows without places that are narrower than a bead, and without small pieces between these.
pub(super) fn without_narrow(rows: &Rows, params: &SupportParams) -> Rows {
    let (half, pitch) = (params.least * NARROW / 200, params.raster().pitch);
    without_specks(&rows.erode(half, pitch).dilate(half, pitch).and(rows), params)
}

/// `rows`, which are `pitch` apart, on the raster of the same pitch that is turned by 90°: its row
/// `m` lies at `u = −m · pitch`. Spans end on rows, so that they are shorter by up to two pitches.
pub(super) fn turned(rows: &Rows, pitch: Coord) -> Rows {
    across(rows, pitch, pitch)
}

/// As [`turned`], on rows that are `to` apart.
pub(super) fn across(rows: &Rows, pitch: Coord, to: Coord) -> Rows {
    let spans = || rows.iter().flat_map(|(_, row)| row);
    let (Some(low), Some(high)) = (spans().map(|s| s.start).min(), spans().map(|s| s.end).max())
    else {
        return Rows::default();
    };
    // Rows of the new raster that a stretch of u crosses.
    let crossed = |s: &Span| (-s.end).div_euclid(to) + 1..(-s.start).div_euclid(to) + 1;
    let all = crossed(&Span { start: low, end: high });
    let mut columns: Vec<Vec<Span>> = vec![Vec::new(); all.len()];
    for (j, row) in rows.iter() {
        for m in row.iter().flat_map(crossed) {
            let column = &mut columns[(m - all.start) as usize];
            match column.last_mut() {
                Some(last) if last.end == (j - 1) * pitch => last.end = j * pitch,
                _ => column.push(Span { start: j * pitch, end: j * pitch }),
            }
        }
    }
    let mut out = Rows::starting_at(all.start);
    for column in columns {
        out.push_row(|out| out.extend(column.into_iter().filter(|s| s.start < s.end)));
    }
    out
}

/// A body with what it needs to be held by lines: those pieces of both that have some of the body in them.
pub(super) fn with_lines(body: &Rows, beside: &Rows) -> Rows {
    if beside.is_empty() {
        return body.clone();
    }
    let both = body.or(beside);
    let pieces = Pieces::new(&both);
    let mut has_body = vec![false; pieces.count()];
    pieces.meeting(&both, body, |piece, _| has_body[piece] = true);
    pieces.keep(&both, |piece| has_body[piece])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rows(list: &[&[(Coord, Coord)]]) -> Rows {
        let mut rows = Rows::starting_at(0);
        for row in list {
            rows.push_row(|out| out.extend(row.iter().map(|&(start, end)| Span { start, end })));
        }
        rows
    }

    #[test]
    fn arms_that_meet_are_one_piece() {
        let fork = rows(&[&[(0, 10), (20, 30)], &[(0, 30), (50, 60)], &[(40, 50)]]);
        let pieces = Pieces::new(&fork);
        assert_eq!(pieces.labels, [0, 0, 0, 1, 2]);
        assert_eq!(pieces.lengths(&fork), [50, 10, 10]);
        assert_eq!(pieces.keep(&fork, |label| label == 1), rows(&[&[], &[(50, 60)], &[]]));
    }

    proptest! {
        #[test]
        fn pieces_touch_no_other(masks in prop::collection::vec(any::<u16>(), 1..8)) {
            let mut all = Rows::starting_at(-2);
            for mask in masks {
                let cells = (0..16).filter(|i| mask >> i & 1 == 1);
                let mut cells: Vec<Span> =
                    cells.map(|i| Span { start: 2 * i, end: 2 * i + 2 }).collect();
                all.push_row(|out| crate::geom::spans::merge(&mut cells, out));
            }
            let pieces = Pieces::new(&all);
            let each: Vec<Rows> =
                (0..pieces.count()).map(|one| pieces.keep(&all, |label| label == one)).collect();
            prop_assert_eq!(each.iter().map(Rows::total).sum::<i64>(), all.total());
            for (k, one) in each.iter().enumerate() {
                prop_assert_eq!(Pieces::new(one).count(), 1);
                for other in &each[k + 1..] {
                    let both = Pieces::new(&one.or(other));
                    prop_assert_eq!(both.count(), 2);
                }
            }
        }
    }
}
