//! The stepper machine of Nariño: strands where its source has them, of its plastic, and the size it missed.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::checks::sound;
use crate::common::{Kind, Move, Run, Solid, as_it_is, fixture, shipped, slice_file, slice_with};
use slicer::check::finding::Code;
use slicer::check::terms::Terms;
use slicer::check::{Model, check};
use slicer::error::{Error, Refusal};
use slicer::profile::Settings;
use slicer::reader;
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Coordinates are written in thousandths of a mm.
const ROUNDING: f64 = 0.0011;

fn printed(solid: &Solid, set: &[(&str, &str)]) -> Run {
    slice_with(&solid.stl(), shipped("narino", set), &as_it_is())
}

/// Width, depth and arms of [`angle`], mm: no line lies on the border of its room.
const SIZE: [f64; 2] = [30.5, 25.5];
const ARM: f64 = 11.5;

/// An angle bracket as it is seen from above.
fn angle(height: f64) -> Solid {
    let [x, y] = SIZE;
    let outline = vec![[0.0, 0.0], [x, 0.0], [x, ARM], [ARM, ARM], [ARM, y], [0.0, y]];
    Solid::prism(&outline, 0.0, height)
}

/// Beads of a kind on a layer, with places from the part's lowest corner.
fn beads(run: &Run, layer: usize, kind: Kind) -> Vec<Move> {
    let middle = run.middle();
    let from_low = |at: [f64; 3]| {
        [at[0] - middle[0] + SIZE[0] / 2.0, at[1] - middle[1] + SIZE[1] / 2.0, at[2]]
    };
    let own = run.print.beads().filter(|m| m.layer == Some(layer) && m.kind == kind);
    own.map(|m| Move { from: from_low(m.from), to: from_low(m.to), ..*m }).collect()
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING
}

#[test]
fn lines_lie_two_mm_apart_from_the_lowest_coordinate_and_turn_from_layer_to_layer() {
    let run = printed(&angle(6.0), &[]);
    for layer in 0..run.print.layers.len() {
        // Along x on layers 1, 3, 5 as people count them.
        let (along, across) = if layer % 2 == 0 { (0, 1) } else { (1, 0) };
        let lines = beads(&run, layer, Kind::Infill);
        let mut rows = Vec::new();
        for m in &lines {
            let way = [0, 1].map(|axis| (m.to[axis] - m.from[axis]).abs());
            if is_near(way[across], 0.0) {
                // Ends lie half a strand inside the wall's middle, 1 mm inside the part.
                let far = if m.from[across] < ARM { SIZE[along] } else { ARM };
                let mut ends = [m.from[along], m.to[along]];
                ends.sort_by(f64::total_cmp);
                assert!(is_near(ends[0], 1.0) && is_near(ends[1], far - 1.0), "{layer}: {m:?}");
                rows.push(m.from[across]);
            } else {
                // A piece from line to line, at right angles.
                assert!(is_near(way[along], 0.0) && is_near(way[across], 2.0), "{layer}: {m:?}");
            }
        }
        rows.sort_by(f64::total_cmp);
        let expected: Vec<f64> = (1..20).map(|k| 2.0 * f64::from(k)).collect();
        let expected: Vec<f64> =
            expected.into_iter().filter(|row| *row <= SIZE[across] - 1.0).collect();
        assert_eq!(rows.len(), expected.len(), "{layer}: {rows:?}");
        assert!(rows.iter().zip(&expected).all(|(a, b)| is_near(*a, *b)), "{layer}: {rows:?}");
        // At most where the part gets narrower the way is broken.
        let breaks = lines.windows(2).filter(|w| w[0].to[..2] != w[1].from[..2]).count();
        assert!(breaks <= 1, "{layer}: {breaks}");
    }
}

#[test]
fn a_strand_is_round_and_takes_as_much_when_it_is_pressed() {
    let run = printed(&angle(6.0), &[]);
    sound(&run.print, &run.settings, "narino");
    let heights: Vec<f64> = run.print.layers.iter().map(|layer| layer.z).collect();
    assert_eq!(heights, [0.6, 1.6, 2.6, 3.6, 4.6, 5.6]);
    let mut long = 0;
    for m in run.print.beads().filter(|m| m.length() > 3.0) {
        let plastic = m.e * run.filament_area() / m.length();
        assert!((plastic - PI / 4.0).abs() < 0.001, "line {}: {plastic}", m.line);
        long += 1;
    }
    assert!(long > 100);
    // Nothing is pulled back, nothing is warmed but the nozzle, no fan blows.
    assert!(run.print.moves.iter().all(|m| m.e >= 0.0));
    for code in ["M140", "M190", "M106 S"] {
        assert!(!run.text.contains(code), "{code}");
    }
    let homing: Vec<&str> = run.text.lines().filter(|line| line.starts_with("G28")).collect();
    assert_eq!(homing, ["G28 X0 Y0"; 2]);
}

#[test]
fn parts_have_their_size_and_the_sources_way_is_a_strand_more() {
    let cylinder = Solid::cylinder(10.0, 6.0, 96);
    for (inset, more) in [("0.5", 0.0), ("0", 1.0)] {
        let run = printed(&cylinder, &[("outer_wall_inset", inset)]);
        for axis in 0..2 {
            let ends = || run.print.beads().flat_map(|m| [m.from[axis], m.to[axis]]);
            let (low, high) = (ends().fold(99.0, f64::min), ends().fold(-99.0, f64::max));
            let size = high - low + run.settings.line_width;
            assert!((size - 20.0 - more).abs() < 0.02, "inset {inset}: {size}");
        }
    }
}

