//! Regions -> Toolpaths: what the nozzle does on each layer, in order.
//!
//! Guaranteed to the next stage: every path lies inside its region, paths are
//! in the order of printing, and each says whether the travel to it retracts.

pub mod link;
pub mod order;
pub mod round;
pub mod tour;
pub mod travel;

use crate::geom::Point;
use crate::profile::{RetractWhen, Seam, Settings, WallOrder};
use crate::region::scan::Raster;
use crate::region::support::SupportParams;
use crate::region::variable_width::LinePoint;
use crate::region::walls::Wall;
use crate::region::{Params, Region};
use crate::slice::Layer;
use crate::units::{Coord, UNITS_PER_MM, to_units};
use round::Rounding;

/// What a path is printed for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// The outermost wall.
    OuterWall,
    /// Walls inside it.
    InnerWall,
    /// Solid lines at tops and bottoms.
    Skin,
    /// Sparse infill.
    Infill,
    /// Support.
    Support,
}

impl Role {
    /// All roles, in the order of reports.
    pub const ALL: [Self; 5] =
        [Self::OuterWall, Self::InnerWall, Self::Skin, Self::Infill, Self::Support];

    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::OuterWall => "outer wall",
            Self::InnerWall => "inner wall",
            Self::Skin => "skin",
            Self::Infill => "infill",
            Self::Support => "support",
        }
    }
}

/// A point of a path, on the bed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PathPoint {
    /// Where.
    pub at: Point,
    /// Width of the bead on the way to here from the point before, grid units.
    pub width: Coord,
}

/// A bead laid in one go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Path {
    /// What it is for.
    pub role: Role,
    /// Its points; a closed path repeats its first at the end.
    pub points: Vec<PathPoint>,
    /// Height of the bead, grid units.
    pub height: Coord,
    /// How many layers it is printed for.
    pub layers: u32,
}

impl Path {
    /// Whether it is printed for more than its own layer.
    #[must_use]
    pub fn is_thick(&self) -> bool {
        self.layers > 1
    }

    /// A closed wall that starts and ends at the vertex `from`.
    fn closed(role: Role, wall: &Wall, from: usize, width: Coord, height: Coord) -> Self {
        let (path, layers) = (&wall.path, wall.layers);
        let n = path.len();
        let points = (0..=n).map(|k| PathPoint { at: path[(from + k) % n], width }).collect();
        Self { role, points, height: layers as Coord * height, layers }
    }

    /// Where it begins.
    #[must_use]
    pub fn start(&self) -> Point {
        self.points.first().map(|p| p.at).unwrap_or_default()
    }

    /// Where it ends.
    #[must_use]
    pub fn end(&self) -> Point {
        self.points.last().map(|p| p.at).unwrap_or_default()
    }

    /// Each segment: where it ends, its length and its width, grid units.
    pub fn segments(&self) -> impl Iterator<Item = (Point, f64, Coord)> {
        self.points.windows(2).map(|w| (w[1].at, w[0].at.distance(w[1].at), w[1].width))
    }

    /// Turns it round.
    fn reverse(&mut self) {
        self.points.reverse();
        // A width belongs to the way to its point: it moves on to the segment's other end.
        for k in (1..self.points.len()).rev() {
            self.points[k].width = self.points[k - 1].width;
        }
    }
}

/// A path and how the nozzle gets to it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step {
    /// The filament is pulled back on the way.
    pub retract: bool,
    /// The path.
    pub path: Path,
}

/// All that is printed on one layer, in order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Toolpath {
    /// The layer, counted from 0.
    pub layer: usize,
    /// Top of the layer above the bed, grid units.
    pub z: Coord,
    /// Height of the layer, grid units.
    pub height: Coord,
    /// Where the nozzle comes from, if known.
    pub from: Option<Point>,
    /// What is printed.
    pub steps: Vec<Step>,
}

