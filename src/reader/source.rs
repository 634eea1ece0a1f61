//! A file, or what comes from a pipe -> Source: bytes that can be read more than once.

use std::fs::File;
use std::io::{self, Read, Seek as _, SeekFrom};
use std::sync::{Mutex, PoisonError};

/// Bytes that can be read again, from any place on.
#[derive(Debug)]
pub struct Source {
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Bytes(Vec<u8>),
    /// One place in it is shared by all who read.
    File(Mutex<File>),
}

impl Source {
    /// A file. What is no regular one, such as a pipe, is kept in a temporary file.
    ///
    /// # Errors
    /// What reading or writing gives.
    pub fn of_file(mut file: File) -> io::Result<Self> {
        if file.metadata()?.is_file() {
            return Ok(Self { kind: Kind::File(Mutex::new(file)) });
        }
        Self::spooled(&mut file)
    }

    /// What can be read only once: it is kept in a temporary file without a name.
    ///
    /// # Errors
    /// What reading or writing gives.
    pub fn spooled(from: &mut dyn Read) -> io::Result<Self> {
        let mut file = tempfile::tempfile()?;
        io::copy(from, &mut file)?;
        Ok(Self { kind: Kind::File(Mutex::new(file)) })
    }

    /// Bytes in memory.
    #[must_use]
    pub fn of_bytes(bytes: Vec<u8>) -> Self {
        Self { kind: Kind::Bytes(bytes) }
    }

    /// All bytes from the first on.
    pub fn reader(&self) -> impl Read {
        Reader { source: self, at: 0 }
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
        let spooled = Source::spooled(&mut &bytes[..]).unwrap();
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
