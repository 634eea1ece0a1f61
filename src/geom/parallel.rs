//! Contours -> Contours: the curves parallel to them, not yet freed of what crosses itself.
//!
//! Where an offset's sides grow apart their corner is mitred. Where they cross, the library's
//! own offset keeps both sides whole with a detour to the corner and leaves it to its union
//! to cut off the loop: three points, and most of the union's work. Here the two sides are
//! cut at their crossing, as long as each side keeps its direction; else they are left whole
//! in the same way. So what the union has to find are crossings of parts that lie apart.
//!
//! Roundings are those of the library (Clipper2: offset points to the nearest unit, crossings
//! cut off towards zero), so that it does not show which way a corner was made.

use super::{Contour, Point};
use crate::units::{Coord, nearest};

/// Cosine of turns that count as folding back (177°); their corners are none of ours.
const FOLDED: f64 = -0.999;

/// Cosine of turns that count as straight (2.5°): mitred on either side.
const STRAIGHT: f64 = 0.999;

/// `contour` moved by `distance` grid units to its right (outwards from what it runs around
/// counter-clockwise; inwards if negative). Corners are mitred; none if one is so sharp that
/// its mitre reaches further than `limit` distances, or folds back.
///
/// Corners at level sides are left whole: there it would show in where the union begins its
/// contours.
#[must_use]
pub fn parallel(contour: &[Point], distance: f64, limit: f64) -> Option<Contour> {
    let n = contour.len();
    let normals: Vec<[f64; 2]> =
        (0..n).map(|k| normal(contour[k], contour[(k + 1) % n])).collect::<Option<_>>()?;
    let corner = |k: usize| {
        let (before, after) = (normals[(k + n - 1) % n], normals[k]);
        Corner::new(contour[k], before, after, distance, limit)
    };
    let corners: Vec<Corner> = (0..n).map(corner).collect::<Option<_>>()?;
    let sides: Vec<Side> = (0..n)
        .map(|k| Side { from: corners[k].after(), to: corners[(k + 1) % n].before() })
        .collect();
    let cuts: Vec<Option<Cut>> = (0..n)
        .map(|k| match corners[k] {
            Corner::Mitred(_) => None,
            Corner::Crossed { .. } => sides[(k + n - 1) % n].cut(&sides[k]),
        })
        .collect();
    // A side that its two cuts turn round keeps its loops: they are what is left of it.
    let keeps = |k: usize| {
        let begin = cuts[k].map_or(0.0, |cut| cut.along_after);
        let end = cuts[(k + 1) % n].map_or(1.0, |cut| cut.along_before);
        begin < end
    };
    let mut out = Vec::with_capacity(n);
    for k in 0..n {
        match (corners[k], cuts[k]) {
            (Corner::Mitred(at), _) => out.push(at),
            (Corner::Crossed { .. }, Some(cut)) if keeps(k) && keeps((k + n - 1) % n) => {
                out.push(cut.at);
            }
            (Corner::Crossed { before, corner, after }, _) => out.extend([before, corner, after]),
        }
    }
    Some(out)
}

/// The direction to the right of the way from `a` to `b`, of length 1.
fn normal(a: Point, b: Point) -> Option<[f64; 2]> {
    let (x, y) = (f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y));
    let by = 1.0 / (x * x + y * y).sqrt();
    (a != b).then_some([y * by, -x * by])
}

/// What becomes of a corner.
#[derive(Debug, Clone, Copy)]
enum Corner {
    /// Where the two sides moved apart meet.
    Mitred(Point),
    /// The sides cross: where the one before ends, the corner itself, where the one after begins.
    Crossed { before: Point, corner: Point, after: Point },
}

impl Corner {
    /// The corner at `p` between sides with these normals.
    fn new(p: Point, before: [f64; 2], after: [f64; 2], distance: f64, limit: f64) -> Option<Self> {
        let sine = after[1] * before[0] - before[1] * after[0];
        let cosine = before[0] * after[0] + before[1] * after[1];
        let moved = |by: [f64; 2], far: f64| rounded(p, [by[0] * far, by[1] * far]);
        if cosine > FOLDED && sine * distance < 0.0 {
            let (before, after) = (moved(before, distance), moved(after, distance));
            return Some(Self::Crossed { before, corner: p, after });
        }
        let mitre = cosine > STRAIGHT || cosine > 2.0 / (limit * limit) - 1.0;
        let both = [before[0] + after[0], before[1] + after[1]];
        mitre.then(|| Self::Mitred(moved(both, distance / (cosine + 1.0))))
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

/// A side of the contour, moved.
#[derive(Debug, Clone, Copy)]
struct Side {
    from: Point,
    to: Point,
}

/// Where two sides that follow each other cross.
#[derive(Debug, Clone, Copy)]
struct Cut {
    at: Point,
    /// How far along the side before, 0 to 1.
    along_before: f64,
    /// How far along the side after.
    along_after: f64,
}

impl Side {
    fn vector(&self) -> [f64; 2] {
        let along = |from: Coord, to: Coord| f64::from(to) - f64::from(from);
        [along(self.from.x, self.to.x), along(self.from.y, self.to.y)]
    }

    /// Where it crosses `next` between the ends of both, if neither is level.
    fn cut(&self, next: &Self) -> Option<Cut> {
        let ([ax, ay], [bx, by]) = (self.vector(), next.vector());
        let [x, y] = Self { from: self.from, to: next.from }.vector();
        let cross = ax * by - ay * bx;
        let along_before = (x * by - y * bx) / cross;
        let along_after = (x * ay - y * ax) / cross;
        let within = |along: f64| along > 0.0 && along < 1.0;
        let is_level = ay == 0.0 || by == 0.0;
        (!is_level && within(along_before) && within(along_after)).then(|| Cut {
            at: self.at(next),
            along_before,
            along_after,
        })
    }

    /// The crossing with `next`, rounded as the library does: measured on the side that is
    /// further left at greater y, from its end there.
    fn at(&self, next: &Self) -> Point {
        let (a, b) = (self.downwards(), next.downwards());
        let ([ax, ay], [bx, by]) = (a.vector(), b.vector());
        let (a, b) = if ax / ay <= bx / by { (a, b) } else { (b, a) };
        let ([ax, ay], [bx, by]) = (a.vector(), b.vector());
        let [x, y] = Self { from: b.from, to: a.from }.vector();
        let along = (x * by - y * bx) / (ay * bx - by * ax);
        let place = |from: Coord, run: f64| (f64::from(from) + along * run) as Coord;
        Point { x: place(a.from.x, ax), y: place(a.from.y, ay) }
    }

    /// From the end with the greater y to the other.
    fn downwards(&self) -> Self {
        if self.from.y >= self.to.y { *self } else { Self { from: self.to, to: self.from } }
    }
}
