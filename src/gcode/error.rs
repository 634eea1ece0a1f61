//! What can go wrong while G-code is written -> Error.

use crate::profile::BlockError;
use std::io;

/// Why G-code cannot be written. The output's name is known to whoever opened it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A start or end block that cannot be filled in. Settings that were loaded as a profile
    /// have been checked for this.
    #[error(transparent)]
    Block(#[from] BlockError),

    /// The output cannot be written.
    #[error("cannot write: {0}")]
    Write(#[from] io::Error),
}

/// The result of everything in this stage that can fail.
pub type Result<T> = std::result::Result<T, Error>;
