//! Capsules -> Rows: what lines cover of the bed, as spans of rows; and how to grow and shrink it.
//!
//! Words used here: the rows of a *lattice* lie a *pitch* apart, row `j` from `j` to `j + 1` pitches;
//! what its middle line crosses counts for the row; to *open* an area is to shrink and grow it
//! again: what is narrower disappears; a *patch* is an area whose spans touch, corners included.
//!
//! Along a row spans are exact to a tenth of a micrometre; across, an area is as exact as the rows are
//! dense. A section of a model has few spans in a row, however wide it is: booleans, and all that
//! grows and shrinks, cost what there are edges, not what there is area.

use super::capsule::{Capsule, Flanks};
use crate::geom::sets::Sets;
use crate::geom::spans::{Rows, Span, intersect, merge, unite};
use crate::units::{Coord, UNITS_PER_MM, to_mm, to_units};
use std::ops::Range;

/// Where rows lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lattice {
    /// Distance of the rows, grid units.
    pitch: Coord,
}

/// A patch of spans that touch one another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Patch {
    /// mm².
    pub(super) area: f64,
    /// A place in it: the middle of its longest span, mm.
    pub(super) at: [f64; 2],
    longest: i64,
}

impl Lattice {
    /// Rows `pitch` mm apart, or more if `side` mm of them were more than `most`.
    pub(super) fn new(pitch: f64, side: f64, most: f64) -> Self {
        Self { pitch: to_units(pitch.max(side / most)).max(1) }
    }

    /// Rows so many times as far apart.
    pub(super) fn coarser(self, times: Coord) -> Self {
        Self { pitch: self.pitch.saturating_mul(times) }
    }

    /// Distance of the rows, mm.
    pub(super) fn pitch(self) -> f64 {
        to_mm(self.pitch)
    }

    /// The rows whose middles lie in `from..to`, mm.
    pub(super) fn range(self, from: f64, to: f64) -> std::ops::Range<i32> {
        // Rounded up, which `f64::ceil` does by a call on some processors.
        let first = |at: f64| {
            let at = at / self.pitch() - 0.5;
            let towards_zero = at as i32;
            towards_zero + i32::from(at > f64::from(towards_zero))
        };
        first(from)..first(to)
    }

    /// Where the middle of a row lies, mm.
    pub(super) fn middle(self, j: i32) -> f64 {
        (f64::from(j) + 0.5) * self.pitch()
    }

    /// Area, mm².
    pub(super) fn area(self, rows: &Rows) -> f64 {
        rows.total() as f64 / UNITS_PER_MM * self.pitch()
    }

    /// Whether an area holds a place.
    pub(super) fn has(self, rows: &Rows, at: [f64; 2]) -> bool {
        let row = rows.row((at[1] / self.pitch()).floor() as i32);
        let x = to_units(at[0]);
        let next = row.partition_point(|span| span.end <= x);
        row.get(next).is_some_and(|span| span.start <= x)
    }

    /// What capsules cover.
    pub(super) fn draw(self, capsules: impl Iterator<Item = Capsule>) -> Rows {
        self.draw_where(capsules, |_, _| true)
    }

    /// What capsules cover of an area and beside it: less than all of it, where only that is asked for.
    pub(super) fn draw_on(self, area: &Rows, capsules: impl Iterator<Item = Capsule>) -> Rows {
        self.draw_where(capsules, |j, span| area.overlapping(j, span).is_some())
    }

    fn draw_where(
        self,
        capsules: impl Iterator<Item = Capsule>,
        is_asked: impl Fn(i32, Span) -> bool,
    ) -> Rows {
        let mut drawn: Vec<(Range<i32>, Flanks)> = Vec::with_capacity(capsules.size_hint().0);
        for capsule in capsules {
            let (low, high) = capsule.extent();
            let rows = self.range(low[1], high[1]);
            if !rows.is_empty() {
                drawn.push((rows, capsule.flanks()));
            }
        }
        let first = drawn.iter().map(|(rows, _)| rows.start).min().unwrap_or(0);
        let end = drawn.iter().map(|(rows, _)| rows.end).max().unwrap_or(first);
        // Where capsules begin and end, from row to row: how many each row has.
        let mut counts = vec![0_i32; (end - first) as usize + 1];
        for (rows, _) in &drawn {
            counts[(rows.start - first) as usize] += 1;
            counts[(rows.end - first) as usize] -= 1;
        }
        let (mut here, mut sum) = (0, 0_u32);
        let starts = counts.into_iter().map(|change| {
            let start = sum;
            here += change;
            sum += here as u32;
            start
        });
        let mut spans = Buckets::new(first, starts.collect());
        for (rows, flanks) in drawn {
            for row in rows {
                let chord = flanks.chord(self.middle(row));
                let span = chord.and_then(|(from, to)| Span::new(to_units(from), to_units(to)));
                if let Some(span) = span.filter(|span| is_asked(row, *span)) {
                    spans.add(row, span);
                }
            }
        }
        spans.rows()
    }

