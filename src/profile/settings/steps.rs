//! `[steps]`: how far a step of each motor goes, and how fast it may come.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[steps]`: the motors of a machine that takes steps instead of G-code, for `slicer steps`. Without x,
/// y, z and e, or with 0 for one, no steps are made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Steps {
    /// Steps for a mm of x, as they are sent: half steps or microsteps are steps.
    #[schemars(range(min = 0, max = 100_000), extend("unit" = "steps/mm"))]
    pub x: Option<f64>,
    /// Steps for a mm of y.
    #[schemars(range(min = 0, max = 100_000), extend("unit" = "steps/mm"))]
    pub y: Option<f64>,
    /// Steps for a mm of z.
    #[schemars(range(min = 0, max = 100_000), extend("unit" = "steps/mm"))]
    pub z: Option<f64>,
    /// Steps for a mm of filament.
    #[schemars(range(min = 0, max = 100_000), extend("unit" = "steps/mm"))]
    pub e: Option<f64>,
    /// Most steps of x in a second; unset means what limits.speed_x makes.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "steps/s"))]
    pub rate_x: Option<f64>,
    /// Most steps of y in a second; unset means what limits.speed_y makes.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "steps/s"))]
    pub rate_y: Option<f64>,
    /// Most steps of z in a second; unset means what limits.speed_z makes.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "steps/s"))]
    pub rate_z: Option<f64>,
    /// Most steps of the filament in a second; unset means what limits.speed_e makes.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "steps/s"))]
    pub rate_e: Option<f64>,
    /// Least time between two steps of an axis that turns round.
    #[schemars(range(min = 0, max = 1_000_000), extend("unit" = "µs", "default" = 0))]
    pub turn: u32,
    /// How long the board holds the pulse of a step; two steps are at least so far apart, and two of
    /// one axis twice as far.
    #[schemars(range(min = 1, max = 10_000), extend("unit" = "µs", "default" = 2))]
    pub pulse: u32,
    /// Whether moves speed up and slow down as `[limits]` says; off, each has the speed that the file
    /// asks for from its first step to its last.
    #[schemars(extend("default" = true))]
    pub ramps: bool,
    /// Where x stands when the steps begin.
    #[schemars(range(min = -10_000, max = 10_000), extend("unit" = "mm", "default" = 0))]
    pub home_x: f64,
    /// Where y stands when the steps begin.
    #[schemars(range(min = -10_000, max = 10_000), extend("unit" = "mm", "default" = 0))]
    pub home_y: f64,
    /// Where z stands when the steps begin.
    #[schemars(range(min = -10_000, max = 10_000), extend("unit" = "mm", "default" = 0))]
    pub home_z: f64,
}
