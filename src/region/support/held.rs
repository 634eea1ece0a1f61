//! Rows -> which places lie near a line of support, and what must be added to have all of them do.
//!
//! Words: a place is *held* by a printed line if it lies near it, with support on all rows between.
//! Other places are *loose*: a *cap* beyond the last line of a piece, or a strip between two lines.
//! They are grown until they reach a line.

use crate::geom::spans::{Rows, Span, intersect, merge, subtract};
use crate::pattern::Lines;

/// How far a piece may reach beyond its lines, in hundredths of their spacing. What lies on a longer
/// overhang sags; with less, hardly any piece is held by its lines.
const BEYOND: i32 = 60;

/// What must be added to `rows` so that their loose places reach a line.
pub(super) fn to_lines(lines: &Lines, rows: &Rows) -> Rows {
    let loose = loose(lines, rows);
    if loose.is_empty() {
        return loose;
    }
    let (range, stride) = (loose.range(), lines.stride);
    let first = range.start - stride;
    let mut added: Vec<Vec<Span>> = vec![Vec::new(); range.len() + 2 * stride as usize];
    for (j, row) in loose.iter() {
        // Rows from the last line, which is too far: to the next one. As well in the other direction.
        let past = (j - lines.offset).rem_euclid(stride);
        let way = if past > reach(lines) {
            j..=j - past + stride
        } else if stride - past > reach(lines) {
            j - past..=j
        } else {
            continue;
        };
        way.for_each(|other| added[(other - first) as usize].extend_from_slice(row));
    }
    let mut out = Rows::starting_at(first);
    added.iter_mut().for_each(|spans| out.push_row(|row| merge(spans, row)));
    out
}

/// The number of rows that a line holds to both of its sides.
pub(super) fn reach(lines: &Lines) -> i32 {
    BEYOND * lines.stride / 100
}

/// The places of `rows` that are loose, but for short ones, over which lines across reach.
pub(super) fn loose(lines: &Lines, rows: &Rows) -> Rows {
    let up = held(lines, rows, rows.range());
    let mut down = held(lines, rows, rows.range().rev());
    down.reverse();
    let short = i64::from(reach(lines) * lines.raster.pitch);
    let (mut both, mut merged, mut left) = (Vec::new(), Vec::new(), Vec::new());
    let mut out = Rows::starting_at(rows.range().start);
    for ((_, row), (up, down)) in rows.iter().zip(up.iter().zip(&down)) {
        [&mut both, &mut merged, &mut left].into_iter().for_each(Vec::clear);
        both.extend(up.iter().chain(down));
        merge(&mut both, &mut merged);
        subtract(row, &merged, &mut left);
        out.push_row(|spans| spans.extend(left.iter().filter(|span| span.len() > short)));
    }
    out
}

/// What lines hold on each of the rows `order`, going away from them. It grows to both sides by as
/// much as it goes on.
fn held(lines: &Lines, rows: &Rows, order: impl Iterator<Item = i32>) -> Vec<Vec<Span>> {
    let (wider, mut steps) = (lines.raster.pitch, 0);
    let (mut wide, mut merged) = (Vec::new(), Vec::new());
    let mut out: Vec<Vec<Span>> = Vec::with_capacity(rows.range().len());
    for j in order {
        let mut here = Vec::new();
        steps += 1;
        if lines.prints(j) {
            steps = 0;
            // Shorter ones than a line is wide are not printed.
            here.extend(rows.row(j).iter().filter(|span| span.len() >= i64::from(2 * wider)));
        } else if let Some(before) = out.last().filter(|_| steps <= reach(lines)) {
            let grown = |s: &Span| Span { start: s.start - wider, end: s.end + wider };
            wide.clear();
            merged.clear();
            wide.extend(before.iter().map(grown));
            merge(&mut wide, &mut merged);
            intersect(rows.row(j), &merged, &mut here);
        }
        out.push(here);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_held(lines: &Lines, piece: &Rows) -> bool {
        loose(lines, piece).is_empty()
    }

    /// A rectangle from row `from` to row `to`.
    fn block(from: i32, to: i32) -> Rows {
        let mut rows = Rows::starting_at(from);
        (from..to).for_each(|_| rows.push_row(|out| out.push(Span { start: 0, end: 50_000 })));
        rows
    }

    #[test]
    fn a_high_cap_reaches_the_next_line_and_a_flat_one_stays() {
        let lines = Lines::new(0.0, 30_000, 2_000);
        assert_eq!(lines.stride, 15);
        for (from, to, held) in [(-2, 41, false), (-2, 40, true), (-9, 31, true), (-10, 31, false)]
        {
            let piece = block(from, to);
            assert_eq!(is_held(&lines, &piece), held, "{from}..{to}");
            let more = to_lines(&lines, &piece);
            assert_eq!(more.is_empty(), held, "{from}..{to}");
            assert!(is_held(&lines, &piece.or(&more)), "{from}..{to}");
        }
    }

    #[test]
    fn a_strip_between_lines_is_not_held_by_the_end_of_another() {
        let lines = Lines::new(0.0, 30_000, 2_000);
        // A foot that meets a line, and an arm of 5 cm that does not.
        let mut angle = Rows::starting_at(-3);
        for j in -3..12 {
            let end = if j < 3 { 6_000 } else { 500_000 };
            angle.push_row(|out| out.push(Span { start: 0, end }));
        }
        assert!(!is_held(&lines, &angle));
        assert!(is_held(&lines, &angle.or(&to_lines(&lines, &angle))));
    }
}
