//! Rows and rows across -> Outlines: a region's border as closed polygons, exact where lines cross it.
//!
//! Words: a *node* is where a row and a column cross, a *cell* lies between two rows and two
//! columns. A *run* is the nodes of one row that one span holds. *Columns* are the rows of the
//! raster across; their pitch may be another.
//!
//! Algorithm: marching squares over the nodes. A node is inside if a span of its row holds it and does not end there.
//! The outline passes between nodes inside and outside: on a row at the span's end, on a column at
//! the end of the column's span. So it is exact on all lines, with no trigonometry and no polygon
//! clipping. It begins at the end of a run and turns from cell to cell, with the inside on its
//! left. Diagonal nodes are kept apart. A corner of the region lies within a cell; it is where the
//! edges before and after it meet.
//!
//! What holds no node, such as a tip thinner than a cell, has no outline.

use super::Point;
use super::spans::{Rows, Span, merge};
use crate::units::{Coord, nearest};

/// Sine of the least turn at which a corner is looked for within a cell, 40°. Flatter ones belong
/// to curves: at a smaller value their outline gets points outside of the curve.
const SHARP: f64 = 0.64;

/// How far from its two points a corner may lie, in cells: a little more than within one.
const FAR: f64 = 1.1;

/// Limit for how far a point is moved at acute corners and along flat edges: by the inverse of
/// this. At 0 an acute corner would be moved far into the region.
const ACUTE: f64 = 0.35;

/// Shorter edges, grid units (20 µm), have no direction of their own: rounding to the grid turns
/// them. A larger value rounds off corners near the end of a row.
const SHORT: f64 = 200.0;

/// Rows of the raster across, as a raster sees them.
#[derive(Debug, Clone, Copy)]
pub struct Columns<'a> {
    /// The rows.
    pub rows: &'a Rows,
    /// Their pitch.
    pub pitch: Coord,
    /// Their raster is turned by +90° (else by −90°).
    pub left_turn: bool,
}

impl Columns<'_> {
    /// Where the border crosses column `c` between `low` and `high`, with the inside above or below.
    fn crossing(&self, c: i32, (low, high): (Coord, Coord), inside_above: bool) -> Option<Coord> {
        // Turned left, their u is v, and column c is their row −c; else their u is −v.
        let (j, sign) = if self.left_turn { (-c, 1) } else { (c, -1) };
        let starts = inside_above == self.left_turn;
        let end = |s: &Span| if starts { s.start } else { s.end };
        let (low, high) = if self.left_turn { (low, high) } else { (-high, -low) };
        let row = self.rows.row(j);
        let first = row.get(row.partition_point(|s| end(s) < low)).map(end);
        first.filter(|end| *end <= high).map(|end| sign * end)
    }

    /// The span of column `c` that holds `v`.
    #[must_use]
    pub fn chord(&self, c: i32, v: Coord) -> Option<Span> {
        let (j, v) = if self.left_turn { (-c, v) } else { (c, -v) };
        self.rows.span_at(j, v)
    }

    /// What of `rows`, `pitch` apart, columns hold: of each column half its distance to both sides.
    /// Spans between two columns stay.
    #[must_use]
    pub fn held(&self, rows: &Rows, pitch: Coord) -> Rows {
        let half = self.pitch / 2;
        let column = |at: Coord| (at + half).div_euclid(self.pitch);
        let mut out = Rows::with_room_of(rows, rows.range().start);
        for (j, row) in rows.iter() {
            let cells = row.iter().flat_map(|&span| {
                let columns = column(span.start)..=column(span.end);
                let only = columns.start() == columns.end();
                let held = columns.filter(move |&c| only || self.chord(c, j * pitch).is_some());
                held.filter_map(move |c| {
                    let (low, high) = (c * self.pitch - half, c * self.pitch + half);
                    Span::new(low.max(span.start), high.min(span.end))
                })
            });
            let mut cells: Vec<Span> = cells.collect();
            out.push_row(|out| merge(&mut cells, out));
        }
        out
    }

    /// The columns of all spans, with their lower and upper ends.
    pub fn spans(&self) -> impl Iterator<Item = (i32, Coord, Coord)> {
        let seen = |j: i32, s: &Span| match self.left_turn {
            true => (-j, s.start, s.end),
            false => (j, -s.end, -s.start),
        };
        self.rows.iter().flat_map(move |(j, row)| row.iter().map(move |s| seen(j, s)))
    }
}

