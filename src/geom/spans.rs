//! Spans -> Spans: unites, intersects and subtracts regions on raster lines, instead of polygon clipping.
//!
//! - A *span* is a half-open stretch `[start, end)` of a raster line. It is never empty.
//! - A *row* is all spans of one raster line: sorted, disjoint and not touching.
//! - [`Rows`] are the rows of one layer in one direction. All their spans are in one list, with the
//!   place where each row begins.
//!
//! Intersection and subtraction walk over two sorted rows at once, in linear time. Union sorts the
//! spans and joins those that touch. Regions are combined row by row.
//!
//! Dilation grows a span by a circle. On the row `m` lines away it grows by half the chord of the
//! circle at that distance; the grown spans are united. Between rows nothing is known, so that
//! this is exact on the lines only. Erosion is the dilation of what lies outside.

use crate::units::Coord;

/// A stretch of a raster line, `start < end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Span {
    /// Where it begins, along the line.
    pub start: Coord,
    /// Where it ends, along the line.
    pub end: Coord,
}

impl Span {
    /// The span from `start` to `end`, or none if that would be empty.
    #[must_use]
    pub fn new(start: Coord, end: Coord) -> Option<Self> {
        (start < end).then_some(Self { start, end })
    }

    /// Its length, grid units.
    #[must_use]
    pub fn len(self) -> i64 {
        i64::from(self.end) - i64::from(self.start)
    }

    /// Always `false`: spans are never empty. Clippy wants it beside `len`.
    #[must_use]
    pub fn is_empty(self) -> bool {
        false
    }

    /// Whether two spans share more than an end.
    #[must_use]
    pub fn overlaps(self, other: Self) -> bool {
        self.start < other.end && other.start < self.end
    }
}

/// Appends `span` to a row whose spans start no later, and joins it with the last one if they touch.
fn push(row: &mut Vec<Span>, base: usize, span: Span) {
    match row[base..].last_mut() {
        Some(last) if last.end >= span.start => last.end = last.end.max(span.end),
        _ => row.push(span),
    }
}

/// Appends the span from `start` to `end`, if it is not empty. `Vec::extend` with an option does the
/// same with three times the instructions.
#[inline]
fn append(row: &mut Vec<Span>, start: Coord, end: Coord) {
    if start < end {
        row.push(Span { start, end });
    }
}

/// Appends `a ∩ b` to `out`.
pub fn intersect(a: &[Span], b: &[Span], out: &mut Vec<Span>) {
    let (mut i, mut j) = (0, 0);
    while let (Some(p), Some(q)) = (a.get(i), b.get(j)) {
        append(out, p.start.max(q.start), p.end.min(q.end));
        if p.end <= q.end {
            i += 1;
        } else {
            j += 1;
        }
    }
}

/// Appends `a − b` to `out`.
pub fn subtract(a: &[Span], b: &[Span], out: &mut Vec<Span>) {
    let mut j = 0;
    for span in a {
        let mut start = span.start;
        while b.get(j).is_some_and(|q| q.end <= start) {
            j += 1;
        }
        let mut k = j;
        while let Some(q) = b.get(k).filter(|q| q.start < span.end) {
            append(out, start, q.start);
            start = start.max(q.end);
            k += 1;
        }
        append(out, start, span.end);
    }
}

/// Appends the union of `spans`, which may overlap and come in any order. Sorts `spans`.
pub fn merge(spans: &mut [Span], out: &mut Vec<Span>) {
    // Where they end does not matter to the union.
    if spans.len() > 1 {
        spans.sort_unstable_by_key(|span| span.start);
    }
    let base = out.len();
    for &span in spans.iter() {
        push(out, base, span);
    }
}

/// Appends `a ∪ b` to `out`.
pub fn unite(a: &[Span], b: &[Span], out: &mut Vec<Span>) {
    let base = out.len();
    let (mut a, mut b) = (a, b);
    while let ([p, after_p @ ..], [q, after_q @ ..]) = (a, b) {
        if p.start <= q.start {
            push(out, base, *p);
            a = after_p;
        } else {
            push(out, base, *q);
            b = after_q;
        }
    }
    a.iter().chain(b).for_each(|&span| push(out, base, span));
}

