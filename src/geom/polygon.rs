//! Contours -> Contours: unites, subtracts and offsets polygons, with the Clipper2 library if needed.
//!
//! The *library* is Clipper2. Only this file uses it, so that it can be replaced.
//!
//! - *Curves* are closed polygons that may cross; *contours* neither cross nor overlap.
//! - The *winding number* of a place is how often the curves run around it counter-clockwise.
//!
//! Nearly all unions and offsets have no crossings, and need no library:
//! 1. For an offset, move each side ([`parallel`]). Corners that are too sharp go to the library.
//! 2. Sweep over the curves once ([`windings`]). If no two sides cross, a curve belongs to the result
//!    exactly if one side of it is inside and the other is not.
//! 3. If sides cross, the library unites the curves.
//! 4. An offset is cleaned: vertices close to the line between their neighbours are removed.
//!
//! Both ways give the same contours in the same order, from the same first vertex. Tests compare them.

use super::boxes::{Boxes, extent};
use super::parallel::{parallel, parallel_and_lost};
use super::simple::windings;
use super::{Contour, Point, double_area, side};
use crate::units::Coord;
use clipper2_rust::core::{FillRule, Path64, Paths64, Point64};
use clipper2_rust::engine::ClipType;
use clipper2_rust::engine_public::Clipper64;
use clipper2_rust::offset::{EndType, JoinType};
use clipper2_rust::{difference_64, inflate_paths_64, intersect_64, union_subjects_64};
use std::cmp::Reverse;

/// Corners of an offset may reach this many distances from the contour; sharper ones are cut off. At 2
/// that begins at 60°: the corner of a square stays sharp, and the tip of a needle grows no spike.
/// Below √2 squares would lose their corners. Any change changes all walls with sharp corners.
const MITER_LIMIT: f64 = 2.0;

/// Vertices of an offset closer than this to the line between their neighbours are removed (0.5 µm).
/// Without it, offsets of offsets collect vertices. Half the resolution of the written G-code, so
/// that nothing visible is lost; larger values move walls.
const CLEAN: f64 = 5.0;

/// More contours that cross are united in parts. A smaller value would change where assemblies of some
/// bodies cross, by rounding; a larger one takes longer.
const MANY: usize = 64;

/// Contours with less area than this are dropped (10⁻⁵ mm², a square of 3 µm): they come from rounding.
/// No bead fits into far larger ones, so that only shapes too small to print are lost.
const LEAST_AREA: i128 = 1_000;

/// The outline of everything with a winding number other than zero. The contours neither cross nor
/// overlap; outer ones run counter-clockwise, holes clockwise.
#[must_use]
pub fn union(contours: &[Contour]) -> Vec<Contour> {
    disjoint(contours, |winding| winding != 0, 0.0).unwrap_or_else(|| by_parts(contours))
}

/// The [`union`] by the library.
fn united(contours: &[Contour]) -> Vec<Contour> {
    from_library(&union_subjects_64(&to_library(contours), FillRule::NonZero))
}

/// The [`union`] of contours that cross. Of many that each run around solid, some are united at a
/// time, then the results two by two: where all overlap each other, all together have a number of
/// crossings with the square of theirs, and what is left of some has few corners.
fn by_parts(contours: &[Contour]) -> Vec<Contour> {
    let is_solid = |contour: &Contour| {
        windings(std::slice::from_ref(contour)).is_some_and(|winding| winding == [1])
    };
    if contours.len() <= MANY || !contours.iter().all(is_solid) {
        return united(contours);
    }
    let mut parts: Vec<Vec<Contour>> = contours.chunks(MANY / 4).map(united).collect();
    while parts.len() > 1 {
        parts = parts.chunks(2).map(|two| united(&two.concat())).collect();
    }
    parts.pop().unwrap_or_default()
}

/// Shrinks `contours` (as from [`union`]) by `distance` > 0, with mitred corners.
#[must_use]
pub fn inset(contours: &[Contour], distance: Coord) -> Vec<Contour> {
    offset(contours, -f64::from(distance))
}

