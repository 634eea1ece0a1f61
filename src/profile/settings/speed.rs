//! `[speed]`: how fast the nozzle moves.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[speed]`: how fast the nozzle moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Speed {
    /// Speed of walls.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 27))]
    pub wall: f64,
    /// Speed of the outermost wall; unset means speed.wall.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s"))]
    pub outer_wall: Option<f64>,
    /// Speed of the walls inside it; unset means speed.wall.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s"))]
    pub inner_wall: Option<f64>,
    /// Speed of closed walls shorter than small_loop_length, of the speeds above: a small loop has
    /// no time to cool and is all turns.
    #[schemars(range(min = 1, max = 100), extend("unit" = "%", "default" = 80))]
    pub small_loop: f64,
    /// Closed walls shorter than this are small loops: 15 mm go around a hole of 4.8 mm.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm", "default" = 15))]
    pub small_loop_length: f64,
    /// Speed of skins.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 50))]
    pub skin: f64,
    /// Speed of skin that is seen from above; unset means speed.skin.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s"))]
    pub top_skin: Option<f64>,
    /// Speed of beads along gaps that no line of skin reaches; unset means that of the skin.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s"))]
    pub gap: Option<f64>,
    /// Speed of walls that hang over nothing with their whole width. From half the width on they
    /// slow down towards it; 0 prints them as any wall.
    #[schemars(range(min = 0, max = 999), extend("unit" = "mm/s", "default" = 15))]
    pub overhang: f64,
    /// Speed of bridges.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 25))]
    pub bridge: f64,
    /// Speed at which tops are ironed.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 15))]
    pub ironing: f64,
    /// Speed of skin that follows a slope, at most: the z axis may allow less.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 20))]
    pub nonplanar: f64,
    /// Speed of sparse infill that is one layer high.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 60))]
    pub infill: f64,
    /// Speed of sparse infill that is several layers high.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 60))]
    pub thick_infill: f64,
    /// Speed of support.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 50))]
    pub support: f64,
    /// Speed of a raft's base, on the bed; no first-layer speed lowers it but for the highest.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 15))]
    pub raft_base: f64,
    /// Speed of the layers of a raft above its base.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 30))]
    pub raft_interface: f64,
    /// Speed in x and y of moves that print nothing.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 90))]
    pub travel: f64,
    /// Speed of moves in z.
    #[schemars(range(min = 0.1, max = 100), extend("unit" = "mm/s", "default" = 10))]
    pub z: f64,
    /// Speed on the first layer, of the speeds above but for travel and z.
    #[schemars(range(min = 1, max = 200), extend("unit" = "%", "default" = 50))]
    pub first_layer: f64,
    /// Highest speed on the first layer, but for travel and z.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 50))]
    pub first_layer_max: f64,
}
