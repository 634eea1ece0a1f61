//! Corners -> RawMesh: gives equal corners one vertex, drops triangles with two equal corners, checks stored normals.

use crate::mesh::RawMesh;
use hashbrown::hash_table::Entry;
use hashbrown::{DefaultHashBuilder, HashTable};
use std::hash::BuildHasher as _;

/// Most triangles that memory is reserved for before they are read: 12 MB of indices. A damaged
/// count can claim no more; above it the lists grow by doubling, which costs little.
const MOST_AHEAD: usize = 1 << 20;

/// A triangle of a file, ready to be welded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facet {
    corners: [[f32; 3]; 3],
    /// Whether its stored normal points to the side that is inside by the order of the corners.
    is_against: bool,
}

impl Facet {
    pub(super) fn new(normal: [f32; 3], corners: [[f32; 3]; 3]) -> Self {
        // Adding zero turns -0 into 0 and leaves every other number as it is.
        let corners = corners.map(|corner| corner.map(|number| number + 0.0));
        Self { corners, is_against: is_against(normal, corners) }
    }
}

/// Collects triangles into a [`RawMesh`]. Vertices are numbered in the order of their first use,
/// since the hash table is looked up but never iterated over. Its keys are random, so that nobody
/// can make a file whose corners all fall into one place of it.
#[derive(Debug, Default)]
pub(super) struct Welder {
    /// Indices of vertices by the bits of their numbers.
    index: HashTable<u32>,
    keys: DefaultHashBuilder,
    /// The corners of the last triangle, and their vertices. In most files the next triangle
    /// shares some of them, and comparing is faster than looking up.
    before: Option<([[f32; 3]; 3], [u32; 3])>,
    mesh: RawMesh,
}

impl Welder {
    /// A welder with room for `triangles`, but for no more than [`MOST_AHEAD`].
    pub(super) fn with_capacity(triangles: usize) -> Self {
        let triangles = triangles.min(MOST_AHEAD);
        // A closed mesh has half as many vertices as triangles.
        let index = HashTable::with_capacity(triangles / 2);
        let mut welder = Self { index, ..Self::default() };
        welder.mesh.vertices.reserve(triangles / 2);
        welder.mesh.triangles.reserve(triangles);
        welder
    }

    /// Adds one triangle, unless two of its corners are equal.
    pub(super) fn add(&mut self, facet: &Facet) {
        let corners = facet.corners;
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            self.mesh.degenerate += 1;
            return;
        }
        self.mesh.wrong_normals += usize::from(facet.is_against);
        let before = self.before;
        let triangle = corners.map(|corner| {
            let known = before.and_then(|(corners, vertices)| {
                corners.iter().position(|&other| other == corner).map(|k| vertices[k])
            });
            known.unwrap_or_else(|| self.vertex(corner))
        });
        self.before = Some((corners, triangle));
        self.mesh.triangles.push(triangle);
    }

    #[expect(clippy::cast_possible_truncation, reason = "3 * edges::MAX_TRIANGLES fits u32")]
    fn vertex(&mut self, corner: [f32; 3]) -> u32 {
        let Self { index, keys, mesh: RawMesh { vertices, .. }, .. } = self;
        let hash = |&[x, y, z]: &[f32; 3]| {
            keys.hash_one((u64::from(x.to_bits()) << 32 | u64::from(y.to_bits()), z.to_bits()))
        };
        let is_same = |&vertex: &u32| vertices[vertex as usize] == corner;
        match index.entry(hash(&corner), is_same, |&vertex| hash(&vertices[vertex as usize])) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(free) => {
                let vertex = vertices.len() as u32;
                free.insert(vertex);
                vertices.push(corner);
                vertex
            }
        }
    }

    /// How many triangles were added, with those that were dropped.
    pub(super) fn count(&self) -> usize {
        self.mesh.triangles.len() + self.mesh.degenerate
    }

    /// The mesh, with the counts of its report filled in.
    pub(super) fn finish(self) -> RawMesh {
        let mut mesh = self.mesh;
        mesh.report.triangles = mesh.triangles.len();
        mesh.report.vertices = mesh.vertices.len();
        mesh
    }
}

/// Whether a stored normal is finite and not zero, and more than 90° off the normal by the order
/// of the corners.
fn is_against(normal: [f32; 3], corners: [[f32; 3]; 3]) -> bool {
    let [a, b, c] = corners;
    let from_a = |p: [f32; 3], axis: usize| f64::from(p[axis]) - f64::from(a[axis]);
    let across = |i: usize, j: usize| from_a(b, i) * from_a(c, j) - from_a(b, j) * from_a(c, i);
    let [x, y, z] = normal.map(f64::from);
    let along = x * across(1, 2) + y * across(2, 0) + z * across(0, 1);
    // The comparison is false for NaN; an infinite normal is none.
    along < 0.0 && normal.iter().all(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: [f32; 3] = [0.0; 3];

    #[test]
    fn equal_corners_share_a_vertex_in_the_order_of_first_use() {
        let mut welder = Welder::default();
        welder.add(&Facet::new(NONE, [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        welder.add(&Facet::new(NONE, [[0.0, 1.0, -0.0], [-0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]));
        let mesh = welder.finish();
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(mesh.vertices[3], [0.0, 0.0, 1.0]);
        assert_eq!((mesh.report.triangles, mesh.report.vertices), (2, 4));
    }

    #[test]
    fn only_triangles_with_equal_corners_are_dropped() {
        let mut welder = Welder::default();
        welder.add(&Facet::new(NONE, [[9.0, 9.0, 9.0], [9.0, 9.0, 9.0], [5.0, 5.0, 5.0]]));
        welder.add(&Facet::new(NONE, [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [-0.0, 0.0, -0.0]]));
        welder.add(&Facet::new(NONE, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]));
        let mesh = welder.finish();
        assert_eq!((mesh.degenerate, mesh.triangles.len()), (2, 1));
        assert_eq!(mesh.vertices.len(), 3, "a dropped triangle leaves no vertex behind");
    }

    #[test]
    fn stored_normals_are_judged_by_the_winding() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        for (normal, wrong) in [
            ([0.0, 0.0, 1.0], 0),
            ([0.0, 0.0, -1.0], 1),
            ([0.0, 0.0, 0.0], 0),
            // Less than 90° off is rounding, and so is a right angle.
            ([9.0, 0.0, 0.1], 0),
            ([9.0, 0.0, 0.0], 0),
            ([9.0, 0.0, -0.1], 1),
            ([f32::NAN, 0.0, -1.0], 0),
            ([0.0, f32::INFINITY, -1.0], 0),
            ([0.0, 0.0, -1e-30], 1),
        ] {
            let mut welder = Welder::default();
            welder.add(&Facet::new(normal, corners));
            assert_eq!(welder.finish().wrong_normals, wrong, "{normal:?}");
        }
    }
}
