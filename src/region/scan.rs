//! Contours -> Rows: the inside of a layer on raster lines, grown or shrunk by an exact distance.
//!
//! Words: a *crossing* is where a raster line meets an edge. The *winding number* says how often
//! the contours go around a place; inside is where it is not zero. A *capsule* is the set of all
//! points within a distance `r` of an edge, a *chord* what a line cuts out of it. A *flank* is
//! the left or right border of a capsule.
//!
//! Algorithm:
//! 1. Find the crossings of all rows, sort each row, and sum the winding numbers. An edge crosses
//!    a line at `v` if one end is below `v` and the other at or above it. So a vertex on the line
//!    is never counted twice, and every closed contour gives balanced crossings.
//! 2. Find the chords of the capsules around all edges. Inside spans minus chords are the exact
//!    Euclidean inset; the union of both is the outset. No polygon offset is needed.
//!
//! For an inset, an edge gives chords only on rows where it may be the nearest one to a place
//! inside (`Stretch::inner`). All other chords are covered anyway.

use crate::geom::raster::Raster;
use crate::geom::spans::{Rows, Span, merge, subtract};
use crate::geom::{Contour, Point, edges, side};
use crate::units::{Bounded as _, Coord, between, nearest};
use std::ops::Range;

/// Rows this much above and below an edge are searched too (2 µm). Rounding the contours to the
/// grid moves their ends by less. At 0 an inset may keep places near a vertex; a larger value only
/// costs time.
const MARGIN: Coord = 20;

/// A layer's contours in the frame of a raster, and their inside on its rows: ready for insets and
/// outsets.
#[derive(Debug)]
pub struct Scan {
    raster: Raster,
    contours: Vec<Contour>,
    inside: Rows,
}

impl Scan {
    /// Scans `contours` (closed, outside counter-clockwise) with the lines of `raster`.
    #[must_use]
    pub fn new(contours: &[Contour], raster: Raster) -> Self {
        let contours: Vec<Contour> =
            contours.iter().map(|c| c.iter().map(|&p| raster.frame.enter(p)).collect()).collect();
        let inside = inside(&contours, raster);
        Self { raster, contours, inside }
    }

    /// The spans of the lines inside the contours.
    #[must_use]
    pub fn inside(&self) -> &Rows {
        &self.inside
    }

    /// The spans inside and at least `distance` from every contour.
    #[must_use]
    pub fn inset(&self, distance: Coord) -> Rows {
        if distance <= 0 {
            return self.inside.clone();
        }
        let mut stretches = Vec::with_capacity(self.contours.iter().map(Vec::len).sum());
        for contour in &self.contours {
            let [.., mut p, mut q] = contour[..] else { continue };
            for &next in contour {
                stretches.push(Stretch::inner([p, q, next], distance, self.raster));
                (p, q) = (q, next);
            }
        }
        let mut chords = chords(&stretches, self.raster);
        let mut covered = Vec::new();
        let mut out = Rows::with_room_of(&self.inside, self.inside.range().start);
        for (j, row) in self.inside.iter() {
            covered.clear();
            merge(chords.row(j), &mut covered);
            out.push_row(|spans| subtract(row, &covered, spans));
        }
        out
    }

    /// The spans inside or at most `distance` from a contour.
    #[must_use]
    pub fn outset(&self, distance: Coord) -> Rows {
        if distance <= 0 {
            return self.inside.clone();
        }
        let whole = |(p, q)| Stretch::whole(p, q, distance, self.raster);
        let all = self.contours.iter().flat_map(|c| edges(c));
        let mut chords = chords(&all.map(whole).collect::<Vec<_>>(), self.raster);
        let mut both = Vec::new();
        let mut out = Rows::starting_at(chords.first);
        for j in chords.range() {
            both.clear();
            both.extend_from_slice(self.inside.row(j));
            both.extend_from_slice(chords.row(j));
            out.push_row(|spans| merge(&mut both, spans));
        }
        out
    }
}

/// The spans of `raster` within the radius of an edge. `edges` holds the ends and the radius of
/// each, in the raster's frame.
#[must_use]
pub fn around(edges: &[(Point, Point, Coord)], raster: Raster) -> Rows {
    around_on(i32::MIN..i32::MAX, edges, raster)
}

/// As [`around`], of edges that are given in the frame of the part.
#[must_use]
pub fn around_in_part(edges: impl Iterator<Item = (Point, Point, Coord)>, raster: Raster) -> Rows {
    let enter = |(p, q, r)| (raster.frame.enter(p), raster.frame.enter(q), r);
    around(&edges.map(enter).collect::<Vec<_>>(), raster)
}

