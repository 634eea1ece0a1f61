//! Gentle slopes that get no skin -> contouring: lines of tops rise and fall within their own layer.
//!
//! Words: S is the height of the surface over a place, z the top of a layer, h its height. The *tread* of a
//! layer is what the layer above leaves bare of it: there S lies between z − h/2 and z + h/2. A *raised* line
//! runs at S instead of z, by no more than [`RISE`] higher, and it keeps the least height. Its flow is that
//! of its own height. Seen from the side, a staircase becomes a row of lines at the height of the surface.
//!
//! 1. All gentle slopes of the mesh are found anew, up to the steepest that contouring can follow, whatever
//!    the head: its cone touches nothing as long as a line stays within its layer.
//! 2. A layer looks at those that cross it (`zones`); its lines are bent where they lie on its tread
//!    (`line`). Where a patch has its skins, lines stay as they are.
//! 3. Of what skins have refused the areas are told anew ([`Contours::tell`]).
//!
//! Nothing is hit:
//! - What lies below ends at z − h + [`RISE`] at most, and no line gets lower than that and the least
//!   height allow.
//! - On a slope, lines beside each other differ by no more than the slope makes of their distance. It is no
//!   steeper than the flat may press, nor than the cone.
//! - Beside an upright wall of the same layer, such as a boss, lines stay at z or above within the reach of
//!   the flat, and of the cone below the layer's top (`zones`).
//! - Lines that rise above z would be new to patches that were tried before. On layers that are printed before
//!   a patch and reach into its height, none rises.

mod line;
mod zones;

use super::Patches;
use super::field::{Field, Fields};
use super::grid::{self, CELL, cell_around};
use super::params::NonPlanarParams;
use super::surface::Surface;
use super::surface::find::{Surfaces, Tops};
use super::tally::Reason;
use crate::fill::{Path, Role};
use crate::geom::Point;
use crate::geom::boxes::{extent, meet};
use crate::geom::spans::Rows;
use crate::slice::Layer;
use crate::units::{Coord, UNITS_PER_MM, to_mm};
use std::sync::Arc;
use zones::Zones;

/// A line rises no higher above the top of its layer, grid units: 0.06 mm, so that what is printed over it
/// keeps its room.
pub const RISE: Coord = 600;

/// Smaller slopes are left as they are, mm²: a few lines of 2 mm.
const LEAST_AREA: f64 = 2.0;

/// The share of a layer's height by which a surface may lie above or below the layer's top to be that of its
/// tread. Half is right; the rest is for contours that were moved or simplified.
const TREAD: f64 = 0.75;

/// What contouring is told, grid units where nothing else is said.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// Tangent of the steepest slope.
    steepest: f64,
    /// Least height of a line.
    min_height: Coord,
    line_width: Coord,
    /// Lines stay at the layer's top so far from what stands upright.
    keep: Coord,
    /// How far a chord may leave the surface.
    tolerance: f64,
    /// Longest chord that bends.
    segment: f64,
    /// Shortest chord.
    shortest: f64,
}

/// A slope.
struct Ground {
    field: Field,
    extent: (Point, Point),
    bounds: [f64; 2],
}

/// Where a patch has its skins.
struct Skinned {
    rows: Rows,
    /// Lowest and highest z of its surface there.
    bounds: [f64; 2],
    /// The layer after which it is printed.
    home: usize,
}

/// The parameters that find the slopes for contouring, of those for skins.
#[must_use]
pub fn gentle(params: &NonPlanarParams) -> NonPlanarParams {
    let degrees = libm::atan(steepest(params)).to_degrees();
    NonPlanarParams {
        slopes: *params.slopes.start()..=degrees.max(*params.slopes.start()),
        min_area: LEAST_AREA,
        ..params.clone()
    }
}

/// The slopes of a print whose lines are bent.
pub struct Contours {
    grounds: Vec<Ground>,
    skins: Vec<Skinned>,
    limits: Limits,
    tops: Tops,
    depth: f64,
}