/// What lies around a region: ends of it that are also ends here are at a wall.
#[derive(Debug, Clone, Copy)]
pub struct Bounds<'a> {
    /// On the rows.
    pub rows: &'a Rows,
    /// On the columns.
    pub columns: Columns<'a>,
}

/// A point of an outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Corner {
    /// Where it is.
    pub at: Point,
    /// The end of a span that it was before the outline was moved, if it lies on a row.
    pub end: Option<SpanEnd>,
    /// Whether it is at a wall.
    pub wall: bool,
}

/// The end of a span on a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SpanEnd {
    /// The row.
    pub row: i32,
    /// Where it is on the row.
    pub u: Coord,
    /// Whether it is the left end, with the region on its right.
    pub left: bool,
}

/// A closed outline, with the region on its left.
pub type Outline = Vec<Corner>;

/// The outlines of `rows`, which are `pitch` apart, with `columns` of the same region. `bounds` are
/// the walls around it; where it is at one, it is moved inwards by `inwards`.
#[must_use]
pub fn outlines(
    rows: &Rows,
    pitch: Coord,
    columns: Columns<'_>,
    bounds: &[Bounds<'_>],
    inwards: Coord,
) -> Vec<Outline> {
    let grid = Grid::new(rows, pitch, columns, bounds);
    let mut seen = vec![false; grid.runs.len()];
    let (mut out, mut walked) = (Vec::new(), Outline::new());
    for (j, index) in grid.all_runs() {
        if !seen[index] {
            grid.walk(j, index, &mut seen, &mut walked);
            let (outline, ring) = with_corners(&walked, pitch.max(columns.pitch));
            out.push(moved(&outline, &ring, f64::from(inwards)));
        }
    }
    out
}

/// The nodes that a span holds.
#[derive(Debug, Clone, Copy)]
struct Run {
    first: i32,
    last: i32,
    span: Span,
}

/// A node: its column and row.
type Node = (i32, i32);

struct Grid<'a> {
    first: i32,
    /// Where the runs of each row begin in `runs`, and where the last row ends.
    starts: Vec<usize>,
    runs: Vec<Run>,
    pitch: Coord,
    columns: Columns<'a>,
    bounds: &'a [Bounds<'a>],
}