    /// All places within `mm` of an area.
    pub(super) fn grown(self, rows: &Rows, mm: f64) -> Rows {
        rows.dilate(to_units(mm), self.pitch)
    }

    /// All places of an area with everything within `mm` in it.
    pub(super) fn shrunk(self, rows: &Rows, mm: f64) -> Rows {
        let reach = (mm / self.pitch() + 1e-9) as i32;
        let chord = |m: i32| {
            let away = f64::from(m) * self.pitch();
            to_units((mm * mm - away * away).max(0.0).sqrt())
        };
        let chords: Vec<Coord> = (0..=reach).map(chord).collect();
        let range = rows.range();
        let mut out = Rows::with_room_of(rows, range.start);
        let (mut left, mut cut, mut next) = (Vec::new(), Vec::new(), Vec::new());
        for j in range {
            left.clear();
            narrowed(rows.row(j), chords[0], &mut left);
            for away in 1..=reach {
                for side in [-away, away] {
                    if left.is_empty() {
                        break;
                    }
                    cut.clear();
                    narrowed(rows.row(j + side), chords[away as usize], &mut cut);
                    next.clear();
                    intersect(&left, &cut, &mut next);
                    std::mem::swap(&mut left, &mut next);
                }
            }
            out.push_row(|spans| spans.extend_from_slice(&left));
        }
        out
    }

    /// What a disc of radius `mm` reaches that stays within an area.
    pub(super) fn opened(self, rows: &Rows, mm: f64) -> Rows {
        if rows.is_empty() { Rows::default() } else { self.grown(&self.shrunk(rows, mm), mm) }
    }

    /// What a square of side `2 × half` mm reaches that stays within an area, shrunk by `less` mm.
    pub(super) fn squares(self, rows: &Rows, half: f64, less: f64) -> Rows {
        let by = to_units(half);
        let mut thin = Rows::with_room_of(rows, rows.range().start);
        for (_, row) in rows.iter() {
            thin.push_row(|spans| narrowed(row, by, spans));
        }
        let window = |mm: f64| 2 * (mm / self.pitch()).round() as i32 + 1;
        let low = stacked(&thin, window(half), (intersect, false));
        if low.is_empty() {
            return low;
        }
        let by = to_units(half - less);
        let high = stacked(&low, window(half - less), (unite, true));
        let mut out = Rows::with_room_of(&high, high.range().start);
        let mut grown = Vec::new();
        for (_, row) in high.iter() {
            grown.clear();
            grown.extend(row.iter().map(|s| Span { start: s.start - by, end: s.end + by }));
            out.push_row(|spans| merge(&mut grown, spans));
        }
        out
    }

    /// The patches of an area, in the order of their first rows.
    pub(super) fn patches(self, rows: &Rows) -> Vec<Patch> {
        let (mut patches, mut sets): (Vec<Patch>, Sets) = (Vec::new(), Sets::default());
        let mut above: Vec<(Span, usize)> = Vec::new();
        for (j, row) in rows.iter() {
            let mut here = Vec::with_capacity(row.len());
            for &span in row {
                let middle = (i64::from(span.start) + span.len() / 2) as f64 / UNITS_PER_MM;
                let patch = sets.add();
                patches.push(Patch {
                    area: span.len() as f64 / UNITS_PER_MM * self.pitch(),
                    at: [middle, self.middle(j)],
                    longest: span.len(),
                });
                for (other, root) in &above {
                    if other.start <= span.end && span.start <= other.end {
                        let joined = sets.join(*root, patch);
                        joined.into_iter().for_each(|both| merged(&mut patches, both));
                    }
                }
                here.push((span, patch));
            }
            above = here;
        }
        (0..patches.len()).filter(|&one| sets.root(one) == one).map(|one| patches[one]).collect()
    }
}

