//! Two lines that rise differently + Rates -> the highest speed at which z may change between them.
//!
//! It is the rule for corners of [`super::junction`], for a path without corners in plan: what it turns
//! sideways is the planner's own matter.

use super::block::Course;
use super::limits::{LEAST_JERK, Rates};
use super::{Junction, Move, junction};
use crate::units::MmPerS;

/// Filament of a line, mm/mm: any that makes it a line and no travel. It is the same on both sides, so
/// that no change of it counts.
const FILAMENT: f64 = 0.03;

/// The highest speed (mm/s) at which z may change its own where one line follows another: infinite where
/// no rule holds it. `ways` are how far they go in plan and how far they rise, mm; `feed` is theirs.
///
/// By a jerk, of any kind, no axis changes its speed by more than that: speed · change of the sine of
/// the slope ≤ jerk of z. By junction deviation and by Klipper's rule the joint is an arc, and z no
/// faster on it than its acceleration allows.
#[must_use]
pub fn joint(rates: &Rates, ways: [[f64; 2]; 2], feed: MmPerS) -> f64 {
    let course = |[plan, rise]: [f64; 2]| {
        let filament = FILAMENT * (plan * plan + rise * rise).sqrt();
        Course::new(&Move { delta: [plan, 0.0, rise, filament], feed, tag: () }, rates)
    };
    let [Some(before), Some(after)] = ways.map(course) else { return f64::INFINITY };
    match &rates.limits.junction {
        Junction::Jerk(jerk) | Junction::VectorJerk(jerk) | Junction::SpeedChange(jerk) => {
            let inverse = jerk.map(|jerk| 1.0 / jerk.max(LEAST_JERK));
            junction::vector_jerk(&before, &after, &inverse)
        }
        Junction::Deviation(_) => {
            junction::deviation(&before, &after, &rates.limits.acceleration).sqrt()
        }
        Junction::SquareCorner { extruder_corner_velocity, .. } => {
            junction::square_corner(&before, &after, *extruder_corner_velocity).sqrt()
        }
    }
}
