//! Region -> Paths: how each area of a layer is laid.
//!
//! The region stage decides where walls, skin and sparse lines go. This stage turns them into
//! paths. Skin is closed up to the walls ([`gap_closing`], [`variable_width`]), and its lines are
//! joined to zigzags ([`skin`]). Sparse areas are filled with their pattern. Corners are rounded
//! ([`rounding`]). The next stage sees nothing but [`Path`]: points with a height above the layer,
//! and the width and height of the bead. A new thing to print is a new file here.
//!
//! Guaranteed to the next stage: every path has at least one point; a loop repeats its first
//! point; the middle of a bead stays inside its region.

pub mod adhesion;
pub mod gap_closing;
mod ironing;
mod monotonic;
mod path;
mod role;
pub mod rounding;
pub mod skin;
pub mod variable_width;

pub use path::{Path, PathPoint, Shape};
pub use role::{Both, Order, Role, RoleFacts, RoleTable, Slows};

use crate::geom::frame::Frame;
use crate::geom::outline::{Bounds, Columns};
use crate::geom::polyline::{self, LinePoint, Polyline};
use crate::geom::spans::Rows;
use crate::geom::{Contour, Point};
use crate::pattern::Held;
use crate::profile::Settings;
use crate::region::crossed::Crossed;
use crate::region::ironing::Ironing;
use crate::region::{Border, Region, Skin, Sparse, walls::Wall};
use crate::slice::Heights;
use crate::units::{Coord, nearest, to_units};
use rounding::Rounding;
use std::borrow::Cow;
use variable_width::LineParams;

/// Slivers of solid rooms that have nowhere room for a bead as wide as this, tenths of a line's width, are left out.
const LEAST_SLIVER: Coord = 7;

/// Corners of skin are rounded with at most a line's width divided by this. A larger radius leaves the
/// corners between line and wall open; a smaller one makes the nozzle stop at each.
const SKIN_ROUNDING: Coord = 8;

/// The numbers that this stage needs, in grid units.
#[derive(Debug, Clone)]
pub struct FillParams {
    heights: Heights,
    line_width: Coord,
    lines: LineParams,
    rounding: Rounding,
    skin_rounding: Rounding,
    /// Plastic of the lines of bridges: 1 fills their distance.
    bridge_flow: f64,
    /// The lines of tops come one beside the other.
    monotonic: bool,
    /// Beads along gaps have a role of their own.
    gaps: bool,
    /// Plastic of ironing: 1 fills the distance of its lines.
    ironing_flow: f64,
}

impl FillParams {
    /// Derives the numbers from `settings`, for layers at `heights`.
    #[must_use]
    pub fn new(settings: &Settings, heights: &Heights) -> Self {
        let line_width = to_units(settings.line_width);
        // Without walls the ends of lines are the outside of the part: their corners stay sharp.
        let radius = if settings.walls == 0 { 0 } else { to_units(settings.corner_radius) };
        Self {
            heights: heights.clone(),
            line_width,
            lines: LineParams::new(settings),
            rounding: Rounding { radius },
            skin_rounding: Rounding { radius: radius.min(line_width / SKIN_ROUNDING) },
            bridge_flow: settings.bridge.flow / 100.0,
            monotonic: settings.top_monotonic,
            ironing_flow: settings.ironing.flow / 100.0,
            gaps: settings.speed.gap.is_some(),
        }
    }
}

/// The paths of a layer, unordered. They depend on no other layer.
#[must_use]
pub fn paths(region: &Region, params: &FillParams) -> Vec<Path> {
    let mut maker = Maker { k: region.layer.index, params, out: Vec::new() };
    let hangs = region.hangs.iter().map(Vec::as_slice).chain(std::iter::repeat(&[] as &[u8]));
    region.walls.iter().zip(hangs).for_each(|(wall, hangs)| maker.wall(wall, hangs));
    region.skins.iter().for_each(|skin| maker.skin(skin));
    region.infill.iter().for_each(|sparse| maker.sparse(Role::Infill, sparse));
    region.ironing.iter().for_each(|ironing| maker.ironing(ironing));
    let support = &region.support;
    support.outlines.iter().for_each(|outline| maker.outline(outline));
    support.body.iter().for_each(|sparse| maker.sparse(Role::Support, sparse));
    support.interface.iter().for_each(|sparse| maker.sparse(Role::SupportInterface, sparse));
    maker.out
}

/// The strands of a region that holds on to its walls.
fn anchored<'a>(sparse: &'a Sparse, border: &'a Border, least: Coord) -> Vec<Polyline> {
    let Border { pitch, left_turn, .. } = *border;
    let columns = |rows: &'a Rows| Columns { rows, pitch, left_turn };
    let bounds =
        border.walls.iter().map(|[rows, across]| Bounds { rows, columns: columns(across) });
    let walls: Vec<Bounds<'_>> = bounds.collect();
    let (all, columns) = (&sparse.rows, columns(&border.columns));
    let pitch = sparse.pattern.raster().pitch;
    let rows =
        if border.beside_thick { Cow::Owned(columns.held(all, pitch)) } else { Cow::Borrowed(all) };
    let held = Held { rows: &rows, columns, walls: &walls };
    sparse.pattern.anchored(&held, sparse.width, least)
}

/// Collects the paths of layer `k`.
struct Maker<'a> {
    k: usize,
    params: &'a FillParams,
    out: Vec<Path>,
}

