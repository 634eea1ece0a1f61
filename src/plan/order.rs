//! Unordered paths -> ordered paths: sorts the paths of a layer island by island, nearest first.
//!
//! - An *island* is an outer contour with everything that is printed inside it.
//! - *Helpers* are paths that are not the part, such as support.
//! - A *seam* is where a wall begins and ends.
//!
//! 1. Each path goes to the smallest outer contour around its start.
//! 2. The island nearest to the nozzle is next. Its walls come first, then skin and infill, and last what
//!    is seen from above; the next path is always the one with the nearest end. Where it saves travel,
//!    `tour` mixes skin and infill afterwards: the order of these two shows nowhere. Helpers come after all islands; those that
//!    make the print stick, such as a brim, before them, in their own order. What is laid on the
//!    others comes last, in its turn.
//! 3. Walls are sorted by depth, from outside or from inside as the settings say. Their seams are at
//!    the vertex nearest to the nozzle, at the rear, or where `seam` put them.
//! 4. With seams in a line, the next layer begins near where this one began. So the last paths are
//!    also sorted backwards from there, and the shorter order wins.
//!
//! As listed, for comparison (`travel.order = "file"`), a layer has no islands: its walls come in the
//! order of their contours, then all else as the stages before have made it. Nothing is turned round.
//!
//! Of equally near paths the first in the list wins, so that the order is always the same.

use super::next::Next;
use super::seam::{self, Seams};
use super::{PlanParams, tour};
use crate::fill::{Order, Path, Role, Shape};
use crate::geom::boxes::Around;
use crate::geom::nest::extent;
use crate::geom::ranks::Ranks;
use crate::geom::{Contour, Point, double_area};
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
    /// The places that say how near it is: the vertices of its walls, or without any the ends of
    /// its paths.
    fn places(&self) -> impl Iterator<Item = Point> {
        let inside = if self.walls.is_empty() { self.inside.as_slice() } else { &[] };
        let walls = self.walls.iter().flat_map(|wall| &wall.points).map(|p| p.at);
        walls.chain(inside.iter().flat_map(|path| [path.start(), path.end()]))
    }
}

/// Sorts the paths of a layer, starting from `at`. `seams` are those of the layers before.
#[must_use]
pub fn order(paths: Unordered, mut at: Point, seams: &mut Seams, params: &PlanParams) -> Vec<Path> {
    let Unordered { mut islands, first, helpers, last } = paths;
    let mut out = Vec::new();
    if params.as_listed {
        out.extend(first);
        at = out.last().map_or(at, Path::end);
    } else {
        first.into_iter().for_each(|path| out.push(entered(path, &mut at)));
    }
    let mut next = Next::new(islands.iter().map(Island::places));
    while let Some((k, _)) = next.take(at) {
        let Island { mut walls, inside } = std::mem::take(&mut islands[k]);
        seams.place(&mut walls, params.seam);
        order_walls(walls, &mut at, params, &mut out);
        order_by_role(inside, Order::Inside, &mut at, params, &mut out);
    }
    order_by_role(helpers, Order::Helper, &mut at, params, &mut out);
    order_by_role(last, Order::Last, &mut at, params, &mut out);
    if !params.as_listed && matches!(params.seam, Seam::Rear | Seam::Aligned) {
        lead_back(&mut out);
    }
    seams.next_layer();
    out
}

/// Sorts paths by role, and nearest first within a role. Then come those that have their turns.
fn order_by_role(
    mut paths: Vec<Path>,
    order: Order,
    at: &mut Point,
    params: &PlanParams,
    out: &mut Vec<Path>,
) {
    let turn = |path: &Path| match path.shape {
        Shape::InTurn { turn } => Some(turn),
        Shape::Open | Shape::Loop { .. } => None,
    };
    for role in Role::ALL.into_iter().filter(|role| role.facts().order == order) {
        let mut open: Vec<Path> = paths.extract_if(.., |path| path.role == role).collect();
        let mut in_turn: Vec<Path> = open.extract_if(.., |path| turn(path).is_some()).collect();
        if params.as_listed {
            out.extend(open);
        } else {
            order_open(open, at, out);
        }
        in_turn.sort_by_key(turn);
        out.extend(in_turn);
        *at = out.last().map_or(*at, Path::end);
    }
}

impl Unordered {
    /// Divides the paths of a layer among its outer contours; as listed all of them are one island, whose
    /// walls have the order of the contours.
    #[must_use]
    pub fn new(mut paths: Vec<Path>, contours: &[Contour], params: &PlanParams) -> Self {
        let mut take = |order: Order| -> Vec<Path> {
            paths.extract_if(.., |path| path.role.facts().order == order).collect()
        };
        let (first, helpers) = (take(Order::First), take(Order::Helper));
        let last = take(Order::Last);
        let islands =
            if params.as_listed { listed(paths, contours) } else { islands(paths, contours) };
        Self { islands, first, helpers, last }
    }
}