/// The total length of a row, grid units.
#[must_use]
pub fn total(row: &[Span]) -> i64 {
    row.iter().map(|span| span.len()).sum()
}

/// The rows of one layer in one direction: row `j` lies at `j` times the pitch.
/// Rows outside the stored range are empty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rows {
    first: i32,
    /// Where each row begins in `spans`, and where the last row ends.
    starts: Vec<u32>,
    spans: Vec<Span>,
}

impl Default for Rows {
    fn default() -> Self {
        Self::starting_at(0)
    }
}

impl Rows {
    /// No rows. The first one pushed will have index `first`.
    #[must_use]
    pub fn starting_at(first: i32) -> Self {
        Self { first, starts: vec![0], spans: Vec::new() }
    }

    /// No rows, with capacity for as many as `other` has. The first one pushed will have index
    /// `first`.
    #[must_use]
    pub fn with_room_of(other: &Self, first: i32) -> Self {
        Self::with_room(first, other.starts.len() - 1, other.spans.len())
    }

    /// No rows, with capacity for `rows` and `spans`. The first one pushed will have index `first`.
    #[must_use]
    pub fn with_room(first: i32, rows: usize, spans: usize) -> Self {
        let mut starts = Vec::with_capacity(rows + 1);
        starts.push(0);
        Self { first, starts, spans: Vec::with_capacity(spans) }
    }

    /// Appends the next row: `fill` appends its spans, sorted and disjoint.
    pub fn push_row(&mut self, fill: impl FnOnce(&mut Vec<Span>)) {
        fill(&mut self.spans);
        let end = u32::try_from(self.spans.len()).unwrap_or(u32::MAX);
        self.starts.push(end);
    }

    /// The indices of the stored rows.
    #[must_use]
    pub fn range(&self) -> std::ops::Range<i32> {
        let count = i32::try_from(self.starts.len() - 1).unwrap_or(i32::MAX);
        self.first..self.first.saturating_add(count)
    }

    /// The spans of row `j`.
    #[must_use]
    pub fn row(&self, j: i32) -> &[Span] {
        // The index of a row before the first wraps to one far after the last.
        let k = j.wrapping_sub(self.first) as u32 as usize;
        match self.starts.get(k..k + 2) {
            Some(&[start, end]) => &self.spans[start as usize..end as usize],
            _ => &[],
        }
    }

    /// All spans with the index of their row.
    pub fn iter(&self) -> impl Iterator<Item = (i32, &[Span])> {
        let row = |ends: &[u32]| &self.spans[ends[0] as usize..ends[1] as usize];
        self.range().zip(self.starts.windows(2).map(row))
    }