/// Adds a patch to another that it has become a part of.
fn merged(patches: &mut [Patch], (whole, part): (usize, usize)) {
    let part = patches[part];
    let whole = &mut patches[whole];
    whole.area += part.area;
    if part.longest > whole.longest {
        (whole.longest, whole.at) = (part.longest, part.at);
    }
}

/// A row with each span shorter by `by` at both ends.
fn narrowed(row: &[Span], by: Coord, out: &mut Vec<Span>) {
    out.extend(row.iter().filter_map(|span| Span::new(span.start + by, span.end - by)));
}

/// How two rows are joined.
type Join = fn(&[Span], &[Span], &mut Vec<Span>);

/// Each row joined with those around it, `window` rows in all, an odd number; `beyond` says whether
/// something is left where some of them are beyond the rows there are.
///
/// A window is the end of a block of as many rows and the beginning of the next one. What lies between each row
/// and either end of its block is found from row to row: three joins a row, however large the window.
fn stacked(rows: &Rows, window: i32, (join, beyond): (Join, bool)) -> Rows {
    let Range { start, end } = rows.range();
    let start = if beyond { start - window + 1 } else { start };
    let place = |j: i32| (j - start) % window;
    let (mut last, mut both) = (Vec::new(), Vec::new());
    let mut add = |out: &mut Rows, row: &[Span], begins: bool| {
        both.clear();
        if begins {
            both.extend_from_slice(row);
        } else {
            join(row, &last, &mut both);
        }
        std::mem::swap(&mut last, &mut both);
        out.push_row(|spans| spans.extend_from_slice(&last));
    };
    // From the last row to the first: row `j` is row `-j` here.
    let mut to_end = Rows::with_room_of(rows, -(end + window - 1));
    for j in (start..end + window).rev() {
        add(&mut to_end, rows.row(j), place(j) == window - 1);
    }
    let mut to_begin = Rows::with_room_of(rows, start);
    for j in start..end + window {
        add(&mut to_begin, rows.row(j), place(j) == 0);
    }
    let mut out = Rows::with_room_of(rows, start + window / 2);
    for j in start..end {
        out.push_row(|spans| match place(j) {
            0 => spans.extend_from_slice(to_end.row(-j)),
            _ => join(to_end.row(-j), to_begin.row(j + window - 1), spans),
        });
    }
    out
}

/// Rows of spans that come in any order and may overlap.
pub(super) fn united(chords: &[(i32, Span)]) -> Rows {
    let first = chords.iter().map(|chord| chord.0).min().unwrap_or(0);
    let count = chords.iter().map(|chord| chord.0 - first + 1).max().unwrap_or(0) as usize;
    let mut starts = vec![0_u32; count + 1];
    for (j, _) in chords {
        starts[(j - first) as usize + 1] += 1;
    }
    for k in 0..count {
        starts[k + 1] += starts[k];
    }
    let mut spans = Buckets::new(first, starts);
    chords.iter().for_each(|(j, span)| spans.add(*j, *span));
    spans.rows()
}

/// Spans by row, in the order in which they come.
struct Buckets {
    first: i32,
    /// Where each row's room begins, and where the last one's ends.
    starts: Vec<u32>,
    /// Where each row's spans end.
    ends: Vec<u32>,
    spans: Vec<Span>,
}

impl Buckets {
    fn new(first: i32, starts: Vec<u32>) -> Self {
        let room = starts.last().map_or(0, |end| *end as usize);
        Self { first, ends: starts.clone(), starts, spans: vec![Span::default(); room] }
    }

    fn add(&mut self, j: i32, span: Span) {
        let row = (j - self.first) as usize;
        let (start, end) = (self.starts[row] as usize, self.ends[row] as usize);
        // Lines one after the other mostly overlap: joined at once, rows stay short.
        match self.spans[start..end].last_mut() {
            Some(last) if last.start <= span.end && span.start <= last.end => {
                last.start = last.start.min(span.start);
                last.end = last.end.max(span.end);
            }
            _ => {
                self.spans[end] = span;
                self.ends[row] += 1;
            }
        }
    }

