//! Random solids that hang -> prints with support: it stands, and is not slender.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::{Kind, Move, Run, Solid, slice, solid::circle};
use proptest::prelude::*;
use slicer::check::finding::{Code, Finding};
use slicer::check::terms::Terms;
use slicer::check::{self};
use slicer::reader::Print;

/// What is found of support itself.
fn faults(text: &str) -> Vec<Finding> {
    let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
    let verdict = check::check(&print, &Terms::new(None, None, &print), None);
    let of_support = |finding: &Finding| match finding.code {
        Code::SlenderSupport => true,
        Code::Floating => finding.text.contains("of support"),
        _ => false,
    };
    verdict.findings.into_iter().filter(of_support).collect()
}

/// A column with arms: boxes that reach out of it, and balls on its sides, at heights of their own.
fn tree(boxes: &[[f64; 5]], balls: &[[f64; 4]]) -> Solid {
    let mut solid = Solid::cuboid([-4.0, -4.0, 0.0], [4.0, 4.0, 24.0]);
    for &[x, y, z, wide, high] in boxes {
        let low = [x.min(0.0) - wide, y.min(0.0) - wide, z];
        solid = solid.and(&Solid::cuboid(low, [x.max(0.0) + wide, y.max(0.0) + wide, z + high]));
    }
    for &[x, y, z, radius] in balls {
        solid = solid.and(&Solid::ball(radius, 24).shifted([x, y, z]));
    }
    solid
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn support_stands_and_is_not_slender(
        boxes in prop::collection::vec(
            [-9.0..9.0, -9.0..9.0, 3.0..20.0, 0.5..3.0, 1.0..4.0_f64],
            1..3,
        ),
        balls in prop::collection::vec([-6.0..6.0, -6.0..6.0, 6.0..18.0, 2.0..5.0_f64], 0..2),
    ) {
        let run = slice(&tree(&boxes, &balls).stl(), "generic-marlin", &[("support.enabled", "true")]);
        let found = faults(&run.text);
        prop_assert!(found.is_empty(), "{found:?}");
    }
}

/// A roof over a slope, so that support stands on the slope and beside it.
#[test]
fn support_over_a_slope_stands_on_it() {
    for angle in [20.0_f64, 35.0, 50.0, 65.0] {
        let run_out = 12.0 / angle.to_radians().tan();
        let hill = Solid::tower(&[(circle(2.0 + run_out, 48), 0.0), (circle(2.0, 48), 12.0)]);
        let neck = Solid::cylinder(2.0, 20.0, 48);
        let hat = Solid::cylinder(12.0, 2.0, 48).shifted([0.0, 0.0, 18.0]);
        let part = hill.and(&neck).and(&hat);
        let run = slice(&part.stl(), "generic-marlin", &[("support.enabled", "true")]);
        let found = faults(&run.text);
        assert!(found.is_empty(), "{angle}: {found:?}");
    }
}

/// How much support there is, mm of lines.
fn length(solid: &Solid, set: &[(&str, &str)]) -> f64 {
    let set: Vec<(&str, &str)> = [&[("support.enabled", "true")], set].concat();
    let run = slice(&solid.stl(), "generic-marlin", &set);
    let kinds = [Kind::Support, Kind::SupportInterface];
    kinds.iter().flat_map(|&kind| run.print.of(kind)).map(|line| line.length()).sum()
}

/// A round or square ledge around a column.
#[test]
fn a_sliver_beyond_the_threshold_gets_no_support() {
    let corners = [4, 48];
    for (height, n) in [0.1, 0.2, 0.3].into_iter().zip(corners.iter().cycle()) {
        let ledge = |reach: f64| {
            let top = Solid::cylinder(8.0 + reach, 2.0, *n).shifted([0.0, 0.0, 4.8]);
            Solid::cylinder(8.0, 6.0, *n).and(&top)
        };
        // Corners make the ledge of the square narrower than its radius says.
        let side = (std::f64::consts::PI / *n as f64).cos();
        let layers = height.to_string();
        for angle in ["0", "30"] {
            let set = [("layer_height", layers.as_str()), ("angle", angle)];
            let of = |reach: f64| length(&ledge(reach / side), &set);
            assert!(of(1.1 * height + 0.03) <= 0.0, "{height} {angle}");
            assert!(of(2.0 * height + 0.1) > 50.0, "{height} {angle}");
        }
    }
}

