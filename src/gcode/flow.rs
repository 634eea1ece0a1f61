//! Bead + requested feed -> feed: lowers a feed that needs more plastic than the hot end can melt.

use crate::fill::{Both, Role, RoleTable};
use crate::profile::Settings;
use crate::units::nearest;

/// Relative tolerance of the limit. A feed exactly at the limit may exceed it by the rounding of
/// floats, about 1e-15; it must not be lowered for that. Anything far above that rounding and
/// far below one mm/min in the fastest feed does.
const SLACK: f64 = 1e-9;

/// Feeds lowered by a smaller part than this are not reported. Widths differ by a few per cent
/// from line to line; without a threshold nearly every print near the limit warns. It changes
/// the report only, never a feed.
const REPORT_THRESHOLD: f64 = 0.05;

/// The limit of what the hot end can melt.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlowLimit {
    /// The largest flow, mm³/s.
    most: f64,
    /// Cross-section of the filament, mm².
    area: f64,
}

impl FlowLimit {
    pub(super) fn new(settings: &Settings) -> Self {
        Self { most: settings.max_volumetric_speed(), area: settings.filament_area() }
    }

    /// Whether it is what holds a feed of whole mm/min down: one more, and `filament` mm for each mm of
    /// path would not melt.
    pub(super) fn holds(self, filament: f64, feed: u32) -> bool {
        f64::from(feed + 1) * filament * self.area / 60.0 > self.most * (1.0 + SLACK)
    }

    /// The feed (mm/min) and the flow (mm³/s) of a bead that takes `filament` mm for each mm of
    /// path: the feed `asked` for, clamped to the highest at which the filament melts.
    pub(super) fn feed(self, filament: f64, asked: f64) -> (u32, f64) {
        // mm³/s for each mm/min.
        let flow = filament * self.area / 60.0;
        let whole = whole_feed(asked);
        let feed = if f64::from(whole) * flow > self.most * (1.0 + SLACK) {
            // Rounded down, since it is a limit.
            (self.most / flow).floor().max(1.0) as u32
        } else {
            whole
        };
        (feed, f64::from(feed) * flow)
    }
}

/// A speed, mm/s, as a feed, mm/min.
pub(super) fn feed(speed: f64) -> f64 {
    60.0 * speed
}

/// A feed as a speed, mm/s, for people.
#[must_use]
pub fn speed(feed: u32) -> f64 {
    f64::from(feed) / 60.0
}

/// A feed as it is written: the nearest whole mm/min.
pub(super) fn whole_feed(feed: f64) -> u32 {
    nearest(feed).max(1) as u32
}

/// The feeds of a role that the flow limit lowered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lowered {
    /// The highest requested feed, mm/min.
    pub asked: u32,
    /// The lowest feed after the limit, mm/min.
    pub given: u32,
}

/// The largest flow, and which roles the flow limit slowed down.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Flows {
    /// The largest flow, mm³/s.
    pub largest: f64,
    /// The feeds that were lowered, where that is worth a report.
    pub lowered: RoleTable<Both<Option<Lowered>>>,
}

impl Flows {
    /// Notes a bead's flow, and its feeds if the limit lowered them.
    pub(super) fn note(&mut self, role: Role, thick: bool, flow: f64, feeds: Lowered) {
        self.largest = self.largest.max(flow);
        if f64::from(feeds.given) < (1.0 - REPORT_THRESHOLD) * f64::from(feeds.asked) {
            merge(self.lowered[role].of_mut(thick), Some(feeds));
        }
    }

    /// Adds another layer's flows.
    pub fn add(&mut self, other: &Self) {
        self.largest = self.largest.max(other.largest);
        for (role, theirs) in other.lowered.iter() {
            for (thick, theirs) in theirs.iter() {
                merge(self.lowered[role].of_mut(thick), *theirs);
            }
        }
    }
}

fn merge(mine: &mut Option<Lowered>, theirs: Option<Lowered>) {
    *mine = match (*mine, theirs) {
        (Some(a), Some(b)) => {
            Some(Lowered { asked: a.asked.max(b.asked), given: a.given.min(b.given) })
        }
        (a, b) => a.or(b),
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_feed_is_lowered_to_the_flow_limit_and_no_further() {
        // A square of 1 mm², so that a mm of filament is a mm³.
        let limit = FlowLimit { most: 10.0, area: 1.0 };
        assert_eq!(limit.feed(0.1, 6000.0), (6000, 10.0));
        assert_eq!(limit.feed(0.1, 6001.0).0, 6000);
        assert_eq!(limit.feed(0.7, 6000.0).0, 857);
        assert_eq!(limit.feed(0.0, 0.2), (1, 0.0));
    }

    #[test]
    fn the_highest_requested_and_the_lowest_final_feed_are_kept() {
        let mut flows = Flows::default();
        flows.note(Role::Infill, true, 5.0, Lowered { asked: 3600, given: 3000 });
        flows.note(Role::Infill, true, 4.0, Lowered { asked: 1800, given: 1800 });
        flows.note(Role::Skin, false, 4.0, Lowered { asked: 1800, given: 1750 });
        let mut all = flows.clone();
        all.note(Role::Infill, true, 6.0, Lowered { asked: 4000, given: 3500 });
        flows.add(&all);
        assert_eq!(flows.largest, 6.0);
        assert_eq!(flows.lowered[Role::Infill].thick, Some(Lowered { asked: 4000, given: 3000 }));
        let thin = flows.lowered.iter().filter(|(_, both)| both.thin.is_some());
        assert_eq!(thin.count(), 0);
    }
}
