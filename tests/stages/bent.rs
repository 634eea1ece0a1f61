//! A print whose height varies within its layers -> layers, findings, times and pictures as of a flat one.
//!
//! `fixtures/bent.gcode` was made by hand: bracket.stl, sliced by
//! `-p generic-marlin --scale 0.2 --layer-height 0.3 --first-layer-height 0.3 --walls 1 --infill 15
//! --set machine.thumbnails=[]`; then, from layer 10 on, each line of `;TYPE:Solid infill` was cut
//! into pieces of at most 0.5 mm with E shared out by length, and each end of a piece (and of the
//! travel to it) was lifted by 0.1 · sin(2π (x + 0.6 y) / 4) mm.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{kinds, largest, listed};
use proptest::prelude::*;
use slicer::check::finding::Code;
use slicer::check::terms::Terms;
use slicer::check::{self, Model, Verdict};
use slicer::diff::{self, Side, Tolerances};
use slicer::estimate::{self, Estimate, Options};
use slicer::mesh::Placement;
use slicer::motion::Limits;
use slicer::preview::{drawing::Frame, layer};
use slicer::profile;
use slicer::reader::Print;

const BENT: &str = include_str!("../../fixtures/bent.gcode");

/// Its layers, each 0.3 mm high.
const LAYERS: usize = 16;

/// The first layer with bent lines, from 0.
const FIRST_BENT: usize = 9;

/// The file without comments.
fn bare() -> String {
    let code = BENT.lines().map(|line| line.split(';').next().unwrap().trim_end());
    code.map(|line| format!("{line}\n")).collect()
}

fn read(text: &str) -> Print {
    Print::read(&mut text.as_bytes(), 1.75).unwrap()
}

fn times(text: &str) -> Estimate {
    let settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
    let options = Options { filament_diameter: 1.75, ..Options::default() };
    estimate::estimate(&mut text.as_bytes(), "bent", &Limits::new(&settings), options).unwrap()
}

/// What is found in `text`, by the machine and the model that it was made for.
fn judge(text: &str) -> Verdict {
    let print = read(text);
    let settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
    let terms = Terms::new(Some(&settings), None, &print);
    let path = crate::common::fixtures().join("bracket.stl").to_str().unwrap().to_owned();
    let placement = Placement { scale: 0.2, ..Placement::default() };
    let placed = slicer::place(
        &[slicer::Model::path(path)],
        &placement,
        &slicer::bed(&settings.machine),
        &Default::default(),
    )
    .unwrap();
    check::check(&print, &terms, Some(Model { mesh: &placed.mesh, offset: placed.offset }))
}

/// `text` with the heights of moves after `from` lines changed; `change` gets the line, from 0, and z.
fn with_heights(text: &str, from: usize, change: impl Fn(usize, f64) -> f64) -> String {
    let lines = text.lines().enumerate().map(|(k, line)| {
        let place = line.find(" Z").filter(|_| k >= from && line.starts_with('G'));
        let Some(place) = place else { return format!("{line}\n") };
        let rest = &line[place + 2..];
        let end = rest.find(' ').unwrap_or(rest.len());
        let z = change(k, rest[..end].parse().unwrap());
        format!("{} Z{z:.3}{}\n", &line[..place], &rest[end..])
    });
    lines.collect()
}

/// Where layer `k`, from 0, begins: a line from 0.
fn begin_of(k: usize) -> usize {
    let mut marks = BENT.lines().enumerate().filter(|(_, line)| *line == ";LAYER_CHANGE");
    marks.nth(k).unwrap().0
}

#[test]
fn layers_lie_where_most_of_their_lines_do() {
    for text in [BENT, &bare()] {
        let print = read(text);
        assert_eq!(print.layers.len(), LAYERS);
        for (k, layer) in print.layers.iter().enumerate() {
            let z = 0.3 * (k + 1) as f64;
            assert!((layer.z - z).abs() < 1e-5 && (layer.height - 0.3).abs() < 1e-5, "{layer:?}");
        }
        // The highest place of the last layer's skin.
        assert!((print.top() - 4.836).abs() < 1e-5, "{}", print.top());
    }
}

