//! Slicer -> Regions, batch by batch: the rolling window of layers that need each other.
//!
//! Words: to *prepare* a layer is to make its walls and rows from its contours. To *divide* it is
//! to tell skin from infill. A *block* of layers is *filled* when dual injection has decided
//! which layer prints what.
//!
//! Algorithm: a layer is divided once the layers above that its top skins depend on are prepared.
//! A block is filled once all of it, and all layers it may share skin with, are divided. Each
//! call of `next` loads batches of layers until a block is ready, fills all ready blocks, and
//! hands on their regions. Layers and blocks run in parallel; results stay in layer order.
//!
//! Two kinds of values are kept for a layer. What neighbours read (rows, areas) stays until no
//! layer above needs it. What belongs to the layer alone (contours, walls, beads) is taken out
//! once, when its region is handed on. So memory holds a batch and a few layers, whatever the
//! height of the print.

mod shared;

use super::curved::{self, Above, CurvedTops};
use super::divide::{Divided, Examined, LayerAreas, Lower, divide, examine};
use super::dual;
use super::dual::audit::Audit;
use super::dual::groups::{Block, Grouping};
use super::dual::inner_skin::{self, Skins, without_threads};
use super::first_skin::{self, Turn};
use super::ironing::{self, Ironing};
use super::joined::{self, Filling, Laid};
use super::landing::{self, Floor};
use super::one_wall::{self, Opened};
use super::params::RegionParams;
use super::per_raster::skin_turn;
use super::prepare::{LayerRows, Own, prepare};
use super::queue::Queue;
use super::support::{SupportLayer, SupportPatterns};
use super::{Region, Skin, Sparse, tops};
use crate::geom::frame::Frame;
use crate::geom::spans::Rows;
use crate::geom::{Contour, polygon};
use crate::profile::DualPart;
use crate::slice::{Layer, Slicer};
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Makes the regions of a print in batches, from the bed upwards.
#[derive(Debug)]
pub struct Window<'a> {
    slicer: &'a Slicer<'a>,
    params: &'a RegionParams,
    grouping: &'a Grouping,
    support: Option<Support>,
    /// Tops that are laid along the surface.
    curved: Above<'a>,
    /// The next batch to be sliced.
    batch: usize,
    /// The last layer that is prepared, where that above decides about its walls.
    held: Option<(Own, LayerRows)>,
    /// What belongs to each layer alone.
    own: Queue<Own>,
    /// The layers themselves, as long as one above is not divided.
    layers: Queue<Arc<Layer>>,
    /// What the layers are divided by, as long as one above is not divided.
    examined: Queue<Examined>,
    /// Wall beads, bridges and overhangs of the layers that are divided.
    beads: Queue<Laid>,
    /// Rows of the layers that are prepared.
    rows: Queue<LayerRows>,
    /// Areas of the layers that are divided.
    areas: Queue<LayerAreas>,
    audits: Vec<Audit>,
}

/// The support of a print.
#[derive(Debug)]
pub struct Support {
    /// The patterns that fill it.
    pub patterns: SupportPatterns,
    /// Where it stands, by layer.
    pub layers: Vec<SupportLayer>,
}

impl<'a> Window<'a> {
    /// A window that begins at the bed.
    #[must_use]
    pub fn new(
        slicer: &'a Slicer<'a>,
        params: &'a RegionParams,
        grouping: &'a Grouping,
        support: Option<Support>,
    ) -> Self {
        Self {
            slicer,
            params,
            grouping,
            support,
            curved: Above::default(),
            batch: 0,
            held: None,
            own: Queue::default(),
            layers: Queue::default(),
            examined: Queue::default(),
            beads: Queue::default(),
            rows: Queue::default(),
            areas: Queue::default(),
            audits: Vec::new(),
        }
    }

    /// The same under tops that are laid along the surface.
    #[must_use]
    pub fn under(mut self, curved: Option<&'a dyn CurvedTops>) -> Self {
        self.curved = Above::new(curved, self.slicer.heights().count());
        self
    }

    /// Takes the audits of dual injection, block by block.
    #[must_use]
    pub fn audits(&mut self) -> Vec<Audit> {
        std::mem::take(&mut self.audits)
    }

    fn count(&self) -> usize {
        self.slicer.heights().count()
    }

    /// How many layers up and down the skin of a layer may be shared.
    fn skin_reach(&self) -> usize {
        let shares = self.grouping.shares(DualPart::InnerSkin);
        if shares { self.grouping.ratio() - 1 } else { 0 }
    }

