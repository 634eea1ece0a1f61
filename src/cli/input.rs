//! Path -> bytes of a G-code file, from a file or from standard input.

use slicer::error::{Error, Result};
use std::fs::File;
use std::io::{BufRead, BufReader, Read as _};

/// Bytes that are read at once.
pub(super) const BUFFER: usize = 1 << 18;

/// Opens a file, `-` being standard input; gives its name for messages, too.
///
/// # Errors
/// [`Error::Input`] if it cannot be opened.
pub(super) fn open(file: &str) -> Result<(&str, Box<dyn BufRead>)> {
    if file == "-" {
        let source = BufReader::with_capacity(BUFFER, std::io::stdin());
        return Ok(("<stdin>", Box::new(source)));
    }
    let source = File::open(file).map_err(|error| unreadable(file, &error))?;
    Ok((file, Box::new(BufReader::with_capacity(BUFFER, source))))
}

/// A whole file and its name for messages.
///
/// # Errors
/// [`Error::Input`] if it cannot be read.
pub(super) fn read(file: &str) -> Result<(&str, Vec<u8>)> {
    let (name, mut source) = open(file)?;
    let mut bytes = Vec::new();
    source.read_to_end(&mut bytes).map_err(|error| unreadable(name, &error))?;
    Ok((name, bytes))
}

/// A file that cannot be read.
pub(super) fn unreadable(file: &str, error: &std::io::Error) -> Error {
    Error::input(file, format!("cannot read: {error}; check the path"))
}
