//! Skin over sparse infill and what is printed below it -> what it takes of the infill to end on something.
//!
//! A skin reaches a stated way into the infill around it. Its lines then end wherever that is: some
//! on a sparse line of the layer below, most between two of them, in the air. They go on: until
//! they lie on the next line below, on what is solid there, or until they meet a wall.
//!
//! Algorithm: on each row the ends of skin at infill are known, and so are the stretches of the
//! row that lie on printed lines, and where the infill below ends. The next of these is
//! where the skin ends. On other rasters the stretches are brought cell by cell, as in [`rooms`].

use super::divide::LayerAreas;
use super::first_skin::Both;
use super::per_raster::Rasters;
use super::rooms;
use super::scan::{around, around_on};
use crate::geom::Point;
use crate::geom::islands::Islands;
use crate::geom::polyline::LinePoint;
use crate::geom::raster::Raster;
use crate::geom::spans::{Rows, Span, merge};
use crate::pattern::Pattern;
use crate::units::Coord;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// An end may lie this far beyond what carries it, in quarters of a line's width: its own plastic
/// reaches as far. A smaller value lengthens lines that hold; a larger one lets ends sag.
const HELD: Coord = 2;

/// How far an end reaches over a line below, in quarters of a line's width: at least, and if it goes
/// on to that line. Turns to the next line begin a little before the end, and have to lie on it too.
const OVER_LINE: [Coord; 2] = [2, 3];

/// Shorter infill between a skin and what comes behind, in line widths, is left to the skin.
const LEAST_REST: Coord = 2;

/// A line goes on to a line below if it is free for this long at most, in line widths: as far as lines
/// of 10 % infill lie apart, and a little more. A larger value turns thin infill into skin; a smaller
/// one leaves ends in the air.
const LONGEST: Coord = 12;

/// A line that lies on nothing at all goes on to what is this far from the last line before it at most, in line
/// widths: across a cell of thin infill in two or three directions. With a smaller value pieces of skin hang
/// in such cells; a larger one bridges what should be infill. Infill in one direction has no cells.
const LONGEST_LOOSE: Coord = 32;

/// It goes on to what is solid if it is free for this long at most, in line widths. It may run along
/// the lines below; a larger value makes lines that sag.
const LONGEST_ALONG: Coord = 6;

/// Fewer lines of skin side by side do not go on where the line below is thick, and so is printed on
/// their own layer: they would cut it into pieces too short to hold anything.
pub const LEAST_ROWS_IN_THICK: i32 = 6;

/// What lies around a skin, on the raster of its lines.
#[derive(Debug, Clone, Copy)]
pub struct Around<'a> {
    /// The sparse infill of its own layer.
    pub infill: &'a Rows,
    /// The sparse infill of the layer below.
    pub below: &'a Rows,
    /// The stretches of the rows that lie on a sparse line below.
    pub printed: &'a Rows,
    /// Width of a line.
    pub line_width: Coord,
    /// Whether lines below cross each other.
    pub crosses: bool,
}

/// Where the lines of `skin` go on through the infill, so that they end on something.
#[must_use]
pub fn beyond(skin: &Rows, around: &Around<'_>) -> Rows {
    let mut out = Rows::with_room_of(skin, skin.range().start);
    let mut found = Vec::new();
    for (j, row) in skin.iter() {
        let (infill, below, printed) =
            (around.infill.row(j), around.below.row(j), around.printed.row(j));
        found.clear();
        if !infill.is_empty() && !below.is_empty() {
            let mirrored = |row: &[Span]| -> Vec<Span> { row.iter().rev().map(mirror).collect() };
            let ahead = Row { infill, below, printed };
            found.extend(row.iter().filter_map(|s| ahead.beyond(*s, around)));
            let rows = [infill, below, printed].map(mirrored);
            let back = Row { infill: &rows[0], below: &rows[1], printed: &rows[2] };
            let behind = row.iter().filter_map(|s| back.beyond(mirror(s), around));
            found.extend(behind.map(|span| mirror(&span)));
        }
        out.push_row(|spans| merge(&mut found, spans));
    }
    out
}

fn mirror(span: &Span) -> Span {
    Span { start: -span.end, end: -span.start }
}

/// What is known of one row.
#[derive(Clone, Copy)]
struct Row<'a> {
    infill: &'a [Span],
    below: &'a [Span],
    printed: &'a [Span],
}

