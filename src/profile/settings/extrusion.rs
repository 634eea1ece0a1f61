//! `[extrusion]`: how much filament a line takes.

use crate::profile::choices::ExtrusionModel;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[extrusion]`: how much filament a line takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Extrusion {
    /// How the amount is found: line width times layer height; for a strand that stays round, π/4 of that;
    /// or the factors below.
    #[schemars(extend("default" = "area"))]
    pub model: ExtrusionModel,
    /// Factor on every amount of filament.
    #[schemars(range(min = 0.05, max = 5), extend("unit" = "times", "default" = 1))]
    pub multiplier: f64,
    /// Plastic on the first layer; 100 is as much as on others.
    #[schemars(range(min = 20, max = 200), extend("unit" = "%", "default" = 100))]
    pub first_layer: f64,
    /// Layer height at which the factors hold; other heights scale them.
    #[schemars(range(min = 0.02, max = 2), extend("unit" = "mm", "default" = 0.2))]
    pub factor_height: f64,
    /// Line width at which the factors hold; other widths scale them.
    #[schemars(range(min = 0.05, max = 4), extend("unit" = "mm", "default" = 0.4))]
    pub factor_width: f64,
    /// Filament for each mm of wall.
    #[schemars(range(min = 0, max = 2), extend("unit" = "mm/mm", "default" = 0.05))]
    pub wall_factor: f64,
    /// Filament for each mm of skin.
    #[schemars(range(min = 0, max = 2), extend("unit" = "mm/mm", "default" = 0.04))]
    pub skin_factor: f64,
    /// Filament for each mm of sparse infill that is one layer high; two layers take twice that.
    #[schemars(range(min = 0, max = 2), extend("unit" = "mm/mm", "default" = 0.04))]
    pub infill_factor: f64,
    /// Filament for each mm of support.
    #[schemars(range(min = 0, max = 2), extend("unit" = "mm/mm", "default" = 0.04))]
    pub support_factor: f64,
}
