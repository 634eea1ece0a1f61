//! Points -> contours, spans, rasters: plane geometry on the integer grid.

pub mod arc;
pub mod boxes;
pub mod cells;
pub mod decimate;
pub mod follow;
pub mod frame;
pub mod hull;
pub mod islands;
mod lookup;
pub mod nearest;
pub mod nest;
pub mod outline;
pub mod parallel;
pub mod polygon;
pub mod polyline;
pub mod ranks;
pub mod raster;
pub mod section;
pub mod segment;
pub mod sets;
pub mod simple;
pub mod spans;

use crate::units::Coord;

/// A point of the plane, in grid units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Point {
    /// To the right.
    pub x: Coord,
    /// To the back of the bed.
    pub y: Coord,
}

impl Point {
    /// The squared distance to `other`, grid units².
    #[must_use]
    pub fn distance2(self, other: Self) -> i64 {
        let dx = i64::from(self.x) - i64::from(other.x);
        let dy = i64::from(self.y) - i64::from(other.y);
        dx * dx + dy * dy
    }

    /// The distance to `other`, grid units.
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        (self.distance2(other) as f64).sqrt()
    }
}

/// A closed polygon: counter-clockwise around solid, clockwise around a hole. The last point is joined
/// to the first, which is not repeated.
pub type Contour = Vec<Point>;

/// Twice the signed area of a closed polygon, grid units²: positive if it runs counter-clockwise.
/// Summed relative to its first point, so that the products are small.
#[must_use]
pub fn double_area(contour: &[Point]) -> i128 {
    let Some(o) = contour.first() else { return 0 };
    let from = |p: &Point| (i64::from(p.x) - i64::from(o.x), i64::from(p.y) - i64::from(o.y));
    contour
        .windows(2)
        .map(|w| {
            let ((ax, ay), (bx, by)) = (from(&w[0]), from(&w[1]));
            i128::from(ax * by - ay * bx)
        })
        .sum()
}

/// The edges of a closed polygon, from each point to the next.
pub fn edges(contour: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    let last = contour.last().copied().zip(contour.first().copied());
    contour.windows(2).map(|w| (w[0], w[1])).chain(last)
}

/// Twice the signed area of the triangle a b c: positive if `c` is left of a–b.
#[must_use]
pub fn side(a: Point, b: Point, c: Point) -> i64 {
    let (abx, aby) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
    let (acx, acy) = (i64::from(c.x) - i64::from(a.x), i64::from(c.y) - i64::from(a.y));
    abx * acy - aby * acx
}

/// Whether `p` is inside the closed polygons formed by `edges`: counts the edges to the right of it.
/// The polygons must not overlap. A point on an edge may count either way.
#[must_use]
pub fn encloses(edges: impl Iterator<Item = (Point, Point)>, p: Point) -> bool {
    let to_the_right = edges.filter(|&(a, b)| {
        let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
        low.y < p.y && p.y <= high.y && side(low, high, p) > 0
    });
    to_the_right.count() % 2 == 1
}
