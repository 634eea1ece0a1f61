//! Contours -> Contours: union, difference and offset of polygons, by the Clipper2 library.
//!
//! The only place that knows the library, so that it can be exchanged.

use super::parallel::parallel;
use super::{Contour, Point, double_area};
use crate::units::Coord;
use clipper2_rust::core::{FillRule, Path64, Paths64, Point64};
use clipper2_rust::engine::ClipType;
use clipper2_rust::engine_public::Clipper64;
use clipper2_rust::offset::{EndType, JoinType};
use clipper2_rust::{difference_64, inflate_paths_64, union_subjects_64};

/// Sharp corners of an offset are cut off where they would reach further than
/// this many offsets. At 2 the corner of a square stays sharp and a needle does
/// not throw a spike.
const MITER_LIMIT: f64 = 2.0;

/// Vertices that an offset leaves closer than this to the line between their
/// neighbours are removed (0.5 µm): offsets of offsets would otherwise pile them up.
const CLEAN: f64 = 5.0;

/// Contours with less area than this vanish (10⁻⁵ mm²): they are rounding, not shape.
const LEAST_AREA: i128 = 1_000;

/// The outline of everything with a winding number other than zero: contours
/// that neither cross nor overlap, outside counter-clockwise, holes clockwise.
#[must_use]
pub fn union(contours: &[Contour]) -> Vec<Contour> {
    from_library(&union_subjects_64(&to_library(contours), FillRule::NonZero))
}

/// `contours` (as from [`union`]) shrunk by `distance` > 0, with mitred corners.
#[must_use]
pub fn inset(contours: &[Contour], distance: Coord) -> Vec<Contour> {
    offset(contours, -f64::from(distance))
}

/// `contours` (as from [`union`]) grown by `distance` > 0, with mitred corners.
#[must_use]
pub fn outset(contours: &[Contour], distance: Coord) -> Vec<Contour> {
    offset(contours, f64::from(distance))
}

/// What of `contours` is outside of `others` (both as from [`union`]), simplified to
/// `tolerance`: without the tiny edges that near coincidence leaves.
#[must_use]
pub fn difference(contours: &[Contour], others: &[Contour], tolerance: Coord) -> Vec<Contour> {
    let (contours, others) = (to_library(contours), to_library(others));
    let left = difference_64(&contours, &others, FillRule::NonZero);
    from_library(&clipper2_rust::simplify_paths(&left, f64::from(tolerance), true))
}

fn offset(contours: &[Contour], distance: f64) -> Vec<Contour> {
    let sides: Option<Vec<Contour>> =
        contours.iter().map(|c| parallel(c, distance, MITER_LIMIT)).collect();
    let moved = match sides {
        Some(sides) => clean(&to_library(&sides)),
        // The library knows what to do about corners that are too sharp.
        None => {
            let (join, end) = (JoinType::Miter, EndType::Polygon);
            inflate_paths_64(&to_library(contours), distance, join, end, MITER_LIMIT, 0.0)
        }
    };
    from_library(&clipper2_rust::simplify_paths(&moved, CLEAN, true))
}

/// Contours where offset curves wind around counter-clockwise.
fn clean(curves: &Paths64) -> Paths64 {
    let mut clipper = Clipper64::new();
    clipper.set_preserve_collinear(false);
    clipper.add_subject(curves);
    let mut out = Paths64::new();
    clipper.execute(ClipType::Union, FillRule::Positive, &mut out, None);
    out
}

fn to_library(contours: &[Contour]) -> Paths64 {
    let path = |c: &Contour| -> Path64 {
        c.iter().map(|p| Point64::new(i64::from(p.x), i64::from(p.y))).collect()
    };
    contours.iter().map(path).collect()
}

fn from_library(paths: &Paths64) -> Vec<Contour> {
    // Coordinates come from contours shrunk, or grown no further than they were shrunk before: they fit.
    let point = |p: &Point64| Point { x: p.x as Coord, y: p.y as Coord };
    paths
        .iter()
        .map(|path| path.iter().map(point).collect::<Contour>())
        .filter(|c| c.len() >= 3 && double_area(c).abs() >= 2 * LEAST_AREA)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::edges;
    use crate::units::{nearest, sin_cos};
    use proptest::prelude::*;

    /// A contour around the origin, as far from it as `radii` say; no side of it is level.
    fn star(radii: &[f64]) -> Contour {
        let corner = |(k, r): (usize, &f64)| {
            let (sin, cos) = sin_cos(0.1 + 360.0 * k as f64 / radii.len() as f64);
            Point { x: nearest(r * cos) as Coord, y: nearest(r * sin) as Coord }
        };
        radii.iter().enumerate().map(corner).collect()
    }

    fn area(contours: &[Contour]) -> f64 {
        contours.iter().map(|c| double_area(c) as f64 / 2.0).sum()
    }

    proptest! {
        #[test]
        fn sides_cut_here_enclose_what_the_library_encloses(
            radii in prop::collection::vec(84_000.0..90_000.0, 5..40),
            distance in prop_oneof![-30_000.0..-100.0, 100.0..8_000.0],
        ) {
            let star = [star(&radii)];
            let sides = parallel(&star[0], distance, MITER_LIMIT);
            prop_assume!(sides.is_some());
            let ours = from_library(&clean(&to_library(sides.as_slice())));
            let (join, end) = (JoinType::Miter, EndType::Polygon);
            let theirs =
                inflate_paths_64(&to_library(&star), distance, join, end, MITER_LIMIT, 0.0);
            let theirs = from_library(&theirs);
            // A micrometre all around.
            let round = edges(&star[0]).map(|(p, q)| p.distance(q)).sum::<f64>();
            let apart = (area(&ours) - area(&theirs)).abs();
            prop_assert!(apart <= 10.0 * round, "{apart} of {}", area(&theirs));
        }
    }

    #[test]
    fn neighbouring_sides_are_cut_where_they_cross() {
        let p = |x, y| Point { x, y };
        // A square on its corner: no side is level.
        let diamond = vec![p(0, -100_000), p(100_000, 0), p(0, 100_000), p(-100_000, 0)];
        let moved = parallel(&diamond, -7_071.067_8, MITER_LIMIT).unwrap();
        for (at, corner) in moved.iter().zip([(0, -90_000), (90_000, 0), (0, 90_000), (-90_000, 0)])
        {
            assert!(at.distance2(p(corner.0, corner.1)) <= 2, "{moved:?}");
        }
        let wider = parallel(&diamond, 7_071.067_8, MITER_LIMIT).unwrap();
        assert_eq!(wider.len(), 4);
        assert!(wider[0].distance2(p(0, -110_000)) <= 2, "{wider:?}");
    }
}