/// Grows `contours` (as from [`union`]) by `distance` > 0, with mitred corners.
#[must_use]
pub fn outset(contours: &[Contour], distance: Coord) -> Vec<Contour> {
    offset(contours, f64::from(distance))
}

/// Whether `contours` (as from [`union`]) keep their shape when shrunk by `distance`: none splits, meets
/// another or vanishes, and none loses sides with a total length above `most` (grid units).
#[must_use]
pub fn keep_shape(contours: &[Contour], distance: Coord, most: f64) -> bool {
    let distance = -f64::from(distance);
    let moved = contours.iter().map(|c| parallel_and_lost(c, distance, MITER_LIMIT));
    let kept = moved.map(|moved| moved.filter(|(_, lost)| *lost <= most).map(|(curve, _)| curve));
    let curves = kept.collect::<Option<Vec<Contour>>>();
    let left = curves.and_then(|curves| disjoint(&curves, |winding| winding > 0, distance));
    left.is_some_and(|left| left.len() == contours.len())
}

/// Subtracts `others` from `contours` (both as from [`union`]). The result is simplified within
/// `tolerance`, since contours that nearly coincide leave tiny edges.
#[must_use]
pub fn difference(contours: &[Contour], others: &[Contour], tolerance: Coord) -> Vec<Contour> {
    let (contours, others) = (to_library(contours), to_library(others));
    let left = difference_64(&contours, &others, FillRule::NonZero);
    from_library(&clipper2_rust::simplify_paths(&left, f64::from(tolerance), true))
}

/// What `contours` and `others` have in common (both as from [`union`]).
#[must_use]
pub fn intersection(contours: &[Contour], others: &[Contour]) -> Vec<Contour> {
    let (contours, others) = (to_library(contours), to_library(others));
    from_library(&intersect_64(&contours, &others, FillRule::NonZero))
}

/// The stretches of `loops` that lie outside of `areas` (as from [`union`], or overlapping): open
/// polylines, in the order of the library. A loop that is cut nowhere is not among them: see
/// [`Cut::whole`].
#[must_use]
pub fn cut(loops: Vec<Contour>, areas: &[Contour]) -> Cut {
    let mut cut = Cut::default();
    let (areas, boxes): (Vec<&Contour>, Vec<_>) =
        areas.iter().filter_map(|area| Some((area, extent(area)?))).unzip();
    let boxes = Boxes::new(boxes);
    for one in loops {
        // What is far from a loop says nothing of it, and the library looks at all it is given.
        let near = extent(&one).map_or_else(Vec::new, |own| boxes.meeting(own));
        if near.is_empty() {
            cut.whole.push(one);
            continue;
        }
        let mut closed = path(&one);
        closed.extend(closed.first().copied());
        let mut clipper = Clipper64::new();
        clipper.add_open_subject(&vec![closed.clone()]);
        clipper.add_clip(&near.iter().map(|&k| path(areas[k])).collect());
        let (mut none, mut left) = (Paths64::new(), Paths64::new());
        clipper.execute(ClipType::Difference, FillRule::NonZero, &mut none, Some(&mut left));
        let pieces: Vec<Vec<Point>> =
            left.iter().map(|path| path.iter().map(point).collect()).collect();
        match &pieces[..] {
            [all] if all.first() == all.last() && all.len() >= closed.len() => cut.whole.push(one),
            _ => cut.pieces.extend(joined(pieces, one[0])),
        }
    }
    cut
}

/// What is left of loops.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Cut {
    /// Loops that lie outside as a whole.
    pub whole: Vec<Contour>,
    /// Stretches of the others.
    pub pieces: Vec<Vec<Point>>,
}

/// Joins the piece that ends where its loop was opened with the one that begins there.
fn joined(mut pieces: Vec<Vec<Point>>, at: Point) -> Vec<Vec<Point>> {
    let ends = |piece: &Vec<Point>| piece.last() == Some(&at);
    let begins = |piece: &Vec<Point>| piece.first() == Some(&at);
    // The library may turn open paths round.
    for piece in &mut pieces {
        if piece.len() > 1 && (begins(piece) && ends(piece)) {
            return pieces;
        }
    }
    let touching: Vec<usize> =
        (0..pieces.len()).filter(|&k| begins(&pieces[k]) || ends(&pieces[k])).collect();
    let [a, b] = touching[..] else { return pieces };
    let mut second = pieces.remove(b);
    let first = &mut pieces[a];
    if !ends(first) {
        first.reverse();
    }
    if !begins(&second) {
        second.reverse();
    }
    first.extend(second.into_iter().skip(1));
    pieces
}

