//! Triangles -> spikes: finds vertices that stick far out of their surroundings, as needles.

use crate::mesh::geometry::vector::minus;
use crate::units::UNITS_PER_MM;
use nalgebra::Vector3;

/// A spike is thinner than 10 degrees, the full angle of the cone around all its edges: its cosine. The
/// sharpest real tip of some 40 models has 44 degrees; a larger angle reports sharp design.
const COS_WIDEST: f64 = 0.984_807_753_012_208;

/// Cosine of half of that angle.
const COS_HALF: f64 = 0.996_194_698_091_745_5;

/// A spike is at least this long, mm: shorter ones vanish in a line of plastic. A smaller value
/// reports the noise of scans.
pub const SHORTEST_MM: f64 = 1.0;

/// A vertex that sticks out of its surroundings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spike {
    /// The vertex at its tip.
    pub vertex: u32,
    /// How far the tip is from the nearest of its neighbours, along the spike, mm.
    pub length_mm: f64,
}

/// Finds the tips of spikes, in the order of the vertices' numbers; vertices in grid units,
/// within ±10⁸.
///
/// A vertex is the tip of a spike if
/// - its triangles form one or more closed fans, with at least three neighbours,
/// - all its edges are within 5 degrees of their mean direction,
/// - along that direction all neighbours are at least [`SHORTEST_MM`] away.
///
/// Such vertices are errors of a scan or a modeller. A real tip is wider, or is rounded or cut off
/// and so has short edges. A real cone that is so thin, with a single vertex at its tip, is
/// reported too, and so is a pit: their numbers are the same. A spike of more than one vertex
/// is not found, nor one at an open edge.
///
/// Takes linear time and a byte for each vertex.
///
/// # Panics
/// If a triangle names a vertex that is not there.
#[must_use]
pub fn spikes(vertices: &[[i32; 3]], triangles: &[[u32; 3]]) -> Vec<Spike> {
    let pointed = pointed(vertices, triangles);
    // The triangles at each pointed vertex, with that vertex first.
    let mut fans: Vec<[u32; 3]> = Vec::new();
    for &[a, b, c] in triangles {
        let corners = [[a, b, c], [b, c, a], [c, a, b]];
        fans.extend(corners.iter().filter(|corner| pointed[corner[0] as usize]));
    }
    fans.sort_unstable();
    fans.chunk_by(|one, other| one[0] == other[0]).filter_map(|fan| spike(vertices, fan)).collect()
}

/// For each vertex whether all triangles at it have a corner there as a spike has.
fn pointed(vertices: &[[i32; 3]], triangles: &[[u32; 3]]) -> Vec<bool> {
    let mut pointed = vec![true; vertices.len()];
    for &[a, b, c] in triangles {
        for [tip, one, other] in [[a, b, c], [b, c, a], [c, a, b]] {
            let [one, other] = [one, other].map(|to| edge(vertices, tip, to));
            let (u, v) = (one.norm(), other.norm());
            let fits =
                u.min(v) >= SHORTEST_MM * UNITS_PER_MM && one.dot(&other) >= COS_WIDEST * (u * v);
            pointed[tip as usize] &= fits;
        }
    }
    pointed
}

/// The spike at the first vertex of all triangles of the `fan`, if it is one.
fn spike(vertices: &[[i32; 3]], fan: &[[u32; 3]]) -> Option<Spike> {
    let tip = fan.first()?[0];
    let mut neighbours: Vec<u32> = fan.iter().flat_map(|&[_, a, b]| [a, b]).collect();
    neighbours.sort_unstable();
    // Two triangles at each edge.
    if neighbours.chunk_by(|a, b| a == b).any(|same| same.len() != 2) {
        return None;
    }
    neighbours.dedup();
    let edges: Vec<Vector3<f64>> = neighbours.iter().map(|&to| edge(vertices, tip, to)).collect();
    let along = edges.iter().fold(Vector3::zeros(), |sum, edge| sum + edge / edge.norm());
    let along = along / along.norm();
    let thin = edges.iter().all(|edge| edge.dot(&along) >= COS_HALF * edge.norm());
    let nearest = edges.iter().map(|edge| edge.dot(&along)).fold(f64::INFINITY, f64::min);
    let length_mm = nearest / UNITS_PER_MM;
    (edges.len() >= 3 && thin && length_mm >= SHORTEST_MM)
        .then_some(Spike { vertex: tip, length_mm })
}