    fn rows(mut self) -> Rows {
        let count = self.starts.len() - 1;
        let mut rows = Rows::with_room(self.first, count, self.spans.len());
        for (start, end) in self.starts.iter().zip(&self.ends).take(count) {
            rows.push_row(|out| merge(&mut self.spans[*start as usize..*end as usize], out));
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::segment;
    use proptest::prelude::*;

    /// Rows 1 mm apart of spans in mm.
    fn rows(spans: &[(i32, i32, i32)]) -> Rows {
        let mm = |at: i32| to_units(f64::from(at));
        let chords: Vec<(i32, Span)> = spans
            .iter()
            .filter_map(|&(j, from, to)| Some((j, Span::new(mm(from), mm(to))?)))
            .collect();
        united(&chords)
    }

    const WHOLE: Lattice = Lattice { pitch: 10_000 };

    fn has(rows: &Rows, x: i32, y: i32) -> bool {
        WHOLE.has(rows, [f64::from(x) + 0.5, f64::from(y) + 0.5])
    }

    #[test]
    fn rows_cover_what_their_middles_cross() {
        let fine = Lattice::new(0.1, 1.0, 1e4);
        assert_eq!(fine.range(0.0, 0.4), 0..4);
        assert_eq!(fine.range(-0.06, 0.04), -1..0);
        assert!((Lattice::new(0.1, 1000.0, 1000.0).pitch() - 1.0).abs() < 1e-9);
        let line = Capsule { from: [0.0, 0.2], to: [10.0, 0.2], radius: 0.2 };
        let area = fine.area(&fine.draw(std::iter::once(line)));
        assert!((4.0..4.14).contains(&area), "{area}");
    }

    #[test]
    fn patches_are_separated() {
        // A U, and a dot beside it that touches nothing.
        let found = WHOLE.patches(&rows(&[(0, 0, 3), (0, 9, 11), (1, 3, 10), (1, 20, 21)]));
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].area, found[0].at), (12.0, [6.5, 1.5]));
        assert_eq!((found[1].area, found[1].at), (1.0, [20.5, 1.5]));
        assert!(WHOLE.patches(&Rows::default()).is_empty());
    }

    proptest! {
        #[test]
        fn a_capsule_covers_the_rows_near_its_line(
            from in [0.0..8.0_f64, 0.0..8.0_f64],
            to in [0.0..8.0_f64, 0.0..8.0_f64],
            radius in 0.05..1.0_f64,
        ) {
            let lattice = Lattice::new(0.1, 8.0, 1e4);
            let drawn = lattice.draw(std::iter::once(Capsule { from, to, radius }));
            for j in -15..95 {
                for k in -15..95 {
                    let at = [f64::from(k) * 0.1, lattice.middle(j)];
                    let distance = segment::distance2(at, [from, to]).sqrt();
                    if (distance - radius).abs() > 1e-3 {
                        prop_assert_eq!(lattice.has(&drawn, at), distance < radius);
                    }
                }
            }
        }

        #[test]
        fn shrinking_keeps_what_a_disc_fits_in(
            spans in prop::collection::vec((0..12, 0..40, 1..30), 0..25),
            radius in 1..5_i32,
        ) {
            let spans: Vec<_> = spans.iter().map(|&(j, from, by)| (j, from, from + by)).collect();
            let area = rows(&spans);
            let shrunk = WHOLE.shrunk(&area, f64::from(radius));
            for y in -1..13 {
                for x in -2..75 {
                    // On each row of the disc all of its chord.
                    let fits = (-radius..=radius).all(|m| {
                        let half = f64::from(radius * radius - m * m).sqrt();
                        let row = area.row(y + m);
                        let (low, high) = (f64::from(x) + 0.5 - half, f64::from(x) + 0.5 + half);
                        row.iter().any(|s| to_mm(s.start) <= low + 1e-3 && high <= to_mm(s.end) + 1e-3)
                    });
                    prop_assert_eq!(has(&shrunk, x, y), fits, "{} {}", x, y);
                }
            }
        }

        #[test]
        fn squares_reach_what_is_wide_enough(
            (x, y, w, h) in (0..60_i32, 0..20_i32, 1..80_i32, 1..20_i32),
            half in 1..8_i32,
            less in 0..3_i32,
        ) {
            let spans: Vec<_> = (y..y + h).map(|j| (j, x, x + w)).collect();
            let less = less.min(half);
            let found = WHOLE.squares(&rows(&spans), f64::from(half), f64::from(less));
            let area = WHOLE.area(&found);
            // Rows are counted by their middles, so that a square has one more.
            let fits = w > 2 * half && h > 2 * half;
            let expected = if fits { (w - 2 * less) * (h - 2 * less) } else { 0 };
            prop_assert_eq!(area, f64::from(expected));
        }
    }
}
