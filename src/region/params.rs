//! Settings -> RegionParams: the numbers of the region stage, one small struct for each part of it.
//!
//! All lengths are in grid units. Distances from the contour are measured to the centre line of a
//! bead or to the end of a line. Words:
//!
//! - An *inset* is how far inside the contour something lies.
//! - The *overlap* is how far lines reach into the wall beside them. Without walls there is none.
//! - To *cover* is what a layer does with those below and above it, nearly up to its contour.
//! - A *top* is what the layer above leaves bare. What only some prints have is `None` in others, and
//!   costs them nothing.
//!
//! Each struct is made from the settings alone. What the heights of the layers or the bodies decide, the
//! pipeline fills in.

use super::dual::groups::Grouping;
use super::per_raster::Rasters;
use crate::geom::Point;
use crate::geom::frame::Frame;
use crate::geom::raster::Raster;
use crate::pattern::Turns;
use crate::profile::{DualPart, Ironing, IroningPlace, Settings};
use crate::units::{Coord, UNITS_PER_MM, to_units};

/// Degrees from the lines of a top to those that iron it. Along them the nozzle would follow the
/// grooves; half-way across it presses each ridge into the groove beside it, and its lines differ from
/// those of the layer below as well. PrusaSlicer and what descends from it do the same.
const ACROSS: f64 = 45.0;

/// Stretches of a row shorter than this are noise of the contours: 50 µm. A smaller value gives single
/// specks of skin, each grown by the reach; a larger one leaves thin ledges open. It is one for all: with
/// another one of its own, what a stage counts would not match the skin that is there.
pub(super) const NOISE: i64 = 500;

/// Strips of tops narrower than this go to what lies beside them, half as wide ones along walls, in line widths.
/// A smaller value makes parts that are all turns; a larger one lets more of a gentle slope be printed as
/// what lies under it.
pub(super) const NARROW_TOP: Coord = 5;

/// Narrower tops keep all their walls, in line widths: the outer wall on both sides and turns of skin
/// between would be all there is. With a smaller value the walls of gentle slopes are gone.
const WIDE_TOP: Coord = 6;

/// Rooms wider than the limit by this (0.05 mm) still are narrow: walls of round sizes, such as 3.6 mm with two
/// lines of 0.4 on both sides, would be solid on one facet of a circle and sparse on the next.
const AS_NARROW: Coord = 500;

/// The numbers of the whole stage.
#[derive(Debug, Clone)]
pub struct RegionParams {
    /// For the walls.
    pub walls: WallParams,
    /// For the rows of a layer: how far they lie inside its contours.
    pub insets: Insets,
    /// For dividing rows into skin and infill.
    pub skins: SkinParams,
    /// For beads along walls.
    pub beads: BeadParams,
    /// For bridges.
    pub bridges: BridgeParams,
    /// Whether skin that is seen from above is told apart.
    pub tops: bool,
    /// For tops with the outer wall alone; `None` if they have all walls.
    pub one_wall: Option<OneWall>,
    /// For going over tops once more; `None` if nothing is ironed.
    pub ironing: Option<IroningParams>,
    /// Whether walls that hang are told apart.
    pub overhangs: bool,
    /// All rasters in use.
    pub rasters: Rasters,
    /// The patterns of the sparse infill.
    pub sparse: Turns,
}

/// How walls are laid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallParams {
    /// Width of a line and distance between walls.
    pub line_width: Coord,
    /// Number of walls.
    pub count: u32,
    /// Distance of the outer wall's centre line from the contour.
    pub outer_inset: Coord,
    /// Thinner places get no bead, grid units.
    pub least_room: f64,
    /// Minimum width of a bead, grid units.
    pub narrowest: f64,
    /// Maximum width of a single bead, in line widths.
    pub widest: f64,
}

/// How far inside the contour lines may run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Insets {
    /// Distance of the ends of skin and infill lines from the contour.
    pub fill: Coord,
    /// How far lines reach out of the core of the walls, where walls share the room of thin places.
    pub core: Coord,
    /// How far inside its contour a neighbouring layer begins to cover this one. It is chosen so
    /// that skin begins where this layer's walls stop closing what is exposed.
    pub cover: Coord,
}

/// Where skin lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SkinParams {
    /// Solid layers at the top.
    pub top: usize,
    /// Solid layers at the bottom.
    pub bottom: usize,
    /// How far skins reach under or over the infill.
    pub reach: Coord,
    /// Width of a line.
    pub line_width: Coord,
    /// The first skin above sparse infill runs across the lines below.
    pub across_infill: bool,
    /// Rooms inside the walls narrower than this are filled solid.
    pub least_room: Coord,
    /// All inside the walls is skin: infill of 100 % is closed up to the walls as skins are.
    pub everywhere: bool,
}

/// How beads along walls are laid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BeadParams {
    /// Width of a line.
    pub line_width: Coord,
    /// From the centre line of the innermost wall to where lines end. Used only with walls.
    pub wall_to_fill: Coord,
    /// How far lines reach into the innermost wall.
    pub overlap: Coord,
}

/// How bridges are laid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BridgeParams {
    /// How far lines reach into what carries them; `None` lays no bridges.
    pub anchor: Option<Coord>,
    /// Distance between lines.
    pub pitch: Coord,
    /// Direction of the skin of even layers, degrees.
    pub angle: f64,
}

/// Where tops have the outer wall alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OneWall {
    /// Number of walls elsewhere.
    pub count: u32,
    /// Distance of the outer wall's centre line from the contour.
    pub outer: Coord,
    /// Distance of the ends of skin lines from the contour.
    pub fill: Coord,
    /// Narrower tops keep their walls.
    pub wide: Coord,
}

