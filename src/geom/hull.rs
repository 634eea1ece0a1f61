//! Points -> contour: their convex hull.

use super::{Contour, Point, side};

/// The convex hull, counter-clockwise, without points on its sides; empty if no three points span
/// an area. A. M. Andrew, "Another efficient algorithm for convex hulls in two dimensions" (1979).
#[must_use]
pub fn hull(mut points: Vec<Point>) -> Contour {
    points.sort_unstable();
    points.dedup();
    let lower = half(points.iter().copied());
    let upper = half(points.iter().rev().copied());
    let ends = |half: &[Point]| half.len().saturating_sub(1);
    let all = [&lower[..ends(&lower)], &upper[..ends(&upper)]].concat();
    if all.len() < 3 { Contour::new() } else { all }
}

/// The points that are passed without a turn to the right.
fn half(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for p in points {
        while let [.., a, b] = kept[..] {
            if side(a, b, p) > 0 {
                break;
            }
            kept.pop();
        }
        kept.push(p);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{double_area, edges};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_point_lies_outside_and_every_corner_turns_left(
            points in prop::collection::vec((-50..50, -50..50), 0..40)
        ) {
            let points: Vec<Point> = points.into_iter().map(|(x, y)| Point { x, y }).collect();
            let hull = hull(points.clone());
            prop_assert!(hull.iter().all(|p| points.contains(p)));
            for (a, b) in edges(&hull) {
                prop_assert!(points.iter().all(|p| side(a, b, *p) >= 0));
            }
            prop_assert!(hull.is_empty() || double_area(&hull) > 0);
        }
    }
}
