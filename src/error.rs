//! Everything that can go wrong, each as one line a user can act on, with its exit code.
//!
//! Every message names the file, the place, the cause and what to do.

use std::path::{Path, PathBuf};

/// A failure that ends the run. [`Error::exit_code`] gives the process exit code.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A bad combination of command-line arguments (exit 2).
    #[error("{0}")]
    Usage(String),

    /// A profile that cannot be read, or a setting that is unknown or out of range (exit 2).
    /// The text starts with the file and line, or with `--set` or the flag that gave it.
    #[error("{0}")]
    Config(String),

    /// A model that cannot be read or is no usable mesh, or a file that is no G-code (exit 3).
    #[error("{file}: {reason}")]
    Input {
        /// The file as the user named it, `<stdin>` for `-`.
        file: String,
        /// Where, what and what to do.
        reason: String,
    },

    /// A model cannot be read, mended or placed (exit 3), or a placement makes no sense (exit 2).
    #[error(transparent)]
    Mesh(#[from] crate::mesh::Error),

    /// The models are readable but do not fit the printer or leave nothing to print (exit 3).
    #[error("{0}")]
    Unprintable(String),

    /// An output that cannot be opened or written (exit 4).
    #[error("{}: {action}: {source}", shown(file))]
    Output {
        /// The output as the user named it.
        file: PathBuf,
        /// What was being done, such as `cannot write`.
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
}

impl Error {
    /// Shorthand for [`Error::Input`].
    pub fn input(file: &str, reason: impl Into<String>) -> Self {
        Self::Input { file: file.to_owned(), reason: reason.into() }
    }

    /// The documented process exit code: 2 usage or configuration, 3 input, 4 output.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Config(_) => 2,
            Self::Mesh(error) if error.is_usage() => 2,
            Self::Input { .. } | Self::Mesh(_) | Self::Unprintable(_) => 3,
            Self::Output { .. } => 4,
        }
    }
}

/// An output's name for people.
fn shown(file: &Path) -> String {
    if file.as_os_str() == "-" { "standard output".into() } else { file.display().to_string() }
}

/// The result of everything that can fail with an [`Error`].
pub type Result<T> = std::result::Result<T, Error>;
