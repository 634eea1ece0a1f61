//! Mesh -> volume: measures a placed mesh in integers, so that the order of triangles does not matter.

use super::Mesh;
use crate::units::UNITS_PER_MM;

/// Whether any triangle has area.
pub(crate) fn has_area(mesh: &Mesh) -> bool {
    mesh.triangles.iter().any(|corners| {
        let [a, b, c] = corners.map(|corner| mesh.vertices[corner as usize].map(i64::from));
        let (u, v) = (minus(b, a), minus(c, a));
        cross(u, v) != [0; 3]
    })
}

/// The vector from `b` to `a`.
pub(super) fn minus(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

/// The cross product; of differences of coordinates it fits.
pub(super) fn cross(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The signed volume: a sixth of the sum of the triangles' determinants, in
/// integers, so that no order of the triangles changes it.
#[expect(clippy::cast_precision_loss, reason = "rounded once, at the end")]
pub(crate) fn volume_mm3(mesh: &Mesh) -> f64 {
    let determinant = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| mesh.vertices[corner as usize].map(i64::from));
        let normal = cross(b, c);
        (0..3).map(|axis| i128::from(a[axis]) * i128::from(normal[axis])).sum::<i128>()
    };
    let sum: i128 = mesh.triangles.iter().map(determinant).sum();
    sum as f64 / (6.0 * UNITS_PER_MM.powi(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[i32; 3]; 4] = [
        [1000, 1000, 0],
        [100_001_000, 1000, 0],
        [1000, 100_001_000, 0],
        [1000, 1000, 100_000_000],
    ];

    #[test]
    fn the_largest_tetrahedron_is_measured_exactly() {
        let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let mut mesh = Mesh { vertices: CORNERS.to_vec(), triangles };
        assert_eq!(volume_mm3(&mesh), 1e12 / 6.0);
        mesh.triangles.iter_mut().for_each(|corners| corners.reverse());
        assert_eq!(volume_mm3(&mesh), -1e12 / 6.0);
    }

    #[test]
    fn a_line_has_no_area() {
        let vertices = vec![[0, 0, 0], [1, 2, 3], [2, 4, 6], [2, 4, 7]];
        let mut mesh = Mesh { vertices, triangles: vec![[0, 1, 2]] };
        assert!(!has_area(&mesh));
        mesh.triangles.push([0, 1, 3]);
        assert!(has_area(&mesh));
    }
}
