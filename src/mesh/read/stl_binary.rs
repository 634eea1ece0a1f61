//! Records -> RawMesh: reads the triangles of a binary STL, and no more than there are.

use super::limit::{Limit, unreadable};
use super::number::{complaint, usable};
use super::weld::{Facet, Welder};
use crate::mesh::RawMesh;
use std::io::Read;
use std::ops::Range;

/// Bytes before the first triangle of a binary file: a header of 80 and the count.
pub(crate) const HEADER: usize = 84;

/// Bytes of a triangle: normal and three corners as `f32`, and two attribute bytes.
const RECORD: usize = 50;

/// Records that are read at once.
const AT_ONCE: u64 = 4096;

type Result<T> = std::result::Result<T, String>;

/// Length of a binary file with so many triangles.
pub(crate) fn length_of(triangles: u64) -> u64 {
    HEADER as u64 + RECORD as u64 * triangles
}

/// The count of triangles in a file's first [`HEADER`] bytes.
pub(crate) fn count(head: &[u8]) -> Option<[u8; 4]> {
    head.get(HEADER - 4..HEADER).map(|count| [count[0], count[1], count[2], count[3]])
}

/// Reads a binary STL with this `count`; `length` is the file's, where it is known. Trailing bytes are
/// left out, another length that is not what the count makes is an error.
///
/// # Errors
/// The triangle, the cause and what to do, as text without the file's name.
pub(crate) fn read(
    from: &mut (dyn Read + Send),
    count: [u8; 4],
    length: Option<u64>,
    limit: Limit,
) -> Result<RawMesh> {
    let announced = u64::from(u32::from_le_bytes(count));
    if let Some(length) = length {
        check_length(announced, count, length)?;
    }
    if announced == 0 && length.is_none() {
        return Err("announces 0 triangles, but more bytes follow; it is damaged or no STL: \
                    export it again"
            .to_owned());
    }
    if announced > limit.triangles as u64 {
        return Err(limit.exceeded(&format!("announces {announced}")));
    }
    from.take(HEADER as u64).read_to_end(&mut Vec::new()).map_err(|error| unreadable(&error))?;
    let mut mesh = records(from, announced)?;
    // Once more by what was read: the length may not be known, or have changed.
    let mut after = from.take(limit.trailing() + 1);
    let after =
        std::io::copy(&mut after, &mut std::io::sink()).map_err(|error| unreadable(&error))?;
    if after > limit.trailing() {
        return Err(format!(
            "announces {announced} triangles, but more than {} bytes follow after them; it is \
             damaged: export or download it again",
            limit.trailing()
        ));
    }
    check_length(announced, count, length_of(announced) + after)?;
    mesh.report.trailing_bytes = after;
    Ok(mesh)
}

/// Whether a file of this `length` can have the triangles that it `announced`.
fn check_length(announced: u64, count: [u8; 4], length: u64) -> Result<()> {
    let surplus = length.saturating_sub(length_of(announced));
    if length == length_of(announced) || (announced > 0 && !surplus.is_multiple_of(RECORD as u64)) {
        return Ok(());
    }
    if length_of(u64::from(u32::from_be_bytes(count))) == length {
        return Err("is a big-endian binary STL; export it as a usual (little-endian) one".into());
    }
    if announced == 0 {
        return Err(format!(
            "announces 0 triangles, but {} more bytes follow; export it again",
            length.saturating_sub(HEADER as u64)
        ));
    }
    if surplus > 0 {
        // Whole triangles too many: which number is right nobody can tell.
        return Err(format!(
            "announces {announced} triangles, but {} more follow; it is damaged: export or \
             download it again",
            surplus / RECORD as u64
        ));
    }
    Err(cut_off(announced, length))
}

fn cut_off(announced: u64, length: u64) -> String {
    format!(
        "announces {announced} triangles, but its {length} bytes hold only {}; it is cut off, \
         damaged or no STL: export or download it again",
        length.saturating_sub(HEADER as u64) / RECORD as u64
    )
}

/// Reads so many records: the next ones are read while those before are welded.
fn records(from: &mut (dyn Read + Send), announced: u64) -> Result<RawMesh> {
    let mut welder = Welder::with_capacity(usize::try_from(announced).unwrap_or(usize::MAX));
    let mut bytes = Vec::new();
    let (mut facets, mut next) = (Vec::new(), Vec::new());
    let mut first = 0;
    while first < announced {
        let count = (announced - first).min(AT_ONCE);
        let (read, ()) = rayon::join(
            || read_facets(from, &mut bytes, first..first + count, &mut next),
            || facets.iter().for_each(|facet| welder.add(facet)),
        );
        let read = read?;
        if read < count * RECORD as u64 {
            return Err(cut_off(announced, length_of(first) + read));
        }
        std::mem::swap(&mut facets, &mut next);
        first += count;
    }
    facets.iter().for_each(|facet| welder.add(facet));
    let mut mesh = welder.finish();
    mesh.report.format = "binary";
    Ok(mesh)
}

/// Reads the records with these numbers, counted from 0. Returns how many bytes there were.
fn read_facets(
    from: &mut dyn Read,
    bytes: &mut Vec<u8>,
    numbers: Range<u64>,
    facets: &mut Vec<Facet>,
) -> Result<u64> {
    bytes.clear();
    facets.clear();
    let wanted = (numbers.end - numbers.start) * RECORD as u64;
    let read = from.take(wanted).read_to_end(bytes).map_err(|error| unreadable(&error))?;
    for (number, record) in numbers.zip(bytes.chunks_exact(RECORD)) {
        let [normal, corners @ ..] = vectors(record);
        if let Some(wrong) = corners.as_flattened().iter().find(|number| !usable(**number)) {
            let (number, complaint) = (number + 1, complaint(*wrong));
            return Err(format!("triangle {number}: {complaint}; mend or export the model again"));
        }
        facets.push(Facet::new(normal, corners));
    }
    Ok(read as u64)
}

/// Normal and corners of a record of [`RECORD`] bytes.
fn vectors(record: &[u8]) -> [[f32; 3]; 4] {
    let number = |at: usize| {
        f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]])
    };
    std::array::from_fn(|vector| std::array::from_fn(|axis| number(vector * 12 + axis * 4)))
}
