//! `[output]`: what the file says of itself.

use crate::profile::choices::Stamp;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[output]`: what the file says of itself, beside the print.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// What the head of the file says of this program: its version, or none, so that the same print
    /// has the same bytes in the next version, too.
    #[schemars(extend("default" = "version"))]
    pub stamp: Stamp,
}
