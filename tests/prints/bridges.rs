//! Slabs on pillars and roofs of counterbores -> G-code, read back: bridges run from hold to hold.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{judge_made, kinds};
use crate::common::solid::circle;
use crate::common::{Kind, Move, Run, Solid, slice};

/// A slab on two pillars, turned.
fn slab(degrees: f64) -> Solid {
    let pillar = |x: f64| Solid::cuboid([x, 0.0, 0.0], [x + 6.0, 10.0, 5.5]);
    let slab = Solid::cuboid([0.0, 0.0, 5.0], [30.0, 10.0, 7.0]);
    let (sin, cos) = degrees.to_radians().sin_cos();
    let turned = |[x, y, z]: [f64; 3]| [cos * x - sin * y, sin * x + cos * y, z];
    pillar(0.0).and(&pillar(24.0)).and(&slab).map(turned)
}

/// How far a bead's direction is from one in degrees.
fn off(bead: &Move, degrees: f64) -> f64 {
    let [a, b] = [bead.a(), bead.b()];
    let off = (b[1] - a[1]).atan2(b[0] - a[0]).to_degrees() - degrees;
    (off + 90.0).rem_euclid(180.0) - 90.0
}

#[test]
fn a_bridge_runs_straight_from_pillar_to_pillar_at_any_angle() {
    for degrees in [0.0, 3.0, 10.0, 17.3, 23.0, 38.0, 45.0, 66.0, 81.0, 88.5, 120.0] {
        let stl = slab(degrees).stl();
        let run = slice(&stl, "generic-marlin", &[]);
        let long: Vec<&Move> = run.print.of(Kind::Bridge).filter(|m| m.length() > 5.0).collect();
        assert!(long.len() >= 18, "{degrees}: {}", long.len());
        let most = long.iter().map(|bead| off(bead, degrees).abs()).fold(0.0, f64::max);
        assert!(most < 0.3, "{degrees}: {most}");
        let codes = kinds(&judge_made(&run.text, &stl));
        assert!(codes.is_empty(), "{degrees}: {codes:?}");
    }
}

const FLOOR: f64 = 3.0;

/// A block with a hole that is wider below.
fn counterbore(hole: f64, bore: f64, corners: usize) -> Solid {
    let ring = |radius: f64, z: f64| (circle(radius, corners), z);
    let hollow = [ring(bore, 0.0), ring(bore, FLOOR), ring(hole, FLOOR), ring(hole, 6.0)];
    let block = Solid::cuboid([-12.0, -12.0, 0.0], [12.0, 12.0, 6.0]);
    block.and(&Solid::tower(&hollow).inside_out())
}

/// The lengths of bridge and of other beads in the ring around a hole, on the layer of its roof.
fn in_roof(run: &Run, [low, high]: [f64; 2]) -> [f64; 2] {
    let middle = run.middle();
    let lies = |m: &&Move| {
        let [x, y] = m.at(0.5);
        let away = (x - middle[0]).hypot(y - middle[1]);
        (m.to[2] - FLOOR - 0.2).abs() < 0.05 && away > low && away < high
    };
    let beads = || run.print.beads().filter(lies);
    let sum = |is_bridge: bool| {
        beads().filter(|m| (m.kind == Kind::Bridge) == is_bridge).map(Move::length).sum()
    };
    [sum(true), sum(false)]
}

#[test]
fn roofs_of_counterbores_are_laid_in_lines_that_hold() {
    for (hole, bore, corners) in [(1.7, 3.4, 32), (2.25, 4.25, 48), (3.2, 6.0, 48), (2.6, 5.0, 6)] {
        let stl = counterbore(hole, bore, corners).stl();
        let run = slice(&stl, "generic-marlin", &[]);
        let flat = bore * (std::f64::consts::PI / corners as f64).cos();
        let [bridge, others] = in_roof(&run, [hole + 0.8, flat - 0.4]);
        assert!(bridge > 0.0 && others < 0.05 * bridge, "{hole} {bore}: {bridge} {others}");
    }
}

/// A box open at the bottom, with three tubes that carry its roof, turned.
fn brick(wall: f64, degrees: f64) -> Solid {
    let pipe = |radius: f64| Solid::prism(&circle(radius, 48), 0.0, 9.0);
    let tube = |x: f64| {
        pipe(3.25).and(&pipe(3.25 - wall).inside_out()).map(move |[u, v, z]| [u + x, v, z])
    };
    let cavity = Solid::cuboid([-14.4, -6.4, 0.0], [14.4, 6.4, 8.6]).inside_out();
    let block = Solid::cuboid([-15.9, -7.9, 0.0], [15.9, 7.9, 9.6]).and(&cavity);
    let (sin, cos) = degrees.to_radians().sin_cos();
    let all = [-8.0, 0.0, 8.0].into_iter().fold(block, |all, x| all.and(&tube(x)));
    all.map(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, z])
}

/// The walls of the tubes are too thin for the anchors of two bridges in different directions.
#[test]
fn bridges_on_both_sides_of_a_thin_wall_run_in_one_direction() {
    for (wall, degrees) in [(0.85, 0.0), (0.85, 20.0), (1.2, 0.0), (1.6, 65.0)] {
        let stl = brick(wall, degrees).stl();
        let run = slice(&stl, "generic-marlin", &[]);
        let long: Vec<&Move> = run.print.of(Kind::Bridge).filter(|m| m.length() > 3.0).collect();
        assert!(long.len() > 30, "{wall} {degrees}: {}", long.len());
        let [a, b] = [long[0].a(), long[0].b()];
        let first = (b[1] - a[1]).atan2(b[0] - a[0]).to_degrees();
        let most = long.iter().map(|bead| off(bead, first).abs()).fold(0.0, f64::max);
        assert!(most < 0.3, "{wall} {degrees}: {most}");
    }
}
