//! Corners -> RawMesh: gives bit-equal corners one vertex and drops triangles with two equal corners.

use super::RawMesh;
use rustc_hash::FxHashMap;

/// Most triangles a mesh may have: half-edges are numbered `triangle * 4 + edge` in 32 bits.
pub(crate) const MAX_TRIANGLES: usize = (1 << 30) - 1;

/// The bits of a corner, packed.
type Key = (u64, u32);

/// Collects triangles into a [`RawMesh`]. The map is only looked up, never
/// walked, so that a vertex's index is the order of its first use.
#[derive(Debug, Default)]
pub(crate) struct Welder {
    index: FxHashMap<Key, u32>,
    mesh: RawMesh,
}

impl Welder {
    /// A welder with room for about `triangles`, which must be bounded by the
    /// length of the input and not only by what its header says.
    pub(crate) fn with_capacity(triangles: usize) -> Self {
        let mut welder = Self::default();
        // A closed mesh has half as many vertices as triangles.
        welder.index.reserve(triangles / 2);
        welder.mesh.vertices.reserve(triangles / 2);
        welder.mesh.triangles.reserve(triangles);
        welder
    }

    /// Adds one triangle, unless two of its corners are equal.
    pub(crate) fn add(&mut self, corners: [[f32; 3]; 3]) {
        // Adding zero turns -0 into 0 and leaves every other number as it is.
        let corners = corners.map(|corner| corner.map(|number| number + 0.0));
        let keys = corners.map(key);
        if keys[0] == keys[1] || keys[1] == keys[2] || keys[2] == keys[0] {
            self.mesh.report.degenerate += 1;
            return;
        }
        let triangle = std::array::from_fn(|i| self.vertex(keys[i], corners[i]));
        self.mesh.triangles.push(triangle);
    }

    #[expect(clippy::cast_possible_truncation, reason = "3 * MAX_TRIANGLES fits u32")]
    fn vertex(&mut self, key: Key, corner: [f32; 3]) -> u32 {
        let vertices = &mut self.mesh.vertices;
        *self.index.entry(key).or_insert_with(|| {
            vertices.push(corner);
            (vertices.len() - 1) as u32
        })
    }

    /// The mesh, with the counts of its report filled in.
    pub(crate) fn finish(self) -> RawMesh {
        let mut mesh = self.mesh;
        mesh.report.triangles = mesh.triangles.len();
        mesh.report.vertices = mesh.vertices.len();
        mesh
    }
}

fn key([x, y, z]: [f32; 3]) -> Key {
    (u64::from(x.to_bits()) << 32 | u64::from(y.to_bits()), z.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_corners_share_a_vertex_in_the_order_of_first_use() {
        let mut welder = Welder::default();
        welder.add([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        welder.add([[0.0, 1.0, -0.0], [-0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        let mesh = welder.finish();
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(mesh.vertices[3], [0.0, 0.0, 1.0]);
        assert_eq!((mesh.report.triangles, mesh.report.vertices), (2, 4));
    }

    #[test]
    fn only_triangles_with_equal_corners_are_dropped() {
        let mut welder = Welder::default();
        welder.add([[9.0, 9.0, 9.0], [9.0, 9.0, 9.0], [5.0, 5.0, 5.0]]);
        welder.add([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [-0.0, 0.0, -0.0]]);
        welder.add([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        let mesh = welder.finish();
        assert_eq!((mesh.report.degenerate, mesh.triangles.len()), (2, 1));
        assert_eq!(mesh.vertices.len(), 3, "a dropped triangle leaves no vertex behind");
    }
}
