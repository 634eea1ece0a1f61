//! Moves -> Moves: lowers the feeds of layers that would take too little time to set.
//!
//! Clock, sums and text read the moves after this, so that times, progress and lengths agree.
//!
//! - A layer is *quick* if it takes less than the least time.
//! - A *cap* is the fastest that lines of a kind may be. Slower lines stay as they are.
//! - A *group* is the layers that dual injection prints at once, or one layer. Every second layer of
//!   a pair is quick, since the other has the infill of both: what is slow on one of them is slow on
//!   all, where it is seen.
//!
//! 1. `slowing` tells which layers are quick, and the cap on outer walls that each needs.
//! 2. `even` gives each group the lowest cap of its layers, and raises and lowers it from group to
//!    group by small steps only. It holds back the groups that a later one may still slow down.
//! 3. `slowing` then slows down the rest of each layer, as little as the least time asks for.
//! 4. What a layer of a group still misses when all of it is as slow as it may be, the others of the
//!    group make up for, so that the group has its time.
//! 5. Or else `waiting` lets the nozzle wait where that is not enough.

mod even;
mod slowing;
mod waiting;

use super::moves::Moves;
use super::times;
use crate::profile::Settings;
use even::{Even, Group, Layer};
use rayon::prelude::*;
use slowing::{Slowed, Slowing};
use waiting::Waiting;

/// What cooling did to a print.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cooled {
    /// Layers that were slowed down.
    pub layers: usize,
    /// Of these, layers that are not quick: only their outer walls are slower, to be like those of
    /// the layers beside them.
    pub evened: usize,
    /// Lines inside and support, inner walls, and outer walls with all that hangs.
    pub kinds: [Kind; 3],
    /// Layers after which the nozzle waits.
    pub waits: usize,
}

/// What cooling did to one kind of lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kind {
    /// Layers on which some were slowed down.
    pub layers: usize,
    /// The lowest share of its speed that one was left.
    pub lowest: f64,
}

impl Default for Kind {
    fn default() -> Self {
        Self { layers: 0, lowest: 1.0 }
    }
}

/// Slows down the layers of one print.
pub struct Cooling {
    slowing: Slowing,
    even: Even,
    waiting: Option<Waiting>,
    /// The fan goes by what layers take.
    fan_by_time: bool,
    cooled: Cooled,
}

impl Cooling {
    /// None where the settings ask for nothing that depends on times: no layer is looked at then.
    /// `fan_by_time` says that the fan does.
    #[must_use]
    pub fn new(settings: &Settings, fan_by_time: bool) -> Option<Self> {
        let slows = settings.cooling.min_layer_time > 0.0;
        (slows || fan_by_time).then(|| Self {
            slowing: Slowing::new(settings),
            even: Even::new(settings),
            waiting: (slows && settings.cooling.wait).then(|| Waiting::new(settings)),
            fan_by_time,
            cooled: Cooled::default(),
        })
    }

    /// Takes the next layers. Returns those that are done, in order.
    pub fn layers(&mut self, layers: Vec<Moves>) -> Vec<Moves> {
        let judge = |moves: Moves| Layer { need: self.slowing.need(&moves), moves };
        let judged: Vec<Layer> = layers.into_par_iter().map(judge).collect();
        let ready: Vec<Group> =
            judged.into_iter().flat_map(|layer| self.even.add(layer, &self.slowing)).collect();
        self.cool(ready)
    }

    /// The layers that are left, at the end of the print.
    pub fn finish(&mut self) -> Vec<Moves> {
        let ready = self.even.finish(&self.slowing);
        self.cool(ready)
    }

    /// What was done so far.
    #[must_use]
    pub fn cooled(&self) -> &Cooled {
        &self.cooled
    }

    fn cool(&mut self, groups: Vec<Group>) -> Vec<Moves> {
        let cool = |group: Group| self.group(group);
        let cooled: Vec<Vec<(Moves, Slowed)>> = groups.into_par_iter().map(cool).collect();
        let layers = cooled.into_iter().flatten();
        layers
            .map(|(moves, slowed)| {
                self.cooled.add(&slowed);
                moves
            })
            .collect()
    }

    fn group(&self, group: Group) -> Vec<(Moves, Slowed)> {
        let cap = group.cap;
        let slow = |Layer { mut moves, need }: Layer| {
            let mut slowed = self.slowing.slow(&mut moves, &need, cap);
            if let Some(waiting) = self.waiting.as_ref().filter(|_| need.quick) {
                slowed.waits = waiting.wait(&mut moves, &self.slowing);
            }
            (moves, slowed)
        };
        let mut layers: Vec<(Moves, Slowed)> = group.layers.into_iter().map(slow).collect();
        if self.waiting.is_none() && layers.len() > 1 && layers.iter().any(|(_, s)| s.quick) {
            self.make_up(&mut layers);
        }
        if self.fan_by_time {
            let seconds = layers.iter().map(|(moves, _)| self.slowing.seconds(moves));
            let mean = seconds.sum::<f64>() / layers.len().max(1) as f64;
            layers.iter_mut().for_each(|(moves, _)| moves.group_seconds = Some(mean));
        }
        layers
    }

    /// Slows down layers of a group further until all of them together take the least time of each: what
    /// is under the next group has set by then, whichever of them gave it the time.
    fn make_up(&self, layers: &mut [(Moves, Slowed)]) {
        let least = self.slowing.least;
        let taken: Vec<f64> = layers.iter().map(|(moves, _)| self.slowing.seconds(moves)).collect();
        let mut missing = taken.iter().map(|seconds| least - seconds).sum::<f64>();
        for ((moves, slowed), seconds) in layers.iter_mut().zip(taken) {
            // One that is too quick as it is has nothing left to give.
            if missing <= 0.0 || seconds < least {
                continue;
            }
            let to = self.slowing.slow_to(moves, seconds + missing);
            missing -= self.slowing.seconds(moves) - seconds;
            slowed.then(&to);
        }
    }
}

impl Cooled {
    fn add(&mut self, slowed: &Slowed) {
        let any = slowed.lowest.iter().any(|&lowest| lowest < 1.0);
        self.layers += usize::from(any);
        self.evened += usize::from(any && !slowed.quick);
        self.waits += usize::from(slowed.waits);
        for (kind, &lowest) in self.kinds.iter_mut().zip(&slowed.lowest) {
            kind.layers += usize::from(lowest < 1.0);
            kind.lowest = kind.lowest.min(lowest);
        }
    }
}
