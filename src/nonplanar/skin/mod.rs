//! Surface and outline -> Paths: the lines of one skin.
//!
//! Words: the *base* is what the skin is laid on: a staircase, or the skin below. The *room* of a stretch
//! is what lies between the two straight below it.
//!
//! 1. `piece`: each piece of the outline has rows of its own, spread evenly over its width.
//! 2. `lines`: where the lines run on the rows, and how wide each is.
//! 3. `runs`: lines are joined to zigzags, which are put in order, on a slope from below.
//! 4. `room`: how much plastic fits under each part of a line.
//! 5. `points`: where a line is cut to follow the surface and the room.
//!
//! All but the last two is plane geometry. What is asked of the surface and the base says `relief`.

mod lines;
mod piece;
mod points;
mod relief;
mod room;
mod runs;
#[cfg(test)]
mod tests;
mod walls;

pub use lines::WIDEST;
pub use relief::{Base, Relief};

use super::params::NonPlanarParams;
use crate::fill::{Path, PathPoint, Role, Shape};
use crate::geom::{Contour, Point, double_area};
use crate::units::{Coord, UNITS_PER_MM, nearest};
use points::{Heights, Limits};
use rayon::prelude::*;
use room::Room;
use runs::{Bead, Leg};

/// Where a skin lies.
#[derive(Debug)]
pub struct Skin<'a> {
    /// The surface that it follows.
    pub surface: &'a dyn Relief,
    /// Its outline in plan.
    pub area: &'a [Contour],
    /// How far below the surface its top lies, grid units.
    pub lowered: Coord,
    /// The top of the layer that it is printed after, grid units above the bed.
    pub layer_top: Coord,
    /// Direction of its lines, degrees.
    pub direction: f64,
}

/// A stretch of a bead with too little or too much room to be laid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outside {
    /// Where it begins.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
    /// Width of the bead, grid units.
    pub width: Coord,
    /// Mean height of its room, grid units.
    pub height: Coord,
}

/// A skin as laid.
#[derive(Debug, Clone, PartialEq)]
pub struct Laid {
    /// Its paths in the order of printing. The z of their points is relative to the layer's top, their
    /// height is the room between the base and the skin.
    pub paths: Vec<Path>,
    /// Stretches whose room is no height for a bead, in the same order. They are among the paths.
    pub outside: Vec<Outside>,
    /// Area of the outline, mm².
    pub area_mm2: f64,
}

/// Lays a skin on `base`.
#[must_use]
pub fn paths(skin: &Skin<'_>, base: &dyn Base, params: &NonPlanarParams) -> Laid {
    let (walls, rest) = walls::walls(skin.area, params);
    let pieces = piece::pieces(&rest, skin.direction, params.line_width);
    let mut beads = walls;
    beads.extend(runs::beads(&pieces, skin.surface, params.shortest));
    let layer = Layer { skin, base, params };
    let laid: Vec<(Vec<PathPoint>, Vec<Outside>)> =
        beads.par_iter().map(|bead| layer.bead(bead)).collect();
    let area: i128 = skin.area.iter().map(|c| double_area(c)).sum();
    let area_mm2 = area as f64 / 2.0 / (UNITS_PER_MM * UNITS_PER_MM);
    let mut out = Laid { paths: Vec::new(), outside: Vec::new(), area_mm2 };
    for (points, outside) in laid.into_iter().filter(|(points, _)| points.len() > 1) {
        let turn = u32::try_from(out.paths.len()).unwrap_or(u32::MAX);
        let shape = Shape::InTurn { turn };
        out.paths.push(Path { role: Role::NonPlanar, shape, points, layers: 1 });
        out.outside.extend(outside);
    }
    out
}

/// What beads are put onto.
struct Layer<'a> {
    skin: &'a Skin<'a>,
    base: &'a dyn Base,
    params: &'a NonPlanarParams,
}

impl Layer<'_> {
    /// The points of a bead, and its stretches with no room to be laid.
    fn bead(&self, bead: &Bead) -> (Vec<PathPoint>, Vec<Outside>) {
        let (mut points, mut outside) = (Vec::new(), Vec::new());
        for leg in bead {
            self.leg(leg, &mut points, &mut outside);
        }
        if let [first, second, ..] = points.as_mut_slice() {
            *first = PathPoint { at: first.at, z: first.z, ..*second };
        }
        (points, outside)
    }

    /// Appends the points of a leg.
    fn leg(&self, leg: &Leg, points: &mut Vec<PathPoint>, outside: &mut Vec<Outside>) {
        let params = self.params;
        let (lowered, surface) = (f64::from(self.skin.lowered), self.skin.surface);
        let before = points.last().map(|p| f64::from(p.z + self.skin.layer_top) + lowered);
        let Some(heights) = Heights::new(leg, surface, before) else { return };
        let limits = Limits {
            tolerance: f64::from(params.tolerance),
            segment: f64::from(params.segment),
            shortest: f64::from(params.shortest),
            cell: f64::from(params.line_width),
        };
        let mut along = heights.in_order();
        let room = Room::new(leg, |s| along(s) - lowered, self.base, params.height);
        let length = leg.from.distance(leg.to);
        let cuts = points::cuts(length, &heights, &room, &limits);
        let point = |s: f64, width: f64, height: f64| PathPoint {
            at: place(leg, s / length),
            z: nearest(heights.at(s) - lowered) as Coord - self.skin.layer_top,
            width: nearest(width) as Coord,
            height: nearest(height).max(1) as Coord,
            hang: 0,
        };
        if points.is_empty() {
            points.push(point(0.0, 0.0, 0.0));
        }
        for part in cuts.windows(2).map(|w| [w[0], w[1]]) {
            let width = room.of(part)[0] / (part[1] - part[0]);
            let one = point(part[1], width, room.height(part));
            let last = points.last().map_or(one.at, |p| p.at);
            points.push(one);
            if !self.is_height(one.height) {
                let PathPoint { at: to, width, height, .. } = one;
                outside.push(Outside { from: last, to, width, height });
            }
        }
    }

    /// Whether a bead may be so high.
    fn is_height(&self, height: Coord) -> bool {
        self.params.bead_heights().contains(&f64::from(height))
    }
}

/// The place on a leg after this part of it.
fn place(leg: &Leg, part: f64) -> Point {
    if part >= 1.0 {
        return leg.to;
    }
    let at = |a: Coord, b: Coord| a + nearest(f64::from(b - a) * part) as Coord;
    Point { x: at(leg.from.x, leg.to.x), y: at(leg.from.y, leg.to.y) }
}
