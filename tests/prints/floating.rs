//! Solids that begin in the air -> refusals and warnings, and prints that stand.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::circle;
use crate::common::{Solid, settings, slice_file};
use slicer::error::{Error, Hanging, Refusal};
use slicer::mesh::Placement;
use slicer::report::Report;
use slicer::warning::Warning;

fn sliced(solid: &Solid, set: &[(&str, &str)], sink: f64) -> Result<Report, Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.stl");
    std::fs::write(&path, solid.stl()).unwrap();
    let placement = Placement { sink, ..Placement::default() };
    slice_file(&path, &settings("generic-marlin", set), &placement).map(|(_, report)| report)
}

fn hanging(solid: &Solid, set: &[(&str, &str)]) -> Hanging {
    match sliced(solid, set, 0.0) {
        Err(Error::Refused(Refusal::Hanging(hanging))) => hanging,
        other => panic!("not refused: {other:?}"),
    }
}

fn begins_in_the_air(report: &Report) -> bool {
    report.warnings.iter().any(|w| matches!(w, Warning::BeginsInTheAir { .. }))
}

fn block(low: [f64; 3], high: [f64; 3]) -> Solid {
    Solid::cuboid(low, high)
}

/// A cone on its tip.
fn tip() -> Solid {
    Solid::tower(&[(circle(0.02, 32), 0.0), (circle(4.0, 32), 8.0)])
}

/// An arch of two legs and a beam. The right leg begins `leg` above the bed.
fn arch(leg: f64) -> Solid {
    block([0.0, 0.0, 0.0], [5.0, 5.0, 10.0])
        .and(&block([15.0, 0.0, leg], [20.0, 5.0, 10.0]))
        .and(&block([1.0, 1.0, 6.0], [19.0, 4.0, 9.5]))
}

/// How much of the outer walls droops: all, and the longest, with its layer.
fn drooping(report: &Report) -> Option<(f64, f64, usize)> {
    report.warnings.iter().find_map(|warning| match warning {
        Warning::WallsHang { length_mm, longest_mm, layer, .. } => {
            Some((*length_mm, *longest_mm, *layer))
        }
        _ => None,
    })
}

const SUPPORT: [(&str, &str); 1] = [("support.enabled", "true")];

#[test]
fn a_tip_is_refused_with_its_layers_and_stands_on_support_or_cut_off() {
    let Hanging::EmptyLayers { from, until, gap_mm, from_bed, .. } = hanging(&tip(), &[]) else {
        panic!("another reason")
    };
    assert!(from == 1 && from_bed && (gap_mm - 0.2 * until as f64).abs() < 1e-9);
    assert!(sliced(&tip(), &[], gap_mm).is_ok());
    assert!(!begins_in_the_air(&sliced(&tip(), &SUPPORT, 0.0).unwrap()));
    let warned = sliced(&tip(), &[("floating", "warn")], 0.0).unwrap();
    assert!(begins_in_the_air(&warned));
}

#[test]
fn a_gap_between_two_bodies_is_refused_and_named() {
    let two = block([0.0; 3], [10.0, 10.0, 2.0]).and(&block([0.0, 0.0, 3.0], [10.0, 10.0, 5.0]));
    let hangs = hanging(&two, &[]);
    let expected =
        Hanging::EmptyLayers { from: 11, until: 15, gap_mm: 1.0, from_bed: false, kept_away: None };
    assert_eq!(hangs, expected);
    assert!(sliced(&two, &SUPPORT, 0.0).is_ok());
}

#[test]
fn a_body_beside_another_that_stands_on_nothing_is_refused() {
    let two = block([0.0; 3], [10.0, 10.0, 8.0]).and(&block([20.0, 0.0, 2.0], [30.0, 10.0, 6.0]));
    let Hanging::Body { layer, above_bed_mm, at_mm, .. } = hanging(&two, &[]) else {
        panic!("another reason")
    };
    assert!(layer == 11 && (above_bed_mm - 2.0).abs() < 1e-9, "{layer} {above_bed_mm}");
    assert!(at_mm[0] > 100.0, "in the machine's coordinates: {at_mm:?}");
    assert!(sliced(&two, &SUPPORT, 0.0).is_ok());
}

/// A tube around the origin.
fn tube(outer: f64, inner: f64, high: f64) -> Solid {
    let hole = Solid::prism(&circle(inner, 48), 0.0, high).inside_out();
    Solid::prism(&circle(outer, 48), 0.0, high).and(&hole)
}

