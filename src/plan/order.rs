//! Unordered paths -> ordered paths: sorts the paths of a layer island by island, nearest first.
//!
//! - An *island* is an outer contour with everything that is printed inside it.
//! - *Helpers* are paths that are not the part, such as support.
//! - A *seam* is where a wall begins and ends.
//!
//! 1. Each path goes to the smallest outer contour around its start.
//! 2. The island nearest to the nozzle is next. Its walls come first, then skin, then infill; the
//!    next path is always the one with the nearest end. Helpers come after all islands; those that
//!    make the print stick, such as a brim, before them, in their own order. What is laid on the
//!    others comes last, in its turn.
//! 3. Walls are sorted by depth, from outside or from inside as the settings say. Their seams are at
//!    the vertex nearest to the nozzle, at the rear, or where `seam` put them.
//! 4. With seams in a line, the next layer begins near where this one began. So the last paths are
//!    also sorted backwards from there, and the shorter order wins.
//!
//! Of equally near paths the first in the list wins, so that the order is always the same.

use super::seam::{self, Seams};
use super::{PlanParams, tour};
use crate::fill::{Path, Place, Role, Shape};
use crate::geom::{Contour, Point, double_area, edges, encloses};
use crate::profile::Seam;

/// The paths of one layer, divided among islands but not sorted.
#[derive(Debug, Default)]
pub struct Unordered {
    /// The paths inside each outer contour.
    islands: Vec<Island>,
    /// Paths printed before all islands, in this order.
    first: Vec<Path>,
    /// Paths printed after all islands, in either direction.
    helpers: Vec<Path>,
    /// Paths printed on what all others have laid.
    last: Vec<Path>,
}

/// The paths inside one outer contour.
#[derive(Debug, Default)]
struct Island {
    /// Its walls, without a chosen seam.
    walls: Vec<Path>,
    /// Its skin and infill, printed in either direction.
    inside: Vec<Path>,
}

impl Island {
    /// The squared distance from `at` to the nearest vertex of its walls. Without walls: to the
    /// nearest end of its paths.
    fn distance2(&self, at: Point) -> i64 {
        let walls = self.walls.iter().flat_map(|w| &w.points).map(|p| p.at.distance2(at)).min();
        let ends = || self.inside.iter().flat_map(|c| [c.start(), c.end()]);
        walls.or_else(|| ends().map(|p| p.distance2(at)).min()).unwrap_or(i64::MAX)
    }
}

/// Sorts the paths of a layer, starting from `at`. `seams` are those of the layers before.
#[must_use]
pub fn order(paths: Unordered, mut at: Point, seams: &mut Seams, params: &PlanParams) -> Vec<Path> {
    let Unordered { mut islands, first, helpers, last } = paths;
    let mut out = Vec::new();
    first.into_iter().for_each(|path| out.push(entered(path, &mut at)));
    while let Some(k) = nearest(islands.iter().map(|i| i.distance2(at))) {
        let Island { mut walls, inside } = islands.remove(k);
        seams.place(&mut walls, params.seam);
        order_walls(walls, &mut at, params, &mut out);
        order_by_role(inside, Place::Inside, &mut at, &mut out);
    }
    order_by_role(helpers, Place::Helper, &mut at, &mut out);
    order_by_role(last, Place::Last, &mut at, &mut out);
    if matches!(params.seam, Seam::Rear | Seam::Aligned) {
        lead_back(&mut out);
    }
    seams.next_layer();
    out
}

/// Sorts paths by role, and nearest first within a role. Then come those that have their turns.
fn order_by_role(mut paths: Vec<Path>, place: Place, at: &mut Point, out: &mut Vec<Path>) {
    let turn = |path: &Path| match path.shape {
        Shape::InTurn { turn } => Some(turn),
        Shape::Open | Shape::Loop { .. } => None,
    };
    for role in Role::ALL.into_iter().filter(|role| role.facts().place == place) {
        let mut open: Vec<Path> = paths.extract_if(.., |path| path.role == role).collect();
        let mut in_turn: Vec<Path> = open.extract_if(.., |path| turn(path).is_some()).collect();
        order_open(open, at, out);
        in_turn.sort_by_key(turn);
        *at = in_turn.last().map_or(*at, Path::end);
        out.extend(in_turn);
    }
}

