//! What is wrong with a G-code file -> Error: why it cannot be read, or is of no use.

use super::limit::TooLong;
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
    /// It has no end.
    #[error("it is a device, which has no end; give a file, or a pipe")]
    Device,
    /// It is longer than is allowed.
    #[error(transparent)]
    TooLong(TooLong),
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
    /// The error of a file with this name. Where reading fails since it is too long, it is that.
    #[must_use]
    pub fn of(self, file: &str) -> Error {
        let long = match &self {
            Self::Unreadable(error) => error.get_ref().and_then(|inner| inner.downcast_ref()),
            _ => None,
        };
        let source = long.copied().map_or(self, Self::TooLong);
        Error { file: file.to_owned(), source }
    }
}