    /// Slices and prepares the next batch, and divides the layers whose neighbours are prepared.
    fn load(&mut self) {
        let layers = self.slicer.block(self.batch);
        self.batch += 1;
        let cut = |layer: Layer| match self.curved.tops() {
            Some(curved) => curved.cut(layer),
            None => layer,
        };
        let prepared: Vec<(Own, LayerRows)> =
            layers.into_par_iter().map(|layer| prepare(cut(layer), self.params)).collect();
        let prepared = if self.params.one_wall.is_some() { self.open(prepared) } else { prepared };
        let (own, rows): (Vec<_>, Vec<_>) = prepared.into_iter().unzip();
        self.layers.extend(own.iter().map(|own| own.layer.clone()));
        self.own.extend(own);
        self.rows.extend(rows);
        let known = self.rows.end();
        let all = self.batch == self.slicer.blocks();
        let until = if all { known } else { known.saturating_sub(self.params.skins.top.max(1)) };
        let examine =
            |k: usize| Some(examine(self.own.get(k)?, &|k| self.rows.get(k), self.params));
        let examined: Vec<Examined> =
            (self.examined.end()..until).into_par_iter().filter_map(examine).collect();
        self.examined.extend(examined);
        let divided: Vec<Divided> =
            (self.areas.end()..until).into_par_iter().filter_map(|k| self.divide(k)).collect();
        for Divided { areas, beads, room_beads, filling, bridges, hanging } in divided {
            self.areas.extend([areas]);
            self.beads.extend([Laid { beads, room_beads, filling, bridges, hanging }]);
        }
        self.layers.forget(until.saturating_sub(1));
        self.examined.forget(until.saturating_sub(1));
    }

    /// Layers with tops that have the outer wall alone, where they have any. The last one is held back
    /// until that above is known.
    fn open(&mut self, prepared: Vec<(Own, LayerRows)>) -> Vec<(Own, LayerRows)> {
        let mut all: Vec<(Own, LayerRows)> = self.held.take().into_iter().chain(prepared).collect();
        let ends = self.batch == self.slicer.blocks();
        let count = if ends { all.len() } else { all.len().saturating_sub(1) };
        let open = |k: usize| {
            let (own, rows) = &all[k];
            one_wall::open(own, rows, all.get(k + 1).map(|(_, rows)| rows), self.params)
        };
        let opened: Vec<Option<Opened>> = (0..count).into_par_iter().map(open).collect();
        self.held = all.drain(count..).next();
        let apply = |((own, rows), opened): ((Own, LayerRows), Option<Opened>)| match opened {
            Some(opened) => opened.apply(own, rows, self.params),
            None => (own, rows),
        };
        all.into_par_iter().zip(opened).map(apply).collect()
    }

    /// Layer `k`, divided on both rasters of skins and on those of its block's infill. `None` if the
    /// layer is not in the window.
    fn divide(&self, k: usize) -> Option<Divided> {
        let block = self.grouping.block(k, self.count());
        let patterns = dual::patterns(&block, self.grouping, &self.params.sparse);
        let rasters = patterns.iter().map(|pattern| pattern.raster());
        let lower = |k: usize| {
            let (layer, examined) = (self.layers.get(k)?, self.examined.get(k)?);
            Some(Lower { layer, examined, lines: self.lines(k) })
        };
        let below = k.checked_sub(1).and_then(lower);
        let (own, examined) = (self.own.get(k)?, self.examined.get(k)?);
        let layers = |k: usize| self.rows.get(k);
        Some(divide(own, examined, rasters, &layers, below.as_ref(), self.params))
    }

    /// The next blocks that can be filled.
    fn ready(&self) -> Vec<Block> {
        let divided = self.areas.end();
        let all = divided == self.count();
        let until = if all { divided } else { divided.saturating_sub(2 * self.skin_reach()) };
        let mut blocks = Vec::new();
        let mut from = self.own.start();
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
        let layers = block.layers.clone();
        let ironed: Vec<Option<Ironing>> =
            layers.clone().into_par_iter().map(|k| self.ironing(k)).collect();
        let (skins, areas): (Vec<_>, Vec<_>) =
            layers.into_par_iter().filter_map(|k| self.skins(k)).unzip();
        let (infill, audit) = self.infill(block, areas);
        let (support, support_audit) = self.share_support(block);
        let above = block.layers.clone().map(|k| self.above(k));
        let ironed = ironed.into_iter().zip(above);
        let lines = infill.into_iter().zip(support);
        let shared = self.share_walls(block).into_iter().zip(self.share_beads(block));
        let fillings = skins.into_iter().zip(lines).zip(shared).zip(ironed).map(
            |(((skins, (infill, support)), (walls, room_beads)), (ironing, above))| Filling {
                skins,
                infill,
                support,
                walls,
                room_beads,
                ironing,
                above,
            },
        );
        (fillings.collect(), audit.into_iter().chain(support_audit).collect())
    }

