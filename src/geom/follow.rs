//! Two closed polygons -> verdict: tests whether each runs along the other within a distance.

use super::{Contour, Point, edges, segment};
use crate::units::Coord;

/// Whether every corner of `a` is at most `far` from `b`, and every corner of `b` from `a`. Both
/// polygons have the same orientation. Takes linear time.
#[must_use]
pub fn follow(a: &Contour, b: &Contour, far: Coord) -> bool {
    near_boxes(a, b, far) && runs_along(a, b, far) && runs_along(b, a, far)
}

/// Whether the bounding boxes of `a` and `b` are alike. This rejects most pairs quickly.
fn near_boxes(a: &Contour, b: &Contour, far: Coord) -> bool {
    let sides = |c: &Contour| {
        let xs = || c.iter().map(|p| p.x);
        let ys = || c.iter().map(|p| p.y);
        [xs().min(), xs().max(), ys().min(), ys().max()].map(Option::unwrap_or_default)
    };
    // An offset may cut off corners, so that boxes can differ by more: twice as much.
    sides(a).iter().zip(sides(b)).all(|(p, q)| (p - q).abs() <= 2 * far)
}

/// Whether every corner of `a` is near some edge of `b`. Both have the same orientation, so that
/// each search starts at the edge where the last one ended.
fn runs_along(a: &Contour, b: &Contour, far: Coord) -> bool {
    let b: Vec<(Point, Point)> = edges(b).collect();
    let limit = f64::from(far) * f64::from(far);
    let mut at = 0;
    a.iter().all(|&p| {
        let found = (at..at + b.len()).find(|&k| distance2(p, b[k % b.len()]) <= limit);
        at = found.unwrap_or_default() % b.len().max(1);
        found.is_some()
    })
}

/// The squared distance from `p` to an edge, grid units².
fn distance2(p: Point, (a, b): (Point, Point)) -> f64 {
    let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
    segment::distance2(float(p), [float(a), float(b)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side: Coord, at: Coord) -> Contour {
        let p = |x, y| Point { x: x + at, y: y + at };
        vec![p(0, 0), p(side, 0), p(side, side), p(0, side)]
    }

    #[test]
    fn a_shifted_polygon_follows_within_the_distance() {
        let a = square(10_000, 0);
        assert!(follow(&a, &square(10_000, 0), 10));
        assert!(follow(&a, &square(10_000, 50), 71));
        assert!(!follow(&a, &square(10_000, 50), 40));
        assert!(!follow(&a, &square(10_100, 0), 40));
    }

    #[test]
    fn more_corners_and_another_first_corner_make_no_difference() {
        let a = square(10_000, 0);
        let mut b = square(10_000, 0);
        b.insert(1, Point { x: 3_000, y: 5 });
        b.insert(4, Point { x: 7_000, y: 10_000 });
        b.rotate_left(3);
        assert!(follow(&a, &b, 10));
    }

    #[test]
    fn a_notch_is_found_in_either_polygon() {
        let a = square(10_000, 0);
        let mut b = square(10_000, 0);
        let p = |x, y| Point { x, y };
        b.splice(1..1, [p(4_000, 0), p(4_000, 900), p(5_000, 900), p(5_000, 0)]);
        assert!(!follow(&a, &b, 100));
        assert!(!follow(&b, &a, 100));
    }
}
