//! Rows -> loops: the outline of an area that is known on raster rows.
//!
//! Words: a *side* is the end of a span, left or right. Sides are linked to loops that keep the area
//! on their left: *right* sides are passed upwards, *left* ones downwards.
//!
//! Between two rows nothing is known, so the outline there follows the two rows: from a side it goes
//! on to that side of the next row which lies nearest along the border of the spans seen as strips,
//! each half a pitch wide to both sides. The loop's points are the ends of the spans themselves.

use crate::geom::decimate::{decimate, most_missed};
use crate::geom::frame::Frame;
use crate::geom::spans::{Rows, Span};
use crate::geom::{Contour, Point, edges, side};
use crate::units::{Bounded as _, Coord};

/// Loops are decimated with this tolerance (50 µm). A larger one shows as facets; a smaller one keeps
/// the steps of the rows.
const BEND: f64 = 500.0;

/// One end of a span: its row, the index of the span in it, and whether it is the right end.
type Side = (i32, usize, bool);

/// The outlines of `rows`, which are `pitch` apart: counter-clockwise around the area, clockwise
/// around its holes. Those shorter than `least` are dropped.
pub(super) fn outlines(rows: &Rows, pitch: Coord, frame: Frame, least: Coord) -> Vec<Contour> {
    let first = rows.range().start;
    let mut seen: Vec<Vec<[bool; 2]>> =
        rows.iter().map(|(_, row)| vec![[false; 2]; row.len()]).collect();
    let mut loops = Vec::new();
    for (j, row) in rows.iter() {
        for start in (0..row.len()).flat_map(|k| [(j, k, false), (j, k, true)]) {
            let mut points = Vec::new();
            let mut at = start;
            loop {
                let (j, k, right) = at;
                let seen = &mut seen[(j - first) as usize][k][usize::from(right)];
                if std::mem::replace(seen, true) {
                    break;
                }
                let span = rows.row(j)[k];
                points.push(Point { x: if right { span.end } else { span.start }, y: j * pitch });
                at = if right { above(rows, at) } else { below(rows, at) };
            }
            loops.extend(smooth(points).filter(|points| {
                edges(points).map(|(a, b)| a.distance(b)).sum::<f64>() >= f64::from(least)
            }));
        }
    }
    let place = |contour: Contour| contour.into_iter().map(|p| frame.leave(p)).collect();
    loops.into_iter().map(place).collect()
}

/// The side after the right end of span `k`, going up.
fn above(rows: &Rows, (j, k, _): Side) -> Side {
    let (row, next) = (rows.row(j), rows.row(j + 1));
    let span = row[k];
    if let Some(m) = next.iter().position(|s| s.start < span.end && span.end <= s.end) {
        // The area goes on above, and may reach further to the right, until the next span begins.
        return match row.get(k + 1).filter(|other| other.start < next[m].end) {
            Some(_) => (j, k + 1, false),
            None => (j + 1, m, true),
        };
    }
    let ends = |s: &Span| span.start < s.end && s.end <= span.end;
    match next.iter().rposition(ends) {
        Some(m) => (j + 1, m, true),
        None => (j, k, false),
    }
}

/// The side after the left end of span `k`, going down.
fn below(rows: &Rows, (j, k, _): Side) -> Side {
    let (row, next) = (rows.row(j), rows.row(j - 1));
    let span = row[k];
    if let Some(m) = next.iter().position(|s| s.start <= span.start && span.start < s.end) {
        return match k.checked_sub(1).filter(|&other| row[other].end > next[m].start) {
            Some(other) => (j, other, true),
            None => (j - 1, m, false),
        };
    }
    match next.iter().position(|s| span.start <= s.start && s.start < span.end) {
        Some(m) => (j - 1, m, false),
        None => (j, k, true),
    }
}

/// The loop without points that lie nearly on a line; none of fewer than three points.
fn smooth(points: Contour) -> Option<Contour> {
    if points.len() < 4 {
        return None;
    }
    // Decimation keeps both ends: of a loop its first point twice.
    let at = |k: usize| points[k % points.len()];
    let kept = decimate(points.len() + 1, |a, b| {
        let length = at(a).distance(at(b)).at_least(1.0);
        // Before the first split both ends are the same point.
        let miss = |k: usize| {
            let off = side(at(a), at(b), at(k)).abs() as f64 / length;
            if at(a) == at(b) { at(a).distance(at(k)) } else { off }
        };
        most_missed(a, b, BEND, miss)
    });
    let kept: Contour = kept[..kept.len() - 1].iter().map(|&k| at(k)).collect();
    (kept.len() > 2).then_some(kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::double_area;
    use proptest::prelude::*;

    proptest! {
        /// Each side is passed once, and the loops enclose the area that the rows show.
        #[test]
        fn loops_pass_each_side_once(masks in prop::collection::vec(any::<u16>(), 1..8)) {
            let mut rows = Rows::starting_at(3);
            for mask in masks {
                let cells = (0..16).filter(|i| mask >> i & 1 == 1);
                let mut cells: Vec<Span> =
                    cells.map(|i| Span { start: 2 * i, end: 2 * i + 2 }).collect();
                rows.push_row(|out| crate::geom::spans::merge(&mut cells, out));
            }
            let mut passed = Vec::new();
            for (j, row) in rows.iter() {
                for k in 0..row.len() {
                    passed.push(above(&rows, (j, k, true)));
                    passed.push(below(&rows, (j, k, false)));
                }
            }
            passed.sort_unstable();
            let mut sides = passed.clone();
            sides.dedup();
            prop_assert_eq!(&passed, &sides);
            for (j, k, _) in passed {
                prop_assert!(rows.row(j).len() > k);
            }
        }
    }

    #[test]
    fn a_frame_has_an_outline_and_a_hole() {
        let mut rows = Rows::starting_at(-50);
        for j in -50..=50_i32 {
            let hole = Span { start: -20_000, end: 20_000 };
            let whole = [Span { start: -50_000, end: 50_000 }];
            let cut: &[Span] = if j.abs() <= 20 { &[hole] } else { &[] };
            rows.push_row(|out| crate::geom::spans::subtract(&whole, cut, out));
        }
        let loops = outlines(&rows, 1_000, Frame::new(0.0), 4_000);
        let mut areas: Vec<i128> = loops.iter().map(|one| double_area(one) / 2_000_000).collect();
        areas.sort_unstable();
        assert_eq!(areas, [-1_600, 10_000], "{loops:?}");
        assert!(loops.iter().all(|one| one.len() <= 6), "{loops:?}");
    }
}