impl<'a> Grid<'a> {
    fn new(rows: &Rows, pitch: Coord, columns: Columns<'a>, bounds: &'a [Bounds<'a>]) -> Self {
        let mut grid = Self {
            first: rows.range().start,
            starts: vec![0],
            runs: Vec::new(),
            pitch,
            columns,
            bounds,
        };
        for (_, row) in rows.iter() {
            let base = grid.runs.len();
            for &span in row {
                // A node on the border is outside: the column there may have nothing.
                let first = span.start.div_euclid(columns.pitch) + 1;
                let last = (span.end - 1).div_euclid(columns.pitch);
                match grid.runs[base..].last_mut() {
                    // No node lies in the gap before it.
                    Some(before) if before.last + 1 >= first => {
                        before.last = before.last.max(last);
                        before.span.end = span.end;
                    }
                    _ if first <= last => grid.runs.push(Run { first, last, span }),
                    _ => {}
                }
            }
            grid.starts.push(grid.runs.len());
        }
        grid
    }

    /// The rows and indices of all runs.
    fn all_runs(&self) -> impl Iterator<Item = (i32, usize)> {
        let rows = (self.first..).zip(self.starts.windows(2));
        rows.flat_map(|(j, ends)| (ends[0]..ends[1]).map(move |index| (j, index)))
    }

    /// The run that holds a node; `None` if the node is outside.
    fn run(&self, (c, j): Node) -> Option<usize> {
        let k = usize::try_from(j.checked_sub(self.first)?).ok()?;
        let &[from, to] = self.starts.get(k..k + 2)? else { return None };
        let index = from + self.runs[from..to].partition_point(|run| run.last < c);
        (index < to && self.runs[index].first <= c).then_some(index)
    }

    /// The outline that passes the left end of run `index` of row `j`, as `out`. Runs whose left ends
    /// it passes are `seen`.
    fn walk(&self, j: i32, index: usize, seen: &mut [bool], out: &mut Outline) {
        let first = self.runs[index].first;
        let start: (Node, Node) = ((first, j), (first - 1, j));
        let ((mut inside, mut outside), mut run) = (start, index);
        out.clear();
        loop {
            if inside.1 == outside.1 && outside.0 < inside.0 {
                seen[run] = true;
            }
            out.push(self.corner((inside, run), outside));
            // From the outside to the inside is to the left, so ahead is a turn to the right.
            let ahead = (inside.1 - outside.1, outside.0 - inside.0);
            let step = |(c, j): Node| (c + ahead.0, j + ahead.1);
            let (left, right) = (step(inside), step(outside));
            match self.run(left) {
                None => outside = left,
                Some(at_left) => match self.run(right) {
                    Some(at_right) => (inside, run) = (right, at_right),
                    None => (inside, outside, run) = (left, right, at_left),
                },
            }
            if (inside, outside) == start {
                return;
            }
        }
    }

    /// The point of the border between two neighbouring nodes, of which `run` holds the one inside.
    fn corner(&self, (inside, run): (Node, usize), outside: Node) -> Corner {
        let v = inside.1 * self.pitch;
        if inside.1 == outside.1 {
            let left = outside.0 < inside.0;
            let end = |s: &Span| if left { s.start } else { s.end };
            let u = end(&self.runs[run].span);
            let same = |b: &Bounds<'_>| {
                let row = b.rows.row(inside.1);
                row.get(row.partition_point(|s| end(s) < u)).is_some_and(|s| end(s) == u)
            };
            let wall = self.bounds.iter().any(same);
            let end = SpanEnd { row: inside.1, u, left };
            return Corner { at: Point { x: u, y: v }, end: Some(end), wall };
        }
        let (c, above) = (inside.0, outside.1 < inside.1);
        let between = if above { (v - self.pitch, v) } else { (v, v + self.pitch) };
        let found = self.columns.crossing(c, between, above);
        let same = |b: &Bounds<'_>| b.columns.crossing(c, between, above) == found;
        let wall = found.is_some() && self.bounds.iter().any(same);
        let at = Point { x: c * self.columns.pitch, y: found.unwrap_or(v) };
        Corner { at, end: None, wall }
    }
}

/// The direction from `a` to `b`, of length 1, and the distance.
fn towards(a: Point, b: Point) -> ([f64; 2], f64) {
    let (x, y) = (f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y));
    let length = (x * x + y * y).sqrt();
    let by = if length > 0.0 { 1.0 / length } else { 0.0 };
    ([x * by, y * by], length)
}

/// The points of a closed outline and the directions of its edges, each computed once.
struct Ring {
    at: Vec<Point>,
    /// From each point to the next: the direction and the distance.
    ways: Vec<([f64; 2], f64)>,
}

impl Ring {
    fn new(points: impl Iterator<Item = Point>) -> Self {
        let at: Vec<Point> = points.collect();
        let next = at.iter().skip(1).chain(at.first());
        let ways = at.iter().zip(next).map(|(a, b)| towards(*a, *b)).collect();
        Self { at, ways }
    }

    fn len(&self) -> usize {
        self.at.len()
    }

    /// The number `by` points after `k`.
    fn after(&self, k: usize, by: usize) -> usize {
        let (k, n) = (k + by, self.len());
        if k < n { k } else { k % n }
    }

    /// The number `by` points before `k`.
    fn before(&self, k: usize, by: usize) -> usize {
        if k >= by { k - by } else { (k + by * self.len() - by) % self.len() }
    }

