//! Everything that can go wrong, each as one line a user can act on, with its exit code.
//!
//! Every message names the file, the place, the cause and what to do.

use crate::profile::ProfileError;
use crate::progress;
use crate::warning::plural;
use std::io;

/// A failure that ends the run. [`Error::exit_code`] gives the process exit code.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A bad combination of command-line arguments (exit 2).
    #[error("{0}")]
    Usage(String),

    /// A profile that cannot be read, or a setting that is unknown or out of range (exit 2).
    /// The text starts with the file and line, or with `--set` or the flag that gave it.
    #[error(transparent)]
    Profile(#[from] ProfileError),

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

    /// A G-code file that cannot be read or prints nothing (exit 3).
    #[error(transparent)]
    Gcode(#[from] crate::reader::Error),

    /// The models are readable but do not fit the printer or leave nothing to print (exit 3).
    #[error("{0}")]
    Unprintable(String),

    /// The models can be read but not be printed (exit 3).
    #[error(transparent)]
    Refused(#[from] Refusal),

    /// The run was told to stop: see [`Progress::cancel`](crate::progress::Progress::cancel).
    #[error("the run was cancelled")]
    Cancelled,

    /// The output cannot be written (exit 4).
    #[error("cannot write: {0}")]
    Write(#[source] io::Error),

    /// The thumbnails cannot be drawn (exit 4).
    #[error("cannot draw the thumbnails: {0}")]
    Thumbnails(#[source] io::Error),
}

impl Error {
    /// Shorthand for [`Error::Input`].
    pub fn input(file: &str, reason: impl Into<String>) -> Self {
        Self::Input { file: file.to_owned(), reason: reason.into() }
    }

    /// The documented process exit code: 2 usage or configuration, 3 input, 4 output; 130, as of
    /// an interrupted program, if the run was cancelled.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Profile(_) => 2,
            Self::Mesh(error) if error.is_usage() => 2,
            Self::Input { .. }
            | Self::Mesh(_)
            | Self::Gcode(_)
            | Self::Unprintable(_)
            | Self::Refused(_) => 3,
            Self::Write(_) | Self::Thumbnails(_) => 4,
            Self::Cancelled => 130,
        }
    }
}

/// A contour that is open by more than this, mm, is refused unless the mesh is to be sliced as
/// it is. A straight line across a longer gap would be a guess that shows on the print; one
/// across a shorter gap is about as long as the lines are wide.
pub const MOST_GAP_MM: f64 = 2.0;

/// Why a model that can be read is not printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The models are lower than half a layer.
    #[error(
        "nothing to print: {height_mm:.3} mm is less than half a layer high; use thinner layers, \
         --scale or --unit"
    )]
    TooLow {
        /// Height of the highest model, mm.
        height_mm: f64,
    },
    /// Contours are open by more than [`MOST_GAP_MM`].
    #[error(
        "{}: the mesh cannot be mended: contours are open on {}, most on layer {layer} by \
         {gap_mm:.1} mm; mend the model, or slice it as it is with --mesh warn",
        .models.join(", "),
        plural(*.layers as u64, "layer")
    )]
    Open {
        /// Names of the models.
        models: Vec<String>,
        /// Number of layers with open contours.
        layers: usize,
        /// Layer with the longest gap, counted from 1.
        layer: usize,
        /// The longest gap, mm.
        gap_mm: f64,
    },
    /// No line fits anywhere.
    #[error(
        "nothing to print: everything is thinner than a line of {line_width_mm} mm; use a smaller \
         --line-width, a larger --scale or another --unit"
    )]
    TooThin {
        /// Width of a line, mm.
        line_width_mm: f64,
    },
}

impl From<progress::Cancelled> for Error {
    fn from(_: progress::Cancelled) -> Self {
        Self::Cancelled
    }
}

/// The result of everything that can fail with an [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;
