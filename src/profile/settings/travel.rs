//! `[travel]`, `[retraction]`: moves without print, and the filament around them.

use crate::profile::choices::{RetractWhen, TravelOrder};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[travel]`: which way the nozzle goes without printing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Travel {
    /// Which path is printed next: `nearest` takes short ways; `file` goes on as the model file does, walls
    /// first and then lines as they are scanned, to compare with that.
    #[schemars(extend("default" = "nearest"))]
    pub order: TravelOrder,
    /// Whether travels go round holes and corners of the part where that saves a retraction.
    #[schemars(extend("default" = true))]
    pub avoid_crossing: bool,
    /// How much longer than the straight way that may be.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm", "default" = 6))]
    pub max_detour: f64,
}

/// `[retraction]`: what happens to the filament around a travel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Retraction {
    /// Filament that is pulled back; 0 turns retraction off.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 1))]
    pub length: f64,
    /// Speed of the filament, back and forth.
    #[schemars(range(min = 0.1, max = 200), extend("unit" = "mm/s", "default" = 20))]
    pub speed: f64,
    /// Which travels retract: all, or those that cross an outer wall or leave the part.
    #[schemars(extend("default" = "crossing"))]
    pub when: RetractWhen,
    /// Travels shorter than this never retract.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm", "default" = 1))]
    pub min_travel: f64,
    /// Longer travels retract even inside the part; 0 sets no limit.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm", "default" = 12))]
    pub max_travel: f64,
    /// How far the nozzle goes back over the last line after a retraction; 0 leaves at once.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 0))]
    pub wipe: f64,
    /// How far the nozzle is lifted while retracted.
    #[schemars(range(min = 0, max = 10), extend("unit" = "mm", "default" = 0))]
    pub z_hop: f64,
}
