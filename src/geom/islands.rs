//! Rows -> Islands: which spans hang together from row to row (connected components).
//!
//! Spans of neighbouring rows belong together if they share a place along the lines. Ends that only
//! touch count: rounding must not split an island.

use super::Point;
use super::sets::Sets;
use super::spans::{Rows, Span};
use crate::units::Coord;

/// The spans of some rows, divided into islands.
#[derive(Debug)]
pub struct Islands<'a> {
    rows: &'a Rows,
    /// Number of spans before each row.
    before: Vec<usize>,
    /// The island of each span, in the order of the rows.
    labels: Vec<usize>,
    count: usize,
}

impl<'a> Islands<'a> {
    /// Divides `rows`. Islands are numbered in the order of their first spans.
    #[must_use]
    pub fn new(rows: &'a Rows) -> Self {
        let (mut before, mut sets) = (Vec::with_capacity(rows.range().len()), Sets::default());
        let mut last: (usize, &[Span]) = (0, &[]);
        for (_, row) in rows.iter() {
            let first = sets.len();
            before.push(first);
            row.iter().for_each(|_| _ = sets.add());
            meet(last, (first, row), &mut sets);
            last = (first, row);
        }
        let mut labels = vec![0; sets.len()];
        let mut count = 0;
        // A root is the least number of its set.
        for k in 0..sets.len() {
            let root = sets.root(k);
            labels[k] = if root == k { count } else { labels[root] };
            count += usize::from(root == k);
        }
        Self { rows, before, labels, count }
    }

    /// Number of islands.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The islands of row `j`, span by span.
    #[must_use]
    pub fn row(&self, j: i32) -> &[usize] {
        let index = usize::try_from(j - self.rows.range().start).ok();
        let Some(&first) = index.and_then(|k| self.before.get(k)) else { return &[] };
        &self.labels[first..first + self.rows.row(j).len()]
    }

    /// The island at `u` on row `j`.
    #[must_use]
    pub fn at(&self, j: i32, u: Coord) -> Option<usize> {
        let row = self.rows.row(j);
        let k = row.partition_point(|s| s.end < u);
        row.get(k).filter(|s| s.start <= u).map(|_| self.row(j)[k])
    }

    /// The island at a place, on rows that are `pitch` apart: that of the row below it, or else of the row above.
    #[must_use]
    pub fn beside(&self, p: Point, pitch: Coord) -> Option<usize> {
        let row = p.y.div_euclid(pitch);
        self.at(row, p.x).or_else(|| self.at(row + 1, p.x))
    }

    /// Whether each island has a span, given with its row, that `is` accepts.
    #[must_use]
    pub fn any(&self, is: impl Fn(i32, Span) -> bool) -> Vec<bool> {
        let mut any = vec![false; self.count];
        for (j, row) in self.rows.iter() {
            row.iter().zip(self.row(j)).for_each(|(span, island)| any[*island] |= is(j, *span));
        }
        any
    }

    /// The length of each island's spans: its area, divided by the distance of the rows.
    #[must_use]
    pub fn lengths(&self) -> Vec<i64> {
        let mut lengths = vec![0; self.count];
        let spans = self.rows.iter().flat_map(|(_, row)| row);
        self.labels.iter().zip(spans).for_each(|(island, span)| lengths[*island] += span.len());
        lengths
    }

    /// The rows of the islands that `keep` accepts.
    #[must_use]
    pub fn select(&self, keep: impl Fn(usize) -> bool) -> Rows {
        let mut out = Rows::with_room_of(self.rows, self.rows.range().start);
        for (j, row) in self.rows.iter() {
            let kept = row.iter().zip(self.row(j)).filter(|(_, island)| keep(**island));
            out.push_row(|spans| spans.extend(kept.map(|(span, _)| *span)));
        }
        out
    }
}

/// Joins the spans of two neighbouring rows that meet. Each row comes with the number of its first
/// span.
fn meet((a, lower): (usize, &[Span]), (b, upper): (usize, &[Span]), sets: &mut Sets) {
    let (mut i, mut j) = (0, 0);
    while let (Some(p), Some(q)) = (lower.get(i), upper.get(j)) {
        if p.start <= q.end && q.start <= p.end {
            sets.join(a + i, b + j);
        }
        if p.end <= q.end {
            i += 1;
        } else {
            j += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(rows: &[&[(Coord, Coord)]]) -> Rows {
        let mut out = Rows::starting_at(3);
        for row in rows {
            out.push_row(|spans| spans.extend(row.iter().map(|&(start, end)| Span { start, end })));
        }
        out
    }

    #[test]
    fn a_fork_is_one_island_and_what_lies_beside_it_another() {
        let rows = rows(&[&[(0, 9), (20, 29), (50, 60)], &[(0, 29)], &[(0, 5), (55, 60)]]);
        let islands = Islands::new(&rows);
        assert_eq!(islands.count(), 3);
        assert_eq!(
            [3, 4, 5].map(|j| islands.row(j).to_vec()),
            [vec![0, 0, 1], vec![0], vec![0, 2]]
        );
        assert_eq!((islands.at(3, 55), islands.at(3, 40), islands.at(9, 0)), (Some(1), None, None));
        assert_eq!(islands.select(|k| k == 0).total(), 9 + 9 + 29 + 5);
    }

    #[test]
    fn rows_that_only_touch_hang_together() {
        let rows = rows(&[&[(0, 10)], &[(10, 20)], &[], &[(10, 20)]]);
        assert_eq!(Islands::new(&rows).count(), 2, "an empty row separates");
    }
}