impl Contours {
    /// The slopes that were found with [`gentle`] parameters, on which no patch lies yet. `known` are the
    /// heights of some of them; `params` are those of skins, and `min_height` is the least height of a line,
    /// grid units.
    #[must_use]
    pub fn new(
        slopes: &Surfaces,
        known: Fields,
        params: &NonPlanarParams,
        min_height: Coord,
    ) -> Self {
        let ground = |(surface, field): (&Arc<Surface>, Field)| Ground {
            field,
            extent: surface.extent(),
            bounds: surface.bounds().map(f64::from),
        };
        let Surfaces { surfaces, tops } = slopes;
        let fields = known.of(surfaces);
        let (head, below) = (&params.head, to_mm((params.height - min_height).max(0)));
        let flank = below / libm::tan(head.cone.clamp(1.0, 89.0).to_radians());
        let keep = (head.flat / 2.0 + flank) * UNITS_PER_MM + f64::from(params.line_width) / 2.0;
        Self {
            grounds: surfaces.iter().zip(fields).map(ground).collect(),
            skins: Vec::new(),
            limits: Limits {
                steepest: steepest(params),
                min_height,
                line_width: params.line_width,
                keep: keep as Coord + CELL / 2,
                tolerance: f64::from(params.tolerance),
                segment: f64::from(params.segment),
                shortest: f64::from(params.shortest.max(1)),
            },
            tops: *tops,
            depth: f64::from(params.skins) * f64::from(params.height),
        }
    }

    /// The same without the places of skins.
    #[must_use]
    pub fn beside(self, patches: &Patches) -> Self {
        let skinned = |patch: &super::Patch| Skinned {
            rows: patch.areas.last().map(|area| grid::cells(area)).unwrap_or_default(),
            bounds: patch.bounds.map(f64::from),
            home: patch.layer,
        };
        Self { skins: patches.patches.iter().map(skinned).collect(), ..self }
    }

    /// Tells the areas that skins have refused, and that are contoured, as such. `found` are the slopes
    /// that were tried for skins.
    pub fn tell(&self, found: &Surfaces, patches: &mut Patches) {
        let tried = found.tops;
        // Of the slopes that were tried, so much is not too steep.
        let share = (in_surfaces(&self.tops) / in_surfaces(&tried).max(f64::MIN_POSITIVE)).min(1.0);
        for patch in &mut patches.patches {
            for reason in Reason::ALL {
                patch.mm2.contoured(reason, patch.mm2.of(reason) * share);
            }
        }
        let all = &mut patches.mm2;
        let outside = |reason: Reason| match reason {
            Reason::Slope => tried.slope,
            Reason::Press => tried.press,
            Reason::Area => tried.small,
            _ => 0.0,
        };
        for reason in Reason::ALL {
            let refused = (all.of(reason) - outside(reason)).max(0.0);
            all.contoured(reason, refused * share);
        }
        // What was no slope for skins, and is one here: smaller, flatter between slopes, or steeper.
        let mut more = (in_surfaces(&self.tops) - in_surfaces(&tried)).max(0.0);
        let mut part = |mm2: f64| {
            let taken = mm2.clamp(0.0, more);
            more -= taken;
            taken
        };
        let level = part(tried.level - self.tops.level);
        let small = part(tried.small - self.tops.small);
        let (slope, press) = (part(tried.slope), part(tried.press));
        all.level -= level;
        all.contour += level;
        all.contoured(Reason::Area, small);
        all.contoured(Reason::Slope, slope);
        all.contoured(Reason::Press, press);
    }

    /// Bends the paths of a layer where they lie on a slope that `above`, the layer above, leaves bare.
    pub fn bend(&self, layer: &Layer, above: Option<&Layer>, paths: &mut [Path]) {
        // The first layer holds the print on the bed.
        let reach = TREAD * f64::from(layer.height);
        let z = f64::from(layer.z);
        let crosses = |ground: &&Ground| {
            let [low, high] = ground.bounds;
            layer.index > 0 && low < z + reach && high > z - reach
        };
        let grounds: Vec<&Ground> = self.grounds.iter().filter(crosses).collect();
        if grounds.is_empty() {
            return;
        }
        let met = |path: &Path| {
            let own = extent(path.points.iter().map(|point| &point.at));
            own.is_some_and(|own| grounds.iter().any(|ground| meet(ground.extent, own)))
        };
        let wanted: Vec<usize> =
            (0..paths.len()).filter(|&k| may_bend(&paths[k]) && met(&paths[k])).collect();
        let tread = Tread { all: self, grounds, layer, reach };
        if wanted.is_empty() || !wanted.iter().any(|&k| tread.touches(&paths[k])) {
            return;
        }
        let zones = Zones::new(&tread, above.map_or(&[], |above| &above.contours));
        let rise = if self.is_below_patch(layer) { 0 } else { RISE };
        for k in wanted {
            line::bend(&mut paths[k], &tread, &zones, rise);
        }
    }

