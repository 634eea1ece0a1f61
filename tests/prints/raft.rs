//! Solids -> prints on a raft: what is laid, and that the part above it prints as on the bed.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::section::distance;
use crate::common::solid::{circle, star};
use crate::common::{
    Kind, Move, Run, Section, Solid, as_it_is, checks, damage, fixture, shipped, slice_file,
    slice_shipped, slice_with,
};
use slicer::check::finding::Code;
use slicer::mesh::Placement;

/// Slack of lengths, mm: coordinates are written in thousandths, contours simplified by a hundredth.
const SLACK: f64 = 0.025;

const ON: (&str, &str) = ("raft.enabled", "true");

/// What cooling does to a layer depends on those beside it.
const UNCOOLED: (&str, &str) = ("cooling.min_layer_time", "0");

/// Layers of a raft where nobody asks for another number.
const LAYERS: usize = 3;

/// What lifts the part then, mm: base, two layers, and the gap.
const LIFT: f64 = 0.3 + 2.0 * 0.2 + 0.2;

/// The lines of a layer.
fn lines(run: &Run, layer: usize) -> Vec<Move> {
    run.print.beads().filter(|step| step.layer == Some(layer)).copied().collect()
}

/// The least distance from a place to lines.
fn nearest(at: [f64; 2], lines: &[Move]) -> f64 {
    lines.iter().map(|step| distance(at, step.a(), step.b())).fold(f64::INFINITY, f64::min)
}

/// The ways of the nozzle from where it begins to print on a layer. The shortest lines may have no
/// filament of their own, by the rounding of its sum.
fn ways_of(run: &Run, layer: usize) -> Vec<Move> {
    let of_layers = |m: &&Move| m.layer >= Some(layer) && m.kind != Kind::Custom;
    let moves = run.print.moves.iter().filter(of_layers).filter(|m| m.length() > 0.0);
    moves.skip_while(|m| !m.is_bead()).copied().collect()
}

/// Share of the length of lines that runs along x, and along y.
fn ways(lines: &[Move]) -> [f64; 2] {
    let all: f64 = lines.iter().map(Move::length).sum();
    let along = |axis: usize| {
        let across = |step: &&Move| (step.to[1 - axis] - step.from[1 - axis]).abs() < 1e-3;
        lines.iter().filter(across).map(Move::length).sum::<f64>() / all
    };
    [along(0), along(1)]
}

/// The part's outline near the bed, where it lies.
fn foot(run: &Run, solid: &Solid) -> Section {
    Section::new(&solid.on_bed(run.middle()), 0.1)
}

/// Settings of a case.
type Set<'a> = &'a [(&'a str, &'a str)];

