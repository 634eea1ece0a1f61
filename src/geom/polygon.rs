//! Contours -> Contours: union, difference and offset of polygons, by the Clipper2 library.
//!
//! The only place that knows the library, so that it can be exchanged.

use super::{Contour, Point, double_area};
use crate::units::Coord;
use clipper2_rust::core::{FillRule, Path64, Paths64, Point64};
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
    let paths = to_library(contours);
    let moved =
        inflate_paths_64(&paths, distance, JoinType::Miter, EndType::Polygon, MITER_LIMIT, 0.0);
    from_library(&clipper2_rust::simplify_paths(&moved, CLEAN, true))
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
