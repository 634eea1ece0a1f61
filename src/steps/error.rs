//! What is wrong with a stream of steps -> Error: why it is refused, with the block.

use std::io;

/// A stream that cannot be played, or G-code that no steps can be made of.
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
    Unreadable(#[source] io::Error),
    /// It begins with something else.
    #[error("it is no stream of steps; give a file that `slicer steps` has made")]
    NotSteps,
    /// It is of a version that is not known.
    #[error("it is of version {0} of the format, and this program knows version {known}; make it anew", known = super::format::VERSION)]
    Version(u16),
    /// Its header is damaged.
    #[error("its header is damaged; make or send it anew")]
    Header,
    /// A block is not as it was written.
    #[error("block {block} {what}; make or send the file anew")]
    Damaged {
        /// Its number, from 0.
        block: u64,
        /// How.
        what: Damage,
    },
    /// A move ends farther away than steps are counted.
    #[error(
        "line {line}: {axis} goes farther than steps can be counted; give a file for this machine"
    )]
    TooFar {
        /// Line of the G-code, from 1.
        line: u64,
        /// Letter of the axis.
        axis: char,
    },
    /// The G-code has a command that moves something, and that a stream cannot hold.
    #[error("line {line}: {code} {why}")]
    NotMade {
        /// Line of the G-code, from 1.
        line: u64,
        /// The command.
        code: String,
        /// What it does, and what to do.
        why: &'static str,
    },
    /// It would take longer than any print.
    #[error(
        "it takes more than {days:.0} days; look for a wait (G4) or a feed (F) that is not meant",
        days = MOST_SECONDS / 86_400.0
    )]
    TooLong,
}

/// A stream takes no longer, s: one wait of a damaged file would make gigabytes of pauses.
pub(super) const MOST_SECONDS: f64 = 1e7;

/// How a block is damaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    /// The file ends within it, or before it.
    #[error("is cut off")]
    Cut,
    /// Its checksum is another.
    #[error("is damaged")]
    Sum,
    /// Another block stands in its place.
    #[error("is missing: block {0} is in its place")]
    Order(u32),
    /// Its checksum is right, but no such block is written.
    #[error("holds what is no step")]
    Content,
    /// It is the last, and its totals are not those of the steps.
    #[error("has other totals than the steps before it")]
    Totals,
    /// It is the last, and something follows.
    #[error("is the last, and more bytes follow")]
    Trailing,
}

impl Cause {
    /// The error of a file with this name.
    #[must_use]
    pub fn of(self, file: &str) -> Error {
        Error { file: file.to_owned(), source: self }
    }
}
