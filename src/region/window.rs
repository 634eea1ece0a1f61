//! Slicer -> Regions, batch by batch: the rolling window of layers that need each other.
//!
//! A layer is divided into skin and infill once the layers above that its top
//! skins look at are there; a block of layers is handed on once all of it, and what
//! it shares skins with, is divided. A layer is forgotten once no layer above looks at
//! it: memory holds a batch and a few layers, whatever the height of the print.

use super::classify::Areas;
use super::divide::divide;
use super::dual::audit::Audit;
use super::dual::groups::{Block, Grouping};
use super::dual::inner_skin::Skins;
use super::dual::{self, LayerAreas};
use super::gap_closing::{Crossed, close};
use super::wall_beads::Bead;
use super::walls::{self, Wall};
use super::{Comb, Hatch, Params, Prepared, Region, Skin};
use crate::geom::spans::Rows;
use crate::profile::DualPart;
use crate::slice::Slicer;
use rayon::prelude::*;
use std::collections::VecDeque;

/// Makes the regions of a print in batches, from the bed upwards.
#[derive(Debug)]
pub struct Window<'a> {
    slicer: &'a Slicer<'a>,
    params: &'a Params,
    grouping: &'a Grouping,
    support: Option<Support>,
    /// The next batch to be sliced.
    batch: usize,
    layers: Queue<Prepared>,
    /// Those divided into skin and infill.
    divided: Queue<Divided>,
    /// Layers handed on so far.
    done: usize,
    audits: Vec<Audit>,
}

/// The support of a print.
#[derive(Debug)]
pub struct Support {
    /// Its lines.
    pub comb: Comb,
    /// Where they stand, by layer.
    pub rows: Vec<Rows>,
}

/// A layer's areas and the beads along its walls.
#[derive(Debug)]
struct Divided {
    areas: LayerAreas,
    beads: Vec<Bead>,
}

/// What classification finds for one layer, before it takes its walls along.
struct Filling {
    skins: Vec<Skin>,
    infill: Vec<Hatch>,
    support: Vec<Hatch>,
    /// How many layers each wall is printed for.
    walls: Vec<u32>,
}

/// Values of successive layers, of which the first are forgotten.
#[derive(Debug)]
struct Queue<T> {
    first: usize,
    values: VecDeque<T>,
}

impl<T> Default for Queue<T> {
    fn default() -> Self {
        Self { first: 0, values: VecDeque::new() }
    }
}

impl<T> Queue<T> {
    /// One more than the last layer.
    fn end(&self) -> usize {
        self.first + self.values.len()
    }

    fn get(&self, k: usize) -> Option<&T> {
        k.checked_sub(self.first).and_then(|k| self.values.get(k))
    }

    /// Forgets the layers before `k`.
    fn forget(&mut self, k: usize) {
        while self.first < k && self.values.pop_front().is_some() {
            self.first += 1;
        }
    }
}

impl<'a> Window<'a> {
    /// A window at the bed.
    #[must_use]
    pub fn new(
        slicer: &'a Slicer<'a>,
        params: &'a Params,
        grouping: &'a Grouping,
        support: Option<Support>,
    ) -> Self {
        Self {
            slicer,
            params,
            grouping,
            support,
            batch: 0,
            layers: Queue::default(),
            divided: Queue::default(),
            done: 0,
            audits: Vec::new(),
        }
    }

    /// What dual injection did, block by block. Nothing is left of it afterwards.
    #[must_use]
    pub fn audits(&mut self) -> Vec<Audit> {
        std::mem::take(&mut self.audits)
    }

    fn count(&self) -> usize {
        self.slicer.heights().count
    }

    /// How many layers up and down a layer's skin may depend on another's.
    fn skin_reach(&self) -> usize {
        let shares = self.grouping.shares(DualPart::InnerSkin);
        if shares { self.grouping.ratio() - 1 } else { 0 }
    }

