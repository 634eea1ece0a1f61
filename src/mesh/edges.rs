//! Triangles -> Adjacency: finds the triangle on the other side of every edge.
//!
//! An edge joins two vertices. A half-edge is one side of one triangle, with the direction in
//! which the triangle's corners run. Two half-edges of one edge in opposite directions are
//! neighbours: there the surface goes on. A mesh is sound if each edge has exactly two
//! half-edges, in opposite directions.
//!
//! A sound mesh is paired by lists, by all threads. Each thread takes a range of vertices and all
//! half-edges whose lower vertex is in it; a half-edge waits in the list of its lower vertex
//! until the other one of its edge comes. That takes linear time, unless very many edges meet
//! at one vertex.
//!
//! Where that fails, half-edges are sorted into buckets by their lower vertex, and each bucket by
//! the higher one. At an edge of more than two half-edges, the triangles are ordered by their
//! angle around the edge, and neighbours are those that bound the same wedge of solid. So two
//! bodies that touch along an edge stay two bodies, whatever the order of the triangles.

use super::geometry::measure::corners_of;
use super::geometry::vector::{Corner, minus};
use crate::geom::cells::Cells;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// No half-edge: the value of [`Adjacency::neighbour`] at an open edge.
pub const NONE: u32 = u32::MAX;

/// Most triangles of a mesh: half-edges are numbered `triangle * 4 + edge` in 32 bits.
pub const MAX_TRIANGLES: usize = (1 << 30) - 1;

/// Which half-edges are neighbours. A half-edge is side `edge` of `triangle`, from corner `edge`
/// to corner `(edge + 1) % 3`; its number is `triangle * 4 + edge`, see [`half_edge`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Adjacency {
    /// For each side of each triangle its neighbour, or [`NONE`]. Always mutual.
    pub neighbour: Vec<[u32; 3]>,
    /// Half-edges without a neighbour; 0 means that the mesh is closed.
    pub unpaired: usize,
    /// Edges with more than two half-edges, all of them paired.
    pub non_manifold: usize,
}

/// The number of side `edge` (0 to 2) of `triangle`.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "fewer than 2^30 triangles, see adjacency")]
pub fn half_edge(triangle: usize, edge: usize) -> u32 {
    (triangle * 4 + edge) as u32
}

/// Triangle and side of a half-edge that is not [`NONE`].
#[must_use]
pub fn parts(half_edge: u32) -> (usize, usize) {
    ((half_edge >> 2) as usize, (half_edge & 3) as usize)
}

/// Pairs the half-edges of at most [`MAX_TRIANGLES`] `triangles` over `vertices`. A side from a
/// vertex to itself has no neighbour.
///
/// # Panics
/// If a triangle names a vertex that is not there.
#[must_use]
pub fn adjacency(vertices: &[[i32; 3]], triangles: &[[u32; 3]]) -> Adjacency {
    if let Some(neighbour) = of_sound(vertices.len(), triangles) {
        return Adjacency { neighbour, unpaired: 0, non_manifold: 0 };
    }
    let mut result =
        Adjacency { neighbour: vec![[NONE; 3]; triangles.len()], unpaired: 0, non_manifold: 0 };
    each_edge(vertices.len(), triangles, |(low, high), sides| {
        if low == high {
            result.unpaired += sides.len();
        } else {
            pair(sides, low, vertices, triangles, &mut result);
        }
    });
    result
}

/// An entry in the list of a lower vertex: one of its edges.
struct Waiting {
    high: u32,
    /// The half-edge that waits for its neighbour; [`NONE`] once it has one.
    half: u32,
    /// The entry before it in the list, or [`NONE`].
    next: u32,
}

