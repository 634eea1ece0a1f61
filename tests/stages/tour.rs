//! Ordered paths -> reordered paths: tests what reordering keeps, on random runs of paths.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use proptest::prelude::*;
use slicer::fill::{Path, PathPoint, Role, Shape};
use slicer::geom::Point;
use slicer::plan::tour::{Cost, improve};
use slicer::units::Coord;

/// A travel costs its length, and more where it crosses the y axis.
struct Lengths;

impl Cost for Lengths {
    fn least(&self, from: Point, to: Point) -> f64 {
        from.distance(to)
    }

    fn whole(&self, from: Point, to: Point) -> f64 {
        let crosses = (from.x < 0) != (to.x < 0);
        self.least(from, to) + if crosses { 20_000.0 } else { 0.0 }
    }

    fn reach(&self, time: f64) -> f64 {
        time
    }
}

fn cost(from: Point, paths: &[Path]) -> f64 {
    let starts = paths.iter().map(Path::start);
    let ends = [from].into_iter().chain(paths.iter().map(Path::end));
    ends.zip(starts).map(|(a, b)| Lengths.whole(a, b)).sum()
}

fn place(x: Coord, y: Coord) -> PathPoint {
    PathPoint { at: Point { x, y }, z: 0, width: 4_000, height: 2_000, hang: 0 }
}

fn line(role: Role, points: Vec<PathPoint>) -> Path {
    Path { role, shape: Shape::Open, points, layers: 1 }
}

/// A path without its direction.
fn undirected(path: &Path) -> (Role, Vec<Point>) {
    let mut points: Vec<Point> = path.points.iter().map(|p| p.at).collect();
    if points.last() < points.first() {
        points.reverse();
    }
    (path.role, points)
}

fn paths() -> impl Strategy<Value = Vec<Path>> {
    let at = || (-200_000..200_000_i32, -200_000..200_000_i32);
    let roles =
        prop::sample::select(vec![Role::OuterWall, Role::Skin, Role::Infill, Role::Support]);
    let path = |(role, a, b): (Role, (Coord, Coord), (Coord, Coord))| {
        line(role, vec![place(a.0, a.1), place(b.0, b.1)])
    };
    prop::collection::vec((roles, at(), at()).prop_map(path), 0..80).prop_map(|mut paths| {
        paths.sort_by_key(|p| match p.role {
            Role::OuterWall => p.start().x / 100_000,
            Role::Skin | Role::Infill => 3,
            _ => 4,
        });
        paths
    })
}

proptest! {
    #[test]
    fn every_path_comes_once_and_travels_never_take_longer(paths in paths()) {
        let from = Point { x: 100_000, y: -150_000 };
        let better = improve(paths.clone(), Some(from), &Lengths);
        prop_assert!(cost(from, &better) <= cost(from, &paths) + 1e-6);
        prop_assert_eq!(better.last(), paths.last());
        let mut kept: Vec<_> = paths.iter().map(undirected).collect();
        let mut made: Vec<_> = better.iter().map(undirected).collect();
        kept.sort();
        made.sort();
        prop_assert_eq!(kept, made);
        // Walls stay where they are in the order, and support stays behind all else.
        for (k, path) in paths.iter().enumerate().filter(|(_, p)| p.role == Role::OuterWall) {
            prop_assert_eq!(path, &better[k]);
        }
        let support = |paths: &[Path]| -> Vec<bool> {
            paths.iter().map(|p| p.role == Role::Support).collect()
        };
        prop_assert_eq!(support(&better), support(&paths));
        prop_assert_eq!(improve(paths, Some(from), &Lengths), better);
    }
}

#[test]
fn a_path_left_behind_is_moved_to_where_the_nozzle_passes() {
    let upright = |x: Coord| line(Role::Infill, vec![place(x, 0), place(x, 10_000)]);
    let order = [10_000, 20_000, 40_000, 50_000, 30_000, 60_000].map(upright).to_vec();
    let better = improve(order, Some(Point { x: 0, y: 0 }), &Lengths);
    let xs: Vec<Coord> = better.iter().map(|p| p.start().x).collect();
    assert_eq!(xs, [10_000, 20_000, 30_000, 40_000, 50_000, 60_000]);
}
