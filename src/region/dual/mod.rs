//! Areas of a block of layers -> Hatches: which lines each layer prints, for itself or for several layers.
//!
//! Where all layers of a group have sparse lines these are printed once, on the
//! uppermost layer, with the material of all: exactly so many times as much. Where
//! only some in a row have them, these share one line. The thesis this follows keeps
//! the whole infill of that layer of a pair whose lines are shorter in all; that leaves
//! hollow places where the layers differ and often keeps the same direction every
//! time. Both gaps are closed unless the settings ask for the thesis's rule.

pub mod audit;
pub mod groups;
pub mod inner_skin;
pub mod runs;

use super::classify::Areas;
use super::{Comb, Hatch, Params};
use crate::geom::spans::Rows;
use crate::profile::DualPart;
use crate::units::Coord;
use audit::{Audit, apart};
use groups::{Block, Grouping, Lane};
use runs::{Printed, runs};

/// Areas of one layer on each raster it was asked on, by raster index.
pub type LayerAreas = Vec<Option<Areas>>;

/// Thick lines get wider by at most this, so that the material of lines which are too
/// short to be printed is not lost; per cent of a line's width.
const MOST_WIDENED: i64 = 5;

/// The combs whose turn it is on block `n`.
#[must_use]
pub fn turn(n: usize, params: &Params) -> &[Comb] {
    match params.infill.len() {
        0 => &[],
        sets => &params.infill[n % sets],
    }
}

/// The combs that may carry the infill of `block`: all that it has to be classified for.
#[must_use]
pub fn combs(block: &Block, grouping: &Grouping, params: &Params) -> Vec<Comb> {
    if grouping.shares(DualPart::Infill) && !grouping.shorter {
        return turn(block.turn, params).to_vec();
    }
    block.layers.clone().flat_map(|k| turn(k, params)).copied().collect()
}

/// The infill of each layer of `block`, and what became of its lines if they may be shared.
#[must_use]
pub fn infill(
    block: &Block,
    layers: &[&LayerAreas],
    grouping: &Grouping,
    params: &Params,
) -> (Vec<Vec<Hatch>>, Option<Audit>) {
    if !grouping.shares(DualPart::Infill) {
        let each = block.layers.clone().zip(layers);
        return (each.map(|(k, areas)| plain(turn(k, params), areas, params)).collect(), None);
    }
    let kept = shortest(block, layers, grouping, params);
    let combs = if grouping.shorter {
        turn(block.layers.start + kept, params)
    } else {
        turn(block.turn, params)
    };
    if grouping.drops {
        return dropped(block, layers, combs, kept, params);
    }
    let mut sharing = Sharing::new(DualPart::Infill, block, grouping, params.line_width);
    for &comb in combs {
        let rows: Vec<Rows> = layers.iter().map(|areas| rows(comb, areas)).collect();
        let skins: Vec<Option<&Rows>> =
            layers.iter().map(|areas| areas[comb.raster].as_ref().map(|a| &a.skin)).collect();
        sharing.share(comb, &rows, &skins);
    }
    let (hatches, audit) = sharing.finish();
    (hatches, Some(audit))
}

/// The support of each layer of `block`, given on all rows of its raster, and what
/// became of its lines if they may be shared.
#[must_use]
pub fn support(
    block: &Block,
    rows: &[Rows],
    comb: Comb,
    grouping: &Grouping,
    line_width: Coord,
) -> (Vec<Vec<Hatch>>, Option<Audit>) {
    if !grouping.shares(DualPart::Support) {
        let hatch = |rows: &Rows| Hatch { comb, rows: rows.clone(), layers: 1, width: line_width };
        return (rows.iter().map(|rows| vec![hatch(rows)]).collect(), None);
    }
    let mut sharing = Sharing::new(DualPart::Support, block, grouping, line_width);
    sharing.share(comb, rows, &vec![None; rows.len()]);
    let (hatches, audit) = sharing.finish();
    (hatches, Some(audit))
}

/// The infill of a layer on its own.
#[must_use]
pub fn plain(combs: &[Comb], areas: &LayerAreas, params: &Params) -> Vec<Hatch> {
    let hatch =
        |&comb: &Comb| Hatch { comb, rows: rows(comb, areas), layers: 1, width: params.line_width };
    combs.iter().map(hatch).collect()
}

/// Where a layer has sparse infill, on the raster of `comb`.
fn rows(comb: Comb, areas: &LayerAreas) -> Rows {
    areas[comb.raster].as_ref().map(|a| a.infill.clone()).unwrap_or_default()
}