impl Row<'_> {
    /// Where a line of skin goes on at its end; `None` if it lies on something there, or if nothing
    /// is near enough.
    fn beyond(&self, skin: Span, around: &Around<'_>) -> Option<Span> {
        let (w, at) = (around.line_width, skin.end);
        let room = self.infill.iter().find(|s| s.start == at)?;
        let void = self.below.iter().find(|s| s.start < at && at < s.end)?;
        let [least, over] = OVER_LINE.map(|quarters| quarters * w / 4);
        let known = self.printed.partition_point(|s| s.start + least <= at);
        let carried = self.printed[..known].last().map_or(void.start, |s| s.end.max(void.start));
        if at - carried <= HELD * w / 4 {
            return None;
        }
        let line = self.printed.get(known).map(|s| s.start + over);
        // Where the infill below ends, skin or a wall lies below.
        let solid = (void.end + w).min(room.end);
        let is_loose = around.crosses && carried <= skin.start;
        let longest = if is_loose { LONGEST_LOOSE } else { LONGEST };
        let is_near = line.is_some_and(|line| line - carried <= longest * w)
            || solid - carried <= LONGEST_ALONG * w;
        if !is_near {
            return None;
        }
        let to = line.map_or(solid, |line| line.min(solid));
        Span::new(at, if room.end - to < LEAST_REST * w { room.end } else { to })
    }
}

/// What is printed sparsely on a layer.
#[derive(Debug)]
pub struct Floor<'a> {
    /// The areas of the layer.
    pub areas: &'a LayerAreas,
    /// The patterns of its sparse infill.
    pub patterns: Vec<Pattern>,
    /// Width of a line.
    pub line_width: Coord,
    /// Fewer rows side by side end where they are.
    pub least_rows: i32,
}

impl Floor<'_> {
    /// The stretches of the rows of `raster` that lie on its lines, as far as `ends` may reach.
    fn printed(&self, raster: Raster, ends: &Ends) -> Rows {
        let far = (LONGEST_LOOSE + 2) * self.line_width;
        let is_near = |p: Point, q: Point| {
            p.x.max(q.x) >= ends.along.start - far && p.x.min(q.x) <= ends.along.end + far
        };
        let mut edges = Vec::new();
        for pattern in &self.patterns {
            let its = pattern.raster();
            let Some(areas) = self.areas.on(its) else { continue };
            let at = |p: &LinePoint| raster.frame.enter(its.frame.leave(Point { x: p.u, y: p.v }));
            for strand in pattern.strands(&areas.infill, self.line_width, self.line_width) {
                let points: Vec<Point> = strand.iter().map(at).collect();
                let near = points.windows(2).filter(|w| is_near(w[0], w[1]));
                edges.extend(near.map(|w| (w[0], w[1], self.line_width / 2)));
            }
        }
        around_on(ends.rows.clone(), &edges, raster)
    }
}

/// Lets the lines of a `skin`, which lie on raster `along` of skins, go on until they end on something.
/// What they take is taken from `areas`, those of its layer.
#[must_use]
pub fn land(
    skin: Both,
    along: usize,
    areas: &mut Cow<'_, LayerAreas>,
    floor: &Floor<'_>,
    rasters: &Rasters,
) -> Both {
    let own = [along, 1 - along].map(|r| rasters.skin(r));
    let (w, infill, below) =
        (floor.line_width, &areas.skin(along).infill, &floor.areas.skin(along).infill);
    let Some(ends) = Ends::of(&skin[0], infill, below) else { return skin };
    let printed = floor.printed(own[0], &ends);
    let crosses = floor.patterns.len() > 1;
    let beside = Around { infill, below, printed: &printed, line_width: w, crosses };
    let more = beyond(&skin[0], &beside);
    let more = broad(more, floor.least_rows);
    if more.is_empty() {
        return skin;
    }
    let longer = skin[0].or(&more);
    // The cells have round ends: each ends half a width before its line does, but not at the skin.
    let spans = more.iter().flat_map(|(j, row)| row.iter().map(move |s| (j, *s)));
    let cells = spans.filter_map(|(j, s)| {
        let line = longer.overlapping(j, s)?;
        let (start, end) =
            ((line.start + w / 2).max(s.start - w), (line.end - w / 2).min(s.end + w));
        Some((j, Span { start: start.min(end), end }))
    });
    let cells: Vec<(i32, Span)> = cells.collect();
    let taken = |raster: Raster, region: &Rows| {
        if raster == own[0] {
            return region.and(&more);
        }
        let edges = rooms::edges(cells.iter().copied(), own[0], raster);
        rooms::whole(region, &around(&edges, raster), own[0].pitch)
    };
    let columns = skin[1].or(&taken(own[1], &areas.skin(1 - along).infill));
    let less = areas.as_ref().clone().map_on(|raster, its| {
        let taken = taken(raster, &its.infill);
        its.with_skin(&taken)
    });
    *areas = Cow::Owned(less);
    [longer, columns].map(Arc::new)
}

