//! Lines + outline -> strands: lines joined along the walls, with ends that run along them.
//!
//! Words: the *border* of a region is one or more closed outlines. An *end* is where a line meets
//! the border. An *arc* is the border from one end to the next. A *join* is an arc that is
//! printed and links two lines. An *anchor* is the part of an arc that is printed after an end
//! without a join.
//!
//! What is printed inside walls holds on to them only where it touches them. A line touches with
//! the width of its end; a bead along the wall with all of its length. So lines are joined along
//! the border even where a straight join is shorter, and ends without a join get an anchor.
//!
//! Algorithm:
//! 1. Find the border ([`outlines`]) and the ends on it, in its order.
//! 2. Along each outline, join the first two ends, the next two, and so on, where the arc between
//!    them is short enough, and does not run back beside a line. Lines that are linked already are
//!    not joined again: strands stay open. Then the next pair begins one end later.
//! 3. Give each end that is left an anchor on the longer of the two arcs beside it, as far as it
//!    is free and at a wall.
//! 4. Follow the joins from line to line.

use super::Held;
use super::zigzag::Side;
use crate::geom::decimate::{decimate, most_missed};
use crate::geom::outline::{Corner, Outline, SpanEnd, outlines};
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::sets::Sets;
use crate::geom::spans::{Rows, Span};
use crate::geom::{Point, side};
use crate::units::{Bounded as _, Coord, nearest};

/// Maximum distance of two ends that are joined, in line widths. Longer joins along a wall add
/// more plastic than the lines there, most where lines of several directions end. A smaller value
/// replaces joins by travels, already at higher densities.
pub(super) const LONGEST_JOIN: i64 = 12;

/// Joins are at most this many times as long as the shorter of their lines, as those of zigzags.
const LONGEST_BY_LINE: i64 = 4;

/// Tolerance for decimating arcs, in line widths (25 µm). It is less than how far beads along a
/// wall reach into it: a larger value leaves gaps, a smaller one makes more, shorter moves.
const BEND: f64 = 0.0625;

/// Shorter anchors, in line widths, hold no more than the end itself.
const LEAST_ANCHOR: f64 = 1.0;

/// An anchor ends where it comes nearer to the middle of a printed line than this, in line widths:
/// the line holds there itself. A larger value drops anchors along walls beside the lines.
const CLEAR: f64 = 0.7;

/// The first part of an anchor or a join, in line widths, may be nearer: it leaves its own line.
const LEAVING: f64 = 2.0;

/// Which rows are printed, and how they hold on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    /// Distance of the rows.
    pub(super) pitch: Coord,
    /// Index of a row that is printed.
    pub(super) offset: i32,
    /// Number of rows from one that is printed to the next.
    pub(super) stride: i32,
    /// The length of an anchor, at most.
    pub(super) anchor: Coord,
    /// How far inside the region's border beads run along a wall.
    pub(super) inwards: Coord,
}

impl Places {
    fn prints(self, j: i32) -> bool {
        (j - self.offset).rem_euclid(self.stride) == 0
    }
}

/// An end of a line on the border.
#[derive(Debug, Clone, Copy)]
struct End {
    /// Where it is on its outline.
    at: usize,
    line: usize,
    side: Side,
}

/// A line and what its two ends lead to.
#[derive(Debug)]
struct Line {
    row: i32,
    /// Its ends, moved off the wall.
    span: Span,
    /// The lines joined at its left and right end.
    joined: [Option<(usize, Side)>; 2],
    /// The points after its ends: of the join or the anchor.
    after: [Vec<LinePoint>; 2],
    done: bool,
}

/// The strands of lines on the rows of `lines` in `region`.
pub(super) fn strands(
    lines: Places,
    region: &Held<'_>,
    width: Coord,
    least: Coord,
) -> Vec<Polyline> {
    let pitch = lines.pitch;
    let printed = region.rows.iter().filter(|(j, _)| lines.prints(*j));
    let spans: Vec<(i32, Span)> = printed
        .flat_map(|(j, row)| row.iter().map(move |&span| (j, span)))
        .filter(|(_, span)| span.len() >= i64::from(least))
        .collect();
    if spans.is_empty() {
        return Vec::new();
    }
    let line = |&(row, span): &(i32, Span)| Line {
        row,
        span,
        joined: [None, None],
        after: [Vec::new(), Vec::new()],
        done: false,
    };
    let border = outlines(region.rows, pitch, region.columns, region.walls, lines.inwards);
    let mut all: Vec<Line> = spans.iter().map(line).collect();
    // Which lines are linked by joins.
    let mut links = Sets::new(all.len());
    for outline in &border {
        let ends = ends(outline, &spans, lines);
        for end in &ends {
            let at = outline[end.at].at.x;
            let span = &mut all[end.line].span;
            *(if end.side == Side::Left { &mut span.start } else { &mut span.end }) = at;
        }
        let arcs = Arcs::new(outline, &ends, lines, region.rows, width);
        arcs.join(&mut all, &mut links);
        arcs.anchor(&mut all, f64::from(lines.anchor));
    }
    let open = |line: &Line, side: Side| line.joined[side as usize].is_none();
    let mut out = Vec::new();
    for k in 0..all.len() {
        let from = [Side::Left, Side::Right].into_iter().find(|&side| open(&all[k], side));
        if let Some(from) = from.filter(|_| !all[k].done) {
            out.push(strand(&mut all, k, from, (pitch, width)));
        }
    }
    out
}