    /// The layer above layer `k`, if lines have to know what it leaves bare.
    fn above(&self, k: usize) -> Option<Arc<Layer>> {
        self.curved.tops().and_then(|_| Some(self.own.get(k + 1)?.layer.clone()))
    }

    /// The infill of a block of these areas. Near a curved top it is printed layer by layer.
    fn infill(
        &self,
        block: &Block,
        areas: Vec<Cow<'_, LayerAreas>>,
    ) -> (Vec<Vec<Sparse>>, Option<Audit>) {
        let (turns, line_width) = (&self.params.sparse, self.params.walls.line_width);
        let shared =
            |areas: Vec<&LayerAreas>| dual::infill(block, &areas, self.grouping, turns, line_width);
        let is_shared = self.grouping.shares(DualPart::Infill);
        let thin = || self.thin_places(block.layers.clone());
        let places = if is_shared { thin() } else { Vec::new() };
        if places.is_empty() {
            return shared(areas.iter().map(Cow::as_ref).collect());
        }
        let divided = areas.iter().map(|areas| curved::divide(areas, &places));
        let (others, thin): (Vec<_>, Vec<_>) = divided.map(|[others, thin]| (others, thin)).unzip();
        let (mut infill, audit) = shared(others.iter().collect());
        let thin = curved::thin_infill(block, &thin, self.grouping, turns, line_width);
        infill.iter_mut().zip(thin).for_each(|(infill, thin)| infill.extend(thin));
        (infill, audit)
    }

    /// Where none of these layers may print a line for several: near a curved top.
    fn thin_places(&self, layers: Range<usize>) -> Vec<Contour> {
        self.curved.near(self.slicer.heights(), layers, self.params.skins.top)
    }

    /// Whether all skins and walls of layer `k` are for it alone: a curved top lies near above it.
    fn is_thin(&self, k: usize) -> bool {
        self.curved.is_near(self.slicer.heights(), k, self.params.skins.top)
    }

    /// What of layer `k` is ironed.
    fn ironing(&self, k: usize) -> Option<Ironing> {
        let params = self.params.ironing.as_ref().filter(|_| self.params.skins.top > 0)?;
        let cover = |k: usize| self.rows.get(k).map(|rows| &rows.skin(0).cover);
        // Most layers leave nothing bare.
        let leaves = |above: &Rows| Some(!cover(k)?.minus(above).is_empty());
        cover(k + 1).is_none_or(|above| leaves(above).unwrap_or(true)).then_some(())?;
        let above = self.own.get(k + 1).map_or(&[] as &[Contour], |above| &above.layer.contours);
        let curved = self.curved_above(k);
        let all;
        let above = if curved.is_empty() {
            above
        } else {
            all = polygon::union(&[above, &curved].concat());
            &all
        };
        ironing::ironing(&self.own.get(k)?.layer, above, params)
    }

    /// Where a curved top lies right on layer `k`.
    fn curved_above(&self, k: usize) -> Vec<Contour> {
        let (top, height) = (self.slicer.heights().top(k), self.slicer.heights().height(k));
        self.curved.tops().map(|tops| tops.over(top - height, top + height)).unwrap_or_default()
    }

    /// The skins of layer `k`, and what they leave of its areas; `None` if it is not divided. The
    /// first has the raster of the layer's beads.
    fn skins(&self, k: usize) -> Option<(Vec<Skin>, Cow<'_, LayerAreas>)> {
        let areas = self.areas.get(k)?;
        let mut left = Cow::Borrowed(areas);
        let (along, across) = skin_turn(k);
        let floor = self.floor(k);
        let mut skins = Vec::new();
        for (layers, skin) in self.printed(k, areas) {
            let (kept, turned) = match self.along(k, layers) {
                Some(below) => {
                    let turn = Turn { pitch: self.params.skins.line_width, left: along == 0 };
                    first_skin::divide(skin, below, turn)
                }
                None => (skin, None),
            };
            let turned = turned.map(|[rows, columns]| ((across, along), [columns, rows]));
            for ((r, other), mut skin) in std::iter::once(((along, across), kept)).chain(turned) {
                if let Some(floor) = floor.as_ref().filter(|_| layers == 1) {
                    skin = landing::land(skin, r, &mut left, floor, &self.params.rasters);
                }
                for (part, top) in self.tops(k, (r, other), layers, skin) {
                    let skin = Skin::on(self.params, (r, other), layers, areas, part);
                    skins.push(Skin { top, ..skin });
                }
            }
        }
        Some((skins, left))
    }

    /// What of the skin of layer `k`, on two rasters, is seen from above, and what not. What is printed
    /// for several layers never is.
    fn tops(
        &self,
        k: usize,
        (along, across): (usize, usize),
        layers: u32,
        skin: first_skin::Both,
    ) -> Vec<(first_skin::Both, bool)> {
        if layers > 1 || !self.params.tops || self.params.skins.top == 0 {
            return vec![(skin, false)];
        }
        let covers = [along, across].map(|r| Some(&self.rows.get(k + 1)?.skin(r).cover));
        tops::divide(skin, covers, (self.params.skins.line_width, self.params.beads.overlap))
    }