impl OneWall {
    /// The numbers that `settings` mean; `None` if all tops have all walls.
    fn new(settings: &Settings) -> Option<Self> {
        let (w, outer) = (settings.line_width, settings.outer_wall_inset);
        let asked = settings.top_one_wall && settings.walls > 1 && settings.has_top_skins();
        asked.then(|| Self {
            count: settings.walls,
            outer: to_units(outer * w),
            fill: to_units((outer + 1.0 - settings.infill_overlap) * w),
            wide: WIDE_TOP * to_units(w),
        })
    }
}

impl BridgeParams {
    fn new(settings: &Settings) -> Self {
        Self {
            anchor: settings.bridge.enabled.then(|| to_units(settings.bridge.anchor)),
            pitch: to_units(settings.bridge.spacing * settings.line_width),
            angle: settings.angle.degrees(),
        }
    }
}

/// How tops are ironed.
#[derive(Debug, Clone, PartialEq)]
pub struct IroningParams {
    /// Its lines on even and on odd layers.
    pub rasters: [Raster; 2],
    /// How far its lines keep from the contours of the layer and from those above.
    pub inset: Coord,
    /// What is nearer to what stands on the layer is ironed only beside a place that is not.
    pub narrow: Coord,
    /// The least length of a line.
    pub least: Coord,
    /// Only the highest layer of each body is ironed.
    pub topmost: bool,
    /// The lowest and the highest corner of each body.
    pub bodies: Vec<[Point; 2]>,
}

impl IroningParams {
    /// The numbers that `settings` mean, with no body yet; `None` if nothing is ironed.
    fn new(settings: &Settings) -> Option<Self> {
        let Ironing { place, spacing, inset, .. } = settings.ironing;
        if place == IroningPlace::Off || !settings.has_top_skins() {
            return None;
        }
        let line_width = to_units(settings.line_width);
        let walls = if settings.top_one_wall { settings.walls.min(1) } else { settings.walls };
        let raster = |turn: f64| Raster {
            frame: Frame::new(settings.angle.degrees() + ACROSS + turn),
            pitch: to_units(spacing).max(1),
        };
        Some(Self {
            rasters: [raster(0.0), raster(90.0)],
            inset: to_units(inset),
            narrow: NARROW_TOP * line_width / 2 + walls as Coord * line_width - line_width,
            least: line_width / 2,
            topmost: place == IroningPlace::Topmost,
            bodies: Vec::new(),
        })
    }
}

impl SkinParams {
    /// Derives the numbers from `settings`, for a part that is `hollow` or has infill.
    fn new(settings: &Settings, hollow: bool) -> Self {
        let grouping = Grouping::new(&settings.dual, settings.dual_ratio());
        Self {
            top: settings.top_skins() as usize,
            bottom: settings.bottom_skins() as usize,
            reach: to_units(settings.skin_reach),
            line_width: to_units(settings.line_width),
            across_infill: settings.skin_across_infill,
            // Without infill parts are meant to be hollow.
            least_room: if hollow || settings.narrow_room <= 0.0 {
                0
            } else {
                to_units(settings.narrow_room) + AS_NARROW
            },
            everywhere: settings.infill >= 100.0 && !grouping.shares(DualPart::Infill),
        }
    }
}

impl RegionParams {
    /// Derives the numbers from `settings`.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let w = settings.line_width;
        let outer = settings.outer_wall_inset;
        // Without walls there is nothing to overlap with.
        let (wall, overlap) = match settings.walls {
            0 => (0.5, 0.0),
            walls => (outer + f64::from(walls), settings.infill_overlap),
        };
        let fill = wall - overlap;
        // The distance from the inner edge of the walls to the ends of lines: what a neighbour
        // leaves exposed above the walls alone then needs no skin. It stays below `fill`, so
        // that an upright side needs none either.
        let cover = (0.5 - overlap).min(fill - 0.25).max(0.0);
        let line_width = to_units(w);
        let walls = WallParams {
            line_width,
            count: settings.walls,
            outer_inset: to_units(outer * w),
            least_room: settings.min_feature * UNITS_PER_MM,
            narrowest: settings.min_bead_width / 100.0
                * settings.machine.nozzle_diameter
                * UNITS_PER_MM,
            widest: settings.max_bead_width / 100.0,
        };
        let insets = Insets {
            fill: to_units(fill * w),
            core: to_units(overlap * w),
            cover: to_units(cover * w),
        };
        let skin =
            |turn| Raster { frame: Frame::new(settings.angle.degrees() + turn), pitch: line_width };
        let sparse = Turns::new(settings);
        Self {
            walls,
            insets,
            skins: SkinParams::new(settings, sparse.is_empty()),
            beads: BeadParams {
                line_width,
                wall_to_fill: insets.fill - walls.inset_of(walls.count),
                overlap: to_units(overlap * w),
            },
            tops: settings.top_monotonic || settings.speed.top_skin.is_some(),
            one_wall: OneWall::new(settings),
            ironing: IroningParams::new(settings),
            overhangs: settings.speed.overhang > 0.0,
            bridges: BridgeParams::new(settings),
            rasters: Rasters::new([skin(0.0), skin(90.0)], sparse.rasters()),
            sparse,
        }
    }
}

impl WallParams {
    /// Distance of the centre line of wall `number`, counted from 1 at the outside, from the contour.
    #[must_use]
    pub fn inset_of(&self, number: u32) -> Coord {
        self.outer_inset + (number as Coord - 1) * self.line_width
    }

    /// How far beads reach out over the contour, grid units; negative if they stay inside.
    #[must_use]
    pub fn outside(&self) -> f64 {
        f64::from(self.line_width) / 2.0 - f64::from(self.outer_inset)
    }
}
