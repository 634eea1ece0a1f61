//! What was cut out of a piece -> the places that may fail for it, and what the head may touch there.
//!
//! What is printed flat instead stands higher than before. Where nothing rose in reach, nothing can fail that
//! passed; elsewhere only what rose has to be looked at.

use super::candidate::Piece;
use super::glance::{Glance, Under};
use super::stack::Stack;
use super::touch::mm;
use crate::geom::boxes::extent;
use crate::head::pile::Pile;
use crate::nonplanar::grid::{CELL, STEP, Spot, counted};
use crate::nonplanar::scene::Scene;
use crate::units::{Coord, to_mm};
use std::collections::BTreeSet;

/// Places are kept in blocks of so many by so many.
const BLOCK: i32 = 8;

/// What was cut out since places were tried.
pub(super) struct Fresh {
    /// Blocks of places that may fail for it.
    blocks: Blocks,
    /// What stands higher now; all else was no hindrance to what passed.
    pub risen: Option<Pile>,
    /// Where it leaves room for the head, at a glance.
    pub glance: Option<Glance>,
}

/// Some blocks of places.
struct Blocks {
    low: Spot,
    columns: usize,
    /// Row by row, whether it is one of them.
    are: Vec<bool>,
}

/// The block of places that a cell lies in.
pub(super) fn block_of([x, y]: Spot) -> Spot {
    [x.div_euclid(2 * BLOCK), y.div_euclid(2 * BLOCK)]
}

impl Fresh {
    /// Of a piece, where some cells have risen; `raised` are the blocks of all that were raised.
    pub(super) fn new(
        (scene, piece): (&Scene<'_>, &Piece),
        (raised, risen): (&BTreeSet<Spot>, &[Spot]),
        stack: &Stack<'_>,
    ) -> Self {
        let (blocks, glance) =
            (in_reach((scene, piece), raised), past((scene, piece), risen, stack));
        Self { blocks, risen: stack.alone(risen), glance }
    }

    /// Whether a place may fail for it.
    pub(super) fn is_near(&self, [x, y]: Spot) -> bool {
        let Blocks { low, columns, are } = &self.blocks;
        let block = counted([x.div_euclid(BLOCK), y.div_euclid(BLOCK)], *low);
        block.is_some_and(|[x, y]| x < *columns && are.get(y * columns + x) == Some(&true))
    }

    /// Whether the head touches nothing of what stands higher now, at a glance, with its tip so high, mm.
    pub(super) fn is_clear(&self, cell: Spot, tip: f64) -> bool {
        self.glance.as_ref().is_some_and(|glance| glance.is_clear(cell, tip))
    }
}

/// Where some cells leave room for the head, at a glance, as far as they are in reach.
fn past((scene, piece): (&Scene<'_>, &Piece), risen: &[Spot], stack: &Stack<'_>) -> Option<Glance> {
    let head = &scene.params.head;
    let heights = || risen.iter().map(|&cell| stack.height(cell) as f32);
    let highest = f64::from(heights().reduce(f32::max)?);
    let most = highest - mm(piece.bounds[0] - f64::from(scene.lowered(0)));
    let reach = (head.reach_below(most) / to_mm(CELL)).ceil() as i32 + 2;
    let (from, to) = extent(piece.area.iter().flatten())?;
    let ends = |axis: usize, from: Coord, to: Coord| {
        let all = || risen.iter().map(|cell| cell[axis]);
        let (first, last) = (all().min()?, all().max()?);
        let low = (first - reach).max(from.div_euclid(CELL)).min(first);
        Some([low, (last + reach).min(to.div_euclid(CELL) + 1).max(last)])
    };
    let ([left, right], [low, high]) = (ends(0, from.x, to.x)?, ends(1, from.y, to.y)?);
    let columns = usize::try_from(right - left + 1).ok()?;
    let mut around = vec![f32::NEG_INFINITY; columns * usize::try_from(high - low + 1).ok()?];
    for ([x, y], height) in risen.iter().zip(heights()) {
        let at = (y - low) as usize * columns + (x - left) as usize;
        around[at] = around[at].max(height);
    }
    Some(Glance::new([left, low], columns, around, Under::of(head, most)))
}

/// The blocks of places from which the head may touch something in some blocks.
fn in_reach((scene, piece): (&Scene<'_>, &Piece), raised: &BTreeSet<Spot>) -> Blocks {
    let heights = scene.slicer.heights();
    let high = piece.bounds[1].max(f64::from(heights.top(piece.home)));
    let low = piece.bounds[0] - f64::from(scene.depth());
    let reach = scene.params.head.reach_below(mm(high - low)) + to_mm(STEP);
    let by = (reach / (f64::from(BLOCK) * to_mm(STEP))).ceil() as i32;
    let ends = |axis: usize| {
        let all = || raised.iter().map(|block| block[axis]);
        [all().min().unwrap_or(0) - by, all().max().unwrap_or(0) + by]
    };
    let ([left, right], [low, high]) = (ends(0), ends(1));
    let [columns, rows] =
        [right - left, high - low].map(|last| usize::try_from(last + 1).unwrap_or(0));
    let mut are = vec![false; if raised.is_empty() { 0 } else { columns * rows }];
    let side = usize::try_from(2 * by + 1).unwrap_or(0);
    for [x, y] in raised {
        let [x, y] = [x - by - left, y - by - low].map(|v| usize::try_from(v).unwrap_or(0));
        for row in y..y + side {
            are[row * columns + x..][..side].fill(true);
        }
    }
    Blocks { low: [left, low], columns, are }
}
