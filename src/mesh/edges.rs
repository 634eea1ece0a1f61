//! Triangles -> Adjacency: finds the triangle on the other side of every edge.

use super::geometry::vector::minus;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// No half-edge: what [`Adjacency::neighbour`] says at an open edge.
pub const NONE: u32 = u32::MAX;

/// Which half-edge continues which. A half-edge is side `edge` of `triangle`,
/// from corner `edge` to corner `(edge + 1) % 3`, and its number is
/// `triangle * 4 + edge`; see [`half_edge`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Adjacency {
    /// For each side of each triangle the half-edge of the same two vertices
    /// in the opposite direction, or [`NONE`]. Always mutual.
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

/// Pairs the half-edges of fewer than 2³⁰ `triangles` over `vertices`, in linear time.
///
/// Where an edge has more than two half-edges, they are taken in the order of their
/// triangles around the edge, and those that bound the same wedge of solid are
/// paired; the order of the triangles does not matter. An edge from a vertex to
/// itself has no neighbour.
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

/// A half-edge whose other one was not met yet, in a list of those with the same lower vertex.
struct Waiting {
    high: u32,
    /// [`NONE`] once it is paired.
    half: u32,
    /// The one before it in the list, or [`NONE`].
    next: u32,
}

/// The neighbours in a mesh each edge of which has two half-edges in opposite directions; none
/// if it has others, or if so many edges meet at one vertex that lists are no way to find them.
fn of_sound(vertices: usize, triangles: &[[u32; 3]]) -> Option<Vec<[u32; 3]>> {
    let blank = |_: &[u32; 3]| [NONE; 3].map(AtomicU32::new);
    let neighbour: Vec<[AtomicU32; 3]> = triangles.par_iter().map(blank).collect();
    // All half-edges of an edge have the same lower vertex: each thread takes some vertices.
    let share = vertices.div_ceil(rayon::current_num_threads()).max(1);
    let shares = (0..vertices.div_ceil(share)).into_par_iter();
    let edges = shares
        .map(|k| pair_lists(k * share..vertices.min((k + 1) * share), triangles, &neighbour))
        .sum::<Option<usize>>()?;
    // All are paired if so many were left waiting at first, and no edge has one vertex only.
    let is_sound = 2 * edges == 3 * triangles.len();
    let known = |sides: [AtomicU32; 3]| sides.map(AtomicU32::into_inner);
    is_sound.then(|| neighbour.into_iter().map(known).collect())
}

