//! Contour -> Contour: offsets each side of a contour; the curve may still cross itself.
//!
//! - A *side* is an edge of the contour, moved to its right by the distance.
//! - A corner is *mitred* where its sides move apart: both are extended until they meet.
//! - A corner is *crossed* where its sides move towards each other.
//! - A *cut* is where two neighbouring sides cross.
//!
//! 1. Move each side, and classify each corner. A corner too sharp for a mitre is left to the library.
//! 2. Cut the sides of each crossed corner at their crossing.
//! 3. Remove each side that is too short for its cuts, and cut its neighbours off each other.
//! 4. If two neighbours do not meet, keep both sides whole, with the corner of the contour between
//!    them. The loop that this makes is left to the library's union.
//!
//! The library (Clipper2) does step 4 at every crossed corner. That makes three points and a loop,
//! which is most of the work of its union. Cutting leaves most curves without crossings.
//!
//! Rounding is that of the library: offset points go to the nearest unit, crossings are truncated
//! towards zero. So results agree. One exception: if rounding leaves nearly parallel sides without a
//! crossing, the corner is at its mitre, where the library makes several points.

use super::{Contour, Point, edges};
use crate::units::{Coord, nearest};

/// Cosine of the turn (177°) above which a corner folds back and is left to the library. The value is
/// Clipper2's, as is [`STRAIGHT`]: with others the two would make different corners.
const FOLDED: f64 = -0.999;

/// Cosine of the turn (2.5°) below which a corner is always mitred. Clipper2's value.
const STRAIGHT: f64 = 0.999;

/// Offsets `contour` by `distance` grid units to its right: outwards if it is counter-clockwise, and
/// inwards if `distance` is negative. `None` if the mitre of a corner reaches further than `limit`
/// distances, or if a corner folds back.
#[must_use]
pub fn parallel(contour: &[Point], distance: f64, limit: f64) -> Option<Contour> {
    parallel_and_lost(contour, distance, limit).map(|(curve, _)| curve)
}

/// As [`parallel`], with the total length of the sides of `contour` that were removed, grid units.
#[must_use]
pub fn parallel_and_lost(contour: &[Point], distance: f64, limit: f64) -> Option<(Contour, f64)> {
    let n = contour.len();
    let mut normals = Vec::with_capacity(n);
    for (a, b) in edges(contour) {
        normals.push(normal(a, b)?);
    }
    let mut corners = Vec::with_capacity(n);
    let mut before = *normals.last()?;
    for (&p, &after) in contour.iter().zip(&normals) {
        corners.push(Corner::new(p, before, after, distance, limit)?);
        before = after;
    }
    let mut sides = Sides::new(&corners);
    sides.cut_all(&corners);
    let is_lost = |k: &usize| sides.after[*k] == *k;
    let length = |k: usize| contour[k].distance(contour[(k + 1) % n]);
    let lost = (0..n).filter(is_lost).map(length).sum();
    Some((sides.curve(&corners), lost))
}

/// The sides of a curve in a ring, linked without those that were removed.
struct Sides {
    sides: Vec<Side>,
    /// Where each side is cut off its neighbour before it.
    cuts: Vec<Option<Cut>>,
    before: Vec<usize>,
    /// The neighbour after each side; a removed side has itself.
    after: Vec<usize>,
}

impl Sides {
    fn new(corners: &[Corner]) -> Self {
        let n = corners.len();
        let side = |k: usize| Side { from: corners[k].after(), to: corners[(k + 1) % n].before() };
        Self {
            sides: (0..n).map(side).collect(),
            cuts: vec![None; n],
            before: (0..n).map(|k| (k + n - 1) % n).collect(),
            after: (0..n).map(|k| (k + 1) % n).collect(),
        }
    }

