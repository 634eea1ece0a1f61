//! `[skirt]`, `[brim]`, `[raft]`: what is printed on the bed beside and under the part, so that it sticks.

use crate::profile::choices::BrimPlace;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[skirt]`: loops around everything, so that the nozzle is full when the part begins.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Skirt {
    /// Loops around all that is printed; 0 prints no skirt.
    #[schemars(range(min = 0, max = 100), extend("unit" = "loops", "default" = 0))]
    pub loops: u32,
    /// Distance from the skirt to the parts, or to their brim.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm", "default" = 6))]
    pub distance: f64,
    /// Least length of all its lines on the first layer; more loops are printed for it.
    #[schemars(range(min = 0, max = 10_000), extend("unit" = "mm", "default" = 0))]
    pub min_length: f64,
    /// Layers that have a skirt.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "layers", "default" = 1))]
    pub layers: u32,
}

/// `[brim]`: lines beside the first layer that make its hold on the bed wider.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Brim {
    /// Where a brim is printed: outside, inside in holes, both, off, or auto: outside of what would
    /// come loose, since its foot is small for its height or ends in a sharp corner.
    #[serde(rename = "where")]
    #[schemars(extend("default" = "auto"))]
    pub place: BrimPlace,
    /// Width of the brim, rounded to whole lines.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm", "default" = 5))]
    pub width: f64,
    /// Gap between brim and part: a little makes it easier to remove, and holds less.
    #[schemars(range(min = 0, max = 10), extend("unit" = "mm", "default" = 0))]
    pub gap: f64,
}

/// `[raft]`: a plate under the print, which is torn off: thick, slow lines on the bed, thin ones
/// across them, and a gap. It takes the place of a brim.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Raft {
    /// Whether a raft is printed.
    #[schemars(extend("default" = false))]
    pub enabled: bool,
    /// How far it reaches beyond part and support; at least a line of its base.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm", "default" = 3))]
    pub margin: f64,
    /// Gap between raft and part: more makes it easier to remove, and the part's bottom rougher.
    #[schemars(range(min = 0, max = 0.5), extend("unit" = "mm", "default" = 0.2))]
    pub gap: f64,
    /// Height of its base, the layer on the bed.
    #[schemars(range(min = 0.02, max = 2), extend("unit" = "mm", "default" = 0.3, "follows" = "machine.nozzle_diameter", "times" = 0.75))]
    pub base_height: f64,
    /// Width of the lines of its base.
    #[schemars(range(min = 0.05, max = 8), extend("unit" = "mm", "default" = 0.8, "follows" = "machine.nozzle_diameter", "times" = 2))]
    pub base_width: f64,
    /// Gap between the lines of its base.
    #[schemars(range(min = 0, max = 10), extend("unit" = "mm", "default" = 0.8, "follows" = "machine.nozzle_diameter", "times" = 2))]
    pub base_spacing: f64,
    /// Layers above its base, each across the one below.
    #[schemars(range(min = 1, max = 100), extend("unit" = "layers", "default" = 2))]
    pub interface_layers: u32,
    /// Height of each of them.
    #[schemars(range(min = 0.02, max = 2), extend("unit" = "mm", "default" = 0.2, "follows" = "machine.nozzle_diameter", "times" = 0.5))]
    pub interface_height: f64,
    /// Gap between their lines; 0 closes them.
    #[schemars(range(min = 0, max = 10), extend("unit" = "mm", "default" = 0))]
    pub interface_spacing: f64,
}