#[test]
fn a_layer_may_begin_with_a_bent_line() {
    let text = ";LAYER_CHANGE\nG1 Z0.2\nG1 X9 E1\n;LAYER_CHANGE\nG1 Z0.35\nG1 X8 Z0.45 E2\n\
                G1 X5\nG1 Z0.4\nG1 X0 E3\nG1 X0.5 Z0.5 E4\nG1 X0.6 E5";
    let print = read(text);
    assert_eq!(print.layers.len(), 2);
    assert!((print.layers[1].z - 0.4).abs() < 1e-6, "{:?}", print.layers);
    assert!((print.top() - 0.5).abs() < 1e-6);
    let times = times(text);
    assert_eq!(times.layers.len(), 2);
    assert!((times.layers[1].z_mm - 0.4).abs() < 1e-9);
    // Nothing is level: the middle of its length.
    let text = ";LAYER_CHANGE\nG1 Z0.2\nG1 X5 Z0.3 E1\nG1 X9 Z0.4 E2\nG1 X12 Z0.5 E3";
    assert!((read(text).layers[0].z - 0.35).abs() < 1e-6);
}

#[test]
fn a_spiral_without_comments_is_no_pile_of_layers() {
    let mut text = "G1 Z0.2\nG1 X9 E1\nG1 X9 Y9 E2\nG1 X0 E3\n".to_owned();
    for k in 0..400 {
        let [x, y] = [[0, 0], [9, 0], [9, 9], [0, 9]][k % 4];
        // Rounded to hundredths: every other piece is level.
        let z = 0.2 + (k as f64 * 0.5).floor() / 100.0;
        text.push_str(&format!("G1 X{x} Y{y} Z{z:.2} E{}\n", k + 4));
    }
    assert_eq!(read(&text).layers.len(), 1);
    assert_eq!(times(&text).layers.len(), 1);
}

#[test]
fn each_round_of_a_spiral_without_comments_is_a_layer() {
    // A spiral on its own, and on two flat layers.
    for bottom in ["", "G1 X9 E1\nG1 Y9 E1\nG1 X0 Y0 Z0.4\nG1 X9 E1\nG1 Y9 E1\n"] {
        let flat = bottom.matches("G1 X9 E").count();
        let mut text = format!("M83\nG1 Z0.2 F1200\n{bottom}G1 E-1\nG1 X20 Y10 Z0.4\nG1 E1\n");
        for k in 1..=720 {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 72.0).sin_cos();
            let z = 0.4 + 0.2 * f64::from(k) / 72.0;
            text.push_str(&format!(
                "G1 X{:.3} Y{:.3} Z{z:.4} E.06\n",
                10.0 + 10.0 * cos,
                10.0 + 10.0 * sin
            ));
        }
        let print = read(&text);
        assert_eq!(print.layers.len(), flat + 10, "{:?}", print.layers);
        for (k, layer) in print.layers[flat..].iter().enumerate() {
            assert!((layer.z - (0.5 + 0.2 * k as f64)).abs() < 0.02, "{layer:?}");
        }
        assert_eq!(times(&text).layers.len(), flat + 10);
    }
}

#[test]
fn a_layer_whose_lines_begin_with_a_ramp_is_one() {
    // A seam that rises along its first millimetres, as some slicers print it.
    let wall = |z: f64| {
        let low = z - 0.2;
        format!(
            "G1 X0 Y0 Z{low:.2} F6000\nG1 X2 Z{z:.2} E1\nG1 X20 E2\nG1 Y20 E3\nG1 X0 E4\nG1 Y0 E5\n\
             G1 X2 E5.1\nG92 E0\nG1 X5 Y5\nG1 X15 E1\nG1 Y15 E2\nG92 E0\n"
        )
    };
    let text: String = (1..=5).map(|k| wall(0.2 * f64::from(k))).collect();
    let heights: Vec<f32> = read(&text).layers.iter().map(|layer| layer.z as f32).collect();
    assert_eq!(heights, [0.2, 0.4, 0.6, 0.8, 1.0]);
}

#[test]
fn parts_that_are_printed_one_after_the_other_have_their_own_layers() {
    let part = "G1 Z0.2\nG1 X9 E1\nG92 E0\nG1 Z0.4\nG1 X0 E1\nG92 E0\nG1 Z5\n";
    let print = read(&part.repeat(3));
    let heights: Vec<f32> = print.layers.iter().map(|layer| layer.z as f32).collect();
    assert_eq!(heights, [0.2, 0.4, 0.2, 0.4, 0.2, 0.4]);
}