    /// The skin of layer `k` by the number of layers that it is printed for, on the raster of its
    /// lines and across.
    fn printed(&self, k: usize, areas: &LayerAreas) -> Vec<(u32, first_skin::Both)> {
        let (along, across) = skin_turn(k);
        if !self.grouping.shares(DualPart::InnerSkin) {
            return vec![(1, [along, across].map(|r| areas.skin(r).skin.clone()))];
        }
        let mut shared = self.share_skin(k);
        shared.swap(0, along);
        let [(thick, thin), (thick_across, thin_across)] = shared;
        let (whole, pitch) = (&areas.skin(across).skin, self.params.skins.line_width);
        let thin_across = without_threads(&thin_across, whole, pitch);
        let mut printed = vec![(1, [thin, thin_across].map(Arc::new))];
        for (layers, rows) in thick {
            let columns = thick_across.iter().find(|(count, _)| *count == layers);
            let columns = columns.map(|(_, rows)| rows.clone()).unwrap_or_default();
            printed.push((layers, [rows, columns].map(Arc::new)));
        }
        printed
    }

    /// The sparse infill below layer `k`, if skin has to end on it.
    fn floor(&self, k: usize) -> Option<Floor<'_>> {
        let below = k.checked_sub(1).filter(|_| self.params.skins.across_infill)?;
        let block = self.grouping.block(below, self.count());
        let patterns = dual::patterns(&block, self.grouping, &self.params.sparse);
        let line_width = self.params.skins.line_width;
        let thick = block.layers.contains(&k) && self.grouping.shares(DualPart::Infill);
        let least_rows = if thick { landing::LEAST_ROWS_IN_THICK } else { 1 };
        Some(Floor { areas: self.areas.get(below)?, patterns, line_width, least_rows })
    }

    /// The sparse infill below what layer `k` prints for `layers`, if its lines run in the direction
    /// that skin has on layer `k`.
    fn along(&self, k: usize, layers: u32) -> Option<&Rows> {
        let below = k.checked_sub(layers as usize)?;
        let frame = self.params.rasters.skin(skin_turn(k).0).frame;
        let alike = self.lines(below).is_some_and(|lines| lines.is_parallel(frame));
        let areas = self.areas.get(below).filter(|_| alike)?;
        Some(&areas.skin(skin_turn(k).0).infill)
    }

    /// The direction of the sparse lines of layer `k`, if they have only one and skin above has to
    /// run across.
    fn lines(&self, k: usize) -> Option<Frame> {
        let block = self.grouping.block(k, self.count());
        let patterns = dual::patterns(&block, self.grouping, &self.params.sparse);
        let mut frames = patterns.iter().map(|pattern| pattern.raster().frame);
        let first = frames.next().filter(|_| self.params.skins.across_infill)?;
        frames.all(|frame| frame.is_parallel(first)).then_some(first)
    }

    /// The skin of layer `k` on both rasters of skins: that printed for several layers, and that for
    /// this one alone.
    fn share_skin(&self, k: usize) -> [(Vec<(u32, Rows)>, Rows); 2] {
        let skins = |r: usize| Skins {
            layers: |k| self.rows.get(k),
            skins: move |k| self.areas.get(k).map(|areas| &*areas.skin(r).skin),
            raster: self.params.rasters.skin(r),
            thin: |k| self.is_thin(k),
            ratio: self.grouping.ratio(),
            params: &self.params.skins,
        };
        inner_skin::share(&[0, 1].map(skins), k)
    }

    /// Joins `fillings` with what belongs to their layers, and drops what no layer needs any more.
    fn hand_on(&mut self, fillings: Vec<Filling>) -> Vec<Region> {
        let own = std::iter::from_fn(|| self.own.take().zip(self.beads.take()));
        let regions = fillings.into_iter().zip(own).map(|(filling, (own, laid))| {
            let k = own.layer.index;
            let above = self.rows.get(k + 1).map(|rows| &rows.skin(skin_turn(k).0).cover);
            let seen = self.params.tops && self.params.skins.top > 0;
            joined::region(filling, own, laid, seen.then_some(above))
        });
        let regions: Vec<Region> = regions.collect();
        let done = self.own.start();
        let below = self.skin_reach();
        let deepest = self.params.skins.bottom.max(1).max(if below > 0 { below + 1 } else { 0 });
        // The next layer's skin looks at the infill below it.
        self.areas.forget(done.saturating_sub(below + 1));
        self.rows.forget(done.saturating_sub(below + deepest));
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
