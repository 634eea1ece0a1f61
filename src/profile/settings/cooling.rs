//! `[cooling]`: how a layer gets the time and the air that it needs to set.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[cooling]`: how a layer gets the time and the air that it needs to set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cooling {
    /// Least time of a layer: what would take less is printed slower, infill, skins and support
    /// first, then inner walls, outer walls and bridges last; 0 slows nothing down.
    #[schemars(range(min = 0, max = 3_600), extend("unit" = "s", "default" = 10))]
    pub min_layer_time: f64,
    /// No line is slowed down below this for cooling.min_layer_time.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 10))]
    pub min_speed: f64,
    /// Whether the nozzle waits beside the part where cooling.min_speed alone does not give a layer
    /// its time. It may ooze meanwhile.
    #[schemars(extend("default" = false))]
    pub wait: bool,
    /// Least power of the fan, on layers that take cooling.min_fan_time and longer; unset means
    /// filament.fan, whatever a layer takes.
    #[schemars(range(min = 0, max = 100), extend("unit" = "%"))]
    pub min_fan: Option<f64>,
    /// Layers that take no longer than this have the fan at filament.fan.
    #[schemars(range(min = 0, max = 3_600), extend("unit" = "s", "default" = 10))]
    pub max_fan_time: f64,
    /// Layers that take this long have the fan at cooling.min_fan; in between it goes evenly.
    #[schemars(range(min = 0, max = 3_600), extend("unit" = "s", "default" = 60))]
    pub min_fan_time: f64,
    /// First layer, counted from 1, with the fan at its whole power: it rises evenly to that from
    /// filament.fan_from_layer on.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "layer", "default" = 4))]
    pub fan_full_from_layer: u32,
    /// Power of the fan on bridges, from filament.fan_from_layer on.
    #[schemars(range(min = 0, max = 100), extend("unit" = "%", "default" = 100))]
    pub bridge_fan: f64,
    /// Power of the fan on overhanging walls; unset means cooling.bridge_fan.
    #[schemars(range(min = 0, max = 100), extend("unit" = "%"))]
    pub overhang_fan: Option<f64>,
    /// Power of the fan on support next to the part; unset means as on all else.
    #[schemars(range(min = 0, max = 100), extend("unit" = "%"))]
    pub interface_fan: Option<f64>,
}
