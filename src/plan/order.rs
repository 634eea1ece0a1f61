//! Pieces -> ordered paths: island by island, walls first, nearest first from either end.
//!
//! An island is an outer contour with its holes and all that is printed inside
//! it. Within an island the order is walls, skin, infill; support comes last on
//! the layer. Each step goes to the piece whose start or end is nearest; ties
//! go to the piece that comes first in the list, so that the order is fixed.
//! The last chains of a layer are also tried backwards from where the next one begins.

use super::{Path, Pieces, PlanParams, Role, tour};
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
    if params.seam_rear {
        lead_back(&mut out);
    }
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
    let first = out.len();
    out.extend(pick(chains, |ends| nearest_first(ends, *at)));
    *at = out[first..].last().map_or(*at, Path::end);
}

/// Where a chain begins and ends.
type Ends = (Point, Point);

/// Which chain is next, and whether it is printed the other way round.
type Pick = (usize, bool);

/// The chains in the order that `order` makes of their ends.
fn pick(chains: Vec<Path>, order: impl FnOnce(&[Ends]) -> Vec<Pick>) -> Vec<Path> {
    let ends: Vec<Ends> = chains.iter().map(|c| (c.start(), c.end())).collect();
    let mut chains: Vec<Option<Path>> = chains.into_iter().map(Some).collect();
    let take = |(k, turned): Pick| {
        let mut chain = chains[k].take()?;
        if turned {
            chain.reverse();
        }
        Some(chain)
    };
    order(&ends).into_iter().filter_map(take).collect()
}

/// The order that goes from `at` to the nearest end each time.
fn nearest_first(ends: &[Ends], mut at: Point) -> Vec<Pick> {
    let mut left: Vec<(usize, Ends)> = ends.iter().copied().enumerate().collect();
    let mut picks = Vec::with_capacity(left.len());
    let far = |at: Point, (a, b): Ends| a.distance2(at).min(b.distance2(at));
    while let Some(k) = nearest(left.iter().map(|(_, e)| far(at, *e))) {
        let (index, (start, end)) = left.swap_remove(k);
        let turned = end.distance2(at) < start.distance2(at);
        at = if turned { start } else { end };
        picks.push((index, turned));
    }
    picks
}

/// Orders the last chains of a layer nearest first backwards from where its first wall
/// begins, if that is the shorter way: with all seams at the rear, that is near where the
/// next layer begins.
fn lead_back(paths: &mut Vec<Path>) {
    let kind = paths.last().and_then(tour::free);
    let first = paths.iter().rposition(|p| tour::free(p) != kind).map_or(0, |k| k + 1);
    let before = first.checked_sub(1).filter(|_| kind.is_some()).map(|k| paths[k].end());
    let (Some(home), Some(before)) = (paths.first().map(Path::start), before) else { return };
    let chains = paths.split_off(first);
    let order = |ends: &[Ends]| {
        let mut back = nearest_first(ends, home);
        back.reverse();
        back.iter_mut().for_each(|(_, turned)| *turned = !*turned);
        let kept: Vec<Pick> = (0..ends.len()).map(|k| (k, false)).collect();
        let shorter = way(&back, ends, (before, home)) < way(&kept, ends, (before, home));
        if shorter { back } else { kept }
    };
    paths.extend(pick(chains, order));
}

/// The length of all travels between chains, from `before` and to `home`.
fn way(picks: &[Pick], ends: &[Ends], (before, home): Ends) -> f64 {
    let mut at = before;
    let mut sum = 0.0;
    for &(k, turned) in picks {
        let (start, end) = if turned { (ends[k].1, ends[k].0) } else { ends[k] };
        sum += at.distance(start);
        at = end;
    }
    sum + at.distance(home)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::PathPoint;

    fn line(x: Coord, role: Role) -> Path {
        let point = |y| PathPoint { at: Point { x, y }, width: 4_000 };
        Path { role, points: vec![point(0), point(10_000)], height: 2_000, layers: 1 }
    }

    fn places(paths: &[Path]) -> Vec<Coord> {
        paths.iter().map(|p| p.start().x).collect()
    }

    #[test]
    fn chains_come_nearest_first_each_of_them_once() {
        let chains = [90, 20, 50, 10].map(|x| line(x * 1_000, Role::Infill)).to_vec();
        let (mut at, mut out) = (Point { x: 40_000, y: 10_000 }, Vec::new());
        order_chains(chains, &mut at, &mut out);
        assert_eq!(places(&out), [50_000, 20_000, 10_000, 90_000]);
        assert_eq!(out[0].start().y, 10_000, "entered at the nearer end");
        assert_eq!(out.last().map(Path::end), Some(at));
    }

    #[test]
    fn the_last_chains_lead_back_to_where_the_layer_began() {
        let wall = line(0, Role::OuterWall);
        let out = |xs: [Coord; 4]| xs.map(|x| line(x, Role::Infill)).to_vec();
        let mut paths = vec![wall.clone()];
        paths.extend(out([20_000, 30_000, 80_000, 90_000]));
        paths[0].points.push(PathPoint { at: Point { x: 85_000, y: 0 }, width: 4_000 });
        lead_back(&mut paths);
        assert_eq!(places(&paths), [0, 90_000, 80_000, 30_000, 20_000]);
        // Walls alone are left as they are.
        let mut walls = vec![wall.clone(), wall];
        lead_back(&mut walls);
        assert_eq!(places(&walls), [0, 0]);
    }
}