    /// Whether there is no span at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.spans.is_empty()
    }

    /// The total length of all spans, grid units.
    #[must_use]
    pub fn total(&self) -> i64 {
        total(&self.spans)
    }

    /// Combines two sets of rows with `op`, row by row, over the rows of `self`.
    #[must_use]
    pub fn combine(&self, other: &Self, op: impl Fn(&[Span], &[Span], &mut Vec<Span>)) -> Self {
        let mut out = Self::with_room_of(self, self.first);
        for (j, row) in self.iter() {
            out.push_row(|spans| op(row, other.row(j), spans));
        }
        out
    }

    /// The difference: these rows without those of `other`.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        self.combine(other, subtract)
    }

    /// The intersection of these rows and those of `other`.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        self.combine(other, intersect)
    }

    /// The union of these rows and those of `other`.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        if self.range().is_empty() {
            return other.clone();
        }
        if other.range().is_empty() {
            return self.clone();
        }
        let (a, b) = (self.range(), other.range());
        let rows = a.start.min(b.start)..a.end.max(b.end);
        let spans = self.spans.len() + other.spans.len();
        let mut out = Self::with_room(rows.start, rows.len(), spans);
        for j in rows {
            out.push_row(|spans| match (self.row(j), other.row(j)) {
                (only, []) | ([], only) => spans.extend_from_slice(only),
                (a, b) => unite(a, b, spans),
            });
        }
        out
    }

    /// The union of many sets of rows.
    #[must_use]
    pub fn united(all: &[&Self]) -> Self {
        match all {
            [] => Self::default(),
            [only] => (*only).clone(),
            _ => {
                // Halves, so that none is copied more often than the halves can be halved.
                let (some, others) = all.split_at(all.len() / 2);
                Self::united(some).or(&Self::united(others))
            }
        }
    }

    /// These rows with only the spans that `keep` accepts.
    #[must_use]
    pub fn filter(&self, keep: impl Fn(i32, Span) -> bool) -> Self {
        let mut out = Self::with_room_of(self, self.first);
        for (j, row) in self.iter() {
            out.push_row(|spans| spans.extend(row.iter().copied().filter(|&s| keep(j, s))));
        }
        out
    }

    /// Grows these rows, which are `pitch` apart, by `radius` in all directions. On each row within
    /// reach a span grows by half the chord of the circle.
    #[must_use]
    pub fn dilate(&self, radius: Coord, pitch: Coord) -> Self {
        if radius <= 0 || self.spans.is_empty() {
            return self.clone();
        }
        let reach = radius / pitch;
        let chords: Vec<Coord> = (0..=reach).map(|m| half_chord(radius, m * pitch)).collect();
        let rows = self.range();
        let mut out = Self::with_room_of(self, rows.start - reach);
        let grow = |s: &Span, by: Coord| Span { start: s.start - by, end: s.end + by };
        let mut grown = Vec::new();
        for j in rows.start - reach..rows.end + reach {
            grown.clear();
            grown.extend(self.row(j).iter().map(|s| grow(s, radius)));
            let own = grown.len();
            for (other, by) in around(j, &chords[1..]) {
                let others = self.row(other).iter().map(|s| grow(s, by));
                // A row's own spans grow most: they hold nearly all of the others.
                let mut k = 0;
                for span in others {
                    k += grown[k..own].iter().take_while(|s| s.end < span.end).count();
                    if k == own || span.start < grown[k].start {
                        grown.push(span);
                    }
                }
            }
            out.push_row(|spans| merge(&mut grown, spans));
        }
        out
    }

    /// Shrinks these rows, which are `pitch` apart, by `radius` in all directions: what stays is where
    /// the middle of a disc has room.
    #[must_use]
    pub fn erode(&self, radius: Coord, pitch: Coord) -> Self {
        if radius <= 0 {
            return self.clone();
        }
        let chords: Vec<Coord> =
            (0..=radius / pitch).map(|m| half_chord(radius, m * pitch)).collect();
        let mut out = Self::with_room_of(self, self.range().start);
        let (mut left, mut shrunk, mut both) = (Vec::new(), Vec::new(), Vec::new());
        for j in self.range() {
            left.clear();
            shrink(self.row(j), radius, &mut left);
            // The nearest rows take most: thin places are done after the first ones.
            for (other, by) in around(j, &chords[1..]) {
                if left.is_empty() {
                    break;
                }
                if holds(self.row(other), by, &left) {
                    continue;
                }
                shrunk.clear();
                shrink(self.row(other), by, &mut shrunk);
                both.clear();
                intersect(&left, &shrunk, &mut both);
                std::mem::swap(&mut left, &mut both);
            }
            out.push_row(|spans| spans.extend_from_slice(&left));
        }
        out
    }
}

/// The rows around row `j`, the nearest first, with the chord at the distance of each.
fn around(j: i32, chords: &[Coord]) -> impl Iterator<Item = (i32, Coord)> {
    (1..).zip(chords).flat_map(move |(m, &by)| [(j - m, by), (j + m, by)])
}

/// Whether a row, without `by` at both ends of its spans, holds all `parts`.
fn holds(row: &[Span], by: Coord, parts: &[Span]) -> bool {
    let mut rest = row;
    parts.iter().all(|part| {
        let before = rest.iter().take_while(|s| s.end - by < part.end).count();
        rest = &rest[before..];
        rest.first().is_some_and(|s| s.start + by <= part.start)
    })
}

/// Appends the spans of a row without `by` at both ends.
fn shrink(row: &[Span], by: Coord, out: &mut Vec<Span>) {
    row.iter().for_each(|s| append(out, s.start + by, s.end - by));
}

