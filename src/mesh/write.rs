//! Triangles -> bytes: writes a mesh as binary STL.

use std::io::{self, Write};

/// The header, filled up with blanks. It must not begin with `solid`.
const TITLE: &[u8] = b"binary STL";

/// Writes `triangles` over `vertices` to `out` as binary STL: the same bytes for the same mesh.
///
/// Numbers are written as they are. A normal is that of the winding, of length 1, or 0 for a
/// triangle without area.
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
    let from_a =
        |p: [f32; 3]| -> [f64; 3] { std::array::from_fn(|i| f64::from(p[i]) - f64::from(a[i])) };
    let (u, v) = (from_a(b), from_a(c));
    let across: [f64; 3] = std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        u[j] * v[k] - u[k] * v[j]
    });
    let length = across.iter().map(|side| side * side).sum::<f64>().sqrt();
    if length > 0.0 { across.map(|side| (side / length) as f32) } else { [0.0; 3] }
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
        let read = read::parse("x", &bytes, 9).unwrap();
        assert_eq!((read.triangles.len(), read.wrong_normals), (4, 0));
        let corner = |t: usize, k: usize| read.vertices[read.triangles[t][k] as usize];
        for (t, triangle) in triangles.iter().enumerate() {
            assert_eq!([0, 1, 2].map(|k| corner(t, k)), triangle.map(|v| vertices[v as usize]));
        }
    }
}
