//! What is wrong with a G-code file -> Error: why it cannot be read, or is of no use.

use std::io;

/// A G-code file that cannot be read or prints nothing.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {source}")]
pub struct Error {
    /// The file as the user named it, `<stdin>` for standard input.
    pub file: String,
    /// What is wrong with it.
    pub source: Cause,
}

/// See [`Error`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Cause {
    /// Its bytes cannot be read.
    #[error("cannot read: {0}; check the path")]
    Unreadable(#[from] io::Error),
    /// No move: it is no G-code.
    #[error("there is no move in it; give a G-code file that a slicer has written")]
    NoMove,
    /// Moves, but none that extrudes on its way.
    #[error("no move in it prints a line; give a G-code file that a slicer has written")]
    NoLine,
    /// No line that a picture can show.
    #[error("nothing is printed in it; give a G-code file that a slicer has written")]
    NothingToDraw,
}

impl Cause {
    /// The error of a file with this name.
    #[must_use]
    pub fn of(self, file: &str) -> Error {
        Error { file: file.to_owned(), source: self }
    }
}
