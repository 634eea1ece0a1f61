//! Blocks in the planner -> how fast each begins: the pass from the last one back.
//!
//! How fast a block may begin by what lies before it is known when it comes in
//! ([`Block::most_entry`]). The pass back gives how fast it may begin so that all
//! after it can still slow down to rest at the end. A block that begins as fast as
//! it ever may is decided for good, whatever follows, and all before it with it.

use super::block::Block;
use crate::units::Bounded as _;

/// Plans all blocks so that the last ends at rest. Returns how many are decided for good.
pub(super) fn back<T>(blocks: &mut [Block<T>]) -> usize {
    let mut next = blocks.last().map_or(0.0, |last| last.rest);
    let mut decided = None;
    for (index, block) in blocks.iter_mut().enumerate().rev() {
        let reachable = next + block.change;
        block.entry = block.most_entry.at_most(reachable);
        if decided.is_none() && block.most_entry <= reachable {
            decided = Some(index);
        }
        next = block.entry;
    }
    decided.unwrap_or(0)
}

/// Plans anew after a block was added, as far back as anything changes. It may have to
/// end at `least`, squared: the corner after it is not known yet.
pub(super) fn back_from_last<T>(blocks: &mut [Block<T>], least: f64) {
    let mut next = blocks.last().map_or(0.0, |last| last.rest.at_most(least));
    for block in blocks.iter_mut().rev() {
        let entry = block.most_entry.at_most(next + block.change);
        if entry == block.entry {
            return;
        }
        block.entry = entry;
        next = entry;
    }
}

/// The first block begins as planned, whatever follows: what can be reached from there on.
pub(super) fn settle_first<T>(blocks: &mut [Block<T>]) {
    let mut blocks = blocks.iter_mut();
    let Some(first) = blocks.next() else { return };
    first.most_entry = first.entry;
    let mut reach = first.reach().full;
    for block in blocks {
        if block.most_entry <= reach {
            return;
        }
        block.most_entry = reach;
        reach = block.reach().full;
    }
}

/// Klipper's plan: both passes back, with the whole acceleration and with the part for
/// sprints. Returns how many blocks are decided for good.
pub(super) fn back_smoothly<T>(blocks: &mut [Block<T>]) -> usize {
    let (mut next, mut next_smooth) = (0.0, 0.0);
    let mut after_decided = false;
    let mut decided = None;
    for (index, block) in blocks.iter_mut().enumerate().rev() {
        let (reachable, smooth) = (next + block.change, next_smooth + block.smooth_change);
        block.entry = block.most_entry.at_most(reachable);
        block.smooth = block.most_smooth.at_most(smooth);
        // The top speed of a climb is known only where it ends: no cut within a climb.
        let climbs = block.smooth + block.smooth_change <= next_smooth;
        if decided.is_none() && after_decided && !climbs {
            decided = Some(index + 1);
        }
        after_decided = block.most_entry <= reachable && block.most_smooth <= smooth;
        (next, next_smooth) = (block.entry, block.smooth);
    }
    decided.unwrap_or(0)
}

/// Klipper's top speeds of the first `count` blocks, from the last of them back: a climb
/// and the descent after it share the top speed at which the slow pass would turn.
/// `ends` are the squared speeds of both passes after the last of them.
pub(super) fn tops<T>(blocks: &[Block<T>], count: usize, ends: (f64, f64)) -> Vec<Top> {
    let mut tops = vec![Top::default(); count];
    let (mut next, mut next_smooth) = ends;
    let mut peak = 0.0;
    // The blocks of the descent that follows, whose top is not known yet.
    let mut descent = count..count;
    for index in (0..count).rev() {
        let block = &blocks[index];
        let smooth = next_smooth + block.smooth_change;
        if block.smooth < smooth {
            let turns = block.smooth + block.smooth_change > next_smooth;
            if turns || !descent.is_empty() {
                peak = block.cruise.at_most(0.5 * (block.smooth + smooth));
                let mut most: f64 = peak;
                for index in descent {
                    let top = &mut tops[index];
                    most = most.at_most(top.entry);
                    *top = Top { entry: most, cruise: most, exit: top.exit.at_most(most) };
                }
            }
            let cruise =
                block.cruise.at_most(0.5 * (block.entry + next + block.change)).at_most(peak);
            let entry = block.entry.at_most(cruise);
            tops[index] = Top { entry, cruise, exit: next.at_most(cruise) };
            descent = index..index;
        } else {
            tops[index] = Top { entry: block.entry, cruise: block.cruise, exit: next };
            descent = index..descent.end;
        }
        (next, next_smooth) = (block.entry, block.smooth);
    }
    tops
}

/// A block's plan, squared speeds.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Top {
    /// At its beginning.
    pub(super) entry: f64,
    /// The highest.
    pub(super) cruise: f64,
    /// At its end.
    pub(super) exit: f64,
}
