//! Contours -> Walls: loops parallel to the contours, and one bead where two passes of a loop do not fit.
//!
//! Words:
//! - The *room* of a place is the thickness of the part there: twice the radius of the largest
//!   circle inside the part that touches the contour at this place (`room`).
//! - A *loop* is a closed wall at a fixed depth. Its two *passes* run along both sides of a thin
//!   place.
//! - A *middle bead* runs along the middle of a thin place, from end to end.
//! - The *core* is what lies so deep inside the loops that lines fit there.
//!
//! Algorithm:
//! 1. Inset the contours once for each wall. Cut off each loop where its two passes come too near
//!    to each other ([`thin`]). The inset one further, cut in the same way, is the core.
//! 2. Where the core is cut off, count the loops that are left. They and a middle bead, if there is
//!    room for one, share the room evenly (`share_room`): loops are moved and widened
//!    (`loops`, `bridged`), and the middle bead gets its share of the width (`middle`). Where walls meet, middle
//!    beads run on into the room between them (`junctions`).
//! 3. What is still open, though a bead has room there, gets loops of its own (`patches`).
//!
//! So the loops that exist decide where middle beads run, the middle beads that exist decide how wide
//! the loops are, and no place gets two counts. A
//! medial axis of the whole contour (Kuipers, Doubrovski, Wu, Wang 2020) decides the same from
//! one diagram; here only thin places of thin layers cost anything, and thick ones keep their
//! exact offsets. Nothing depends on the direction of raster lines, so equal layers get equal
//! beads.

mod arcs;
mod bridged;
mod dots;
mod junctions;
mod loops;
mod lost;
mod middle;
mod patches;
mod room;
mod share;
pub mod thin;

pub use share::share;

use super::near::Near;
use super::params::WallParams;
use crate::geom::frame::Frame;
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::segment::along;
use crate::geom::{Contour, Point, polygon};
use crate::units::Coord;
use room::{Opposite, Outline};

/// One wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    /// The centre line of its bead. A closed one has the solid on its left.
    pub path: Contour,
    /// The width of the bead from the previous point to each point; empty if it is one line width
    /// everywhere. A closed wall begins with the width of the way from its last point.
    pub widths: Vec<Coord>,
    /// Whether it is a loop.
    pub closed: bool,
    /// Counted from the outside; 0 is the outer wall.
    pub depth: u32,
    /// How many layers it is printed for: this one and those below it.
    pub layers: u32,
}

/// The walls of a layer.
#[derive(Debug, Default)]
pub struct Walls {
    /// The walls, from the outside inwards; then the middle beads.
    pub walls: Vec<Wall>,
    /// The contours one line width inside the innermost loops, without the places that walls fill.
    /// `None` if there are no such places.
    pub core: Option<Vec<Contour>>,
    /// Area that is too thin for any bead, mm².
    pub lost_mm2: f64,
}

/// The walls of `contours`. If the layer `may_be_thin`, places that are too thin for the passes of
/// all loops get fewer beads that share the room.
#[must_use]
pub fn walls(contours: &[Contour], may_be_thin: bool, params: &WallParams) -> Walls {
    let dots = if may_be_thin { dots::dots(contours, params) } else { None };
    let Some((dots, others)) = dots else { return around_cores(contours, may_be_thin, params).0 };
    let (mut made, core) = around_cores(&others, may_be_thin, params);
    made.walls.extend(dots);
    in_order(&mut made.walls);
    // Dots have none.
    made.core = made.core.or(core);
    made
}

/// The outer loops first, and middle beads last.
fn in_order(walls: &mut [Wall]) {
    walls.sort_by_key(|wall| (!wall.closed, wall.depth));
}

