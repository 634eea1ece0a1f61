//! Bytes -> RawMesh: reads binary and ASCII STL and says what is wrong with the rest.

use super::coordinate::{complaint, usable};
use super::weld::{MAX_TRIANGLES, Welder};
use super::{RawMesh, ascii, sniff};
use crate::error::{Error, Result};
use std::io::{ErrorKind, Read};

pub use super::coordinate::MAX_NUMBER;

/// Bytes before the first triangle of a binary file: a header of 80 and the count.
pub const HEADER: usize = 84;
/// Bytes of a triangle: normal and three corners as `f32`, and two attribute bytes.
const RECORD: usize = 50;

/// Reads the STL file at `path`, or standard input if `path` is `-`.
///
/// # Errors
/// [`Error::Input`] if it cannot be read or is no usable STL; see [`parse`].
pub fn load(path: &str) -> Result<RawMesh> {
    let (name, read) = if path == "-" {
        let mut bytes = Vec::new();
        let read = std::io::stdin().lock().read_to_end(&mut bytes);
        ("<stdin>", read.map(|_| bytes))
    } else {
        (path, std::fs::read(path))
    };
    let bytes = read.map_err(|error| match error.kind() {
        _ if path.is_empty() => Error::input("''", "is no file name; name a model"),
        ErrorKind::IsADirectory => Error::input(name, "is a directory; name a file in it"),
        _ => Error::input(
            name,
            format!("cannot be read: {error}; check the name and the permissions"),
        ),
    })?;
    parse(name, &bytes)
}

/// Whether a file of `length` bytes that begins with `head`, its first [`HEADER`] bytes, seems
/// to be an STL.
#[must_use]
pub fn seems(head: &[u8], length: u64) -> bool {
    let count = head.get(80..HEADER).map(|count| [count[0], count[1], count[2], count[3]]);
    let binary = count.map(|bytes| binary_length(u64::from(u32::from_le_bytes(bytes))));
    binary == Some(length) || head.trim_ascii_start().starts_with(b"solid")
}

/// Reads an STL file's `bytes`; `name` stands in messages and in the report.
///
/// A file is binary when its length is the one that its count asks for,
/// whatever its header says. Stored normals are ignored: the winding of the
/// corners says what is outside. Nothing is allocated by a count that the
/// length does not bear out.
///
/// # Errors
/// [`Error::Input`] with the place, the cause and what to do, if the bytes are
/// no STL, are cut off, hold no triangle with area, or hold a coordinate that
/// is not finite or larger than [`MAX_NUMBER`].
pub fn parse(name: &str, bytes: &[u8]) -> Result<RawMesh> {
    let mut mesh = parse_any(bytes).map_err(|reason| Error::input(name, reason))?;
    if mesh.triangles.is_empty() {
        let dropped = mesh.report.degenerate;
        let reason = if dropped == 0 {
            "holds no triangles; export the model again".to_owned()
        } else {
            format!("none of its {dropped} triangles has three different corners; export it again")
        };
        return Err(Error::input(name, reason));
    }
    name.clone_into(&mut mesh.report.file);
    Ok(mesh)
}

fn parse_any(bytes: &[u8]) -> std::result::Result<RawMesh, String> {
    if bytes.is_empty() {
        return Err("is empty; export the model again".to_owned());
    }
    let count = bytes.get(80..HEADER).map(|count| [count[0], count[1], count[2], count[3]]);
    let announced = count.map(|bytes| u64::from(u32::from_le_bytes(bytes)));
    let length = bytes.len() as u64;
    if announced.map(binary_length) == Some(length) {
        return binary(bytes, bytes.len());
    }
    if let Some(what) = sniff::foreign(bytes) {
        return Err(format!("is no STL but seems to be {what}"));
    }
    if let Some(start) = sniff::ascii_start(bytes) {
        return ascii::parse(bytes, start);
    }
    if sniff::is_text(bytes) {
        let line = bytes.trim_ascii_start().split(|&byte| byte == b'\n' || byte == b'\r').next();
        let quote = ascii::quote(line.unwrap_or_default());
        return Err(format!("is no STL but text that begins with {quote}; export it as STL"));
    }
    match (announced, count) {
        (Some(announced), Some(count)) => odd_binary(bytes, announced, count),
        _ => {
            Err(format!("has only {length} bytes, too few for an STL; export or download it again"))
        }
    }
}

/// Reads a binary file whose length is not what its `count` of `announced` triangles
/// makes: trailing bytes are left out, all else is an error.
fn odd_binary(
    bytes: &[u8],
    announced: u64,
    count: [u8; 4],
) -> std::result::Result<RawMesh, String> {
    let length = bytes.len() as u64;
    let surplus = length.saturating_sub(binary_length(announced));
    if announced > 0 && surplus > 0 && surplus.is_multiple_of(RECORD as u64) {
        // Whole triangles too many: which number is right nobody can tell.
        return Err(format!(
            "announces {announced} triangles, but {} more follow; it is damaged: export or \
             download it again",
            surplus / RECORD as u64
        ));
    }
    if announced > 0 && surplus > 0 {
        let end = usize::try_from(binary_length(announced)).unwrap_or(bytes.len());
        return binary(bytes, end);
    }
    let swapped = u64::from(u32::from_be_bytes(count));
    if binary_length(swapped) == length {
        return Err("is a big-endian binary STL; export it as a usual (little-endian) one".into());
    }
    if announced == 0 {
        return Err(format!(
            "announces 0 triangles, but {} more bytes follow; export it again",
            length - HEADER as u64
        ));
    }
    Err(format!(
        "announces {announced} triangles, but its {length} bytes hold only {}; it is cut off, \
         damaged or no STL: export or download it again",
        (length - HEADER as u64) / RECORD as u64
    ))
}

