//! `slicer diff`: what is the same in other bytes, and what is found where, by how much.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::run::with as slicer;
use crate::common::{fixture, settings, slice};
use proptest::prelude::*;
use slicer::diff::{Both, Difference, File, Finding, Quantity, Side, Tolerances, diff};
use slicer::estimate::{Options, estimate};
use slicer::motion::Limits;
use slicer::reader::Role;
use std::fmt::Write as _;

/// A line of a small print: role's comment, start, end, filament.
type Line = (&'static str, [f64; 2], [f64; 2], f64);

/// Layers of lines, 0.2 mm apart, each line on its own.
type Model = Vec<Vec<Line>>;

/// Squares of 20 mm with nine lines of infill.
fn model(layers: usize) -> Model {
    let corners = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]];
    let wall = |k: usize| ("Outer wall", corners[k], corners[(k + 1) % 4], 20.0 * 0.0333);
    let fill = |k: usize| {
        let x = 2.0 * (k + 1) as f64;
        ("Sparse infill", [x, 0.4], [x, 19.6], 19.2 * 0.0333)
    };
    let layer: Vec<Line> = (0..4).map(wall).chain((0..9).map(fill)).collect();
    vec![layer; layers]
}

fn gcode(model: &Model) -> String {
    let mut text = "M104 S210\nG28\nM83\nG1 Z5 F1000\n".to_owned();
    for (index, layer) in model.iter().enumerate() {
        let z = 0.2 * (index + 1) as f64;
        writeln!(text, ";LAYER_CHANGE\nG1 Z{z:.3} F1000").unwrap();
        for (role, from, to, filament) in layer {
            writeln!(text, ";TYPE:{role}").unwrap();
            writeln!(text, "G1 X{:.4} Y{:.4} F6000", from[0], from[1]).unwrap();
            writeln!(text, "G1 X{:.4} Y{:.4} E{filament:.5} F3000", to[0], to[1]).unwrap();
        }
    }
    text + "M104 S0\n"
}

pub(crate) fn side(text: &str) -> Side {
    let limits = Limits::new(&settings("generic-marlin", &[]));
    let options = Options { filament_diameter: 1.75, ..Options::default() };
    let time = estimate(&mut text.as_bytes(), "x", &limits, options).unwrap();
    Side::of_bytes(text.as_bytes(), time).unwrap()
}

fn compared(a: &str, b: &str) -> Difference {
    // Ways and seams have tests of their own, in `ways.rs`.
    let tolerances = Tolerances { travels: false, seams: f64::INFINITY, ..Tolerances::default() };
    let (a, b) = (side(a), side(b));
    let found = diff(&a, &b, &tolerances).unwrap();
    // It has no direction: what is told of A is told of B the other way round.
    assert_eq!(diff(&b, &a, &tolerances).unwrap().findings.len(), found.findings.len());
    found
}