    /// The direction in which the outline comes to point `k`. Very short edges have none of their own:
    /// up to three are taken together.
    fn coming(&self, k: usize) -> [f64; 2] {
        let (way, length) = self.ways[self.before(k, 1)];
        let far = |other: &Point| other.distance(self.at[k]) >= SHORT;
        if length >= SHORT {
            return way;
        }
        let earlier = [2, 3].map(|by| self.at[self.before(k, by)]);
        earlier.into_iter().find(far).map_or(way, |from| towards(from, self.at[k]).0)
    }

    /// The direction in which the outline leaves point `k`, as [`Self::coming`].
    fn leaving(&self, k: usize) -> [f64; 2] {
        let (way, length) = self.ways[k];
        let far = |other: &Point| other.distance(self.at[k]) >= SHORT;
        if length >= SHORT {
            return way;
        }
        let later = [2, 3].map(|by| self.at[self.after(k, by)]);
        later.into_iter().find(far).map_or(way, |to| towards(self.at[k], to).0)
    }
}

/// An outline with the corners that lie within cells, and whether each point is one of these.
fn with_corners(outline: &[Corner], cell: Coord) -> (Vec<(Corner, bool)>, Ring) {
    let ring = Ring::new(outline.iter().map(|corner| corner.at));
    let mut out = Vec::with_capacity(ring.len() + 8);
    for (k, &p) in outline.iter().enumerate() {
        out.push((p, false));
        let next = ring.after(k, 1);
        let (a, b, q) = (ring.coming(k), ring.leaving(next), outline[next]);
        let ((way, length), turn) = (ring.ways[k], a[0] * b[1] - a[1] * b[0]);
        if turn.abs() < SHARP {
            continue;
        }
        // p + s a = q − t b.
        let s = length * (way[0] * b[1] - way[1] * b[0]) / turn;
        let t = length * (a[0] * way[1] - a[1] * way[0]) / turn;
        let near = |x: f64| x > 0.0 && x <= FAR * f64::from(cell);
        if near(s) && near(t) {
            let on = |x: Coord, a: f64| nearest(f64::from(x) + s * a) as Coord;
            let at = Point { x: on(p.at.x, a[0]), y: on(p.at.y, a[1]) };
            out.push((Corner { at, end: None, wall: p.wall && q.wall }, true));
        }
    }
    // Most outlines bend too little for corners.
    let whole = out.len() == ring.len();
    let ring = if whole { ring } else { Ring::new(out.iter().map(|(corner, _)| corner.at)) };
    (out, ring)
}

