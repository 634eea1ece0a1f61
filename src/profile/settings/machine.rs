//! `[machine]`: the printer, and `[machine.reach]`: where its nozzle may go.

use super::MAX_TEXT;
use crate::profile::choices::{DialectName, Origin};
use crate::profile::sizes::{self, PictureSize};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[machine]`: the printer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Name of the printer.
    #[schemars(length(max = MAX_TEXT))]
    pub name: String,
    /// The G-code that its firmware understands.
    pub dialect: DialectName,
    /// Size of the print volume in x.
    #[schemars(range(min = 1, max = 5_000), extend("unit" = "mm"))]
    pub bed_width: f64,
    /// Size of the print volume in y.
    #[schemars(range(min = 1, max = 5_000), extend("unit" = "mm"))]
    pub bed_depth: f64,
    /// Size of the print volume in z.
    #[schemars(range(min = 1, max = 5_000), extend("unit" = "mm"))]
    pub bed_height: f64,
    /// Least size of a part in x, y and z; smaller ones are refused. 0 sets no limit.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm", "default" = 0))]
    pub min_part_size: f64,
    /// Whether the bed can be heated; if not, filament.bed_temperature is 0 for every material.
    #[schemars(extend("default" = true))]
    pub heated_bed: bool,
    /// Where the nozzle may go; the print volume is where parts may lie.
    pub reach: Reach,
    /// Where on the bed x and y are 0.
    #[schemars(extend("default" = "front-left"))]
    pub origin: Origin,
    /// Diameter of the nozzle.
    #[schemars(range(min = 0.05, max = 2), extend("unit" = "mm", "default" = 0.4))]
    pub nozzle_diameter: f64,
    /// Number of the tool that prints.
    #[schemars(range(min = 0, max = 1), extend("default" = 0))]
    pub tool: u32,
    /// Acceleration of moves that print, which {acceleration} in the start block stands for.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub acceleration: f64,
    /// Whether E counts from the last move instead of from the start.
    #[schemars(extend("default" = false))]
    pub relative_e: bool,
    /// Whether the firmware knows arcs (G2, G3); Klipper does with `[gcode_arcs]`.
    #[schemars(extend("default" = false))]
    pub arcs: bool,
    /// Length of the straight pieces that the firmware makes of an arc, as Klipper's resolution or
    /// Marlin's MAX_ARC_SEGMENT_MM: where they would cut off too much, lines stay lines.
    #[schemars(range(min = 0.01, max = 10), extend("unit" = "mm", "default" = 1))]
    pub arc_segment: f64,
    /// How far these pieces leave the arc at most, where the firmware makes them shorter for that;
    /// unset if only their length counts.
    #[schemars(range(min = 0.001, max = 1), extend("unit" = "mm"))]
    pub arc_deviation: Option<f64>,
    /// Hottest that the hot end and its firmware bear.
    #[schemars(range(min = 100, max = 500), extend("unit" = "°C", "default" = 300))]
    pub max_temperature: f64,
    /// Coldest at which the firmware pushes filament.
    #[schemars(range(min = 0, max = 500), extend("unit" = "°C", "default" = 170))]
    pub min_temperature: f64,
    /// Hottest that the bed and its firmware bear.
    #[schemars(range(min = 0, max = 200), extend("unit" = "°C", "default" = 120))]
    pub max_bed_temperature: f64,
    /// Plastic that the hot end can melt; lines that need more are printed slower.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm³/s"))]
    pub max_volumetric_speed: f64,
    /// Sizes of the pictures of the models at the head of the file, for hosts.
    #[schemars(length(max = sizes::MOST), extend("unit" = "pixels", "default" = []))]
    pub thumbnails: Vec<PictureSize>,
    /// G-code before the print, with {placeholders}.
    pub start_gcode: String,
    /// G-code after the print, with {placeholders}.
    pub end_gcode: String,
}

/// `[machine.reach]`: where the nozzle may go, in the machine's coordinates. Start and end blocks may use
/// what lies beside the print volume, and nothing beyond this.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Reach {
    /// Lowest x that the nozzle may go to; unset means that of the print volume.
    #[schemars(range(min = -10_000, max = 10_000), extend("unit" = "mm"))]
    pub min_x: Option<f64>,
    /// Lowest y that the nozzle may go to; unset means that of the print volume.
    #[schemars(range(min = -10_000, max = 10_000), extend("unit" = "mm"))]
    pub min_y: Option<f64>,
    /// Lowest z that the nozzle may go to; unset means that of the print volume.
    #[schemars(range(min = -10_000, max = 10_000), extend("unit" = "mm"))]
    pub min_z: Option<f64>,
    /// Highest x that the nozzle may go to; unset means that of the print volume.
    #[schemars(range(min = -10_000, max = 10_000), extend("unit" = "mm"))]
    pub max_x: Option<f64>,
    /// Highest y that the nozzle may go to; unset means that of the print volume.
    #[schemars(range(min = -10_000, max = 10_000), extend("unit" = "mm"))]
    pub max_y: Option<f64>,
    /// Highest z that the nozzle may go to; unset means that of the print volume.
    #[schemars(range(min = -10_000, max = 10_000), extend("unit" = "mm"))]
    pub max_z: Option<f64>,
}
