//! Rows of both rasters -> Narrow: places where a region is narrower than a limit, to be filled solid.
//!
//! Words: the *chord* of a place is the span that holds it, on its row or on its column. A *tip*
//! is where a wide region tapers, such as a corner or the end of a circle.
//!
//! Sparse lines far apart miss narrow rooms on some layers and fill them on others. So do strips
//! between skin and a wall. Both are filled with skin instead, the same on every layer.
//!
//! Algorithm: in a straight room of any direction, with chords `a` and `b` across each other, the
//! width is `ab / √(a² + b²)`. Only spans shorter than √2 · `HARDLY` times the limit can be
//! narrow or hardly wider, so that most wide spans cost one look at the columns. Narrow spans on
//! neighbouring rows form a stack, and those hardly wider go on with it: a ring about as wide as the limit
//! is filled all around or nowhere. A low stack beside a wide place is a tip, and stays as it is. A long
//! span of which the columns lack most is narrow as well. What is narrow on the columns is brought to the
//! rows cell by cell, and the reverse, so that both rasters agree. Last, small spots between narrow places
//! are narrow, too: where two narrow rooms cross, both chords run on along them.

use super::scan::around;
use crate::geom::Point;
use crate::geom::cells::Cells;
use crate::geom::islands::Islands;
use crate::geom::outline::Columns;
use crate::geom::raster::{Raster, crossed};
use crate::geom::sets::Sets;
use crate::geom::spans::{Rows, Span, merge};
use crate::units::Coord;

/// Height of the lowest stack beside a wide place, in limits. The tip of a right angle is half a
/// limit high; a smaller value fills corners of wide rooms, a larger one leaves narrow ends open.
const TIP: f64 = 0.75;

/// The same for a stack that is higher than wide: not a corner but a finger, such as the tooth of a
/// gear. A smaller value lays specks; a larger one leaves short fingers hollow.
const FINGER: f64 = 0.375;

/// What is hardly wider than a narrow place beside it is narrow as well, up to so many limits. In bent rooms
/// the widths by chords differ by up to a fifth. A smaller value leaves patches in them; a larger one fills
/// more of rooms that taper.
const HARDLY: f64 = 1.25;

/// Most of a stack that may be hardly wider than the limit. With a larger value a bar is filled because the corners
/// at its ends are narrow; with a smaller one a ring in places.
const MOST_DOUBTFUL: f64 = 0.8;

/// The narrow places of a region on the two rasters of skins, of which the second is turned by
/// +90°; `None` if there are none.
#[must_use]
pub fn narrow(region: [&Rows; 2], rasters: [Raster; 2], limit: Coord) -> Option<[Rows; 2]> {
    let of = |r: usize| {
        let (rows, raster) = (region[r], rasters[r]);
        let columns = columns(region, rasters, r);
        stacks(rows, raster.pitch, &columns, limit)
    };
    let own = [of(0), of(1)];
    if own.iter().all(Option::is_none) {
        return None;
    }
    let narrow = on_both(region, own.map(Option::unwrap_or_default), rasters);
    let spots = [0, 1].map(|r| spots(region[r], &narrow[r], rasters[r].pitch, limit));
    if spots.iter().all(Rows::is_empty) {
        return Some(narrow);
    }
    let all = [0, 1].map(|r| narrow[r].or(&spots[r]));
    Some(on_both(region, all, rasters))
}

/// What is narrow on either of the two rasters, on both.
fn on_both(region: [&Rows; 2], own: [Rows; 2], rasters: [Raster; 2]) -> [Rows; 2] {
    [0, 1].map(|r| {
        let brought = brought(&columns([&own[0], &own[1]], rasters, r), rasters[r].pitch);
        whole(region[r], &own[r].or(&brought), rasters[1 - r].pitch)
    })
}

/// The islands beside what is `narrow` that are smaller than a square as wide as the limit, and a row more: rows
/// and columns tell widths in steps.
fn spots(region: &Rows, narrow: &Rows, pitch: Coord, limit: Coord) -> Rows {
    let rest = region.minus(narrow);
    let islands = Islands::new(&rest);
    let lengths = islands.lengths();
    let near = narrow.dilate(pitch, pitch);
    let meets = islands.any(|j, span| near.overlapping(j, span).is_some());
    let most = i64::from(limit + pitch);
    let is_small = |island: usize| lengths[island] * i64::from(pitch) < most * most;
    islands.select(|island| meets[island] && is_small(island))
}

