//! Path + length -> Wipe: the way back along a line, on which the nozzle leaves what still oozes.
//!
//! After a retraction a little plastic still comes out. It does no harm on the line that was just
//! printed. A loop is gone over again from its beginning, where it also ends, perhaps after a gap; any
//! other line backwards from its end.

use crate::fill::{Path, PathPoint, Shape};
use crate::geom::Point;
use crate::units::{Coord, nearest};

/// The points of the way that wipes `length` of `path`. A path that rises is not wiped: the way back
/// would run into it.
pub(super) fn wipe(path: &Path, length: Coord) -> Vec<Point> {
    if length <= 0 || path.points.iter().any(|point| point.z != 0) {
        return Vec::new();
    }
    match path.shape {
        Shape::Open | Shape::InTurn { .. } => along(path.points.iter().rev(), length),
        Shape::Loop { .. } if path.start() == path.end() => along(path.points.iter(), length),
        Shape::Loop { .. } => along(path.points.last().into_iter().chain(&path.points), length),
    }
}

/// The first `length` of these points, without the first of them.
fn along<'a>(mut points: impl Iterator<Item = &'a PathPoint>, length: Coord) -> Vec<Point> {
    let (mut left, mut out) = (f64::from(length), Vec::new());
    let Some(mut at) = points.next().map(|point| point.at) else { return out };
    for next in points.map(|point| point.at) {
        let step = at.distance(next);
        if step >= left {
            let part = |a: Coord, b: Coord| {
                nearest(f64::from(a) + (f64::from(b) - f64::from(a)) * left / step) as Coord
            };
            out.push(Point { x: part(at.x, next.x), y: part(at.y, next.y) });
            return out;
        }
        left -= step;
        out.push(next);
        at = next;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::Role;

    fn path(shape: Shape, places: &[(Coord, Coord)]) -> Path {
        let point =
            |&(x, y)| PathPoint { at: Point { x, y }, z: 0, width: 4_000, height: 2_000, hang: 0 };
        let points = places.iter().map(point).collect();
        Path { role: Role::OuterWall, shape, points, layers: 1 }
    }

    #[test]
    fn a_loop_is_wiped_from_its_beginning_and_a_line_from_its_end() {
        let places = [(0, 0), (10_000, 0), (10_000, 10_000), (0, 0)];
        let p = |x, y| Point { x, y };
        assert_eq!(
            wipe(&path(Shape::Loop { depth: 0 }, &places), 15_000),
            [p(10_000, 0), p(10_000, 5_000)]
        );
        assert_eq!(wipe(&path(Shape::Open, &places[..3]), 10_000), [p(10_000, 0)]);
        assert_eq!(wipe(&path(Shape::Open, &places[..2]), 50_000), [p(0, 0)]);
        assert!(wipe(&path(Shape::Open, &places), 0).is_empty());
    }
}
