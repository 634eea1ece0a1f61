//! Mesh -> volume: measures a mesh in integers, so that the order of triangles does not matter.

use super::vector::{Corner, cross, dot, minus, normal};
use crate::mesh::Mesh;
use crate::units::UNITS_PER_MM;
use rayon::prelude::*;

/// Whether any triangle has area.
pub(crate) fn has_area(mesh: &Mesh) -> bool {
    mesh.triangles.iter().any(|&corners| normal(corners_of(&mesh.vertices, corners)) != [0; 3])
}

/// The corners of a triangle.
pub(crate) fn corners_of(vertices: &[Corner], triangle: [u32; 3]) -> [Corner; 3] {
    triangle.map(|corner| vertices[corner as usize])
}

/// The signed volume: a sixth of the sum of the triangles' determinants.
pub(crate) fn volume_mm3(mesh: &Mesh) -> f64 {
    of_determinants(determinants(&mesh.vertices, &mesh.triangles))
}

/// The sum of the triangles' [`determinant`]s.
pub(crate) fn determinants(vertices: &[Corner], triangles: &[[u32; 3]]) -> i128 {
    triangles.par_iter().map(|&t| determinant(corners_of(vertices, t))).sum()
}

/// Six times the signed volume of the tetrahedron from the origin to a triangle; exact.
pub(crate) fn determinant([a, b, c]: [Corner; 3]) -> i128 {
    let from_origin = |corner| minus(corner, [0; 3]);
    dot(from_origin(a), cross(from_origin(b), from_origin(c)))
}

/// The volume that a sum of [`determinant`]s stands for, mm³.
#[expect(clippy::cast_precision_loss, reason = "rounded once, at the end")]
pub(crate) fn of_determinants(sum: i128) -> f64 {
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