/// Which layer of the block has the least length of lines, in its own direction if
/// directions are free; the upper one of equals.
fn shortest(block: &Block, layers: &[&LayerAreas], grouping: &Grouping, params: &Params) -> usize {
    let length = |n: usize| -> i64 {
        let turn_of = if grouping.shorter { block.layers.start + n } else { block.turn };
        let of = |comb: &Comb| {
            let areas = layers[n][comb.raster].as_ref();
            areas.map_or(0, |a| comb.length(&a.infill, params.line_width))
        };
        turn(turn_of, params).iter().map(of).sum()
    };
    let decides = grouping.shorter || grouping.drops;
    let by_length = (0..layers.len()).rev().filter(|_| decides).min_by_key(|&n| length(n));
    by_length.unwrap_or(0)
}

/// The thesis's rule: one layer's infill for all, the others' left out.
fn dropped(
    block: &Block,
    layers: &[&LayerAreas],
    combs: &[Comb],
    kept: usize,
    params: &Params,
) -> (Vec<Vec<Hatch>>, Option<Audit>) {
    let w = params.line_width;
    let count = layers.len();
    let mut audit = Audit::new(DualPart::Infill, block.layers.clone());
    let mut out = vec![Vec::new(); count];
    for hatch in plain(combs, layers[kept], params) {
        for areas in layers {
            audit.plain(hatch.comb, &rows(hatch.comb, areas), w);
        }
        let hatch = Hatch { layers: count as u32, ..hatch };
        audit.printed(&hatch, w);
        out[count - 1].push(hatch);
    }
    (out, Some(audit))
}

/// Lines of a block being shared out among its layers.
struct Sharing<'a> {
    block: &'a Block,
    grouping: &'a Grouping,
    line_width: Coord,
    hatches: Vec<Vec<Hatch>>,
    audit: Audit,
}

impl<'a> Sharing<'a> {
    fn new(part: DualPart, block: &'a Block, grouping: &'a Grouping, line_width: Coord) -> Self {
        let hatches = vec![Vec::new(); block.layers.len()];
        let audit = Audit::new(part, block.layers.clone());
        Self { block, grouping, line_width, hatches, audit }
    }

    /// Shares the lines of `comb`, whose region on each layer is `rows`. `skins` are the
    /// layers' skins on the same raster.
    fn share(&mut self, comb: Comb, rows: &[Rows], skins: &[Option<&Rows>]) {
        for lane in self.grouping.lanes(comb) {
            let first = self.block.layers.start;
            let ends = |n: usize| self.grouping.ends(lane.phase, first + n, self.block);
            let printed = runs(rows, ends, self.line_width);
            self.explain(lane, rows, skins, &printed);
            for (out, printed) in self.hatches.iter_mut().zip(printed) {
                let hatch = |(layers, rows)| Hatch {
                    comb: lane.comb,
                    rows,
                    layers,
                    width: self.line_width,
                };
                out.extend(printed.into_iter().map(hatch));
            }
        }
    }

    /// Counts the lines of a lane, and says why some are not printed for a whole group.
    fn explain(&mut self, lane: Lane, rows: &[Rows], skins: &[Option<&Rows>], printed: &[Printed]) {
        let first = self.block.layers.start;
        let mut from = 0;
        for n in 0..rows.len() {
            self.audit.plain(lane.comb, &rows[n], self.line_width);
            if !self.grouping.ends(lane.phase, first + n, self.block) {
                continue;
            }
            let group = from..n + 1;
            let whole = printed[n].iter().find(|(layers, _)| *layers as usize == group.len());
            let full = group.len() == self.grouping.ratio();
            let whole = whole.map(|(_, rows)| rows);
            let apart = apart(lane.comb, &rows[group.clone()], &skins[group], whole, full);
            self.audit.kept_apart.add(apart);
            from = n + 1;
        }
    }

    /// The lines of each layer. Thick ones carry the material of those that are too
    /// short to be printed.
    fn finish(mut self) -> (Vec<Vec<Hatch>>, Audit) {
        let w = self.line_width;
        let all = || self.hatches.iter().flatten();
        let material = |h: &Hatch| i64::from(h.layers) * h.length(w);
        let thick: i64 = all().filter(|h| h.layers > 1).map(material).sum();
        let lost = self.audit.plain - all().map(material).sum::<i64>();
        if thick > 0 && lost > 0 {
            let most = i64::from(w) * MOST_WIDENED / 100;
            let wider = ((i64::from(w) * lost + thick / 2) / thick).min(most) as Coord;
            let thick = self.hatches.iter_mut().flatten().filter(|h| h.layers > 1);
            thick.for_each(|hatch| hatch.width += wider);
        }
        for hatch in self.hatches.iter().flatten() {
            self.audit.printed(hatch, w);
        }
        (self.hatches, self.audit)
    }
}
