//! Thin plates and wedges -> G-code, read back: how much plastic is in them, and whether beads lie on each other.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::Outline;
use crate::common::{Kind, Move, Run, Solid, slice};
use std::collections::BTreeSet;

const WIDTH: f64 = 0.4;
const LENGTH: f64 = 24.0;
/// Away from the ends, mm from the middle.
const WITHIN: f64 = 8.0;
/// Skin, and infill far from it.
const LAYERS: [usize; 2] = [0, 7];

/// An upright plate, 15 layers high, whose thickness goes from `first` to `last` mm.
fn plate(first: f64, last: f64) -> Solid {
    let outline: Outline =
        vec![[0.0, -first / 2.0], [LENGTH, -last / 2.0], [LENGTH, last / 2.0], [0.0, first / 2.0]];
    Solid::prism(&outline, 0.0, 3.0)
}

fn turned(solid: &Solid, degrees: f64) -> Solid {
    let (sin, cos) = degrees.to_radians().sin_cos();
    solid.map(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, z])
}

fn sliced(solid: &Solid, walls: u32, angle: f64, set: &[(&str, &str)]) -> Run {
    let (walls, angle) = (walls.to_string(), angle.to_string());
    let mut all = vec![("walls", walls.as_str()), ("angle", angle.as_str())];
    all.extend(set);
    slice(&solid.stl(), "generic-marlin", &all)
}

/// Where a place is along the plate that is turned by `degrees`, mm from its middle.
fn along(run: &Run, degrees: f64, at: [f64; 2]) -> f64 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let middle = run.middle();
    cos * (at[0] - middle[0]) + sin * (at[1] - middle[1])
}

/// Plastic of a layer between two places along the plate, mm³.
fn plastic(run: &Run, degrees: f64, layer: usize, low: f64, high: f64) -> f64 {
    let part = |m: &Move| {
        let (a, b) = (along(run, degrees, m.a()), along(run, degrees, m.b()));
        let inside = (a.max(b).min(high) - a.min(b).max(low)).max(0.0);
        if (a - b).abs() < 1e-6 {
            return f64::from(u8::from((low..high).contains(&a)));
        }
        inside / (a - b).abs()
    };
    let beads = run.print.beads().filter(|m| m.layer == Some(layer));
    beads.map(|m| m.e * part(m)).sum::<f64>() * run.filament_area()
}

/// The longest stretch that a bead of a layer runs nearer than half a width to another, or to
/// itself further on, mm.
fn longest_twice(run: &Run, degrees: f64, layer: usize) -> f64 {
    const STEP: f64 = 0.05;
    let mut places: Vec<([f64; 2], f64)> = Vec::new();
    let mut way = 0.0;
    let mut end = [f64::MAX; 2];
    for m in run.print.beads().filter(|m| m.layer == Some(layer)) {
        if m.a() != end {
            way += 100.0;
        }
        end = m.b();
        let count = (m.length() / STEP).ceil().max(1.0);
        places.extend((0..count as usize).map(|k| {
            let t = (k as f64 + 0.5) / count;
            (m.at(t), way + t * m.length())
        }));
        way += m.length();
    }
    let near = |p: &([f64; 2], f64), q: &([f64; 2], f64)| {
        (p.1 - q.1).abs() > 1.5 && (p.0[0] - q.0[0]).hypot(p.0[1] - q.0[1]) < 0.49 * WIDTH
    };
    let (mut longest, mut from) = (0.0_f64, None::<f64>);
    for p in &places {
        let here = along(run, degrees, p.0).abs() < WITHIN && places.iter().any(|q| near(p, q));
        match (here, from) {
            (true, Some(start)) if p.1 - start < 90.0 => longest = longest.max(p.1 - start),
            (true, _) => from = Some(p.1),
            (false, _) => from = None,
        }
    }
    longest
}

/// Plates from 0.8 to 3 mm in steps of 0.05.
fn thicknesses() -> impl Iterator<Item = f64> {
    (16..=60).map(|k| f64::from(k) / 20.0)
}

/// How far in the walls and one bead between them reach, mm.
fn filled_up_to(walls: u32) -> f64 {
    (2.0 * f64::from(walls) + 1.6) * WIDTH
}

