//! `[limits]`: what the printer's planner holds itself to.

use crate::profile::choices::JunctionRule;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[limits]`: what the printer's planner holds itself to. It changes no move, only
/// estimates of time. Two keys hold the file itself to it: `max_segment_rate`, and the accelerations of
/// x and y, beyond which `[acceleration]` asks for nothing. `machine.acceleration` is the acceleration
/// of moves that extrude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionLimits {
    /// Highest speed in x.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s"))]
    pub speed_x: f64,
    /// Highest speed in y.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s"))]
    pub speed_y: f64,
    /// Highest speed in z.
    #[schemars(range(min = 0.1, max = 100), extend("unit" = "mm/s"))]
    pub speed_z: f64,
    /// Highest speed of the filament.
    #[schemars(range(min = 0.1, max = 200), extend("unit" = "mm/s"))]
    pub speed_e: f64,
    /// Highest acceleration in x. Klipper has none for x and y alone: there it is max_accel of
    /// printer.cfg, which a file may change.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub acceleration_x: f64,
    /// Highest acceleration in y; for Klipper as acceleration_x.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub acceleration_y: f64,
    /// Highest acceleration in z.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub acceleration_z: f64,
    /// Highest acceleration of the filament.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub acceleration_e: f64,
    /// Acceleration of moves that print nothing, which {travel_acceleration} in the start block stands
    /// for. Klipper has one for all moves, machine.acceleration, unless acceleration.travel is set.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub travel_acceleration: f64,
    /// Acceleration of the filament when it moves alone; 0 is what Klipper takes by itself: the lesser
    /// of acceleration_x and _y, times 4 nozzle², over the area of the filament.
    #[schemars(range(min = 0, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub retract_acceleration: f64,
    /// Rule for the speed at corners: Marlin's jerk, Marlin's jerk before 1.1, Sailfish's
    /// speed change, Marlin's junction deviation, Klipper's square corner velocity.
    pub junction: JunctionRule,
    /// Sudden change of speed in x, for jerk, vector-jerk and speed-change.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 10))]
    pub jerk_x: f64,
    /// Sudden change of speed in y, for jerk, vector-jerk and speed-change.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 10))]
    pub jerk_y: f64,
    /// Sudden change of speed in z, for jerk, vector-jerk and speed-change.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 0.4))]
    pub jerk_z: f64,
    /// Sudden change of the filament's speed, for jerk, vector-jerk and speed-change.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 5))]
    pub jerk_e: f64,
    /// How far an arc would pass from the corner, for deviation.
    #[schemars(range(min = 0, max = 10), extend("unit" = "mm", "default" = 0.013))]
    pub junction_deviation: f64,
    /// Speed through a corner of 90 degrees, for square-corner.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 5))]
    pub square_corner_velocity: f64,
    /// Part of a move that is left for cruising, for square-corner.
    #[schemars(range(min = 0, max = 0.99), extend("unit" = "times", "default" = 0.5))]
    pub minimum_cruise_ratio: f64,
    /// Sudden change of the filament's speed, for square-corner.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 1))]
    pub extruder_corner_velocity: f64,
    /// Moves that the planner knows of at a time; 0 is the whole file.
    #[schemars(range(min = 0, max = 100_000), extend("unit" = "blocks", "default" = 16))]
    pub look_ahead: u32,
    /// Moves that the printer can be fed in a second, over look_ahead of them: where lines are so short
    /// that more would be asked for, they are joined, then slowed down. 0 sets no limit.
    #[schemars(range(min = 0, max = 100_000), extend("unit" = "moves/s", "default" = 0))]
    pub max_segment_rate: f64,
    /// No corner need be slower than this.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 0.05))]
    pub minimum_speed: f64,
}
