//! Walls of an island + seams of the layer below -> walls that begin at their seams.
//!
//! - A *seam* is where a closed wall begins and ends. A *mark* is the seam of an outer wall.
//! - The *turn* of a place is the angle by which the wall turns there, measured over half a millimetre to
//!   either side: a tiny edge makes no corner, and a rounded corner is one. Left turns are convex, right
//!   turns concave, since the part lies to the left of its walls.
//!
//! Aligned seams make one line up the part, though layers are planned in parallel: the outer walls of a
//! layer are placed when those of the layer below are, in the pass that orders layers one after the
//! other. It looks at each wall once, and at most walls only near one place.
//!
//! 1. A wall *follows* the nearest mark below if that is so near that the sides of the part go on. It
//!    begins at the nearest place, which is a point of its own if need be, or at a corner close by.
//! 2. Else it begins *anew*: at the sharpest concave corner, without one at the sharpest convex
//!    corner. Of equally sharp corners the nearest to a mark below wins, then the rearmost. A wall without corners
//!    begins at the place nearest to a mark, or at the rear. Corners that hang over nothing do not count.
//! 3. Inner walls begin at the place nearest to a mark of their island.

use super::marks::Marks;
use crate::fill::{Path, PathPoint, Shape};
use crate::geom::nest::extent;
use crate::geom::segment::{along, nearest_part, way};
use crate::geom::{Point, double_area};
use crate::profile::Seam;
use crate::units::{Coord, nearest};

/// Turns are measured over this length to either side (0.5 mm): about a line's width, which is what the
/// bead can show of a corner.
const REACH: f64 = 5_000.0;

/// Smaller turns are no corners, degrees: a hole of 1.7 mm turns as much. Smaller values take scanned
/// surfaces for corners; larger ones miss the edges of hexagons when they are rounded.
const CORNER: f64 = 35.0;

/// Corners whose turns differ by less count as equally sharp, degrees.
const ALIKE: f64 = 10.0;

/// A wall follows marks as near as this (1.5 mm): two layers of a side that leans by 75 degrees lie that
/// far apart. From further away it would be another side.
const FOLLOWED: f64 = 15_000.0;

/// It leaves the line for a corner as near as this (1 mm) to the mark, which hides more than a bend shows.
const SNAP: f64 = 10_000.0;

/// A place nearer to a point of the wall is that point (10 µm).
const SAME: f64 = 100.0;

/// A gap takes at most this part of a wall.
const MOST_GAP: f64 = 0.1;

/// The seam of an outer wall.
#[derive(Debug, Clone, Copy)]
struct Mark {
    at: Point,
    /// The wall goes around a hole.
    hole: bool,
}

/// The seams of the layer that is placed, and of the one below.
#[derive(Debug, Default)]
pub struct Seams {
    /// Layers that are placed.
    layers: u64,
    /// Marks of the layer below: of outer contours, and of holes.
    below: [Marks; 2],
    marks: Vec<Mark>,
}

/// A place of a closed wall: on the way from point `from` to the next.
#[derive(Debug, Clone, Copy)]
struct Place {
    from: usize,
    at: [f64; 2],
    /// Squared distance to what it is nearest to.
    far2: f64,
}

impl Seams {
    /// The next walls are those of the layer above.
    pub(super) fn next_layer(&mut self) {
        self.layers += 1;
        let marks = std::mem::take(&mut self.marks);
        let of = |hole: bool| marks.iter().filter(move |mark| mark.hole == hole);
        self.below = [false, true].map(|hole| Marks::new(of(hole).map(|mark| mark.at).collect()));
    }

    /// Lets the closed `walls` of an island begin at their seams, if `rule` needs no nozzle for that.
    pub(super) fn place(&mut self, walls: &mut [Path], rule: Seam) {
        if !matches!(rule, Seam::Aligned | Seam::Random) {
            return;
        }
        let first = self.marks.len();
        let is_outer = |wall: &Path| wall.shape == (Shape::Loop { depth: 0 });
        for wall in walls.iter_mut().filter(|wall| is_outer(wall)) {
            let hole = is_hole(wall);
            if rule == Seam::Random {
                self.shuffle(wall)
            } else {
                self.align(wall, hole)
            }
            self.marks.push(Mark { at: wall.start(), hole });
        }
        let marks = Marks::new(self.marks[first..].iter().map(|mark| mark.at).collect());
        for wall in walls.iter_mut().filter(|wall| wall.shape != Shape::Open && !is_outer(wall)) {
            if let Some(place) = nearest_of(wall, &marks) {
                begin_at(wall, place);
            }
        }
    }

    /// Lets a wall begin at a place that only its own points and its layer decide.
    fn shuffle(&self, wall: &mut Path) {
        let Point { x, y } = wall.start();
        let seed = [x, y].into_iter().fold(mixed(self.layers), |seed, n| mixed(seed ^ n as u64));
        let part = (seed >> 11) as f64 / (1_u64 << 53) as f64;
        let place = after(wall, part * length(wall));
        begin_at(wall, place);
    }