/// Half the chord of a circle at distance `d` from its centre, rounded down.
fn half_chord(radius: Coord, d: Coord) -> Coord {
    let (r, d) = (f64::from(radius), f64::from(d));
    (r * r - d * d).max(0.0).sqrt() as Coord
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIZE: i32 = 64;

    fn row(mask: u64) -> Vec<Span> {
        let mut spans = Vec::new();
        let mut cells: Vec<Span> = (0..SIZE)
            .filter(|i| mask >> i & 1 == 1)
            .map(|i| Span { start: i, end: i + 1 })
            .collect();
        merge(&mut cells, &mut spans);
        spans
    }

    fn mask(row: &[Span]) -> u64 {
        row.iter().flat_map(|s| s.start..s.end).fold(0, |m, i| m | 1 << i)
    }

    fn is_row(row: &[Span]) -> bool {
        row.iter().all(|s| s.start < s.end) && row.windows(2).all(|w| w[0].end < w[1].start)
    }

    proptest! {
        #[test]
        fn set_operations_agree_with_bitmaps(a: u64, b: u64) {
            let (ra, rb) = (row(a), row(b));
            let mut out = Vec::new();
            intersect(&ra, &rb, &mut out);
            prop_assert_eq!(mask(&out), a & b);
            prop_assert!(is_row(&out));
            out.clear();
            subtract(&ra, &rb, &mut out);
            prop_assert_eq!(mask(&out), a & !b);
            prop_assert!(is_row(&out));
            out.clear();
            merge(&mut [ra, rb].concat(), &mut out);
            prop_assert_eq!(mask(&out), a | b);
            prop_assert!(is_row(&out));
            prop_assert_eq!(total(&out), i64::from((a | b).count_ones()));
        }

        #[test]
        fn rows_combine_row_by_row(a in prop::collection::vec(any::<u64>(), 0..6),
                                   b in prop::collection::vec(any::<u64>(), 0..6),
                                   shift in -4i32..4) {
            let make = |first: i32, masks: &[u64]| {
                let mut rows = Rows::starting_at(first);
                for m in masks { rows.push_row(|out| out.extend(row(*m))); }
                rows
            };
            let (ra, rb) = (make(0, &a), make(shift, &b));
            for j in -8..16 {
                let (ma, mb) = (mask(ra.row(j)), mask(rb.row(j)));
                prop_assert_eq!(mask(ra.or(&rb).row(j)), ma | mb);
                prop_assert_eq!(mask(Rows::united(&[&ra, &rb, &ra]).row(j)), ma | mb);
                prop_assert_eq!(mask(ra.and(&rb).row(j)), ma & mb);
                prop_assert_eq!(mask(ra.minus(&rb).row(j)), ma & !mb);
            }
        }
    }

    #[test]
    fn dilation_reaches_like_a_circle() {
        let mut rows = Rows::starting_at(0);
        rows.push_row(|out| out.push(Span { start: 0, end: 100 }));
        let grown = rows.dilate(50, 40);
        assert_eq!(grown.range(), -1..2);
        assert_eq!(grown.row(0), [Span { start: -50, end: 150 }]);
        assert_eq!(grown.row(1), [Span { start: -30, end: 130 }]);
    }

    #[test]
    fn a_square_is_eroded_on_all_sides() {
        let mut square = Rows::starting_at(0);
        (0..10).for_each(|_| square.push_row(|out| out.push(Span { start: 0, end: 100 })));
        let core = square.erode(25, 10);
        let first = core.iter().find(|(_, row)| !row.is_empty());
        assert_eq!(first, Some((2, &[Span { start: 25, end: 75 }][..])));
        assert!(square.erode(60, 10).is_empty());
    }

    proptest! {
        #[test]
        fn erosion_is_the_dilation_of_what_lies_outside(
            masks in prop::collection::vec(any::<u64>(), 1..9), radius in 0..24_i32
        ) {
            let mut rows = Rows::starting_at(-3);
            // Few gaps, so that something is left.
            masks.iter().for_each(|m| rows.push_row(|out| out.extend(row(m | m << 7 | m >> 9))));
            let whole = [Span { start: -100, end: SIZE + 100 }];
            let mut outside = Rows::starting_at(-30);
            (-30..30).for_each(|j| outside.push_row(|out| subtract(&whole, rows.row(j), out)));
            let expected = rows.minus(&outside.dilate(radius, 4));
            let eroded = rows.erode(radius, 4);
            for j in rows.range() {
                prop_assert_eq!(eroded.row(j), expected.row(j));
            }
        }
    }
}
