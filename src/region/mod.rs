//! Layers -> Regions: walls, and the spans of skin, sparse infill and support on raster lines.
//!
//! Everything but the walls comes from one pass over raster lines: each layer's
//! contours are laid under the lines of every raster once ([`Prepared`]), and
//! each layer then combines its own spans with its neighbours' by 1-D booleans
//! ([`classify`]). Where skin is narrow it becomes beads along the walls ([`wall_beads`]).
//! Guaranteed to the next stage: skin and sparse infill of a layer are disjoint and
//! together its inset without these beads; rows are sorted, disjoint, never empty.

pub mod angle;
pub mod classify;
pub mod divide;
pub mod dual;
pub mod gap_closing;
mod near;
pub mod scan;
pub mod support;
pub mod thin;
pub mod variable_width;
pub mod wall_beads;
mod wall_samples;
pub mod walls;
pub mod window;

use crate::geom::frame::Frame;
use crate::geom::spans::Rows;
use crate::profile::{Pattern, Settings};
use crate::slice::Layer;
use crate::units::{Coord, to_units};
use scan::{Raster, Scan};
use thin::Strip;
use variable_width::{Line, LinePoint};
use walls::Wall;

/// The numbers that this stage needs, in grid units.
#[derive(Debug, Clone)]
pub struct Params {
    /// Width of a line and distance of solid lines.
    pub line_width: Coord,
    /// Number of walls.
    pub walls: u32,
    /// The profile has inner walls, within however many of them these numbers are.
    pub inner_walls: bool,
    /// Beads are only laid along the middle of strips, not along walls.
    pub only_strips: bool,
    /// Distance of the outer wall's middle from the contour.
    pub outer_inset: Coord,
    /// Distance of the ends of skin and infill lines from the contour.
    pub fill_inset: Coord,
    /// How far inside its contour a neighbouring layer counts as covering this one,
    /// so that skin begins where this layer's walls end to close what is exposed.
    pub cover_inset: Coord,
    /// How far lines reach into the innermost wall.
    pub overlap: Coord,
    /// Solid layers at the top.
    pub top_skins: usize,
    /// Solid layers at the bottom.
    pub bottom_skins: usize,
    /// How far skins reach under or over the infill.
    pub reach: Coord,
    /// All rasters in use; the first two carry the skins of even and odd layers.
    pub rasters: Vec<Raster>,
    /// The rasters of the sparse infill, for each layer (or pair) in turn. Empty: no infill.
    pub infill: Vec<Vec<Comb>>,
}

/// Every `stride`-th line of a raster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Comb {
    /// Index in [`Params::rasters`].
    pub raster: usize,
    /// Index of a line that is printed.
    pub offset: i32,
    /// From one printed line to the next.
    pub stride: i32,
    /// Neighbouring lines are joined at their ends. Not where lines of several
    /// directions end at the same wall: their joins would lie on each other.
    pub joined: bool,
}

impl Comb {
    /// Whether line `j` is printed.
    #[must_use]
    pub fn prints(self, j: i32) -> bool {
        (j - self.offset).rem_euclid(self.stride) == 0
    }

    /// The length of what is printed of `rows` in pieces at least `least` long, grid units.
    #[must_use]
    pub fn length(self, rows: &Rows, least: Coord) -> i64 {
        let printed = rows.iter().filter(|(j, _)| self.prints(*j)).flat_map(|(_, row)| row);
        printed.map(|span| span.len()).filter(|&len| len >= i64::from(least)).sum()
    }
}