/// The part of `region`, on `raster`, that is narrow on the two rasters of skins.
#[must_use]
pub fn on_raster(narrow: &[Rows; 2], rasters: [Raster; 2], raster: Raster, region: &Rows) -> Rows {
    let spans = |(rows, its): (&Rows, Raster)| {
        let spans = rows.iter().flat_map(|(j, row)| row.iter().map(move |s| (j, *s)));
        edges(spans, its, raster)
    };
    let all: Vec<_> = narrow.iter().zip(rasters).flat_map(spans).collect();
    whole(region, &around(&all, raster), rasters[0].pitch)
}

/// Spans of rows of `its` as edges in the frame of `raster`, each as wide as the rows' distance.
pub(super) fn edges(
    spans: impl Iterator<Item = (i32, Span)>,
    its: Raster,
    raster: Raster,
) -> Vec<(Point, Point, Coord)> {
    let at =
        |u: Coord, j: i32| raster.frame.enter(its.frame.leave(Point { x: u, y: j * its.pitch }));
    spans.map(|(j, s)| (at(s.start, j), at(s.end, j), its.pitch / 2)).collect()
}

/// The rows across raster `r`.
fn columns<'a>(rows: [&'a Rows; 2], rasters: [Raster; 2], r: usize) -> Columns<'a> {
    Columns { rows: rows[1 - r], pitch: rasters[1 - r].pitch, left_turn: r == 0 }
}

/// A narrow span and its row. It begins as a stack of its own, and stays one if the columns do not have it.
struct Narrow {
    row: i32,
    span: Span,
    alone: bool,
}

/// What a span is by its chords.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Chords {
    Wide,
    /// Hardly wider than what is narrow.
    Doubtful,
    Narrow,
    /// It is long, and the columns do not have most of it. Skins reach along their own lines: a strip between
    /// two of them may be open on one raster and closed on the other.
    Lone,
}

/// No rows: first and last.
const NONE: (i32, i32) = (i32::MAX, i32::MIN);

/// A stack of narrow spans: the lowest and highest row and the longest span of those that are beyond doubt,
/// whether it lies beside a wide place, and the length of all spans and of those that are in doubt.
#[derive(Clone, Copy)]
struct Stack {
    rows: (i32, i32),
    widest: i64,
    tip: bool,
    length: i64,
    doubtful: i64,
}

impl Stack {
    /// Whether it is no tip of a wide region.
    fn is_room(&self, pitch: Coord, limit: Coord) -> bool {
        let (low, high) = self.rows;
        let height = (i64::from(high) - i64::from(low) + 1) * i64::from(pitch);
        let least = if height > self.widest { FINGER } else { TIP };
        let is_narrow = (self.doubtful as f64) <= MOST_DOUBTFUL * self.length as f64;
        low <= high && is_narrow && (!self.tip || height >= (f64::from(limit) * least) as i64)
    }
}

/// Stacks that grow together: each set's root holds what is true of all of it.
#[derive(Default)]
struct Stacks {
    sets: Sets,
    of: Vec<Stack>,
}

impl Stacks {
    fn add(&mut self, stack: Stack) {
        self.sets.add();
        self.of.push(stack);
    }

    fn root(&mut self, k: usize) -> &mut Stack {
        &mut self.of[self.sets.root(k)]
    }

    fn join(&mut self, a: usize, b: usize) {
        let Some((root, joined)) = self.sets.join(a, b) else { return };
        let (x, y) = (self.of[root], self.of[joined]);
        let rows = (x.rows.0.min(y.rows.0), x.rows.1.max(y.rows.1));
        self.of[root] = Stack {
            rows,
            widest: x.widest.max(y.widest),
            tip: x.tip || y.tip,
            length: x.length + y.length,
            doubtful: x.doubtful + y.doubtful,
        };
    }
}