impl Maker<'_> {
    fn wall(&mut self, wall: &Wall, hangs: &[u8]) {
        let (plain, height) = (self.params.line_width, self.height(wall.layers));
        let role = match wall.depth {
            0 => Role::OuterWall,
            _ => Role::InnerWall,
        };
        let point = |(k, &at): (usize, &Point)| {
            let width = wall.widths.get(k).copied().unwrap_or(plain);
            let hang = hangs.get(k).copied().unwrap_or(0);
            PathPoint { at, z: 0, width, height, hang }
        };
        let corners = wall.path.iter().enumerate().map(point);
        let again = corners.clone().next().filter(|_| wall.closed);
        let shape = if wall.closed { Shape::Loop { depth: wall.depth } } else { Shape::Open };
        self.push(role, shape, wall.layers, corners.chain(again).collect());
    }

    fn skin(&mut self, skin: &Skin) {
        let (frame, rounding) = (skin.raster.frame, self.params.skin_rounding);
        let params = LineParams { line_width: skin.raster.pitch, ..self.params.lines };
        let (lines, slivers) = gap_closing::close(&skin.crossed(), 0, &params);
        let in_turn = skin.top && self.params.monotonic;
        let lines = skin::zigzags(&lines, in_turn, &params);
        let role = match skin {
            Skin { bridges: true, .. } => Role::Bridge,
            Skin { top: true, .. } => Role::TopSkin,
            _ => Role::Skin,
        };
        let first = self.out.len();
        for polyline in &lines {
            self.polyline(role, skin.layers, frame, polyline, rounding);
        }
        if in_turn {
            let turns = self.out[first..].iter_mut().zip(first as u32..);
            turns.for_each(|(path, turn)| path.shape = Shape::InTurn { turn });
        }
        let gap = if self.params.gaps { Role::Gap } else { role };
        for bead in skin.beads.iter().chain(&slivers) {
            self.polyline(gap, skin.layers, frame, bead, rounding);
        }
        for bead in &skin.room_beads {
            self.polyline(Role::Infill, skin.layers, frame, bead, rounding);
        }
    }

    fn sparse(&mut self, role: Role, sparse: &Sparse) {
        let Sparse { pattern, rows, layers, width, border } = sparse;
        let frame = pattern.raster().frame;
        let solid = pattern.is_solid();
        let rounding = if solid { self.params.skin_rounding } else { self.params.rounding };
        let least = self.params.line_width;
        let strands = match border {
            Some(border) if solid => self.solid(rows, border),
            Some(border) => anchored(sparse, border, least),
            None => pattern.strands(rows, *width, least),
        };
        for strand in strands {
            self.polyline(role, *layers, frame, &strand, rounding);
        }
    }

    /// Adds the lines that go over tops. Each is as wide as their distance, and low.
    fn ironing(&mut self, ironing: &Ironing) {
        let (frame, width) = (ironing.raster.frame, ironing.raster.pitch);
        let height = nearest(f64::from(self.height(1)) * self.params.ironing_flow) as Coord;
        let turns = ironing::zigzags(ironing, self.params.line_width);
        for (points, turn) in turns.into_iter().zip(0..) {
            let place = |p: Point| PathPoint { at: frame.leave(p), z: 0, width, height, hang: 0 };
            let points = points.into_iter().map(place).collect();
            self.push(Role::Ironing, Shape::InTurn { turn }, 1, points);
        }
    }

    /// Adds a bead around support. Its beginning does not matter, so it is an open path.
    fn outline(&mut self, outline: &Contour) {
        let (width, height) = (self.params.line_width, self.height(1));
        let corners = outline.iter().chain(outline.first());
        let points = corners.map(|&at| PathPoint { at, z: 0, width, height, hang: 0 }).collect();
        self.push(Role::Support, Shape::Open, 1, points);
    }

    /// The lines of a region that is filled solidly, closed up to the walls.
    fn solid(&self, rows: &Rows, border: &Border) -> Vec<Polyline> {
        let Some([fill, fill_columns]) = border.walls.last() else { return Vec::new() };
        let crossed = Crossed {
            skin: rows,
            fill,
            columns: &border.columns,
            fill_columns,
            left_turn: border.left_turn,
        };
        // A thread beside a skin's edge would lie on the skin's last line.
        let least = self.params.line_width * LEAST_SLIVER / 10;
        let (lines, mut slivers) = gap_closing::close(&crossed, least, &self.params.lines);
        // A lone line shorter than wide fills a notch beside a bead that turns, and lies on the wall there.
        let least = i64::from(self.params.line_width);
        let lines = skin::zigzags(&lines, false, &self.params.lines).into_iter();
        slivers.extend(lines.filter(|line| polyline::length(line) >= least));
        slivers
    }

    /// Adds a polyline given in `frame`, with its corners rounded.
    fn polyline(
        &mut self,
        role: Role,
        layers: u32,
        frame: Frame,
        polyline: &Polyline,
        rounding: Rounding,
    ) {
        let height = self.height(layers);
        let place = |&LinePoint { u, v, width }: &LinePoint| PathPoint {
            at: frame.leave(Point { x: u, y: v }),
            z: 0,
            width,
            height,
            hang: 0,
        };
        let mut points = rounding.round(polyline.iter().map(place).collect());
        if role == Role::Bridge {
            let flow = self.params.bridge_flow;
            points.iter_mut().for_each(|p| p.width = nearest(f64::from(p.width) * flow) as Coord);
        }
        self.push(role, Shape::Open, layers, points);
    }

    fn push(&mut self, role: Role, shape: Shape, layers: u32, points: Vec<PathPoint>) {
        if !points.is_empty() {
            self.out.push(Path { role, shape, points, layers });
        }
    }

    /// Height of a bead that is printed for `layers` layers.
    fn height(&self, layers: u32) -> Coord {
        self.params.heights.stack(self.k, layers)
    }
}