/// The ends of lines on an outline, in its order.
fn ends(outline: &Outline, spans: &[(i32, Span)], lines: Places) -> Vec<End> {
    let end = |(at, corner): (usize, &Corner)| {
        let SpanEnd { row, u, .. } = corner.end.filter(|end| lines.prints(end.row))?;
        // The last line of the row that begins at or before u.
        let line = spans.partition_point(|&(j, s)| (j, s.start) <= (row, u)).checked_sub(1)?;
        let (j, span) = spans[line];
        let side = if span.start == u { Side::Left } else { Side::Right };
        (j == row && side.of(span) == u).then_some(End { at, line, side })
    };
    outline.iter().enumerate().filter_map(end).collect()
}

/// The arcs of one outline. Arc `k` leads from end `k` to the next.
struct Arcs<'a> {
    outline: &'a Outline,
    ends: &'a [End],
    /// How long each arc is.
    lengths: Vec<f64>,
    lines: Places,
    rows: &'a Rows,
    width: Coord,
}

impl<'a> Arcs<'a> {
    fn new(
        outline: &'a Outline,
        ends: &'a [End],
        lines: Places,
        rows: &'a Rows,
        width: Coord,
    ) -> Self {
        let mut arcs = Self { outline, ends, lengths: Vec::new(), lines, rows, width };
        arcs.lengths = (0..ends.len()).map(|k| arcs.length(k)).collect();
        arcs
    }

    /// The places of arc `k` on the outline, with both ends.
    fn places(&self, k: usize) -> impl DoubleEndedIterator<Item = usize> + use<> {
        let n = self.outline.len();
        let (from, to) = (self.ends[k].at, self.ends[(k + 1) % self.ends.len()].at);
        let (ahead, around) = if to > from { (to + 1, 0) } else { (n, to + 1) };
        (from..ahead).chain(0..around)
    }

    fn length(&self, k: usize) -> f64 {
        let places = self.places(k).map(|k| self.outline[k].at);
        let nexts = self.places(k).skip(1).map(|k| self.outline[k].at);
        places.zip(nexts).map(|(a, b)| a.distance(b)).sum()
    }

    /// The points between the first and the last of `points`, without those that matter little.
    fn points(&self, points: &[Point]) -> Vec<LinePoint> {
        let point = |p: &Point| LinePoint { u: p.x, v: p.y, width: self.width };
        let points: Vec<LinePoint> = points.iter().map(point).collect();
        bends(&points, f64::from(self.width) * BEND)
    }

    /// Joins lines along the outline.
    fn join(&self, all: &mut [Line], links: &mut Sets) {
        let n = self.ends.len();
        if n < 2 {
            return;
        }
        let longest = (LONGEST_JOIN * i64::from(self.width)) as f64;
        let short = |k: usize| {
            let length = self.lengths[k];
            let line = |k: usize| all[self.ends[k % n].line].span.len();
            let shorter = line(k).min(line(k + 1));
            let is_short = length <= longest && length <= (LONGEST_BY_LINE * shorter) as f64;
            is_short && !self.turns_back(k)
        };
        let short: Vec<bool> = (0..n).map(short).collect();
        let first = short.iter().position(|short| !short).map_or(0, |k| k + 1);
        let mut free = vec![true; n];
        for k in (first..first + n).map(|k| k % n) {
            let next = (k + 1) % n;
            let (a, b) = (self.ends[k], self.ends[next]);
            if !(short[k] && free[k] && free[next] && links.join(a.line, b.line).is_some()) {
                continue;
            }
            (free[k], free[next]) = (false, false);
            let places: Vec<Point> = self.places(k).map(|k| self.outline[k].at).collect();
            let points = self.points(&places);
            all[b.line].after[b.side as usize] = points.iter().rev().copied().collect();
            all[a.line].after[a.side as usize] = points;
            all[a.line].joined[a.side as usize] = Some((b.line, b.side));
            all[b.line].joined[b.side as usize] = Some((a.line, a.side));
        }
    }