/// The narrow spans of `rows` by their own chords, without tips; `None` if there are none.
fn stacks(rows: &Rows, pitch: Coord, columns: &Columns<'_>, limit: Coord) -> Option<Rows> {
    let mut spans: Vec<Narrow> = Vec::new();
    let mut stacks = Stacks::default();
    // The narrow spans of the row before, and the wide ones there and here.
    let (mut before, mut wide, mut wide_here) = (0..0, Vec::new(), Vec::new());
    for (row, all) in rows.iter() {
        let first = spans.len();
        let mut passed = 0;
        for &span in all {
            // Rows are sorted: what ends before this one begins is done with.
            before.start +=
                spans[before.clone()].iter().take_while(|n| n.span.end <= span.start).count();
            passed += wide[passed..].iter().take_while(|w: &&Span| w.end <= span.start).count();
            let meets = |k: &usize| spans[*k].span.start < span.end;
            let below = before.clone().take_while(meets).filter(|k| !spans[*k].alone);
            let chords = chords(row * pitch, span, columns, limit);
            if chords == Chords::Wide {
                wide_here.push(span);
                below.for_each(|k| stacks.root(k).tip = true);
                continue;
            }
            let alone = chords == Chords::Lone;
            let tip = !alone && wide.get(passed).is_some_and(|w| w.overlaps(span));
            let (rows, widest) = match chords {
                Chords::Doubtful => (NONE, 0),
                _ => ((row, row), span.len()),
            };
            let length = span.len();
            let doubtful = if chords == Chords::Doubtful { length } else { 0 };
            stacks.add(Stack { rows, widest, tip, length, doubtful });
            if !alone {
                below.for_each(|k| stacks.join(k, spans.len()));
            }
            spans.push(Narrow { row, span, alone });
        }
        before = first..spans.len();
        std::mem::swap(&mut wide, &mut wide_here);
        wide_here.clear();
    }
    let mut is_room = (0..spans.len()).map(|k| stacks.root(k).is_room(pitch, limit));
    spans.retain(|_| is_room.next().unwrap_or_default());
    (!spans.is_empty()).then(|| {
        let mut rest = spans.as_slice();
        let mut out = Rows::with_room_of(rows, rows.range().start);
        for j in rows.range() {
            let here = rest.iter().take_while(|n| n.row == j).count();
            out.push_row(|row| row.extend(rest[..here].iter().map(|n| n.span)));
            rest = &rest[here..];
        }
        out
    })
}

/// How wide a region is, beside `limit`, at the middle of `span`, which lies at `v`.
fn chords(v: Coord, span: Span, columns: &Columns<'_>, limit: Coord) -> Chords {
    let (a, limit) = (span.len() as f64, f64::from(limit));
    let middle = span.start + (span.len() / 2) as Coord;
    let column = |u: Coord| (u + columns.pitch / 2).div_euclid(columns.pitch);
    let b = columns.chord(column(middle), v);
    let most = HARDLY * limit;
    if a * a >= 2.0 * most * most {
        if b.is_some() {
            return Chords::Wide;
        }
        let all = column(span.start)..=column(span.end);
        let lacking = all.clone().filter(|c| columns.chord(*c, v).is_none()).count();
        return if 2 * lacking > all.count() { Chords::Lone } else { Chords::Wide };
    }
    let b = b.map_or(0, Span::len) as f64;
    let is_narrower = |limit: f64| a * a * b * b < limit * limit * (a * a + b * b);
    match is_narrower(limit) {
        true => Chords::Narrow,
        false if is_narrower(most) => Chords::Doubtful,
        false => Chords::Wide,
    }
}

/// The columns as rows `pitch` apart: each as wide as their distance.
fn brought(columns: &Columns<'_>, pitch: Coord) -> Rows {
    let rows = |low: Coord, high: Coord| crossed(low, high, pitch);
    let all = || columns.spans().map(|(_, low, high)| rows(low, high)).filter(|r| !r.is_empty());
    let (first, last) = (all().map(|r| r.start).min(), all().map(|r| r.end).max());
    let Some((first, last)) = first.zip(last) else { return Rows::default() };
    let cells = || {
        columns.spans().map(|(c, low, high)| {
            let start = c * columns.pitch - columns.pitch / 2;
            (Span { start, end: start + columns.pitch }, low, high)
        })
    };
    let index = |j: i32| (j - first) as usize;
    let cells = Cells::new(index(last), cells, |(_, low, high)| rows(low, high).map(index));
    let mut out = Rows::with_room(first, cells.count(), cells.count());
    let mut row: Vec<Span> = Vec::new();
    for k in 0..cells.count() {
        row.clear();
        row.extend(cells.of(k..k + 1).iter().map(|(span, ..)| *span));
        out.push_row(|spans| merge(&mut row, spans));
    }
    out
}