/// What beads along `lines` cover that are `width` wide, with gaps up to `closed` filled in.
#[must_use]
pub fn covered<'a>(
    lines: impl Iterator<Item = &'a [Point]>,
    width: Coord,
    closed: Coord,
) -> Vec<Contour> {
    let paths: Paths64 = lines.map(path).collect();
    let grown = |width: Coord| {
        let (join, end) = (JoinType::Square, EndType::Square);
        let reach = f64::from(width) / 2.0;
        from_library(&inflate_paths_64(&paths, reach, join, end, MITER_LIMIT, 0.0))
    };
    // What is shrunk again loses the round corners of the beads: they are added once more.
    let mut all = inset(&union(&grown(width + closed)), (closed / 2).max(1));
    all.extend(grown(width));
    union(&all)
}

fn offset(contours: &[Contour], distance: f64) -> Vec<Contour> {
    let sides: Option<Vec<Contour>> =
        contours.iter().map(|c| parallel(c, distance, MITER_LIMIT)).collect();
    let moved = match sides {
        Some(sides) => disjoint(&sides, |winding| winding > 0, distance)
            .unwrap_or_else(|| from_library(&clean(&to_library(&sides)))),
        // Corners that are too sharp: the library cuts them off.
        None => {
            let (join, end) = (JoinType::Miter, EndType::Polygon);
            let contours = to_library(contours);
            from_library(&inflate_paths_64(&contours, distance, join, end, MITER_LIMIT, 0.0))
        }
    };
    moved.into_iter().map(cleaned).filter(is_shape).collect()
}

/// The union of `curves`, if no sides cross: the curves that separate inside from outside, where the
/// winding number decides what is inside. `None` if sides cross. Order and first vertices are those
/// of the library, for curves that are offset by `distance`.
fn disjoint(
    curves: &[Contour],
    is_inside: impl Fn(i32) -> bool,
    distance: f64,
) -> Option<Vec<Contour>> {
    let windings = windings(curves)?;
    let mut out = Vec::with_capacity(curves.len());
    for (curve, left) in curves.iter().zip(windings) {
        match (is_inside(left), is_inside(left - 1)) {
            (true, false) => out.push(rotated_like_library(curve, distance)?),
            (false, true) => return None,
            _ => {}
        }
    }
    out.sort_by_key(|curve| curve.iter().map(|p| (Reverse(p.y), p.x)).min());
    out.retain(is_shape);
    Some(out)
}

/// Rotates a curve to the library's first vertex. The library sweeps from high to low y and begins a
/// contour where its sweep ends: after the last of the lowest corners, or at that corner if it ends
/// a horizontal side and was cut.
fn rotated_like_library(curve: &Contour, distance: f64) -> Option<Contour> {
    let n = curve.len();
    let at = |k: usize| curve[k % n];
    let end = curve.iter().map(|p| p.y).min()?;
    let right = (0..n).filter(|&k| at(k).y == end).max_by_key(|&k| at(k).x)?;
    let last = (right..right + n).find(|&k| at(k + 1).y != end)?;
    let (before, after) = (at(last + n - 1), at(last + 1));
    let was_cut = side(before, at(last), after) as f64 * distance < 0.0;
    let first = if before.y == end && was_cut { last } else { last + 1 } % n;
    Some([&curve[first..], &curve[..first]].concat())
}

/// Removes vertices close to the line between their neighbours.
fn cleaned(contour: Contour) -> Contour {
    let n = contour.len();
    // Slightly above the library's own threshold, as it may round differently.
    let least = 1.01 * CLEAN * CLEAN;
    let is_close = |k: usize| {
        let (before, after) = (contour[(k + n - 1) % n], contour[(k + 1) % n]);
        let aside = side(before, after, contour[k]) as f64;
        aside * aside <= least * before.distance2(after) as f64
    };
    if !(0..n).any(is_close) {
        return contour;
    }
    let cleaned = clipper2_rust::simplify_path(&path(&contour), CLEAN, true);
    cleaned.iter().map(point).collect()
}