#[test]
fn order_direction_and_division_of_lines_do_not_matter() {
    let made = model(4);
    let mut other = made.clone();
    for layer in &mut other {
        layer.reverse();
        for line in layer.iter_mut() {
            (line.1, line.2) = (line.2, line.1);
        }
        let (role, from, to, filament) = layer.remove(3);
        let part = |t: f64| [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
        layer.push((role, from, part(0.3), 0.3 * filament));
        layer.push((role, part(0.3), to, 0.7 * filament));
    }
    // Only the ways between lines are other ones: a time of their own.
    let found = compared(&gcode(&made), &gcode(&other));
    let rest: Vec<_> = found
        .findings
        .iter()
        .filter(|one| !matches!(one, Finding::Sum { quantity: Quantity::Time, .. }))
        .collect();
    assert!(rest.is_empty(), "{rest:?}");
    let mut turned = made.clone();
    turned[2].reverse();
    turned[2].iter_mut().for_each(|line| (line.1, line.2) = (line.2, line.1));
    let found = compared(&gcode(&made), &gcode(&turned));
    assert!(found.equal, "{:?}", found.findings);
    assert!(compared(&gcode(&made), &gcode(&made)).equal);
}

#[test]
fn a_slower_layer_is_found() {
    let made = gcode(&model(8));
    let at = made.match_indices(";LAYER_CHANGE").nth(4).unwrap().0;
    let slower =
        made[..at].to_owned() + &made[at..].replacen("E0.66600 F3000", "E0.66600 F2000", 1);
    let found = compared(&made, &slower);
    let [Finding::Sum { layer: Some(layer), role, quantity: Quantity::AskedTime, sum }] =
        &found.findings[..]
    else {
        panic!("{:?}", found.findings);
    };
    assert_eq!((layer.a, *role), (5, Some(Role::OuterWall)));
    assert!((sum.b - sum.a - 0.2).abs() < 1e-3, "{sum:?}");
}

#[test]
fn a_moved_end_is_found_in_its_layer_if_it_is_too_far() {
    let made = model(4);
    let moved = |by: f64| {
        let mut other = made.clone();
        other[2][7].2[0] += by;
        compared(&gcode(&made), &gcode(&other))
    };
    assert!(moved(0.005).equal && moved(0.01).equal);
    let found = moved(0.02);
    let [Finding::Lines { layer, role, far_mm, farthest, .. }] = &found.findings[..] else {
        panic!("{:?}", found.findings);
    };
    assert_eq!((*layer, *role), (Both { a: 3, b: 3 }, Role::Infill));
    assert!((farthest.distance_mm - 0.02).abs() < 1e-4, "{farthest:?}");
    assert!((farthest.at_mm[0] - 8.0).abs() < 0.03 && (farthest.at_mm[1] - 19.6).abs() < 1e-4);
    assert!((farthest.at_mm[2] - 0.6).abs() < 1e-4);
    // The half of the line that has the moved end.
    assert!((far_mm.a - 9.6).abs() < 0.2 && (far_mm.b - 9.6).abs() < 0.2, "{far_mm:?}");
    let line = |text: String| text.lines().nth(farthest.line.a as usize - 1).unwrap().to_owned();
    assert!(line(gcode(&made)).starts_with("G1 X8.0000 Y19.6000 E"));
}

#[test]
fn more_filament_on_a_line_is_found_although_it_lies_where_it_did() {
    let made = model(4);
    let mut other = made.clone();
    other[1][5].3 *= 2.0;
    let found = compared(&gcode(&made), &gcode(&other));
    let Finding::Flow { layer, role, unlike_mm, most_unlike, .. } = &found.findings[0] else {
        panic!("{:?}", found.findings);
    };
    assert_eq!((layer.a, *role), (2, Role::Infill));
    assert!((unlike_mm.a - 19.2).abs() < 0.01 && (unlike_mm.b - 19.2).abs() < 0.01);
    let Both { a, b } = most_unlike.filament_per_mm;
    assert!((b / a - 2.0).abs() < 1e-3);
    // Drawn twice it lies nowhere else, but the second one has no counterpart: there is twice the plastic.
    let mut twice = made.clone();
    let line = twice[1][5];
    twice[1].push(line);
    let found = compared(&gcode(&made), &gcode(&twice));
    let Finding::Flow { layer, unlike_mm, most_unlike, .. } = &found.findings[0] else {
        panic!("{:?}", found.findings);
    };
    assert_eq!((layer.a, unlike_mm.a), (2, 0.0));
    assert!((unlike_mm.b - 19.2).abs() < 1e-3);
    let Both { a, b } = most_unlike.filament_per_mm;
    assert!((b / a - 2.0).abs() < 1e-3);
    let longer = found.findings.iter().any(|finding| {
        matches!(finding, Finding::Sum { layer: None, quantity: Quantity::Length, sum, .. }
            if (sum.b - sum.a - 19.2).abs() < 1e-3)
    });
    assert!(longer, "{:?}", found.findings);
}

#[test]
fn a_layer_that_is_missing_does_not_upset_those_above() {
    let made = gcode(&model(8));
    let start = made.match_indices(";LAYER_CHANGE").nth(3).unwrap().0;
    let end = made.match_indices(";LAYER_CHANGE").nth(4).unwrap().0;
    let other = made[..start].to_owned() + &made[end..];
    let found = compared(&made, &other);
    let Finding::LayersOnlyIn { file, layers, length_mm } = &found.findings[0] else {
        panic!("{:?}", found.findings);
    };
    assert_eq!((*file, &layers[..]), (File::A, &[4][..]));
    assert!((length_mm - 80.0 - 9.0 * 19.2).abs() < 1e-3);
    let is_sum = |one: &Finding| matches!(one, Finding::Sum { layer: None, .. });
    assert!(found.findings[1..].iter().all(is_sum), "{:?}", found.findings);
}

#[test]
fn orders_to_the_printer_are_told_with_their_place() {
    let made = gcode(&model(3));
    let hotter = made.replace("M104 S210", "M104 S215");
    let found = compared(&made, &hotter);
    let [Finding::Heaters { layer, difference }] = &found.findings[..] else {
        panic!("{:?}", found.findings);
    };
    assert_eq!(*layer, Some(Both { a: 0, b: 0 }));
    assert_eq!(difference.only.b, ["nozzle 215 °C"]);
    assert_eq!(difference.line, Both { a: Some(1), b: Some(1) });
    let fan = made.replacen("Z0.400 F1000", "Z0.400 F1000\nM106 S255", 1);
    let found = compared(&made, &fan);
    let [Finding::Commands { layer: Some(layer), difference }] = &found.findings[..] else {
        panic!("{:?}", found.findings);
    };
    assert_eq!((layer.b, &difference.only.b[..]), (2, &["M106 S255".to_owned()][..]));
    let left_hot = made.replace("M104 S0\n", "");
    let found = compared(&made, &left_hot);
    assert!(matches!(found.findings[..], [Finding::Heaters { layer: None, .. }]));
    // Talk, progress and other words for the same are no orders.
    let talk = made.replace("M104 S210", "; hello\nM117 hello\nM73 P0\nm104 S210.0");
    assert!(compared(&made, &talk).equal);
}

#[test]
fn thick_infill_differs_from_thin_and_the_walls_do_not() {
    let stl = fixture("bracket.stl");
    let thin = slice(&stl, "generic-marlin", &[]).text;
    let thick = slice(&stl, "generic-marlin", &[("dual.mode", "pair")]).text;
    let found = compared(&thin, &thick);
    assert!(!found.equal);
    for role in found.pairs.iter().flat_map(|pair| &pair.roles) {
        let far = role.far_mm.a + role.far_mm.b;
        if matches!(role.role, Role::OuterWall | Role::InnerWall | Role::Other) {
            assert!(far == 0.0 && role.unlike_mm == Both { a: 0.0, b: 0.0 }, "{role:?}");
        }
    }
    let lone = |one: &&Finding| matches!(one, Finding::RoleOnlyIn { file: File::A, role: Role::Infill, layers, .. } if layers.len() > 20);
    assert!(found.findings.iter().any(|one| lone(&one)), "{:?}", found.findings);
    let infill = found.roles.iter().find(|row| row.role == Role::Infill).unwrap();
    assert!(!infill.length_mm.equal && infill.length_mm.b < 0.7 * infill.length_mm.a);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn how_far_a_corner_was_moved_is_told(
        layer in 0..3_usize, line in 4..13_usize, start in any::<bool>(),
        x in 0.02..0.9_f64, y in -0.4..0.9_f64,
    ) {
        let made = model(3);
        let mut other = made.clone();
        let end = &mut other[layer][line];
        let end = if start { &mut end.1 } else { &mut end.2 };
        // As the file has it. Lines are 2 mm apart: its own is the nearest.
        let by = [x, if start { -y } else { y }].map(|by| (by * 1e4).round() / 1e4);
        (end[0], end[1]) = (end[0] + by[0], end[1] + by[1]);
        let expected = (by[0] * by[0] + by[1] * by[1]).sqrt();
        let found = compared(&gcode(&made), &gcode(&other));
        let lines = found.findings.iter().find_map(|one| match one {
            Finding::Lines { layer, farthest, .. } => Some((*layer, *farthest)),
            _ => None,
        });
        let (at, place) = lines.unwrap();
        prop_assert_eq!(at, Both { a: layer + 1, b: layer + 1 });
        // Moved outwards the end itself is as far; inwards, the old end from the new line.
        let told = place.distance_mm;
        prop_assert!((told - expected).abs() < 2e-3 * expected + 2e-4, "{} {}", told, expected);
    }
}

const TILE: &str = "fixtures/golden/tile@generic-marlin.gcode";

#[test]
fn exit_codes_text_and_json() {
    let told = slicer(&["diff", TILE, TILE]).assert().code(0);
    let text = String::from_utf8(told.get_output().stdout.clone()).unwrap();
    assert!(text.starts_with("equal within 0.01 mm, 0.1 %\n"), "{text}");
    let tile = std::fs::read_to_string(TILE).unwrap();
    let hotter = tile.replace("M109 S210", "M109 S200").replace("infill = 20", "infill = 21");
    let told = slicer(&["diff", TILE, "-"]).write_stdin(hotter.clone()).assert().code(1);
    let text = String::from_utf8(told.get_output().stdout.clone()).unwrap();
    let line = 1 + tile.lines().position(|line| line.starts_with("M109")).unwrap();
    let heaters = format!(
        "before the first line: heaters: A nozzle 210 °C waited for (line {line}), B nozzle 200 °C"
    );
    for part in [
        "not equal within 0.01 mm, 0.1 %: 1 difference\n",
        &heaters,
        "told only: 1 setting in comments: infill: 20 in A, 21 in B",
        "timed by the limits of the settings in A",
    ] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
    let words = ["diff", "-", TILE, "--json", "--settings", "-p", "generic-klipper"];
    let told = slicer(&words).write_stdin(hotter).assert().code(1);
    let json: serde_json::Value = serde_json::from_slice(&told.get_output().stdout).unwrap();
    assert_eq!((&json["schema"], &json["equal"]), (&1.into(), &false.into()));
    assert_eq!(json["findings"][0]["kind"], "heaters");
    assert_eq!(json["findings"][1]["kind"], "setting");
    assert_eq!(json["limits"], "profile generic-klipper");
    assert_eq!(json["pairs"].as_array().unwrap().len(), 9);
}

#[test]
fn a_layer_that_lacks_a_role_is_drawn_beside_the_other_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let mut hollow = model(4);
    hollow[2].truncate(4);
    std::fs::write(path("a.gcode"), gcode(&model(4))).unwrap();
    std::fs::write(path("b.gcode"), gcode(&hollow)).unwrap();
    slicer(&["diff", &path("a.gcode"), &path("b.gcode"), "-q", "-o", &path("d.svg")])
        .assert()
        .code(1);
    let drawn = std::fs::read_to_string(path("d.svg")).unwrap();
    assert!(drawn.contains("A: layer 3, z 0.6") && drawn.contains("B: layer 3, z 0.6"), "{drawn}");
}