    /// Whether arc `k` runs beside a line, but for where it leaves its own lines.
    fn turns_back(&self, k: usize) -> bool {
        let leaving = LEAVING * f64::from(self.width);
        let (mut length, mut last) = (0.0, None);
        self.places(k).map(|place| self.outline[place].at).any(|at| {
            length += last.replace(at).map_or(0.0, |last: Point| last.distance(at));
            let middle = leaving < length && length < self.lengths[k] - leaving;
            middle && !self.is_clear(at)
        })
    }

    /// Gives anchors to the ends that are not joined, each at most `longest`.
    fn anchor(&self, all: &mut [Line], longest: f64) {
        let n = self.ends.len();
        let joined = |all: &[Line], k: usize| {
            let End { line, side, .. } = self.ends[k % n];
            all[line].joined[side as usize]
        };
        // What anchors leave of each arc; nothing if it is a join.
        let left = |k: usize| {
            let next = self.ends[(k + 1) % n];
            let is_join = joined(all, k) == Some((next.line, next.side));
            if is_join && n > 1 { 0.0 } else { self.lengths[k] - f64::from(self.width) }
        };
        let mut left: Vec<f64> = (0..n).map(left).collect();
        for k in (0..n).filter(|&k| joined(all, k).is_none()).collect::<Vec<_>>() {
            let back = (k + n - 1) % n;
            let (ahead, behind): (Vec<usize>, Vec<usize>) =
                (self.places(k).collect(), self.places(back).rev().collect());
            let ahead = (self.run(&ahead, longest.min(left[k])), k);
            let behind = (self.run(&behind, longest.min(left[back])), back);
            let ((points, length), arc) = if behind.0.1 > ahead.0.1 { behind } else { ahead };
            let [.., last] = points[..] else { continue };
            if length < LEAST_ANCHOR * f64::from(self.width) {
                continue;
            }
            left[arc] -= length + f64::from(self.width);
            let End { line, side, .. } = self.ends[k];
            let mut anchor = self.points(&points);
            anchor.push(LinePoint { u: last.x, v: last.y, width: self.width });
            all[line].after[side as usize] = anchor;
        }
    }

    /// The points along `places` as far as an anchor may run, and its length. One that does not get
    /// away from its line is none.
    fn run(&self, places: &[usize], longest: f64) -> (Vec<Point>, f64) {
        let Some(&first) = places.first() else { return (Vec::new(), 0.0) };
        let mut points = vec![self.outline[first].at];
        let (mut length, mut is_away) = (0.0, false);
        for w in places.windows(2) {
            let (from, to) = (self.outline[w[0]], self.outline[w[1]]);
            let far = from.at.distance(to.at);
            let leaving = !is_away && length + far < LEAVING * f64::from(self.width);
            let is_clear = self.is_clear(to.at);
            if length >= longest || !to.wall || !(leaving || is_clear) {
                break;
            }
            is_away |= is_clear;
            let share = if far > 0.0 { ((longest - length) / far).min(1.0) } else { 1.0 };
            let on = |a: Coord, b: Coord| a + nearest(share * f64::from(b - a)) as Coord;
            points.push(Point { x: on(from.at.x, to.at.x), y: on(from.at.y, to.at.y) });
            length += share * far;
        }
        if is_away { (points, length) } else { (Vec::new(), 0.0) }
    }

    /// Whether no printed line is near `p`.
    fn is_clear(&self, p: Point) -> bool {
        let Places { pitch, offset, stride, .. } = self.lines;
        let near = f64::from(self.width) * CLEAR;
        let step = stride * pitch;
        let from = p.y - offset * pitch;
        let j = offset + (from + step / 2).div_euclid(step) * stride;
        let beside = |s: &Span| s.start <= p.x && p.x <= s.end;
        f64::from((p.y - j * pitch).abs()) >= near || !self.rows.row(j).iter().any(beside)
    }
}

/// The inner `points` that remain after decimation with tolerance `least`.
pub(super) fn bends(points: &[LinePoint], least: f64) -> Vec<LinePoint> {
    let at = |k: usize| Point { x: points[k].u, y: points[k].v };
    let kept = decimate(points.len(), |a, b| {
        let length = at(a).distance(at(b)).at_least(1.0);
        most_missed(a, b, least, |k| side(at(a), at(b), at(k)).abs() as f64 / length)
    });
    kept[1..kept.len() - 1].iter().map(|&k| points[k]).collect()
}

