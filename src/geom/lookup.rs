//! Rows and a place -> the span there: looked up, since a row across a plate has spans of all parts on it.

use super::spans::{Rows, Span};
use crate::units::Coord;

impl Rows {
    /// The span of row `j` that holds a place, its ends included.
    #[must_use]
    pub fn span_at(&self, j: i32, at: Coord) -> Option<Span> {
        let row = self.row(j);
        let next = row.partition_point(|span| span.end < at);
        row.get(next).copied().filter(|span| span.start <= at)
    }

    /// The first span of row `j` that overlaps another.
    #[must_use]
    pub fn overlapping(&self, j: i32, other: Span) -> Option<Span> {
        let row = self.row(j);
        let next = row.partition_point(|span| span.end <= other.start);
        row.get(next).copied().filter(|span| span.overlaps(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_looked_up_in_a_row_is_what_a_search_finds(
            steps in prop::collection::vec((1..4_i32, 1..4_i32), 0..9),
            at in -2..60_i32, from in -2..60_i32, by in 1..9_i32,
        ) {
            let mut end = 0;
            let spans: Vec<Span> = steps.into_iter().map(|(gap, long)| {
                let start = end + gap;
                end = start + long;
                Span { start, end }
            }).collect();
            let mut rows = Rows::starting_at(3);
            rows.push_row(|out| out.extend_from_slice(&spans));
            let search = |is: &dyn Fn(&Span) -> bool| spans.iter().copied().find(|span| is(span));
            prop_assert_eq!(rows.span_at(3, at), search(&|s| s.start <= at && at <= s.end));
            let other = Span { start: from, end: from + by };
            prop_assert_eq!(rows.overlapping(3, other), search(&|span| span.overlaps(other)));
            prop_assert_eq!((rows.span_at(4, at), rows.overlapping(2, other)), (None, None));
        }
    }
}
