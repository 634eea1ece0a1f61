//! Lines -> Chains: neighbouring raster lines joined end to end in zig-zags.
//!
//! A join goes from the end of one line to the same end of the next, straight
//! where that stays inside the region, else along the region's edge as the fine
//! lines between show it. Lines that cannot be joined begin a new chain.

use crate::geom::spans::{Rows, Span};
use crate::geom::{Point, side};
use crate::region::variable_width::{self, Joined, Line, LinePoint};
use crate::region::{Hatch, Params};
use crate::units::{Bounded as _, Coord};

/// Lines joined end to end, in the frame of their raster.
pub type Chain = Vec<LinePoint>;

/// A join between two solid lines may run at most this many line widths along
/// them: a longer one would lie on its neighbours.
const LONGEST_SOLID_JOIN: Coord = 2;

/// A join of sparse lines runs at most this many rows' distance along them from row to row.
const FLATTEST_STEP: Coord = 2;

/// Width of a join between two solid lines, in line widths: the rest of what it covers
/// is filled by the lines' round ends.
const SOLID_JOIN_WIDTH: f64 = 0.25;

/// The same where turns are rounded: arcs cover more than corners do.
const ROUND_JOIN_WIDTH: f64 = 0.1;

/// Solid lines that turn in an arc reach further by the arc's radius over this.
const REACH: Coord = 4;

/// Ends of sparse lines further apart than this, in line widths, are not joined: the
/// joins along a wall would weigh more than the lines, most where lines of several
/// directions end there.
const LONGEST_SPARSE_JOIN: i64 = 12;

/// A straight join may leave its region by this much (10 µm): edges are rounded to the grid.
const SLACK: Coord = 100;

/// Bends of a join along an edge that move it by less, in line widths, are left out.
const BEND: f64 = 0.125;

/// Lines are joined if their distance is at most this many times the shorter one's length.
const LONGEST_JOIN: i64 = 4;

/// Solid lines shorter than this are left out (50 µm): the ends of their neighbours
/// cover them. A sparse line shorter than it is wide is left out: it would be a blob.
const LEAST_SOLID: i64 = 500;

/// Which end of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

impl Side {
    fn other(self) -> Self {
        if self == Self::Left { Self::Right } else { Self::Left }
    }

    /// The end of `span` on this side.
    fn of(self, span: Span) -> Coord {
        if self == Self::Left { span.start } else { span.end }
    }
}

/// A line of a zig-zag.
#[derive(Debug)]
struct Link {
    /// The points between the line before and this one.
    join: Vec<LinePoint>,
    row: i32,
    /// Which of its row's lines, among those given to [`link`].
    index: usize,
    span: Span,
    /// Where it is entered. Of a line without a neighbour either end will do.
    from: Side,
}

/// Chains of skin lines, closed up to the walls. Their turns will be rounded with `radius`.
#[must_use]
pub fn skin(lines: &[Line], params: &Params, radius: Coord) -> Vec<Chain> {
    let pitch = params.line_width;
    let rows: Vec<&[Line]> = lines.chunk_by(|a, b| a.row == b.row).collect();
    let solid = |line: &Line| Some(line.span).filter(|s| s.len() >= LEAST_SOLID);
    let spans = rows.iter().map(|row| (row[0].row, row.iter().map(solid)));
    let join = |from: (Coord, i32), to: (Coord, i32), _: Side| {
        ((from.0 - to.0).abs() <= LONGEST_SOLID_JOIN * pitch).then(Vec::new)
    };
    // Rows come in order, but rows without skin are left out.
    let line = |row: i32, index: usize| &rows[rows.partition_point(|r| r[0].row < row)][index];
    link(spans, 1, pitch, join)
        .into_iter()
        .map(|zigzag| {
            let mut chain = Vec::with_capacity(2 * zigzag.len());
            for (k, link) in zigzag.iter().enumerate() {
                let mut joined = Joined::default();
                if k > 0 {
                    joined.below(link.from == Side::Left);
                }
                if k + 1 < zigzag.len() {
                    joined.above(link.from == Side::Right);
                }
                let mut points = variable_width::points(line(link.row, link.index), joined, params);
                if link.from == Side::Right {
                    points.reverse();
                }
                let ends = (k > 0, k + 1 < zigzag.len());
                reach(&mut points, ends, link.from, radius);
                lay(points, &mut chain, pitch, radius);
            }
            chain
        })
        .collect()
}

