//! Slicer -> Regions, batch by batch: the rolling window of layers that need each other.
//!
//! A layer is divided into skin and infill once the layers above that its top
//! skins look at are there, and is forgotten once no layer above looks at it:
//! memory holds a block and a few layers, whatever the height of the print.

use super::classify::Areas;
use super::close::{Crossed, close};
use super::divide::divide;
use super::dual::{self, LayerAreas, PairStats};
use super::rings::Bead;
use super::{Infill, Params, Prepared, Region, Skin, walls};
use crate::geom::spans::Rows;
use crate::profile::Dual;
use crate::slice::Slicer;
use rayon::prelude::*;
use std::collections::VecDeque;

/// Makes the regions of a print in batches, from the bed upwards.
#[derive(Debug)]
pub struct Window<'a> {
    slicer: &'a Slicer<'a>,
    params: &'a Params,
    dual: &'a Dual,
    /// Support by layer; empty if there is none.
    supports: Vec<Rows>,
    /// The next block to be sliced.
    block: usize,
    layers: VecDeque<Prepared>,
    /// Index of the first layer in the window.
    first: usize,
    /// Layers handed on so far.
    done: usize,
    stats: PairStats,
}

/// What classification finds for one layer, before it takes its walls along.
struct Filling {
    skin: Skin,
    infill: Vec<Infill>,
}

impl<'a> Window<'a> {
    /// A window at the bed. `supports` holds the support of every layer, or nothing.
    #[must_use]
    pub fn new(
        slicer: &'a Slicer<'a>,
        params: &'a Params,
        dual: &'a Dual,
        supports: Vec<Rows>,
    ) -> Self {
        Self {
            slicer,
            params,
            dual,
            supports,
            block: 0,
            layers: VecDeque::new(),
            first: 0,
            done: 0,
            stats: PairStats::default(),
        }
    }

    /// What dual injection did so far.
    #[must_use]
    pub fn pair_stats(&self) -> PairStats {
        self.stats
    }

    /// Slices and prepares the next block.
    fn load(&mut self) {
        let layers = self.slicer.block(self.block);
        self.block += 1;
        let prepared: Vec<Prepared> =
            layers.into_par_iter().map(|layer| Prepared::new(layer, self.params)).collect();
        self.layers.extend(prepared);
    }

    /// One more than the last layer that has all it needs; even unless the print ends.
    fn ready(&self) -> usize {
        let known = self.first + self.layers.len();
        if self.block == self.slicer.blocks() {
            return known;
        }
        known.saturating_sub(self.params.top_skins.max(1)) / 2 * 2
    }

    fn layer(&self, k: usize) -> Option<&Prepared> {
        k.checked_sub(self.first).and_then(|k| self.layers.get(k))
    }

    /// Divides the layers of a pair (or the single last layer).
    fn fill(&self, lower: usize, upper: Option<usize>) -> (Vec<Filling>, PairStats) {
        let count = self.slicer.heights().count;
        let Some(upper) = upper.filter(|_| dual::is_pair(lower, count, self.dual.mode)) else {
            let each = |k| {
                let more = dual::turn(k, self.params).iter().map(|c| c.raster);
                let (areas, beads) = self.areas(k, more);
                let infill = dual::plain(k, &areas, self.params);
                Filling { skin: self.skin(k, (&areas, beads)), infill }
            };
            return (
                [Some(lower), upper].into_iter().flatten().map(each).collect(),
                PairStats::default(),
            );
        };
        let combs = dual::pair_combs(lower / 2, self.dual, self.params);
        let (below, below_beads) = self.areas(lower, combs.iter().map(|c| c.raster));
        let (above, above_beads) = self.areas(upper, combs.iter().map(|c| c.raster));
        let (infill, stats) = dual::pair(lower / 2, &below, &above, self.dual, self.params);
        let skins =
            [self.skin(lower, (&below, below_beads)), self.skin(upper, (&above, above_beads))];
        let fillings =
            skins.into_iter().zip(infill).map(|(skin, infill)| Filling { skin, infill }).collect();
        (fillings, stats)
    }

    /// The areas of layer `k` on both skin rasters and on those that `more` names, and
    /// the beads along its walls.
    fn areas(&self, k: usize, more: impl Iterator<Item = usize>) -> (LayerAreas, Vec<Bead>) {
        divide(k, more, &|k| self.layer(k), self.params)
    }

    /// The skin of layer `k`, closed up to the walls.
    fn skin(&self, k: usize, (areas, beads): (&LayerAreas, Vec<Bead>)) -> Skin {
        let (along, across) = self.params.skin_rasters(k);
        let none = Areas::default();
        let of = |r: usize| areas[r].as_ref().unwrap_or(&none);
        let Some(layer) = self.layer(k) else { return Skin::default() };
        let fill = |r: usize| of(r).fill.as_ref().unwrap_or(&layer.rows[r].fill);
        let crossed = Crossed {
            skin: &of(along).skin,
            fill: fill(along),
            columns: &of(across).skin,
            fill_columns: fill(across),
            left_turn: along == 0,
        };
        let (lines, slivers) = close(&crossed, self.params);
        Skin { raster: along, lines, beads: [beads, slivers].concat() }
    }

    /// The regions of the layers that `fillings` were made for, in order.
    fn hand_on(&mut self, fillings: Vec<Filling>) -> Vec<Region> {
        let mut regions = Vec::with_capacity(fillings.len());
        for Filling { skin, infill } in fillings {
            let support = self.supports.get_mut(self.done).map(std::mem::take).unwrap_or_default();
            let prepared = &mut self.layers[self.done - self.first];
            // Neighbours look at the rows only.
            let (walls, contours) =
                (std::mem::take(&mut prepared.walls), std::mem::take(&mut prepared.layer.contours));
            let layer = crate::slice::Layer { contours, ..prepared.layer.clone() };
            let thin_mm2 = walls::thin_area(&layer.contours, &walls, self.params);
            regions.push(Region { layer, walls, skin, infill, support, thin_mm2 });
            self.done += 1;
        }
        while self.first + self.params.bottom_skins < self.done {
            self.layers.pop_front();
            self.first += 1;
        }
        regions
    }
}

impl Iterator for Window<'_> {
    type Item = Vec<Region>;

    fn next(&mut self) -> Option<Vec<Region>> {
        while self.block < self.slicer.blocks() && self.ready() <= self.done {
            self.load();
        }
        let ready = self.ready();
        if ready <= self.done {
            return None;
        }
        let pairs: Vec<usize> = (self.done..ready).step_by(2).collect();
        let filled: Vec<_> = pairs
            .par_iter()
            .map(|&lower| self.fill(lower, Some(lower + 1).filter(|&k| k < ready)))
            .collect();
        let mut fillings = Vec::with_capacity(ready - self.done);
        for (layers, stats) in filled {
            self.stats.add(stats);
            fillings.extend(layers);
        }
        Some(self.hand_on(fillings))
    }
}
