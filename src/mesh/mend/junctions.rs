//! Corners on edges -> split triangles: gives an open edge the corners that the triangles beside it have there.

use super::Work;
use super::beside::Beside;
use super::near::open_edges;
use crate::mesh::faults::{Fault, Mending};
use crate::mesh::geometry::vector::{Corner, distance2, dot, length, minus};
use hashbrown::HashMap;

/// A corner further from an edge than this share of the edge's length does not lie on it, even
/// within the tolerance. In small triangles it is a corner of the next triangle, and a larger
/// value would split there.
const MOST_OFF: f64 = 0.05;

/// Looks at a corner beside an edge, for all edges together, and more for each of them. Where very
/// many edges lie on one line each would be split at all corners of the others: then the rest stays
/// open, and is reported as such.
const MOST_LOOKS: usize = 1 << 22;
const MOST_LOOKS_OF_EDGE: usize = 64;

/// An open side of a triangle and the vertices along it.
type Split = (usize, Vec<u32>);

/// Splits the triangles of open edges at the open corners that lie on them.
///
/// Each pass splits a triangle along one edge. Its other two edges then belong to one piece each,
/// so that three passes are enough.
pub(super) fn split_junctions(work: &mut Work, tolerance: i32) {
    for _ in 0..3 {
        let splits = splits(work, tolerance);
        if splits.is_empty() {
            return;
        }
        let mut split = Vec::with_capacity(work.triangles.len());
        for (t, &triangle) in work.triangles.iter().enumerate() {
            let Some((side, between)) = splits.get(&t) else {
                split.push(triangle);
                continue;
            };
            for &v in between {
                work.found.add(Fault::TJunction, v);
            }
            work.done.add(Mending::SplitTJunction, between[0]);
            fan(triangle, *side, between, &mut split);
        }
        work.triangles = split;
    }
}

/// For each triangle to be split the side to split: the longest that has corners on it.
fn splits(work: &Work, tolerance: i32) -> HashMap<usize, Split> {
    let edges = open_edges(work);
    let ends_of = |(t, side): (usize, usize)| {
        let triangle = work.triangles[t];
        [triangle[side], triangle[(side + 1) % 3]]
    };
    let line_of = |edge| ends_of(edge).map(|v| work.vertices[v as usize]);
    let mut ends: Vec<u32> = edges.iter().flat_map(|&edge| ends_of(edge)).collect();
    ends.sort_unstable();
    ends.dedup();
    let mut looks = MOST_LOOKS + MOST_LOOKS_OF_EDGE * edges.len();
    let corners = Beside::new(work.vertices, ends);
    let mut splits: HashMap<usize, Split> = HashMap::default();
    for (t, side) in edges {
        let line = line_of((t, side));
        let between = between(work, &corners, (work.triangles[t], line), (tolerance, &mut looks));
        if looks == 0 {
            break;
        }
        if between.is_empty() {
            continue;
        }
        let key = |side: usize| {
            let [a, b] = line_of((t, side));
            (distance2(a, b), a.min(b), a.max(b))
        };
        if splits.get(&t).is_none_or(|known| key(side) > key(known.0)) {
            splits.insert(t, (side, between));
        }
    }
    splits
}

/// The open corners on a side of a triangle, in their order along it.
fn between(
    work: &Work,
    corners: &Beside<'_>,
    (triangle, [from, to]): ([u32; 3], [Corner; 2]),
    (tolerance, looks): (i32, &mut usize),
) -> Vec<u32> {
    let mut on_it: Vec<(i128, Corner, u32)> = Vec::new();
    corners.along(from, to, tolerance, |v| {
        *looks = looks.saturating_sub(1);
        if *looks > 0 && !triangle.contains(&v) {
            let at = work.vertices[v as usize];
            let place = place_on([from, to], at, f64::from(tolerance));
            on_it.extend(place.map(|place| (place, at, v)));
        }
    });
    on_it.sort_unstable();
    on_it.dedup();
    on_it.into_iter().map(|(.., v)| v).collect()
}

/// How far along the line `v` lies, if it is within the tolerance of the line and further than
/// that from its ends.
fn place_on([from, to]: [Corner; 2], v: Corner, tolerance: f64) -> Option<i128> {
    let (line, side) = (minus(to, from), minus(v, from));
    let (long, place) = (length(line), dot(line, side));
    let along = place as f64 / long;
    let off2 = length(side).powi(2) - along * along;
    let is_inside = along > tolerance && along < long - tolerance;
    let most = tolerance.min(MOST_OFF * long);
    (is_inside && off2 <= most * most).then_some(place)
}

/// The pieces of a triangle that is split at the vertices `between` the ends of a side.
fn fan(triangle: [u32; 3], side: usize, between: &[u32], out: &mut Vec<[u32; 3]>) {
    let corner = |step: usize| triangle[(side + step) % 3];
    let (first, last, apex) = (corner(0), corner(1), corner(2));
    let way: Vec<u32> = [&[first], between, &[last]].concat();
    out.extend(way.windows(2).map(|ends| [ends[0], ends[1], apex]));
}
