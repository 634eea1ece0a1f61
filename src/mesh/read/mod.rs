//! Bytes -> RawMesh: reads a model from a file, from standard input or from memory, or says why it is none.
//!
//! Each format has a file of its own here, with a function `read` that takes a reader and
//! returns a [`RawMesh`]; `sniff` recognizes formats by their first bytes, and [`from_reader`]'s
//! `read_any` below is the one place that chooses. To add a format, add its file, let `sniff` recognize it,
//! and call it in `read_any`.
//!
//! The head of a file is its first 64 KiB. A file is, in this order:
//! 1. a binary STL, if its length is the one that the count of triangles in its head asks for,
//!    whatever its header says (many binary files begin with `solid`);
//! 2. refused, if its head is that of another known format;
//! 3. an ASCII STL, if a line of its head begins with `solid`;
//! 4. refused, if its head is other text;
//! 5. else a binary STL with bytes too many or too few, which its reader judges.
//!
//! Both STL readers pass their triangles to `weld`, which joins equal corners. Memory is only taken
//! for triangles that the bytes really hold, and no source is read further than `limit` says.

mod error;
mod limit;
mod number;
mod sniff;
mod stl_ascii;
mod stl_binary;
mod weld;

use crate::mesh::edges::MAX_TRIANGLES;
use crate::mesh::{Error, RawMesh, Result};
use crate::text;
use limit::Limit;
use std::fs::File;
use std::io::Read;
use std::path::Path;

pub use error::{Damaged, NotStl, Place, ReadError, Truncated};
pub use number::MAX_NUMBER;

/// Bytes before the first triangle of a binary STL: a header of 80 and the count.
pub const HEADER: usize = stl_binary::HEADER;

/// Most triangles of a file, and of all models together, unless `--max-triangles` says another
/// number. Slicing so many takes some 2 GB; a larger default would let a damaged file fill the
/// memory of a small computer.
pub const DEFAULT_MAX_TRIANGLES: usize = 20_000_000;

/// Bytes of a file's start that tell its format.
const HEAD: u64 = 1 << 16;

/// Reads the model at `path`, or from standard input if `path` is `-`. Pipes and devices are
/// read no further than `max_triangles` can need.
///
/// # Errors
/// [`Error::Read`] if it cannot be read or is no usable STL; see [`from_bytes`].
pub fn from_path(path: impl AsRef<Path>, max_triangles: usize) -> Result<RawMesh> {
    let path = path.as_ref();
    if path.as_os_str() == "-" {
        return from_reader("<stdin>", &mut std::io::stdin(), max_triangles);
    }
    if path.as_os_str().is_empty() {
        return Err(refused("''")(ReadError::NoName));
    }
    let name = text::name(path);
    let (mut file, length) = open(path).map_err(refused(&name))?;
    read(&name, &mut file, length, max_triangles)
}

/// Reads a model that is in memory; `name` stands in messages and in the report.
///
/// The order of a triangle's corners says which side is outside. Stored normals that contradict
/// it are only counted. A count of triangles is not believed before the bytes bear it out.
///
/// # Errors
/// [`Error::Read`] if the bytes are no STL, are cut off, hold no triangle with three different
/// corners, hold more than `max_triangles`, or a coordinate that is not finite or larger than
/// [`MAX_NUMBER`].
pub fn from_bytes(name: &str, mut bytes: &[u8], max_triangles: usize) -> Result<RawMesh> {
    let length = Some(bytes.len() as u64);
    read(&text::line(name), &mut bytes, length, max_triangles)
}

/// Reads a model from any source, such as a pipe, whose length is not known.
///
/// # Errors
/// As [`from_bytes`], and if the source fails.
pub fn from_reader(
    name: &str,
    from: &mut (dyn Read + Send),
    max_triangles: usize,
) -> Result<RawMesh> {
    read(name, from, None, max_triangles)
}

/// Whether a file of `length` bytes seems to be an STL, going by `head`, its first [`HEADER`] bytes.
#[must_use]
pub fn looks_like_stl(head: &[u8], length: u64) -> bool {
    stl_binary::has_length(head, Some(length)) || head.trim_ascii_start().starts_with(b"solid")
}

/// Opens a file; its length too, if it is a regular one.
fn open(path: &Path) -> std::result::Result<(File, Option<u64>), ReadError> {
    let file = File::open(path)?;
    let data = file.metadata()?;
    if data.is_dir() {
        return Err(ReadError::Directory);
    }
    Ok((file, data.is_file().then_some(data.len())))
}

/// Adds the name of the file to what is wrong with it.
fn refused(name: &str) -> impl Fn(ReadError) -> Error + '_ {
    |source| Error::Read { file: name.to_owned(), source }
}

fn read(
    name: &str,
    from: &mut (dyn Read + Send),
    length: Option<u64>,
    max_triangles: usize,
) -> Result<RawMesh> {
    let limit = Limit { triangles: max_triangles.min(MAX_TRIANGLES) };
    let mut mesh = read_any(from, length, limit).map_err(refused(name))?;
    if mesh.triangles.is_empty() {
        return Err(refused(name)(match mesh.degenerate {
            0 => ReadError::NoTriangles,
            triangles => ReadError::OnlyDegenerate { triangles },
        }));
    }
    name.clone_into(&mut mesh.report.file);
    Ok(mesh)
}

