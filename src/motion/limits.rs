//! Settings -> Limits: what a machine's planner holds itself to.

use crate::profile::{JunctionRule, Settings};
use crate::units::Bounded as _;

/// What a machine's planner holds itself to. Arrays are x, y, z, e.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// Highest speed of each axis, mm/s.
    pub feed: [f64; 4],
    /// Highest acceleration of each axis, mm/s². A move along several axes gets
    /// what leaves each within its own. With [`Junction::SquareCorner`] only z has
    /// one.
    pub acceleration: [f64; 4],
    /// Acceleration along the path of moves that extrude, mm/s².
    pub print_acceleration: f64,
    /// Acceleration along the path of moves that do not extrude, mm/s².
    pub travel_acceleration: f64,
    /// Acceleration of moves of the filament alone, mm/s².
    pub retract_acceleration: f64,
    /// How fast a corner may be taken.
    pub junction: Junction,
    /// Blocks that the planner knows of at a time: the oldest one's plan is final
    /// when so many are there, with the youngest ending at rest. `None` is the
    /// whole file. [`Junction::SquareCorner`] always takes the whole file.
    pub look_ahead: Option<usize>,
    /// No corner need be slower than this, mm/s.
    pub minimum_speed: f64,
}

/// How fast the corner between two moves may be taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Junction {
    /// Marlin's classic jerk: the sudden change of speed that each axis bears, mm/s.
    /// An axis that turns back may come in and leave at its jerk. Moves begin
    /// and end at rest with the same sudden change.
    Jerk([f64; 4]),
    /// The jerk of Marlin before 1.1 and of `CuraEngine`'s estimates: the sudden change of
    /// speed in x and y as one vector, and in z, mm/s. Where x and y bear different ones,
    /// each counts in its direction. Simpler than theirs in three things: both moves pass
    /// the corner at one speed, moves begin and end at rest at the minimum speed, and the
    /// filament counts only beside moves of it alone. With no jerk it stops the nozzle there.
    VectorJerk([f64; 4]),
    /// Sailfish's "maximum speed change" of each axis, mm/s: the corner is slowed down by
    /// the share that each axis changes its speed too much. Moves begin and end at rest
    /// at the minimum speed.
    SpeedChange([f64; 4]),
    /// Marlin's junction deviation: how far a corner's arc would be from the corner, mm.
    Deviation(f64),
    /// Klipper's rule.
    SquareCorner {
        /// Speed through a corner of 90°, mm/s.
        velocity: f64,
        /// Part of a move, 0 to below 1, that must be left for cruising: what is
        /// gained by speeding up for a moment only is not worth the shaking.
        minimum_cruise_ratio: f64,
        /// Sudden change of the filament's speed that is allowed, mm/s.
        extruder_corner_velocity: f64,
    },
}

/// Least limit that is used, mm/s or mm/s²: a limit of 0 would stop the clock.
const LEAST: f64 = 1e-3;

/// Least jerk that is used, mm/s: no jerk at all would divide by 0.
pub(super) const LEAST_JERK: f64 = 1e-12;

/// [`Limits`] with what every move needs precomputed, so that a clock can change from one to another
/// at no cost.
#[derive(Debug, Clone)]
pub struct Rates {
    pub(super) limits: Limits,
    /// 1 / feed.
    feed_inverse: [f64; 4],
    /// 1 / acceleration; 0 where an axis has no limit of its own.
    acceleration_inverse: [f64; 4],
    /// 1 / jerk.
    pub(super) jerk_inverse: [f64; 4],
    /// How far a corner's arc would be from the corner, mm.
    pub(super) deviation: f64,
    /// Klipper's acceleration for short sprints, mm/s². It is a part of the machine's,
    /// so that moves which an axis holds back to less have nothing to lose.
    pub(super) sprint: f64,
    /// Klipper has one acceleration for x and y, which commands may raise, a limit of its own for z, and
    /// limits of the filament only where it moves alone.
    is_klipper: bool,
}