fn pin(radius: f64, low: f64, high: f64) -> Solid {
    Solid::prism(&circle(radius, 24), low, high)
}

#[test]
fn a_body_inside_another_that_touches_nothing_is_refused() {
    for high in [3.0, 5.0, 9.0, 21.0] {
        let inside = tube(12.0, 11.0, 22.0).and(&pin(3.0, 1.0, high));
        let hangs = hanging(&inside, &[]);
        assert!(matches!(hangs, Hanging::Body { layer: 6, .. }), "{high}: {hangs:?}");
        // Standing on the bed, or hanging from a lid, it is held.
        for held in [
            tube(12.0, 11.0, 8.0).and(&pin(3.0, 0.0, 5.0)),
            tube(12.0, 11.0, 8.0).and(&pin(3.0, 1.0, 8.0)).and(&pin(12.0, 7.5, 9.0)),
        ] {
            sliced(&held, &[], 0.0).unwrap();
        }
    }
}

#[test]
fn bodies_that_share_an_edge_hold_no_more_than_those_apart() {
    let low = block([0.0; 3], [10.0, 10.0, 4.0]);
    for apart in [0.0, 0.05] {
        let by = 10.0 + apart;
        for at in [[by, 0.0, 4.0], [by, by, 4.0], [by, 3.0, 4.0]] {
            let two = low.clone().and(&block(at, [at[0] + 10.0, at[1] + 10.0, 8.0]));
            for degrees in [0.0_f64, 30.0, 90.0] {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let turned = two.map(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, z]);
                let hangs = hanging(&turned, &[]);
                assert!(matches!(hangs, Hanging::Body { layer: 21, .. }), "{at:?} {hangs:?}");
            }
        }
    }
    // One that reaches over the other by half a line is held.
    let over = low.and(&block([9.8, 0.0, 4.0], [19.8, 10.0, 8.0]));
    sliced(&over, &[], 0.0).unwrap();
}

#[test]
fn a_neck_too_thin_to_be_printed_holds_nothing() {
    // Two cylinders that lie on a line, and a thread between their ends along that line.
    let ball = |x: f64, radius: f64, high: f64| {
        let rings = [0.02, radius, radius, 0.02].map(|r| circle(r, 32));
        let at = [-4.0, -3.0, 3.0, 4.0];
        let rings: Vec<_> = rings.into_iter().zip(at).collect();
        // Its axis along x.
        Solid::tower(&rings).map(|[a, b, c]| [c + x, a, b + high])
    };
    let two = ball(0.0, 5.0, 5.0).and(&ball(12.0, 4.0, 5.0));
    let neck = two.and(&block([3.0, -0.04, 4.0], [9.0, 0.04, 6.0]));
    let hangs = hanging(&neck, &[]);
    assert!(matches!(hangs, Hanging::Body { .. }), "{hangs:?}");
}

#[test]
fn an_island_between_the_lines_of_open_infill_is_warned_of() {
    let small = |x: f64, y: f64| block([x, y, 1.0], [x + 1.2, y + 1.2, 2.0]);
    let at = |k: u8| 2.0 + 2.7 * f64::from(k);
    let comb = (0..36)
        .fold(block([0.0; 3], [20.0, 20.0, 1.0]), |all, k| all.and(&small(at(k / 6), at(k % 6))));
    assert!(!begins_in_the_air(&sliced(&comb, &[], 0.0).unwrap()));
    for key in ["skin_layers", "top_layers"] {
        let report = sliced(&comb, &[(key, "0"), ("infill", "8")], 0.0).unwrap();
        assert!(begins_in_the_air(&report), "{key}");
    }
}

#[test]
fn what_keeps_support_away_is_named() {
    let over = |gap: f64| {
        block([0.0; 3], [20.0, 20.0, 2.0]).and(&block([5.0, 5.0, 2.0 + gap], [15.0, 15.0, 6.0]))
    };
    let named = |solid: &Solid, set: &[(&str, &str)]| {
        let set: Vec<_> = SUPPORT.iter().chain(set).copied().collect();
        let refusal = hanging(solid, &set).to_string();
        assert!(!refusal.contains("with --support"), "{refusal}");
        refusal.split_whitespace().find(|word| word.starts_with("support.")).unwrap().to_owned()
    };
    let two = block([0.0; 3], [10.0, 10.0, 8.0]).and(&block([20.0, 0.0, 2.0], [30.0, 10.0, 6.0]));
    assert_eq!(named(&over(0.2), &[]), "support.z_distance");
    assert_eq!(named(&over(2.0), &[("support.stands_on", "bed")]), "support.stands_on");
    assert_eq!(named(&two, &[("support.xy_distance", "20")]), "support.xy_distance");
    assert_eq!(named(&two, &[("support.threshold_angle", "0")]), "support.threshold_angle");
}

