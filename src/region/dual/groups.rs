//! Dual settings -> Blocks: which layers are filled in one direction, and which of them share their lines.
//!
//! A *group* is a number of layers whose lines may be printed at once, on the uppermost of them.
//! Their number is the *ratio*. A *block* is the layers filled in the same direction: one group,
//! or several where the lines are interlaced. No line is shared beyond its block. Otherwise thick
//! lines of two directions would cross in the same layers and be stacked on each other.

use crate::pattern::Pattern;
use crate::profile::{Dual, DualDirection, DualMode, DualPart, DualRemainder};
use std::ops::Range;

/// Height of an interlaced block in groups. All lanes must end with the block, so groups at its
/// two ends are incomplete. A lower block has more of them, which costs time and evenness. A
/// higher one makes upright walls of parallel lines, which are weak across.
const INTERLACED_GROUPS: usize = 6;

/// Which layers share their lines.
#[derive(Debug, Clone)]
pub struct Grouping {
    mode: DualMode,
    /// Layers of a group, at least 1.
    ratio: usize,
    parts: Vec<DualPart>,
    /// Thick lines take the direction with the smaller total length.
    pub shorter: bool,
    /// One layer's infill is printed for the whole group; that of the others is dropped.
    pub drops: bool,
}

/// Layers that are filled in the same direction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// Number of the turn; directions alternate with it.
    pub turn: usize,
    /// The layers.
    pub layers: Range<usize>,
}

/// A share of a pattern, all of it printed on the same layers.
#[derive(Debug, Clone)]
pub struct Lane {
    /// The share.
    pub pattern: Pattern,
    /// How many layers before the block's end its groups end.
    pub phase: usize,
}

impl Grouping {
    /// The grouping that `dual` asks for, with groups of `ratio` layers.
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

    /// The block of layer `k` of `count`. The first layer is always on its own, because a thick
    /// bead does not hold on the bed.
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

    /// How many layers before the block's end the groups of walls of this depth end.
    #[must_use]
    pub fn wall_phase(&self, depth: u32) -> usize {
        if self.is_interlaced() { depth as usize % self.ratio } else { 0 }
    }

    /// Whether a group ends with layer `k` of `block`, in a lane whose groups end `phase` layers
    /// before the block's end. Every group ends with the block.
    #[must_use]
    pub fn ends(&self, phase: usize, k: usize, block: &Block) -> bool {
        k + 1 == block.layers.end || (k + 1 + phase).is_multiple_of(self.ratio)
    }

    fn is_interlaced(&self) -> bool {
        self.mode == DualMode::Interlaced
    }
}
