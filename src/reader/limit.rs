//! Source -> the same source with an end: no file, and no pipe, is read for ever.

use std::io::{self, BufRead, Read};

/// Lines that are no comments of a file, at most, unless the caller says another number: some 3 GB.
/// The longest prints have a tenth of it.
pub const DEFAULT_MAX_MOVES: u64 = 100_000_000;

/// Bytes of a line, at most: what has no line ends is no G-code.
const LONGEST_LINE: u64 = 1 << 26;

/// Bytes for each move, comments included, and bytes beside the moves, such as pictures.
const BYTES_PER_MOVE: u64 = 256;
const MORE_BYTES: u64 = 1 << 26;

/// A file that is longer than is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TooLong {
    /// It has more moves.
    #[error("it has more than {0} moves; raise --max-moves if it is meant to be that long")]
    Moves(u64),
    /// It has more bytes than that many moves need.
    #[error(
        "it has more bytes than {0} moves need; raise --max-moves if it is meant to be that long"
    )]
    Bytes(u64),
    /// It has a line without an end.
    #[error("a line of it has more than {LONGEST_LINE} bytes; give a G-code file")]
    Line,
}

/// A source that fails with [`TooLong`], in an [`io::Error`], where it holds more than is allowed.
/// Every line that is not empty and does not begin with `;` counts as a move.
#[derive(Debug)]
pub struct Limited<R> {
    source: R,
    counter: Counter,
    /// Bytes of the source's buffer that are counted already.
    counted: usize,
}

#[derive(Debug)]
struct Counter {
    most: u64,
    moves: u64,
    bytes: u64,
    /// Bytes since the last end of a line.
    line: u64,
    /// The last byte.
    last: u8,
}

impl<R: BufRead> Limited<R> {
    /// Lets `most` moves through.
    pub fn new(source: R, most: u64) -> Self {
        let counter = Counter { most, moves: 0, bytes: 0, line: 0, last: b'\n' };
        Self { source, counter, counted: 0 }
    }
}

impl Counter {
    fn count(&mut self, bytes: &[u8]) -> Result<(), TooLong> {
        let (Some(&first), Some(&last)) = (bytes.first(), bytes.last()) else { return Ok(()) };
        let ends = |byte: u8| (byte == b'\n') | (byte == b'\r');
        let begins = |before: u8, byte: u8| ends(before) & !ends(byte) & (byte != b';');
        self.moves += u64::from(begins(self.last, first));
        // Two neighbours at a time, without a branch, and sums that fit a byte: many at once for the processor.
        let most = usize::from(u8::MAX);
        for (some, next) in bytes.chunks(most).zip(bytes[1..].chunks(most)) {
            let pairs = some.iter().zip(next);
            let begun: u8 = pairs.map(|(&one, &next)| u8::from(begins(one, next))).sum();
            self.moves += u64::from(begun);
        }
        let length = bytes.len() as u64;
        self.bytes += length;
        self.line = match bytes.iter().rposition(|&byte| ends(byte)) {
            Some(end) => length - end as u64 - 1,
            None => self.line + length,
        };
        self.last = last;
        if self.moves > self.most {
            return Err(TooLong::Moves(self.most));
        }
        if self.line > LONGEST_LINE {
            return Err(TooLong::Line);
        }
        if self.bytes > self.most.saturating_mul(BYTES_PER_MOVE).saturating_add(MORE_BYTES) {
            return Err(TooLong::Bytes(self.most));
        }
        Ok(())
    }
}

impl<R: BufRead> BufRead for Limited<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let bytes = self.source.fill_buf()?;
        let new = bytes.get(self.counted..).unwrap_or_default();
        self.counter.count(new).map_err(io::Error::other)?;
        self.counted = bytes.len();
        Ok(bytes)
    }

    fn consume(&mut self, count: usize) {
        self.source.consume(count);
        self.counted = self.counted.saturating_sub(count);
    }
}

impl<R: BufRead> Read for Limited<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    fn moves(text: &str, buffer: usize, most: u64) -> Result<Vec<u8>, TooLong> {
        let mut source = Limited::new(BufReader::with_capacity(buffer, text.as_bytes()), most);
        let mut bytes = Vec::new();
        let read = source.read_to_end(&mut bytes).map(|_| bytes);
        read.map_err(|error| *error.get_ref().unwrap().downcast_ref().unwrap())
    }

    #[test]
    fn lines_that_are_no_comments_count_whatever_the_buffer() {
        let text = ";a\nG1 X1\r\n\r\nG1 X2\r;b\n\n G1 X3;c\nG1 X4";
        for buffer in 1..9 {
            assert_eq!(moves(text, buffer, 4), Ok(text.as_bytes().to_vec()));
            assert_eq!(moves(text, buffer, 3), Err(TooLong::Moves(3)));
        }
    }

    #[test]
    fn what_has_no_line_ends_and_what_is_all_comments_end() {
        for (endless, most, expected) in [
            (&b"x"[..], 1_000_000, TooLong::Line),
            (b";\n", 7, TooLong::Bytes(7)),
            (b"G1\n", 1_000_000, TooLong::Moves(1_000_000)),
        ] {
            let block = endless.repeat(1 << 16);
            let mut counter = Counter { most, moves: 0, bytes: 0, line: 0, last: b'\n' };
            let end = (0..1 << 20).find_map(|_| counter.count(&block).err());
            assert_eq!(end, Some(expected));
        }
    }
}
