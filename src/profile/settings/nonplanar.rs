//! `[nonplanar]`: top skins that follow the surface.

use crate::profile::choices::Directions;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[nonplanar]`: skins of gentle slopes follow the surface, instead of climbing it in steps. How fast
/// says `speed.nonplanar`; what the nozzle and what hangs beside it may touch says `[head]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NonPlanar {
    /// Whether skins follow the surface where the head touches nothing.
    #[schemars(extend("default" = false))]
    pub enabled: bool,
    /// Skins one above the other, each a layer high.
    #[schemars(range(min = 1, max = 10), extend("unit" = "skins", "default" = 2))]
    pub skins: u32,
    /// Directions of their lines from the x axis, from the lowest skin upwards; the last one is seen. auto
    /// takes the mean steepest slope for the last skin, and across it for those below by turns.
    #[schemars(extend("unit" = "degrees", "default" = [0, 90]))]
    pub directions: Directions,
    /// Distance between the lines of a skin, and their width. Across a slope each line is a step above the
    /// one before it: nearer lines make lower steps.
    #[schemars(range(min = 0.5, max = 1.5), extend("unit" = "line widths", "default" = 0.9))]
    pub spacing: f64,
    /// Flatter places stay level.
    #[schemars(range(min = 0.05, max = 45), extend("unit" = "degrees", "default" = 0.5))]
    pub min_slope: f64,
    /// A skin ends where the surface bends by more than this over an edge of the mesh.
    #[schemars(range(min = 1, max = 90), extend("unit" = "degrees", "default" = 30))]
    pub max_bend: f64,
    /// Smaller places are printed level.
    #[schemars(range(min = 0, max = 10_000), extend("unit" = "mm²", "default" = 20))]
    pub min_area: f64,
    /// Lines along the edge of a skin, on the surface.
    #[schemars(range(min = 0, max = 10), extend("unit" = "lines", "default" = 0))]
    pub wall: u32,
    /// How far a straight line may leave the surface.
    #[schemars(range(min = 0.001, max = 0.1), extend("unit" = "mm", "default" = 0.005))]
    pub tolerance: f64,
    /// Longest straight line on a surface that bends along it.
    #[schemars(range(min = 0.1, max = 50), extend("unit" = "mm", "default" = 2))]
    pub segment: f64,
    /// How far above all that stands under its way the nozzle travels to a skin and over it.
    #[schemars(range(min = 0, max = 10), extend("unit" = "mm", "default" = 0.5))]
    pub clearance: f64,
    /// Whether the lines of tops that no skin can follow rise and fall within their own layer.
    #[schemars(extend("default" = true))]
    pub contour: bool,
    /// Least height of a line that falls within its layer.
    #[schemars(range(min = 0.02, max = 1), extend("unit" = "mm", "default" = 0.06))]
    pub min_height: f64,
}
