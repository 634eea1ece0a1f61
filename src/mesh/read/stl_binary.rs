//! Records -> RawMesh: reads the triangles of a binary STL, and no more than there are.
//!
//! A binary STL is a header of 80 bytes, the count of triangles in four (lowest byte first), and
//! a record of 50 bytes for each triangle. The count and the length of the file must agree: some
//! bytes more are counted and ignored, whole records more or any bytes fewer are refused.

use super::error::{Damaged, Place, ReadError, Truncated};
use super::limit::Limit;
use super::number::usable;
use super::weld::{Facet, Welder};
use crate::mesh::RawMesh;
use std::io::Read;
use std::ops::Range;

/// Bytes before the first triangle: a header of 80 and the count.
pub(super) const HEADER: usize = 84;

/// Bytes of a triangle: normal and three corners as `f32`, and two attribute bytes.
const RECORD: usize = 50;

/// Records that are read at a time: 200 KB, which stay in the processor's cache until they are
/// welded. Fewer make the two threads wait for each other more often.
const AT_ONCE: u64 = 4096;

type Result<T> = std::result::Result<T, ReadError>;

/// Length of a file with this many triangles.
fn length_of(triangles: u64) -> u64 {
    HEADER as u64 + RECORD as u64 * triangles
}

/// The count of triangles in a file's first [`HEADER`] bytes, as it stands there.
pub(super) fn count(head: &[u8]) -> Option<[u8; 4]> {
    head.get(HEADER - 4..HEADER).map(|count| [count[0], count[1], count[2], count[3]])
}

/// Whether a file is exactly as long as the count in its `head` asks for.
pub(super) fn has_length(head: &[u8], length: Option<u64>) -> bool {
    let announced = count(head).map(|count| u64::from(u32::from_le_bytes(count)));
    length.is_some() && announced.map(length_of) == length
}

/// Reads a binary STL with this `count`; `length` is the file's, where it is known.
///
/// # Errors
/// Triangles or bytes too many or too few, a number that is no coordinate, a source that fails.
pub(super) fn read(
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
        return Err(Damaged::NoneAnnounced { bytes: None }.into());
    }
    if announced > limit.triangles as u64 {
        let (announced, most) = (Some(announced), limit.triangles);
        return Err(ReadError::TooManyTriangles { announced, most });
    }
    from.take(HEADER as u64).read_to_end(&mut Vec::new())?;
    let mut mesh = records(from, announced)?;
    // Checked again by what was read: the length may be unknown, or have changed meanwhile.
    let after = std::io::copy(&mut from.take(limit.trailing() + 1), &mut std::io::sink())?;
    if after > limit.trailing() {
        return Err(Damaged::MoreBytes { announced, most: limit.trailing() }.into());
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
        return Err(Damaged::BigEndian.into());
    }
    if announced == 0 {
        let bytes = Some(length.saturating_sub(HEADER as u64));
        return Err(Damaged::NoneAnnounced { bytes }.into());
    }
    if surplus > 0 {
        return Err(Damaged::MoreTriangles { announced, more: surplus / RECORD as u64 }.into());
    }
    Err(cut_off(announced, length))
}

fn cut_off(announced: u64, bytes: u64) -> ReadError {
    let held = bytes.saturating_sub(HEADER as u64) / RECORD as u64;
    Truncated::Binary { announced, bytes, held }.into()
}

/// Reads this many records. One thread reads the next ones while another welds those before.
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
    let read = from.take(wanted).read_to_end(bytes)?;
    for (number, record) in numbers.zip(bytes.chunks_exact(RECORD)) {
        let [normal, corners @ ..] = vectors(record);
        if let Some(&wrong) = corners.as_flattened().iter().find(|number| !usable(**number)) {
            let place = Place::Triangle(number + 1);
            return Err(ReadError::Coordinate { place, number: wrong });
        }
        facets.push(Facet::new(normal, corners));
    }
    Ok(read as u64)
}

/// Normal and corners of a record of [`RECORD`] bytes.
fn vectors(record: &[u8]) -> [[f32; 3]; 4] {
    let mut vectors = [[0.0; 3]; 4];
    let (numbers, _) = record.as_chunks();
    for (number, bytes) in vectors.as_flattened_mut().iter_mut().zip(numbers) {
        *number = f32::from_le_bytes(*bytes);
    }
    vectors
}