/// The walls of contours that are no dots, and their core if they fill no part of it.
fn around_cores(
    contours: &[Contour],
    may_be_thin: bool,
    params: &WallParams,
) -> (Walls, Option<Vec<Contour>>) {
    let (mut levels, whole) = levels(contours, may_be_thin, params);
    let core = levels.split_off((params.count as usize).min(levels.len())).pop();
    let plain = |(depth, level): (u32, &Vec<Contour>)| -> Vec<Wall> {
        level.iter().map(|path| Wall::closed(path.clone(), depth)).collect()
    };
    let mut walls: Vec<Wall> = (0..).zip(&levels).flat_map(plain).collect();
    let lost_mm2 = lost::outside_loops(contours, &walls, params);
    // What one island has too much makes up for nothing that another lacks.
    let lost = |walls: &[Wall], beads: f64| {
        let bare = if may_be_thin && params.count > 0 { lost::bare(contours, walls) } else { 0.0 };
        bare + (lost_mm2 - bare - beads).max(0.0)
    };
    let core = match core {
        Some(core) if !whole => core,
        core => {
            let lost_mm2 = lost(&walls, 0.0);
            return (Walls { walls, core: None, lost_mm2 }, core);
        }
    };
    let layout = Layout::new(contours, &levels, &core, params);
    let (mut arcs, doubts) = middle::beads(&layout);
    junctions::run_on(&mut arcs, &layout);
    let mut more: Vec<Wall> = arcs.iter().map(middle::wall).collect();
    let near = middle::near(&more, &layout);
    walls.iter_mut().for_each(|wall| loops::share(wall, &near, &layout));
    let loops = walls.len();
    walls.append(&mut more);
    let patches = patches::patches(&doubts, (&walls, &near), &core, &layout);
    let are_any = !patches.is_empty();
    walls.extend(patches);
    let lost_mm2 = lost(&walls, lost::under_beads(&walls[loops..]));
    if are_any {
        in_order(&mut walls);
    }
    (Walls { walls, core: Some(core), lost_mm2 }, None)
}

/// The loops of each depth, and the core if the layer `may_be_thin`. Also whether each loop goes all
/// around at each depth, so that nothing is too thin.
fn levels(
    contours: &[Contour],
    may_be_thin: bool,
    params: &WallParams,
) -> (Vec<Vec<Contour>>, bool) {
    let mut levels: Vec<Vec<Contour>> = Vec::new();
    let mut whole = true;
    for depth in 0..params.count + u32::from(may_be_thin) {
        let outer = levels.last().map_or(contours, |level| level.as_slice());
        let distance = if depth == 0 { params.outer_inset } else { params.line_width };
        let mut level = if distance > 0 { polygon::inset(outer, distance) } else { outer.to_vec() };
        if may_be_thin {
            let cut;
            (level, cut) = thin::open(level, (outer, distance), depth, params);
            whole &= !cut && !lost::loses((outer, &level), distance, params);
        }
        levels.push(level);
    }
    (levels, whole)
}

impl Wall {
    /// Its bead in a frame; `line_width` is that of places without another.
    #[must_use]
    pub fn bead(&self, frame: Frame, line_width: Coord) -> Polyline {
        let point = |(k, at): (usize, &Point)| {
            let at = frame.enter(*at);
            let width = self.widths.get(k).copied().unwrap_or(line_width);
            LinePoint { u: at.x, v: at.y, width }
        };
        let corners = self.path.iter().enumerate().map(point);
        corners.clone().chain(corners.take(usize::from(self.closed))).collect()
    }

    /// A loop of one line width.
    fn closed(path: Contour, depth: u32) -> Self {
        Self { path, widths: Vec::new(), closed: true, depth, layers: 1 }
    }
}

/// How far from its place a loop is looked for, in line widths. A cut ends a loop more than half
/// a line before the passes meet, so that half a line would find the wrong pass; a small value
/// misses loops at corners, where they lie further from the contour.
const BESIDE: f64 = 0.3;

/// Room in line widths that a place may have beyond what its beads are for. Where a loop is cut
/// off, rounding and the ends of the cut leave such places; a larger value makes fat beads.
const BEYOND: f64 = 0.15;

/// Room in line widths beside passes from which there is a middle bead. The middle between no bead
/// and one of full width is 0.5; a little more, so that walls of a round thickness, such as 2.5
/// lines, are not decided by rounding.
const LEAST_MIDDLE: f64 = 0.54;

/// Rooms thinner than the least by this much (5 µm) still count: rounding.
const ROUNDING: f64 = 50.0;

