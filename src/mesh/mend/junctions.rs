//! Corners on edges -> split triangles: gives an open edge the corners that its neighbours have along it.

use super::Work;
use super::cells::Cells;
use super::near::open_edges;
use crate::mesh::faults::{Fault, Mending};
use crate::mesh::vector::{Corner, distance2, dot, length, minus};
use hashbrown::HashMap;

/// A corner further from an edge than this share of its length is none of it, even within the
/// tolerance: in small triangles it is another triangle's.
const MOST_OFF: f64 = 0.05;

/// An open edge of a triangle and the vertices along it, from the first corner on.
type Split = ((u32, u32), Vec<u32>);

/// Splits the triangles of open edges at the open corners that lie on them.
///
/// Each pass splits a triangle along one edge: its other edges come into one piece each,
/// so that a third pass leaves nothing to do.
pub(super) fn split_junctions(work: &mut Work, tolerance: i32) {
    for _ in 0..3 {
        let splits = splits(work, tolerance);
        if splits.is_empty() {
            return;
        }
        let mut split = Vec::with_capacity(work.triangles.len());
        for (t, &triangle) in (0_u32..).zip(&work.triangles) {
            let Some(((from, to), between)) = splits.get(&t) else {
                split.push(triangle);
                continue;
            };
            for &v in between {
                work.found.add(Fault::TJunction, v);
            }
            work.done.add(Mending::SplitTJunction, between[0]);
            fan(triangle, (*from, *to), between, &mut split);
        }
        work.triangles = split;
    }
}

/// For each triangle to be split the edge to begin with: its longest.
fn splits(work: &Work, tolerance: i32) -> HashMap<u32, Split> {
    let edges = open_edges(work);
    let mut ends: Vec<u32> = edges.iter().flat_map(|&(a, b, _)| [a, b]).collect();
    ends.sort_unstable();
    ends.dedup();
    let cells = Cells::new(work.vertices, &ends, cube(work, &edges, tolerance));
    let mut splits: HashMap<u32, Split> = HashMap::default();
    for (a, b, t) in edges {
        let between = between(work, &cells, (a, b), (work.triangles[t as usize], tolerance));
        if between.is_empty() {
            continue;
        }
        let key = |(a, b): (u32, u32)| {
            let (a, b) = (work.vertices[a as usize], work.vertices[b as usize]);
            (distance2(a, b), a.min(b), a.max(b))
        };
        let slot = splits.entry(t).or_insert_with(|| ((a, b), Vec::new()));
        if slot.1.is_empty() || key((a, b)) > key(slot.0) {
            *slot = ((a, b), between);
        }
    }
    splits
}

/// The side of the cubes that open corners are sorted into: the mean length of an open edge,
/// so that an edge touches few cubes and a cube holds few corners.
fn cube(work: &Work, edges: &[(u32, u32, u32)], tolerance: i32) -> i64 {
    let lengths = edges
        .iter()
        .map(|&(a, b, _)| length(minus(work.vertices[a as usize], work.vertices[b as usize])));
    let mean = lengths.sum::<f64>() / edges.len().max(1) as f64;
    (mean as i64).max(i64::from(tolerance))
}

/// The open corners on the line from `a` to `b`, in the order along it.
fn between(
    work: &Work,
    cells: &Cells,
    (a, b): (u32, u32),
    (triangle, tolerance): ([u32; 3], i32),
) -> Vec<u32> {
    let (from, to) = (work.vertices[a as usize], work.vertices[b as usize]);
    let mut on_it: Vec<(i128, Corner, u32)> = Vec::new();
    cells.along(from, to, tolerance, |v| {
        if !triangle.contains(&v) {
            let at = work.vertices[v as usize];
            on_it
                .extend(place_on((from, to), at, f64::from(tolerance)).map(|place| (place, at, v)));
        }
    });
    on_it.sort_unstable();
    on_it.dedup();
    on_it.into_iter().map(|(.., v)| v).collect()
}

/// How far along the line `v` lies, if it is within the tolerance of it and further than that
/// from its ends.
fn place_on((from, to): (Corner, Corner), v: Corner, tolerance: f64) -> Option<i128> {
    let (line, side) = (minus(to, from), minus(v, from));
    let (long, place) = (length(line), dot(line, side));
    let along = place as f64 / long;
    let off2 = length(side).powi(2) - along * along;
    let is_inside = along > tolerance && along < long - tolerance;
    let most = tolerance.min(MOST_OFF * long);
    (is_inside && off2 <= most * most).then_some(place)
}

/// The pieces of a triangle that is split at the vertices `between` its corners `from` and `to`.
fn fan(triangle: [u32; 3], (from, to): (u32, u32), between: &[u32], out: &mut Vec<[u32; 3]>) {
    let side = (0..3).find(|&k| {
        let ends = (triangle[k], triangle[(k + 1) % 3]);
        ends == (from, to) || ends == (to, from)
    });
    let side = side.unwrap_or(0);
    let (first, last, apex) = (triangle[side], triangle[(side + 1) % 3], triangle[(side + 2) % 3]);
    let mut way: Vec<u32> = vec![from];
    way.extend(between);
    way.push(to);
    if first != from {
        way.reverse();
    }
    debug_assert_eq!((way.first(), way.last()), (Some(&first), Some(&last)));
    out.extend(way.windows(2).map(|ends| [ends[0], ends[1], apex]));
}
