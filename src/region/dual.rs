//! Areas of a pair of layers -> Infill: printed on each layer, or thick on the upper one.
//!
//! A pair is two layers `2m` and `2m + 1` of the same height. Where both have
//! sparse infill it is printed once, on the upper layer, with the material of
//! both: exactly twice. The thesis this follows keeps the whole infill of the
//! layer whose lines are shorter in all; that leaves hollow places where the
//! layers differ and often keeps the same direction every time. Both gaps are
//! closed unless the settings ask for the thesis's rule.

use super::classify::Areas;
use super::{Comb, Infill, Params};
use crate::geom::spans::Rows;
use crate::profile::{Dual, DualDirection, DualMode, DualRemainder};
use crate::units::Coord;

/// Areas of one layer on each raster it was asked on, by raster index.
pub type LayerAreas = Vec<Option<Areas>>;

/// What thick lines replace, in one pair or in many; lengths in grid units. Lines
/// shorter than they are wide are not printed and not counted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PairStats {
    /// Pairs that have infill.
    pub pairs: usize,
    /// Of these, pairs with thick lines.
    pub thick_pairs: usize,
    /// Length of thick lines.
    pub thick: i64,
    /// Length of thin lines beside them on both layers.
    pub thin: i64,
    /// Length of lines of both layers that a print without dual would have.
    pub plain: i64,
}

impl PairStats {
    /// Counts other pairs in.
    pub fn add(&mut self, other: Self) {
        self.pairs += other.pairs;
        self.thick_pairs += other.thick_pairs;
        self.thick += other.thick;
        self.thin += other.thin;
        self.plain += other.plain;
    }
}

/// The combs that may carry the infill of pair `m`: all that have to be classified for it.
#[must_use]
pub fn pair_combs(m: usize, dual: &Dual, params: &Params) -> Vec<Comb> {
    match dual.direction {
        DualDirection::Cross => turn(m, params).to_vec(),
        DualDirection::Shorter => [turn(2 * m, params), turn(2 * m + 1, params)].concat(),
    }
}

/// The combs whose turn it is on layer (or pair) `n`.
#[must_use]
pub fn turn(n: usize, params: &Params) -> &[Comb] {
    match params.infill.len() {
        0 => &[],
        sets => &params.infill[n % sets],
    }
}

/// Whether layers `lower` and `lower + 1` of `count` may share their infill. The
/// first layer never does: a thick bead on the bare bed does not hold.
#[must_use]
pub fn is_pair(lower: usize, count: usize, mode: DualMode) -> bool {
    mode == DualMode::Pair && lower.is_multiple_of(2) && lower > 0 && lower + 1 < count
}

/// The infill of a layer on its own.
#[must_use]
pub fn plain(k: usize, areas: &LayerAreas, params: &Params) -> Vec<Infill> {
    turn(k, params).iter().map(|&comb| infill(comb, areas)).collect()
}

fn infill(comb: Comb, areas: &LayerAreas) -> Infill {
    let rows = areas[comb.raster].as_ref().map(|a| a.infill.clone()).unwrap_or_default();
    Infill { comb, rows, layers: 1 }
}

/// The length of the lines that `combs` print of a layer.
fn length(combs: &[Comb], areas: &LayerAreas, params: &Params) -> i64 {
    let of = |comb: &Comb| {
        areas[comb.raster].as_ref().map_or(0, |a| comb.length(&a.infill, params.line_width))
    };
    combs.iter().map(of).sum()
}

/// The infill of the lower and of the upper layer of pair `m`.
#[must_use]
pub fn pair(
    m: usize,
    lower: &LayerAreas,
    upper: &LayerAreas,
    dual: &Dual,
    params: &Params,
) -> ([Vec<Infill>; 2], PairStats) {
    let w = params.line_width;
    let own = [turn(2 * m, params), turn(2 * m + 1, params)];
    let shorter = |below: &[Comb], above: &[Comb]| {
        length(below, lower, params) < length(above, upper, params)
    };
    let combs = match dual.direction {
        DualDirection::Cross => turn(m, params),
        DualDirection::Shorter => own[usize::from(!shorter(own[0], own[1]))],
    };
    let keep_lower = dual.remainder == DualRemainder::Drop
        && match dual.direction {
            DualDirection::Cross => shorter(combs, combs),
            DualDirection::Shorter => shorter(own[0], own[1]),
        };
    let mut out = [Vec::new(), Vec::new()];
    let mut stats = PairStats::default();
    for &comb in combs {
        let (a, b) = (infill(comb, lower), infill(comb, upper));
        stats.plain += a.length(w) + b.length(w);
        let thick = match dual.remainder {
            DualRemainder::Thin => shared(&a.rows, &b.rows, w),
            DualRemainder::Drop if keep_lower => a.rows.clone(),
            DualRemainder::Drop => b.rows.clone(),
        };
        let thick = Infill { comb, rows: thick, layers: 2 };
        stats.thick += thick.length(w);
        if dual.remainder == DualRemainder::Thin {
            for (side, whole) in out.iter_mut().zip([a, b]) {
                let rest = Infill { rows: whole.rows.minus(&thick.rows), ..whole };
                stats.thin += rest.length(w);
                side.push(rest);
            }
        }
        out[1].push(thick);
    }
    stats.pairs = usize::from(stats.plain > 0);
    stats.thick_pairs = usize::from(stats.thick > 0);
    (out, stats)
}

/// What both layers have, in pieces at least `least` long: a thick bead shorter
/// than it is wide is a blob.
fn shared(a: &Rows, b: &Rows, least: Coord) -> Rows {
    a.and(b).filter(|_, span| span.len() >= i64::from(least))
}