#[test]
fn a_body_with_support_under_its_middle_alone_stands_on_it() {
    // Walls on two sides keep support away from all its corners.
    for gap in [0.02, 0.3, 0.6, 1.0] {
        let wall = |from: f64| block([from, -2.0, 0.0], [from + 4.0, 22.0, 8.0]);
        let held = block([0.0, 0.0, 3.0], [10.0, 20.0, 6.0]);
        let all = held.and(&wall(-4.0 - gap)).and(&wall(10.0 + gap));
        for degrees in [0.0_f64, 30.0, 90.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let turned = all.map(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, z]);
            let report = sliced(&turned, &SUPPORT, 0.0);
            let report = report.unwrap_or_else(|error| panic!("{gap}, {degrees}: {error}"));
            assert!(!begins_in_the_air(&report), "{gap}, {degrees}");
        }
    }
}

#[test]
fn an_arm_that_meets_what_stands_is_warned_of_or_refused_as_asked() {
    let arch = arch(2.0);
    assert!(begins_in_the_air(&sliced(&arch, &[], 0.0).unwrap()));
    let hangs = hanging(&arch, &[("floating", "refuse-all")]);
    assert!(matches!(hangs, Hanging::Places { places: 1, layer: 11, .. }), "{hangs:?}");
    assert!(!begins_in_the_air(&sliced(&arch, &SUPPORT, 0.0).unwrap()));
}

#[test]
fn what_stands_is_not_warned_of() {
    let ball = Solid::ball(8.0, 32);
    let nested = block([0.0; 3], [20.0, 20.0, 4.0]).and(&block([5.0, 5.0, 3.0], [15.0, 15.0, 9.0]));
    for solid in [arch(0.0), ball, nested, Solid::cylinder(6.0, 5.0, 40)] {
        assert!(!begins_in_the_air(&sliced(&solid, &[], 0.0).unwrap()));
    }
}

#[test]
fn walls_that_hang_for_long_are_told_and_bridges_and_ledges_are_not() {
    let plate = |reach: f64| block([-5.0 - reach, -8.0, 5.0], [5.0 + reach, 8.0, 8.0]);
    let table = |reach: f64| block([-5.0, -5.0, 0.0], [5.0, 5.0, 6.0]).and(&plate(reach));
    // All around it but for 1 mm beside the leg: the plate is nowhere nearer at its corners.
    let (all, longest, layer) = drooping(&sliced(&table(15.0), &[], 0.0).unwrap()).unwrap();
    let around = 2.0 * (40.0 + 16.0) - 4.0 * 0.2 * 2.0;
    assert!((longest - around).abs() < 4.0 && (all - longest).abs() < 1e-9, "{all} {longest}");
    assert_eq!(layer, 26);
    assert_eq!(drooping(&sliced(&table(15.0), &SUPPORT, 0.0).unwrap()), None);
    // Beams between two legs, on which they lie and beyond which they reach by little.
    let legs = block([0.0; 3], [5.0, 5.0, 10.0]).and(&block([45.0, 0.0, 0.0], [50.0, 5.0, 10.0]));
    let beam = legs.and(&block([-0.5, -0.5, 9.0], [50.5, 5.5, 12.0]));
    assert_eq!(drooping(&sliced(&beam, &[], 0.0).unwrap()), None);
    // A slope of 45° and a small chin.
    let slope = Solid::tower(&[(circle(5.0, 64), 0.0), (circle(25.0, 64), 20.0)]);
    let chin = block([0.0; 3], [10.0, 10.0, 20.0]).and(&block([5.0, 3.0, 12.0], [13.0, 7.0, 20.0]));
    for clean in [slope, chin] {
        assert_eq!(drooping(&sliced(&clean, &[], 0.0).unwrap()), None);
    }
}
