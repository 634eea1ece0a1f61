//! Bytes -> lines without their ends; an endless line is cut short.

use std::io::{self, BufRead};

/// Bytes of a line that are read: far more than any printer takes, and little memory.
const LONGEST: usize = 1 << 16;

/// Hands each line to `sink`. `\n`, `\r\n` and `\r` end one.
///
/// # Errors
/// What reading gives.
pub(super) fn each(source: &mut dyn BufRead, sink: &mut dyn FnMut(&[u8])) -> io::Result<()> {
    // The beginning of a line whose end has not come yet.
    let mut begun: Vec<u8> = Vec::new();
    let mut after_return = false;
    loop {
        let bytes = match source.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            other => other?,
        };
        if bytes.is_empty() {
            break;
        }
        let mut rest = bytes;
        while let Some(end) = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r') {
            // `\r\n` is one end: nothing lies between the two.
            let halves = after_return && end == 0 && rest[0] == b'\n' && begun.is_empty();
            if !halves {
                hand_on(&mut begun, &rest[..end], sink);
            }
            after_return = rest[end] == b'\r';
            rest = &rest[end + 1..];
        }
        if !rest.is_empty() {
            after_return = false;
            let room = LONGEST - begun.len().min(LONGEST);
            begun.extend_from_slice(&rest[..rest.len().min(room)]);
        }
        let count = bytes.len();
        source.consume(count);
    }
    if !begun.is_empty() {
        sink(&begun);
    }
    Ok(())
}

fn hand_on(begun: &mut Vec<u8>, end: &[u8], sink: &mut dyn FnMut(&[u8])) {
    if begun.is_empty() {
        return sink(&end[..end.len().min(LONGEST)]);
    }
    let room = LONGEST - begun.len().min(LONGEST);
    begun.extend_from_slice(&end[..end.len().min(room)]);
    sink(begun);
    begun.clear();
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    fn lines(bytes: &[u8], buffer: usize) -> Vec<Vec<u8>> {
        let mut found = Vec::new();
        let mut source = BufReader::with_capacity(buffer, bytes);
        each(&mut source, &mut |line| found.push(line.to_vec())).unwrap();
        found
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