/// Pairs the half-edges whose lower vertex is one of `vertices`. Returns how many edges they
/// are on, or none as [`of_sound`] does.
#[expect(clippy::cast_possible_truncation, reason = "vertices have numbers of 32 bits")]
fn pair_lists(
    vertices: Range<usize>,
    triangles: &[[u32; 3]],
    neighbour: &[[AtomicU32; 3]],
) -> Option<usize> {
    /// Half-edges that may be looked at to find one, on average.
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

/// A place in a list of fewer than 3 · 2³⁰ half-edges.
#[expect(clippy::cast_possible_truncation, reason = "fewer than 2^30 triangles, see adjacency")]
fn index(place: usize) -> u32 {
    place as u32
}

/// Calls `visit` with every edge of `triangles`, its lower and its higher vertex, and the
/// half-edges on it in both directions, at least one. Edges come in the order of their vertices.
///
/// # Panics
/// If a triangle names a vertex that is not below `vertices`.
pub(crate) fn each_edge(
    vertices: usize,
    triangles: &[[u32; 3]],
    mut visit: impl FnMut((u32, u32), &[u32]),
) {
    let (mut entries, ends) = bucketed(vertices, triangles);
    let mut start = 0;
    let mut sides = Vec::new();
    for (low, end) in (0_u32..).zip(ends) {
        let bucket = &mut entries[start..end as usize];
        start = end as usize;
        bucket.sort_unstable();
        for edge in bucket.chunk_by(|a, b| a >> 32 == b >> 32) {
            sides.clear();
            sides.extend(edge.iter().map(|&entry| number(entry)));
            visit((low, number(edge[0] >> 32)), &sides);
        }
    }
}

/// All half-edges as `higher vertex << 32 | half-edge`, grouped by their lower
/// vertex, and for each vertex where its group ends.
fn bucketed(vertices: usize, triangles: &[[u32; 3]]) -> (Vec<u64>, Vec<u32>) {
    let mut next = vec![0_u32; vertices];
    for corners in triangles {
        for edge in 0..3 {
            next[ends_of(corners, edge).0 as usize] += 1;
        }
    }
    let mut sum = 0;
    for slot in &mut next {
        let count = *slot;
        *slot = sum;
        sum += count;
    }
    let mut entries = vec![0_u64; triangles.len() * 3];
    for (triangle, corners) in triangles.iter().enumerate() {
        for edge in 0..3 {
            let (low, high) = ends_of(corners, edge);
            let slot = &mut next[low as usize];
            entries[*slot as usize] = u64::from(high) << 32 | u64::from(half_edge(triangle, edge));
            *slot += 1;
        }
    }
    (entries, next)
}

/// Lower and higher vertex of a side.
fn ends_of(corners: &[u32; 3], edge: usize) -> (u32, u32) {
    let (a, b) = (corners[edge], corners[(edge + 1) % 3]);
    (a.min(b), a.max(b))
}

/// The half-edge in the lower half of an entry.
#[expect(clippy::cast_possible_truncation, reason = "the lower half is wanted")]
fn number(entry: u64) -> u32 {
    entry as u32
}

/// Whether a half-edge starts at vertex `low`.
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
    // Like brackets in a ring: a face that goes up is closed by the next free one that goes
    // down, so that bodies that touch along the edge stay apart.
    let count = around.len();
    let mut taken = vec![false; count];
    let mut waiting = Vec::new();
    for step in 0..2 * count {
        let k = step % count;
        if taken[k] {
            continue;
        }
        if upwards(around[k]) {
            // In the second round they wait already.
            waiting.extend((step < count).then_some(k));
        } else if let Some(opened) = waiting.pop() {
            join(around[opened], around[k], result);
            (taken[k], taken[opened]) = (true, true);
        }
    }
    result.unpaired += taken.iter().filter(|&&taken| !taken).count();
}

/// The half-edges of one edge by the angle of their triangles about it; those that go down
/// come first where angles are equal, then by the coordinates of the third corner.
fn in_order_around(
    sides: &[u32],
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    upwards: impl Fn(u32) -> bool,
) -> Vec<u32> {
    let corner = |half: u32, step: usize| {
        let (triangle, edge) = parts(half);
        vertices[triangles[triangle][(edge + step) % 3] as usize]
    };
    let Some(&first) = sides.iter().find(|&&half| upwards(half)).or(sides.first()) else {
        return Vec::new();
    };
    let from = if upwards(first) { corner(first, 0) } else { corner(first, 1) };
    let to = if upwards(first) { corner(first, 1) } else { corner(first, 0) };
    let along = minus(to, from).map(|side| side as f64);
    // Across the edge in the plane of its two longer extents, and across both.
    let least = (0..3).min_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap_or(0);
    let (j, k) = ((least + 1) % 3, (least + 2) % 3);
    let mut u = [0.0; 3];
    (u[j], u[k]) = (-along[k], along[j]);
    let v: [f64; 3] = std::array::from_fn(|axis| {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        along[a] * u[b] - along[b] * u[a]
    });
    let turn = |half: u32| {
        let side = minus(corner(half, 2), from).map(|side| side as f64);
        let part = |axis: [f64; 3]| (0..3).map(|i| axis[i] * side[i]).sum::<f64>();
        // Scaled to like lengths; a measure that grows with the angle, from 0 to 4.
        let length = along.iter().map(|side| side * side).sum::<f64>().sqrt();
        let (x, y) = (part(u) * length, part(v));
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