#[expect(clippy::cast_precision_loss, reason = "differences are below 2^28")]
fn edge(vertices: &[[i32; 3]], from: u32, to: u32) -> Vector3<f64> {
    Vector3::from(minus(vertices[to as usize], vertices[from as usize]).map(|part| part as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A pyramid over a square of 2·`half`, `height` high, its tip first.
    fn pyramid(half: i32, height: i32) -> (Vec<[i32; 3]>, Vec<[u32; 3]>) {
        let h = half;
        let vertices = vec![[0, 0, height], [h, h, 0], [-h, h, 0], [-h, -h, 0], [h, -h, 0]];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [1, 3, 2], [1, 4, 3]];
        (vertices, triangles)
    }

    fn lengths(half: i32, height: i32) -> Vec<(u32, f64)> {
        let (vertices, triangles) = pyramid(half, height);
        spikes(&vertices, &triangles).iter().map(|s| (s.vertex, s.length_mm)).collect()
    }

    #[test]
    fn the_cosines_are_those_of_one_angle() {
        assert!((COS_WIDEST.acos().to_degrees() - 10.0).abs() < 1e-9);
        assert!((COS_HALF.acos().to_degrees() - 5.0).abs() < 1e-9);
    }

    #[test]
    fn a_spike_is_thin_and_long() {
        // The edges are at 4.94°, 5.05° and 45° from the axis, half · √2 out.
        assert_eq!(lengths(1222, 20_000), [(0, 2.0)]);
        assert_eq!(lengths(1250, 20_000), []);
        assert_eq!(lengths(14_142, 20_000), []);
        assert_eq!(lengths(600, 10_000), [(0, 1.0)]);
        assert_eq!(lengths(600, 9999), []);
        // A pit is one too.
        assert_eq!(lengths(1222, -20_000), [(0, 2.0)]);
        assert_eq!(lengths(100_000, 100_000_000).len(), 1);
        assert!(spikes(&[], &[]).is_empty());
    }

    #[test]
    fn fins_and_open_fans_are_none() {
        let (vertices, mut triangles) = pyramid(1000, 20_000);
        let sheet = [[0, 1, 2], [0, 2, 1]];
        assert_eq!(spikes(&vertices, &sheet), []);
        triangles.remove(2);
        assert_eq!(spikes(&vertices, &triangles), []);
        let (mut vertices, mut triangles) = pyramid(1000, 20_000);
        // One edge that leads elsewhere.
        vertices[3] = [-30_000, -1000, 20_000];
        assert_eq!(spikes(&vertices, &triangles), []);
        (vertices, _) = pyramid(1000, 20_000);
        triangles[0] = [0, 1, 1];
        assert_eq!(spikes(&vertices, &triangles), []);
    }

    proptest! {
        #[test]
        fn a_thrown_vertex_of_a_field_is_found_whatever_the_order(
            at in 0_u32..81,
            thrown in 5_i32..200,
            start in 0_usize..128,
        ) {
            // 9 × 9 vertices 0.3 mm apart, one of them thrown up by 0.5 to 20 mm.
            let mut vertices: Vec<_> = (0..81).map(|k| [k % 9 * 3000, k / 9 * 3000, 0]).collect();
            vertices[at as usize][2] = thrown * 1000;
            let squares = (0..64).map(|k| k / 8 * 9 + k % 8);
            let mut triangles: Vec<_> =
                squares.flat_map(|k| [[k, k + 1, k + 9], [k + 1, k + 10, k + 9]]).collect();
            triangles.rotate_left(start);
            let found: Vec<u32> = spikes(&vertices, &triangles).iter().map(|s| s.vertex).collect();
            let inside = (1..8).contains(&(at % 9)) && (1..8).contains(&(at / 9));
            // The farther neighbours are 0.424 mm away: 5° at 4.85 mm; the mean is a little aside.
            prop_assert!(thrown > 46 || found.is_empty());
            let expected = if inside { vec![at] } else { vec![] };
            prop_assert!(thrown < 54 || found == expected);
        }
    }
}
