//! Slopes that the head cannot follow -> lines that rise and fall within their own layer.
//!
//! - A *ramp* rises along x, so that its surface is known at each place. With the cautious head no skin
//!   follows it.
//! - Beads stay within their layer: never more than 0.06 mm above its top, and never thinner than the least
//!   height. Those of the ramp's treads lie at the surface, and the plastic is that of the part.
//! - Beside a *boss*, an upright block on the ramp, and where the layer above lies on a line, it does not fall.
//! - Switched off, the bytes are those of a print without any of it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{judge, kinds, listed};
use crate::common::gcode::WALLS;
use crate::common::solid::circle;
use crate::common::{Kind, Move, Run, Section, Solid, as_it_is, slice};
use proptest::prelude::*;

/// A line may rise by this above the top of its layer, mm.
const RISE: f64 = 0.06;

/// Coordinates are rounded to thousandths, mm.
const ROUNDED: f64 = 0.001;

/// What a line may miss the surface by, beside what its width makes, mm: the tolerance twice, and roundings.
const MISS: f64 = 0.015;

/// A ramp that is 1 mm high at its lower end.
fn ramp(degrees: f64, size: [f64; 2]) -> Solid {
    let rise = degrees.to_radians().tan();
    let block = Solid::cuboid([0.0; 3], [size[0], size[1], 1.0]);
    block.map(|[x, y, z]| [x, y, if z > 0.0 { 1.0 + x * rise } else { 0.0 }])
}

/// A cap of a ball of some radius, as wide as a circle of another, on a disc 1 mm high; flat in the middle.
fn dome(wide: f64, radius: f64) -> Solid {
    let foot = (radius * radius - wide * wide).sqrt();
    let ring = |k: u32| {
        let r = wide * f64::from(20 - k) / 20.0;
        (circle(r, 48), 1.0 + (radius * radius - r * r).sqrt() - foot)
    };
    let rings: Vec<_> = std::iter::once((circle(wide, 48), 0.0)).chain((0..20).map(ring)).collect();
    Solid::tower(&rings)
}

fn sliced(solid: &Solid, set: &[(&str, &str)]) -> Run {
    let head = [("nonplanar.enabled", "true"), ("head.name", "cautious")];
    slice(&solid.stl(), "generic-marlin", &[&head[..], set].concat())
}

/// How far beads lie above their layer's top, at both ends.
fn rises(run: &Run) -> impl Iterator<Item = (&Move, [f64; 2])> {
    let top = |m: &Move| run.print.layers[m.layer.unwrap()].z;
    run.print.beads().map(move |m| (m, [m.from[2] - top(m), m.to[2] - top(m)]))
}

/// Asserts that beads stay within their layers. Returns the length of those that do not lie level at the
/// layer's top.
fn bent(run: &Run) -> f64 {
    let least = run.settings.nonplanar.min_height;
    let mut length = 0.0;
    for (m, ends) in rises(run) {
        for up in ends {
            assert!(up <= RISE + ROUNDED, "{m:?} rises by {up}");
            assert!(up >= least - run.settings.layer_height - ROUNDED, "{m:?} falls by {up}");
        }
        assert!(m.layer > Some(0) || ends == [0.0; 2], "{m:?} on the first layer");
        if ends.iter().any(|up| up.abs() > 2.0 * ROUNDED) {
            length += m.length();
            let room = run.settings.layer_height + (ends[0] + ends[1]) / 2.0;
            assert!((m.height - room).abs() < 0.04, "{m:?} is {} high in {room}", m.height);
        }
    }
    length
}

/// The volume of all beads, mm³.
fn plastic(run: &Run) -> f64 {
    run.print.beads().map(|m| m.e).sum::<f64>() * run.filament_area()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    #[test]
    fn lines_of_a_ramp_lie_at_its_surface(degrees in 5.0..16.0_f64, wide in 8.0..14.0_f64) {
        let solid = ramp(degrees, [14.0, wide]);
        let run = sliced(&solid, &[("infill", "100")]);
        prop_assert!(bent(&run) > 50.0);
        let report = run.report.nonplanar.as_ref().unwrap();
        let surface = 14.0 * wide / degrees.to_radians().cos();
        prop_assert!((report.areas.contour_mm2 - surface).abs() < 0.01 * surface, "{report:?}");
        prop_assert!((report.areas.top_mm2 - surface).abs() < 0.01 * surface, "{report:?}");
        let rise = degrees.to_radians().tan();
        let left = run.middle()[0] - 7.0;
        let (mut near, mut all) = (0.0, 0.0);
        for (m, ends) in rises(&run).filter(|(_, ends)| ends.iter().any(|up| *up < -0.01)) {
            for (up, at) in ends.into_iter().zip([m.a(), m.b()]) {
                let own = run.print.layers[m.layer.unwrap()].z + up;
                let off = own - (1.0 + (at[0] - left) * rise);
                // What is straightened may rise a bit further on.
                prop_assert!(off < RISE + MISS, "{m:?} lies {off} above the surface");
                all += m.length();
                near += if off.abs() < MISS { m.length() } else { 0.0 };
            }
        }
        prop_assert!(near > 0.9 * all, "{near} of {all}");
        let share = plastic(&run) / solid.volume();
        prop_assert!((share - 1.0).abs() < 0.02, "{share}");
    }
}

