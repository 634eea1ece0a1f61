//! Job: what one run is asked for, as the command line hands it to the library.

use crate::mesh::Placement;
use crate::profile::Settings;
use std::path::PathBuf;

/// Name and version of this program.
pub const NAME: &str = concat!("slicer ", env!("CARGO_PKG_VERSION"));

/// One run: which models become which file, and how.
#[derive(Debug, Clone)]
pub struct Job {
    /// Model files, `-` for standard input.
    pub models: Vec<String>,
    /// Where they lie.
    pub placement: Placement,
    /// All effective settings.
    pub settings: Settings,
    /// Name or file of the profile, for the report.
    pub profile: String,
    /// Name of the output, for messages.
    pub output: PathBuf,
}