/// How much support a wedge gets that leans out at so many degrees to the bed, mm of lines for each mm of its
/// height.
fn under_wedge(degrees: f64, set: &[(&str, &str)]) -> f64 {
    let far = 10.0 / degrees.to_radians().tan();
    let foot = vec![[0.0, 0.0], [6.0, 0.0], [6.0, 16.0], [0.0, 16.0]];
    let top = vec![[0.0, 0.0], [6.0 + far, 0.0], [6.0 + far, 16.0], [0.0, 16.0]];
    length(&Solid::tower(&[(foot, 0.0), (top, 10.0)]), set) / 10.0
}

/// A cone on its tip, steeper or flatter than the threshold.
#[test]
fn slopes_flatter_than_the_threshold_get_support() {
    for (degrees, wanted) in [(30.0_f64, true), (46.0, false), (60.0, false)] {
        for height in ["0.1", "0.2", "0.3"] {
            let far = 6.0 / degrees.to_radians().tan();
            let cone = Solid::tower(&[(circle(4.0, 48), 0.0), (circle(4.0 + far, 48), 6.0)]);
            let found = length(&cone, &[("layer_height", height)]) > 0.0;
            assert_eq!(found, wanted, "{degrees} {height}");
        }
    }
}

/// The threshold is the angle of the surface to the bed, to a degree or two.
#[test]
fn the_threshold_is_that_of_the_slope() {
    for height in ["0.1", "0.2", "0.3"] {
        for angle in ["0", "30", "90"] {
            for threshold in ["35", "45"] {
                let set = [
                    ("layer_height", height),
                    ("angle", angle),
                    ("support.threshold_angle", threshold),
                ];
                let at: f64 = threshold.parse().unwrap();
                for off in [-15.0, -8.0, -4.0, -2.0, 1.0, 4.0, 15.0] {
                    let found = under_wedge(at + off, &set);
                    let is_right = if off < 0.0 { found > 100.0 } else { found <= 0.0 };
                    assert!(is_right, "{height} {angle} {threshold} {off}: {found}");
                }
            }
        }
    }
}

/// Layers are cut in the middle of their height: the next one is further from a thick first layer.
#[test]
fn a_thick_first_layer_does_not_shift_the_threshold() {
    for first in ["0.1", "0.2", "0.3"] {
        let set = [("layer_height", "0.1"), ("first_layer_height", first)];
        let [flat, steep] = [42.0, 46.5].map(|degrees| under_wedge(degrees, &set));
        assert!(flat > 100.0 && steep <= 0.0, "{first}: {flat} {steep}");
    }
}

/// A bell that widens upwards gets support all around, though rows cross its sides at all angles.
#[test]
fn support_does_not_depend_on_the_direction_of_an_overhang() {
    for (corners, angle) in [(48, 55.0_f64), (48, 60.0), (8, 60.0), (12, 65.0)] {
        let rim = 2.0 + 8.0 * angle.to_radians().tan();
        let foot = Solid::cylinder(2.0, 6.0, 48);
        let bell = Solid::tower(&[(circle(2.0, corners), 5.0), (circle(rim, corners), 13.0)]);
        let run = slice(&foot.and(&bell).stl(), "generic-marlin", &[("support.enabled", "true")]);
        let [x, y] = run.middle();
        let mut sectors = [0.0; 8];
        for line in run.print.of(Kind::Support).filter(|line| line.is_bead()) {
            let ([ax, ay], [bx, by]) = (line.a(), line.b());
            // A millimetre at a time: lines cross sectors.
            let pieces = line.length().ceil();
            for k in 0..pieces as usize {
                let part = (k as f64 + 0.5) / pieces;
                let (u, v) = (ax + part * (bx - ax) - x, ay + part * (by - ay) - y);
                let turn = v.atan2(u) / std::f64::consts::FRAC_PI_4 + 8.5;
                sectors[turn.rem_euclid(8.0) as usize] += line.length() / pieces;
            }
        }
        let (least, most) =
            sectors.iter().fold((f64::MAX, 0.0_f64), |(a, b), s| (a.min(*s), b.max(*s)));
        assert!(least > 0.5 * most, "{corners} corners, {angle}: {sectors:?}");
    }
}

