//! Print + Part -> findings of how lines lie on each other: in the air, unanchored, or printed twice.
//!
//! Words used here: a *chain* is lines one after the other without a break; a *patch* is all lines of a
//! layer that touch; a place of a line is *carried* if plastic or the bed reaches up to its lower
//! side there; a *run* is a stretch of a chain that is carried all along, or nowhere.
//!
//! Each layer is laid on those below it ([`lay`]); layers are judged side by side:
//! - a patch of which no line is carried anywhere is in the air. If the model itself has nothing
//!   below there, or is not known, a body begins ([`bodies`]). Within other patches a
//!   stretch that is not carried is a bridge if both its ends are, else an end that hangs; both are
//!   measured, and judged ([`anchors`]);
//! - a line whose core runs along another core of its layer is printed twice;
//! - a line that lies lower than a core of a layer before it falls: it runs into what is printed.
//!   This is possible only for lines below the highest line so far, so flat files do not pay for it;
//! - a line that irons may lie on others of its layer, and on nothing else;
//! - a layer whose walls are less high than it lies above the one below misses a layer between.
//!
//! Bodies are put together in the file's order at the end.

pub(crate) mod anchors;
pub(crate) mod bead;
pub(crate) mod bodies;
pub(crate) mod carriers;
pub(crate) mod chains;
pub(crate) mod ground;
pub(crate) mod laid;
pub(crate) mod lay;
pub(crate) mod runs;

use crate::check::beads::place;
use crate::check::filled::Filled;
use crate::check::finding::{Code, Finding, Findings, short};
use crate::check::model::part::Part;
use crate::check::model::raft;
use crate::check::survey::Survey;
use crate::check::window::Window;
use crate::reader::print::Step;
use crate::reader::{Facts, Role};
use bead::SUPPORT_GAP;
use bodies::Bodies;
use chains::{chains_of, is_ironing};
use ground::{Carrier, Ground};
use laid::Laid;
use lay::{Judge, Judged, Measured, Patch};
use rayon::prelude::*;
use std::ops::Range;

/// How far below the lower side of a line something may stand that carries it, mm.
const MOST_BELOW: f64 = SUPPORT_GAP + 1e-3;

/// All layers so far, and what stands of them.
pub(crate) struct Stack<'a> {
    part: Option<&'a Part>,
    /// Whether any line may be support: the file has some, and does not tell which.
    untold_support: bool,
    measured: Measured,
    bodies: Bodies,
    /// The first chain of each layer.
    firsts: Vec<u32>,
    chains: u32,
    /// What layers have laid, of those that something may lie on yet.
    kept: Vec<Option<Laid>>,
    /// For each layer the highest line before it, mm.
    highest: Vec<f64>,
}

impl<'a> Stack<'a> {
    /// Nothing yet. Where `part` itself has nothing below, a hanging line is no missing layer.
    pub(crate) fn new(facts: &Facts, part: Option<&'a Part>) -> Self {
        Self {
            part,
            untold_support: [raft::SUPPORT, raft::RAFT]
                .iter()
                .any(|key| raft::is_untold(facts, key)),
            measured: Measured::default(),
            bodies: Bodies::default(),
            firsts: Vec::new(),
            chains: 0,
            kept: Vec::new(),
            highest: vec![0.0],
        }
    }

    /// Takes in the lines of the next layers.
    pub(crate) fn lay(&mut self, window: &Window<'_>, batch: Range<usize>) {
        let laid = batch.clone().into_par_iter().map(|layer| {
            let moves = window.moves(layer);
            let chains = chains_of(moves).filter(|chain| !is_ironing(&moves[chain.start]));
            let laid = Laid::new(moves, chains);
            Some(if self.untold_support { laid.into_support() } else { laid })
        });
        self.kept.extend(laid.collect::<Vec<_>>());
        for layer in batch {
            let own = self.kept[layer].as_ref().map_or(0.0, |laid| laid.highest);
            self.highest.push(self.highest[layer].max(own));
        }
    }

    /// Judges a layer of those that were taken in.
    pub(crate) fn judged(&self, filled: &Filled<'_>, layer: usize) -> Judged {
        let moves = filled.window.moves(layer);
        let nothing = Laid::default();
        let level = &filled.window.facts.layers[layer];
        let laid = self.kept[layer].as_ref().unwrap_or(&nothing);
        let lowest = filled.survey.depths[layer] - MOST_BELOW;
        let ground = Ground::below(laid, &self.kept[..layer], lowest);
        let mut judge =
            Judge::new((layer, level, self.part), (laid, moves), &ground, self.highest[layer]);
        judge.found.extend(gap((filled.survey, moves), (layer, self.part)));
        judge.layer()
    }

    /// Adds what was found on the next layer.
    pub(crate) fn layer(&mut self, judged: Judged, found: &mut Findings) {
        self.firsts.push(self.chains);
        self.chains += judged.of_chain.len() as u32;
        found.extend(judged.found);
        let (all, own) = (&mut self.measured, judged.measured);
        all.longest_bridge = all.longest_bridge.max(own.longest_bridge);
        all.longest_end = all.longest_end.max(own.longest_end);
        all.part_hangs += own.part_hangs;
        stand(&mut self.bodies, judged.patches, &judged.of_chain, &self.firsts);
    }

    /// Lets go of what nothing will lie on any more: the layers to come reach down to `floor`, mm.
    pub(crate) fn forget(&mut self, floor: f64) {
        for kept in &mut self.kept {
            if kept.as_ref().is_some_and(|laid| laid.top < floor - MOST_BELOW) {
                *kept = None;
            }
        }
    }

    /// Ends the print.
    pub(crate) fn finish(self, found: &mut Findings) -> Measured {
        self.bodies.report(found);
        self.measured
    }
}

/// Puts the patches of a layer on the bodies below; `firsts` are the first chains of the layers.
fn stand(bodies: &mut Bodies, patches: Vec<Patch>, of_chain: &[usize], firsts: &[u32]) {
    let of_patch: Vec<usize> = patches
        .into_iter()
        .map(|patch| {
            let carriers = patch.carriers.iter().map(|carrier| match carrier {
                Carrier::Bed => 0,
                Carrier::Chain(layer, chain) => firsts[*layer] + chain + 1,
            });
            let body = bodies.add((patch.length, patch.is_part), carriers);
            if let Some(start) = patch.start {
                bodies.begin(body, start);
            }
            body
        })
        .collect();
    of_chain.iter().for_each(|&patch| bodies.chain(of_patch[patch]));
}

/// Reports a layer whose walls are less high than it lies above the one below: a layer between is
/// missing, unless the part has nothing there either. Only walls are compared, since infill may be
/// as thick as several layers.
fn gap(
    (survey, moves): (&Survey, &[Step]),
    (layer, part): (usize, Option<&Part>),
) -> Option<Finding> {
    let missing = survey.gaps[layer];
    // Above the bed the patches are judged. A raft or support below ends lower on purpose.
    let is_above_walls = layer.checked_sub(1).is_some_and(|below| survey.has_walls(below));
    if missing <= 0.0 || !is_above_walls || part.is_some_and(|part| part.is_empty_below(layer)) {
        return None;
    }
    let first = moves.iter().find(|step| step.is_line() && step.role == Role::OuterWall)?;
    let text = format!("the layer lies {} mm too high above the one before", short(missing));
    Some(Finding::of(Code::InTheAir, missing, "mm", text).at(place(layer, first)))
}
