//! Contour -> Contour: removes vertices within a tolerance, from a canonical start.
//!
//! Words: the *canonical start* of a contour is the vertex at which its list is the smallest: the same
//! whichever way a mesh is stored.
//!
//! A cone of directions starts at each kept vertex. Every vertex that follows narrows the cone to the
//! lines that pass it within the tolerance. The first vertex outside the cone ends the line: the
//! vertex before it is kept. This takes linear time. Imai and Iri 1986 and Sklansky and Gonzalez 1980
//! describe cones of this kind.

use crate::geom::{Contour, Point};
use crate::units::Coord;
use std::cmp::Ordering;

/// Rotates `contour` so that its list of vertices is the smallest in lexicographic order, and removes
/// repeated vertices. So the same loop gives the same list wherever its tracing began.
#[must_use]
pub(super) fn canonical(mut contour: Contour) -> Contour {
    contour.dedup();
    while contour.len() > 1 && contour.first() == contour.last() {
        contour.pop();
    }
    let least = least_start(&contour);
    contour.rotate_left(least);
    contour
}

/// The start of the smallest rotation of a loop. Two candidates are compared vertex by vertex. If they
/// differ after `same` equal vertices, the greater one is rejected, and with it the `same` starts
/// that follow it. Linear even for loops that repeat themselves (Shiloach 1981, "Fast
/// canonization of circular strings").
fn least_start(contour: &[Point]) -> usize {
    let n = contour.len();
    // Nearly always the least vertex is there once: the smallest rotation begins with it.
    let least = contour.iter().enumerate().min_by_key(|(_, p)| **p);
    let Some((first, least)) = least else { return 0 };
    if !contour[first + 1..].contains(least) {
        return first;
    }
    let (mut a, mut b, mut same) = (0, 1, 0);
    while a < n && b < n && same < n {
        match contour[(a + same) % n].cmp(&contour[(b + same) % n]) {
            Ordering::Equal => same += 1,
            Ordering::Less => (b, same) = (b + same + 1, 0),
            Ordering::Greater => (a, same) = (a + same + 1, 0),
        }
        if a == b {
            b += 1;
        }
    }
    a.min(b).min(n - 1)
}

/// Removes vertices of a canonical contour. None of them lies further than `tolerance` (grid units)
/// from the line that replaces it. Contours that collapse have fewer than three vertices left.
#[must_use]
pub(super) fn simplify(contour: &[Point], tolerance: Coord) -> Contour {
    let Some(&first) = contour.first() else { return Vec::new() };
    let mut kept = vec![first];
    let mut anchor = first;
    let mut cone = Cone::open();
    let mut last = first;
    for &p in contour[1..].iter().chain([&first]) {
        if !cone.admits(anchor, p) {
            kept.push(last);
            anchor = last;
            cone = Cone::open();
        }
        cone.narrow(anchor, p, f64::from(tolerance));
        last = p;
    }
    kept
}

/// The allowed directions of a line from its first vertex, the anchor.
struct Cone {
    /// The rightmost and the leftmost direction; `None` allows all.
    bounds: Option<([f64; 2], [f64; 2])>,
    /// The largest squared distance of a passed vertex. A line that ended nearer would cut off a
    /// spike.
    reach2: f64,
}

impl Cone {
    fn open() -> Self {
        Self { bounds: None, reach2: 0.0 }
    }

    /// Whether a line from `anchor` to `p` passes all vertices so far within the tolerance.
    fn admits(&self, anchor: Point, p: Point) -> bool {
        let d = difference(anchor, p);
        let within = self.bounds.is_none_or(|(right, left)| {
            cross(right, d) >= 0.0 && cross(d, left) >= 0.0 && dot(right, d) > 0.0
        });
        within && dot(d, d) >= self.reach2
    }

    /// Narrows the cone to directions that pass `p` within `tolerance`.
    fn narrow(&mut self, anchor: Point, p: Point, tolerance: f64) {
        let d = difference(anchor, p);
        let length2 = dot(d, d);
        self.reach2 = self.reach2.max(length2);
        if length2 <= tolerance * tolerance {
            return;
        }
        // The tangents from the anchor to the circle of radius `tolerance` around p.
        let along = (length2 - tolerance * tolerance).sqrt();
        let right = [d[0] * along + d[1] * tolerance, d[1] * along - d[0] * tolerance];
        let left = [d[0] * along - d[1] * tolerance, d[1] * along + d[0] * tolerance];
        self.bounds = Some(match self.bounds {
            None => (right, left),
            Some((r, l)) => (
                if cross(r, right) > 0.0 { right } else { r },
                if cross(left, l) > 0.0 { left } else { l },
            ),
        });
    }
}

fn difference(a: Point, b: Point) -> [f64; 2] {
    [f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y)]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::segment;
    use proptest::prelude::*;

    fn points(list: &[(i32, i32)]) -> Contour {
        list.iter().map(|&(x, y)| Point { x, y }).collect()
    }

    /// Distance of `p` from the segment a–b.
    fn distance(p: Point, a: Point, b: Point) -> f64 {
        let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
        segment::distance2(float(p), [float(a), float(b)]).sqrt()
    }

    #[test]
    fn vertices_on_straight_edges_are_removed() {
        let square = points(&[(0, 0), (500, 0), (1000, 0), (1000, 1000), (400, 1000), (0, 1000)]);
        let simple = simplify(&square, 10);
        assert_eq!(simple, points(&[(0, 0), (1000, 0), (1000, 1000), (0, 1000)]));
    }

    #[test]
    fn spikes_stay() {
        let spike = points(&[(0, 0), (5000, 0), (9000, 1), (5000, 2), (5000, 4000), (0, 4000)]);
        assert!(simplify(&spike, 10).contains(&Point { x: 9000, y: 1 }));
    }

    #[test]
    fn a_loop_that_repeats_itself_takes_no_longer() {
        // Comparing all starts with each other would take minutes.
        let period = points(&[(0, 0), (5000, 0), (0, 5000)]);
        assert_eq!(canonical(period.repeat(200_000)).len(), 600_000);
    }

    proptest! {
        #[test]
        fn no_removed_vertex_is_further_away_than_the_tolerance(
            list in prop::collection::vec((-2000i32..2000, -2000i32..2000), 3..40),
            tolerance in 1i32..400,
        ) {
            let contour = canonical(points(&list));
            let simple = simplify(&contour, tolerance);
            for &p in &contour {
                let nearest = (0..simple.len())
                    .map(|k| distance(p, simple[k], simple[(k + 1) % simple.len()]))
                    .fold(f64::MAX, f64::min);
                prop_assert!(nearest <= f64::from(tolerance) + 1e-6, "{nearest}");
            }
        }

        #[test]
        fn a_canonical_loop_is_its_smallest_rotation(list in prop::collection::vec((0i32..2, 0i32..2), 1..12)) {
            let contour = canonical(points(&list));
            for by in 0..contour.len() {
                let mut turned = contour.clone();
                turned.rotate_left(by);
                prop_assert!(contour <= turned);
            }
        }

        #[test]
        fn a_canonical_loop_does_not_depend_on_its_start(
            list in prop::collection::vec((-9i32..9, -9i32..9), 3..12), turn in 0usize..12,
        ) {
            let mut turned = points(&list);
            let by = turn % turned.len();
            turned.rotate_left(by);
            prop_assert_eq!(canonical(points(&list)), canonical(turned));
        }
    }
}
