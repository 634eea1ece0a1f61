//! Settings -> PlanParams: the numbers of the plan stage.

use crate::profile::{RetractWhen, Seam, Settings, WallOrder};
use crate::units::{Bounded as _, Coord, UNITS_PER_MM, to_units};

/// The numbers that the plan stage needs.
#[derive(Debug, Clone)]
pub struct PlanParams {
    /// The outer wall comes before the inner ones.
    pub(super) outer_first: bool,
    /// Walls begin at their rearmost point, not at the nearest.
    pub(super) seam_rear: bool,
    /// Every travel retracts that is long enough, not only those that leave the part.
    pub(super) retract_always: bool,
    /// Shorter travels never retract, grid units.
    pub(super) min_travel: Coord,
    /// Filament is pulled back at all.
    pub(super) retracts: bool,
    /// How long travels take.
    pub(super) times: Times,
}

impl PlanParams {
    /// The numbers that `settings` mean for this stage.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        Self {
            outer_first: settings.wall_order == WallOrder::OuterFirst,
            seam_rear: settings.seam == Seam::Rear,
            retract_always: settings.retraction.when == RetractWhen::Always,
            min_travel: to_units(settings.retraction.min_travel),
            retracts: settings.retraction.length > 0.0,
            times: Times {
                feed: settings.speed.travel / 60.0 * UNITS_PER_MM,
                acceleration: settings.limits.travel_acceleration * UNITS_PER_MM,
                retraction: 120.0 * settings.retraction.length / settings.retraction.feed,
            },
        }
    }
}

/// How long travels take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Times {
    /// Feed, grid units per s.
    pub(super) feed: f64,
    /// Acceleration, grid units per s².
    pub(super) acceleration: f64,
    /// Pulling the filament back and pushing it again, s.
    pub(super) retraction: f64,
}

impl Times {
    /// Time of a travel over `distance` grid units from stop to stop, s.
    pub(super) fn travel(&self, distance: f64) -> f64 {
        let Self { feed, acceleration, .. } = *self;
        if distance * acceleration < feed * feed {
            2.0 * (distance / acceleration).sqrt()
        } else {
            distance / feed + feed / acceleration
        }
    }

    /// How far a travel of `time` s leads at most, grid units.
    pub(super) fn reach(&self, time: f64) -> f64 {
        (self.acceleration * time * time / 4.0).at_most(self.feed * time)
    }
}