/// Recognizes the format of a file by its head, and reads it.
fn read_any(
    from: &mut (dyn Read + Send),
    length: Option<u64>,
    limit: Limit,
) -> std::result::Result<RawMesh, ReadError> {
    let mut head = Vec::new();
    from.take(HEAD).read_to_end(&mut head)?;
    // What was read counts more than what the system says.
    let length = if (head.len() as u64) < HEAD { Some(head.len() as u64) } else { length };
    let length = length.filter(|&length| length >= head.len() as u64);
    if head.is_empty() {
        return Err(ReadError::Empty);
    }
    let is_binary = stl_binary::has_length(&head, length);
    if !is_binary {
        if let Some(what) = sniff::foreign(&head) {
            return Err(NotStl::Foreign(what).into());
        }
        if let Some(bytes) = length.filter(|&length| length > limit.bytes()) {
            return Err(ReadError::TooManyBytes { bytes, most: limit.triangles });
        }
        if let Some(start) = sniff::ascii_start(&head) {
            return stl_ascii::read(&mut head.as_slice().chain(from), start, limit);
        }
        if sniff::is_text(&head) {
            return Err(NotStl::Text(sniff::first_line(&head)).into());
        }
    }
    let count = stl_binary::count(&head).ok_or(NotStl::TooShort { bytes: head.len() })?;
    stl_binary::read(&mut head.as_slice().chain(from), count, length, limit)
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
        let text = from_bytes("x.stl", bytes, 9).expect_err("must be refused").to_string();
        assert!(text.starts_with("x.stl: ") && !text.contains('\n'), "{text}");
        text
    }

    #[test]
    fn binary_is_told_by_its_length() {
        for header in [&b""[..], b"solid", b"solid x\nfacet normal 0 0 0\nendfacet"] {
            let mesh = from_bytes("x.stl", &tetrahedron(header), 9).unwrap();
            assert_eq!((mesh.triangles.len(), mesh.vertices.len()), (4, 4));
            assert_eq!((mesh.report.format, mesh.report.file.as_str()), ("binary", "x.stl"));
        }
    }

    #[test]
    fn trailing_bytes_are_counted() {
        for header in [&b""[..], b"solid facet normal endfacet"] {
            let mut bytes = tetrahedron(header);
            bytes.extend([0; 99]);
            let mesh = from_bytes("x.stl", &bytes, 9).unwrap();
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
        let error = from_path("/nowhere/x.stl", 9).expect_err("there is no such file");
        assert!(error.to_string().starts_with("/nowhere/x.stl: cannot be read"));
        assert!(!error.is_usage());
        let Error::Read { source: ReadError::Io(cause), .. } = &error else { panic!("{error:?}") };
        assert_eq!(cause.kind(), std::io::ErrorKind::NotFound);
    }

    #[test]
    fn a_program_can_match_on_what_is_wrong() {
        let cause = |bytes: &[u8]| match from_bytes("x.stl", bytes, 9) {
            Err(Error::Read { file, source }) if file == "x.stl" => source,
            other => panic!("{other:?}"),
        };
        let good = tetrahedron(b"");
        let cut = Truncated::Binary { announced: 4, bytes: 283, held: 3 };
        assert!(matches!(cause(&good[..283]), ReadError::Truncated(why) if why == cut));
        let text = b"solid\nfacet normal 0 0 1\nouter loop\n";
        let cut = Truncated::Text { line: 4 };
        assert!(matches!(cause(text), ReadError::Truncated(why) if why == cut));
        assert!(matches!(cause(b"PK\x03\x04"), ReadError::NotStl(NotStl::Foreign(_))));
        assert!(matches!(cause(b""), ReadError::Empty));
        let mut many = good.clone();
        many[80] = 10;
        many.resize(HEADER + 10 * RECORD, 0);
        let most = |bytes: &[u8]| match cause(bytes) {
            ReadError::TooManyTriangles { announced, most } => (announced, most),
            other => panic!("{other:?}"),
        };
        assert_eq!(most(&many), (Some(10), 9));
        let mut wrong = good;
        wrong[HEADER + 12..HEADER + 16].copy_from_slice(&f32::NAN.to_le_bytes());
        let (place, number) = match cause(&wrong) {
            ReadError::Coordinate { place, number } => (place, number),
            other => panic!("{other:?}"),
        };
        assert!(place == Place::Triangle(1) && number.is_nan());
    }

    #[test]
    fn a_source_of_unknown_length_gives_what_its_bytes_give() {
        for bytes in [tetrahedron(b""), tetrahedron(b"solid")[..270].to_vec(), b"solid".to_vec()] {
            let whole = from_bytes("x.stl", &bytes, 9);
            let stream = from_reader("x.stl", &mut bytes.as_slice(), 9);
            match (whole, stream) {
                (Ok(whole), Ok(stream)) => assert_eq!(whole.report, stream.report),
                (whole, stream) => assert_eq!(
                    whole.expect_err("refused alike").to_string(),
                    stream.expect_err("refused alike").to_string()
                ),
            }
        }
    }
}
