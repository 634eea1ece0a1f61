//! Moves of a layer + cap on its outer walls -> Moves that take the least time, no more slowly than needed.
//!
//! Acceleration makes times uneven, so that no sum tells how slow is slow enough: the clock does. It
//! runs over the layer again and again, with caps halfway between what is enough and what is not,
//! until they are one mm/min apart.
//!
//! A layer is timed between layers that end and begin as it does ([`times::between_its_likes`]): those
//! beside it, whose feeds change as well, then have no part in it. All layers begin with a lift or a
//! retraction, before which every planner all but stops, so that it makes little difference
//! ([`MARGIN`]).

use super::times;
use crate::fill::{RoleTable, Slows};
use crate::gcode::drive::Drives;
use crate::gcode::flow::{feed, whole_feed};
use crate::gcode::moves::{Kind, Moves};
use crate::motion::Limits;
use crate::profile::Settings;

/// Added to the least time, s: twice what the corners at a layer's ends save in the print at most, by
/// Sailfish's rule, whose corners depend on the one before. Far less than anyone sees.
const MARGIN: f64 = 0.05;

/// No cap on a feed.
pub(super) const NO_CAP: u32 = u32::MAX;

/// The highest feed of each kind of line, mm/min, in the order of [`Slows`].
type Caps = [u32; 3];

/// What a layer needs, whatever those beside it do.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Need {
    /// It takes less than the least time.
    pub(super) quick: bool,
    /// The cap that it needs on its outer walls, mm/min; [`NO_CAP`] if what is inside does.
    pub(super) cap: u32,
    /// Its time, if that was worth a look, s.
    pub(super) seconds: Option<f64>,
}

/// How a layer was slowed down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slowed {
    /// It was quick.
    pub(super) quick: bool,
    /// For each kind, the lowest share of its feed that a line was left.
    pub(super) lowest: [f64; 3],
    /// The nozzle waits at its end.
    pub(super) waits: bool,
}

impl Slowed {
    /// Once it was slowed down again, in the way of `next`.
    pub(super) fn then(&mut self, next: &Self) {
        self.quick |= next.quick;
        for (mine, theirs) in self.lowest.iter_mut().zip(&next.lowest) {
            *mine *= theirs;
        }
    }
}

/// Slows down layers.
#[derive(Debug, Clone)]
pub(super) struct Slowing {
    limits: Limits,
    drives: Option<Drives>,
    /// The time that a layer has to take, s.
    pub(super) least: f64,
    /// No line is slowed down below this, mm/min.
    slowest: u32,
    kinds: RoleTable<usize>,
    /// Cross-section of the filament, mm².
    area: f64,
}

impl Slowing {
    pub(super) fn new(settings: &Settings) -> Self {
        let least = settings.cooling.min_layer_time;
        Self {
            limits: Limits::new(settings),
            drives: Drives::new(settings),
            least: if least > 0.0 { least + MARGIN } else { 0.0 },
            slowest: whole_feed(feed(settings.cooling.min_speed)),
            kinds: RoleTable::new(|role| role.facts().slows as usize),
            area: settings.filament_area(),
        }
    }

    /// What a layer takes, s.
    pub(super) fn seconds(&self, layer: &Moves) -> f64 {
        times::between_its_likes(layer, &self.limits, self.drives.as_ref())
    }

    /// What a layer needs.
    pub(super) fn need(&self, layer: &Moves) -> Need {
        let none = Need { quick: false, cap: NO_CAP, seconds: None };
        if self.is_long(layer) {
            return none;
        }
        let mut layer = layer.clone();
        let mut trial = Trial::new(self, &mut layer);
        let seconds = trial.seconds([NO_CAP; 3]);
        let seen = Slows::Last as usize;
        let inside = self.slowest;
        if seconds >= self.least {
            return Need { seconds: Some(seconds), ..none };
        }
        let need = Need { quick: true, seconds: Some(seconds), ..none };
        let fastest = trial.fastest[seen];
        if fastest <= self.slowest || trial.is_enough([inside, inside, NO_CAP]) {
            return need;
        }
        let cap = highest(self.slowest, fastest, |cap| trial.is_enough([inside, inside, cap]));
        Need { cap, ..need }
    }

    /// Slows down a layer whose outer walls have the cap of its group.
    pub(super) fn slow(&self, layer: &mut Moves, need: &Need, cap: u32) -> Slowed {
        let untouched = Slowed { quick: need.quick, lowest: [1.0; 3], waits: false };
        if !need.quick && cap == NO_CAP {
            return untouched;
        }
        let mut trial = Trial::new(self, layer);
        let mut caps = [NO_CAP, NO_CAP, cap];
        if need.quick {
            caps = trial.inside(caps);
        }
        Slowed { lowest: trial.settle(caps), ..untouched }
    }

