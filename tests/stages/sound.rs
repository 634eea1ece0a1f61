//! Prints and files that are right -> no errors of `check`: what once was found without being there.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{judge, kinds, listed};
use crate::common::solid::{Point3, circle};
use crate::common::{Solid, as_it_is, slice};
use slicer::check::finding::Code;
use slicer::check::terms::Terms;
use slicer::check::{self, Verdict};
use slicer::reader::Print;

/// Slices a solid and judges the print against it, by its own settings.
fn sliced(solid: &Solid, profile: &str, set: &[(&str, &str)]) -> Verdict {
    let text = slice(&solid.stl(), profile, set).text;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.stl");
    std::fs::write(&path, solid.stl()).unwrap();
    judge(&text, path.to_str().unwrap(), &as_it_is())
}

#[track_caller]
fn sound(verdict: &Verdict) {
    assert_eq!(kinds(verdict), [], "{}", listed(verdict));
}

fn boxes(corners: &[[Point3; 2]]) -> Solid {
    corners.iter().fold(Solid::default(), |all, [low, high]| all.and(&Solid::cuboid(*low, *high)))
}

#[test]
fn bodies_that_touch_by_faces_have_no_outline_between_them() {
    let stairs = boxes(&[
        [[0.0; 3], [8.0, 12.0, 2.0]],
        [[8.0, 0.0, 0.0], [16.0, 12.0, 4.0]],
        [[16.0, 2.0, 0.0], [24.0, 14.0, 6.0]],
    ]);
    for degrees in [0.0_f64, 10.0, 90.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let turned = stairs.map(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, z]);
        sound(&sliced(&turned, "generic-marlin", &[]));
    }
}

#[test]
fn hanging_inner_walls_are_no_outline() {
    let mushroom = Solid::tower(&[(circle(4.0, 48), 0.0), (circle(4.0, 48), 3.2)])
        .and(&Solid::prism(&circle(9.0, 48), 3.2, 4.2));
    sound(&sliced(&mushroom, "generic-marlin", &[("walls", "4")]));
}

#[test]
fn the_shipped_profiles_stay_on_their_machines() {
    let cube = boxes(&[[[0.0; 3], [10.0, 10.0, 5.0]]]);
    for profile in slicer::profile::builtin_names() {
        sound(&sliced(&cube, profile, &[]));
    }
}

/// A square of one line on several layers, its corner at `at`.
fn square(at: [f64; 2], layers: std::ops::RangeInclusive<u32>) -> String {
    layers
        .map(|layer| {
            let [x, y] = at;
            let z = 0.2 * f64::from(layer);
            let corners = [[x + 10.0, y], [x + 10.0, y + 10.0], [x, y + 10.0], [x, y]];
            let lines = corners.map(|[x, y]| format!("G1 X{x} Y{y} E0.3326 F1200\n")).concat();
            format!(
                ";LAYER_CHANGE\n;HEIGHT:0.2\n;WIDTH:0.4\n;TYPE:External perimeter\nG0 Z9\n\
             G0 X{x} Y{y} F9000\nG1 Z{z:.1}\n{lines}"
            )
        })
        .collect()
}

fn judged(body: &str) -> Verdict {
    let text = format!("M104 S200\nM109 S200\nG28\nG90\nM83\n{body}M104 S0\n");
    let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
    check::check(&print, &Terms::new(None, None, &print), None)
}

#[test]
fn parts_one_after_the_other_fall_only_where_they_meet() {
    sound(&judged(&(square([50.0, 50.0], 1..=3) + &square([80.0, 50.0], 1..=3))));
    let over = judged(&(square([50.0, 50.0], 1..=3) + &square([50.0, 50.0], 1..=1)));
    assert!(kinds(&over).contains(&Code::FallingZ), "{}", listed(&over));
}

#[test]
fn a_first_line_far_above_the_bed_hangs() {
    let bare = |z: f64| {
        let text = square([50.0, 50.0], 1..=1).replace(";HEIGHT:0.2\n;WIDTH:0.4\n", "");
        judged(&text.replace("Z0.2", &format!("Z{z}")))
    };
    sound(&bare(0.3));
    assert_eq!(kinds(&bare(5.0)), [Code::Floating]);
}