    /// Whether a layer is printed before a patch and reaches into its height.
    fn is_below_patch(&self, layer: &Layer) -> bool {
        let top = f64::from(layer.z) + f64::from(RISE);
        self.skins.iter().any(|skin| skin.home >= layer.index && top > skin.bounds[0] - self.depth)
    }
}

/// The slopes that cross a layer.
struct Tread<'a> {
    all: &'a Contours,
    grounds: Vec<&'a Ground>,
    layer: &'a Layer,
    /// How far from the layer's top its tread may lie.
    reach: f64,
}

impl Tread<'_> {
    /// How high the surface lies above the layer's top; `None` where there is none, or a skin.
    fn above(&self, at: Point) -> Option<f64> {
        let z = self.surface(at)?;
        let cell = cell_around(at);
        let near = |skin: &&Skinned| {
            let [low, high] = skin.bounds;
            low - self.reach < z && z < high + self.reach
        };
        let is_skin = self.all.skins.iter().filter(near).any(|skin| zones::holds(&skin.rows, cell));
        (!is_skin).then(|| z - f64::from(self.layer.z))
    }

    /// The surface over a place, if it is that of the layer's tread, grid units.
    fn surface(&self, at: Point) -> Option<f64> {
        let cell = cell_around(at);
        let top = f64::from(self.layer.z);
        let over = |ground: &&Ground| {
            let (z, [along, across]) = ground.field.plane(cell)?;
            let by = |v: Coord, k: i32| f64::from(v) - f64::from(k) * f64::from(CELL);
            let z = z + along * by(at.x, cell[0]) + across * by(at.y, cell[1]);
            ((z - top).abs() < self.reach).then_some(z)
        };
        self.grounds.iter().find_map(over)
    }

    /// Whether any of a path's places, a line width apart, lies on the tread.
    fn touches(&self, path: &Path) -> bool {
        let step = f64::from(self.all.limits.line_width);
        let on = |ends: &[crate::fill::PathPoint]| {
            let (a, b) = (ends[0].at, ends[1].at);
            let count = (a.distance(b) / step).ceil().max(1.0);
            (0..=count as usize).any(|k| self.above(between(a, b, k as f64 / count)).is_some())
        };
        path.points.windows(2).any(on)
    }
}

/// The tangent of the steepest slope: lines beside each other still overlap, the flat presses no deeper than
/// a layer, and the cone runs clear of the slope.
fn steepest(params: &NonPlanarParams) -> f64 {
    let height = f64::from(params.height);
    let lines = height / f64::from(params.line_width.max(1));
    let press = height / (params.head.flat / 2.0 * UNITS_PER_MM).max(1.0);
    let cone = libm::tan(params.head.cone.clamp(0.0, 89.0).to_radians());
    lines.min(press).min(cone)
}

/// Whether a path may be one of a top that is seen. What carries or spans nothing, or hangs, is left alone.
fn may_bend(path: &Path) -> bool {
    let is_wall = matches!(path.role, Role::OuterWall | Role::InnerWall);
    let is_skin = matches!(path.role, Role::Skin | Role::TopSkin | Role::Gap | Role::Ironing);
    (is_wall || is_skin) && path.layers == 1
}

/// What of the tops is in surfaces, mm².
fn in_surfaces(tops: &Tops) -> f64 {
    tops.all - tops.level - tops.slope - tops.press - tops.small
}

/// The place after a share of the way, to the nearest grid unit.
fn between(a: Point, b: Point, share: f64) -> Point {
    let on = |a: Coord, b: Coord| {
        crate::units::nearest(f64::from(a) + (f64::from(b) - f64::from(a)) * share) as Coord
    };
    Point { x: on(a.x, b.x), y: on(a.y, b.y) }
}