/// As [`around`], on the rows `wanted` only.
#[must_use]
pub fn around_on(wanted: Range<i32>, edges: &[(Point, Point, Coord)], raster: Raster) -> Rows {
    let all = edges.iter().map(|&(p, q, r)| {
        let Stretch { capsule, rows } = Stretch::whole(p, q, r, raster);
        let rows = rows.start.max(wanted.start)..rows.end.min(wanted.end);
        Stretch { capsule, rows }
    });
    let mut chords = chords(&all.collect::<Vec<_>>(), raster);
    let mut out = Rows::starting_at(chords.first);
    for j in chords.range() {
        out.push_row(|spans| merge(chords.row(j), spans));
    }
    out
}

/// Lowest and highest `v` of the contours.
fn extent(contours: &[Contour]) -> Option<(Coord, Coord)> {
    let mut all = contours.iter().flatten().map(|p| p.y);
    let first = all.next()?;
    Some(all.fold((first, first), |(low, high), v| (low.min(v), high.max(v))))
}

/// Where a line at `v` crosses the edge between `low` and `high`, `low.y < v <= high.y`. It is
/// rounded to the nearest unit, the same for both directions of the edge.
fn crossing(low: Point, high: Point, v: Coord) -> Coord {
    between(low.x, high.x, (v, low.y, high.y))
}

/// Items sorted into rows. Each row has room for the most items that it can get.
struct Buckets<T> {
    first: i32,
    /// Where each row begins in `items`, and the end of the last.
    starts: Vec<u32>,
    /// Where each row ends so far.
    ends: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Buckets<T> {
    /// Reserves room in the rows `range`: one item for each of `stretches` that reaches a row.
    fn new(range: Range<i32>, stretches: impl Iterator<Item = Range<i32>>) -> Self {
        let first = range.start;
        let index = |j: i32| (j - first) as usize;
        // The change of the number of stretches from row to row.
        let mut change = vec![0_i32; range.len() + 1];
        for stretch in stretches.filter(|s| !s.is_empty()) {
            change[index(stretch.start)] += 1;
            change[index(stretch.end)] -= 1;
        }
        let (mut here, mut sum) = (0, 0);
        let mut starts = Vec::with_capacity(change.len());
        for more in change {
            starts.push(sum);
            here += more;
            sum += here as u32;
        }
        let ends = starts[..range.len()].to_vec();
        Self { first, starts, ends, items: vec![T::default(); sum as usize] }
    }

    fn range(&self) -> Range<i32> {
        self.first..self.first + self.ends.len() as i32
    }

    fn push(&mut self, j: i32, item: T) {
        let end = &mut self.ends[(j - self.first) as usize];
        self.items[*end as usize] = item;
        *end += 1;
    }

    fn row(&mut self, j: i32) -> &mut [T] {
        if !self.range().contains(&j) {
            return &mut [];
        }
        let k = (j - self.first) as usize;
        &mut self.items[self.starts[k] as usize..self.ends[k] as usize]
    }
}

impl Buckets<Span> {
    /// Pushes a chord, or merges it with the last one of its row if they meet. Chords of
    /// neighbouring edges mostly overlap, so this keeps rows short.
    fn join(&mut self, j: i32, chord: Span) {
        let k = (j - self.first) as usize;
        let (start, end) = (self.starts[k] as usize, self.ends[k] as usize);
        match self.items[start..end].last_mut() {
            Some(last) if last.start <= chord.end && chord.start <= last.end => {
                last.start = last.start.min(chord.start);
                last.end = last.end.max(chord.end);
            }
            _ => self.push(j, chord),
        }
    }
}

/// A crossing: its place, and the change of the winding number from its left to its right.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Crossing {
    u: Coord,
    winding: i32,
}

/// The spans of each row with a winding number other than zero.
fn inside(contours: &[Contour], raster: Raster) -> Rows {
    let Some((low, high)) = extent(contours) else { return Rows::default() };
    let range = raster.rows(low, high);
    let all = || contours.iter().flat_map(|c| edges(c));
    let rows = |p: Point, q: Point| raster.rows(p.y.min(q.y), p.y.max(q.y));
    let mut crossings = Buckets::new(range.clone(), all().map(|(p, q)| rows(p, q)));
    for (p, q) in all() {
        // The solid is on the left of an edge: to the right of it along u if the edge falls.
        let (low, high, winding) = if p.y < q.y { (p, q, -1) } else { (q, p, 1) };
        for j in rows(p, q) {
            let u = crossing(low, high, j * raster.pitch);
            crossings.push(j, Crossing { u, winding });
        }
    }
    let mut rows = Rows::with_room(range.start, range.len(), crossings.items.len() / 2);
    for j in range {
        let row = crossings.row(j);
        row.sort_unstable();
        rows.push_row(|out| wound(row, out));
    }
    rows
}

