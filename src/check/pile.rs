//! Lines in their order -> Pile: how high plastic stands at each place of the bed, and which line it is of.
//!
//! Words used here: *tops* says how high plastic stands and which line stands highest, *cores* at
//! which height the middle of the last line there was laid, *owners* which line was laid there last;
//! a *chain* is lines one after the other without a break; a place of a line is *carried* if plastic
//! or the bed reaches up to its lower side there. Chains are counted over all layers, from 1; 0 is
//! the bed.
//!
//! A layer's lines raise the tops only when the layer is done: lines beside each other do not carry
//! each other.

use super::capsule::Capsule;
use super::grid::Grid;
use super::moves::ROUNDING;
use super::samples::Sample;
use super::sets::Sets;
use crate::reader::print::Step;
use crate::reader::{Print, Role};

/// Side of a pixel, mm: a quarter of a usual line. Larger ones miss lines between the samples.
const PITCH: f64 = 0.1;

/// Pixels of the map at most; larger beds get larger pixels.
const MOST_PIXELS: f64 = 2e7;

/// Part of a line's height that may be missing under it: less makes findings of rounded heights,
/// more hides a missing layer under a thick line.
const GAP: f64 = 0.5;

/// Gap that may be between support and part, mm: it must come off. Two layers of 0.2 mm, and rounding.
const SUPPORT_GAP: f64 = 0.45;

/// A line runs on another where their cores meet, which are this part of their widths: neighbours
/// overlap by less, turns of a zigzag by more.
const CORE: f64 = 0.4;

/// Heights of lines that differ by less are the same, mm: positions are rounded to this or less.
const SAME_HEIGHT: f32 = 0.01;

/// The highest plastic at a place.
#[derive(Clone, Copy, Default)]
struct Top {
    /// How high it stands, mm; 0 is the bed.
    z: f32,
    /// The chain that stands there.
    owner: u32,
}

/// Plastic as it stands.
pub(super) struct Pile {
    pub(super) grid: Grid,
    tops: Vec<Top>,
    /// Height of the nozzle when a line's middle was laid, mm.
    cores: Vec<f32>,
    /// The chain that was laid there last.
    owners: Vec<u32>,
    /// The last chain of the layers before.
    owners_from: u32,
    /// Which chains of the layer touch: a patch each.
    patches: Sets,
    /// The highest line of the layers before, mm.
    highest: f64,
    /// How deep a line of this layer lies in what the layers before have printed, mm, and the line
    /// that lies deepest.
    pub(super) fall: Option<(f64, Step)>,
}

impl Pile {
    pub(super) fn over(print: &Print) -> Option<Self> {
        let (low, high) = super::extent(print.lines())?;
        let grid = Grid::over(low, high, 0.5, PITCH, MOST_PIXELS);
        let count = grid.size[0] * grid.size[1];
        Some(Self {
            grid,
            tops: vec![Top::default(); count],
            cores: vec![0.0; count],
            owners: vec![0; count],
            owners_from: 0,
            patches: Sets::default(),
            highest: 0.0,
            fall: None,
        })
    }

    fn at<T: Copy>(&self, map: &[T], place: [f64; 2]) -> Option<T> {
        self.grid.pixel(place).map(|[x, y]| map[y * self.grid.size[0] + x])
    }

    /// Forgets which chains touch; those to come are of another layer.
    pub(super) fn begin_layer(&mut self) {
        self.owners_from += self.patches.len() as u32;
        self.patches.clear();
    }

    /// The first chain of the patch that a chain of this layer belongs to.
    pub(super) fn root(&mut self, line: usize) -> usize {
        self.patches.root(line)
    }

    /// What carries a line there, if anything does.
    pub(super) fn carrier(&self, step: &Step, place: &Sample) -> Option<u32> {
        let needed = lower_side(step, place.z);
        let side = f64::from(step.width) / 2.0;
        // Support keeps off the part, not off the bed.
        let on_bed = place.z - own_gap(step) - f64::from(step.height) <= 1e-3;
        let at = |off: f64| {
            let at = [place.at[0] + off * place.across[0], place.at[1] + off * place.across[1]];
            self.standing(at, needed).filter(|&owner| owner > 0 || on_bed)
        };
        [0.0, -side / 2.0, side / 2.0, -side, side].into_iter().find_map(at)
    }