/// The pieces of `rows` that are at least `least` rows high.
fn broad(rows: Rows, least: i32) -> Rows {
    if least <= 1 || rows.is_empty() {
        return rows;
    }
    let islands = Islands::new(&rows);
    let mut high = vec![(i32::MAX, i32::MIN); islands.count()];
    for j in rows.range() {
        for island in islands.row(j) {
            let (first, last) = high[*island];
            high[*island] = (first.min(j), last.max(j));
        }
    }
    islands.select(|island| high[island].1 - high[island].0 + 1 >= least)
}

/// Where the ends lie that may lie on nothing.
struct Ends {
    rows: Range<i32>,
    along: Span,
}

impl Ends {
    /// The ends of `skin` at `infill` with sparse infill `below`; `None` if there are none.
    fn of(skin: &Rows, infill: &Rows, below: &Rows) -> Option<Self> {
        let mut ends: Option<Self> = None;
        for (j, row) in skin.iter() {
            let (infill, below) = (infill.row(j), below.row(j));
            let is_over = |u: Coord| below.iter().any(|s| s.start < u && u < s.end);
            let is_free = |u: Coord, right: bool| {
                let is_at = |room: &Span| u == if right { room.start } else { room.end };
                infill.iter().any(is_at) && is_over(u)
            };
            let both = row.iter().flat_map(|s| [(s.end, true), (s.start, false)]);
            for (u, _) in both.filter(|&(u, right)| is_free(u, right)) {
                let ends =
                    ends.get_or_insert(Self { rows: j..j, along: Span { start: u, end: u } });
                ends.rows.end = j + 1;
                ends.along.start = ends.along.start.min(u);
                ends.along.end = ends.along.end.max(u);
            }
        }
        ends
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const W: Coord = 4_000;

    fn row(spans: &[(Coord, Coord)]) -> Rows {
        let mut rows = Rows::starting_at(0);
        rows.push_row(|out| out.extend(spans.iter().map(|&(start, end)| Span { start, end })));
        rows
    }

    /// Where a skin from `at` back to 0 goes on, with infill up to `wall`, and infill below from 0 to
    /// `void` with lines `spacing` apart.
    fn end(at: Coord, wall: Coord, void: Coord, spacing: Coord) -> Coord {
        let lines: Vec<(Coord, Coord)> = (1..)
            .map(|k| (k * spacing - W / 2, k * spacing + W / 2))
            .take_while(|line| line.1 < void)
            .collect();
        let around = Around {
            infill: &row(&[(at, wall)]),
            below: &row(&[(0, void)]),
            printed: &row(&lines),
            line_width: W,
            crosses: true,
        };
        let more = beyond(&row(&[(0, at)]), &around);
        more.row(0).first().map_or(at, |s| s.end)
    }

    proptest! {
        #[test]
        fn a_line_ends_on_the_next_one_below_or_at_a_wall(
            at in 21_000..60_000_i32, spacing in 8_000..40_000_i32, wall in 62_000..200_000_i32,
        ) {
            let to = end(at, wall, 300_000, spacing);
            prop_assert!((at..=wall).contains(&to));
            prop_assert!(to - at <= spacing + LEAST_REST * W);
            let beyond_line = (to + W / 2) % spacing;
            let on_line = (W / 2..=W + W / 2).contains(&beyond_line);
            prop_assert!(to == wall || on_line, "{} to {}", at, to);
        }
    }

    #[test]
    fn both_ends_of_a_line_go_on() {
        let around = Around {
            infill: &row(&[(-90_000, -11_000), (11_000, 90_000)]),
            below: &row(&[(-90_000, 90_000)]),
            printed: &row(&[(-22_000, -18_000), (-2_000, 2_000), (18_000, 22_000)]),
            line_width: W,
            crosses: true,
        };
        let more = beyond(&row(&[(-11_000, 11_000)]), &around);
        assert_eq!(more, row(&[(-21_000, -11_000), (11_000, 21_000)]));
    }

    #[test]
    fn a_line_that_lies_on_nothing_goes_on_across_a_wide_cell() {
        // What a line below holds ends in the air rather than that it bridges so much.
        for (first, most) in [(-8_000, 11_000), (30_000, 33_000)] {
            let lines = [(-44_000, -40_000), (first, first + 4_000), (52_000, 56_000)];
            let around = Around {
                infill: &row(&[(-90_000, -11_000), (11_000, 90_000)]),
                below: &row(&[(-90_000, 90_000)]),
                printed: &row(&lines),
                line_width: W,
                crosses: true,
            };
            let more = beyond(&row(&[(-11_000, 11_000)]), &around);
            let end = more.row(0).last().map_or(11_000, |s| s.end.max(11_000));
            assert_eq!(end, most, "{first}");
        }
    }

    #[test]
    fn a_line_ends_on_what_is_solid_below() {
        assert_eq!(end(33_000, 200_000, 40_000, 27_000), 40_000 + W);
        // Too far: it may run along the lines below.
        assert_eq!(end(33_000, 200_000, 55_000, 27_000), 33_000);
    }
}