/// Moves those ends of a line that are joined (the first and the last of `points`, entered
/// from `side`) outwards, so that the arcs there cover what lies between their corners.
fn reach(points: &mut [LinePoint], joined: (bool, bool), side: Side, radius: Coord) {
    let by = if side == Side::Left { radius / REACH } else { -radius / REACH };
    if let [first, .., last] = points {
        first.u -= if joined.0 { by } else { 0 };
        last.u += if joined.1 { by } else { 0 };
    }
}

/// Appends a line, given with the widths at its points, to a chain of widths on the
/// way to them.
fn lay(points: Vec<LinePoint>, chain: &mut Chain, line_width: Coord, radius: Coord) {
    let share = if radius > 0 { ROUND_JOIN_WIDTH } else { SOLID_JOIN_WIDTH };
    let join = (f64::from(line_width) * share) as Coord;
    let mut before = None;
    for point in points {
        let width = before.map_or(join, |b: Coord| (b + point.width) / 2);
        before = Some(point.width);
        chain.push(LinePoint { width, ..point });
    }
}

/// Chains of the lines that are printed of a sparse region; `pitch` is the distance
/// of its rows.
#[must_use]
pub fn hatch(hatch: &Hatch, pitch: Coord, line_width: Coord) -> Vec<Chain> {
    let Hatch { comb, rows: region, width, .. } = hatch;
    let (stride, width) = (comb.stride, *width);
    let printed = region.iter().filter(|(j, _)| comb.prints(*j));
    let long = |s: &Span| Some(*s).filter(|s| s.len() >= i64::from(line_width));
    let rows = printed.map(|(j, row)| (j, row.iter().map(long)));
    let edges = Edges { region, pitch, width };
    let short = |from: (Coord, i32), to: (Coord, i32)| {
        let (du, dv) = (i64::from(to.0 - from.0), i64::from((to.1 - from.1) * pitch));
        du * du + dv * dv <= (LONGEST_SPARSE_JOIN * i64::from(width)).pow(2)
    };
    let join = |from: (Coord, i32), to: (Coord, i32), side: Side| {
        let straight = || edges.straight(from, to).then(Vec::new);
        let join = || straight().or_else(|| edges.along(from, to, side));
        (comb.joined && short(from, to)).then(join).flatten()
    };
    link(rows, stride, stride * pitch, join)
        .into_iter()
        .map(|zigzag| {
            let mut chain = Vec::with_capacity(2 * zigzag.len());
            for link in zigzag {
                chain.extend(link.join);
                let v = link.row * pitch;
                let end = |side: Side| LinePoint { u: side.of(link.span), v, width };
                chain.extend([end(link.from), end(link.from.other())]);
            }
            chain
        })
        .collect()
}

/// The edges of a sparse region, as its fine rows show them. Ends are given as `(u, row)`.
struct Edges<'a> {
    region: &'a Rows,
    pitch: Coord,
    width: Coord,
}