    /// Cuts each side off the one before it. Removes a side that is too short for its cuts, and cuts
    /// its neighbours off each other.
    fn cut_all(&mut self, corners: &[Corner]) {
        let n = corners.len();
        let cut = |k: usize| corners[k].cut(&self.sides[self.before[k]], &self.sides[k]);
        self.cuts = (0..n).map(cut).collect();
        let mut short: Vec<usize> = (0..n).rev().filter(|&k| self.is_short(k, corners)).collect();
        while let Some(k) = short.pop() {
            let (p, q) = (self.before[k], self.after[k]);
            if self.after[k] == k || p == q || !self.is_short(k, corners) {
                continue;
            }
            let Some(cut) = self.sides[p].cut(&self.sides[q]) else { continue };
            (self.after[p], self.before[q]) = (q, p);
            self.after[k] = k;
            self.cuts[q] = Some(cut);
            short.extend([q, p].into_iter().filter(|&k| self.is_short(k, corners)));
        }
    }

    /// Whether a side is too short: a neighbour crosses it beyond its other end, or its cuts would
    /// reverse it.
    fn is_short(&self, k: usize, corners: &[Corner]) -> bool {
        let length = || self.sides[k].from.distance(self.sides[k].to);
        // Only a side's own corner has no cut: removing a neighbour always sets one.
        let is_beyond = |k: usize| {
            self.cuts[k].is_none() && corners[k].overlap().is_some_and(|o| o >= length())
        };
        is_beyond(k) || is_beyond(self.after[k]) || !self.keeps(k)
    }

    /// Whether a side keeps its direction between its cuts.
    fn keeps(&self, k: usize) -> bool {
        let begin = self.cuts[k].map_or(0.0, |cut| cut.along_after);
        let end = self.cuts[self.after[k]].map_or(1.0, |cut| cut.along_before);
        begin < end
    }

    /// The points of the curve: cuts, and where there are none the points of the corners.
    fn curve(&self, corners: &[Corner]) -> Contour {
        let n = corners.len();
        let mut out = Contour::with_capacity(n);
        for k in (0..n).filter(|&k| self.after[k] != k) {
            let before = self.before[k];
            match self.cuts[k].filter(|_| self.keeps(k) && self.keeps(before)) {
                Some(cut) => out.push(cut.at),
                // Whole sides keep the loop at their corner.
                None => {
                    let mut corner = before;
                    while corner != k {
                        corner = (corner + 1) % n;
                        corners[corner].push_to(&mut out);
                    }
                }
            }
        }
        out
    }
}

/// The unit vector to the right of the direction from `a` to `b`.
fn normal(a: Point, b: Point) -> Option<[f64; 2]> {
    let (x, y) = (f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y));
    let by = 1.0 / (x * x + y * y).sqrt();
    (a != b).then_some([y * by, -x * by])
}

/// The corner between two moved sides.
#[derive(Debug, Clone, Copy)]
enum Corner {
    /// The sides move apart, and meet here once extended.
    Mitred(Point),
    /// The sides cross at `mitre`, `overlap` from their ends. The side before ends at `before`, the
    /// side after begins at `after`, and `corner` is the contour's own.
    Crossed { before: Point, corner: Point, after: Point, mitre: Point, overlap: f64 },
}

impl Corner {
    /// The corner at `p` between sides with these normals.
    fn new(p: Point, before: [f64; 2], after: [f64; 2], distance: f64, limit: f64) -> Option<Self> {
        let sine = after[1] * before[0] - before[1] * after[0];
        let cosine = before[0] * after[0] + before[1] * after[1];
        let moved = |by: [f64; 2], far: f64| rounded(p, [by[0] * far, by[1] * far]);
        let both = [before[0] + after[0], before[1] + after[1]];
        let mitre = moved(both, distance / (cosine + 1.0));
        if cosine > FOLDED && sine * distance < 0.0 {
            let (before, after) = (moved(before, distance), moved(after, distance));
            let overlap = (distance * sine / (cosine + 1.0)).abs();
            return Some(Self::Crossed { before, corner: p, after, mitre, overlap });
        }
        let reaches = cosine > STRAIGHT || cosine > 2.0 / (limit * limit) - 1.0;
        reaches.then_some(Self::Mitred(mitre))
    }

    /// The distance from the ends of its sides to their crossing, if they cross.
    fn overlap(self) -> Option<f64> {
        match self {
            Self::Mitred(_) => None,
            Self::Crossed { overlap, .. } => Some(overlap),
        }
    }