impl Params {
    /// The numbers that `settings` mean for this stage.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let w = settings.line_width;
        let outer = settings.outer_wall_inset;
        // Without a wall there is none to reach into.
        let (wall, overlap) = match settings.walls {
            0 => (0.5, 0.0),
            walls => (outer + f64::from(walls), settings.infill_overlap),
        };
        let fill_inset = wall - overlap;
        // Where the walls' inner edge is, seen from the ends of the lines; never quite
        // as far in as they are, so that an upright side needs no skin.
        let cover_inset = (0.5 - overlap).min(fill_inset - 0.25).max(0.0);
        let skin = |turn: f64| Raster {
            frame: Frame::new(settings.angle.degrees() + turn),
            pitch: to_units(w),
        };
        let mut params = Self {
            line_width: to_units(w),
            walls: settings.walls,
            inner_walls: settings.walls > 1,
            only_strips: false,
            outer_inset: to_units(outer * w),
            fill_inset: to_units(fill_inset * w),
            cover_inset: to_units(cover_inset * w),
            overlap: to_units(overlap * w),
            top_skins: settings.top_skins() as usize,
            bottom_skins: settings.bottom_skins() as usize,
            reach: to_units(settings.skin_reach),
            rasters: vec![skin(0.0), skin(90.0)],
            infill: Vec::new(),
        };
        params.add_infill(settings);
        params
    }

    /// Lays out the lines of the infill pattern.
    fn add_infill(&mut self, settings: &Settings) {
        if settings.infill <= 0.0 {
            return;
        }
        let spacing = settings.line_width * 100.0 / settings.infill;
        let turns: &[&[f64]] = match settings.pattern {
            Pattern::Rectilinear => &[&[0.0], &[90.0]],
            Pattern::Aligned => &[&[0.0]],
            Pattern::Grid => &[&[0.0, 90.0]],
            Pattern::Triangles => &[&[0.0, 60.0, 120.0]],
        };
        for set in turns {
            let spacing = spacing * set.len() as f64;
            let mut combs = Vec::with_capacity(set.len());
            for turn in *set {
                let comb = self.comb(settings.angle.degrees() + turn, to_units(spacing));
                combs.push(Comb { joined: set.len() == 1, ..comb });
            }
            self.infill.push(combs);
        }
    }

    /// Lines `spacing` apart as a comb over fine lines no further apart than a
    /// line is wide: the skin's own where the spacing is a multiple of theirs.
    fn comb(&mut self, degrees: f64, spacing: Coord) -> Comb {
        let (raster, stride) = Raster::fine(degrees, spacing, self.line_width);
        let known = self.rasters.iter().position(|r| *r == raster);
        let index = known.unwrap_or_else(|| {
            self.rasters.push(raster);
            self.rasters.len() - 1
        });
        Comb { raster: index, offset: 0, stride, joined: true }
    }

    /// From the middle of the innermost wall to where lines end; there is a wall.
    #[must_use]
    pub fn wall_to_fill(&self) -> Coord {
        // The middles of the walls are a line apart.
        self.fill_inset - self.outer_inset - (self.walls as Coord - 1) * self.line_width
    }

    /// The raster of the skin of layer `k`, and the one across it.
    #[must_use]
    pub fn skin_rasters(&self, k: usize) -> (usize, usize) {
        (k % 2, 1 - k % 2)
    }
}

/// A layer with all that it and its neighbours will ask of its contours.
#[derive(Debug)]
pub struct Prepared {
    /// The layer.
    pub layer: Layer,
    /// Its walls.
    pub walls: Vec<Wall>,
    /// For each raster: where skin and infill may go, and where this layer covers its neighbours.
    pub rows: Vec<PreparedRows>,
    /// The room inside each of its walls, where some of it may be thin.
    pub strips: Vec<Strip>,
}

/// One raster's rows of a layer.
#[derive(Debug)]
pub struct PreparedRows {
    /// Where lines of skin or infill may run.
    pub fill: Rows,
    /// Where this layer covers its neighbours: with its walls, nearly up to its contour.
    pub cover: Rows,
}

impl Prepared {
    /// Makes the walls of `layer` and lays it under every raster.
    #[must_use]
    pub fn new(layer: Layer, params: &Params) -> Self {
        let scans: Vec<Scan> =
            params.rasters.iter().map(|&raster| Scan::new(&layer.contours, raster)).collect();
        let may_be_thin = thin::may_be_thin(&scans, params);
        let walls = walls::walls(&layer.contours, may_be_thin, params);
        let rows = |scan: &Scan| PreparedRows {
            fill: scan.inset(params.fill_inset),
            cover: scan.inset(params.cover_inset),
        };
        let rows: Vec<PreparedRows> = scans.iter().map(rows).collect();
        let strips =
            if may_be_thin { thin::strips(&scans, &walls, &rows, params) } else { Vec::new() };
        Self { layer, walls, rows, strips }
    }
}

/// What is to be printed on one layer.
#[derive(Debug)]
pub struct Region {
    /// The layer.
    pub layer: Layer,
    /// Its walls.
    pub walls: Vec<Wall>,
    /// Its skin, closed up to the walls: what is for this layer alone, then what is printed
    /// for several.
    pub skins: Vec<Skin>,
    /// Its sparse infill.
    pub infill: Vec<Hatch>,
    /// Its support, on the support raster.
    pub support: Vec<Hatch>,
    /// Area too thin for a wall, which is not printed, mm².
    pub thin_mm2: f64,
}

/// Skin of one layer that is printed for as many layers.
#[derive(Debug, Default)]
pub struct Skin {
    /// How many layers it is printed for: this one and those below it.
    pub layers: u32,
    /// Index of its raster in [`Params::rasters`].
    pub raster: usize,
    /// Its lines, row by row; bent and widened along walls.
    pub lines: Vec<Line>,
    /// Beads along narrow skin: at walls, and along strips too thin for a line.
    pub beads: Vec<Vec<LinePoint>>,
}

/// Sparse lines of one layer in one direction: infill or support.
#[derive(Debug, Clone)]
pub struct Hatch {
    /// Which lines of which raster.
    pub comb: Comb,
    /// The region on every line of the raster; only those of the comb are printed.
    pub rows: Rows,
    /// How many layers its lines are printed for: this one and those below it, with the
    /// material of all.
    pub layers: u32,
    /// Width of its lines.
    pub width: Coord,
}

impl Hatch {
    /// The length of the lines to be printed, grid units: those of the comb that are
    /// at least `least` long.
    #[must_use]
    pub fn length(&self, least: Coord) -> i64 {
        self.comb.length(&self.rows, least)
    }
}