/// The neighbours in a sound mesh; `None` if it is not sound, or if so many edges meet at one
/// vertex that lists are too slow.
fn of_sound(vertices: usize, triangles: &[[u32; 3]]) -> Option<Vec<[u32; 3]>> {
    let blank = |_: &[u32; 3]| [NONE; 3].map(AtomicU32::new);
    let neighbour: Vec<[AtomicU32; 3]> = triangles.par_iter().map(blank).collect();
    // All half-edges of an edge have the same lower vertex, so that threads share the vertices.
    let share = vertices.div_ceil(rayon::current_num_threads()).max(1);
    let shares = (0..vertices.div_ceil(share)).into_par_iter();
    let edges = shares
        .map(|k| pair_lists(k * share..vertices.min((k + 1) * share), triangles, &neighbour))
        .sum::<Option<usize>>()?;
    // With half as many edges as half-edges, each edge has two, and none is from a vertex to itself.
    let is_sound = 2 * edges == 3 * triangles.len();
    let known = |sides: [AtomicU32; 3]| sides.map(AtomicU32::into_inner);
    is_sound.then(|| neighbour.into_iter().map(known).collect())
}

/// Pairs the half-edges whose lower vertex is one of `vertices`. Returns the number of their
/// edges, or `None` as [`of_sound`] does.
#[expect(clippy::cast_possible_truncation, reason = "vertices have numbers of 32 bits")]
fn pair_lists(
    vertices: Range<usize>,
    triangles: &[[u32; 3]],
    neighbour: &[[AtomicU32; 3]],
) -> Option<usize> {
    /// List entries that may be visited per half-edge, on average. Real meshes need about 2, since
    /// a vertex has three edges in its list. Without a limit, a cone whose tip is vertex 0 takes
    /// quadratic time.
    const MOST_STEPS: usize = 16;
    let mut last = vec![NONE; vertices.len()];
    // A closed mesh has three edges for each vertex, and for two triangles.
    let room = (3 * vertices.len()).min(triangles.len() / 2 * 3);
    let mut waiting: Vec<Waiting> = Vec::with_capacity(room);
    let mut steps = 3 * MOST_STEPS * triangles.len();
    for (triangle, corners) in triangles.iter().enumerate() {
        for edge in 0..3 {
            let (low, high) = ends_of(corners, edge);
            let Some(last) = last.get_mut(low.wrapping_sub(vertices.start as u32) as usize) else {
                continue;
            };
            let here = half_edge(triangle, edge);
            let mut at = *last;
            while at != NONE && waiting[at as usize].high != high {
                at = waiting[at as usize].next;
                steps = steps.checked_sub(1)?;
            }
            if at == NONE {
                let next = std::mem::replace(last, index(waiting.len()));
                waiting.push(Waiting { high, half: here, next });
                continue;
            }
            let other = std::mem::replace(&mut waiting[at as usize].half, NONE);
            if other == NONE || starts_at(low, other, triangles) == (corners[edge] == low) {
                return None;
            }
            let (t, e) = parts(other);
            neighbour[triangle][edge].store(other, Ordering::Relaxed);
            neighbour[t][e].store(here, Ordering::Relaxed);
        }
    }
    Some(waiting.len())
}

/// An index into a list of fewer than 3 · 2³⁰ half-edges.
#[expect(clippy::cast_possible_truncation, reason = "fewer than 2^30 triangles, see adjacency")]
fn index(place: usize) -> u32 {
    place as u32
}

/// Calls `visit` for every edge of `triangles` with its lower and higher vertex and all of its
/// half-edges, at least one. Edges come in the order of their vertices.
///
/// # Panics
/// If a triangle names a vertex that is not below `vertices`.
pub(crate) fn each_edge(
    vertices: usize,
    triangles: &[[u32; 3]],
    mut visit: impl FnMut((u32, u32), &[u32]),
) {
    let mut buckets = bucketed(vertices, triangles);
    let mut sides = Vec::new();
    for (low, cell) in (0_u32..).zip(0..vertices) {
        let bucket = buckets.of_mut(cell);
        bucket.sort_unstable();
        for edge in bucket.chunk_by(|a, b| a >> 32 == b >> 32) {
            sides.clear();
            sides.extend(edge.iter().map(|&entry| number(entry)));
            visit((low, number(edge[0] >> 32)), &sides);
        }
    }
}