    /// Where its sides are cut off each other. If they are nearly parallel, rounding may leave no
    /// crossing; then they are cut at the mitre.
    fn cut(self, before: &Side, after: &Side) -> Option<Cut> {
        let Self::Crossed { mitre, overlap, .. } = self else { return None };
        before.cut(after).or_else(|| {
            let part = |side: &Side| overlap / side.from.distance(side.to);
            let (along_before, along_after) = (1.0 - part(before), part(after));
            let within = along_before > 0.0 && along_after < 1.0;
            within.then_some(Cut { at: mitre, along_before, along_after })
        })
    }

    /// Appends the points of the corner if both sides stay whole.
    fn push_to(self, curve: &mut Contour) {
        match self {
            Self::Mitred(at) => curve.push(at),
            Self::Crossed { before, corner, after, .. } => curve.extend([before, corner, after]),
        }
    }

    /// Where the side before it ends.
    fn before(self) -> Point {
        match self {
            Self::Mitred(at) | Self::Crossed { before: at, .. } => at,
        }
    }

    /// Where the side after it begins.
    fn after(self) -> Point {
        match self {
            Self::Mitred(at) | Self::Crossed { after: at, .. } => at,
        }
    }
}

fn rounded(p: Point, by: [f64; 2]) -> Point {
    let at = |c: Coord, by: f64| nearest(f64::from(c) + by) as Coord;
    Point { x: at(p.x, by[0]), y: at(p.y, by[1]) }
}

/// A moved side of the contour.
#[derive(Debug, Clone, Copy)]
struct Side {
    from: Point,
    to: Point,
}

/// Where two sides that follow each other cross.
#[derive(Debug, Clone, Copy)]
struct Cut {
    at: Point,
    /// Its place along the side before, 0 to 1.
    along_before: f64,
    /// Its place along the side after, 0 to 1.
    along_after: f64,
}

impl Side {
    fn vector(&self) -> [f64; 2] {
        let along = |from: Coord, to: Coord| f64::from(to) - f64::from(from);
        [along(self.from.x, self.to.x), along(self.from.y, self.to.y)]
    }

    /// The crossing with `next`, if it is between the ends of both.
    fn cut(&self, next: &Self) -> Option<Cut> {
        let ([ax, ay], [bx, by]) = (self.vector(), next.vector());
        let [x, y] = Self { from: self.from, to: next.from }.vector();
        let cross = ax * by - ay * bx;
        let along_before = (x * by - y * bx) / cross;
        let along_after = (x * ay - y * ax) / cross;
        let within = |along: f64| along > 0.0 && along < 1.0;
        (within(along_before) && within(along_after)).then(|| Cut {
            at: self.at(next),
            along_before,
            along_after,
        })
    }

    /// The crossing with `next`, rounded as the library does: measured from the upper end of the side
    /// that lies to the left above the crossing.
    fn at(&self, next: &Self) -> Point {
        let (a, b) = (self.downwards(), next.downwards());
        match (a.from.y == a.to.y, b.from.y == b.to.y) {
            (true, _) => return b.at_height(a.from.y),
            (_, true) => return a.at_height(b.from.y),
            _ => {}
        }
        let ([ax, ay], [bx, by]) = (a.vector(), b.vector());
        let (a, b) = if ax / ay <= bx / by { (a, b) } else { (b, a) };
        let ([ax, ay], [bx, by]) = (a.vector(), b.vector());
        let [x, y] = Self { from: b.from, to: a.from }.vector();
        let along = (x * by - y * bx) / (ay * bx - by * ax);
        let place = |from: Coord, run: f64| (f64::from(from) + along * run) as Coord;
        Point { x: place(a.from.x, ax), y: place(a.from.y, ay) }
    }

    /// Where it crosses the horizontal at `y`; it is not horizontal itself and starts at its upper end.
    fn at_height(&self, y: Coord) -> Point {
        let [run, rise] = self.vector();
        let along = f64::from(y) - f64::from(self.from.y);
        let by = (run / rise * along).round_ties_even();
        Point { x: self.from.x + by as Coord, y }
    }

    /// The side, starting at its upper end (greater y).
    fn downwards(&self) -> Self {
        if self.from.y >= self.to.y { *self } else { Self { from: self.to, to: self.from } }
    }
}
