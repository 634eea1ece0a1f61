//! Solids -> prints with skirt and brim, on a first layer of its own: judged on the G-code read back.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::section::distance;
use crate::common::solid::{Outline, circle, rectangle, star};
use crate::common::{
    Kind, Move, Run, Section, Solid, as_it_is, checks, damage, shipped, slice_shipped, slice_with,
};
use proptest::prelude::*;
use slicer::mesh::Placement;

/// Slack of lengths, mm: coordinates are written in thousandths, contours simplified by a hundredth.
const SLACK: f64 = 0.025;

/// Off, so that only what a test asks for is printed.
const NO_BRIM: (&str, &str) = ("brim.where", "off");

/// The lines of a kind on the first layer.
fn first(run: &Run, kind: Kind) -> Vec<Vec<Move>> {
    let chains = run.print.chains(kind);
    chains.into_iter().filter(|chain| chain[0].layer == Some(0)).collect()
}

/// Places along lines, each with the number of its line.
fn places(chains: &[Vec<Move>]) -> Vec<(usize, [f64; 2])> {
    let of = |(k, chain): (usize, &Vec<Move>)| {
        let steps = chain.iter().flat_map(|step| {
            let count = (step.length() / 0.3).ceil().max(1.0) as usize;
            (0..=count).map(move |i| step.at(i as f64 / count as f64))
        });
        steps.map(|at| (k, at)).collect::<Vec<_>>()
    };
    chains.iter().enumerate().flat_map(of).collect()
}

/// The least distance from a place to lines.
fn nearest<'a>(at: [f64; 2], lines: impl Iterator<Item = &'a Move>) -> f64 {
    lines.map(|step| distance(at, step.a(), step.b())).fold(f64::INFINITY, f64::min)
}

/// Checks that no line of a brim lies on another one.
fn apart(chains: &[Vec<Move>], width: f64) {
    for (k, at) in places(chains) {
        let others = chains.iter().enumerate().filter(|(other, _)| *other != k);
        let near = nearest(at, others.flat_map(|(_, chain)| chain));
        assert!(near > width - SLACK, "lines {near} mm apart at {at:?}");
    }
}

/// The length of lines, in thousandths.
fn length(chains: &[Vec<Move>]) -> i64 {
    (chains.iter().flatten().map(Move::length).sum::<f64>() * 1000.0).round() as i64
}

/// The part's outline on the first layer, where it lies on the bed.
fn section(run: &Run, solid: &Solid) -> Section {
    checks::section(&run.print, &solid.on_bed(run.middle()), 0)
}