/// The law of the raft: what is printed above it is what is printed without it, moved up.
#[test]
fn the_part_prints_above_a_raft_as_it_does_on_the_bed() {
    let dual = ("dual.mode", "pair");
    let support = ("support.enabled", "true");
    let cases: [(&str, &str, Set<'_>); 6] = [
        ("bracket.stl", "generic-marlin", &[dual]),
        ("bracket.stl", "zcube-dual", &[dual, ("dual.ratio", "2"), ("seam", "nearest")]),
        ("cavity.stl", "generic-klipper", &[("seam", "aligned"), ("first_layer_height", "0.3")]),
        ("cavity.stl", "generic-marlin", &[dual, ("layer_height", "0.1"), ("dual.ratio", "3")]),
        ("overhang.stl", "generic-marlin", &[support]),
        ("overhang.stl", "prusa-mk3s", &[dual, support, ("dual.parts", "infill,support")]),
    ];
    for (stl, profile, set) in cases {
        let what = format!("{stl} {profile} {set:?}");
        let plain = [&[UNCOOLED, ("brim.where", "off"), ("elephant_foot", "0")], set].concat();
        let below = slice_shipped(&fixture(stl), profile, &plain);
        let above = slice_shipped(&fixture(stl), profile, &[&[ON], plain.as_slice()].concat());
        let on_bed = ways_of(&below, 0);
        let on_raft = ways_of(&above, LAYERS);
        assert_eq!(on_raft.len(), on_bed.len(), "{what}");
        for (raft, bed) in on_raft.iter().zip(&on_bed) {
            assert_eq!((raft.a(), raft.b()), (bed.a(), bed.b()), "{what}");
            assert_eq!(raft.layer.map(|k| k - LAYERS), bed.layer, "{what}");
            assert_eq!(raft.feed, bed.feed, "{what}: {raft:?}");
            assert!((raft.e - bed.e).abs() < 4e-5 || bed.kind.is_support(), "{what}: {raft:?}");
            if !raft.is_bead() || !bed.is_bead() {
                continue;
            }
            assert_eq!((raft.kind, raft.width), (bed.kind, bed.width), "{what}: {raft:?}");
            assert!((raft.to[2] - bed.to[2] - LIFT).abs() < 1e-6, "{what}: {raft:?} {bed:?}");
            // Support is printed down to the raft.
            let stands = bed.kind.is_support() && bed.layer == Some(0);
            let higher = if stands { 0.2 } else { 0.0 };
            assert!((raft.height - bed.height - higher).abs() < 1e-6, "{what}: {raft:?}");
            let more = raft.e * bed.height / raft.height - bed.e;
            assert!(more.abs() < 4e-5, "{what}: {more} mm more: {raft:?}");
        }
        let layers = |run: &Run| run.text.matches(";LAYER_CHANGE\n").count();
        assert_eq!(layers(&above), layers(&below) + LAYERS, "{what}");
        let report = &above.report;
        assert_eq!(report.layers.count, layers(&above), "{what}");
        assert_eq!(report.time.layers.len(), layers(&above), "{what}");
        assert!((report.layers.top_mm - below.report.layers.top_mm - LIFT).abs() < 1e-6, "{what}");
        if let (Some(raft), Some(bed)) = (&report.dual, &below.report.dual) {
            assert_eq!(raft.thick_length_mm, bed.thick_length_mm, "{what}");
            assert_eq!(raft.audit[0].first_layer, bed.audit[0].first_layer + LAYERS, "{what}");
        }
    }
}

#[test]
fn a_raft_covers_foot_and_margin_and_no_more() {
    let radii = [20.0, 13.0, 18.0, 14.0, 20.0, 16.0, 13.0, 17.0];
    for (solid, margin) in [
        (Solid::prism(&star(&radii), 0.0, 2.0), 3.0),
        (Solid::prism(&circle(9.0, 50), 0.0, 2.0), 5.5),
        (Solid::cuboid([0.0; 3], [14.0, 6.0, 2.0]), 0.0),
    ] {
        let text = margin.to_string();
        let set = [ON, ("raft.margin", text.as_str())];
        let run = slice_shipped(&solid.stl(), "generic-marlin", &set);
        let (foot, raft) = (foot(&run, &solid), &run.settings.raft);
        let reach = f64::max(margin, raft.base_width);
        for layer in 0..LAYERS {
            let lines = lines(&run, layer);
            let out = |step: &Move| {
                let ends = [step.a(), step.b()].map(|at| foot.signed_distance(at, 99.0));
                ends[0].max(ends[1]) + step.width / 2.0
            };
            let furthest = lines.iter().map(out).fold(0.0, f64::max);
            assert!(furthest > reach - SLACK, "layer {layer}: {furthest} of {reach}");
            // Corners are pointed up to twice as far, bays are closed.
            assert!(furthest < 2.0 * reach, "layer {layer}: {furthest} of {reach}");
            // What lies under the part and its margin is closed, or holds the next layer up.
            let gap = if layer == 0 { raft.base_spacing + raft.base_width } else { 0.4 };
            let (low, high) = foot.extent().unwrap();
            let count = |axis: usize| ((high[axis] - low[axis]) / 0.7) as usize + 1;
            for (i, j) in (0..count(0)).flat_map(|i| (0..count(1)).map(move |j| (i, j))) {
                let at = [low[0] + 0.7 * i as f64, low[1] + 0.7 * j as f64];
                if foot.signed_distance(at, 99.0) < reach - 0.4 {
                    let near = nearest(at, &lines);
                    assert!(near < 0.8 * gap, "layer {layer}: {near} mm from a line at {at:?}");
                }
            }
        }
    }
}

#[test]
fn holes_are_closed_where_they_are_narrow() {
    let ring = |inner: f64| {
        let hole = Solid::cylinder(inner, 2.0, 64).inside_out();
        Solid::cylinder(inner + 6.0, 2.0, 64).and(&hole)
    };
    for (inner, closed) in [(2.0, true), (5.5, true), (7.0, false), (20.0, false)] {
        let run = slice_shipped(&ring(inner).stl(), "generic-marlin", &[ON]);
        let near = nearest(run.middle(), &lines(&run, LAYERS - 1));
        assert_eq!(near < 0.3, closed, "{inner}: {near} mm");
    }
}

#[test]
fn layers_of_a_raft_cross_and_the_gap_is_as_asked() {
    let part = Solid::cuboid([0.0; 3], [30.0, 20.0, 2.0]);
    for (layers, gap) in [(1, 0.0), (2, 0.1), (3, 0.35)] {
        let (count, gap_text) = (layers.to_string(), gap.to_string());
        let set = [
            ON,
            ("angle", "0"),
            ("raft.interface_layers", &count),
            ("raft.gap", &gap_text),
            ("raft.base_height", "0.35"),
            ("raft.base_width", "0.9"),
            ("raft.interface_height", "0.25"),
            ("speed.raft_base", "12"),
            ("speed.raft_interface", "33"),
        ];
        let run = slice_shipped(&part.stl(), "generic-marlin", &set);
        let top = 0.35 + 0.25 * layers as f64;
        for layer in 0..=layers {
            let lines = lines(&run, layer);
            let z = 0.35 + 0.25 * layer as f64;
            let base = layer == 0;
            let size = if base { [0.35, 0.9, 12.0] } else { [0.25, 0.4, 33.0] };
            for step in &lines {
                assert_eq!([step.height, step.width, step.feed / 60.0], size, "{step:?}");
                assert!((step.to[2] - z).abs() < 1e-6, "{step:?}");
                assert!(step.kind == if base { Kind::Support } else { Kind::SupportInterface });
            }
            // The part's bottom runs along x, and the last layer below it along y.
            let along = ways(&lines)[(layers - layer + 1) % 2];
            assert!(along > 0.8, "layer {layer} of {layers}: {along}");
        }
        let first = lines(&run, layers + 1);
        let bottom = first[0].to[2] - first[0].height;
        assert!((bottom - top - gap).abs() < 1e-6, "{bottom} above {top}");
        let skin: Vec<Move> = first.into_iter().filter(|step| step.kind == Kind::Skin).collect();
        assert!(ways(&skin)[0] > 0.8);
        let raft = run.report.raft.unwrap();
        assert_eq!((raft.layers, raft.plates), (layers + 1, 1));
        assert!((raft.height_mm - top).abs() < 1e-6 && (raft.gap_mm - gap).abs() < 1e-6);
    }
}

/// What the first layer has of its own goes to the bed, but for its speed.
#[test]
fn first_layer_rules_hold_on_the_bed() {
    let part = Solid::cuboid([-10.0, -10.0, 0.0], [10.0, 10.0, 3.0]);
    let set = [
        ON,
        UNCOOLED,
        ("elephant_foot", "0.4"),
        ("extrusion.first_layer", "120"),
        ("filament.first_layer_temperature", "240"),
        ("filament.temperature", "220"),
        ("cooling.interface_fan", "60"),
        ("filament.fan", "100"),
    ];
    let run = slice_shipped(&part.stl(), "generic-marlin", &set);
    let plain = slice_shipped(&part.stl(), "generic-marlin", &[ON, UNCOOLED]);
    let pushed = |run: &Run, layer: usize| lines(run, layer).iter().map(|step| step.e).sum::<f64>();
    for layer in 0..6 {
        let share = pushed(&run, layer) / pushed(&plain, layer);
        let expected = if layer == 0 { 1.2 } else { 1.0 };
        assert!((share - expected).abs() < 1e-3, "layer {layer}: {share}");
    }
    // Nothing is drawn in.
    let wall = lines(&run, LAYERS).into_iter().filter(|step| step.kind == Kind::OuterWall);
    let out = wall.map(|step| (step.b()[0] - run.middle()[0]).abs()).fold(0.0, f64::max);
    assert!((out - 9.8).abs() < 0.003, "{out}");
    let layers: Vec<&str> = run.text.split(";LAYER_CHANGE\n").skip(1).collect();
    let with = |words: &str| -> Vec<usize> {
        (0..layers.len()).filter(|&k| layers[k].lines().any(|line| line == words)).collect()
    };
    assert_eq!(with("M104 S220"), [1]);
    // 60 % on the part's first layer alone, and all of it from the next on.
    assert_eq!(with("M106 S153"), [LAYERS]);
    assert_eq!(with("M106 S255"), [LAYERS + 1]);
    // Half as fast as elsewhere, on the raft too; the base at its own speed, but never above the limit.
    let feeds = |run: &Run, layer: usize, kind: Kind| -> Vec<f64> {
        let of = lines(run, layer).into_iter().filter(|step| step.kind == kind);
        let mut feeds: Vec<f64> = of.map(|step| step.feed / 60.0).collect();
        feeds.dedup();
        feeds
    };
    assert_eq!(feeds(&run, 0, Kind::Support), [15.0]);
    assert_eq!(feeds(&run, LAYERS, Kind::Skin), [25.0]);
    assert_eq!(feeds(&run, LAYERS + 1, Kind::Skin), [50.0]);
    let set = [ON, UNCOOLED, ("speed.raft_base", "80"), ("speed.first_layer_max", "20")];
    let slow = slice_shipped(&part.stl(), "generic-marlin", &set);
    assert_eq!(feeds(&slow, 0, Kind::Support), [20.0]);
    assert_eq!(feeds(&slow, LAYERS, Kind::Skin), [20.0]);
}

#[test]
fn a_skirt_runs_around_the_raft() {
    let part = Solid::cuboid([0.0; 3], [20.0, 10.0, 3.0]);
    let set = [ON, ("skirt.loops", "1"), ("skirt.distance", "4"), ("skirt.layers", "5")];
    let run = slice_shipped(&part.stl(), "generic-marlin", &set);
    let foot = foot(&run, &part);
    for layer in 0..8 {
        let lines: Vec<Move> =
            lines(&run, layer).into_iter().filter(|step| step.kind == Kind::Brim).collect();
        assert_eq!(lines.is_empty(), layer >= 5, "layer {layer}");
        for step in lines {
            let away = foot.signed_distance(step.at(0.5), 99.0);
            assert!((away - 3.0 - 4.0 - 0.2).abs() < SLACK, "layer {layer}: {away}");
            // It stands on itself: the gap above the raft is closed.
            let below = if layer == 0 { 0.0 } else { run.print.layers[layer - 1].z };
            assert!((step.to[2] - step.height - below).abs() < 1e-6, "{step:?}");
        }
    }
}

#[test]
fn copies_keep_a_raft_each() {
    let part = Solid::cuboid([0.0; 3], [12.0, 8.0, 2.0]);
    let placement = Placement { copies: 5, ..as_it_is() };
    let run = slice_with(&part.stl(), shipped("generic-marlin", &[ON]), &placement);
    assert_eq!(run.report.raft.as_ref().unwrap().plates, 5);
    checks::stays_on_the_bed(&run.print, &run.settings, "five");
    // A part of two pieces near to each other has one.
    let two = Solid::cuboid([0.0; 3], [10.0, 10.0, 3.0])
        .and(&Solid::cuboid([14.0, 0.0, 0.0], [24.0, 10.0, 3.0]));
    let run = slice_shipped(&two.stl(), "generic-marlin", &[ON]);
    assert_eq!(run.report.raft.unwrap().plates, 1);
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.stl");
    let refused = |solid: &Solid, profile: &str, set: &[(&str, &str)], at: Option<[f64; 2]>| {
        std::fs::write(&path, solid.stl()).unwrap();
        let placement = Placement { at, ..as_it_is() };
        let error = slice_file(&path, &shipped(profile, set), &placement).unwrap_err();
        assert_eq!(error.exit_code(), 3);
        error.to_string()
    };
    let cube = Solid::cuboid([0.0; 3], [20.0; 3]);
    let text = refused(&cube, "generic-marlin", &[ON], Some([12.0, 150.0]));
    assert!(text.contains("the raft would reach 1 mm at the left beyond the bed"), "{text}");
    assert!(text.contains("raft.margin"), "{text}");
    // A raft does not fit above the machine.
    let tall = Solid::cuboid([0.0; 3], [20.0, 20.0, 10.0]);
    let low = [("machine.bed_height", "10.5")];
    std::fs::write(&path, tall.stl()).unwrap();
    assert!(slice_file(&path, &shipped("generic-marlin", &low), &as_it_is()).is_ok());
    let text = refused(&tall, "generic-marlin", &[ON, low[0]], None);
    assert!(text.contains("would end at 10.90 mm on 0.9 mm of raft"), "{text}");
    // The margin lies on what the start block primes, the part does not.
    let block = "G28\nM109 S{temperature}\nG1 X100 Y138 Z0.3 F3000\nG1 X200 Y138 E10 F600\n";
    let primes = [("machine.start_gcode", block), ("filament.bed_temperature", "0")];
    std::fs::write(&path, cube.stl()).unwrap();
    assert!(slice_file(&path, &shipped("generic-marlin", &primes), &as_it_is()).is_ok());
    let text = refused(&cube, "generic-marlin", &[&[ON], &primes[..]].concat(), None);
    assert!(text.contains("start block"), "{text}");
    // Heights that no nozzle prints.
    let over = |(key, value): (&str, &str)| slicer::profile::Override {
        key: key.to_owned(),
        value: value.to_owned(),
        origin: slicer::profile::ValueOrigin::Set,
    };
    let wrong = |set: (&str, &str)| {
        let load = |set: &[(&str, &str)]| {
            let all: Vec<_> = set.iter().map(|one| over(*one)).collect();
            slicer::profile::load(["generic-marlin"], &all)
        };
        assert!(load(&[set]).is_ok());
        load(&[ON, set]).unwrap_err().to_string()
    };
    assert!(wrong(("raft.base_height", "0.5")).contains("machine.nozzle_diameter"));
    assert!(wrong(("raft.base_width", "0.2")).contains("raft.base_width = 0.2 mm is too little"));
    let support = [over(ON), over(("support.enabled", "true")), over(("raft.gap", "0.35"))];
    let error = slicer::profile::load(["generic-marlin"], &support).unwrap_err().to_string();
    assert!(error.contains("would have to be 0.55 mm high"), "{error}");
    assert!(wrong(("raft.base_width", "1.2")).contains("2.5 times machine.nozzle_diameter"));
}

#[test]
fn a_print_on_a_raft_is_found_clean_and_a_raft_that_is_missing_is_not() {
    let sets: [(&str, Set<'_>); 5] = [
        ("bracket.stl", &[ON, ("dual.mode", "pair")]),
        ("cavity.stl", &[ON, ("elephant_foot", "0.3"), ("skirt.loops", "2")]),
        ("overhang.stl", &[ON, ("support.enabled", "true"), ("dual.mode", "pair")]),
        ("sphere_20.stl", &[ON, ("support.enabled", "true")]),
        ("tile.stl", &[ON, ("raft.gap", "0.5"), ("raft.interface_spacing", "0.2")]),
    ];
    for (stl, set) in sets {
        let run = slice_shipped(&fixture(stl), "generic-marlin", set);
        let verdict = damage::judge(&run.text, stl, &as_it_is());
        assert!(damage::errors(&verdict).next().is_none(), "{set:?}: {}", damage::listed(&verdict));
        let outline = verdict.measures.outline.unwrap();
        assert!(outline > 0.999, "{stl}: {outline}");
    }
    // What is cut off at the bed, or too thin to be printed there, is not looked for beside the raft.
    let sunk = Placement { sink: 5.0, ..as_it_is() };
    let tipped = Placement { rotate: [45.0, 35.0, 0.0], ..as_it_is() };
    for (placement, more) in [(sunk, ("dual.mode", "pair")), (tipped, ("support.enabled", "true"))]
    {
        let set = [ON, more];
        let run = slice_with(&fixture("cube_20.stl"), shipped("generic-marlin", &set), &placement);
        let verdict = damage::judge(&run.text, "cube_20.stl", &placement);
        assert!(
            damage::errors(&verdict).next().is_none(),
            "{more:?}: {}",
            damage::listed(&verdict)
        );
        let outline = verdict.measures.outline.unwrap();
        assert!(outline > 0.999, "{more:?}: {outline}");
    }
    let good = damage::Good::of("cube_20.stl", "generic-marlin", &[ON]);
    let without = |layers: std::ops::Range<usize>| {
        let text = good.with(|step| {
            let is_raft = step.kind.is_support() && step.layer.is_some_and(|k| layers.contains(&k));
            if is_raft && step.is_bead() {
                step.e = 0.0;
            }
            true
        });
        damage::kinds(&good.judge(&text))
    };
    assert!(damage::kinds(&good.judge(&good.text)).is_empty());
    assert!(without(0..1).contains(&Code::Floating) || without(0..1).contains(&Code::InTheAir));
    assert!(without(1..3).contains(&Code::Floating) || without(1..3).contains(&Code::InTheAir));
}

#[test]
fn what_a_raft_makes_void_is_said() {
    let set =
        [ON, ("elephant_foot", "0.3"), ("first_layer_width", "0.6"), ("brim.where", "outside")];
    let said = |set: &[(&str, &str)]| -> Vec<String> {
        let run = slice_shipped(&fixture("tile.stl"), "generic-marlin", set);
        run.report.warnings.iter().map(ToString::to_string).collect()
    };
    let why = "have no effect: the part stands on a raft, and not on the bed";
    assert_eq!(said(&set), [format!("brim.where, first_layer_width, elephant_foot {why}")]);
    assert!(said(&set[1..]).is_empty() && said(&[ON]).is_empty());
}

#[test]
fn a_raft_that_is_off_changes_no_move() {
    let moves = |set: &[(&str, &str)]| {
        let text = slice_shipped(&fixture("bracket.stl"), "generic-marlin", set).text;
        text.split("; printer_model").next().unwrap().to_owned()
    };
    let set = [("raft.margin", "9"), ("raft.gap", "0.4"), ("speed.raft_base", "3")];
    assert_eq!(moves(&set), moves(&[]));
    // With one, nothing else holds the part on the bed.
    let tower = Solid::cuboid([0.0; 3], [5.0, 5.0, 40.0]);
    for set in [vec![ON], vec![ON, ("brim.where", "outside")]] {
        let run = slice_shipped(&tower.stl(), "generic-marlin", &set);
        assert!(run.print.of(Kind::Brim).next().is_none() && run.report.brim.is_none());
    }
}