impl Edges<'_> {
    /// Whether the straight join is inside the region on every row between.
    fn straight(&self, (u, a): (Coord, i32), (to, b): (Coord, i32)) -> bool {
        let run = i64::from(to) - i64::from(u);
        // A flatter join could slip past a hole between two rows.
        run.abs() <= i64::from(FLATTEST_STEP * self.pitch * (b - a))
            && (a + 1..b).all(|j| {
                let u = u + (run * i64::from(j - a) / i64::from(b - a)) as Coord;
                let holds = |s: &Span| s.start - SLACK <= u && u <= s.end + SLACK;
                self.region.row(j).iter().any(holds)
            })
    }

    /// The points of a join along the region's edge, if one edge leads there.
    fn along(
        &self,
        (u, a): (Coord, i32),
        (to, b): (Coord, i32),
        side: Side,
    ) -> Option<Vec<LinePoint>> {
        // Along a flatter edge a join would be longer than a travel is worth.
        let step = FLATTEST_STEP * self.pitch;
        let mut at = u;
        let mut points = Vec::new();
        for j in a + 1..b {
            let ends = self.region.row(j).iter().map(|&s| side.of(s));
            at = ends.filter(|u| (u - at).abs() <= step).min_by_key(|u| ((u - at).abs(), *u))?;
            points.push(LinePoint { u: at, v: j * self.pitch, width: self.width });
        }
        ((to - at).abs() <= step).then(|| {
            let end = |u, row| LinePoint { u, v: row * self.pitch, width: self.width };
            let mut kept = Vec::new();
            keep_bends(&points, end(u, a), end(to, b), f64::from(self.width) * BEND, &mut kept);
            kept
        })
    }
}

/// Of `points` between `a` and `b`, keeps those that straight lines between the kept ones would
/// miss by more than `least` (Ramer 1972, Douglas and Peucker 1973).
fn keep_bends(
    points: &[LinePoint],
    a: LinePoint,
    b: LinePoint,
    least: f64,
    kept: &mut Vec<LinePoint>,
) {
    let at = |p: LinePoint| Point { x: p.u, y: p.v };
    let length = at(a).distance(at(b)).at_least(1.0);
    let miss = |p: LinePoint| side(at(a), at(b), at(p)).abs() as f64 / length;
    let worst = (0..points.len())
        .max_by(|&k, &l| miss(points[k]).total_cmp(&miss(points[l])).then(l.cmp(&k)));
    if let Some(k) = worst.filter(|&k| miss(points[k]) > least) {
        keep_bends(&points[..k], a, points[k], least, kept);
        kept.push(points[k]);
        keep_bends(&points[k + 1..], points[k], b, least, kept);
    }
}

/// Joins lines of rows `stride` apart that lie beside each other or at most `slack`
/// apart along the lines; what is none is left out. `join` gives the points between two ends, given as
/// `(u, row)`, or none if they cannot be joined.
fn link(
    rows: impl Iterator<Item = (i32, impl Iterator<Item = Option<Span>>)>,
    stride: i32,
    slack: Coord,
    join: impl Fn((Coord, i32), (Coord, i32), Side) -> Option<Vec<LinePoint>>,
) -> Vec<Vec<Link>> {
    let mut done: Vec<Vec<Link>> = Vec::new();
    let mut open: Vec<Vec<Link>> = Vec::new();
    let (mut free, mut growing) = (Vec::new(), Vec::new());
    for (row, spans) in rows {
        free.extend(spans);
        if open.first().and_then(|c| c.last()).is_some_and(|l| l.row + stride != row) {
            done.append(&mut open);
        }
        for mut chain in open.drain(..) {
            match extend(&mut chain, row, &mut free, slack, &join) {
                Some(index) => growing.push((index, chain)),
                None => done.push(chain),
            }
        }
        for (index, span) in free.drain(..).enumerate() {
            let link = |span| Link { join: Vec::new(), row, index, span, from: Side::Left };
            growing.extend(span.map(|span| (index, vec![link(span)])));
        }
        growing.sort_by_key(|(index, _)| *index);
        open.extend(growing.drain(..).map(|(_, chain)| chain));
    }
    done.append(&mut open);
    done
}

