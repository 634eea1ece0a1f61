//! Triangles -> bytes: writes a mesh as binary STL.

use nalgebra::Vector3;
use std::io::{self, Write};

/// The header, padded with blanks. It must not begin with `solid`: readers take that for text.
const TITLE: &[u8] = b"binary STL";

/// Writes `triangles` over `vertices` to `out` as binary STL: the same bytes for the same mesh.
///
/// Coordinates are written unchanged. Normals follow the order of the corners and have length 1,
/// or 0 for a triangle without area.
///
/// # Errors
/// Those of `out`, and [`io::ErrorKind::InvalidInput`] for more triangles than STL can count.
///
/// # Panics
/// If a triangle names a vertex that is not there.
pub fn write(out: &mut dyn Write, vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> io::Result<()> {
    let mut header = [b' '; 80];
    header[..TITLE.len()].copy_from_slice(TITLE);
    out.write_all(&header)?;
    let count = u32::try_from(triangles.len()).map_err(|_| io::ErrorKind::InvalidInput)?;
    out.write_all(&count.to_le_bytes())?;
    for triangle in triangles {
        let corners = triangle.map(|vertex| vertices[vertex as usize]);
        let mut record = [0; 50];
        let numbers = [normal(corners), corners[0], corners[1], corners[2]];
        for (place, number) in record.chunks_exact_mut(4).zip(numbers.as_flattened()) {
            place.copy_from_slice(&number.to_le_bytes());
        }
        out.write_all(&record)?;
    }
    Ok(())
}

#[expect(clippy::cast_possible_truncation, reason = "a number of at most 1")]
fn normal([a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let from_a = |to: [f32; 3]| Vector3::from(to.map(f64::from)) - Vector3::from(a.map(f64::from));
    let across = from_a(b).cross(&from_a(c));
    let length = across.norm();
    if length > 0.0 { across.map(|side| (side / length) as f32).into() } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::read;

    #[test]
    fn what_is_written_is_read_again() {
        let vertices = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 1e-30, 0.0], [0.0, 0.0, -9.25]];
        let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let mut bytes = Vec::new();
        write(&mut bytes, &vertices, &triangles).unwrap();
        let read = read::from_bytes("x", &bytes, 9).unwrap();
        assert_eq!((read.triangles.len(), read.wrong_normals), (4, 0));
        for (read_back, triangle) in read.triangles.iter().zip(triangles) {
            let corners = read_back.map(|v| read.vertices[v as usize]);
            assert_eq!(corners, triangle.map(|v| vertices[v as usize]));
        }
    }
}