/// The part of `region` in `narrow`, with the bits shorter than `least` beside it.
pub(super) fn whole(region: &Rows, narrow: &Rows, least: Coord) -> Rows {
    let inside = region.and(narrow);
    let beside = |j: i32, s: Span| {
        s.len() < i64::from(least)
            && (inside.span_at(j, s.start).is_some_and(|n| n.end == s.start)
                || inside.span_at(j, s.end).is_some_and(|n| n.start == s.end))
    };
    let bits = region.minus(&inside).filter(beside);
    if bits.is_empty() { inside } else { inside.or(&bits) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Contour;
    use crate::geom::frame::Frame;
    use crate::region::scan::Scan;
    use crate::units::{UNITS_PER_MM, sin_cos, to_mm, to_units};
    use proptest::prelude::*;

    const W: Coord = 4_000;
    const LIMIT: Coord = 20_000;

    /// How much of a polygon is narrow, and all of it, mm², on each raster.
    fn areas(corners: &[(f64, f64)], degrees: f64) -> [(f64, f64); 2] {
        let (sin, cos) = sin_cos(degrees);
        let turned = |&(x, y): &(f64, f64)| Point {
            x: to_units(x * cos - y * sin),
            y: to_units(x * sin + y * cos),
        };
        areas_of(&[corners.iter().map(turned).collect()])
    }

    /// The same of contours.
    fn areas_of(contours: &[Contour]) -> [(f64, f64); 2] {
        let rasters = [0.0, 90.0].map(|a| Raster { frame: Frame::new(a), pitch: W });
        let scans = rasters.map(|r| Scan::new(contours, r));
        let rows = [scans[0].inside(), scans[1].inside()];
        let area = |rows: &Rows| to_mm(W) * rows.total() as f64 / UNITS_PER_MM;
        let found = narrow(rows, rasters, LIMIT).unwrap_or_default();
        [0, 1].map(|r| (area(&found[r]), area(rows[r])))
    }

    /// A short skin on the columns reaches over a row that goes on far to both sides of it.
    #[test]
    fn a_row_that_the_columns_lack_in_its_middle_alone_stays_wide() {
        let rasters = [0.0, 90.0].map(|a| Raster { frame: Frame::new(a), pitch: W });
        let rect = |low: f64, high: f64| -> Contour {
            let p = |x, y| Point { x: to_units(x), y: to_units(y) };
            vec![p(low, -5.0), p(high, -5.0), p(high, 5.0), p(low, 5.0)]
        };
        let rows =
            |contours: &[Contour], r: usize| Scan::new(contours, rasters[r]).inside().clone();
        let on_rows = rows(&[rect(-10.0, 10.0)], 0);
        let on_columns = rows(&[rect(-10.0, -2.0), rect(2.0, 10.0)], 1);
        let found = narrow([&on_rows, &on_columns], rasters, 5_000);
        assert!(found.is_none_or(|found| found[0].is_empty()));
    }

    /// Skins above and below a strip have reached over it on the columns alone.
    #[test]
    fn what_one_raster_lacks_is_narrow_on_the_other() {
        let rasters = [0.0, 90.0].map(|a| Raster { frame: Frame::new(a), pitch: W });
        let rect = |x: f64, y: f64| {
            let p = |x, y| Point { x: to_units(x), y: to_units(y) };
            vec![p(-x, -y), p(x, -y), p(x, y), p(-x, y)]
        };
        let rows =
            |contours: &[Contour], r: usize| Scan::new(contours, rasters[r]).inside().clone();
        // A wide place to the right of the strip is there on both, and stays.
        let wide =
            rect(2.0, 20.0).iter().map(|p| Point { x: p.x + to_units(14.0), y: p.y }).collect();
        let strip = rows(&[rect(10.0, 0.5)], 0);
        let (on_rows, on_columns) =
            (strip.or(&rows(std::slice::from_ref(&wide), 0)), rows(&[wide], 1));
        let found = narrow([&on_rows, &on_columns], rasters, 5_000).unwrap();
        assert!(found[0].minus(&strip).is_empty() && strip.minus(&found[0]).is_empty());
        assert!(found[1].is_empty());
    }

    /// The share of a rectangle that is narrow, on each raster.
    fn share(size: (f64, f64), degrees: f64) -> [f64; 2] {
        let (x, y) = (size.0 / 2.0, size.1 / 2.0);
        areas(&[(-x, -y), (x, -y), (x, y), (-x, y)], degrees).map(|(narrow, all)| narrow / all)
    }

    proptest! {
        #[test]
        fn bars_are_narrow_below_the_limit_and_not_above(
            width in 0.3..4.0_f64, length in 15.0..40.0_f64, degrees in 0.0..180.0_f64
        ) {
            // The slanted ends of a bar hardly wider than the limit are narrow.
            prop_assume!(!(1.85..=3.0).contains(&width));
            for share in share((length, width), degrees) {
                if width < 2.0 {
                    prop_assert!(share > 0.97, "{}", share);
                } else {
                    prop_assert!(share < 0.12, "{}", share);
                }
            }
        }

        /// However its ends lie to the rows: their corners are narrow.
        #[test]
        fn a_bar_hardly_wider_than_the_limit_is_not_filled_from_its_ends(
            width in 2.2..3.0_f64, length in 15.0..40.0_f64, degrees in 0.0..180.0_f64
        ) {
            for share in share((length, width), degrees) {
                prop_assert!(share < 0.2, "{}", share);
            }
        }

        #[test]
        fn narrow_rooms_are_narrow_where_they_cross(
            width in 0.6..1.7_f64, ends in prop::array::uniform4(5.0..9.0_f64), degrees in 0.0..90.0_f64
        ) {
            let h = width / 2.0;
            let [right, top, left, bottom] = ends;
            let cross = [
                (right, -h), (right, h), (h, h), (h, top), (-h, top), (-h, h),
                (-left, h), (-left, -h), (-h, -h), (-h, -bottom), (h, -bottom), (h, -h),
            ];
            for (narrow, all) in areas(&cross, degrees) {
                prop_assert!(narrow > 0.97 * all, "{} of {}", narrow, all);
            }
        }

        #[test]
        fn rings_are_narrow_all_around_or_nowhere(
            inner in 6.0..20.0_f64, width in 1.7..2.6_f64, quarter in 6..24_usize
        ) {
            // Its four quarters are judged one by one, so that they have to be alike.
            let corners = 4 * quarter;
            let circle = |radius: f64, way: f64| -> Contour {
                let at = |k: usize| {
                    let (sin, cos) = sin_cos(way * 360.0 * k as f64 / corners as f64);
                    Point { x: to_units(radius * cos), y: to_units(radius * sin) }
                };
                (0..corners).map(at).collect()
            };
            for (narrow, all) in areas_of(&[circle(inner + width, 1.0), circle(inner, -1.0)]) {
                let share = narrow / all;
                // Brought from the columns, the ends of long rows are left out.
                prop_assert!(!(0.02..0.93).contains(&share), "{}", share);
            }
        }

        /// A finger on a block, with a little of the block at its foot.
        #[test]
        fn fingers_longer_than_wide_are_rooms(
            width in 0.5..0.9_f64, longer in 2.6..4.0_f64, degrees in 0.0..90.0_f64
        ) {
            let (x, top) = (width / 2.0, 5.0 + longer * width);
            let block = [(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0)];
            let finger = [(x, 5.0), (x, top), (-x, top), (-x, 5.0), (-5.0, 5.0)];
            let finger_mm2 = longer * width * width;
            for (narrow, _) in areas(&[&block[..], &finger[..]].concat(), degrees) {
                let share = narrow / finger_mm2;
                prop_assert!((0.5..1.9).contains(&share), "{share}");
            }
        }

        #[test]
        fn wide_rooms_keep_their_corners(size in 6.0..40.0_f64, degrees in 0.0..90.0_f64) {
            prop_assert_eq!(share((size, size), degrees), [0.0, 0.0]);
        }
    }
}