/// Goes on with `chain` in a line of `row`: of those that are free and near its last
/// line the outermost on the side it ended. Says which, if it could be joined.
fn extend(
    chain: &mut Vec<Link>,
    row: i32,
    free: &mut [Option<Span>],
    slack: Coord,
    join: &impl Fn((Coord, i32), (Coord, i32), Side) -> Option<Vec<LinePoint>>,
) -> Option<usize> {
    let alone = chain.len() == 1;
    let last = chain.last_mut()?;
    let near = Span { start: last.span.start - slack, end: last.span.end + slack };
    let (both, onward) = ([Side::Right, Side::Left], [last.from.other()]);
    let sides: &[Side] = if alone { &both } else { &onward };
    let (index, side, span, points) = sides.iter().find_map(|&side| {
        let mut beside = free
            .iter()
            .enumerate()
            .filter_map(|(k, s)| s.filter(|s| s.overlaps(near)).map(|s| (k, s)));
        let (index, span) = if side == Side::Right { beside.next_back() } else { beside.next() }?;
        // A join much longer than the lines it joins would be an infill of its own.
        let shorter = last.span.len().min(span.len());
        let worth = i64::from(slack) <= LONGEST_JOIN * shorter;
        let ends = ((side.of(last.span), last.row), (side.of(span), row));
        let points = worth.then(|| join(ends.0, ends.1, side)).flatten()?;
        Some((index, side, span, points))
    })?;
    free[index] = None;
    last.from = side.other();
    chain.push(Link { join: points, row, index, span, from: side });
    Some(index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::spans::subtract;
    use crate::region::Comb;

    const W: Coord = 4_000;

    fn every(stride: i32, rows: &Rows) -> Hatch {
        let comb = Comb { raster: 0, offset: 0, stride, joined: true };
        Hatch { comb, rows: rows.clone(), layers: 1, width: W }
    }

    /// Rows 0 to `count`, 40 mm long, without `hole` on the rows it names.
    fn region(count: i32, hole: Option<(std::ops::Range<i32>, Span)>) -> Rows {
        let whole = [Span { start: 0, end: 400_000 }];
        let mut rows = Rows::starting_at(0);
        for j in 0..count {
            let cut = hole.as_ref().filter(|(rows, _)| rows.contains(&j)).map(|(_, s)| *s);
            rows.push_row(|out| subtract(&whole, cut.as_slice(), out));
        }
        rows
    }

    fn joins_are_inside(region: &Rows, chain: &Chain) {
        for w in chain.windows(2).filter(|w| w[0].v != w[1].v) {
            for j in w[0].v.min(w[1].v) / W..=w[0].v.max(w[1].v) / W {
                let holds = |u: Coord| region.row(j).iter().any(|s| s.start <= u && u <= s.end);
                assert!(holds(w[0].u) && holds(w[1].u), "{w:?} on row {j}");
            }
        }
    }

    #[test]
    fn a_convex_region_is_one_zigzag() {
        let chains = hatch(&every(5, &region(26, None)), W, W);
        assert_eq!(chains.len(), 1);
        let ends: Vec<Coord> = chains[0].iter().map(|p| p.u).collect();
        assert_eq!(ends[..6], [0, 400_000, 400_000, 0, 0, 400_000]);
        assert_eq!(chains[0].len(), 12);
    }

    #[test]
    fn joins_go_round_a_hole_and_never_across() {
        let hole = (6..14, Span { start: 100_000, end: 300_000 });
        let region = region(26, Some(hole));
        let chains = hatch(&every(5, &region), W, W);
        chains.iter().for_each(|chain| joins_are_inside(&region, chain));
        let lines: usize = chains.iter().map(|c| c.len() / 2).sum();
        assert_eq!(lines, 7, "six rows, one of them in two pieces: {chains:?}");
        assert!(chains.len() > 1);
    }

    #[test]
    fn lines_of_a_crossing_pattern_are_not_joined() {
        let mut grid = every(5, &region(26, None));
        grid.comb.joined = false;
        let chains = hatch(&grid, W, W);
        assert_eq!(chains.len(), 6);
    }

    #[test]
    fn sparse_lines_far_apart_are_not_joined() {
        let chains = hatch(&every(20, &region(41, None)), W, W);
        assert_eq!(chains.len(), 3);
        assert!(chains.iter().all(|c| c.len() == 2));
    }

    #[test]
    fn a_sparse_line_shorter_than_wide_is_left_out() {
        let mut rows = Rows::starting_at(0);
        rows.push_row(|out| out.push(Span { start: 0, end: W - 1 }));
        assert!(hatch(&every(1, &rows), W, W).is_empty());
    }
}