    /// Slices and prepares the next batch, and divides the layers whose neighbours are there.
    fn load(&mut self) {
        let layers = self.slicer.block(self.batch);
        self.batch += 1;
        let prepared: Vec<Prepared> =
            layers.into_par_iter().map(|layer| Prepared::new(layer, self.params)).collect();
        self.layers.values.extend(prepared);
        let known = self.layers.end();
        let all = self.batch == self.slicer.blocks();
        let until = if all { known } else { known.saturating_sub(self.params.top_skins.max(1)) };
        let divided: Vec<Divided> =
            (self.divided.end()..until).into_par_iter().map(|k| self.divide(k)).collect();
        self.divided.values.extend(divided);
    }

    /// The areas of layer `k` on both skin rasters and on those of its block's infill, and
    /// the beads along its walls.
    fn divide(&self, k: usize) -> Divided {
        let block = self.grouping.block(k, self.count());
        let combs = dual::combs(&block, self.grouping, self.params);
        let rasters = combs.iter().map(|c| c.raster);
        let (areas, beads) = divide(k, rasters, &|k| self.layers.get(k), self.params);
        Divided { areas, beads }
    }

    /// The next blocks whose layers have all they need.
    fn ready(&self) -> Vec<Block> {
        let divided = self.divided.end();
        let all = divided == self.count();
        let until = if all { divided } else { divided.saturating_sub(2 * self.skin_reach()) };
        let mut blocks = Vec::new();
        let mut from = self.done;
        while from < until {
            let block = self.grouping.block(from, self.count());
            from = block.layers.end;
            if from <= until {
                blocks.push(block);
            }
        }
        blocks
    }

    /// Fills the layers of a block.
    fn fill(&self, block: &Block) -> (Vec<Filling>, Vec<Audit>) {
        let none = LayerAreas::new();
        let layers = block.layers.clone();
        let areas: Vec<&LayerAreas> =
            layers.clone().map(|k| self.divided.get(k).map_or(&none, |d| &d.areas)).collect();
        let (infill, audit) = dual::infill(block, &areas, self.grouping, self.params);
        let (support, support_audit) = self.share_support(block);
        let skins: Vec<Vec<Skin>> = layers.into_par_iter().map(|k| self.skins(k)).collect();
        let lines = infill.into_iter().zip(support).zip(self.share_walls(block));
        let fillings = skins
            .into_iter()
            .zip(lines)
            .map(|(skins, ((infill, support), walls))| Filling { skins, infill, support, walls });
        (fillings.collect(), audit.into_iter().chain(support_audit).collect())
    }

    /// How many layers each wall of each layer of a block is printed for.
    fn share_walls(&self, block: &Block) -> Vec<Vec<u32>> {
        let walls = |k| self.layers.get(k).map_or(&[] as &[Wall], |layer| &layer.walls);
        let layers: Vec<&[Wall]> = block.layers.clone().map(walls).collect();
        if self.grouping.shares(DualPart::InnerWalls) {
            walls::share(block, &layers, self.grouping, self.params)
        } else {
            layers.iter().map(|walls| vec![1; walls.len()]).collect()
        }
    }

    /// The support of each layer of a block.
    fn share_support(&self, block: &Block) -> (Vec<Vec<Hatch>>, Option<Audit>) {
        let Some(support) = &self.support else {
            return (vec![Vec::new(); block.layers.len()], None);
        };
        let rows = &support.rows[block.layers.clone()];
        dual::support(block, rows, support.comb, self.grouping, self.params.line_width)
    }

    /// The areas of layer `k` on raster `r`, if it is divided.
    fn areas(&self, k: usize, r: usize) -> Option<&Areas> {
        self.divided.get(k)?.areas.get(r)?.as_ref()
    }