    /// Slows down what is inside a layer until it takes `seconds`, if it can.
    pub(super) fn slow_to(&self, layer: &mut Moves, seconds: f64) -> Slowed {
        let mut trial = Trial { least: seconds, ..Trial::new(self, layer) };
        let caps = trial.inside([NO_CAP; 3]);
        Slowed { quick: true, lowest: trial.settle(caps), waits: false }
    }

    /// Whether a layer takes the least time even without speeding up and slowing down.
    fn is_long(&self, layer: &Moves) -> bool {
        let mut minutes = 0.0;
        // What coordinates are rounded by may make a line shorter.
        let enough = 1.01 * self.least / 60.0;
        layer.moves.iter().any(|step| {
            minutes += step.length / f64::from(step.feed);
            minutes >= enough
        }) || self.least <= 0.0
    }
}

/// A layer that is tried with one set of caps after another.
struct Trial<'a> {
    slowing: &'a Slowing,
    layer: &'a mut Moves,
    /// The feeds without caps, mm/min.
    asked: Vec<u32>,
    /// The highest of each kind.
    fastest: Caps,
    /// The time that it has to take, s.
    least: f64,
}

impl<'a> Trial<'a> {
    fn new(slowing: &'a Slowing, layer: &'a mut Moves) -> Self {
        let asked = layer.moves.iter().map(|step| step.feed).collect();
        let mut fastest = [0; 3];
        for step in &layer.moves {
            if let Kind::Extrude(bead) = step.kind {
                let kind = slowing.kinds[bead.role];
                fastest[kind] = step.feed.max(fastest[kind]);
            }
        }
        Self { slowing, layer, asked, fastest, least: slowing.least }
    }

    /// Caps the feeds. Lines that are slower than any cap may be stay as they are.
    fn set(&mut self, caps: Caps) {
        let kinds = &self.slowing.kinds;
        let caps = caps.map(|cap| cap.max(self.slowing.slowest));
        for (step, &asked) in self.layer.moves.iter_mut().zip(&self.asked) {
            if let Kind::Extrude(bead) = step.kind {
                step.feed = asked.min(caps[kinds[bead.role]]);
            }
        }
    }

    fn seconds(&mut self, caps: Caps) -> f64 {
        self.set(caps);
        self.slowing.seconds(self.layer)
    }

    /// `caps` with lower ones on what is inside, if that is not slow enough: infill and skins first, no
    /// lower than needed.
    fn inside(&mut self, mut caps: Caps) -> Caps {
        if self.is_enough(caps) {
            return caps;
        }
        let slowest = self.slowing.slowest;
        for kind in [Slows::First, Slows::Second].map(|kind| kind as usize) {
            let fastest = self.fastest[kind];
            caps[kind] = slowest;
            if fastest > slowest && self.is_enough(caps) {
                caps[kind] = highest(slowest, fastest, |cap| {
                    caps[kind] = cap;
                    self.is_enough(caps)
                });
                break;
            }
        }
        caps
    }

    fn is_enough(&mut self, caps: Caps) -> bool {
        self.seconds(caps) >= self.least
    }

    /// Leaves the layer with these caps. Returns, for each kind, the lowest share of its feed that a
    /// line is left.
    fn settle(mut self, caps: Caps) -> [f64; 3] {
        self.set(caps);
        self.layer.slowed(self.slowing.area);
        self.lowest()
    }

    /// For each kind, the lowest share of its feed that a line is left.
    fn lowest(&self) -> [f64; 3] {
        let mut lowest: [f64; 3] = [1.0; 3];
        for (step, &asked) in self.layer.moves.iter().zip(&self.asked) {
            if let Kind::Extrude(bead) = step.kind {
                let kind = self.slowing.kinds[bead.role];
                lowest[kind] = lowest[kind].min(f64::from(step.feed) / f64::from(asked));
            }
        }
        lowest
    }
}

/// The highest cap that is enough, between one that is, or is the lowest there is, and one that is not.
fn highest(mut low: u32, mut high: u32, mut is_enough: impl FnMut(u32) -> bool) -> u32 {
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if is_enough(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_highest_cap_that_is_enough_is_found() {
        for limit in [600, 601, 777, 3598, 3599] {
            assert_eq!(highest(600, 3600, |cap| cap <= limit), limit);
        }
        assert_eq!(highest(600, 3600, |_| false), 600);
        assert_eq!(highest(600, 601, |_| true), 600);
    }
}
