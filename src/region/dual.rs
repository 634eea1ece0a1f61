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

/// What a pair's thick lines replace.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PairStats {
    /// The pair has infill.
    pub filled: bool,
    /// Length of thick lines, grid units.
    pub thick: i64,
    /// Length of thin lines beside them on both layers, grid units.
    pub thin: i64,
    /// Length of lines of both layers that a print without dual would have, grid units.
    /// (None of these counts lines shorter than they are wide, which are not printed.)
    pub plain: i64,
}

/// The combs that carry the infill of layer `k` where nothing is thick.
#[must_use]
pub fn plain_combs(k: usize, params: &Params) -> &[Comb] {
    turn(k, params)
}

/// The combs that may carry the infill of pair `m`: all that have to be classified for it.
#[must_use]
pub fn pair_combs(m: usize, dual: &Dual, params: &Params) -> Vec<Comb> {
    match dual.direction {
        DualDirection::Cross => turn(m, params).to_vec(),
        DualDirection::Shorter => [turn(2 * m, params), turn(2 * m + 1, params)].concat(),
    }
}

fn turn(n: usize, params: &Params) -> &[Comb] {
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
    plain_combs(k, params).iter().map(|&comb| infill(comb, areas, false)).collect()
}

fn rows(comb: Comb, areas: &LayerAreas) -> Rows {
    areas[comb.raster].as_ref().map(|a| a.infill.clone()).unwrap_or_default()
}

fn infill(comb: Comb, areas: &LayerAreas, thick: bool) -> Infill {
    Infill { comb, rows: rows(comb, areas), thick }
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
    let length = |combs: &[Comb], areas: &LayerAreas| -> i64 {
        combs.iter().map(|&comb| infill(comb, areas, false).length(w)).sum()
    };
    let own = [turn(2 * m, params), turn(2 * m + 1, params)];
    let (combs, lower_is_shorter) = match dual.direction {
        DualDirection::Cross => {
            let combs = turn(m, params);
            (combs, length(combs, lower) < length(combs, upper))
        }
        DualDirection::Shorter if length(own[0], lower) < length(own[1], upper) => (own[0], true),
        DualDirection::Shorter => (own[1], false),
    };
    let mut out = [Vec::new(), Vec::new()];
    let mut stats = PairStats::default();
    for &comb in combs {
        let (a, b) = (infill(comb, lower, false), infill(comb, upper, false));
        let plain = a.length(w) + b.length(w);
        let thick = match dual.remainder {
            DualRemainder::Thin => shared(&a.rows, &b.rows, w),
            DualRemainder::Drop if lower_is_shorter => a.rows.clone(),
            DualRemainder::Drop => b.rows.clone(),
        };
        let thick = Infill { comb, rows: thick, thick: true };
        stats.plain += plain;
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
    stats.filled = stats.plain > 0;
    (out, stats)
}

/// What both layers have, in pieces at least `least` long: a thick bead shorter
/// than it is wide is a blob.
fn shared(a: &Rows, b: &Rows, least: Coord) -> Rows {
    a.and(b).filter(|_, span| span.len() >= i64::from(least))
}
