//! `[jerk]`: how fast the nozzle takes corners, by what it prints.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[jerk]`: sudden change of speed in x and y that corners may have; on Klipper the square corner
/// velocity, on Marlin with junction deviation what that is made of. A file sets nothing of it while
/// all are unset.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Jerk {
    /// Jerk of walls; unset means the machine's.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub wall: Option<f64>,
    /// Jerk of the outermost wall, skirt and brim; unset means jerk.wall.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub outer_wall: Option<f64>,
    /// Jerk of the walls inside it; unset means jerk.wall.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub inner_wall: Option<f64>,
    /// Jerk of walls where they hang over nothing; unset means jerk.outer_wall.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub overhang: Option<f64>,
    /// Jerk of skins; unset means the machine's.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub skin: Option<f64>,
    /// Jerk of skin that is seen from above; unset means jerk.skin.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub top_skin: Option<f64>,
    /// Jerk of bridges; unset means jerk.skin.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub bridge: Option<f64>,
    /// Jerk of beads along gaps that no line of skin reaches; unset means jerk.skin.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub gap: Option<f64>,
    /// Jerk of sparse infill, thin and thick; unset means the machine's.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub infill: Option<f64>,
    /// Jerk of support; unset means the machine's.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub support: Option<f64>,
    /// Jerk of all lines of the first layer, on a raft also of the part's; unset means that of each line.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub first_layer: Option<f64>,
    /// Jerk of moves that print nothing; unset means the machine's.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm/s"))]
    pub travel: Option<f64>,
}
