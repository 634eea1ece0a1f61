//! Move + Rates -> Block: a move's length, speed and acceleration, and how fast it may begin.

use super::limits::{Rates, moves_nozzle};
use super::{Junction, Move};
use crate::units::Bounded as _;

/// What a corner's rule needs of the move before and the move after it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    /// Change of each axis per mm of path.
    pub(super) direction: [f64; 4],
    /// Length of the path, mm.
    pub(super) distance: f64,
    /// Speed where nothing holds it back, mm/s.
    pub(super) cruise: f64,
    /// Acceleration along the path, mm/s².
    pub(super) acceleration: f64,
    /// Speed at which it may begin from rest and end at rest, mm/s.
    pub(super) rest: f64,
    /// Whether more than the filament moves.
    pub(super) moves_nozzle: bool,
    /// [`Junction::SpeedChange`]: by how much the corner before it was slowed down.
    pub(super) slowed: f64,
    /// See [`Rates::deviation`].
    pub(super) deviation: f64,
}

impl Course {
    /// `None` for a move whose length is 0 or not finite.
    pub(super) fn new<T>(given: &Move<T>, rates: &Rates) -> Option<Self> {
        let [x, y, z, e] = given.delta;
        let moves_nozzle = moves_nozzle(&given.delta);
        let distance = if moves_nozzle { (x * x + y * y + z * z).sqrt() } else { e.abs() };
        if !(distance > 0.0 && distance.is_finite() && e.is_finite()) {
            return None;
        }
        let (cruise, acceleration) = rates.of_move(&given.delta, distance, given.feed.0);
        let per_mm = 1.0 / distance;
        let direction = given.delta.map(|length| length * per_mm);
        let rest = match rates.limits.junction {
            Junction::Jerk(_) => from_rest(&direction, cruise, &rates.jerk_inverse),
            _ => 0.0,
        };
        Some(Self {
            direction,
            distance,
            cruise,
            acceleration,
            rest: rest.at_least(rates.limits.minimum_speed).at_most(cruise),
            moves_nozzle,
            slowed: 1.0,
            deviation: rates.deviation,
        })
    }
}

/// The speed at which a move may start from rest without exceeding any axis's jerk, mm/s.
/// `inverse` is 1 / jerk.
fn from_rest(direction: &[f64; 4], cruise: f64, inverse: &[f64; 4]) -> f64 {
    let mut worst = 0.0_f64;
    for (direction, inverse) in direction.iter().zip(inverse) {
        worst = worst.at_least(direction.abs() * inverse);
    }
    cruise.at_most(1.0 / worst)
}

/// A move in the planner. Speeds are squared, mm²/s²: at constant acceleration
/// the square changes evenly along the path, so that planning needs no roots.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<T> {
    /// Length of the path, mm.
    pub(super) distance: f64,
    /// mm/s².
    pub(super) acceleration: f64,
    /// Most that the squared speed can change within it: 2 · acceleration · distance.
    pub(super) change: f64,
    /// [`Block::change`] by no more than the acceleration for short sprints.
    pub(super) smooth_change: f64,
    /// Highest speed, squared.
    pub(super) cruise: f64,
    /// Speed at which it may end if nothing follows, squared.
    pub(super) rest: f64,
    /// How fast it may begin, by the corner and by what lies before it; squared.
    pub(super) most_entry: f64,
    /// The same with [`Block::smooth_change`].
    pub(super) most_smooth: f64,
    /// How fast it begins by the plan, squared.
    pub(super) entry: f64,
    /// [`Block::entry`] by the slow pass; squared.
    pub(super) smooth: f64,
    /// Returned with the move's time.
    pub(super) tag: T,
}

impl<T> Block<T> {
    /// The block of `course` after a block that may end at `before` (squared), with a
    /// corner that allows `corner` (squared). `sprint` is the acceleration for short sprints, mm/s².
    pub(super) fn new(course: &Course, corner: f64, before: Reach, sprint: f64, tag: T) -> Self {
        let change = 2.0 * course.acceleration * course.distance;
        let most_entry = corner.at_most(before.full);
        Self {
            distance: course.distance,
            acceleration: course.acceleration,
            change,
            smooth_change: change.at_most(2.0 * sprint * course.distance),
            cruise: course.cruise * course.cruise,
            rest: course.rest * course.rest,
            most_entry,
            most_smooth: most_entry.at_most(before.smooth),
            entry: 0.0,
            smooth: 0.0,
            tag,
        }
    }

    /// A move of no length: it takes no time and limits no other move.
    pub(super) fn empty(before: Reach, tag: T) -> Self {
        Self {
            distance: 0.0,
            acceleration: 1.0,
            change: 0.0,
            smooth_change: 0.0,
            cruise: f64::INFINITY,
            rest: 0.0,
            most_entry: before.full,
            most_smooth: before.smooth,
            entry: 0.0,
            smooth: 0.0,
            tag,
        }
    }

    /// How fast it may end, squared.
    pub(super) fn reach(&self) -> Reach {
        Reach {
            full: self.cruise.at_most(self.most_entry + self.change),
            smooth: self.most_smooth + self.smooth_change,
        }
    }
}

/// How fast a block may end, by what lies before and within it; squared.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// With the whole acceleration.
    pub(super) full: f64,
    /// With that for short sprints.
    pub(super) smooth: f64,
}