#[test]
fn the_last_layer_ends_within_half_a_layer_of_the_top_and_is_reported() {
    for tenths in 50..=62 {
        let height = f64::from(tenths) / 10.0;
        let run = printed(&Solid::cuboid([0.0; 3], [8.0, 8.0, height]), &[]);
        let top = run.print.layers.last().unwrap().z;
        assert!((top - height).abs() <= 0.5 + 1e-9, "{height}: {top}");
        assert!((run.report.layers.top_mm - top).abs() < 1e-9);
    }
}

#[test]
fn a_part_that_is_too_small_is_refused() {
    let refused = |size: [f64; 3], set: &[(&str, &str)]| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.stl");
        std::fs::write(&path, Solid::cuboid([0.0; 3], size).stl()).unwrap();
        slice_file(&path, &shipped("narino", set), &as_it_is()).err()
    };
    for size in [[4.9, 20.0, 20.0], [20.0, 4.9, 20.0], [20.0, 20.0, 4.9]] {
        match refused(size, &[]) {
            Some(Error::Refused(Refusal::TooSmall { size_mm, least_mm, .. })) => {
                assert!((size_mm.iter().copied().fold(99.0, f64::min) - 4.9).abs() < 1e-3);
                assert_eq!(least_mm, 5.0);
            }
            other => panic!("{size:?}: {other:?}"),
        }
        assert!(refused(size, &[("machine.min_part_size", "0")]).is_none());
    }
    assert!(refused([5.0; 3], &[]).is_none());
}

/// What `check` finds in a file of `settings`, with the part or without.
fn found(text: &str, settings: &Settings) -> BTreeSet<Code> {
    let print = reader::Print::read(&mut text.as_bytes(), settings.filament.diameter).unwrap();
    let terms = Terms::new(Some(settings), Some(settings), &print);
    let none: Option<Model<'_>> = None;
    check(&print, &terms, none).findings.iter().map(|finding| finding.code).collect()
}

/// The file with the plastic of the `n`th line of this kind on layer `layer` so many times as much; E counts
/// from move to move.
fn changed(text: &str, layer: usize, kind: &str, n: usize, times: f64) -> String {
    let (mut at, mut of_kind, mut seen) = (0, false, 0);
    let change = |line: &str| {
        if line.starts_with(";LAYER_CHANGE") {
            at += 1;
        } else if let Some(now) = line.strip_prefix(";TYPE:") {
            of_kind = now == kind;
        }
        let Some((way, e)) = line.split_once(" E").filter(|_| at == layer && of_kind) else {
            return format!("{line}\n");
        };
        seen += 1;
        let (e, rest) = e.split_once(' ').unwrap_or((e, ""));
        let e: f64 = e.parse::<f64>().unwrap() * if seen == n { times } else { 1.0 };
        format!("{way} E{e:.5} {rest}\n")
    };
    text.lines().map(change).collect()
}

#[test]
fn check_takes_strands_for_what_they_are_and_still_finds_faults() {
    let relative = ("machine.relative_e", "true");
    let solid = angle(8.0);
    let run = printed(&solid, &[relative]);
    assert_eq!(found(&run.text, &run.settings), BTreeSet::new());
    for layer in [1, 3] {
        for (kind, times) in
            [("Internal infill", 2.0), ("Internal infill", 0.4), ("External perimeter", 2.0)]
        {
            let damaged = changed(&run.text, layer, kind, 3, times);
            let codes = found(&damaged, &run.settings);
            assert!(codes.contains(&Code::OddBead), "layer {layer}, {times} x {kind}: {codes:?}");
        }
    }
    // A file of boxes is no file of strands: all of it has 27 % too much.
    let boxes = printed(&solid, &[relative, ("extrusion.model", "area")]);
    assert!(!found(&boxes.text, &run.settings).is_empty());
}

#[test]
fn a_round_section_takes_the_same_part_of_every_line() {
    let set = [
        ("support.enabled", "true"),
        ("skirt.loops", "2"),
        ("ironing.where", "top"),
        ("dual.mode", "pair"),
    ];
    let [area, round] = ["area", "round"].map(|model| {
        let set = [&set[..], &[("extrusion.model", model)]].concat();
        slice_with(&fixture("overhang.stl"), shipped("generic-marlin", &set), &as_it_is())
    });
    assert_eq!(area.report.roles.len(), round.report.roles.len());
    let mut roles = 0;
    for (a, b) in area.report.roles.iter().zip(&round.report.roles) {
        assert_eq!((&a.role, a.length_mm), (&b.role, b.length_mm));
        if a.filament_mm > 0.0 {
            let share = b.filament_mm / a.filament_mm;
            assert!((share - PI / 4.0).abs() < 1e-9, "{}: {share}", a.role);
            roles += 1;
        }
    }
    assert!(roles >= 6, "{roles}");
    assert_eq!(found(&round.text, &round.settings), found(&area.text, &area.settings));
}