#[test]
fn off_leaves_the_bytes_of_a_flat_print() {
    let solid = ramp(10.0, [14.0, 9.0]);
    let printed = |set: &[(&str, &str)]| {
        let text = slice(&solid.stl(), "generic-marlin", set).text;
        let is_print = |line: &&str| !line.starts_with(';');
        text.lines().filter(is_print).map(str::to_owned).collect::<Vec<_>>()
    };
    let off = [("nonplanar.enabled", "true"), ("nonplanar.contour", "false")];
    let flat = printed(&[]);
    assert_eq!(printed(&off), flat);
    assert_ne!(printed(&off[..1]), flat);
}

#[test]
fn the_check_takes_contouring_for_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.stl");
    for solid in [ramp(8.0, [16.0, 12.0]), dome(8.0, 46.0)] {
        // The middle of the dome is too small for a skin.
        let run = sliced(&solid, &[("nonplanar.min_area", "100")]);
        assert!(bent(&run) > 50.0);
        std::fs::write(&path, solid.stl()).unwrap();
        let verdict = judge(&run.text, path.to_str().unwrap(), &as_it_is());
        assert!(kinds(&verdict).is_empty(), "{}", listed(&verdict));
    }
}

#[test]
fn lines_do_not_fall_beside_a_boss_nor_under_a_line() {
    let boss = Solid::cuboid([5.0, 4.0, 0.4], [9.0, 8.0, 6.0]);
    let solid = ramp(10.0, [14.0, 12.0]).and(&boss);
    let run = sliced(&solid, &[]);
    assert!(bent(&run) > 50.0);
    let boss = boss.shifted([run.middle()[0] - 7.0, run.middle()[1] - 6.0, 0.0]);
    let boss = Section::new(&boss, 3.0);
    let on_bed = solid.on_bed(run.middle());
    let keep = 0.5 + run.settings.line_width / 2.0;
    for (m, ends) in rises(&run) {
        let top = run.print.layers[m.layer.unwrap()].z;
        let above = Section::new(&on_bed, top + run.settings.layer_height / 2.0);
        for (up, at) in ends.into_iter().zip([m.a(), m.b()]) {
            let lowest = if above.is_inside(at) { MISS } else { run.settings.layer_height };
            assert!(up > -lowest, "{m:?} falls by {up} under a line");
            let is_close = !boss.is_inside(at) && boss.distance(at, keep) < keep;
            assert!(!is_close || top > 6.0 || up > -MISS, "{m:?} falls by {up} beside the boss");
        }
    }
}

#[test]
fn only_tops_are_bent() {
    let run = sliced(&ramp(10.0, [14.0, 12.0]), &[]);
    let bent = |kinds: &[Kind]| {
        rises(&run)
            .filter(|(m, ends)| kinds.contains(&m.kind) && ends.iter().any(|up| up.abs() > 0.005))
            .count()
    };
    assert!(bent(&WALLS) > 0 && bent(&[Kind::Skin]) > 0);
    assert_eq!(bent(&[Kind::Infill, Kind::Bridge, Kind::Brim]), 0);
}

#[test]
fn a_layer_whose_only_line_falls_keeps_its_height() {
    let set = [("layer_height", "0.27"), ("first_layer_height", "0.2"), ("walls", "1")];
    let wedge = Solid::cuboid([0.0; 3], [24.0, 10.0, 1.6]);
    let wedge = wedge.map(|[x, y, z]| [x, y, if z > 0.0 { 1.6 + x / 12.0 } else { 0.0 }]);
    let run = sliced(&wedge, &set);
    let last = run.print.beads().filter(|m| m.layer == Some(run.print.layers.len() - 1));
    let fallen = last.map(|m| m.to[2]).fold(0.0, f64::max);
    assert!(fallen < 3.65, "{fallen}");
    let read = slicer::reader::Print::read(&mut run.text.as_bytes(), 1.75).unwrap();
    let top = read.facts.layers.last().unwrap().z;
    assert!((top - 3.71).abs() < 1e-3, "{top}");
}
