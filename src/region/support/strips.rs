//! Rows -> strips: narrow places that no line of support holds, so that lines across hold them.
//!
//! Words: a *column* is a row of the raster across the lines. A place is *loose* if it lies far from
//! any line ([`mod@super::held`]). A line is *alone* where it is long, and has no neighbour to be joined
//! to. A *strip* is loose or has a line that is alone, and is so narrow that its columns are short:
//! it runs along the lines. A zigzag of lines across stands there like a folded sheet; a line
//! along it, or one on each of its sides, would stand alone.

use super::held::loose;
use super::params::SupportParams;
use super::pieces::{Pieces, turned};
use crate::geom::spans::{Rows, subtract, unite};

/// A strip is no wider than this, in distances of lines. Wider places have lines of their own.
const WIDEST: i32 = 2;

/// A line that is alone is longer than this, in distances of lines.
const ALONE: i32 = 2;

/// A strip has at least so many lines across: one alone is no zigzag.
const LEAST_LINES: usize = 2;

/// The strips of `all`.
pub(super) fn strips(all: &Rows, params: &SupportParams) -> Rows {
    let (lines, pitch) = (&params.lines, params.raster().pitch);
    let seeds = loose(lines, all).or(&alone(all, params).dilate(pitch, pitch));
    if seeds.is_empty() {
        return seeds;
    }
    let [columns, seeds] = [all, &seeds].map(|rows| turned(rows, pitch));
    let narrow = short(&columns, params);
    let seeds = narrow.filter(|j, span| seeds.overlapping(j, span).is_some());
    // They go on to the next line across.
    let near = seeds.dilate(params.crossing.stride * pitch, pitch);
    let strips = narrow.filter(|j, span| near.overlapping(j, span).is_some());
    let pieces = Pieces::new(&strips);
    let mut lines = vec![0; pieces.count()];
    let printed = strips.filter(|j, _| params.crossing.prints(j));
    pieces.meeting(&strips, &printed, |piece, _| lines[piece] += 1);
    let strips = pieces.keep(&strips, |piece| lines[piece] >= LEAST_LINES);
    turned_back(&strips, all, params)
}

/// The short columns of `rows` that have some of `strips`.
pub(super) fn whole_columns(rows: &Rows, strips: &Rows, params: &SupportParams) -> Rows {
    if strips.is_empty() || rows.is_empty() {
        return Rows::default();
    }
    let [columns, strips] = [rows, strips].map(|rows| turned(rows, params.raster().pitch));
    let whole = short(&columns, params).filter(|j, span| strips.overlapping(j, span).is_some());
    turned_back(&whole, rows, params)
}

/// The columns that are no longer than a strip is wide.
fn short(columns: &Rows, params: &SupportParams) -> Rows {
    let widest = i64::from(WIDEST * params.lines.stride * params.raster().pitch);
    columns.filter(|_, span| span.len() <= widest)
}

/// Columns as rows again, grown within `rows`: turned back they are short by up to a pitch at each end.
fn turned_back(columns: &Rows, rows: &Rows, params: &SupportParams) -> Rows {
    let pitch = params.raster().pitch;
    upright(columns, params).dilate(2 * pitch, pitch).and(rows)
}

/// The long stretches of lines without another line on either side.
fn alone(all: &Rows, params: &SupportParams) -> Rows {
    let stride = params.lines.stride;
    let longer = i64::from(ALONE * stride * params.raster().pitch);
    let (mut beside, mut left) = (Vec::new(), Vec::new());
    let mut out = Rows::starting_at(all.range().start);
    for (j, row) in all.iter() {
        left.clear();
        if params.lines.prints(j) && row.iter().any(|span| span.len() > longer) {
            beside.clear();
            unite(all.row(j - stride), all.row(j + stride), &mut beside);
            subtract(row, &beside, &mut left);
        }
        out.push_row(|spans| spans.extend(left.iter().filter(|span| span.len() > longer)));
    }
    out
}

/// Columns on the rows of support.
pub(super) fn upright(columns: &Rows, params: &SupportParams) -> Rows {
    (0..3).fold(columns.clone(), |rows, _| turned(&rows, params.raster().pitch))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::spans::Span;
    use crate::profile;
    use crate::units::Coord;

    #[test]
    fn a_strip_between_two_lines_is_found_and_what_lines_hold_is_not() {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        settings.support.enabled = true;
        let params = SupportParams::new(&settings).unwrap();
        assert_eq!((params.lines.stride, params.raster().pitch), (15, 2_000));
        let block = |from: i32, to: i32, long: Coord| {
            let mut rows = Rows::starting_at(from);
            (from..to).for_each(|_| rows.push_row(|out| out.push(Span { start: 0, end: long })));
            rows
        };
        let found = |rows: &Rows| strips(rows, &params);
        let is_strip = |rows: &Rows| found(rows).total() == rows.total();
        assert!(is_strip(&block(3, 13, 450_000)));
        // A line that is alone.
        assert!(is_strip(&block(-3, 7, 450_000)));
        // Lines hold these, or they are too short for a zigzag across.
        assert!(found(&block(-3, 7, 55_000)).is_empty());
        assert!(found(&block(-3, 18, 450_000)).is_empty());
        assert!(found(&block(0, 90, 450_000)).is_empty());
        assert!(found(&block(3, 13, 25_000)).is_empty());
        // Beneath a broad piece there are long columns.
        assert!(found(&block(0, 42, 450_000)).is_empty());
        // An arm of a broad piece is one; the piece is none.
        let foot = block(-60, 30, 100_000);
        let both = foot.or(&block(3, 13, 450_000));
        let strip = found(&both);
        assert!(strip.and(&foot).total() * 20 < strip.total(), "{strip:?}");
        assert!(strip.total() > 9 * 340_000, "{strip:?}");
    }
}