#[test]
fn errors_name_the_file_the_cause_and_what_to_do() {
    for (words, code, part) in [
        (&["diff", TILE, "no.gcode"][..], 3, "error: no.gcode: cannot read: "),
        (&["diff", "fixtures/cube_20.stl", TILE], 3, "cube_20.stl: there is no move in it"),
        (&["diff", "-", "-"], 2, "`-` is given twice"),
        (&["diff", TILE], 2, "see `slicer diff --help`"),
        (&["diff", TILE, TILE, "--tolerance", "-1"], 2, "it must be 0 or more"),
        (&["diff", TILE, TILE, "--set", "limits.jerk_y=-1"], 2, "out of range"),
    ] {
        let failed = slicer(words).assert().code(code).stdout("");
        let text = String::from_utf8(failed.get_output().stderr.clone()).unwrap();
        assert!(text.contains(part) && text.lines().count() == 1, "{text}");
    }
}

/// A file of the first format of settings: no number, speeds in mm/min, other names.
const OLD: &str = "fixtures/old/tile@generic-marlin.gcode";

#[test]
fn settings_of_the_first_format_are_read_as_todays() {
    let old = std::fs::read_to_string(OLD).unwrap();
    assert!(old.contains("; retraction.feed = 1200") && !old.contains("settings_format"));
    // Its print is an older one, too: of the settings only what has another default today differs.
    let told = slicer(&["diff", OLD, TILE, "--settings", "--all"]).assert().code(1).stderr("");
    let text = String::from_utf8(told.get_output().stdout.clone()).unwrap();
    let settings = text.lines().filter_map(|line| line.trim().strip_prefix("setting "));
    let differs = settings.filter(|s| !s.contains("nothing in A")).collect::<Vec<_>>();
    let defaults = [
        "corner_radius",
        "skin_reach",
        "speed.first_layer",
        "support.expansion",
        "estimated printing",
        "filament used",
    ];
    assert!(differs.iter().all(|s| defaults.iter().any(|key| s.starts_with(key))), "{differs:?}");
    for words in [&["check", OLD][..], &["estimate", OLD, "-p", "generic-marlin"]] {
        let told = slicer(words).assert().code(0).stderr("");
        let text = String::from_utf8(told.get_output().stdout.clone()).unwrap();
        assert!(!text.contains("told only: 1 setting"), "{text}");
    }
    // The machine's limits are read as mm/min: 1800 mm/min are less than the lines need.
    let slow = old.replace("; limits.feed_x = 18000", "; limits.feed_x = 1800");
    let told = slicer(&["check", "-"]).write_stdin(slow).assert().code(1);
    let text = String::from_utf8(told.get_output().stdout.clone()).unwrap();
    assert!(text.contains("mm/s in x, where the machine does 30"), "{text}");
}
