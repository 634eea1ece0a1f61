//! `[filament]`: the material.

use super::MAX_TEXT;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[filament]`: the material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Filament {
    /// Name of the material, such as PLA.
    #[schemars(length(max = MAX_TEXT), extend("default" = "PLA"))]
    pub name: String,
    /// Diameter of the filament.
    #[schemars(range(min = 0.5, max = 5), extend("unit" = "mm", "default" = 1.75))]
    pub diameter: f64,
    /// Density of the material.
    #[schemars(range(min = 0.1, max = 20), extend("unit" = "g/cm³", "default" = 1.24))]
    pub density: f64,
    /// Temperature of the nozzle.
    #[schemars(range(min = 0, max = 500), extend("unit" = "°C"))]
    pub temperature: f64,
    /// Temperature of the bed; 0 leaves it cold.
    #[schemars(range(min = 0, max = 200), extend("unit" = "°C", "default" = 0))]
    pub bed_temperature: f64,
    /// Temperature of the nozzle on the first layer; unset means temperature.
    #[schemars(range(min = 0, max = 500), extend("unit" = "°C"))]
    pub first_layer_temperature: Option<f64>,
    /// Temperature of the bed on the first layer; unset means bed_temperature.
    #[schemars(range(min = 0, max = 200), extend("unit" = "°C"))]
    pub first_layer_bed_temperature: Option<f64>,
    /// Coldest that the material is printed at; below it there is a warning.
    #[schemars(range(min = 0, max = 500), extend("unit" = "°C"))]
    pub min_temperature: Option<f64>,
    /// Hottest that the material is printed at; above it there is a warning.
    #[schemars(range(min = 0, max = 500), extend("unit" = "°C"))]
    pub max_temperature: Option<f64>,
    /// Hottest bed that the material is printed on; above it there is a warning.
    #[schemars(range(min = 0, max = 200), extend("unit" = "°C"))]
    pub max_bed_temperature: Option<f64>,
    /// Power of the part cooling fan; at most, where cooling.min_fan lowers it.
    #[schemars(range(min = 0, max = 100), extend("unit" = "%", "default" = 100))]
    pub fan: f64,
    /// First layer, counted from 1, that is printed with the fan on.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "layer", "default" = 2))]
    pub fan_from_layer: u32,
    /// Most of this material that can be melted; the lesser of it and machine.max_volumetric_speed
    /// holds. Unset, the machine's does.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm³/s"))]
    pub max_volumetric_speed: Option<f64>,
    /// How much the material shrinks in x and y as it cools; models are printed larger by that.
    #[schemars(range(min = 0, max = 20), extend("unit" = "%", "default" = 0))]
    pub shrinkage: f64,
    /// How much it shrinks in z; most of that is gone before the next layer is laid.
    #[schemars(range(min = 0, max = 20), extend("unit" = "%", "default" = 0))]
    pub shrinkage_z: f64,
    /// Pressure (or linear) advance: how far ahead of the flow the filament is pushed. Unset leaves what
    /// the printer is set to.
    #[schemars(range(min = 0, max = 2), extend("unit" = "s"))]
    pub pressure_advance: Option<f64>,
    /// Price of the material; 0 means unknown.
    #[schemars(range(min = 0, max = 1_000_000), extend("unit" = "money/kg", "default" = 0))]
    pub cost: f64,
}