/// A house whose eaves hang all around it.
#[test]
fn support_under_eaves_is_one_folded_strip() {
    for at in [0.0, 0.8, 1.6] {
        let house = Solid::cuboid([-20.0, -15.0 + at, 0.0], [20.0, 15.0 + at, 14.0]);
        let roof = Solid::cuboid([-21.2, -16.2 + at, 12.0], [21.2, 16.2 + at, 14.0]);
        let part = house.and(&roof);
        let run = slice(&part.stl(), "generic-marlin", &[("support.enabled", "true")]);
        let found = faults(&run.text);
        assert!(found.is_empty(), "{found:?}");
        // The ring's middle line is 150 mm long.
        let layers = 10..50;
        let is_there = |line: &&Move| line.layer.is_some_and(|k| layers.contains(&k));
        let lines = run.print.of(Kind::Support).filter(is_there);
        let per_layer = lines.map(Move::length).sum::<f64>() / layers.len() as f64;
        assert!(per_layer < 1.9 * 150.0 && per_layer > 1.2 * 150.0, "{at}: {per_layer}");
    }
}

/// The longest stretch of bridge lines over the middle of a part, `half` wide to both sides, with
/// neither support nor a wall near it below, mm.
fn longest_free(run: &Run, half: [f64; 2]) -> f64 {
    let walls: Vec<&Move> = run.print.of(Kind::OuterWall).collect();
    let middle = [0, 1].map(|axis| {
        let ends = || walls.iter().map(|wall| wall.to[axis]);
        0.5 * (ends().fold(f64::MAX, f64::min) + ends().fold(f64::MIN, f64::max))
    });
    let bridge: Vec<&Move> = run.print.of(Kind::Bridge).collect();
    let first = bridge.iter().filter_map(|line| line.layer).min().unwrap();
    let is_below = |line: &&Move| line.layer == Some(first - 2);
    let support: Vec<&Move> = run.print.of(Kind::SupportInterface).filter(is_below).collect();
    let carried = |at: [f64; 2]| {
        let is_open = (0..2).all(|axis| (at[axis] - middle[axis]).abs() < half[axis]);
        let near = |line: &&Move| {
            (0..=40)
                .map(|i| line.at(f64::from(i) / 40.0))
                .any(|p| (p[0] - at[0]).hypot(p[1] - at[1]) < 0.7)
        };
        !is_open || support.iter().any(near)
    };
    let mut longest = 0.0_f64;
    for line in bridge.iter().filter(|line| line.layer == Some(first)).step_by(5) {
        let steps = (line.length() / 0.25).ceil().max(1.0);
        let mut free = 0.0;
        for i in 0..=steps as usize {
            free =
                if carried(line.at(i as f64 / steps)) { 0.0 } else { free + line.length() / steps };
            longest = longest.max(free);
        }
    }
    longest
}

/// Halls and bridges that are too long get support in strips, across the lines of their skin.
#[test]
fn a_long_bridge_lies_on_piers() {
    let wall = |low: [f64; 2], high: [f64; 2]| {
        Solid::cuboid([low[0], low[1], 0.0], [high[0], high[1], 5.2])
    };
    // Whole layers higher, the skin runs the other way.
    for [x, y, low] in [[15.0, 15.2, 4.8], [15.0, 15.2, 5.0], [16.0, 12.0, 4.8]] {
        let (a, b) = (x + 3.0, y + 3.0);
        let hall = wall([-a, -b], [-x, b]).and(&wall([x, -b], [a, b]));
        let hall = hall.and(&wall([-a, -b], [a, -y])).and(&wall([-a, y], [a, b]));
        let part = hall.and(&Solid::cuboid([-a, -b, low], [a, b, low + 1.0]));
        let set = [("support.enabled", "true"), ("angle", "0")];
        let run = slice(&part.stl(), "generic-marlin", &set);
        let found = faults(&run.text);
        assert!(found.is_empty(), "{found:?}");
        let free = longest_free(&run, [x - 0.5, y - 0.5]);
        assert!(free > 5.0 && free < 20.5, "{x} {y} {low}: {free}");
        let dense: f64 = run.print.of(Kind::SupportInterface).map(Move::length).sum();
        // Two layers of lines 0.6 mm apart at the top and on the bed.
        assert!(dense < 0.45 * 4.0 * 4.0 * x * y / 0.6, "{x} {y} {low}: {dense}");
    }
}