#[test]
fn plates_of_any_thickness_are_as_full_as_walls_and_one_bead_make_them() {
    let mut wrong = Vec::new();
    for walls in [2, 3] {
        for thickness in thicknesses() {
            for (turn, angle) in [(0.0, 0.0), (0.0, 45.0), (20.0, 0.0)] {
                let run = sliced(&turned(&plate(thickness, thickness), turn), walls, angle, &[]);
                for layer in LAYERS {
                    let volume = thickness * 2.0 * WITHIN * 0.2;
                    let ratio = plastic(&run, turn, layer, -WITHIN, WITHIN) / volume;
                    let sparse = layer == LAYERS[1] && thickness > filled_up_to(walls) - 0.01;
                    let least =
                        if sparse { 2.0 * f64::from(walls) * WIDTH / thickness } else { 0.9 };
                    let twice = longest_twice(&run, turn, layer);
                    if !(least - 0.01..=1.06).contains(&ratio) || twice > 1.0 {
                        wrong.push(format!("{walls} walls, {thickness} mm at {turn}/{angle}, layer {layer}: {ratio:.3}, {twice:.1} mm twice"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn a_wedge_is_full_all_along() {
    let mut wrong = Vec::new();
    for walls in [2, 3] {
        for (turn, angle) in [(0.0, 0.0), (0.0, 45.0), (20.0, 0.0)] {
            let run = sliced(&turned(&plate(0.8, filled_up_to(walls)), turn), walls, angle, &[]);
            for layer in LAYERS {
                let twice = longest_twice(&run, turn, layer);
                if twice > 1.0 {
                    wrong.push(format!(
                        "{walls} walls at {turn}/{angle}, layer {layer}: {twice:.1} mm twice"
                    ));
                }
                for low in (-8..6).map(f64::from) {
                    let middle = low + 1.0;
                    let share = middle / LENGTH + 0.5;
                    let thickness = 0.8 + share * (filled_up_to(walls) - 0.8);
                    let ratio =
                        plastic(&run, turn, layer, low, low + 2.0) / (thickness * 2.0 * 0.2);
                    // Where the number of beads changes.
                    if !(0.85..=1.12).contains(&ratio) {
                        wrong.push(format!("{walls} walls, {thickness:.2} mm at {turn}/{angle}, layer {layer}: {ratio:.3}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn a_plate_of_one_line_is_one_bead_on_every_layer() {
    for thickness in [0.35, 0.4, 0.5, 0.69] {
        let run = sliced(&plate(thickness, thickness), 1, 45.0, &[]);
        for layer in 0..15 {
            let beads: Vec<_> = run.print.beads().filter(|m| m.layer == Some(layer)).collect();
            assert_eq!(beads.len(), 1, "{thickness} mm, layer {layer}");
            assert!((beads[0].width - thickness).abs() < 0.02, "{}", beads[0].width);
        }
    }
}

#[test]
fn what_fills_a_narrow_room_is_infill_where_nothing_exposes_it() {
    // Middle beads, beads along the walls, and solid lines.
    for (thick, walls) in [(1.2, 1), (1.6, 1), (2.0, 2), (2.4, 2), (3.0, 2)] {
        for angle in [0.0, 30.0, 90.0] {
            let run = sliced(&plate(thick, thick), walls, angle, &[]);
            let layers = run.print.of(Kind::Infill).map(|m| m.layer.unwrap());
            let layers: BTreeSet<usize> = layers.collect();
            assert_eq!(layers, (3..12).collect(), "{thick} mm, {walls} walls, {angle} degrees");
        }
    }
}

/// The length of a layer's lines of a kind beside the middle of a plate along x: along it, and across.
fn ways(run: &Run, kind: Kind, layer: usize) -> [f64; 2] {
    let near = |m: &&Move| along(run, 0.0, m.at(0.5)).abs() < WITHIN;
    let beads = run.print.of(kind).filter(|m| m.layer == Some(layer)).filter(near);
    beads.fold([0.0; 2], |[along, across], m| {
        let [x, y] = [0, 1].map(|axis| (m.to[axis] - m.from[axis]).abs());
        [along + x, across + y]
    })
}

/// Rooms up to 2 mm wide are solid. Zigzags in them would be nearly all turns.
#[test]
fn the_room_between_two_walls_is_filled_by_beads_along_them() {
    for room in [0.5, 0.9, 1.2, 1.4, 1.7, 1.95] {
        for angle in [0.0, 30.0, 90.0] {
            let run = sliced(&plate(1.6 + room, 1.6 + room), 2, angle, &[]);
            for layer in [6, 7] {
                let [along, across] = ways(&run, Kind::Infill, layer);
                assert!(along > 10.0, "{room} mm, {angle} degrees, layer {layer}: {along} mm");
                assert!(across < 0.02 * along, "{room} mm, {angle} degrees: {across} of {along}");
                let filled = plastic(&run, 0.0, layer, -WITHIN, WITHIN);
                let share = filled / ((1.6 + room) * 2.0 * WITHIN * 0.2);
                assert!((0.95..=1.03).contains(&share), "{room} mm, {angle} degrees: {share}");
            }
        }
    }
}

#[test]
fn beads_that_lie_on_each_other_are_printed_once_for_both_layers() {
    for (thickness, mode) in [(2.1, "pair"), (2.8, "pair"), (3.3, "pair"), (3.3, "interlaced")] {
        let plain = sliced(&plate(thickness, thickness), 2, 0.0, &[]);
        let dual = sliced(&plate(thickness, thickness), 2, 0.0, &[("dual.mode", mode)]);
        let of = |run: &Run, thick: bool| -> f64 {
            let infill = run.print.of(Kind::Infill).filter(|m| run.print.is_thick(m) == thick);
            infill.map(|m| m.e).sum()
        };
        let (all, thick, thin) = (of(&plain, false), of(&dual, true), of(&dual, false));
        assert!(
            (thick + thin - all).abs() < 0.01 * all,
            "{thickness} mm {mode}: {thick} {thin} {all}"
        );
        assert!(thick > 0.75 * all, "{thickness} mm {mode}: {thick} of {all}");
    }
}