    /// The skins of layer `k`, closed up to the walls.
    fn skins(&self, k: usize) -> Vec<Skin> {
        let (along, across) = self.params.skin_rasters(k);
        if !self.grouping.shares(DualPart::InnerSkin) {
            let none = Rows::default();
            let rows = |r: usize| self.areas(k, r).map_or(&none, |areas| &areas.skin);
            return vec![self.skin(k, 1, rows(along), rows(across))];
        }
        let ((thick, thin), (thick_across, thin_across)) =
            (self.share_skin(k, along), self.share_skin(k, across));
        let mut skins = vec![self.skin(k, 1, &thin, &thin_across)];
        for (layers, rows) in thick {
            let columns = thick_across.iter().find(|(count, _)| *count == layers);
            let columns = columns.map(|(_, rows)| rows.clone()).unwrap_or_default();
            skins.push(self.skin(k, layers, &rows, &columns));
        }
        skins
    }

    /// The skin of layer `k` on raster `r`: what is printed for several layers, and what for
    /// this one alone.
    fn share_skin(&self, k: usize, r: usize) -> (Vec<(u32, Rows)>, Rows) {
        let skins = Skins {
            layers: |k| self.layers.get(k),
            skins: |k| self.areas(k, r).map(|areas| &areas.skin),
            raster: r,
            ratio: self.grouping.ratio(),
            params: self.params,
        };
        skins.share(k)
    }

    /// The skin of layer `k` on these rows and columns, closed up to the walls.
    fn skin(&self, k: usize, layers: u32, rows: &Rows, columns: &Rows) -> Skin {
        let (along, across) = self.params.skin_rasters(k);
        let Some(layer) = self.layers.get(k) else { return Skin::default() };
        let left = |r: usize| self.areas(k, r).and_then(|areas| areas.fill.as_ref());
        let fill = |r: usize| left(r).unwrap_or(&layer.rows[r].fill);
        let crossed = Crossed {
            skin: rows,
            fill: fill(along),
            columns,
            fill_columns: fill(across),
            left_turn: along == 0,
        };
        let (lines, slivers) = close(&crossed, self.params);
        // Beads along walls are for this layer alone.
        let beads =
            self.divided.get(k).filter(|_| layers == 1).map_or(&[] as &[Bead], |d| &d.beads);
        Skin { layers, raster: along, lines, beads: [beads, &slivers].concat() }
    }

    /// The regions of the layers that `fillings` were made for, in order.
    fn hand_on(&mut self, fillings: Vec<Filling>) -> Vec<Region> {
        let mut regions = Vec::with_capacity(fillings.len());
        for Filling { skins, infill, support, walls: printed } in fillings {
            let prepared = &mut self.layers.values[self.done - self.layers.first];
            // Neighbours look at the rows only.
            let (walls, contours) =
                (std::mem::take(&mut prepared.walls), std::mem::take(&mut prepared.layer.contours));
            let layer = crate::slice::Layer { contours, ..prepared.layer.clone() };
            let thin_mm2 = walls::thin_area(&layer.contours, &walls, self.params);
            let walls = walls
                .into_iter()
                .zip(printed)
                .filter(|(_, layers)| *layers > 0)
                .map(|(wall, layers)| Wall { layers, ..wall })
                .collect();
            regions.push(Region { layer, walls, skins, infill, support, thin_mm2 });
            self.done += 1;
        }
        let below = self.skin_reach();
        let deepest = self.params.bottom_skins.max(if below > 0 { below + 1 } else { 0 });
        self.divided.forget(self.done.saturating_sub(below));
        self.layers.forget(self.done.saturating_sub(below + deepest));
        regions
    }
}

impl Iterator for Window<'_> {
    type Item = Vec<Region>;

    fn next(&mut self) -> Option<Vec<Region>> {
        let mut blocks = self.ready();
        while blocks.is_empty() && self.batch < self.slicer.blocks() {
            self.load();
            blocks = self.ready();
        }
        if blocks.is_empty() {
            return None;
        }
        let filled: Vec<_> = blocks.par_iter().map(|block| self.fill(block)).collect();
        let mut fillings = Vec::new();
        for (layers, audits) in filled {
            self.audits.extend(audits);
            fillings.extend(layers);
        }
        Some(self.hand_on(fillings))
    }
}
