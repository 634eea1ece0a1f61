//! Surface + beads -> Map: how high the plastic nearest to the surface is over each sample.
//!
//! Words used here: a *tile* is a square of cells whose lowest and highest samples are known, so that beads
//! far above or below are left out at once.
//!
//! The highest of all beads over a sample counts that is no higher than [`WINDOW`] layers
//! above it. The order of beads does not matter, so they are drawn side by side.

use super::bead::{Bead, is_of_part};
use super::surface::{Grid, Sample, Surface};
use super::{COVERED, WINDOW};
use crate::reader::Stream;
use crate::reader::print::Step;
use crate::units::{Coord, UNITS_PER_MM};
use rayon::prelude::*;
use std::io;
use std::sync::atomic::{AtomicI32, Ordering};

/// No plastic.
const NOTHING: i32 = i32::MIN;

/// Cells of a tile along a side.
const TILE: usize = 32;

/// Moves that are drawn at once: enough for all threads.
const BATCH: usize = 1 << 16;

/// The true surface and the plastic over it.
#[derive(Debug)]
pub(super) struct Map {
    pub(super) grid: Grid,
    pub(super) samples: Vec<Sample>,
    /// Where the samples of each cell begin; one more at the end.
    starts: Vec<u32>,
    /// Lowest and highest sample of each tile, grid units.
    tiles: Vec<[Coord; 2]>,
    /// The highest plastic over each sample, grid units, or [`NOTHING`].
    tops: Vec<AtomicI32>,
    /// Height of a layer, grid units.
    layer: f64,
}

impl Map {
    /// The samples of a surface, with nothing on them; `layer` is the height of a layer, mm.
    pub(super) fn new(surface: &Surface, cell: Coord, layer: f64) -> Self {
        let grid = surface.grid(cell);
        let samples = surface.samples(&grid);
        let mut starts = vec![0_u32; grid.size[0] * grid.size[1] + 1];
        for sample in &samples {
            starts[sample.cell as usize + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        let width = grid.size[0].div_ceil(TILE);
        let mut tiles = vec![[Coord::MAX, Coord::MIN]; width * grid.size[1].div_ceil(TILE)];
        for sample in &samples {
            let (row, place) =
                (sample.cell as usize / grid.size[0], sample.cell as usize % grid.size[0]);
            let tile = &mut tiles[row / TILE * width + place / TILE];
            *tile = [tile[0].min(sample.z), tile[1].max(sample.z)];
        }
        let tops = samples.iter().map(|_| AtomicI32::new(NOTHING)).collect();
        Self { grid, samples, starts, tiles, tops, layer: layer * UNITS_PER_MM }
    }

    /// Draws the beads of a file, seen from `origin` and lower by `lift`, mm.
    ///
    /// # Errors
    /// What reading gives.
    pub(super) fn draw(&mut self, stream: &Stream, origin: [f64; 2], lift: f64) -> io::Result<()> {
        let facts = stream.facts();
        let mut some: Vec<Step> = Vec::new();
        let draw = |some: &mut Vec<Step>| {
            let beads = some.par_iter().map(|step| Bead::of(step, origin, lift));
            beads.for_each(|bead| self.bead(&bead));
            some.clear();
        };
        for section in stream.sections() {
            let section = section?;
            if section.layer.is_some() {
                some.extend(section.moves.into_iter().filter(|step| is_of_part(step, facts)));
            }
            if some.len() >= BATCH {
                draw(&mut some);
            }
        }
        draw(&mut some);
        Ok(())
    }

    /// Draws one bead.
    pub(super) fn bead(&self, bead: &Bead) {
        let window = WINDOW * self.layer;
        let [lowest, highest] = bead.tops();
        let width = self.grid.size[0].div_ceil(TILE);
        let [front, back] = bead.rows();
        let (first, last) = self.grid.range(1, front, back);
        for row in first..last {
            let y = self.grid.middle(1, row);
            let Some([left, right]) = bead.chord(y) else { continue };
            let (mut place, end) = self.grid.range(0, left, right);
            while place < end {
                let tile = place / TILE;
                let until = end.min((tile + 1) * TILE);
                let [low, high] = self.tiles[row / TILE * width + tile].map(f64::from);
                if highest >= low - window && lowest <= high + window {
                    self.cells(bead, (row, y), place..until);
                }
                place = until;
            }
        }
    }

    /// Draws what a bead covers of a stretch of a row.
    fn cells(&self, bead: &Bead, (row, y): (usize, f64), places: std::ops::Range<usize>) {
        let window = (WINDOW * self.layer).round() as i64;
        for place in places {
            let cell = row * self.grid.size[0] + place;
            let samples = self.starts[cell] as usize..self.starts[cell + 1] as usize;
            if samples.is_empty() {
                continue;
            }
            let top = bead.top([self.grid.middle(0, place), y]).round() as Coord;
            for sample in samples {
                if i64::from(top) <= i64::from(self.samples[sample].z) + window {
                    self.tops[sample].fetch_max(top, Ordering::Relaxed);
                }
            }
        }
    }

    /// Takes all plastic away.
    pub(super) fn clear(&mut self) {
        self.tops.iter_mut().for_each(|top| *top.get_mut() = NOTHING);
    }

    /// How much higher than a sample the plastic over it is, straight up, mm; `None` if there is none as
    /// near as [`WINDOW`] layers.
    pub(super) fn over(&self, sample: usize) -> Option<f64> {
        let top = self.tops[sample].load(Ordering::Relaxed);
        let over = f64::from(top) - f64::from(self.samples[sample].z);
        (top != NOTHING && over >= -WINDOW * self.layer).then_some(over / UNITS_PER_MM)
    }

    /// Whether plastic that is so much higher than the surface, mm, covers it.
    pub(super) fn covers(&self, over: Option<f64>) -> bool {
        over.is_some_and(|over| over.abs() * UNITS_PER_MM <= COVERED * self.layer)
    }

    /// Share of the samples that have plastic near, and of those that it covers.
    pub(super) fn fit(&self) -> [f64; 2] {
        let all = || (0..self.samples.len()).map(|sample| self.over(sample));
        let near = all().filter(Option::is_some).count();
        let covered = all().filter(|over| self.covers(*over)).count();
        [near, covered].map(|count| count as f64 / self.samples.len().max(1) as f64)
    }

    /// How badly the plastic lies along the surface: the mean distance, mm, at most [`WINDOW`] layers each.
    pub(super) fn misfit(&self) -> f64 {
        let most = WINDOW * self.layer / UNITS_PER_MM;
        let off = |sample| self.over(sample).map_or(most, |over| over.abs().min(most));
        (0..self.samples.len()).map(off).sum::<f64>() / self.samples.len().max(1) as f64
    }
}
