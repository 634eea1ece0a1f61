//! Layers + the caps that they need -> groups with caps that differ little from one to the next.
//!
//! A wall that is laid at another speed shines otherwise. So all layers of a group have the lowest
//! cap that one of them needs, and two groups one above the other that would take nearly the same
//! time have caps that are at most a [step](STEP) apart. Where the part changes all at once, so may
//! the cap.
//!
//! A slow group makes those around it slower, step by step, until the cap is no cap any more. How far
//! that goes up is known when a group comes. How far it goes down is not: groups are held back until
//! no group that can come is slow enough to reach them.

use super::slowing::{NO_CAP, Need, Slowing};
use crate::fill::Role;
use crate::gcode::flow::{feed, whole_feed};
use crate::gcode::moves::Moves;
use crate::profile::{DualMode, Settings};
use std::collections::VecDeque;

/// Caps of neighbouring groups differ by this factor at most. A little below the 10 % from which
/// on it may be seen, for feeds are whole mm/min.
const STEP: f64 = 1.09;

/// Neighbouring groups are alike if the shorter one takes more than this share of the longer one's
/// time. Beyond it the part has another shape, and its walls look otherwise anyway.
const ALIKE: f64 = 0.7;

/// A layer, and what it needs.
pub(super) struct Layer {
    pub(super) moves: Moves,
    pub(super) need: Need,
}

/// Layers whose outer walls have one cap.
pub(super) struct Group {
    pub(super) layers: Vec<Layer>,
    /// mm/min; [`NO_CAP`] if none.
    pub(super) cap: u32,
    /// Mean time of its layers before any is slowed down, s, once it was asked for.
    mean: Option<f64>,
}

impl Group {
    fn new(layers: Vec<Layer>) -> Self {
        let cap = layers.iter().map(|layer| layer.need.cap).min().unwrap_or(NO_CAP);
        Self { layers, cap, mean: None }
    }

    fn mean(&mut self, slowing: &Slowing) -> f64 {
        let layers = &self.layers;
        *self.mean.get_or_insert_with(|| {
            let seconds =
                |layer: &Layer| layer.need.seconds.unwrap_or_else(|| slowing.seconds(&layer.moves));
            layers.iter().map(seconds).sum::<f64>() / layers.len().max(1) as f64
        })
    }
}

/// Gives groups their caps.
pub(super) struct Even {
    /// Layers of a group.
    ratio: usize,
    /// Layers of a raft, each on its own; groups count from its top.
    raft: usize,
    /// The lowest cap there is, mm/min.
    slowest: u32,
    /// The feed of outer walls, mm/min: a cap from there on is none.
    fastest: u32,
    /// Layers whose group is not whole yet.
    open: Vec<Layer>,
    /// Groups that may still be slowed down.
    held: VecDeque<Group>,
    /// Cap and mean time of the group before those held, if it has a cap.
    before: Option<(u32, f64)>,
}

impl Even {
    pub(super) fn new(settings: &Settings) -> Self {
        let dual = settings.dual.mode != DualMode::Off;
        // Without a least time no group gets a cap, so that none is held.
        let slows = settings.cooling.min_layer_time > 0.0;
        let slowest = whole_feed(feed(settings.cooling.min_speed));
        let wall = (Role::OuterWall.facts().speed)(&settings.speed).thin;
        let fastest = whole_feed(feed(wall));
        Self {
            ratio: if dual { settings.dual_ratio().max(1) as usize } else { 1 },
            raft: settings.raft_layers(),
            slowest: if slows { slowest } else { fastest },
            fastest,
            open: Vec::new(),
            held: VecDeque::new(),
            before: None,
        }
    }

    /// Takes the next layer. Returns the groups whose caps are final, in order.
    pub(super) fn add(&mut self, layer: Layer, slowing: &Slowing) -> Vec<Group> {
        // The first layer is on its own, as in dual injection.
        let k = layer.moves.layer.saturating_sub(self.raft);
        let ends = k == 0 || (k + 1).is_multiple_of(self.ratio);
        self.open.push(layer);
        if !ends {
            return Vec::new();
        }
        self.close(slowing);
        let mut ready = Vec::new();
        while self.is_final() {
            ready.extend(self.release(slowing));
        }
        ready
    }

    /// The groups that are left, at the end of the print.
    pub(super) fn finish(&mut self, slowing: &Slowing) -> Vec<Group> {
        if !self.open.is_empty() {
            self.close(slowing);
        }
        self.before = None;
        self.held.drain(..).collect()
    }

    /// The open layers become a group, with the caps that follow from it.
    fn close(&mut self, slowing: &Slowing) {
        let mut group = Group::new(std::mem::take(&mut self.open));
        let before = match self.held.back_mut() {
            Some(before) if before.cap != NO_CAP => Some((before.cap, before.mean(slowing))),
            Some(_) => None,
            None => self.before,
        };
        if let Some((cap, mean)) = before.filter(|&(cap, _)| self.faster(cap) < group.cap)
            && are_alike(mean, group.mean(slowing))
        {
            group.cap = self.faster(cap);
        }
        self.held.push_back(group);
        // The groups before it are no more than a step faster each.
        for index in (1..self.held.len()).rev() {
            let cap = self.faster(self.held[index].cap);
            if cap >= self.held[index - 1].cap {
                return;
            }
            let mean = self.held[index].mean(slowing);
            if !are_alike(self.held[index - 1].mean(slowing), mean) {
                return;
            }
            self.held[index - 1].cap = cap;
        }
    }

    /// Whether no group that may come can slow down the first one that is held.
    fn is_final(&self) -> bool {
        let Some(first) = self.held.front() else { return false };
        let mut reach = self.slowest;
        for _ in &self.held {
            if reach >= first.cap {
                return true;
            }
            reach = self.faster(reach);
        }
        reach >= first.cap
    }

    fn release(&mut self, slowing: &Slowing) -> Option<Group> {
        let mut group = self.held.pop_front()?;
        self.before = (group.cap != NO_CAP).then(|| (group.cap, group.mean(slowing)));
        Some(group)
    }

    /// The cap a step above `cap`.
    fn faster(&self, cap: u32) -> u32 {
        let faster = (f64::from(cap) * STEP) as u32;
        // At one digit, a step is less than one mm/min.
        if faster < self.fastest { faster.max(cap.saturating_add(1)) } else { NO_CAP }
    }
}

/// Whether groups that take so long are alike.
fn are_alike(a: f64, b: f64) -> bool {
    a.min(b) > ALIKE * a.max(b)
}