    /// Lets an outer wall begin in the line of seams below it, or where a line begins best.
    fn align(&self, wall: &mut Path, hole: bool) {
        let below = &self.below[usize::from(hole)];
        let place = followed(wall, below)
            .or_else(|| corner(wall, below))
            .or_else(|| nearest_of(wall, below))
            .unwrap_or_else(|| of_point(wall, rearmost(wall)));
        begin_at(wall, place);
    }
}

/// Moves the beginning of a closed wall forward by `distance` along it, grid units.
pub(super) fn advance(wall: &mut Path, distance: Coord) {
    let whole = length(wall);
    if whole > 0.0 {
        begin_at(wall, after(wall, f64::from(distance) % whole));
    }
}

/// Takes `gap` off the end of a closed wall, or less of a short one, grid units.
pub(super) fn cut(wall: &mut Path, gap: Coord) {
    let mut left = f64::from(gap).min(MOST_GAP * length(wall));
    while let [.., before, last] = &mut wall.points[..] {
        let step = before.at.distance(last.at);
        if step > left {
            last.at =
                point(along(float(last.at), left / step, way(float(last.at), float(before.at))));
            last.z = height(last.z, before.z, left / step);
            return;
        }
        left -= step;
        wall.points.pop();
    }
}

/// Where a wall goes on with the line of one of the marks `below`.
fn followed(wall: &Path, below: &Marks) -> Option<Place> {
    let area = extent(wall.points.iter().map(|point| &point.at))?;
    let near = below.around(area, FOLLOWED as Coord);
    let (mark, place) = near
        .into_iter()
        .filter_map(|mark| Some((mark, nearest_place(wall, mark)?)))
        .min_by(|a, b| a.1.far2.total_cmp(&b.1.far2))?;
    if place.far2 > FOLLOWED * FOLLOWED {
        return None;
    }
    let reached = |&k: &usize| (wall.points[k].at.distance2(mark) as f64) < SNAP * SNAP;
    let close = (0..wall.points.len() - 1).filter(reached);
    Some(best(wall, close, |at| Some(mark.distance2(at))).unwrap_or(place))
}

/// The best corner of a wall to begin a line at; `below` are the marks below.
fn corner(wall: &Path, below: &Marks) -> Option<Place> {
    best(wall, 0..wall.points.len() - 1, |at| below.far2(at))
}

/// The best of the points `ks` of a wall that are corners: concave, sharp, near to a mark, at the
/// rear. `far2` is the squared distance to the nearest mark.
fn best(
    wall: &Path,
    ks: impl Iterator<Item = usize>,
    far2: impl Fn(Point) -> Option<i64>,
) -> Option<Place> {
    let hangs = |k: usize| wall.points[k].hang > 0 || wall.points[k + 1].hang > 0;
    let turned = |k: usize| Some((k, turn(wall, k)?)).filter(|(_, turn)| turn.abs() >= CORNER);
    let mut corners: Vec<(usize, f64)> = ks.filter(|&k| !hangs(k)).filter_map(turned).collect();
    if corners.iter().any(|(_, turn)| *turn < 0.0) {
        corners.retain(|(_, turn)| *turn < 0.0);
    }
    let sharpest = corners.iter().map(|(_, turn)| turn.abs()).max_by(f64::total_cmp)?;
    let alike = corners.into_iter().filter(|(_, turn)| turn.abs() > sharpest - ALIKE);
    let key = |k: usize| {
        let at = wall.points[k].at;
        (far2(at), -i64::from(at.y), at.x)
    };
    alike.map(|(k, _)| k).min_by_key(|&k| key(k)).map(|k| of_point(wall, k))
}

/// The turn of a closed wall at point `k`, degrees, left turns above 0; `None` of a wall that is too short.
fn turn(wall: &Path, k: usize) -> Option<f64> {
    let points = &wall.points[..wall.points.len() - 1];
    let n = points.len();
    let at = |by: usize| float(points[(k + by) % n].at);
    let (back, ahead) = (reached((0..n).map(|by| at(n - by)))?, reached((0..n).map(at))?);
    let (from, to) = (way(back, at(0)), way(at(0), ahead));
    let (cross, dot) = (from[0] * to[1] - from[1] * to[0], from[0] * to[0] + from[1] * to[1]);
    Some(libm::atan2(cross, dot).to_degrees())
}

/// The place [`REACH`] along a way over `points`.
fn reached(mut points: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 2]> {
    let (mut at, mut left) = (points.next()?, REACH);
    for next in points {
        let [x, y] = way(at, next);
        let step = (x * x + y * y).sqrt();
        if step >= left {
            return Some(along(at, left / step, [x, y]));
        }
        left -= step;
        at = next;
    }
    None
}