    /// What stands so high at a place; beyond the map nothing does.
    pub(super) fn standing(&self, at: [f64; 2], needed: f64) -> Option<u32> {
        let top = self.at(&self.tops, at)?;
        (f64::from(top.z) >= needed).then_some(top.owner)
    }

    /// Whether the middle of another line of this layer lies there.
    pub(super) fn is_laid(&self, step: &Step, at: [f64; 2]) -> bool {
        let core = self.at(&self.cores, at).unwrap_or(0.0);
        core > 0.0 && (core - middle(step)).abs() < SAME_HEIGHT
    }

    /// Whether a line of this layer covers that place.
    pub(super) fn is_covered(&self, at: [f64; 2]) -> bool {
        self.at(&self.owners, at).is_some_and(|owner| owner > self.owners_from)
    }

    /// Notes how far a place of a line lies below the nozzle's way there in a layer before. Flat
    /// layers, which all lie above those before, need no search.
    pub(super) fn find_fall(&mut self, step: &Step, place: &Sample) {
        if place.z >= self.highest - ROUNDING {
            return;
        }
        let is_of_layer = self.at(&self.owners, place.at).is_none_or(|one| one > self.owners_from);
        let fall = f64::from(self.at(&self.cores, place.at).unwrap_or(0.0)) - place.z;
        if !is_of_layer && fall > self.fall.map_or(ROUNDING, |(most, _)| most) {
            self.fall = Some((fall, *step));
        }
    }

    /// Lays a chain down, and joins it to the chains of this layer that it touches.
    pub(super) fn lay(&mut self, chain: &[Step]) {
        // Chains of the layer are counted from 0, owners over all layers from 1.
        let line = self.patches.add();
        let owner = self.owners_from + self.patches.len() as u32;
        let mut touched: Vec<u32> = Vec::new();
        let width = self.grid.size[0];
        for step in chain {
            let (owners, before) = (&mut self.owners, self.owners_from);
            Capsule::of(step, 1.0).rows(&self.grid, |y, span| {
                let row = y * width;
                // Lines that lie side by side touch at a pixel more.
                let beside = row + span.start.saturating_sub(1)..row + (span.end + 1).min(width);
                for known in &mut owners[beside] {
                    if *known > before && *known != owner && touched.last() != Some(known) {
                        touched.push(*known);
                    }
                    *known = owner;
                }
            });
        }
        touched.sort_unstable();
        touched.dedup();
        for other in touched {
            self.patches.join(line, (other - 1 - self.owners_from) as usize);
        }
    }

    /// Lets plastic stand where the chains of this layer were laid, once the layer is done.
    pub(super) fn raise<'s>(&mut self, chains: impl Iterator<Item = &'s [Step]>) {
        for (owner, chain) in (self.owners_from + 1..).zip(chains) {
            for step in chain {
                self.raise_line(step, owner);
            }
        }
    }

    fn raise_line(&mut self, step: &Step, owner: u32) {
        let extra = if step.role == Role::Support { SUPPORT_GAP as f32 } else { 0.0 };
        let top = Top { z: step.from[2].max(step.to[2]) + extra, owner };
        self.highest = self.highest.max(step.heights()[1]);
        let (width, tops) = (self.grid.size[0], &mut self.tops);
        Capsule::of(step, 1.0).rows(&self.grid, |y, span| {
            for known in &mut tops[y * width..][span] {
                if known.z <= top.z {
                    *known = top;
                }
            }
        });
    }

    pub(super) fn lay_core(&mut self, step: &Step) {
        let (width, cores, z) = (self.grid.size[0], &mut self.cores, middle(step));
        Capsule::of(step, CORE).rows(&self.grid, |y, span| cores[y * width..][span].fill(z));
    }
}

/// How high plastic must stand to carry a line at this height of the nozzle, mm. Support stands on the
/// part with the gap that the part has above it.
pub(super) fn lower_side(step: &Step, z: f64) -> f64 {
    let gap = if step.role == Role::Support { SUPPORT_GAP } else { own_gap(step) };
    z - f64::from(step.height) - gap - 1e-3
}

/// What may be missing under a line, mm.
fn own_gap(step: &Step) -> f64 {
    GAP * f64::from(step.height).min(0.3)
}

/// Height of the nozzle in the middle of a line, mm.
fn middle(step: &Step) -> f32 {
    0.5 * (step.from[2] + step.to[2])
}
