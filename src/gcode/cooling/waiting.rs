//! Moves of a layer -> Moves with a pause at their end: the nozzle waits beside the part.
//!
//! It pulls the filament back, rises, goes beside the layer's lines, stands still, and returns to
//! where it was: the next layer begins as if nothing had been.

use super::slowing::Slowing;
use crate::gcode::flow::{feed, whole_feed};
use crate::gcode::moves::{Kind, Move, Moves};
use crate::profile::Settings;
use crate::units::{Coord, Thousandths, to_units};

/// How far from the lines the nozzle waits, mm: no drop that hangs from it reaches them.
const ASIDE: f64 = 10.0;

/// How far it rises, mm: its heat no longer reaches the layer.
const LIFT: f64 = 2.0;

/// How the nozzle waits.
#[derive(Debug, Clone)]
pub(super) struct Waiting {
    /// The bed on the machine, thousandths of a mm: least and most in x, then in y.
    bed: [[i32; 2]; 2],
    /// The highest that the nozzle may be, grid units.
    top: Coord,
    retract: f64,
    retract_feed: u32,
    travel_feed: u32,
    z_feed: u32,
}

impl Waiting {
    pub(super) fn new(settings: &Settings) -> Self {
        let machine = &settings.machine;
        let [low, high] = machine.volume();
        let side = |axis: usize| [low[axis], high[axis]].map(|mm| (1000.0 * mm) as i32);
        Self {
            bed: [0, 1].map(side),
            top: to_units(machine.bed_height),
            retract: settings.retraction.length,
            retract_feed: whole_feed(feed(settings.retraction.speed)),
            travel_feed: whole_feed(feed(settings.speed.travel)),
            z_feed: whole_feed(feed(settings.speed.z)),
        }
    }

    /// Adds a pause, if the layer takes too little time. Returns whether it did.
    pub(super) fn wait(&self, layer: &mut Moves, slowing: &Slowing) -> bool {
        let Some(&end) = layer.moves.last() else { return false };
        if slowing.seconds(layer) >= slowing.least {
            return false;
        }
        // On a slope the end is not the highest place.
        let up = (end.z.max(layer.highest) + to_units(LIFT)).min(self.top).max(end.z);
        let beside = self.beside(layer).unwrap_or(end.to);
        let go =
            |to, z, kind| Move { to, z, feed: self.travel_feed, length: 0.0, filament: 0.0, kind };
        let length = way(end.to, beside);
        let (pulls, goes) = (self.retract > 0.0, beside != end.to);
        let pull =
            |filament, kind| Move { filament, feed: self.retract_feed, ..go(end.to, end.z, kind) };
        let rise = |z| Move { feed: self.z_feed, ..go(end.to, z, Kind::Z) };
        let travel = |to| Move { length, ..go(to, up, Kind::Travel) };
        layer.moves.extend(pulls.then(|| pull(-self.retract, Kind::Retract)));
        layer.moves.push(rise(up));
        layer.moves.extend(goes.then(|| travel(beside)));
        let pause = layer.moves.len();
        layer.moves.push(go(beside, up, Kind::Wait(0)));
        layer.moves.extend(goes.then(|| travel(end.to)));
        layer.moves.push(rise(end.z));
        layer.moves.extend(pulls.then(|| pull(self.retract, Kind::Restore)));
        let rest = (slowing.least - slowing.seconds(layer)).max(0.0);
        layer.moves[pause].kind = Kind::Wait((1000.0 * rest).ceil() as u32);
        true
    }

    /// Where the nozzle waits: beside all lines of the layer, on the side that is nearest and on the
    /// bed. None if they leave no room.
    fn beside(&self, layer: &Moves) -> Option<[Thousandths; 2]> {
        let end = layer.moves.last()?.to;
        let aside = (1000.0 * ASIDE) as i32;
        let beads = || layer.moves.iter().filter(|step| matches!(step.kind, Kind::Extrude(_)));
        let sides = (0..2).flat_map(|axis| {
            let along = || beads().map(move |step| step.to[axis].0);
            let low = along().min().map(|least| least - aside);
            let high = along().max().map(|most| most + aside);
            [low, high].into_iter().flatten().map(move |at| (axis, at))
        });
        let on_bed =
            sides.filter(|&(axis, at)| (self.bed[axis][0]..=self.bed[axis][1]).contains(&at));
        let (axis, at) = on_bed.min_by_key(|&(axis, at)| (at - end[axis].0).abs())?;
        let mut beside = end;
        beside[axis] = Thousandths(at);
        Some(beside)
    }
}

/// mm from `a` to `b`.
fn way(a: [Thousandths; 2], b: [Thousandths; 2]) -> f64 {
    let [x, y] = [0, 1].map(|k| f64::from(a[k].0 - b[k].0) / 1000.0);
    (x * x + y * y).sqrt()
}