impl Limits {
    /// The limits of the machine that these settings are for.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let limits = &settings.limits;
        let jerk = [limits.jerk_x, limits.jerk_y, limits.jerk_z, limits.jerk_e];
        Self {
            feed: [limits.speed_x, limits.speed_y, limits.speed_z, limits.speed_e],
            acceleration: [
                limits.acceleration_x,
                limits.acceleration_y,
                limits.acceleration_z,
                limits.acceleration_e,
            ],
            print_acceleration: settings.machine.acceleration,
            // Klipper has one for all moves.
            travel_acceleration: match limits.junction {
                JunctionRule::SquareCorner => settings.machine.acceleration,
                _ => limits.travel_acceleration,
            },
            retract_acceleration: settings.retract_acceleration(),
            junction: match limits.junction {
                JunctionRule::Jerk => Junction::Jerk(jerk),
                JunctionRule::VectorJerk => Junction::VectorJerk(jerk),
                JunctionRule::SpeedChange => Junction::SpeedChange(jerk),
                JunctionRule::Deviation => Junction::Deviation(limits.junction_deviation),
                JunctionRule::SquareCorner => Junction::SquareCorner {
                    velocity: limits.square_corner_velocity,
                    minimum_cruise_ratio: limits.minimum_cruise_ratio,
                    extruder_corner_velocity: limits.extruder_corner_velocity,
                },
            },
            look_ahead: (limits.look_ahead > 0).then_some(limits.look_ahead as usize),
            minimum_speed: limits.minimum_speed,
        }
    }
}

impl Rates {
    /// What `limits` mean for each move.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        let inverse = |values: [f64; 4]| values.map(|value| 1.0 / value.max(LEAST));
        let deviation = match limits.junction {
            Junction::Jerk(_) | Junction::VectorJerk(_) | Junction::SpeedChange(_) => 0.0,
            Junction::Deviation(deviation) => deviation.max(0.0),
            Junction::SquareCorner { velocity, .. } => {
                let root_of_two = std::f64::consts::SQRT_2;
                velocity * velocity * (root_of_two - 1.0) / limits.print_acceleration.max(LEAST)
            }
        };
        let sprint = match limits.junction {
            Junction::SquareCorner { minimum_cruise_ratio, .. } => {
                limits.print_acceleration.max(LEAST) * (1.0 - minimum_cruise_ratio)
            }
            _ => f64::INFINITY,
        };
        let is_klipper = matches!(limits.junction, Junction::SquareCorner { .. });
        let mut acceleration_inverse = inverse(limits.acceleration);
        if is_klipper {
            let [x, y, _, e] = &mut acceleration_inverse;
            (*x, *y, *e) = (0.0, 0.0, 0.0);
        }
        Self {
            sprint,
            jerk_inverse: match limits.junction {
                Junction::Jerk(jerk) | Junction::VectorJerk(jerk) => {
                    jerk.map(|jerk| 1.0 / jerk.max(LEAST_JERK))
                }
                _ => [0.0; 4],
            },
            feed_inverse: inverse(limits.feed),
            acceleration_inverse,
            deviation,
            is_klipper,
            limits,
        }
    }

    /// Speed (mm/s) and acceleration (mm/s²) along the path of a move of this length, mm.
    pub(super) fn of_move(&self, delta: &[f64; 4], distance: f64, feed: f64) -> (f64, f64) {
        let limits = &self.limits;
        let moves_nozzle = moves_nozzle(delta);
        let wanted = if !moves_nozzle && self.is_klipper {
            limits.retract_acceleration.at_most(limits.print_acceleration)
        } else if !moves_nozzle {
            limits.retract_acceleration
        } else if delta[3] == 0.0 {
            limits.travel_acceleration
        } else {
            limits.print_acceleration
        };
        let axes = if moves_nozzle && self.is_klipper { 3 } else { 4 };
        let (mut slowest, mut laziest) = (0.0_f64, 0.0_f64);
        for (axis, length) in delta.iter().enumerate().take(axes) {
            let length = length.abs();
            slowest = slowest.at_least(length * self.feed_inverse[axis]);
            laziest = laziest.at_least(length * self.acceleration_inverse[axis]);
        }
        // `max` replaces a NaN where numbers come in: behind it all are numbers.
        let speed = feed.max(LEAST).at_most(distance / slowest);
        (speed, wanted.max(LEAST).at_most(distance / laziest))
    }
}

/// Whether more than the filament moves.
pub(super) fn moves_nozzle(delta: &[f64; 4]) -> bool {
    delta[0] != 0.0 || delta[1] != 0.0 || delta[2] != 0.0
}