/// All paths, as one island.
fn listed(mut paths: Vec<Path>, contours: &[Contour]) -> Vec<Island> {
    let ranks = Ranks::new(contours);
    let is_wall = |path: &mut Path| path.role.facts().order == Order::Walls;
    let mut walls: Vec<Path> = paths.extract_if(.., is_wall).collect();
    walls.sort_by_cached_key(|wall| ranks.of(wall.points.iter().map(|p| p.at)));
    vec![Island { walls, inside: paths }]
}

/// Divides paths among the outer contours of a layer.
fn islands(paths: Vec<Path>, contours: &[Contour]) -> Vec<Island> {
    let outer: Vec<&Contour> = contours.iter().filter(|c| double_area(c) > 0).collect();
    let around = Around::new(outer.iter().copied().enumerate());
    let size = |k: usize| extent(outer[k]).map_or(0, |(low, high)| low.distance2(high));
    let sizes: Vec<i64> = (0..outer.len()).map(size).collect();
    // One more than contours: the last takes paths that rounding left outside all of them.
    let mut islands: Vec<Island> = (0..=outer.len()).map(|_| Island::default()).collect();
    // Of nested contours (an island in a hole) the one with the smallest box is the path's own.
    let island_of = |p: Point| {
        if outer.len() == 1 {
            return 0;
        }
        around.of(p).min_by_key(|&k| (sizes[k], k)).unwrap_or(outer.len())
    };
    for path in paths {
        let island = &mut islands[island_of(path.start())];
        let is_wall = path.role.facts().order == Order::Walls;
        if is_wall { &mut island.walls } else { &mut island.inside }.push(path);
    }
    islands.retain(|i| !i.walls.is_empty() || !i.inside.is_empty());
    islands
}

/// Sorts walls by depth as the settings ask, and nearest first within a depth.
fn order_walls(walls: Vec<Path>, at: &mut Point, params: &PlanParams, out: &mut Vec<Path>) {
    let depth = |wall: &Path| match wall.shape {
        Shape::Loop { depth } => depth,
        Shape::Open | Shape::InTurn { .. } => 0,
    };
    let mut walls: Vec<Option<Path>> = walls.into_iter().map(Some).collect();
    let mut sorted: Vec<(u32, usize)> =
        walls.iter().flatten().map(depth).enumerate().map(|(k, depth)| (depth, k)).collect();
    sorted.sort_unstable_by_key(|&(depth, k)| {
        (if params.outer_first { i64::from(depth) } else { -i64::from(depth) }, k)
    });
    for group in sorted.chunk_by(|a, b| a.0 == b.0) {
        let of = |&(_, k): &(u32, usize)| walls[k].as_ref();
        let entries: Vec<Vec<usize>> =
            group.iter().map(|one| of(one).map_or_else(Vec::new, |w| entries(w, params))).collect();
        let places = group.iter().zip(&entries).map(|(one, entries)| {
            let at = |wall: &Path| entries.iter().map(|&k| wall.points[k].at).collect();
            of(one).map_or_else(Vec::new, at)
        });
        if params.as_listed {
            for (one, entries) in group.iter().zip(&entries) {
                let Some(wall) = walls[one.1].take() else { continue };
                out.push(begun_wall(wall, entries[0], at, params));
            }
            continue;
        }
        let mut next = Next::new(places);
        while let Some((one, entry)) = next.take(*at) {
            let Some(wall) = walls[group[one].1].take() else { continue };
            out.push(begun_wall(wall, entries[one][entry], at, params));
        }
    }
    *at = out.last().map_or(*at, Path::end);
}

/// `wall`, beginning at its point `from`, with its seam as the settings ask.
fn begun_wall(mut wall: Path, from: usize, at: &mut Point, params: &PlanParams) -> Path {
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
    wall
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

/// The points where `wall` may begin: its seam, or the ends of an open wall.
fn entries(wall: &Path, params: &PlanParams) -> Vec<usize> {
    let last = wall.points.len() - 1;
    if wall.shape == Shape::Open {
        return vec![0, last];
    }
    match params.seam {
        Seam::Nearest => (0..last.max(1)).collect(),
        Seam::Rear => vec![seam::rearmost(wall)],
        Seam::Aligned | Seam::Random => vec![0],
    }
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
    let mut next = Next::new(ends.iter().map(|&(start, end)| [start, end]));
    let mut picks = Vec::with_capacity(ends.len());
    while let Some((k, end)) = next.swap_take(at) {
        let turned = end == 1;
        at = if turned { ends[k].0 } else { ends[k].1 };
        picks.push((k, turned));
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
        Path { role, shape: Shape::Open, points, layers: 1 }
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