/// Outlines around the origin: none has pockets narrower than two brims.
fn outlines() -> impl Strategy<Value = Outline> {
    prop_oneof![
        (4.0..30.0_f64, 4.0..30.0_f64).prop_map(|(x, y)| rectangle([-x, -y], [x, y])),
        (2.0..20.0_f64, 3..60_usize).prop_map(|(radius, corners)| circle(radius, corners)),
        prop::collection::vec(12.0..20.0_f64, 8..14).prop_map(|radii| star(&radii)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn a_brim_keeps_its_distance_covers_its_width_and_lies_on_nothing(
        outline in outlines(), width in 0.5..8.0_f64, gap in prop_oneof![Just(0.0), 0.05..0.5_f64],
    ) {
        let solid = Solid::prism(&outline, 0.0, 1.0);
        let (width_text, gap_text) = (width.to_string(), gap.to_string());
        let set = [("brim.where", "outside"), ("brim.width", &width_text), ("brim.gap", &gap_text)];
        let run = slice_shipped(&solid.stl(), "generic-marlin", &set);
        let (line, section) = (run.settings.line_width, section(&run, &solid));
        let chains = first(&run, Kind::Brim);
        let lines = (width / line).round();
        let reach = gap + lines * line;
        apart(&chains, line);
        for (_, at) in places(&chains) {
            let away = section.signed_distance(at, 100.0);
            prop_assert!(away > gap + line / 2.0 - SLACK, "{away} mm from the part at {at:?}");
            // Corners are pointed up to twice as far.
            prop_assert!(away < 2.0 * reach, "{away} of {reach} at {at:?}");
        }
        // All around lies under some line.
        let (low, high) = section.extent().unwrap();
        let count = |axis: usize| ((high[axis] - low[axis] + 2.0 * reach) / 0.7) as usize + 1;
        for (i, j) in (0..count(0)).flat_map(|i| (0..count(1)).map(move |j| (i, j))) {
            let at = [low[0] - reach + 0.7 * i as f64, low[1] - reach + 0.7 * j as f64];
            let away = section.signed_distance(at, 100.0);
            if away > gap && away < reach {
                let near = nearest(at, chains.iter().flatten());
                // Pointed corners of neighbouring lines leave a little between them.
                prop_assert!(near < 0.75 * line + SLACK, "{near} mm from a line at {at:?}");
            }
        }
    }

    #[test]
    fn a_brim_inside_fills_holes_and_no_more(
        radius in 1.0..12.0_f64, width in 1.0..8.0_f64, both in any::<bool>(),
    ) {
        let solid = ring(radius + 4.0, radius, 1.0);
        let width_text = width.to_string();
        let place = if both { "both" } else { "inside" };
        let set = [("brim.where", place), ("brim.width", width_text.as_str())];
        let run = slice_shipped(&solid.stl(), "generic-marlin", &set);
        let (line, section, middle) = (run.settings.line_width, section(&run, &solid), run.middle());
        let chains = first(&run, Kind::Brim);
        apart(&chains, line);
        let out = |at: [f64; 2]| (at[0] - middle[0]).hypot(at[1] - middle[1]);
        let all = places(&chains);
        prop_assert!(all.iter().any(|(_, at)| out(*at) < radius));
        prop_assert_eq!(all.iter().any(|(_, at)| out(*at) > radius), both);
        prop_assert!(all.iter().all(|(_, at)| section.signed_distance(*at, 99.0) > line / 2.0 - SLACK));
        let lines = (width / line).round();
        for k in 0..40 {
            let away = f64::from(k) / 40.0 * lines * line;
            // A hole's middle, less than a loop wide, stays open.
            if radius - away > 2.0 * line {
                let at = [middle[0] + radius - away, middle[1]];
                prop_assert!(nearest(at, chains.iter().flatten()) < 0.6 * line + SLACK);
            }
        }
    }
}

/// A ring that stands on the bed.
fn ring(outer: f64, inner: f64, height: f64) -> Solid {
    let hole = Solid::cylinder(inner, height, 64).inside_out();
    Solid::cylinder(outer, height, 64).and(&hole)
}

#[test]
fn copies_with_a_brim_have_room_for_it() {
    let part = Solid::cuboid([0.0; 3], [12.0, 8.0, 2.0]);
    let placement = Placement { copies: 5, ..as_it_is() };
    let set = [("brim.where", "outside"), ("brim.width", "8")];
    let run = slice_with(&part.stl(), shipped("generic-marlin", &set), &placement);
    let chains = first(&run, Kind::Brim);
    // 20 lines around each, none of which goes around two.
    assert_eq!(chains.len(), 5 * 20);
    apart(&chains, run.settings.line_width);
    // One part after the other, each from outside inwards.
    let round = |chain: &Vec<Move>| chain.iter().map(Move::length).sum::<f64>();
    let lengths: Vec<f64> = chains.iter().map(round).collect();
    let falls = lengths.windows(2).filter(|two| two[0] > two[1]).count();
    assert_eq!(falls, 5 * 19, "{lengths:?}");
    assert_eq!(run.print.beads().next().unwrap().kind, Kind::Brim);
}

#[test]
fn brims_that_meet_grow_together() {
    let tower = Solid::cuboid([0.0; 3], [5.0, 5.0, 60.0]);
    let placement = Placement { copies: 4, ..as_it_is() };
    let run = slice_with(&tower.stl(), shipped("generic-marlin", &[]), &placement);
    let chains = first(&run, Kind::Brim);
    apart(&chains, run.settings.line_width);
    assert!(chains.len() < 4 * 12, "{} lines", chains.len());
}

#[test]
fn support_keeps_off_a_brim_and_a_brim_off_what_has_none() {
    let hat = Solid::cuboid([-3.0, -3.0, 0.0], [3.0, 3.0, 10.1])
        .and(&Solid::cuboid([-12.0, -12.0, 10.0], [12.0, 12.0, 12.0]));
    for set in [vec![], vec![("support.interface_layers", "0")], vec![("support.outline", "false")]]
    {
        let mut set = [
            vec![("support.enabled", "true"), ("brim.where", "outside"), ("brim.width", "4")],
            set,
        ]
        .concat();
        let run = slice_shipped(&hat.stl(), "generic-marlin", &set);
        let brim = first(&run, Kind::Brim);
        let support =
            [Kind::Support, Kind::SupportInterface].map(|kind| first(&run, kind)).concat();
        assert!(!support.is_empty(), "{set:?}");
        // The foot is what needs to be held: support gives way to all of its brim.
        set[0] = ("support.enabled", "false");
        set.push(("floating", "warn"));
        assert_eq!(
            length(&brim),
            length(&first(&slice_shipped(&hat.stl(), "generic-marlin", &set), Kind::Brim))
        );
        for (_, at) in places(&brim) {
            let near = nearest(at, support.iter().flatten());
            assert!(near > run.settings.line_width - SLACK, "{set:?}: {near} mm at {at:?}");
        }
    }
    // A tower with a brim of its own beside a plate without.
    let both = Solid::cuboid([0.0; 3], [5.0, 5.0, 40.0])
        .and(&Solid::cuboid([7.0, -20.0, 0.0], [60.0, 30.0, 2.0]));
    let run = slice_shipped(&both.stl(), "generic-marlin", &[]);
    let (brim, section) = (first(&run, Kind::Brim), section(&run, &both));
    assert!(!brim.is_empty());
    apart(&brim, run.settings.line_width);
    let line = run.settings.line_width;
    for (_, at) in places(&brim) {
        assert!(section.signed_distance(at, 99.0) > line / 2.0 - SLACK, "{at:?}");
    }
}

/// The reason for a brim, where nobody has decided.
fn why(solid: &Solid) -> Option<String> {
    let run = slice_shipped(&solid.stl(), "generic-marlin", &[("floating", "warn")]);
    let printed = !first(&run, Kind::Brim).is_empty();
    assert_eq!(run.report.brim.is_some(), printed);
    run.report.brim.map(|brim| brim.why.join(", "))
}

#[test]
fn a_brim_is_printed_where_the_foot_is_small_for_the_height_or_a_corner_is_sharp() {
    let cuboid = |x: f64, y: f64, z: f64| Solid::cuboid([0.0; 3], [x, y, z]);
    let legs = |thick: f64, height: f64| {
        let ring = |x: f64, y: f64, side: f64| rectangle([x, y], [x + side, y + side]);
        let corners = [(0.0, 0.0), (30.0, 0.0), (0.0, 30.0), (30.0, 30.0)];
        let leg = |(x, y): (f64, f64)| Solid::prism(&ring(x, y, thick), 0.0, height + 0.1);
        let top = Solid::cuboid([-1.0, -1.0, height], [41.0, 41.0, height + 3.0]);
        corners.into_iter().map(leg).fold(top, |all, one| all.and(&one))
    };
    let wedge = |half: f64, high: f64| {
        let tip = vec![[-40.0, 0.0], [0.0, -half], [0.0, half]];
        Solid::prism(&tip, 0.0, high)
    };
    let tall = "high on a small foot";
    for (what, solid, wanted) in [
        ("a cube", cuboid(20.0, 20.0, 20.0), None),
        ("a small cube", cuboid(10.0, 10.0, 10.0), None),
        ("a slim tower", cuboid(5.0, 5.0, 60.0), Some(tall)),
        ("a tower", cuboid(10.0, 10.0, 60.0), Some(tall)),
        ("a stout tower", cuboid(20.0, 20.0, 60.0), None),
        ("a big flat plate", cuboid(180.0, 180.0, 2.0), None),
        ("an upright board", cuboid(60.0, 2.0, 30.0), Some(tall)),
        ("a low board", cuboid(60.0, 2.0, 4.0), None),
        ("a ball", Solid::ball(12.0, 40), Some(tall)),
        ("a vase", ring(30.0, 29.0, 60.0), None),
        ("thin feet", legs(3.0, 20.0), Some(tall)),
        ("thick feet", legs(10.0, 20.0), None),
        ("a sharp corner", wedge(8.0, 20.0), Some("a sharp corner")),
        ("a low sharp corner", wedge(8.0, 4.0), None),
        ("a blunt corner", wedge(30.0, 20.0), None),
    ] {
        assert_eq!(why(&solid).as_deref(), wanted, "{what}");
    }
}

/// Feet of one surface with the table they carry.
#[test]
fn feet_stand_alone_until_they_grow_together() {
    // Of one surface: its faces are divided inside its outline, x and z.
    let arch = |foot: f64, rise: f64| {
        let (far, high) = (40.0 - foot, rise + 8.0);
        let corners = [
            [0.0, 0.0],
            [foot, 0.0],
            [foot, rise],
            [far, rise],
            [far, 0.0],
            [40.0, 0.0],
            [40.0, high],
            [0.0, high],
        ];
        let at = |k: usize, y: f64| [corners[k % 8][0], y, corners[k % 8][1]];
        let faces = [[0, 1, 2], [0, 2, 7], [2, 3, 7], [3, 6, 7], [3, 4, 5], [3, 5, 6]];
        let mut triangles = Vec::new();
        for [a, b, c] in faces {
            triangles.push([at(a, 0.0), at(b, 0.0), at(c, 0.0)]);
            triangles.push([at(a, 16.0), at(c, 16.0), at(b, 16.0)]);
        }
        for k in 0..8 {
            triangles.push([at(k, 0.0), at(k, 16.0), at(k + 1, 16.0)]);
            triangles.push([at(k, 0.0), at(k + 1, 16.0), at(k + 1, 0.0)]);
        }
        Solid { triangles }
    };
    assert_eq!(why(&arch(3.0, 10.0)).as_deref(), Some("a thin foot"));
    // As thin, but joined right above the bed.
    assert_eq!(why(&arch(3.0, 1.0)), None);
    // What stands inside letters that are cut into the bottom is thinner still.
    assert_eq!(why(&arch(1.0, 1.5)), None);
    assert_eq!(why(&arch(1.0, 3.0)).as_deref(), Some("a thin foot"));
    assert_eq!(why(&arch(10.0, 10.0)), None);
}

#[test]
fn what_does_not_fit_the_bed_is_refused_or_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.stl");
    std::fs::write(&path, Solid::cuboid([0.0; 3], [5.0, 5.0, 60.0]).stl()).unwrap();
    let corner = Placement { at: Some([4.0, 150.0]), ..as_it_is() };
    let run = |set: &[(&str, &str)]| {
        crate::common::slice_file(&path, &shipped("generic-marlin", set), &corner)
    };
    let refused = |set: &[(&str, &str)]| {
        let error = run(set).unwrap_err();
        assert_eq!(error.exit_code(), 3);
        error.to_string()
    };
    // The tower ends 1.5 mm from the bed's side.
    let text = refused(&[("brim.where", "outside")]);
    assert!(text.contains("the brim would reach 3.7 mm at the left beyond the bed"), "{text}");
    let text = refused(&[NO_BRIM, ("skirt.loops", "2")]);
    assert!(text.contains("the skirt would reach 5.3 mm at the left beyond the bed"), "{text}");
    assert!(run(&[("brim.where", "outside"), ("brim.width", "1.2")]).is_ok());
    let (text, report) = run(&[]).unwrap();
    assert!(!text.contains("Skirt/Brim") && report.brim.is_none());
    let warnings: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
    assert!(warnings.iter().any(|text| text.contains("a brim would reach beyond the bed")));
}

#[test]
fn a_skirt_runs_around_everything_at_its_distance() {
    let two = Solid::cuboid([0.0; 3], [10.0, 10.0, 3.0])
        .and(&Solid::cuboid([20.0, 5.0, 0.0], [30.0, 25.0, 3.0]));
    let set = [NO_BRIM, ("skirt.loops", "2"), ("skirt.distance", "3"), ("skirt.layers", "4")];
    let run = slice_shipped(&two.stl(), "generic-marlin", &set);
    let line = run.settings.line_width;
    let section = section(&run, &two);
    let all = run.print.chains(Kind::Brim);
    for layer in 0..15 {
        let here: Vec<Vec<Move>> =
            all.iter().filter(|chain| chain[0].layer == Some(layer)).cloned().collect();
        assert_eq!(here.len(), if layer < 4 { 2 } else { 0 }, "layer {layer}");
        apart(&here, line);
        let away = places(&here).into_iter().map(|(_, at)| section.signed_distance(at, 99.0));
        let least = away.fold(f64::INFINITY, f64::min);
        assert!(here.is_empty() || (least - 3.0 - line / 2.0).abs() < SLACK, "{least}");
    }
    let long = [NO_BRIM, ("skirt.loops", "1"), ("skirt.min_length", "900")];
    let run = slice_shipped(&two.stl(), "generic-marlin", &long);
    let lengths: Vec<f64> =
        first(&run, Kind::Brim).iter().map(|chain| chain.iter().map(Move::length).sum()).collect();
    let all: f64 = lengths.iter().sum();
    assert!(all >= 900.0 && all - lengths[0] < 900.0, "{lengths:?}");
}

/// Half the width of the outer walls of layer `k` that are nearer than `within` to the middle.
fn half_width(run: &Run, k: usize, within: f64) -> f64 {
    let middle = run.middle();
    let walls = run.print.of(Kind::OuterWall).filter(|step| step.layer == Some(k));
    let out = |step: &Move| (step.b()[0] - middle[0]).abs().max((step.b()[1] - middle[1]).abs());
    walls.map(out).filter(|out| *out < within).fold(0.0, f64::max)
}

#[test]
fn outlines_and_holes_are_moved_by_what_is_asked() {
    let frame = Solid::cuboid([-15.0, -15.0, 0.0], [15.0, 15.0, 3.0])
        .and(&Solid::cuboid([-5.0, -5.0, 0.0], [5.0, 5.0, 3.0]).inside_out());
    let plain = [NO_BRIM];
    let moved = |set: &[(&str, &str)], k: usize| {
        let run = slice_shipped(&frame.stl(), "generic-marlin", &[&plain, set].concat());
        // Walls lie half a line inside the part.
        [half_width(&run, k, 99.0) + 0.2, half_width(&run, k, 8.0) - 0.2]
    };
    let close = |found: [f64; 2], wanted: [f64; 2]| {
        assert!((0..2).all(|k| (found[k] - wanted[k]).abs() < 0.003), "{found:?}, not {wanted:?}");
    };
    for k in [0, 1, 9] {
        close(moved(&[], k), [15.0, 5.0]);
        close(moved(&[("xy_compensation", "0.15")], k), [15.15, 5.0]);
        close(moved(&[("xy_compensation", "-0.1")], k), [14.9, 5.0]);
        close(moved(&[("hole_compensation", "0.12")], k), [15.0, 5.12]);
        let both = [("xy_compensation", "-0.1"), ("hole_compensation", "0.1")];
        close(moved(&both, k), [14.9, 5.1]);
    }
    // Layers of 0.2 mm: drawn in by as much less as they lie higher.
    for (k, foot) in [(0, 0.5), (1, 0.3), (2, 0.1), (3, 0.0), (4, 0.0)] {
        close(moved(&[("elephant_foot", "0.5")], k), [15.0 - foot, 5.0 + foot]);
    }
}

#[test]
fn what_compensation_and_brim_make_is_found_clean() {
    let settings: [&[(&str, &str)]; 4] = [
        &[("brim.where", "both"), ("skirt.loops", "2"), ("skirt.layers", "3")],
        &[("elephant_foot", "0.4")],
        &[("xy_compensation", "-0.3"), ("hole_compensation", "0.2")],
        &[("extrusion.first_layer", "110"), ("brim.where", "outside"), ("support.enabled", "true")],
    ];
    for set in settings {
        let run = slice_shipped(&crate::common::fixture("bracket.stl"), "generic-marlin", set);
        let verdict = damage::judge(&run.text, "bracket.stl", &as_it_is());
        let found: Vec<_> = damage::errors(&verdict).collect();
        assert!(found.is_empty(), "{set:?}: {found:?}");
    }
}

#[test]
fn the_first_layer_has_speeds_flow_and_temperatures_of_its_own() {
    let part = Solid::cuboid([0.0; 3], [20.0, 20.0, 2.0]);
    let temperatures = [
        ("filament.temperature", "230"),
        ("filament.first_layer_temperature", "240"),
        ("filament.bed_temperature", "70"),
        ("filament.first_layer_bed_temperature", "85"),
    ];
    for (profile, nozzle, bed) in [
        ("generic-marlin", "M104 S230", "M140 S70"),
        ("generic-klipper", "M104 S230", "M140 S70"),
        ("zcube-dual", "M104 S230 T1", "M140 S70"),
    ] {
        let run = slice_shipped(&part.stl(), profile, &temperatures);
        let layers: Vec<&str> = run.text.split(";LAYER_CHANGE\n").collect();
        assert!(layers[0].contains(" S240") && layers[0].contains("M140 S85"), "{profile}");
        assert!(!layers[0].contains(" S230") && !layers[0].contains(" S70"), "{profile}");
        let heats = |text: &str| -> Vec<String> {
            text.lines().filter(|line| line.starts_with("M1")).map(str::to_owned).collect()
        };
        let second = heats(layers[2]);
        assert!(
            second.contains(&nozzle.to_owned()) && second.contains(&bed.to_owned()),
            "{second:?}"
        );
        for layer in [&layers[1], &layers[3]] {
            assert!(!heats(layer).iter().any(|line| line.contains("M104")));
        }
    }
    let feeds = |set: &[(&str, &str)], layer: usize| -> Vec<f64> {
        let run =
            slice_shipped(&part.stl(), "generic-marlin", &[&[("speed.wall", "80")], set].concat());
        let beads = run.print.beads().filter(|step| step.layer == Some(layer));
        let mut feeds: Vec<f64> = beads.map(|step| step.feed / 60.0).collect();
        feeds.sort_by(f64::total_cmp);
        feeds.dedup();
        feeds
    };
    assert_eq!(feeds(&[], 0), [25.0, 40.0]);
    assert_eq!(feeds(&[], 1), [50.0, 80.0]);
    assert_eq!(
        feeds(&[("speed.first_layer", "80"), ("speed.first_layer_max", "45")], 0),
        [40.0, 45.0]
    );
    let filament = |flow: &str, layer: usize| -> f64 {
        let run = slice_shipped(&part.stl(), "generic-marlin", &[("extrusion.first_layer", flow)]);
        run.print.beads().filter(|step| step.layer == Some(layer)).map(|step| step.e).sum()
    };
    assert!((filament("120", 0) / filament("100", 0) - 1.2).abs() < 1e-3);
    assert!((filament("120", 1) / filament("100", 1) - 1.0).abs() < 1e-3);
}

#[test]
fn what_is_not_needed_changes_no_move() {
    let stl = crate::common::fixture("bracket.stl");
    let moves = |set: &[(&str, &str)]| {
        let text = slice_shipped(&stl, "generic-marlin", set).text;
        text.split("; printer_model").next().unwrap().to_owned()
    };
    let plain = moves(&[NO_BRIM]);
    assert_eq!(moves(&[]), plain);
    assert_eq!(moves(&[NO_BRIM, ("brim.width", "9"), ("skirt.distance", "2")]), plain);
    assert_eq!(moves(&[("brim.where", "outside"), ("brim.width", "0")]), plain);
}

#[test]
fn what_is_too_thin_to_be_printed_gets_no_brim() {
    // A tower with a thread beside it.
    let tower = Solid::cuboid([0.0; 3], [5.0, 5.0, 40.0]);
    let both = tower.and(&Solid::cuboid([30.0, 0.0, 0.0], [30.3, 5.0, 40.0]));
    for set in [vec![], vec![("brim.where", "outside")]] {
        let set = [&set[..], &[("min_feature", "0.5")]].concat();
        let run = slice_shipped(&both.stl(), "generic-marlin", &set);
        let middle = run.middle()[0];
        let all = places(&first(&run, Kind::Brim));
        assert!(!all.is_empty() && all.iter().all(|(_, at)| at[0] < middle), "{set:?}");
    }
}

#[test]
fn the_first_layers_lines_are_as_wide_as_asked_and_fill_the_same_room() {
    let solid = ring(14.0, 5.0, 2.0);
    for more in [[NO_BRIM, ("dual.mode", "off")], [NO_BRIM, ("dual.mode", "pair")]] {
        let of = |width: &str| {
            let set = [&more[..], &[("first_layer_width", width)]].concat();
            slice_shipped(&solid.stl(), "generic-klipper", &set)
        };
        let (wide, plain) = (of("0.6"), of("0.4"));
        let beads = |run: &Run, kind: Kind, layer: usize| -> Vec<Move> {
            let of = run.print.of(kind).filter(|bead| bead.layer == Some(layer));
            of.cloned().collect()
        };
        let walls = beads(&wide, Kind::OuterWall, 0);
        assert!(walls.iter().all(|bead| (bead.width - 0.6).abs() < 0.011), "{walls:?}");
        // The edge lies where it lay: the middle is further inside by half of what the lines are wider.
        let most = |beads: &[Move]| beads.iter().map(|bead| bead.to[0]).fold(f64::MIN, f64::max);
        let inwards = most(&beads(&plain, Kind::OuterWall, 0)) - most(&walls);
        assert!((inwards - 0.1).abs() < 0.01, "{inwards}");
        let plastic = |run: &Run| -> f64 {
            run.print.beads().filter(|bead| bead.layer == Some(0)).map(|bead| bead.e).sum()
        };
        let share = plastic(&wide) / plastic(&plain);
        assert!((share - 1.0).abs() < 0.02, "{share}");
        let lines = |run: &Run| beads(run, Kind::Skin, 0).iter().map(Move::length).sum::<f64>();
        assert!(lines(&wide) < 0.75 * lines(&plain), "{} {}", lines(&wide), lines(&plain));
        // The layers above do not know; they only begin where the first one ended.
        let above = |run: &Run, layer: usize| -> (usize, f64) {
            let beads = run.print.beads().filter(|bead| bead.layer == Some(layer));
            beads.fold((0, 0.0), |(count, sum), bead| (count + 1, sum + bead.e))
        };
        for layer in 1..wide.print.layers.len() {
            let ((count, e), (same, as_much)) = (above(&wide, layer), above(&plain, layer));
            assert!(count == same && (e - as_much).abs() < 1e-3, "{layer}: {count} {same}");
        }
    }
}
