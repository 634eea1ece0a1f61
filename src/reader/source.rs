//! A file, or what comes from a pipe -> Source: bytes that can be read more than once.

use super::limit::{DEFAULT_MAX_MOVES, Limited};
use super::recognise::Reading;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek as _, SeekFrom};
use std::sync::{Mutex, PoisonError};

/// Bytes that are read at once.
const BUFFER: usize = 1 << 18;

/// Bytes that can be read again, from any place on.
#[derive(Debug)]
pub struct Source {
    kind: Kind,
    /// Moves in it, at most.
    most: u64,
}

#[derive(Debug)]
enum Kind {
    Bytes(Vec<u8>),
    /// One place in it is shared by all who read.
    File(Mutex<File>),
}

impl Source {
    /// A file with at most so many moves. What is no regular file, such as a pipe, is kept in a
    /// temporary one.
    ///
    /// # Errors
    /// What reading or writing gives.
    pub fn of_file(mut file: File, most_moves: u64) -> io::Result<Self> {
        if file.metadata()?.is_file() {
            return Ok(Self { kind: Kind::File(Mutex::new(file)), most: most_moves });
        }
        Self::spooled(&mut file, most_moves)
    }

    /// What can be read only once: it is kept in a temporary file without a name.
    ///
    /// # Errors
    /// What reading or writing gives, and [`TooLong`](super::TooLong).
    pub fn spooled(from: &mut dyn Read, most_moves: u64) -> io::Result<Self> {
        let mut file = tempfile::tempfile()?;
        io::copy(&mut Limited::new(BufReader::with_capacity(BUFFER, from), most_moves), &mut file)?;
        Ok(Self { kind: Kind::File(Mutex::new(file)), most: most_moves })
    }

    /// Bytes in memory.
    #[must_use]
    pub fn of_bytes(bytes: Vec<u8>) -> Self {
        Self { kind: Kind::Bytes(bytes), most: DEFAULT_MAX_MOVES }
    }

    /// All bytes from the first on; an error, [`TooLong`](super::TooLong), where there are too many moves.
    pub fn reader(&self) -> impl BufRead {
        let reader = Reader { source: self, at: 0 };
        Limited::new(BufReader::with_capacity(BUFFER, reader), self.most)
    }

    /// What [`Reading::of_parts`] looks at: its beginning and its end, which overlap in a short file, so
    /// that settings at the end are whole in one of them.
    ///
    /// # Errors
    /// What reading gives.
    pub fn ends(&self) -> io::Result<[Vec<u8>; 2]> {
        let head = self.bytes(0, Reading::HEAD as u64)?;
        let length = self.length()?;
        let tail = length.saturating_sub(Reading::TAIL as u64);
        Ok([head, self.bytes(tail, length)?])
    }

    fn length(&self) -> io::Result<u64> {
        match &self.kind {
            Kind::Bytes(bytes) => Ok(bytes.len() as u64),
            Kind::File(file) => {
                let file = file.lock().unwrap_or_else(PoisonError::into_inner);
                Ok(file.metadata()?.len())
            }
        }
    }

    /// The bytes from `from` to `to`, or to the end if that comes before.
    ///
    /// # Errors
    /// What reading gives.
    pub(super) fn bytes(&self, from: u64, to: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        Reader { source: self, at: from }.take(to.saturating_sub(from)).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    fn read_at(&self, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
        match &self.kind {
            Kind::Bytes(bytes) => {
                let from = usize::try_from(at).unwrap_or(usize::MAX).min(bytes.len());
                let mut rest = &bytes[from..];
                rest.read(buffer)
            }
            Kind::File(file) => {
                let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                file.seek(SeekFrom::Start(at))?;
                file.read(buffer)
            }
        }
    }
}

/// Reads a source from a place on.
struct Reader<'a> {
    source: &'a Source,
    at: u64,
}

impl Read for Reader<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read_at(self.at, buffer)?;
        self.at += count as u64;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_source_is_read_again_from_any_place() {
        let bytes = b"some bytes";
        let spooled = Source::spooled(&mut &bytes[..], 10).unwrap();
        for source in [spooled, Source::of_bytes(bytes.to_vec())] {
            for _ in 0..2 {
                assert_eq!(source.bytes(5, 8).unwrap(), b"byt");
                assert_eq!(source.bytes(8, 80).unwrap(), b"es");
                assert!(source.bytes(80, 90).unwrap().is_empty());
                let mut all = Vec::new();
                source.reader().read_to_end(&mut all).unwrap();
                assert_eq!(all, bytes);
            }
        }
    }
}
