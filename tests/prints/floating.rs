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

const SUPPORT: [(&str, &str); 1] = [("support.enabled", "true")];

#[test]
fn a_tip_is_refused_with_its_layers_and_stands_on_support_or_cut_off() {
    let Hanging::EmptyLayers { from, until, gap_mm, from_bed } = hanging(&tip(), &[]) else {
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
    let expected = Hanging::EmptyLayers { from: 11, until: 15, gap_mm: 1.0, from_bed: false };
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
