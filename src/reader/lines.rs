//! Bytes -> lines without their ends, and where each ends; an endless line is cut short.

use std::io::{self, BufRead};

/// Bytes of a line that are read: far more than any printer takes, and little memory.
const LONGEST: usize = 1 << 16;

/// Where a line ends and the next begins: reading may go on here.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Place {
    /// Bytes before it.
    pub(super) offset: u64,
    /// Whether the last of them is a `\r`: a `\n` that follows is of the same end.
    after_return: bool,
}

/// Hands each line to `sink`, with the place where it ends. `\n`, `\r\n` and `\r` end one. `from` is
/// where `source` begins. Returns where it ends.
///
/// # Errors
/// What reading gives.
pub(super) fn each(
    source: &mut dyn BufRead,
    from: Place,
    sink: &mut dyn FnMut(&[u8], Place),
) -> io::Result<Place> {
    // The beginning of a line whose end has not come yet.
    let mut begun: Vec<u8> = Vec::new();
    let Place { mut offset, mut after_return } = from;
    loop {
        let bytes = match source.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            other => other?,
        };
        if bytes.is_empty() {
            break;
        }
        let mut rest = bytes;
        while let Some(end) = memchr::memchr2(b'\n', b'\r', rest) {
            // `\r\n` is one end: nothing lies between the two.
            let halves = after_return && end == 0 && rest[0] == b'\n' && begun.is_empty();
            offset += end as u64 + 1;
            after_return = rest[end] == b'\r';
            if !halves {
                let line = whole(&mut begun, &rest[..end]);
                sink(line, Place { offset, after_return });
                begun.clear();
            }
            rest = &rest[end + 1..];
        }
        if !rest.is_empty() {
            after_return = false;
            offset += rest.len() as u64;
            let room = LONGEST - begun.len().min(LONGEST);
            begun.extend_from_slice(&rest[..rest.len().min(room)]);
        }
        let count = bytes.len();
        source.consume(count);
    }
    let end = Place { offset, after_return };
    if !begun.is_empty() {
        sink(&begun, end);
    }
    Ok(end)
}

/// A line of which a part may have come before.
fn whole<'a>(begun: &'a mut Vec<u8>, end: &'a [u8]) -> &'a [u8] {
    if begun.is_empty() {
        return &end[..end.len().min(LONGEST)];
    }
    let room = LONGEST - begun.len().min(LONGEST);
    begun.extend_from_slice(&end[..end.len().min(room)]);
    begun
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    fn lines(bytes: &[u8], buffer: usize) -> Vec<Vec<u8>> {
        let mut found = Vec::new();
        let mut source = BufReader::with_capacity(buffer, bytes);
        each(&mut source, Place::default(), &mut |line, _| found.push(line.to_vec())).unwrap();
        found
    }

    #[test]
    fn reading_goes_on_at_the_end_of_any_line() {
        let bytes = b"a\nbc\r\nd\re\n\nf\r\n";
        let mut all: Vec<(Vec<u8>, Place)> = Vec::new();
        let mut keep = |line: &[u8], place| all.push((line.to_vec(), place));
        each(&mut &bytes[..], Place::default(), &mut keep).unwrap();
        for (k, (_, place)) in all.iter().enumerate() {
            let mut rest = Vec::new();
            let mut source = &bytes[place.offset as usize..];
            let mut keep = |line: &[u8], place| rest.push((line.to_vec(), place));
            each(&mut source, *place, &mut keep).unwrap();
            assert_eq!(rest, all[k + 1..], "{k}");
        }
    }

    #[test]
    fn all_kinds_of_ends_and_any_buffer() {
        for buffer in 1..9 {
            assert_eq!(
                lines(b"a\nbc\r\nd\re\n\nf", buffer),
                [&b"a"[..], b"bc", b"d", b"e", b"", b"f"]
            );
        }
    }

    #[test]
    fn a_line_without_end_does_not_fill_the_memory() {
        let long = vec![b'x'; 3 * LONGEST];
        for buffer in [100, 1 << 20] {
            let found = lines(&[&long[..], b"\nG1"].concat(), buffer);
            assert_eq!(found.len(), 2);
            assert_eq!(found[0].len(), LONGEST);
        }
    }
}