/// All half-edges as `higher vertex << 32 | half-edge`, in a cell for each lower vertex.
fn bucketed(vertices: usize, triangles: &[[u32; 3]]) -> Cells<u64> {
    let entry = |(triangle, corners): (usize, &[u32; 3]), edge: usize| {
        u64::from(ends_of(corners, edge).1) << 32 | u64::from(half_edge(triangle, edge))
    };
    let entries = || {
        let sides = move |one| [entry(one, 0), entry(one, 1), entry(one, 2)];
        triangles.iter().enumerate().flat_map(sides)
    };
    let low = |entry: u64| {
        let (triangle, edge) = parts(number(entry));
        ends_of(&triangles[triangle], edge).0 as usize
    };
    Cells::new(vertices, entries, |entry| std::iter::once(low(entry)))
}

/// Lower and higher vertex of a side.
fn ends_of(corners: &[u32; 3], edge: usize) -> (u32, u32) {
    let (a, b) = (corners[edge], corners[(edge + 1) % 3]);
    (a.min(b), a.max(b))
}

/// The half-edge of an entry: its lower half.
#[expect(clippy::cast_possible_truncation, reason = "the lower half is wanted")]
fn number(entry: u64) -> u32 {
    entry as u32
}

/// Whether a half-edge starts at the vertex `low`.
pub(crate) fn starts_at(low: u32, half: u32, triangles: &[[u32; 3]]) -> bool {
    let (triangle, edge) = parts(half);
    triangles[triangle][edge] == low
}

/// Pairs the half-edges `sides` of one edge, whose lower vertex is `low`.
fn pair(
    sides: &[u32],
    low: u32,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    result: &mut Adjacency,
) {
    let upwards = |half: u32| starts_at(low, half, triangles);
    if let &[a, b] = sides
        && upwards(a) != upwards(b)
    {
        join(a, b, result);
        return;
    }
    let is_balanced = 2 * sides.iter().filter(|&&half| upwards(half)).count() == sides.len();
    result.non_manifold += usize::from(is_balanced);
    let around = in_order_around(sides, vertices, triangles, upwards);
    // Matched like brackets in a ring: a half-edge that goes up pairs with the next free one that
    // goes down, so that bodies that touch along the edge stay apart.
    let count = around.len();
    let mut taken = vec![false; count];
    let mut waiting = Vec::new();
    for step in 0..2 * count {
        let k = step % count;
        if taken[k] {
            continue;
        }
        if upwards(around[k]) {
            // In the second round it waits already.
            waiting.extend((step < count).then_some(k));
        } else if let Some(opened) = waiting.pop() {
            join(around[opened], around[k], result);
            (taken[k], taken[opened]) = (true, true);
        }
    }
    result.unpaired += taken.iter().filter(|&&taken| !taken).count();
}

/// The half-edges of one edge, ordered by the angle of their triangles around it. At equal angles
/// those that go down come first; then the coordinates of the third corner decide.
fn in_order_around(
    sides: &[u32],
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    upwards: impl Fn(u32) -> bool,
) -> Vec<u32> {
    let corner = |half: u32, step: usize| -> Corner {
        let (triangle, edge) = parts(half);
        corners_of(vertices, triangles[triangle])[(edge + step) % 3]
    };
    let Some(&first) = sides.iter().find(|&&half| upwards(half)).or(sides.first()) else {
        return Vec::new();
    };
    let (from, to) = if upwards(first) { (0, 1) } else { (1, 0) };
    let (from, to) = (corner(first, from), corner(first, to));
    let vector = |to: Corner| Vector3::from(minus(to, from).map(|side| side as f64));
    let along = vector(to);
    // Two directions across the edge: one in the plane of its two longer extents, and one
    // across both.
    let least = along.map(f64::abs).imin();
    let (j, k) = ((least + 1) % 3, (least + 2) % 3);
    let mut u = Vector3::zeros();
    (u[j], u[k]) = (-along[k], along[j]);
    let v = along.cross(&u);
    // The lengths of `u` and `v` differ by that of the edge.
    let length = along.norm();
    // Not the angle, but a number from 0 to 4 that grows with it.
    let turn = |half: u32| {
        let side = vector(corner(half, 2));
        let (x, y) = (u.dot(&side) * length, v.dot(&side));
        let share = if x == 0.0 && y == 0.0 { 0.0 } else { y / (x.abs() + y.abs()) };
        if x < 0.0 {
            2.0 - share
        } else if share < 0.0 {
            4.0 + share
        } else {
            share
        }
    };
    let mut keyed: Vec<_> =
        sides.iter().map(|&half| (turn(half), upwards(half), corner(half, 2), half)).collect();
    keyed.sort_unstable_by(|a, b| {
        a.0.total_cmp(&b.0).then_with(|| (a.1, a.2, a.3).cmp(&(b.1, b.2, b.3)))
    });
    keyed.into_iter().map(|(.., half)| half).collect()
}

