//! Slicer -> Regions, batch by batch: the rolling window of layers that need each other.
//!
//! A layer is divided into skin and infill once the layers above that its top
//! skins look at are there, and is forgotten once no layer above looks at it:
//! memory holds a block and a few layers, whatever the height of the print.

use super::audit::Audit;
use super::classify::{Areas, areas};
use super::close::{Crossed, close};
use super::dual::{self, LayerAreas};
use super::groups::{Block, Grouping};
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
    layers: VecDeque<Prepared>,
    /// Index of the first layer in the window.
    first: usize,
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

/// What classification finds for one layer, before it takes its walls along.
struct Filling {
    skin: Skin,
    infill: Vec<Hatch>,
    support: Vec<Hatch>,
    /// How many layers each wall is printed for.
    walls: Vec<u32>,
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
            layers: VecDeque::new(),
            first: 0,
            done: 0,
            audits: Vec::new(),
        }
    }

    /// What dual injection did, block by block. Nothing is left of it afterwards.
    #[must_use]
    pub fn audits(&mut self) -> Vec<Audit> {
        std::mem::take(&mut self.audits)
    }

    /// Slices and prepares the next batch.
    fn load(&mut self) {
        let layers = self.slicer.block(self.batch);
        self.batch += 1;
        let prepared: Vec<Prepared> =
            layers.into_par_iter().map(|layer| Prepared::new(layer, self.params)).collect();
        self.layers.extend(prepared);
    }

    /// The next blocks whose layers have all they need.
    fn ready(&self) -> Vec<Block> {
        let count = self.slicer.heights().count;
        let known = self.first + self.layers.len();
        let all = self.batch == self.slicer.blocks();
        let until = if all { known } else { known.saturating_sub(self.params.top_skins.max(1)) };
        let mut blocks = Vec::new();
        let mut from = self.done;
        while from < until {
            let block = self.grouping.block(from, count);
            from = block.layers.end;
            if from <= until {
                blocks.push(block);
            }
        }
        blocks
    }

    fn layer(&self, k: usize) -> Option<&Prepared> {
        k.checked_sub(self.first).and_then(|k| self.layers.get(k))
    }

    /// Divides the layers of a block.
    fn fill(&self, block: &Block) -> (Vec<Filling>, Vec<Audit>) {
        let combs = dual::combs(block, self.grouping, self.params);
        let areas: Vec<LayerAreas> = block
            .layers
            .clone()
            .into_par_iter()
            .map(|k| self.areas(k, combs.iter().map(|c| c.raster)))
            .collect();
        let (infill, audit) = dual::infill(block, &areas, self.grouping, self.params);
        let (support, support_audit) = self.share_support(block);
        let lines = infill.into_iter().zip(support).zip(self.share_walls(block));
        let fillings = block.layers.clone().zip(&areas).zip(lines).map(
            |((k, areas), ((infill, support), walls))| Filling {
                skin: self.skin(k, areas),
                infill,
                support,
                walls,
            },
        );
        (fillings.collect(), audit.into_iter().chain(support_audit).collect())
    }

    /// How many layers each wall of each layer of a block is printed for.
    fn share_walls(&self, block: &Block) -> Vec<Vec<u32>> {
        let walls = |k| self.layer(k).map_or(&[] as &[Wall], |layer| &layer.walls);
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

    /// The areas of layer `k` on both skin rasters and on those that `more` names.
    fn areas(&self, k: usize, more: impl Iterator<Item = usize>) -> LayerAreas {
        let mut out: LayerAreas = vec![None; self.params.rasters.len()];
        for r in [0, 1].into_iter().chain(more) {
            if out[r].is_none() {
                out[r] = Some(areas(k, r, &|k| self.layer(k), self.params));
            }
        }
        out
    }

    /// The skin of layer `k`, closed up to the walls.
    fn skin(&self, k: usize, areas: &LayerAreas) -> Skin {
        let (along, across) = self.params.skin_rasters(k);
        let none = Areas::default();
        let of = |r: usize| areas[r].as_ref().unwrap_or(&none);
        let Some(layer) = self.layer(k) else { return Skin::default() };
        let crossed = Crossed {
            skin: &of(along).skin,
            fill: &layer.rows[along].fill,
            columns: &of(across).skin,
            fill_columns: &layer.rows[across].fill,
            left_turn: along == 0,
        };
        let (lines, slivers) = close(&crossed, self.params);
        Skin { raster: along, lines, slivers }
    }

    /// The regions of the layers that `fillings` were made for, in order.
    fn hand_on(&mut self, fillings: Vec<Filling>) -> Vec<Region> {
        let mut regions = Vec::with_capacity(fillings.len());
        for Filling { skin, infill, support, walls: printed } in fillings {
            let prepared = &mut self.layers[self.done - self.first];
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