#[test]
fn bent_skins_are_clean_with_and_without_comments() {
    let verdict = judge(BENT);
    assert_eq!(kinds(&verdict), [], "{}", listed(&verdict));
    assert!(verdict.not_judged.is_empty(), "{:?}", verdict.not_judged);
    assert!(verdict.measures.surface.unwrap() > 0.98, "{:?}", verdict.measures);
    let verdict = judge(&bare());
    assert_eq!(kinds(&verdict), [], "{}", listed(&verdict));
    assert!(verdict.not_judged.iter().all(|what| what.contains("no comment")), "{verdict:?}");
    assert!(verdict.measures.surface.unwrap() > 0.98, "{:?}", verdict.measures);
}

#[test]
fn walls_may_vary_in_height_as_skins_may() {
    let walls = BENT.replace(";TYPE:Solid infill", ";TYPE:Internal infill");
    let verdict = judge(&walls);
    assert!(!kinds(&verdict).contains(&Code::FallingZ), "{}", listed(&verdict));
}

#[test]
fn a_bent_line_that_lies_in_what_is_printed_falls() {
    for text in [BENT.to_owned(), BENT.replace(";TYPE:Solid infill", ";TYPE:Internal infill")] {
        // The last layer's skins, two layers lower.
        let text = with_heights(&text, begin_of(LAYERS - 1) + 12, |_, z| {
            if (4.65..4.95).contains(&z) && z != 4.8 { z - 0.6 } else { z }
        });
        let verdict = judge(&text);
        let found = largest(&verdict, Code::FallingZ);
        assert_eq!(found.place.layer, Some(LAYERS), "{found}");
        // In what is printed of the layer below, as much as that one is bent.
        assert!((0.2..0.5).contains(&found.measure), "{found}");
    }
}

#[test]
fn times_are_by_the_same_layers() {
    let (marked, bare) = (times(BENT), times(&bare()));
    assert_eq!((marked.layers.len(), bare.layers.len()), (LAYERS, LAYERS));
    for (k, (one, other)) in marked.layers.iter().zip(&bare.layers).enumerate() {
        let z = 0.3 * (k + 1) as f64;
        assert!((one.z_mm - z).abs() < 1e-9 && (other.z_mm - z).abs() < 1e-9, "{one:?} {other:?}");
        // What lies between a layer's mark and its first line is counted before it without marks.
        assert!(k == 0 || (one.seconds - other.seconds).abs() < 0.6, "{k}: {one:?} {other:?}");
    }
}

#[test]
fn both_forms_are_compared_layer_by_layer() {
    let side = |text: &str| Side::of_bytes(text.as_bytes(), times(text)).unwrap();
    let tolerances = Tolerances::default();
    let found = diff::diff(&side(BENT), &side(&bare()), &tolerances).unwrap();
    assert!(found.pairs.iter().all(|pair| pair.layer.a == pair.layer.b), "{:?}", found.findings);
    // The line that primes the nozzle is a part of the first layer where nothing marks that.
    for finding in &found.findings {
        let text = serde_json::to_string(finding).unwrap();
        assert!(
            text.contains("commands")
                || text.contains(r#""a":1"#)
                || text.contains(r#""layer":{"a":0,"b":0}"#)
                || text.contains(r#""layers":[0]"#),
            "{text}"
        );
    }
    let same = diff::diff(&side(&bare()), &side(&bare()), &tolerances).unwrap();
    assert!(same.equal && same.pairs.len() == LAYERS + 1);
}

#[test]
fn both_forms_are_drawn_layer_by_layer() {
    let (marked, bare) = (read(BENT), read(&bare()));
    for k in FIRST_BENT..LAYERS {
        let picture = |print: &Print| {
            let frame = Frame { min: [130.0, 140.0], max: [170.0, 160.0] };
            let options = layer::Options { size: 600, below: 0, travels: false, frame };
            layer::drawing(print, k, &options)
        };
        let (one, other) = (picture(&marked), picture(&bare));
        let points = |drawing: &slicer::preview::drawing::Drawing| {
            drawing.scene.iter().map(|stroke| stroke.points.len() - 1).sum::<usize>()
        };
        assert_eq!(one.title, other.title);
        assert_eq!(points(&one), points(&other), "{}", one.title);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    /// However skins are bent: the layers are those of the walls.
    #[test]
    fn any_bend_leaves_the_layers(phase in 0.0..7.0_f64, high in 0.01..0.14_f64) {
        let text = with_heights(&bare(), 0, |k, z| {
            let layer = (z / 0.3).round() * 0.3;
            let bent = (z - layer).abs() > 1e-6 && z < 5.0;
            if bent { layer + high * (phase + k as f64).sin() } else { z }
        });
        prop_assert_eq!(read(&text).layers.len(), LAYERS);
        prop_assert_eq!(times(&text).layers.len(), LAYERS);
    }
}
