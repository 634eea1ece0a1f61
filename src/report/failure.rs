//! Error of a run -> Failure: the report of a run that failed, as versioned JSON.

use super::SCHEMA;
use crate::error::details::{CODES, Details, Place};
use crate::job;
use schemars::JsonSchema;
use serde::Serialize;

/// The report of a run that failed. It stands where the report of a run that is done would stand, so
/// that none of an earlier run is taken for it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Failure {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Name and version of this program.
    pub slicer: String,
    /// Exit code of the run.
    pub exit_code: u8,
    /// What went wrong.
    pub error: Cause,
}

/// What went wrong.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Cause {
    /// One of [`CODES`].
    #[schemars(extend("enum" = codes()))]
    pub code: &'static str,
    /// One line for people, as on standard error.
    pub message: String,
    /// The file that it is about, such as a model or a profile; absent if it is about none, or about several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Where in the file or on the bed, or which setting; absent if it is nowhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<Place>,
}

fn codes() -> Vec<&'static str> {
    CODES.iter().map(|(code, _, _)| *code).collect()
}

impl Failure {
    /// A run that ended with this exit code and line.
    #[must_use]
    pub fn new(exit_code: u8, message: String, details: Details) -> Self {
        let Details { code, file, place } = details;
        let error = Cause { code, message, file, place };
        Self { schema: SCHEMA, slicer: job::NAME.to_owned(), exit_code, error }
    }

    /// A run that has not ended yet, or was killed.
    #[must_use]
    pub fn unfinished(exit_code: u8) -> Self {
        let message = "the run has not ended: it goes on, or was killed".to_owned();
        Self::new(exit_code, message, Details::of("unfinished"))
    }

    /// A run that was interrupted by a signal.
    #[must_use]
    pub fn interrupted(exit_code: u8) -> Self {
        let details = Details::of("interrupted");
        Self::new(exit_code, "the run was interrupted by a signal".to_owned(), details)
    }

    /// A run that met a fault of the program itself.
    #[must_use]
    pub fn fault(exit_code: u8, message: String) -> Self {
        Self::new(exit_code, message, Details::of("fault"))
    }
}
