//! Layers below a layer -> Ground: what stands where, and what carries a line.
//!
//! Words: a place of a line is *carried* if plastic or the bed reaches up to its lower side there, below
//! its middle or anywhere across it. A layer's lines carry none of their own layer.

use super::bead::{Bead, SUPPORT_GAP, within};
use super::laid::{Laid, Seen};
use crate::reader::Role;
use crate::reader::print::Step;

/// Length of the pieces in which a hanging line is looked at, mm: a quarter of a usual line.
pub(crate) const PITCH: f64 = 0.1;

/// Part of a line's height that may be missing under it: less makes findings of rounded heights,
/// more hides a missing layer under a thick line.
const GAP: f64 = 0.5;

/// What carries a line: a chain of a layer, both from 0, or the bed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Carrier {
    Bed,
    Chain(usize, u32),
}

/// What layers below a layer have laid, as far as it may meet a line of the layer.
pub(crate) struct Ground<'a> {
    /// The layers with their numbers, the highest first.
    layers: Vec<(usize, &'a Laid)>,
}

impl<'a> Ground<'a> {
    /// Of `kept`, the layers below `layer`, the lines of which lie this low or higher, mm.
    pub(crate) fn below(layer: &Laid, kept: &'a [Option<Laid>], lowest: f64) -> Self {
        let some = kept.iter().enumerate().rev();
        let some = some.filter_map(|(k, one)| Some((k, one.as_ref()?)));
        let layers = some.filter(|(_, one)| one.top >= lowest && one.meets(layer)).collect();
        Self { layers }
    }

    /// Whether plastic or the bed stands so high at a place, mm.
    pub(crate) fn stands(&self, at: [f64; 2], needed: f64) -> bool {
        let covers = |laid: &Laid| laid.covers(at, |_, bead| bead.top() >= needed);
        needed <= 0.0 || self.layers.iter().any(|(_, laid)| laid.top >= needed && covers(laid))
    }

    /// Hands the beads within `more` mm of a line that reach up to a height to `sink`, with the places of
    /// their layers among those of the ground.
    pub(crate) fn near(
        &self,
        line: &Bead,
        (needed, more): (f64, f64),
        seen: &mut [Seen],
        mut sink: impl FnMut(usize, &Bead),
    ) {
        for (place, ((_, laid), seen)) in self.layers.iter().zip(seen).enumerate() {
            if laid.top >= needed {
                let is_flat = laid.least_top >= needed;
                laid.near(line, more, seen, |_, bead| {
                    if is_flat || bead.top() >= needed {
                        sink(place, bead);
                    }
                });
            }
        }
    }

    /// How deep a line lies in the way that the nozzle took in a layer before, mm: in the last one
    /// that it meets. `core` is the part of a bead's width that is this way.
    pub(crate) fn depth(
        &self,
        line: &Bead,
        core: f64,
        seen: &mut [Seen],
        counts: impl Fn([f64; 2]) -> bool,
    ) -> f64 {
        let lowest = line.heights[0].min(line.heights[1]);
        for ((_, laid), seen) in self.layers.iter().zip(seen) {
            let mut deepest = 0.0_f64;
            laid.near(line, 0.0, seen, |_, bead| {
                if bead.highest() <= lowest {
                    return;
                }
                let Some([from, to]) = line.way(bead, core * bead.radius) else { return };
                let part = 0.5 * (from + to);
                if counts(line.place(part)) {
                    deepest = deepest.max(-line.above(bead, part));
                }
            });
            if deepest > 0.0 {
                return deepest;
            }
        }
        0.0
    }

    /// The number of the layer at a place of the ground.
    pub(crate) fn number(&self, place: usize) -> usize {
        self.layers[place].0
    }

    /// How many chains each of its layers has.
    pub(crate) fn chains(&self) -> impl Iterator<Item = usize> {
        self.layers.iter().map(|(_, laid)| laid.chains.len())
    }

    /// Room to mark beads in, for [`Self::near`] and [`Self::depth`].
    pub(crate) fn seen(&self) -> Vec<Seen> {
        self.layers.iter().map(|_| Seen::default()).collect()
    }
}

/// The part of a line, from 0 to 1, that lies no higher than this, mm.
pub(crate) fn below(line: &Bead, most: f64) -> Option<[f64; 2]> {
    let [from, to] = line.heights;
    within(from, to - from, [f64::NEG_INFINITY, most])
}

/// The part of a line, from 0 to 1, that lies within these distances above another line, mm. Each is as
/// high as it is there, and the other goes on beyond its ends: the caller looks beside it alone.
pub(crate) fn above(line: &Bead, other: &Bead, within_mm: [f64; 2]) -> Option<[f64; 2]> {
    let over = |part: f64| line.height(part) - other.height_along(line.place(part));
    let [from, to] = [over(0.0), over(1.0)];
    within(from, to - from, within_mm)
}

/// How high plastic must stand to carry a line at this height of the nozzle, mm. Support stands on the
/// part with the gap that the part has above it.
pub(crate) fn lower_side(step: &Step, z: f64) -> f64 {
    z - room_below(step)
}

/// How far below the nozzle plastic must stand to carry a line, mm.
pub(crate) fn room_below(step: &Step) -> f64 {
    let gap = if step.role == Role::Support { SUPPORT_GAP } else { own_gap(step) };
    f64::from(step.height) + gap + 1e-3
}

/// The height up to which a line lies on the bed, mm: support keeps off the part, not off the bed.
pub(crate) fn bed_room(step: &Step) -> f64 {
    own_gap(step) + f64::from(step.height) + 1e-3
}

/// What may be missing under a line, mm.
fn own_gap(step: &Step) -> f64 {
    GAP * f64::from(step.height).min(0.3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_over_a_slope_lies_on_short_ones() {
        // 12 mm at 17°, over pieces of it that lie a skin lower.
        let at = |y: f64, below: f64| [0.0, y as f32, (10.0 + 0.3 * y - below) as f32];
        let bead = |from: f64, to: f64, below: f64| {
            Bead::of(&Step {
                from: at(from, below),
                to: at(to, below),
                filament: 1.0,
                feed: 1.0,
                width: 0.4,
                height: 0.2,
                role: Role::NonPlanar,
                line: 1,
            })
        };
        let long = bead(0.0, 12.0, 0.0);
        let carried = |from: f64, to: f64| {
            let other = bead(from, to, 0.2);
            let beside = long.way(&other, 0.2)?;
            above(&long, &other, [0.05, 0.31])
                .and_then(|way| crate::check::stack::bead::both(way, beside))
        };
        for (from, to) in [(0.0, 2.0), (5.0, 7.0), (11.0, 12.0), (7.0, 5.0), (6.0, 6.05)] {
            let [begin, end] = carried(from, to).unwrap();
            let (low, high) = (from.min(to) / 12.0, from.max(to) / 12.0);
            assert!(begin <= low + 1e-6 && end >= high - 1e-6, "{from} to {to}: {begin} {end}");
        }
    }
}