/// The strand that begins at the end `from` of line `k`.
fn strand(
    all: &mut [Line],
    mut k: usize,
    mut from: Side,
    (pitch, width): (Coord, Coord),
) -> Polyline {
    let mut out: Polyline = all[k].after[from as usize].iter().rev().copied().collect();
    loop {
        let line = &mut all[k];
        line.done = true;
        let end = |side: Side| LinePoint { u: side.of(line.span), v: line.row * pitch, width };
        out.extend([end(from), end(from.other())]);
        let to = from.other() as usize;
        out.append(&mut line.after[to]);
        match line.joined[to] {
            Some((next, side)) => (k, from) = (next, side),
            None => return out,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::outline::{Bounds, Columns};
    use proptest::prelude::*;

    const W: Coord = 4_000;

    /// The strands in a rectangle from 0 to `size`, whose border lies at a wall.
    fn strands_in(size: (Coord, Coord), anchor: Coord) -> Vec<Polyline> {
        let rows = |across: Coord, along: Coord| {
            let mut rows = Rows::starting_at(0);
            (0..=across / W)
                .for_each(|_| rows.push_row(|out| out.push(Span { start: 0, end: along })));
            rows
        };
        // Turned left, column c is row −c of the raster across.
        let mut across = Rows::starting_at(-(size.0 / W));
        (0..=size.0 / W)
            .for_each(|_| across.push_row(|out| out.push(Span { start: 0, end: size.1 })));
        let rows = rows(size.1, size.0);
        let columns = Columns { rows: &across, pitch: W, left_turn: true };
        let walls = [Bounds { rows: &rows, columns }];
        let lines = Places { pitch: W, offset: 0, stride: 5, anchor, inwards: 600 };
        strands(lines, &Held { rows: &rows, columns, walls: &walls }, W, W)
    }

    proptest! {
        #[test]
        fn a_zigzag_turns_along_the_walls_and_its_ends_follow_them(
            width in 100_000..400_000_i32, height in 60_000..400_000_i32, anchor in 20_000..90_000_i32
        ) {
            let strands = strands_in((width, height), anchor);
            prop_assert_eq!(strands.len(), 1);
            let (low, high) = ((0, 600), (width - 600, height - 600));
            let mut along = 0.0;
            for w in strands[0].windows(2) {
                let inside = |p: &LinePoint| {
                    low.0 <= p.u && p.u <= high.0 && 0 <= p.v && p.v <= height
                };
                prop_assert!(w.iter().all(inside), "{:?}", w);
                if w[0].u == w[1].u && (w[0].u == 600 || w[0].u == high.0) {
                    along += f64::from((w[1].v - w[0].v).abs());
                }
            }
            // One turn between two lines, at least.
            let turns = (height / W) / 5;
            prop_assert!(along >= f64::from(turns * 5 * W), "{} of {}", along, height);
        }
    }

    #[test]
    fn an_anchor_is_no_longer_than_allowed() {
        // One line in the middle of a room too low for a second.
        for anchor in [8_000, 20_000, 60_000] {
            let strands = strands_in((200_000, 18_000), anchor);
            assert_eq!(strands.len(), 1);
            let length: f64 = crate::geom::polyline::length(&strands[0]) as f64;
            assert!(length <= 200_000.0 + 2.0 * f64::from(anchor), "{length}");
            assert!(length >= 198_000.0 + f64::from(anchor), "{length}");
        }
    }

    /// A step in the wall begins just above the end of a line.
    #[test]
    fn no_strand_runs_back_beside_its_line() {
        let (wide, high, step, line) = (50 * W, 15 * W, 4 * W, 5 * W);
        for above in [400, 1_200, 2_400] {
            let mut rows = Rows::starting_at(0);
            for j in 0..=high / W {
                let start = if j * W <= line { 0 } else { step };
                rows.push_row(|out| out.push(Span { start, end: wide }));
            }
            let mut across = Rows::starting_at(-(wide / W));
            for c in (0..=wide / W).rev() {
                let end = if c * W < step { line + above } else { high };
                across.push_row(|out| out.push(Span { start: 0, end }));
            }
            let columns = Columns { rows: &across, pitch: W, left_turn: true };
            let walls = [Bounds { rows: &rows, columns }];
            let lines = Places { pitch: W, offset: 0, stride: 5, anchor: 20_000, inwards: 0 };
            let strands = strands(lines, &Held { rows: &rows, columns, walls: &walls }, W, W);
            let beside = |p: &LinePoint| p.v != line && (p.v - line).abs() < 2_800;
            let back = |w: &[LinePoint]| w.iter().any(beside) && (w[0].u - w[1].u).abs() > 2 * W;
            let all = || strands.iter().flat_map(|strand| strand.windows(2));
            assert!(!all().any(back), "{above}: {strands:?}");
        }
    }
}
