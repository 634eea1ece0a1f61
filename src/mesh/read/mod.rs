//! Bytes -> RawMesh: reads binary and ASCII STL and says what is wrong with the rest.

mod limit;
mod number;
mod sniff;
mod stl_ascii;
mod stl_binary;
mod weld;

use crate::error::{Error, Result};
use crate::mesh::RawMesh;
use limit::{Limit, unreadable};
use std::fs::File;
use std::io::Read;

pub use number::MAX_NUMBER;
pub(crate) use weld::MAX_TRIANGLES;

/// Bytes before the first triangle of a binary file: a header of 80 and the count.
pub const HEADER: usize = stl_binary::HEADER;

/// Most triangles of a file and of a layout unless `--max-triangles` says another number: slicing
/// them takes some 2 GB.
pub const DEFAULT_MAX_TRIANGLES: usize = 20_000_000;

/// Bytes of a file's start that tell what it is.
const HEAD: u64 = 1 << 16;

/// Reads the STL file at `path`, or standard input if `path` is `-`. Pipes and devices
/// are read no further than `max_triangles` can need.
///
/// # Errors
/// [`Error::Input`] if it cannot be read or is no usable STL; see [`parse`].
pub fn load(path: &str, max_triangles: usize) -> Result<RawMesh> {
    if path == "-" {
        return read("<stdin>", &mut std::io::stdin(), None, max_triangles);
    }
    let mut file = File::open(path).map_err(|error| match error.kind() {
        _ if path.is_empty() => Error::input("''", "is no file name; name a model"),
        _ => Error::input(path, unreadable(&error)),
    })?;
    let data = file.metadata().map_err(|error| Error::input(path, unreadable(&error)))?;
    if data.is_dir() {
        return Err(Error::input(path, "is a directory; name a file in it"));
    }
    let length = data.is_file().then_some(data.len());
    read(path, &mut file, length, max_triangles)
}

/// Whether a file of `length` bytes that begins with `head`, its first [`HEADER`] bytes, seems
/// to be an STL.
#[must_use]
pub fn seems(head: &[u8], length: u64) -> bool {
    is_binary(head, Some(length)) || head.trim_ascii_start().starts_with(b"solid")
}

/// Reads an STL file's `bytes`; `name` stands in messages and in the report.
///
/// A file is binary when its length is the one that its count asks for,
/// whatever its header says. The winding of the corners says what is outside;
/// stored normals that say otherwise are only counted. Nothing is allocated by
/// a count that the bytes do not bear out.
///
/// # Errors
/// [`Error::Input`] with the place, the cause and what to do, if the bytes are
/// no STL, are cut off, hold no triangle with area, hold more than `max_triangles`, or a coordinate that
/// is not finite or larger than [`MAX_NUMBER`].
pub fn parse(name: &str, mut bytes: &[u8], max_triangles: usize) -> Result<RawMesh> {
    let length = Some(bytes.len() as u64);
    read(name, &mut bytes, length, max_triangles)
}

/// As [`parse`], of a source whose length may not be known.
fn read(
    name: &str,
    from: &mut (dyn Read + Send),
    length: Option<u64>,
    max_triangles: usize,
) -> Result<RawMesh> {
    let limit = Limit { triangles: max_triangles.min(MAX_TRIANGLES) };
    let mut mesh = read_any(from, length, limit).map_err(|reason| Error::input(name, reason))?;
    if mesh.triangles.is_empty() {
        let dropped = mesh.degenerate;
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

/// Tells by its head what a file is, and reads it.
fn read_any(
    from: &mut (dyn Read + Send),
    length: Option<u64>,
    limit: Limit,
) -> std::result::Result<RawMesh, String> {
    let mut head = Vec::new();
    from.take(HEAD).read_to_end(&mut head).map_err(|error| unreadable(&error))?;
    // What was read says more than what the system tells.
    let length = if (head.len() as u64) < HEAD { Some(head.len() as u64) } else { length };
    let length = length.filter(|&length| length >= head.len() as u64);
    if head.is_empty() {
        return Err("is empty; export the model again".to_owned());
    }
    let count = stl_binary::count(&head);
    let is_binary = is_binary(&head, length);
    if let Some(what) = sniff::foreign(&head).filter(|_| !is_binary) {
        return Err(format!("is no STL but seems to be {what}"));
    }
    if let Some(length) = length.filter(|&length| !is_binary && length > limit.bytes()) {
        return Err(format!(
            "has {length} bytes, more than the {} triangles that are allowed can need; simplify \
             the model or raise --max-triangles",
            limit.triangles
        ));
    }
    let start = sniff::ascii_start(&head).filter(|_| !is_binary);
    let mut from = head.as_slice().chain(from);
    match (start, count) {
        (Some(start), _) => stl_ascii::read(&mut from, start, limit),
        (None, _) if !is_binary && sniff::is_text(&head) => Err(other_text(&head)),
        (None, Some(count)) => stl_binary::read(&mut from, count, length, limit),
        (None, None) => Err(format!(
            "has only {} bytes, too few for an STL; export or download it again",
            head.len()
        )),
    }
}

/// Whether a file is as long as the count in its `head` says.
fn is_binary(head: &[u8], length: Option<u64>) -> bool {
    let announced = stl_binary::count(head).map(|count| u64::from(u32::from_le_bytes(count)));
    length.is_some() && announced.map(stl_binary::length_of) == length
}

/// Says what a text that is no STL begins with.
fn other_text(head: &[u8]) -> String {
    let line = head.trim_ascii_start().split(|&byte| byte == b'\n' || byte == b'\r').next();
    let quote = stl_ascii::quote(line.unwrap_or_default());
    format!("is no STL but text that begins with {quote}; export it as STL")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes of a triangle.
    const RECORD: usize = 50;
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
        let text = parse("x.stl", bytes, 9).expect_err("must be refused").to_string();
        assert!(text.starts_with("x.stl: ") && !text.contains('\n'), "{text}");
        text
    }

    #[test]
    fn binary_is_told_by_its_length() {
        for header in [&b""[..], b"solid", b"solid x\nfacet normal 0 0 0\nendfacet"] {
            let mesh = parse("x.stl", &tetrahedron(header), 9).unwrap();
            assert_eq!((mesh.triangles.len(), mesh.vertices.len()), (4, 4));
            assert_eq!((mesh.report.format, mesh.report.file.as_str()), ("binary", "x.stl"));
        }
    }

    #[test]
    fn trailing_bytes_are_counted() {
        for header in [&b""[..], b"solid facet normal endfacet"] {
            let mut bytes = tetrahedron(header);
            bytes.extend([0; 99]);
            let mesh = parse("x.stl", &bytes, 9).unwrap();
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
        let error = load("/nowhere/x.stl", 9).expect_err("there is no such file");
        assert!(error.to_string().starts_with("/nowhere/x.stl: cannot be read"));
        assert_eq!(error.exit_code(), 3);
    }
}