/// The place of a closed wall that is nearest to one of the `marks`.
fn nearest_of(wall: &Path, marks: &Marks) -> Option<Place> {
    let area = extent(wall.points.iter().map(|point| &point.at))?;
    marks.nearest(area, FOLLOWED as Coord, |some| {
        let places = some.iter().filter_map(|mark| nearest_place(wall, *mark));
        places.min_by(|a, b| a.far2.total_cmp(&b.far2)).map(|place| (place.far2, place))
    })
}

/// The place of a closed wall that is nearest to `mark`.
fn nearest_place(wall: &Path, mark: Point) -> Option<Place> {
    let place = |(from, ends): (usize, &[PathPoint])| {
        let (a, b) = (float(ends[0].at), float(ends[1].at));
        let (arm, segment) = (way(a, float(mark)), way(a, b));
        let part = nearest_part(arm, segment);
        let [x, y] = along(arm, -part, segment);
        Place { from, at: along(a, part, segment), far2: x * x + y * y }
    };
    let places = wall.points.windows(2).enumerate().map(place);
    places.min_by(|a, b| a.far2.total_cmp(&b.far2))
}

/// The place `distance` along a closed wall, grid units.
fn after(wall: &Path, distance: f64) -> Place {
    let mut left = distance;
    for (from, ends) in wall.points.windows(2).enumerate() {
        let (a, b) = (float(ends[0].at), float(ends[1].at));
        let step = ends[0].at.distance(ends[1].at);
        if step > left {
            return Place { from, at: along(a, left / step, way(a, b)), far2: 0.0 };
        }
        left -= step;
    }
    of_point(wall, 0)
}

fn of_point(wall: &Path, from: usize) -> Place {
    Place { from, at: float(wall.points[from].at), far2: 0.0 }
}

/// Lets a closed wall begin at `place`, with a point of its own if none is there.
fn begin_at(wall: &mut Path, Place { from, at, .. }: Place) {
    let last = wall.points.len() - 1;
    let is_there = |k: usize| {
        let [x, y] = way(float(wall.points[k].at), at);
        x * x + y * y < SAME * SAME
    };
    let first = match [from, from + 1].into_iter().find(|&k| is_there(k)) {
        Some(k) => k % last,
        None => {
            // It has the bead of the segment that it lies in.
            let [before, next] = [wall.points[from], wall.points[from + 1]];
            let share = before.at.distance(point(at)) / before.at.distance(next.at).max(1.0);
            let z = height(before.z, next.z, share);
            wall.points.insert(from + 1, PathPoint { at: point(at), z, ..next });
            from + 1
        }
    };
    wall.begin_at(first);
}

/// The height after a share of the way from one to another.
fn height(from: Coord, to: Coord, share: f64) -> Coord {
    from + nearest(f64::from(to - from) * share) as Coord
}

/// The point of a closed wall furthest back; of those the rightmost, wherever its list of points begins.
pub(super) fn rearmost(wall: &Path) -> usize {
    let key = |&k: &usize| (-i64::from(wall.points[k].at.y), -i64::from(wall.points[k].at.x));
    (0..wall.points.len() - 1).min_by_key(key).unwrap_or_default()
}

fn is_hole(wall: &Path) -> bool {
    let points: Vec<Point> = wall.points.iter().map(|point| point.at).collect();
    double_area(&points) < 0
}

/// Grid units.
fn length(wall: &Path) -> f64 {
    wall.points.windows(2).map(|ends| ends[0].at.distance(ends[1].at)).sum()
}

fn float(Point { x, y }: Point) -> [f64; 2] {
    [f64::from(x), f64::from(y)]
}

fn point([x, y]: [f64; 2]) -> Point {
    Point { x: nearest(x) as Coord, y: nearest(y) as Coord }
}

/// A number in which each bit depends on all bits of `n` (the steps of SplitMix64).
fn mixed(n: u64) -> u64 {
    let n = n.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let n = (n ^ (n >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let n = (n ^ (n >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    n ^ (n >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::Role;

    #[test]
    fn the_rear_is_the_same_corner_wherever_the_list_begins() {
        let corners = [(0, 0), (10, 0), (10, 10), (0, 10), (0, 0)];
        let point = |(x, y)| PathPoint { at: Point { x, y }, z: 0, width: 1, height: 1, hang: 0 };
        let points = corners.map(point).to_vec();
        let wall =
            Path { role: Role::OuterWall, shape: Shape::Loop { depth: 0 }, points, layers: 1 };
        for first in 0..4 {
            for backwards in [false, true] {
                let mut wall = wall.clone();
                wall.begin_at(first);
                if backwards {
                    wall.reverse();
                }
                assert_eq!(wall.points[rearmost(&wall)].at, Point { x: 10, y: 10 });
            }
        }
    }
}