/// Appends the spans between sorted crossings where the winding number is not zero.
fn wound(crossings: &[Crossing], out: &mut Vec<Span>) {
    let base = out.len();
    let mut winding = 0;
    let mut start = 0;
    for c in crossings {
        if winding == 0 {
            start = c.u;
        }
        winding += c.winding;
        if winding == 0 {
            match out[base..].last_mut() {
                Some(last) if last.end >= start => last.end = last.end.max(c.u),
                _ => out.extend(Span::new(start, c.u)),
            }
        }
    }
}

/// A capsule around an edge, and the rows on which it matters.
struct Stretch {
    capsule: Capsule,
    rows: Range<i32>,
}

impl Stretch {
    /// The capsule with all rows that meet it.
    fn whole(p: Point, q: Point, r: Coord, raster: Raster) -> Self {
        let rows = raster.rows(p.y.min(q.y) - r, p.y.max(q.y) + r);
        Self { capsule: Capsule::new(p, q, r), rows }
    }

    /// The capsule with the rows on which the edge from `p` to `q` may be the nearest one to a
    /// place inside. The solid is on its left; `next` is the end of the following edge. Places
    /// beside the edge lie on its left. Beyond its end the edge is nearest only around a reflex
    /// corner. Both edges together already have the rows of such a corner beside them, unless it
    /// is the highest or lowest point: then all rows within `r` are needed.
    fn inner([p, q, next]: [Point; 3], r: Coord, raster: Raster) -> Self {
        let capsule = Capsule::new(p, q, r);
        let lift = if p.y <= q.y { capsule.lift } else { -capsule.lift } as Coord;
        let (low, high) = (p.y.min(q.y), p.y.max(q.y));
        let (mut down, mut up) = ((MARGIN - lift.min(0)).min(r), (MARGIN + lift.max(0)).min(r));
        if (p.y < q.y) != (q.y < next.y) && side(p, q, next) <= 0 {
            (down, up) = (r, r);
        }
        Self { capsule, rows: raster.rows(low - down, high + up) }
    }
}

/// The chords that rows cut from capsules.
fn chords(stretches: &[Stretch], raster: Raster) -> Buckets<Span> {
    let rows = || stretches.iter().map(|s| s.rows.clone()).filter(|rows| !rows.is_empty());
    let first = rows().map(|rows| rows.start).min().unwrap_or_default();
    let end = rows().map(|rows| rows.end).max().unwrap_or_default();
    let mut chords = Buckets::new(first..end, rows());
    for Stretch { capsule, rows } in stretches {
        for j in rows.clone() {
            if let Some(chord) = capsule.chord(j * raster.pitch) {
                chords.join(j, chord);
            }
        }
    }
    chords
}

/// All points within a distance of an edge.
struct Capsule {
    /// The edge's ends, `u` and `v`; `low` has the lesser `v`.
    low: [f64; 2],
    high: [f64; 2],
    /// The distance, squared.
    square: f64,
    /// Run per rise; 0 for a horizontal edge.
    slope: f64,
    /// Distance along u from the edge's line to the parallel that bounds the capsule.
    shift: f64,
    /// How much lower than the edge the straight part of the right flank ends; the left: higher.
    lift: f64,
}

impl Capsule {
    fn new(p: Point, q: Point, r: Coord) -> Self {
        let (low, high) = if p.y <= q.y { (p, q) } else { (q, p) };
        let [low, high] = [low, high].map(|p| [f64::from(p.x), f64::from(p.y)]);
        let (run, rise) = (high[0] - low[0], high[1] - low[1]);
        let length = (run * run + rise * rise).sqrt();
        let r = f64::from(r);
        let (slope, shift) = if rise > 0.0 { (run / rise, r * length / rise) } else { (0.0, 0.0) };
        let lift = if length > 0.0 { r * run / length } else { 0.0 };
        Self { low, high, square: r * r, slope, shift, lift }
    }

    /// The chord at `v`; `None` if rounding leaves nothing of it. A flank is a straight line
    /// between its tangent points with the two end circles, and an arc beyond.
    fn chord(&self, v: Coord) -> Option<Span> {
        let v = f64::from(v);
        let Self { low: [low_u, low_v], high: [high_u, high_v], lift, .. } = *self;
        let circle = |at: f64| (self.square - (v - at) * (v - at)).at_least(0.0).sqrt();
        let (start, end) = if low_v == high_v {
            (low_u.at_most(high_u) - circle(low_v), low_u.at_least(high_u) + circle(low_v))
        } else {
            let middle = low_u + (v - low_v) * self.slope;
            let flank = |lift: f64, side: f64| {
                if v < low_v - lift {
                    low_u + side * circle(low_v)
                } else if v > high_v - lift {
                    high_u + side * circle(high_v)
                } else {
                    middle + side * self.shift
                }
            };
            (flank(-lift, -1.0), flank(lift, 1.0))
        };
        Span::new(nearest(start) as Coord, nearest(end) as Coord)
    }
}
