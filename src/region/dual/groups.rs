//! Dual settings -> Blocks: which layers are filled in one direction, and which of them share their lines.
//!
//! A *group* is a number of layers, the ratio, whose lines may be printed at once, on
//! the uppermost of them. A *block* is the layers that are filled in the same
//! direction: one group, or several where the lines are interlaced. Nothing is
//! shared beyond a block, so that lines of two directions never lie in the same
//! layers and cross without being stacked twice.

use crate::pattern::Pattern;
use crate::profile::{Dual, DualDirection, DualMode, DualPart, DualRemainder};
use std::ops::Range;

/// Groups that an interlaced block is high. Lines that are not interlaced end at
/// each block's end, so that a low block costs time and evenness; a high one makes
/// upright walls of parallel lines, which are weak across.
const INTERLACED_GROUPS: usize = 6;

/// Which layers share their lines.
#[derive(Debug, Clone)]
pub struct Grouping {
    mode: DualMode,
    /// Layers of a group, at least 1.
    ratio: usize,
    parts: Vec<DualPart>,
    /// Thick lines take the direction that has less length.
    pub shorter: bool,
    /// Of a group one layer's infill is kept, the others' are dropped.
    pub drops: bool,
}

/// Layers that are filled in the same direction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// Whose turn it is: the blocks' directions alternate with this number.
    pub turn: usize,
    /// The layers.
    pub layers: Range<usize>,
}

/// The share of a pattern that is printed on the same layers.
#[derive(Debug, Clone)]
pub struct Lane {
    /// The share.
    pub pattern: Pattern,
    /// How many layers earlier than the block's their groups end.
    pub phase: usize,
}

impl Grouping {
    /// What `dual` means, with groups of `ratio` layers.
    #[must_use]
    pub fn new(dual: &Dual, ratio: u32) -> Self {
        let ratio = if dual.mode == DualMode::Off { 1 } else { ratio.max(1) as usize };
        Self {
            mode: if ratio == 1 { DualMode::Off } else { dual.mode },
            ratio,
            parts: dual.parts.clone(),
            shorter: dual.direction == DualDirection::Shorter,
            drops: dual.remainder == DualRemainder::Drop,
        }
    }

    /// Layers of a group.
    #[must_use]
    pub fn ratio(&self) -> usize {
        self.ratio
    }

    /// Whether `part` is printed thick.
    #[must_use]
    pub fn shares(&self, part: DualPart) -> bool {
        self.mode != DualMode::Off && self.parts.contains(&part)
    }

    /// The block that has layer `k` of `count`. The first layer is always on its own: a
    /// thick bead on the bare bed does not hold.
    #[must_use]
    pub fn block(&self, k: usize, count: usize) -> Block {
        if self.mode == DualMode::Off {
            return Block { turn: k, layers: k..k + 1 };
        }
        if k == 0 {
            return Block { turn: 1, layers: 0..1 };
        }
        let size = self.ratio * if self.is_interlaced() { INTERLACED_GROUPS } else { 1 };
        let turn = k / size;
        Block { turn, layers: (turn * size).max(1)..((turn + 1) * size).min(count) }
    }

    /// The lanes that `pattern` is divided into.
    #[must_use]
    pub fn lanes(&self, pattern: &Pattern) -> Vec<Lane> {
        if !self.is_interlaced() {
            return vec![Lane { pattern: pattern.clone(), phase: 0 }];
        }
        let lane = |(phase, pattern)| Lane { pattern, phase };
        pattern.shares(self.ratio).into_iter().enumerate().map(lane).collect()
    }

    /// How many layers earlier than the block's the groups of walls of this depth end.
    #[must_use]
    pub fn wall_phase(&self, depth: u32) -> usize {
        if self.is_interlaced() { depth as usize % self.ratio } else { 0 }
    }

    /// Whether a group that ends `phase` layers earlier than the block's ends with layer
    /// `k` of `block`.
    #[must_use]
    pub fn ends(&self, phase: usize, k: usize, block: &Block) -> bool {
        k + 1 == block.layers.end || (k + 1 + phase).is_multiple_of(self.ratio)
    }

    fn is_interlaced(&self) -> bool {
        self.mode == DualMode::Interlaced
    }
}
