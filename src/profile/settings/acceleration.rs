//! `[acceleration]`: how hard the nozzle speeds up and slows down, by what it prints.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[acceleration]`: how hard the nozzle speeds up and slows down. A file sets nothing of it while all
/// are unset. No more is asked for than limits.acceleration_x and limits.acceleration_y allow.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Acceleration {
    /// Acceleration of walls; unset means machine.acceleration.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub wall: Option<f64>,
    /// Acceleration of the outermost wall, skirt and brim; unset means acceleration.wall.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub outer_wall: Option<f64>,
    /// Acceleration of the walls inside it; unset means acceleration.wall.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub inner_wall: Option<f64>,
    /// Acceleration of walls where they hang over nothing; unset means acceleration.outer_wall.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub overhang: Option<f64>,
    /// Acceleration of skins; unset means machine.acceleration.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub skin: Option<f64>,
    /// Acceleration of skin that is seen from above; unset means acceleration.skin.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub top_skin: Option<f64>,
    /// Acceleration of bridges; unset means acceleration.skin.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub bridge: Option<f64>,
    /// Acceleration of beads along gaps that no line of skin reaches; unset means acceleration.skin.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub gap: Option<f64>,
    /// Acceleration of sparse infill, thin and thick; unset means machine.acceleration.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub infill: Option<f64>,
    /// Acceleration of support; unset means machine.acceleration.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub support: Option<f64>,
    /// Acceleration of all lines of the first layer, on a raft also of the part's; unset means that of each line.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub first_layer: Option<f64>,
    /// Acceleration of moves that print nothing; unset means limits.travel_acceleration.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub travel: Option<f64>,
}
