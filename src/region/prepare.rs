//! Layer -> its walls and rows: everything that it and its neighbours need of its contours.
//!
//! The result is two values. [`Own`] belongs to the layer and is consumed once. [`LayerRows`] is
//! what neighbours read; it is kept as long as one of them needs it.

use super::mitres::{self, Way};
use super::params::RegionParams;
use super::per_raster::PerRaster;
use super::scan::Scan;
use super::walls::{self, Wall, Walls, thin};
use crate::geom::Contour;
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;
use crate::slice::Layer;
use std::sync::Arc;

/// What a layer keeps for itself.
#[derive(Debug)]
pub struct Own {
    /// The layer.
    pub layer: Arc<Layer>,
    /// Its walls.
    pub walls: Vec<Wall>,
    /// The room for lines of skin and infill, where it is not all that the walls enclose.
    pub core: Option<Vec<Contour>>,
    /// The ways along its innermost loops beside corners that reach further inwards than the rows' inset.
    pub mitres: Vec<Way>,
    /// Area that is too thin for any bead, mm².
    pub thin_mm2: f64,
    /// What it would be without tops that have the outer wall alone; `None` if it has none.
    pub whole: Option<Whole>,
}

/// A layer as it would be with all walls everywhere.
#[derive(Debug)]
pub struct Whole {
    /// Its innermost loops.
    pub innermost: Vec<Contour>,
    /// Its fill rows on the rasters of skins.
    pub fill: [Arc<Rows>; 2],
    /// Its tops on the same.
    pub tops: [Rows; 2],
}

/// The rows of a layer on each raster in use.
pub type LayerRows = PerRaster<PreparedRows>;

/// One raster's rows of a layer.
#[derive(Debug, Default)]
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
    let may_be_thin = thin::may_be_thin(&layer.contours, skins.map(Scan::inside), &params.walls);
    let Walls { walls, core, lost_mm2: thin_mm2 } =
        walls::walls(&layer.contours, may_be_thin, &params.walls);
    let mitres = mitres::mitres(&walls, &params.walls);
    let rows = |raster: Raster, scan: &Scan| PreparedRows {
        fill: Arc::new(fill(scan, core.as_deref(), &mitres, raster, params)),
        cover: scan.inset(params.insets.cover),
    };
    let rows = PerRaster::new(&params.rasters, params.rasters.iter(), |raster| {
        scans.on(raster).map_or_else(PreparedRows::default, |scan| rows(raster, scan))
    });
    (Own { layer: Arc::new(layer), walls, core, mitres, thin_mm2, whole: None }, rows)
}

/// Where lines of skin or infill may run on `raster`: the scanned contours inset by their walls, beside
/// the `mitres` of these, and within the `core` that they leave.
#[must_use]
pub fn fill(
    scan: &Scan,
    core: Option<&[Contour]>,
    mitres: &[Way],
    raster: Raster,
    params: &RegionParams,
) -> Rows {
    let mut rows = scan.inset(params.insets.fill);
    if !mitres.is_empty() {
        rows = rows.minus(&mitres::taken(mitres, raster, params));
    }
    match core {
        Some(core) => rows.and(&Scan::new(core, raster).outset(params.insets.core)),
        None => rows,
    }
}
