//! Layers -> Regions: what each place is for: walls, skin, sparse infill, support.
//!
//! Everything but the walls is computed on raster lines. Each layer's contours are scanned once
//! with every raster ([`mod@prepare`]). Then each layer combines its spans with those of its
//! neighbours by 1-D booleans ([`classify`]). Where skin is narrow, beads along the walls replace
//! its lines ([`wall_beads`]). They belong to this stage because lines must end at them. Dual
//! injection decides which layer prints what for which others ([`dual`]).
//!
//! Words: a *row* is one raster line of a layer, with its *spans*: the stretches inside something.
//! A *column* is a row of the raster across. The *fill rows* of a layer are where lines may run:
//! the layer inset by its walls.
//!
//! Guaranteed to the next stage: skin and sparse infill of a layer are disjoint; together with
//! the wall beads they are its fill rows. Spans are sorted, disjoint, never empty. How an area is
//! filled, and what to do where a line does not fit, is up to [`crate::fill`].

pub mod angle;
pub mod bridge;
pub mod classify;
pub mod crossed;
pub mod curved;
pub mod divide;
pub mod dual;
pub mod first_skin;
pub mod foot;
pub mod hidden;
pub mod ironing;
mod joined;
pub mod landing;
pub mod mitres;
mod near;
pub mod needed;
pub mod one_wall;
pub mod overhang;
pub mod params;
pub mod per_raster;
pub mod prepare;
mod queue;
pub mod rooms;
pub mod scan;
mod sides;
mod stretches;
pub mod support;
mod taper;
pub mod tops;
pub mod wall_beads;
mod wall_samples;
pub mod walls;
pub mod wedges;
pub mod window;

pub use params::RegionParams;

use crate::geom::Contour;
use crate::geom::polyline::Polyline;
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;
use crate::pattern::Pattern;
use crate::slice::Layer;
use crate::units::Coord;
use crossed::Crossed;
use divide::LayerAreas;
use ironing::Ironing;
use std::sync::Arc;
use walls::Wall;

/// What is to be printed on one layer.
#[derive(Debug)]
pub struct Region {
    /// The layer.
    pub layer: Arc<Layer>,
    /// The layer above, if lines have to know what it leaves bare.
    pub above: Option<Arc<Layer>>,
    /// Its walls.
    pub walls: Vec<Wall>,
    /// How far the way to each point of each wall hangs, % of the width; 0 up to half. No list for
    /// a wall that does not hang, no lists if none does.
    pub hangs: Vec<Vec<u8>>,
    /// Its skin: first that for this layer alone, then that printed for several, then bridges.
    pub skins: Vec<Skin>,
    /// Its sparse infill.
    pub infill: Vec<Sparse>,
    /// Where the nozzle goes over it once more.
    pub ironing: Option<Ironing>,
    /// Its support.
    pub support: SupportLines,
    /// Area that is too thin for a wall and so not printed, mm².
    pub thin_mm2: f64,
}

/// Support of one layer.
#[derive(Debug, Clone, Default)]
pub struct SupportLines {
    /// Its sparse lines.
    pub body: Vec<Sparse>,
    /// Dense lines next to the part.
    pub interface: Vec<Sparse>,
    /// Beads around what is sparse.
    pub outlines: Vec<Contour>,
}

impl SupportLines {
    /// All areas where its lines run.
    pub fn areas(&self) -> impl Iterator<Item = &Sparse> {
        self.body.iter().chain(&self.interface)
    }
}

/// Skin of one layer, on its raster and on the one across.
#[derive(Debug)]
pub struct Skin {
    /// How many layers it is printed for: this one and those below it.
    pub layers: u32,
    /// The raster of its lines.
    pub raster: Raster,
    /// The skin and the fill rows on its raster.
    pub rows: SkinRows,
    /// The same on the raster across.
    pub columns: SkinRows,
    /// The raster across is turned by +90° (else by −90°).
    pub left_turn: bool,
    /// Beads along walls where the skin is narrow, in the frame of its raster.
    pub beads: Vec<Polyline>,
    /// The same in rooms too narrow for sparse lines, where nothing is exposed.
    pub room_beads: Vec<Polyline>,
    /// Its lines span places where nothing is printed below.
    pub bridges: bool,
    /// It is seen from above, and told apart from what is not.
    pub top: bool,
}

/// Skin on one raster.
#[derive(Debug, Clone, Default)]
pub struct SkinRows {
    /// The skin.
    pub skin: Arc<Rows>,
    /// Where skin and infill may go. An end of the skin that is also an end here is at a wall.
    pub fill: Arc<Rows>,
}

impl Skin {
    /// Skin of a layer of these `areas`, on the rasters `along` its lines and across. Its beads are added
    /// later.
    #[must_use]
    fn on(
        params: &RegionParams,
        (along, across): (usize, usize),
        layers: u32,
        areas: &LayerAreas,
        [rows, columns]: first_skin::Both,
    ) -> Self {
        let fill = |r: usize| areas.skin(r).fill.clone();
        Self {
            layers,
            raster: params.rasters.skin(along),
            rows: SkinRows { skin: rows, fill: fill(along) },
            columns: SkinRows { skin: columns, fill: fill(across) },
            left_turn: along == 0,
            beads: Vec::new(),
            room_beads: Vec::new(),
            bridges: false,
            top: false,
        }
    }

    /// The same without lines and beads, to lay others in its frame.
    #[must_use]
    fn bare(&self) -> Self {
        let (rows, columns) = (SkinRows::default(), SkinRows::default());
        Self { rows, columns, beads: Vec::new(), room_beads: Vec::new(), top: false, ..*self }
    }

    /// Its rows and columns together.
    #[must_use]
    pub fn crossed(&self) -> Crossed<'_> {
        Crossed {
            skin: &self.rows.skin,
            fill: &self.rows.fill,
            columns: &self.columns.skin,
            fill_columns: &self.columns.fill,
            left_turn: self.left_turn,
        }
    }
}

/// A region of one layer that is filled with a pattern: infill or support.
#[derive(Debug, Clone)]
pub struct Sparse {
    /// The pattern.
    pub pattern: Pattern,
    /// The region, on every row of the pattern's raster.
    pub rows: Rows,
    /// How many layers it is printed for: this one and those below it, with the
    /// material of all.
    pub layers: u32,
    /// Width of its lines.
    pub width: Coord,
    /// What its lines hold on to; `None` if the pattern does not ask for it.
    pub border: Option<Border>,
}

/// The border of a sparse region, and the walls around it.
#[derive(Debug, Clone)]
pub struct Border {
    /// The region on the raster across.
    pub columns: Rows,
    /// The distance of those rows.
    pub pitch: Coord,
    /// The raster across is turned by +90° (else by −90°).
    pub left_turn: bool,
    /// The fill rows of each of its layers, on both rasters. An end of the region that is also an
    /// end here is at a wall.
    pub walls: Vec<[Arc<Rows>; 2]>,
    /// Thicker lines are printed beside it: a place that no column holds has no room for a bead.
    pub beside_thick: bool,
}

impl Sparse {
    /// The length of what is printed in strands at least `least` long, grid units.
    #[must_use]
    pub fn length(&self, least: Coord) -> i64 {
        self.pattern.length(&self.rows, least)
    }
}