impl Unordered {
    /// Divides the paths of a layer among its outer contours.
    #[must_use]
    pub fn new(mut paths: Vec<Path>, contours: &[Contour]) -> Self {
        let mut take = |place: Place| -> Vec<Path> {
            paths.extract_if(.., |path| path.role.facts().place == place).collect()
        };
        let (first, helpers) = (take(Place::First), take(Place::Helper));
        let last = take(Place::Last);
        Self { islands: islands(paths, contours), first, helpers, last }
    }
}

/// Divides paths among the outer contours of a layer.
fn islands(paths: Vec<Path>, contours: &[Contour]) -> Vec<Island> {
    let outer: Vec<Outer<'_>> =
        contours.iter().filter(|c| double_area(c) > 0).map(Outer::new).collect();
    // One more than contours: the last takes paths that rounding left outside all of them.
    let mut islands: Vec<Island> = (0..=outer.len()).map(|_| Island::default()).collect();
    // Of nested contours (an island in a hole) the one with the smallest box is the path's own.
    let island_of = |p: Point| {
        if outer.len() == 1 {
            return 0;
        }
        let holds = outer.iter().enumerate().filter(|(_, o)| o.contains(p));
        holds.min_by_key(|(k, o)| (o.extent(), *k)).map_or(outer.len(), |(k, _)| k)
    };
    for path in paths {
        let island = &mut islands[island_of(path.start())];
        let is_wall = path.role.facts().place == Place::Walls;
        if is_wall { &mut island.walls } else { &mut island.inside }.push(path);
    }
    islands.retain(|i| !i.walls.is_empty() || !i.inside.is_empty());
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

/// The index of the smallest distance; of equal ones the first.
fn nearest(distances: impl Iterator<Item = i64>) -> Option<usize> {
    distances.enumerate().min_by_key(|&(k, d)| (d, k)).map(|(k, _)| k)
}

/// Sorts walls by depth as the settings ask, and nearest first within a depth.
fn order_walls(mut walls: Vec<Path>, at: &mut Point, params: &PlanParams, out: &mut Vec<Path>) {
    let depth = |wall: &Path| match wall.shape {
        Shape::Loop { depth } => depth,
        Shape::Open | Shape::InTurn { .. } => 0,
    };
    while let Some(next) = {
        let depths = walls.iter().map(depth);
        if params.outer_first { depths.min() } else { depths.max() }
    } {
        let best = walls
            .iter()
            .enumerate()
            .filter(|(_, wall)| depth(wall) == next)
            .map(|(k, wall)| {
                let from = seam(wall, *at, params);
                (wall.points[from].at.distance2(*at), k, from)
            })
            .min();
        let Some((_, k, from)) = best else { break };
        let mut wall = walls.remove(k);
        match wall.shape {
            Shape::Loop { depth } => {
                wall.begin_at(from);
                // The next wall's seam is sought from here, so that a moved seam moves no other.
                *at = wall.end();
                if depth % 2 == 1 && params.stagger > 0 {
                    seam::advance(&mut wall, params.stagger);
                }
                if params.seam_gap > 0 {
                    seam::cut(&mut wall, params.seam_gap);
                }
            }
            Shape::Open | Shape::InTurn { .. } => {
                if from > 0 {
                    wall.reverse();
                }
                *at = wall.end();
            }
        }
        out.push(wall);
    }
    *at = out.last().map_or(*at, Path::end);
}

/// `path`, beginning at its point nearest to the nozzle.
fn entered(path: Path, at: &mut Point) -> Path {
    let last = path.points.len() - 1;
    let places = if path.shape == Shape::Open { vec![0, last] } else { (0..=last).collect() };
    let nearest = places.into_iter().min_by_key(|&k| (path.points[k].at.distance2(*at), k));
    begun(path, nearest.unwrap_or_default(), at)
}

/// `path`, beginning at point `from`: one of its ends if it is open. The nozzle is at its end then.
fn begun(mut path: Path, from: usize, at: &mut Point) -> Path {
    match path.shape {
        Shape::Loop { .. } => path.begin_at(from),
        Shape::Open | Shape::InTurn { .. } if from > 0 => path.reverse(),
        Shape::Open | Shape::InTurn { .. } => {}
    }
    *at = path.end();
    path
}

/// The index of the point where `wall` begins: its seam, or the nearer end of an open wall.
fn seam(wall: &Path, at: Point, params: &PlanParams) -> usize {
    let near = |k: usize| (wall.points[k].at.distance2(at), k);
    let last = wall.points.len() - 1;
    if wall.shape == Shape::Open {
        return near(0).min(near(last)).1;
    }
    let rear = |k: usize| (-i64::from(wall.points[k].at.y), k);
    let first = match params.seam {
        Seam::Nearest => (0..last).map(near).min(),
        Seam::Rear => (0..last).map(rear).min(),
        Seam::Aligned | Seam::Random => None,
    };
    first.map(|(_, k)| k).unwrap_or_default()
}

/// Sorts open paths nearest first, entering each at its nearer end.
fn order_open(paths: Vec<Path>, at: &mut Point, out: &mut Vec<Path>) {
    let first = out.len();
    out.extend(pick(paths, |ends| nearest_first(ends, *at)));
    *at = out[first..].last().map_or(*at, Path::end);
}

/// Start and end of a path.
type Ends = (Point, Point);

/// The index of the next path, and whether it is reversed.
type Pick = (usize, bool);

/// Sorts paths as `order` says, which sees only their ends.
fn pick(paths: Vec<Path>, order: impl FnOnce(&[Ends]) -> Vec<Pick>) -> Vec<Path> {
    let ends: Vec<Ends> = paths.iter().map(|c| (c.start(), c.end())).collect();
    let mut paths: Vec<Option<Path>> = paths.into_iter().map(Some).collect();
    let take = |(k, turned): Pick| {
        let mut path = paths[k].take()?;
        if turned {
            path.reverse();
        }
        Some(path)
    };
    order(&ends).into_iter().filter_map(take).collect()
}

/// The order that goes to the nearest end each time, from `at`.
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

/// Sorts the last paths of a layer backwards, nearest first from where its first path begins, if
/// that makes the travels shorter. With all seams at the rear the next layer begins near there.
fn lead_back(paths: &mut Vec<Path>) {
    let kind = paths.last().and_then(tour::free);
    let first = paths.iter().rposition(|p| tour::free(p) != kind).map_or(0, |k| k + 1);
    let before = first.checked_sub(1).filter(|_| kind.is_some()).map(|k| paths[k].end());
    let (Some(home), Some(before)) = (paths.first().map(Path::start), before) else { return };
    let last = paths.split_off(first);
    let order = |ends: &[Ends]| {
        let mut back = nearest_first(ends, home);
        back.reverse();
        back.iter_mut().for_each(|(_, turned)| *turned = !*turned);
        let kept: Vec<Pick> = (0..ends.len()).map(|k| (k, false)).collect();
        let shorter =
            travel_length(&back, ends, (before, home)) < travel_length(&kept, ends, (before, home));
        if shorter { back } else { kept }
    };
    paths.extend(pick(last, order));
}

/// The length of all travels: from `before`, between the paths, and on to `home`.
fn travel_length(picks: &[Pick], ends: &[Ends], (before, home): Ends) -> f64 {
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
    use crate::fill::PathPoint;
    use crate::units::Coord;

    fn place(x: Coord, y: Coord) -> PathPoint {
        PathPoint { at: Point { x, y }, z: 0, width: 4_000, height: 2_000, hang: 0 }
    }

    fn line(x: Coord, role: Role) -> Path {
        let point = |y| place(x, y);
        let points = vec![point(0), point(10_000)];
        Path { role, shape: Shape::Open, points, layers: 1, tool: 0 }
    }

    fn places(paths: &[Path]) -> Vec<Coord> {
        paths.iter().map(|p| p.start().x).collect()
    }

    #[test]
    fn open_paths_come_nearest_first_and_each_once() {
        let paths = [90, 20, 50, 10].map(|x| line(x * 1_000, Role::Infill)).to_vec();
        let (mut at, mut out) = (Point { x: 40_000, y: 10_000 }, Vec::new());
        order_open(paths, &mut at, &mut out);
        assert_eq!(places(&out), [50_000, 20_000, 10_000, 90_000]);
        assert_eq!(out[0].start().y, 10_000, "starts at the nearer end");
        assert_eq!(out.last().map(Path::end), Some(at));
    }

    #[test]
    fn the_last_paths_lead_back_to_where_the_layer_began() {
        let wall = line(0, Role::OuterWall);
        let out = |xs: [Coord; 4]| xs.map(|x| line(x, Role::Infill)).to_vec();
        let mut paths = vec![wall.clone()];
        paths.extend(out([20_000, 30_000, 80_000, 90_000]));
        paths[0].points.push(place(85_000, 0));
        lead_back(&mut paths);
        assert_eq!(places(&paths), [0, 90_000, 80_000, 30_000, 20_000]);
        // Walls alone keep their order.
        let mut walls = vec![wall.clone(), wall];
        lead_back(&mut walls);
        assert_eq!(places(&walls), [0, 0]);
    }
}