/// All that decides how beads lie at a place.
struct Layout<'a> {
    contours: &'a [Contour],
    outline: Outline,
    /// The loops of each depth, then the core, with a reach of [`BESIDE`].
    levels: Vec<Near>,
    params: &'a WallParams,
    line_width: f64,
}

/// How beads lie at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Share {
    /// The room, from outer edge to outer edge of the beads.
    room: f64,
    /// The width of each bead.
    width: f64,
    /// How many loops have passes here.
    loops: u32,
    /// Whether there is a middle bead.
    middle: bool,
}

impl<'a> Layout<'a> {
    fn new(
        contours: &'a [Contour],
        levels: &[Vec<Contour>],
        core: &[Contour],
        params: &'a WallParams,
    ) -> Self {
        let line_width = f64::from(params.line_width);
        let near = |level: &[Contour]| Near::of_all(level, 2.0 * line_width, BESIDE * line_width);
        let mut near: Vec<Near> = levels.iter().map(|level| near(level)).collect();
        near.push(Near::of_all(core, 2.0 * line_width, BESIDE * line_width));
        Self { contours, outline: Outline::new(contours, params), levels: near, params, line_width }
    }

    /// Distance of the centre line of a loop of nominal width from the contour.
    fn inset(&self, depth: u32) -> f64 {
        f64::from(self.params.inset_of(depth + 1))
    }

    /// How beads lie where the contour runs through `at` and the part lies towards `normal`, and
    /// what is opposite. `None` if loops and core lie there as everywhere, or nothing fits. `guess`
    /// is as for [`Outline::opposite`].
    fn share(&self, at: [f64; 2], normal: [f64; 2], guess: &mut f64) -> Option<(Share, Opposite)> {
        // Nearly everywhere the core is there: nothing else is asked for.
        if self.has_core(at, normal) { None } else { self.shared(at, normal, guess) }
    }

    /// As [`Layout::share`] where no core is.
    fn shared(&self, at: [f64; 2], normal: [f64; 2], guess: &mut f64) -> Option<(Share, Opposite)> {
        let opposite = self.outline.opposite(at, normal, guess)?;
        let reaches = |depth: u32| {
            self.inset(depth) < opposite.radius + BESIDE * self.line_width
                && self.has(depth, at, normal)
        };
        let loops = (0..self.params.count).take_while(|&depth| reaches(depth)).count() as u32;
        let thickness = 2.0 * opposite.radius;
        // Beads stay a little inside the contour, or reach out of it: that makes no part thinner.
        if loops == 0 && thickness < self.params.least_room - ROUNDING {
            return None;
        }
        let room = thickness + 2.0 * self.params.outside();
        Some((share_room(room, loops, self.params)?, opposite))
    }

    /// Whether a bead of this `width` at `at` lies on no loop deeper than `loops` and not on the core.
    fn is_clear(&self, at: [f64; 2], loops: u32, width: f64) -> bool {
        let deeper = &self.levels[loops as usize..];
        deeper.iter().all(|level| level.is_free([at], f64::midpoint(self.line_width, width)))
    }

    /// Whether the core runs beside the place `at` of the contour.
    fn has_core(&self, at: [f64; 2], normal: [f64; 2]) -> bool {
        self.has(self.params.count, at, normal)
    }

    /// Whether a loop of this depth, or the core, runs beside the place `at` of the contour.
    fn has(&self, depth: u32, at: [f64; 2], normal: [f64; 2]) -> bool {
        let place = along(at, self.inset(depth), normal);
        self.levels[depth as usize].is_beside(place)
    }
}

/// How `loops` loops and perhaps a middle bead share `room`. `None` if there is more room than they
/// are for.
fn share_room(room: f64, loops: u32, params: &WallParams) -> Option<Share> {
    let w = f64::from(params.line_width);
    let passes = f64::from(2 * loops);
    let most = if loops == 0 { params.widest } else { passes + 1.5 };
    if room > (most + BEYOND) * w {
        return None;
    }
    let middle = loops == 0 || room >= (passes + LEAST_MIDDLE) * w;
    let width = room / (passes + f64::from(u8::from(middle)));
    Some(Share { room, width: width.max(params.narrowest), loops, middle })
}

#[cfg(test)]
mod tests;
