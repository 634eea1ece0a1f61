//! Layer -> its walls and rows: everything that it and its neighbours need of its contours.
//!
//! The result is two values. [`Own`] belongs to the layer and is consumed once. [`LayerRows`] is
//! what neighbours read; it is kept as long as one of them needs it.

use super::params::{Insets, RegionParams};
use super::per_raster::PerRaster;
use super::scan::Scan;
use super::strips::{self, Strip};
use super::thin;
use super::walls::{self, Wall};
use crate::geom::spans::Rows;
use crate::slice::Layer;
use std::sync::Arc;

/// What a layer keeps for itself.
#[derive(Debug)]
pub struct Own {
    /// The layer.
    pub layer: Layer,
    /// Its walls.
    pub walls: Vec<Wall>,
    /// The room inside each of its walls; empty if nothing can be too thin.
    pub strips: Vec<Strip>,
}

/// The rows of a layer on each raster in use.
pub type LayerRows = PerRaster<PreparedRows>;

/// One raster's rows of a layer.
#[derive(Debug)]
pub struct PreparedRows {
    /// Where lines of skin or infill may run.
    pub fill: Arc<Rows>,
    /// Where this layer covers its neighbours. Its walls count, so nearly up to its contour.
    pub cover: Rows,
}

/// Makes the walls of `layer` and scans it with every raster.
#[must_use]
pub fn prepare(layer: Layer, params: &RegionParams) -> (Own, LayerRows) {
    let scan = |raster| Scan::new(&layer.contours, raster);
    let scans = PerRaster::new(&params.rasters, params.rasters.iter(), scan);
    let skins = [scans.skin(0), scans.skin(1)];
    let may_be_thin = thin::may_be_thin(skins.map(Scan::inside), &params.walls);
    let walls = walls::walls(&layer.contours, may_be_thin, &params.walls);
    let Insets { fill, cover } = params.insets;
    let rows =
        |scan: &Scan| PreparedRows { fill: Arc::new(scan.inset(fill)), cover: scan.inset(cover) };
    let rows = scans.map(rows);
    let strips = if may_be_thin {
        let innermost = [0, 1].map(|r| &*rows.skin(r).fill);
        strips::strips(skins, &walls, innermost, params)
    } else {
        Vec::new()
    };
    (Own { layer, walls, strips }, rows)
}
