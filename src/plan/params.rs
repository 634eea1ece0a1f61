//! Settings -> PlanParams: converts the settings that the plan stage needs.

use super::detour::DetourParams;
use crate::profile::{RetractWhen, Seam, SeamInner, Settings, TravelOrder, WallOrder};
use crate::units::{Bounded as _, Coord, UNITS_PER_MM, to_units};

/// How far seams are moved sideways, in line widths: further than a seam's own bulge is wide, and not so
/// far that the way to the next wall shows.
const STAGGER: f64 = 4.0;

/// The settings that the plan stage needs.
#[derive(Debug, Clone)]
pub struct PlanParams {
    /// Paths are printed as the model file has them, not the nearest first.
    pub(super) as_listed: bool,
    /// The outer wall is printed before the inner walls.
    pub(super) outer_first: bool,
    /// Where walls begin.
    pub(super) seam: Seam,
    /// How far the seam of every other wall is moved along it, grid units.
    pub(super) stagger: Coord,
    /// How far a closed wall ends before its beginning, grid units.
    pub(super) seam_gap: Coord,
    /// How far the nozzle goes on once an outer wall is closed, grid units.
    pub(super) seam_wipe: Coord,
    /// All travels of at least `min_travel` retract, not only those that leave the part.
    pub(super) retract_always: bool,
    /// Travels shorter than this never retract, grid units.
    pub(super) min_travel: Coord,
    /// Longer travels retract wherever they go, grid units; `None` without a limit.
    pub(super) max_travel: Option<Coord>,
    /// For travels that go round what they would cross; `None` if all go straight.
    pub(super) detour: Option<DetourParams>,
    /// How far the nozzle goes over the last line after a retraction, grid units.
    pub(super) wipe: Coord,
    /// The retraction length is above zero.
    pub(super) retracts: bool,
    /// For the time of travels.
    pub(super) times: Times,
}

impl PlanParams {
    /// Converts `settings`.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        Self {
            as_listed: settings.travel.order == TravelOrder::File,
            outer_first: settings.wall_order == WallOrder::OuterFirst,
            seam: settings.seam,
            stagger: match settings.seam_inner {
                SeamInner::Aligned => 0,
                SeamInner::Staggered => to_units(STAGGER * settings.line_width),
            },
            seam_gap: to_units(settings.seam_gap),
            seam_wipe: to_units(settings.seam_wipe),
            retract_always: settings.retraction.when == RetractWhen::Always,
            min_travel: to_units(settings.retraction.min_travel),
            max_travel: Some(to_units(settings.retraction.max_travel)).filter(|&most| most > 0),
            detour: detour(settings),
            wipe: to_units(settings.retraction.wipe),
            retracts: settings.retraction.length > 0.0,
            times: Times {
                feed: settings.speed.travel * UNITS_PER_MM,
                acceleration: settings.limits.travel_acceleration * UNITS_PER_MM,
                retraction: 2.0 * settings.retraction.length / settings.retraction.speed,
            },
        }
    }
}

/// Ways lie a line's width inside the contours, where walls are. They come no nearer than a third of
/// that: the outer wall's middle lies at half of it, and travels begin and end there.
fn detour(settings: &Settings) -> Option<DetourParams> {
    let (travel, retraction) = (&settings.travel, &settings.retraction);
    let wanted = travel.avoid_crossing && retraction.when == RetractWhen::Crossing;
    let limit = Some(to_units(retraction.max_travel)).filter(|&most| most > 0);
    wanted.then(|| DetourParams {
        most_more: to_units(travel.max_detour),
        longest: limit.unwrap_or(Coord::MAX),
        rail: to_units(settings.line_width),
        clearance: to_units(settings.line_width / 3.0),
    })
}

/// Estimates the time of travels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Times {
    /// Feed, grid units per s.
    pub(super) feed: f64,
    /// Acceleration, grid units per s².
    pub(super) acceleration: f64,
    /// Time of a retraction and of restoring the filament, s.
    pub(super) retraction: f64,
}

impl Times {
    /// Time of a travel over `distance` grid units that starts and ends at rest, s.
    pub(super) fn travel(&self, distance: f64) -> f64 {
        let Self { feed, acceleration, .. } = *self;
        if distance * acceleration < feed * feed {
            2.0 * (distance / acceleration).sqrt()
        } else {
            distance / feed + feed / acceleration
        }
    }

    /// An upper bound for the length of a travel that takes `time` s, grid units.
    pub(super) fn reach(&self, time: f64) -> f64 {
        (self.acceleration * time * time / 4.0).at_most(self.feed * time)
    }
}