fn join(a: u32, b: u32, result: &mut Adjacency) {
    for (from, to) in [(a, b), (b, a)] {
        let (triangle, edge) = parts(from);
        result.neighbour[triangle][edge] = to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    const CORNERS: [[i32; 3]; 6] =
        [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9], [-9, -9, 1], [-9, -9, -9]];

    fn check_mutual(triangles: &[[u32; 3]], result: &Adjacency) {
        for (triangle, sides) in result.neighbour.iter().enumerate() {
            for (edge, &other) in sides.iter().enumerate().filter(|(_, other)| **other != NONE) {
                let (u, f) = parts(other);
                assert_eq!(result.neighbour[u][f], half_edge(triangle, edge));
                assert_eq!(triangles[triangle][edge], triangles[u][(f + 1) % 3]);
                assert_eq!(triangles[triangle][(edge + 1) % 3], triangles[u][f]);
            }
        }
    }

    #[test]
    fn a_tetrahedron_is_closed() {
        let result = adjacency(&CORNERS, &TETRAHEDRON);
        assert_eq!((result.unpaired, result.non_manifold), (0, 0));
        check_mutual(&TETRAHEDRON, &result);
        assert_eq!(result.neighbour[0], [half_edge(3, 0), half_edge(2, 0), half_edge(1, 0)]);
    }

    #[test]
    fn a_missing_face_leaves_three_sides_open() {
        let result = adjacency(&CORNERS, &TETRAHEDRON[1..]);
        assert_eq!((result.unpaired, result.non_manifold), (3, 0));
        check_mutual(&TETRAHEDRON[1..], &result);
    }

    #[test]
    fn a_face_wound_the_wrong_way_has_no_neighbours() {
        let mut triangles = TETRAHEDRON;
        triangles[2].reverse();
        let result = adjacency(&CORNERS, &triangles);
        assert_eq!((result.unpaired, result.neighbour[2]), (6, [NONE; 3]));
        check_mutual(&triangles, &result);
    }

    /// Two tetrahedra that share the edge from vertex 0 to vertex 3.
    fn siamese() -> Vec<[u32; 3]> {
        let mut triangles = TETRAHEDRON.to_vec();
        triangles.extend(TETRAHEDRON.map(|corners| corners.map(|v| [0, 4, 5, 3][v as usize])));
        triangles
    }

    #[test]
    fn an_edge_of_four_faces_is_closed_whatever_the_order_of_the_faces() {
        let triangles = siamese();
        let first = adjacency(&CORNERS, &triangles);
        assert_eq!((first.unpaired, first.non_manifold), (0, 1));
        check_mutual(&triangles, &first);
        let partner = |triangles: &[[u32; 3]], result: &Adjacency, at: usize| {
            result.neighbour[at].map(|half| triangles[parts(half).0])
        };
        let mut turned = triangles.clone();
        turned.reverse();
        let second = adjacency(&CORNERS, &turned);
        for at in 0..triangles.len() {
            let other = triangles.len() - 1 - at;
            assert_eq!(partner(&triangles, &first, at), partner(&turned, &second, other));
        }
    }

    #[test]
    fn a_fin_stays_open_alone() {
        let mut triangles = TETRAHEDRON.to_vec();
        triangles.push([0, 3, 5]);
        let result = adjacency(&CORNERS, &triangles);
        assert_eq!((result.unpaired, result.non_manifold), (3, 0));
        check_mutual(&triangles, &result);
    }

    #[test]
    fn a_side_without_length_has_no_neighbour() {
        let triangles = [[0, 0, 1], [0, 0, 1]];
        let result = adjacency(&CORNERS, &triangles);
        assert_eq!(result.neighbour[0][0], NONE);
        assert_eq!(result.unpaired, 2);
        check_mutual(&triangles, &result);
    }
}