/// The numbers that this stage needs.
#[derive(Debug, Clone)]
pub struct PlanParams {
    outer_first: bool,
    seam_rear: bool,
    retract_always: bool,
    min_travel: Coord,
    retracts: bool,
    times: travel::Times,
    rounding: Rounding,
    skin_rounding: Rounding,
    region: Params,
    support: Option<SupportParams>,
}

impl PlanParams {
    /// The numbers that `settings` mean for this stage.
    #[must_use]
    pub fn new(settings: &Settings, region: &Params, support: Option<SupportParams>) -> Self {
        // Without a wall the ends of lines are the outside, where nothing gets wider.
        let radius = if settings.walls == 0 { 0 } else { to_units(settings.corner_radius) };
        Self {
            outer_first: settings.wall_order == WallOrder::OuterFirst,
            seam_rear: settings.seam == Seam::Rear,
            retract_always: settings.retraction.when == RetractWhen::Always,
            min_travel: to_units(settings.retraction.min_travel),
            retracts: settings.retraction.length > 0.0,
            times: travel::Times {
                feed: settings.speed.travel / 60.0 * UNITS_PER_MM,
                acceleration: settings.limits.travel_acceleration * UNITS_PER_MM,
                retraction: 120.0 * settings.retraction.length / settings.retraction.feed,
            },
            rounding: Rounding { radius },
            skin_rounding: Rounding { radius: radius.min(region.line_width / 2) },
            region: region.clone(),
            support,
        }
    }
}

/// The paths of one layer, not yet in order.
#[derive(Debug, Default)]
pub struct Pieces {
    /// What is printed inside each outer contour.
    pub islands: Vec<order::Island>,
    /// Support; which end comes first is still free.
    pub support: Vec<Path>,
}

/// The paths of a region, linked into chains. Independent of all other layers.
#[must_use]
pub fn pieces(region: &Region, params: &PlanParams) -> Pieces {
    let mut chains: Vec<Path> = Vec::new();
    let height = region.layer.height;
    let mut add = |role, layers: u32, raster: Raster, links: Vec<link::Chain>| {
        chains.extend(links.into_iter().map(|chain| {
            let place = |p: LinePoint| raster.frame.leave(Point { x: p.u, y: p.v });
            let point = |p: LinePoint| PathPoint { at: place(p), width: p.width };
            let points = chain.into_iter().map(point).collect();
            let rounding = if role == Role::Skin { params.skin_rounding } else { params.rounding };
            let points = rounding.round(points);
            Path { role, layers, height: layers as Coord * height, points }
        }));
    };
    for skin in &region.skins {
        let raster = params.region.rasters[skin.raster];
        let chains = link::skin(&skin.lines, &params.region, params.skin_rounding.radius);
        add(Role::Skin, skin.layers, raster, chains);
        add(Role::Skin, skin.layers, raster, skin.beads.clone());
    }
    for infill in &region.infill {
        let raster = params.region.rasters[infill.comb.raster];
        let chains = link::hatch(infill, raster.pitch, params.region.line_width);
        add(Role::Infill, infill.layers, raster, chains);
    }
    if let Some(support) = &params.support {
        let raster = support.raster;
        for hatch in &region.support {
            let chains = link::hatch(hatch, raster.pitch, params.region.line_width);
            add(Role::Support, hatch.layers, raster, chains);
        }
    }
    let support = chains.extract_if(.., |c| c.role == Role::Support).collect();
    let islands = order::islands(region.walls.clone(), chains, &region.layer.contours);
    Pieces { islands, support }
}

/// The toolpath of a layer whose paths are in order; the nozzle comes from `from`.
#[must_use]
pub fn toolpath(
    region: &Region,
    paths: Vec<Path>,
    from: Option<Point>,
    params: &PlanParams,
) -> Toolpath {
    let Layer { index, z, height, .. } = region.layer;
    let steps = travel::steps(paths, &region.layer.contours, from, params);
    Toolpath { layer: index, z, height, from, steps }
}