/// An outline moved inwards where it is at a wall. Ends of rows stay on their row. Points on
/// columns that a corner has passed are dropped.
fn moved(outline: &[(Corner, bool)], ring: &Ring, inwards: f64) -> Outline {
    let moved = |(k, (corner, _)): (usize, &(Corner, bool))| {
        if !corner.wall {
            return *corner;
        }
        let (a, b) = (ring.coming(k), ring.leaving(k));
        // The sum of both normals to the left; both edges move by 1 if the corner moves by this.
        let (x, y) = (-a[1] - b[1], a[0] + b[0]);
        let by = inwards / (1.0 + a[0] * b[0] + a[1] * b[1]).max(ACUTE);
        let (x, y) = match corner.end {
            // The end of a row stays on it. On a flat edge the normal does not tell where inwards is.
            Some(SpanEnd { left, .. }) => {
                let sign = if left { 1.0 } else { -1.0 };
                (sign * inwards / (x.abs() / 2.0).max(ACUTE), 0.0)
            }
            None => (x * by, y * by),
        };
        let at = Point {
            x: nearest(f64::from(corner.at.x) + x) as Coord,
            y: nearest(f64::from(corner.at.y) + y) as Coord,
        };
        Corner { at, ..*corner }
    };
    let all: Outline = outline.iter().enumerate().map(moved).collect();
    let passed = |k: usize| {
        let next = ring.after(k, 1);
        let way = |a: Point, b: Point| [i64::from(b.x - a.x), i64::from(b.y - a.y)];
        let (a, b) = (way(ring.at[k], ring.at[next]), way(all[k].at, all[next].at));
        a[0] * b[0] + a[1] * b[1] < 0
    };
    let stays = |&k: &usize| {
        let (corner, inserted) = outline[k];
        inserted || corner.end.is_some() || !(passed(k) || passed(ring.before(k, 1)))
    };
    let mut out = Outline::with_capacity(all.len());
    out.extend((0..all.len()).filter(stays).map(|k| all[k]));
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const W: Coord = 4_000;

    /// The rows of a region of which `chord` gives the span at each v.
    fn rows(chord: impl Fn(Coord) -> Option<Span>) -> Rows {
        let mut rows = Rows::starting_at(-60);
        for j in -60..60 {
            rows.push_row(|out| out.extend(chord(j * W)));
        }
        rows
    }

    fn outline(rows: &Rows, columns: &Rows, inwards: Coord) -> Vec<Outline> {
        // Turned right, the columns of a region that is symmetric to both axes are its rows.
        let columns = Columns { rows: columns, pitch: W, left_turn: false };
        outlines(rows, W, columns, &[Bounds { rows, columns }], inwards)
    }

    #[test]
    fn a_rectangle_keeps_its_corners_and_moves_inwards_as_a_whole() {
        let (a, b) = (50_300, 31_700);
        let chord = |low: Coord, high: Coord| {
            move |v: Coord| (v.abs() <= high).then_some(Span { start: -low, end: low })
        };
        let found = outline(&rows(chord(a, b)), &rows(chord(b, a)), 600);
        assert_eq!(found.len(), 1);
        let on = |p: &Corner| p.at.x.abs() == a - 600 || p.at.y.abs() == b - 600;
        assert!(found[0].iter().all(|p| p.wall && on(p)), "{found:?}");
        for (x, y) in [(1, 1), (1, -1), (-1, 1), (-1, -1)] {
            let corner = Point { x: x * (a - 600), y: y * (b - 600) };
            assert!(found[0].iter().any(|p| p.at == corner), "{corner:?}");
        }
    }

    /// How far the points of the outline of a circle, moved inwards, lie outside of where they should.
    fn off(radius: Coord, inwards: Coord) -> (Outline, Vec<f64>) {
        let chord = |v: Coord| {
            let (r, v) = (f64::from(radius), f64::from(v));
            let half = (r * r - v * v).max(0.0).sqrt() as Coord;
            (half > 0).then_some(Span { start: -half, end: half })
        };
        let all = rows(chord);
        let mut found = outline(&all, &all, inwards);
        assert_eq!(found.len(), 1);
        let found = found.remove(0);
        let off = |p: &Corner| p.at.distance(Point::default()) - f64::from(radius - inwards);
        let all = found.iter().map(off).collect();
        (found, all)
    }

    #[test]
    fn no_point_of_a_circle_lies_outside() {
        // A flat edge on a row, whose end moves along it; a point on a row beside one on a column.
        for (radius, inwards) in [(29_121, 354), (32_250, 1_000), (59_465, 0)] {
            for off in off(radius, inwards).1 {
                assert!(off < f64::from(inwards) + 600.0, "{radius} {inwards}: {off}");
            }
        }
    }

    proptest! {
        #[test]
        fn the_outline_of_a_circle_lies_on_it(radius in 20_000..200_000_i32, inwards in 0..1_000_i32) {
            let (found, all) = off(radius, inwards);
            for (k, (p, off)) in found.iter().zip(all).enumerate() {
                // An end of a row on a flat edge stays on its row, and is moved inwards along it. A
                // bend that rows and columns both miss is cut by up to a cell's half diagonal.
                let least = -0.75 * f64::from(W) - f64::from(inwards);
                prop_assert!(off > least, "{:?} is off by {}", p, off);
                prop_assert!(off < f64::from(inwards) + 800.0, "{:?} is off by {}", p, off);
                let next = found[(k + 1) % found.len()].at;
                prop_assert!(p.at.distance(next) < 2.0 * f64::from(W));
            }
        }
    }
}
