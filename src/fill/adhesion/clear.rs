//! Brim + first layer -> support of the first layer without what lies under the brim.
//!
//! A brim holds what is small, so it comes first: support stands on it from the next layer on. Each line
//! of support is cut where the brim begins; what is left of it is too short or goes on beside the brim.

use crate::fill::{Order, Path, PathPoint, Shape};
use crate::geom::boxes::{Around, Boxes};
use crate::geom::nest::extent;
use crate::geom::segment::way;
use crate::geom::{Contour, Point, double_area, edges};
use crate::units::{Coord, nearest};

/// Shorter pieces are left out, in widths of a line: a dot holds nothing.
const LEAST_LENGTH: f64 = 3.0;

/// Leaves out what the helpers among `paths` have inside `area`, as from
/// [`union`](crate::geom::polygon::union). Other paths keep their order and come first.
pub fn clear(paths: &mut Vec<Path>, area: &[Contour]) {
    if area.is_empty() {
        return;
    }
    let area = Area::new(area);
    let is_helper = |path: &mut Path| path.role.facts().order == Order::Helper;
    let helpers: Vec<Path> = paths.extract_if(.., is_helper).collect();
    paths.extend(helpers.into_iter().flat_map(|path| area.without(path)));
}

/// An area on the bed.
struct Area<'a> {
    /// For each contour 1 if it runs around the area, and -1 around a hole.
    turns: Vec<i32>,
    around: Around<'a>,
    sides: Vec<(Point, Point)>,
    boxes: Boxes,
}

impl<'a> Area<'a> {
    fn new(contours: &'a [Contour]) -> Self {
        let sides: Vec<(Point, Point)> = contours.iter().flat_map(|c| edges(c)).collect();
        let boxes = sides.iter().map(|&(a, b)| extent([&a, &b]).unwrap_or_default());
        let boxes = Boxes::new(boxes.collect());
        let turn = |contour: &Contour| if double_area(contour) > 0 { 1 } else { -1 };
        let turns = contours.iter().map(turn).collect();
        Self { turns, around: Around::new(contours.iter().enumerate()), sides, boxes }
    }

    fn holds(&self, p: Point) -> bool {
        self.around.of(p).map(|k| self.turns[k]).sum::<i32>() > 0
    }

    /// The parts of the way from `a` to `b` that lie outside, as parts of its length.
    fn outside(&self, a: Point, b: Point) -> Vec<[f64; 2]> {
        let near = extent([&a, &b]).map_or_else(Vec::new, |own| self.boxes.meeting(own));
        let mut ends: Vec<f64> =
            near.into_iter().filter_map(|k| crossing((a, b), self.sides[k])).collect();
        ends.extend([0.0, 1.0]);
        ends.sort_unstable_by(f64::total_cmp);
        let mut parts: Vec<[f64; 2]> = Vec::new();
        for ends in ends.windows(2) {
            if self.holds(between(a, b, f64::midpoint(ends[0], ends[1]))) {
                continue;
            }
            match parts.last_mut().filter(|last| last[1] == ends[0]) {
                Some(last) => last[1] = ends[1],
                None => parts.push([ends[0], ends[1]]),
            }
        }
        parts
    }

    /// The pieces of `path` that lie outside; all of it, unchanged, if nothing lies inside.
    fn without(&self, path: Path) -> Vec<Path> {
        let sides = path.points.windows(2);
        let outside: Vec<Vec<[f64; 2]>> =
            sides.map(|ends| self.outside(ends[0].at, ends[1].at)).collect();
        if outside.iter().all(|parts| parts[..] == [[0.0, 1.0]]) {
            return vec![path];
        }
        let mut pieces: Vec<Vec<PathPoint>> = Vec::new();
        let mut goes_on = false;
        for (ends, parts) in path.points.windows(2).zip(outside) {
            for &[from, to] in &parts {
                let at =
                    |part: f64| PathPoint { at: between(ends[0].at, ends[1].at, part), ..ends[1] };
                match pieces.last_mut().filter(|_| goes_on && from == 0.0) {
                    Some(piece) => piece.push(at(to)),
                    None => pieces.push(vec![at(from), at(to)]),
                }
            }
            goes_on = parts.last().is_some_and(|last| last[1] == 1.0);
        }
        let piece = |points| Path { shape: Shape::Open, points, ..path.clone() };
        pieces.into_iter().filter(|points| is_long(points)).map(piece).collect()
    }
}

fn is_long(points: &[PathPoint]) -> bool {
    let length: f64 = points.windows(2).map(|ends| ends[0].at.distance(ends[1].at)).sum();
    points.last().is_some_and(|last| length >= LEAST_LENGTH * f64::from(last.width))
}

/// The place at this part of the way from `a` to `b`.
fn between(a: Point, b: Point, part: f64) -> Point {
    let at =
        |a: Coord, b: Coord| nearest(f64::from(a) + part * (f64::from(b) - f64::from(a))) as Coord;
    Point { x: at(a.x, b.x), y: at(a.y, b.y) }
}

/// At which part of the way from `a` to `b` the segment from `c` to `d` crosses it.
fn crossing((a, b): (Point, Point), (c, d): (Point, Point)) -> Option<f64> {
    let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let way = |p: Point, q: Point| way(float(p), float(q));
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let (own, other, between) = (way(a, b), way(c, d), way(a, c));
    let turn = cross(own, other);
    let (part, there) = (cross(between, other) / turn, cross(between, own) / turn);
    let is_crossed = (0.0..=1.0).contains(&part) && (0.0..=1.0).contains(&there);
    (turn != 0.0 && is_crossed).then_some(part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::Role;

    #[test]
    fn lines_are_cut_at_the_area_and_dots_are_left_out() {
        let p = |x, y| Point { x, y };
        let square = vec![p(0, 0), p(50_000, 0), p(50_000, 50_000), p(0, 50_000)];
        let hole = vec![p(20_000, 20_000), p(20_000, 40_000), p(40_000, 40_000), p(40_000, 20_000)];
        let point = |at| PathPoint { at, z: 0, width: 4_000, height: 2_000, hang: 0 };
        let line = |role, ends: &[Point]| Path {
            role,
            shape: Shape::Open,
            points: ends.iter().copied().map(point).collect(),
            layers: 1,
        };
        let ends = |path: &Path| path.points.iter().map(|p| p.at).collect::<Vec<_>>();
        let mut paths = vec![
            // Through the square and its hole, and on around a corner.
            line(Role::Support, &[p(-30_000, 30_000), p(70_000, 30_000), p(70_000, 60_000)]),
            line(Role::Skin, &[p(-30_000, 10_000), p(70_000, 10_000)]),
            // Ends just outside.
            line(Role::Support, &[p(-5_000, 10_000), p(10_000, 10_000)]),
            line(Role::Support, &[p(0, 60_000), p(50_000, 60_000)]),
        ];
        let (skin, beside) = (paths[1].clone(), paths[3].clone());
        clear(&mut paths, &[square, hole]);
        assert_eq!(paths.len(), 5);
        assert_eq!((&paths[0], &paths[4]), (&skin, &beside));
        assert_eq!(ends(&paths[1]), [p(-30_000, 30_000), p(0, 30_000)]);
        assert_eq!(ends(&paths[2]), [p(20_000, 30_000), p(40_000, 30_000)]);
        let around = [p(50_000, 30_000), p(70_000, 30_000), p(70_000, 60_000)];
        assert_eq!(ends(&paths[3]), around);
    }
}
