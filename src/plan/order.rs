//! Pieces -> ordered paths: island by island, walls first, nearest first from either end.
//!
//! An island is an outer contour with its holes and all that is printed inside
//! it. Within an island the order is walls, skin, infill; support comes last on
//! the layer. Each step goes to the piece whose start or end is nearest; ties
//! go to the piece that comes first in the list, so that the order is fixed.

use super::{Path, Pieces, PlanParams, Role};
use crate::geom::{Contour, Point, double_area, edges, encloses};
use crate::region::walls::Wall;
use crate::units::Coord;

/// Puts the pieces of a layer in order, starting from `at`.
#[must_use]
pub fn order(pieces: Pieces, height: Coord, mut at: Point, params: &PlanParams) -> Vec<Path> {
    let Pieces { mut islands, support } = pieces;
    let mut out = Vec::new();
    while let Some(k) = nearest(islands.iter().map(|i| i.distance2(at))) {
        let island = islands.remove(k);
        order_walls(island.walls, height, &mut at, params, &mut out);
        let mut chains = island.chains;
        for role in [Role::Skin, Role::Infill] {
            order_chains(chains.extract_if(.., |c| c.role == role).collect(), &mut at, &mut out);
        }
    }
    order_chains(support, &mut at, &mut out);
    out
}

/// What is printed inside one outer contour.
#[derive(Debug, Default)]
pub struct Island {
    /// Its walls; where they begin is still free.
    pub walls: Vec<Wall>,
    /// Its skin and infill; which end comes first is still free.
    pub chains: Vec<Path>,
}

impl Island {
    /// The squared distance from `at` to the nearest vertex of its walls, else of its chains.
    fn distance2(&self, at: Point) -> i64 {
        let walls = self.walls.iter().flat_map(|w| &w.path).map(|p| p.distance2(at)).min();
        let ends = || self.chains.iter().flat_map(|c| [c.start(), c.end()]);
        walls.or_else(|| ends().map(|p| p.distance2(at)).min()).unwrap_or(i64::MAX)
    }
}

/// Divides walls and chains among the outer contours of a layer.
#[must_use]
pub fn islands(walls: Vec<Wall>, chains: Vec<Path>, contours: &[Contour]) -> Vec<Island> {
    let outer: Vec<Outer<'_>> =
        contours.iter().filter(|c| double_area(c) > 0).map(Outer::new).collect();
    // The last one takes what rounding leaves outside of all.
    let mut islands: Vec<Island> = (0..=outer.len()).map(|_| Island::default()).collect();
    // Of nested contours (an island in a hole) the one with the smallest box holds the piece.
    let home = |p: Point| {
        if outer.len() == 1 {
            return 0;
        }
        let holds = outer.iter().enumerate().filter(|(_, o)| o.contains(p));
        holds.min_by_key(|(k, o)| (o.extent(), *k)).map_or(outer.len(), |(k, _)| k)
    };
    for wall in walls {
        let at = wall.path.first().copied().unwrap_or_default();
        islands[home(at)].walls.push(wall);
    }
    for chain in chains {
        islands[home(chain.start())].chains.push(chain);
    }
    islands.retain(|i| !i.walls.is_empty() || !i.chains.is_empty());
    islands
}

/// An outer contour with its bounding box.
struct Outer<'a> {
    contour: &'a Contour,
    low: Point,
    high: Point,
}

impl<'a> Outer<'a> {
    fn new(contour: &'a Contour) -> Self {
        let xs = || contour.iter().map(|p| p.x);
        let ys = || contour.iter().map(|p| p.y);
        let low = Point { x: xs().min().unwrap_or(0), y: ys().min().unwrap_or(0) };
        let high = Point { x: xs().max().unwrap_or(0), y: ys().max().unwrap_or(0) };
        Self { contour, low, high }
    }

    fn extent(&self) -> i64 {
        self.low.distance2(self.high)
    }

    /// Whether `p` is inside (a point on the contour may count either way).
    fn contains(&self, p: Point) -> bool {
        let (low, high) = (self.low, self.high);
        if p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y {
            return false;
        }
        encloses(edges(self.contour), p)
    }
}

/// The index of the smallest distance, the first of equals.
fn nearest(distances: impl Iterator<Item = i64>) -> Option<usize> {
    distances.enumerate().min_by_key(|&(k, d)| (d, k)).map(|(k, _)| k)
}

/// Orders walls by depth as the settings say, nearest first within a depth.
fn order_walls(
    mut walls: Vec<Wall>,
    height: Coord,
    at: &mut Point,
    params: &PlanParams,
    out: &mut Vec<Path>,
) {
    while let Some(depth) = {
        let depths = walls.iter().map(|w| w.depth);
        if params.outer_first { depths.min() } else { depths.max() }
    } {
        let seam = |wall: &Wall| -> (i64, usize) {
            let place = |(k, p): (usize, &Point)| {
                (if params.seam_rear { -i64::from(p.y) } else { p.distance2(*at) }, k)
            };
            wall.path.iter().enumerate().map(place).min().unwrap_or_default()
        };
        let best = walls
            .iter()
            .enumerate()
            .filter(|(_, w)| w.depth == depth && !w.path.is_empty())
            .map(|(k, w)| {
                let (_, from) = seam(w);
                (w.path[from].distance2(*at), k, from)
            })
            .min();
        let Some((_, k, from)) = best else { break };
        let wall = walls.remove(k);
        let role = if wall.depth == 0 { Role::OuterWall } else { Role::InnerWall };
        *at = wall.path[from];
        out.push(Path::closed(role, &wall, from, params.region.line_width, height));
    }
}

/// Orders chains nearest first from either end.
fn order_chains(chains: Vec<Path>, at: &mut Point, out: &mut Vec<Path>) {
    let mut ends: Vec<(Point, Point)> = chains.iter().map(|c| (c.start(), c.end())).collect();
    let mut left = chains;
    let from = |at: Point, (a, b): &(Point, Point)| a.distance2(at).min(b.distance2(at));
    while let Some(k) = nearest(ends.iter().map(|e| from(*at, e))) {
        let (start, end) = ends.swap_remove(k);
        let mut path = left.swap_remove(k);
        if end.distance2(*at) < start.distance2(*at) {
            path.reverse();
        }
        *at = path.end();
        out.push(path);
    }
}
