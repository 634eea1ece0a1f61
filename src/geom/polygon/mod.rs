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

#[cfg(test)]
mod tests;

use super::boxes::{Boxes, extent};
use super::parallel::{parallel, parallel_and_lost};
use super::simple::windings;
use super::{Contour, Point, double_area, segment, side};
use crate::units::{Bounded as _, Coord};
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
/// another or vanishes, and none loses sides with a total length above `most` (grid units). A pointed tip may
/// move far along its sides: see [`sharpest`].
#[must_use]
pub fn keep_shape(contours: &[Contour], distance: Coord, most: f64) -> bool {
    let distance = -f64::from(distance);
    let moved = contours.iter().map(|c| parallel_and_lost(c, distance, MITER_LIMIT));
    let kept = moved.map(|moved| moved.filter(|(_, lost)| *lost <= most).map(|(curve, _)| curve));
    let curves = kept.collect::<Option<Vec<Contour>>>();
    let left = curves.and_then(|curves| disjoint(&curves, |winding| winding > 0, distance));
    left.is_some_and(|left| left.len() == contours.len())
}

/// How far the tip of the sharpest corner moves along its sides for each unit that they move inwards: the
/// cotangent of half its angle. Corners that stick into the part do not move inwards; 0 if all do.
#[must_use]
pub fn sharpest(contours: &[Contour]) -> f64 {
    let way =
        |a: Point, b: Point| [[a.x, b.x], [a.y, b.y]].map(|[a, b]| f64::from(b) - f64::from(a));
    let corner = |contour: &Contour, k: usize| {
        let n = contour.len();
        let at = contour[k];
        let (u, v) = (way(contour[(k + n - 1) % n], at), way(at, contour[(k + 1) % n]));
        let cross = u[0] * v[1] - u[1] * v[0];
        let length = (segment::dot(u, u) * segment::dot(v, v)).sqrt();
        // The solid is on the left.
        if cross > 0.0 {
            cross / (length + segment::dot(u, v)).at_least(f64::MIN_POSITIVE)
        } else {
            0.0
        }
    };
    let all = contours.iter().flat_map(|contour| (0..contour.len()).map(move |k| (contour, k)));
    all.map(|(contour, k)| corner(contour, k)).fold(0.0, f64::max)
}

/// Subtracts `others` from `contours` (both as from [`union`]). The result is simplified within
/// `tolerance`, since contours that nearly coincide leave tiny edges.
#[must_use]
pub fn difference(contours: &[Contour], others: &[Contour], tolerance: Coord) -> Vec<Contour> {
    let (contours, others) = (to_library(contours), to_library(others));
    let left = difference_64(&contours, &others, FillRule::NonZero);
    // A sliver may turn over when it is simplified: then it would be a hole in nothing.
    let simpler = |path: &Path64| {
        let simple = clipper2_rust::simplify_path(path, f64::from(tolerance), true);
        let [before, after] = [path, &simple].map(clipper2_rust::area::<i64>);
        (before * after > 0.0).then_some(simple)
    };
    from_library(&left.iter().filter_map(simpler).collect())
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
            let contours = without_lowest_holes(contours);
            from_library(&inflate_paths_64(&contours, distance, join, end, MITER_LIMIT, 0.0))
        }
    };
    moved.into_iter().map(cleaned).filter(is_shape).collect()
}

/// The contours for the library, which takes the lowest one for an outer one, and turns all others round if it is
/// none. A hole in nothing is a sliver that rounding has turned over.
fn without_lowest_holes(contours: &[Contour]) -> Paths64 {
    let mut left: Vec<&Contour> = contours.iter().filter(|c| !c.is_empty()).collect();
    let lowest = |c: &Contour| c.iter().map(|p| (p.y, Reverse(p.x))).max();
    while let Some(at) = (0..left.len()).max_by_key(|&k| lowest(left[k])) {
        if double_area(left[at]) > 0 {
            break;
        }
        left.remove(at);
    }
    left.into_iter().map(|contour| path(contour)).collect()
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