/// Whether a contour is a shape and not only rounding.
fn is_shape(contour: &Contour) -> bool {
    contour.len() >= 3 && double_area(contour).abs() >= 2 * LEAST_AREA
}

/// The library's union of offset curves: everything with a positive winding number.
fn clean(curves: &Paths64) -> Paths64 {
    let mut clipper = Clipper64::new();
    clipper.set_preserve_collinear(false);
    clipper.add_subject(curves);
    let mut out = Paths64::new();
    clipper.execute(ClipType::Union, FillRule::Positive, &mut out, None);
    out
}

fn to_library(contours: &[Contour]) -> Paths64 {
    contours.iter().map(|contour| path(contour)).collect()
}

fn from_library(paths: &Paths64) -> Vec<Contour> {
    paths.iter().map(|path| path.iter().map(point).collect()).filter(is_shape).collect()
}

fn path(contour: &[Point]) -> Path64 {
    contour.iter().map(|p| Point64::new(i64::from(p.x), i64::from(p.y))).collect()
}

fn point(p: &Point64) -> Point {
    // These contours were shrunk, or grown no further than they were shrunk before: they fit.
    Point { x: p.x as Coord, y: p.y as Coord }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::edges;
    use crate::units::{nearest, sin_cos};
    use proptest::prelude::*;

    /// A star around the origin with its corners at `radii`. No side of it is horizontal.
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

    #[test]
    fn loops_are_cut_by_the_areas_near_them_and_those_around_them() {
        let square = |(x, y): (Coord, Coord), side: Coord| -> Contour {
            let corners = [(0, 0), (side, 0), (side, side), (0, side)];
            corners.map(|(right, up)| Point { x: x + right, y: y + up }).to_vec()
        };
        // A frame with a hole in it, and so many squares far away that they are sorted into cells.
        let mut hole = square((40_000, 40_000), 20_000);
        hole.reverse();
        let mut areas = vec![square((0, 0), 100_000), hole];
        areas.extend((0..60).map(|k| square((200_000 + 30_000 * k, 0), 10_000)));
        let in_hole = square((45_000, 45_000), 5_000);
        let far = square((0, -50_000), 5_000);
        let loops = vec![
            in_hole.clone(),
            square((10_000, 10_000), 5_000),
            square((55_000, 45_000), 10_000),
            far.clone(),
            square((205_000, -5_000), 10_000),
        ];
        let Cut { whole, pieces } = cut(loops, &areas);
        assert_eq!(whole, [in_hole, far]);
        let length =
            |piece: &Vec<Point>| -> f64 { piece.windows(2).map(|p| p[0].distance(p[1])).sum() };
        // Of a loop halfway in the hole half is left; of one over the corner of a square 3/4.
        assert_eq!(pieces.iter().map(length).collect::<Vec<_>>(), [20_000.0, 30_000.0]);
    }

    #[test]
    fn many_that_overlap_make_one_in_parts() {
        // 300 triangles that share a middle, and one apart from them.
        let triangle = |k: i32| -> Contour {
            let at = |by: f64| {
                let (sin, cos) = crate::units::sin_cos(by + f64::from(k) * 0.37);
                Point { x: (cos * 90_000.0) as i32, y: (sin * 90_000.0) as i32 }
            };
            vec![at(0.0), at(120.0), at(240.0)]
        };
        let mut all: Vec<Contour> = (0..300).map(triangle).collect();
        all.push(triangle(0).into_iter().map(|p| Point { x: p.x + 500_000, ..p }).collect());
        let (parts, whole) = (by_parts(&all), united(&all));
        let area = |contours: &[Contour]| contours.iter().map(|c| double_area(c)).sum::<i128>();
        assert_eq!((parts.len(), whole.len()), (2, 2));
        // Corners are rounded to the grid, a few times.
        assert!((area(&parts) - area(&whole)).abs() < area(&whole) / 20_000);
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
            // They may differ by a micrometre along the whole outline.
            let round = edges(&star[0]).map(|(p, q)| p.distance(q)).sum::<f64>();
            let apart = (area(&ours) - area(&theirs)).abs();
            prop_assert!(apart <= 10.0 * round, "{apart} of {}", area(&theirs));
        }
    }

    /// Stars with corners on a coarse grid: many horizontal sides, many corners of equal y.
    fn stars() -> impl Strategy<Value = Vec<Contour>> {
        let shape = (prop::collection::vec(20.0..60.0, 3..12), -80..80, -80..80, any::<bool>());
        let shape = shape.prop_map(|(radii, x, y, hole): (Vec<f64>, i32, i32, bool)| {
            let coarse = |from: Coord, c: Coord| (from + c) / 4 * 4_000;
            let move_to = |p: Point| Point { x: coarse(x, p.x), y: coarse(y, p.y) };
            let mut star: Contour = star(&radii).into_iter().map(move_to).collect();
            star.dedup();
            if hole {
                star.reverse();
            }
            star
        });
        prop::collection::vec(shape, 1..5)
    }

    proptest! {
        #[test]
        fn curves_without_crossings_are_united_as_the_library_does(curves in stars()) {
            prop_assume!(curves.iter().all(|c| c.len() > 2));
            let library = |fill| from_library(&union_subjects_64(&to_library(&curves), fill));
            if let Some(ours) = disjoint(&curves, |winding| winding != 0, 0.0) {
                prop_assert_eq!(ours, library(FillRule::NonZero));
            }
            if let Some(ours) = disjoint(&curves, |winding| winding > 0, 0.0) {
                prop_assert_eq!(ours, library(FillRule::Positive));
            }
        }
    }

    #[test]
    fn a_side_too_short_for_its_cuts_is_removed() {
        let p = |x, y| Point { x, y };
        // A square on its corner, with one corner blunted.
        let cut = vec![
            p(0, -100_000),
            p(100_000, 0),
            p(1_000, 99_000),
            p(-1_000, 99_000),
            p(-100_000, 0),
        ];
        let moved = parallel(&cut, -7_071.067_8, MITER_LIMIT).unwrap();
        assert_eq!(moved.len(), 4, "{moved:?}");
        assert!(moved.iter().any(|at| at.distance2(p(0, 90_000)) <= 2), "{moved:?}");
    }

    #[test]
    fn shapes_are_kept_unless_something_is_too_thin() {
        let p = |x, y| Point { x, y };
        let square =
            |low: Coord, high: Coord| vec![p(low, low), p(high, low), p(high, high), p(low, high)];
        let block = square(0, 100_000);
        let hole = |low, high| square(low, high).into_iter().rev().collect::<Contour>();
        assert!(keep_shape(std::slice::from_ref(&block), 1_000, 0.0));
        assert!(keep_shape(&[block.clone(), hole(2_100, 50_000)], 1_000, 0.0));
        assert!(!keep_shape(&[block.clone(), hole(1_900, 50_000)], 1_000, 0.0), "a thin rim");
        assert!(!keep_shape(&[square(0, 1_900)], 1_000, 0.0), "nothing is left");
        // A pointed bump on a side, whose sides are removed one after the other from its tip.
        let mut cape = vec![p(0, 0), p(100_000, 0), p(100_000, 100_000)];
        cape.extend((0..=20).map(|k| p(51_000 - 50 * k, 100_000 + 1_000 * k)));
        cape.extend((0..20).rev().map(|k| p(49_000 + 50 * k, 100_000 + 1_000 * k)));
        cape.push(p(0, 100_000));
        assert!(!keep_shape(&[cape], 1_100, 20_000.0));
        // A blunted corner.
        let blunt =
            vec![p(0, 0), p(100_000, 0), p(100_000, 99_900), p(99_900, 100_000), p(0, 100_000)];
        let keeps = |most| keep_shape(std::slice::from_ref(&blunt), 1_000, most);
        assert!(keeps(200.0) && !keeps(100.0));
    }

    #[test]
    fn neighbouring_sides_are_cut_where_they_cross() {
        let p = |x, y| Point { x, y };
        // A square on its corner: no side is horizontal.
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
