//! `[dual]`: dual injection.

use crate::profile::choices::{DualDirection, DualMode, DualPart, DualRatio, DualRemainder};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[dual]`: dual injection. A group is a number of layers, one on the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dual {
    /// Which layers thick lines lie on: none, the top layer of each group, or all layers of a
    /// group in turn.
    #[schemars(extend("default" = "off"))]
    pub mode: DualMode,
    /// Layers in a group, whose lines are printed at once; auto takes as many as pay.
    #[schemars(extend("unit" = "layers", "default" = 2))]
    pub ratio: DualRatio,
    /// Height of thick lines, at most.
    #[schemars(range(min = 10, max = 200), extend("unit" = "% of the nozzle", "default" = 100))]
    pub max_bead_height: f64,
    /// What is printed thick.
    #[schemars(extend("default" = ["infill", "support"]))]
    pub parts: Vec<DualPart>,
    /// Direction of a group's thick lines: crossing those of the group before, or the one with
    /// less length.
    #[schemars(extend("default" = "cross"))]
    pub direction: DualDirection,
    /// What happens to infill that only one layer of a group has: printed thin, or left out.
    #[schemars(extend("default" = "thin"))]
    pub remainder: DualRemainder,
}