/// Length of a binary file with so many triangles.
fn binary_length(triangles: u64) -> u64 {
    HEADER as u64 + RECORD as u64 * triangles
}

/// Reads the records up to `end`; what comes after them is only counted.
fn binary(bytes: &[u8], end: usize) -> std::result::Result<RawMesh, String> {
    let records = &bytes[HEADER..end];
    let triangles = records.len() / RECORD;
    if triangles > MAX_TRIANGLES {
        return Err(format!("has more than {MAX_TRIANGLES} triangles; simplify the model"));
    }
    let mut welder = Welder::with_capacity(triangles);
    for (i, record) in records.chunks_exact(RECORD).enumerate() {
        let corners = corners(record);
        if let Some(number) = corners.as_flattened().iter().find(|number| !usable(**number)) {
            return Err(format!(
                "triangle {}: {}; mend or export the model again",
                i + 1,
                complaint(*number)
            ));
        }
        welder.add(corners);
    }
    let mut mesh = welder.finish();
    mesh.report.format = "binary";
    mesh.report.trailing_bytes = (bytes.len() - end) as u64;
    Ok(mesh)
}

/// The corners of a record of [`RECORD`] bytes.
fn corners(record: &[u8]) -> [[f32; 3]; 3] {
    let number = |at: usize| {
        f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]])
    };
    std::array::from_fn(|corner| std::array::from_fn(|axis| number(12 + corner * 12 + axis * 4)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 4] =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn tetrahedron(header: &[u8]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(4_u32.to_le_bytes());
        for face in FACES {
            bytes.extend(f32::NAN.to_le_bytes().repeat(3));
            for corner in face {
                bytes.extend(CORNERS[corner].iter().flat_map(|number| number.to_le_bytes()));
            }
            bytes.extend([1, 2]);
        }
        bytes
    }

    fn reason(bytes: &[u8]) -> String {
        let text = parse("x.stl", bytes).expect_err("must be refused").to_string();
        assert!(text.starts_with("x.stl: ") && !text.contains('\n'), "{text}");
        text
    }

    #[test]
    fn binary_is_told_by_its_length() {
        for header in [&b""[..], b"solid", b"solid x\nfacet normal 0 0 0\nendfacet"] {
            let mesh = parse("x.stl", &tetrahedron(header)).unwrap();
            assert_eq!((mesh.triangles.len(), mesh.vertices.len()), (4, 4));
            assert_eq!((mesh.report.format, mesh.report.file.as_str()), ("binary", "x.stl"));
        }
    }

    #[test]
    fn trailing_bytes_are_counted() {
        for header in [&b""[..], b"solid facet normal endfacet"] {
            let mut bytes = tetrahedron(header);
            bytes.extend([0; 99]);
            let mesh = parse("x.stl", &bytes).unwrap();
            assert_eq!((mesh.triangles.len(), mesh.report.trailing_bytes), (4, 99));
        }
    }

    #[test]
    fn a_wrong_count_is_named() {
        let mut bytes = tetrahedron(b"solid");
        bytes.truncate(bytes.len() - 1);
        assert!(reason(&bytes).contains("announces 4 triangles, but its 283 bytes hold only 3"));
        bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(reason(&bytes).contains("announces 4294967295"));
        bytes[80..84].copy_from_slice(&[0; 4]);
        assert!(reason(&bytes).contains("announces 0"));
        assert!(reason(&bytes[..50]).contains("no triangles"), "a header alone reads as text");
        assert!(reason(&[0; 50]).contains("only 50 bytes"));
        assert!(reason(&[0; 84]).contains("no triangles"));
        assert!(reason(&[]).contains("is empty"));
    }

    #[test]
    fn big_endian_is_named() {
        let mut bytes = tetrahedron(b"");
        bytes[80..84].reverse();
        assert!(reason(&bytes).contains("big-endian"));
    }

    #[test]
    fn numbers_that_are_no_coordinates_are_refused_with_their_triangle() {
        for (number, word) in [
            (f32::NAN, "no finite"),
            (f32::NEG_INFINITY, "no finite"),
            (3e38, "absurdly large"),
            (-3e38, "absurdly large"),
        ] {
            let mut bytes = tetrahedron(b"");
            let at = HEADER + RECORD + 12 + 4;
            bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
            let text = reason(&bytes);
            assert!(text.contains("triangle 2") && text.contains(word), "{text}");
        }
    }

    #[test]
    fn a_mesh_of_points_is_refused() {
        let mut bytes = tetrahedron(b"");
        bytes[HEADER..].fill(0);
        assert!(reason(&bytes).contains("none of its 4 triangles"));
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = load("/nowhere/x.stl").expect_err("there is no such file");
        assert!(error.to_string().starts_with("/nowhere/x.stl: cannot be read"));
        assert_eq!(error.exit_code(), 3);
    }
}
