//! `slicer preview`: what is in the pictures of layers and cuts, held against the G-code itself, and errors.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::{Kind, fixture, fixtures, slice};
use assert_cmd::Command;
use predicates::prelude::*;
use slicer::preview::colours::Colour;
use slicer::preview::cut::{Axis, Cut, Plane};
use slicer::preview::drawing::{Drawing, Frame};
use slicer::preview::{layer, png, svg};
use slicer::reader::{Print, Role};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

pub(super) const TILE: &str = "golden/tile@zcube-dual.gcode";

/// A layer of the bracket with skin, thin and thick infill, counted from 1; the layer below
/// has its infill printed by this one.
const LAYER: usize = 14;

pub(super) fn slicer(folder: &TempDir) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    command.current_dir(folder.path());
    command
}

pub(super) fn print(text: &str) -> Print {
    Print::read(&mut text.as_bytes(), 1.75).unwrap()
}

fn bracket() -> String {
    slice(&fixture("bracket.stl"), "zcube-dual", &[("dual.mode", "pair")]).text
}

fn drawn(print: &Print, number: usize, size: u32) -> Drawing {
    let frame = layer::frame(print, &print.layers);
    let options = layer::Options { size, below: 0, travels: false, frame };
    layer::drawing(print, number - 1, &options)
}

pub(super) fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// What a path of the scene is painted with last, its width and its lines.
struct Painted {
    colour: String,
    width: f64,
    lines: Vec<[[f64; 2]; 2]>,
}

/// The beads of an SVG. Fails if it is not well-formed.
fn beads(text: &str) -> Vec<Painted> {
    let document = roxmltree::Document::parse(text).unwrap();
    let nodes = || document.descendants();
    let paths = nodes().filter(|node| node.has_tag_name("path") && node.has_attribute("id"));
    paths
        .map(|path| {
            let href = format!("#{}", path.attribute("id").unwrap());
            let top = nodes().find(|node| node.attribute("href") == Some(&href)).unwrap();
            let width = path.parent().unwrap().attribute("stroke-width").unwrap();
            Painted {
                colour: top.attribute("stroke").unwrap().to_owned(),
                width: width.parse().unwrap(),
                lines: lines(path.attribute("d").unwrap()),
            }
        })
        .collect()
}

/// The lines of a path's text, of `M` and `l` only.
fn lines(path: &str) -> Vec<[[f64; 2]; 2]> {
    let mut all = Vec::new();
    for run in path.split('M').skip(1) {
        let spaced = run.replace('-', " -").replace('l', " ");
        let numbers: Vec<f64> = spaced.split_whitespace().map(|n| n.parse().unwrap()).collect();
        let mut at = [numbers[0], numbers[1]];
        for way in numbers[2..].chunks(2) {
            let to = [at[0] + way[0], at[1] + way[1]];
            all.push([at, to]);
            at = to;
        }
    }
    all
}

fn colour(kind: Kind, thick: bool) -> String {
    let role = match kind {
        Kind::OuterWall | Kind::Overhang => Role::OuterWall,
        Kind::InnerWall => Role::InnerWall,
        Kind::Skin | Kind::Bridge => Role::Skin,
        Kind::Ironing => Role::Ironing,
        Kind::Infill => Role::Infill,
        Kind::Support | Kind::SupportInterface => Role::Support,
        Kind::Brim => Role::Adhesion,
        Kind::Custom => Role::Other,
    };
    Colour::of(role, thick).hex()
}

#[test]
fn every_line_of_a_layer_is_in_the_picture_where_it_is_printed_in_its_colour() {
    let text = bracket();
    let moves = crate::common::Print::read(&text).unwrap().moves;
    let wanted: Vec<_> =
        moves.iter().filter(|m| m.is_bead() && m.layer == Some(LAYER - 1)).collect();
    let found = beads(&svg::write(&drawn(&print(&text), LAYER, 1200)));
    let all = found.iter().flat_map(|p| p.lines.iter().map(move |line| (line, p)));
    let all: Vec<_> = all.collect();
    assert_eq!(all.len(), wanted.len());
    let mut colours = std::collections::BTreeSet::new();
    for (bead, (line, painted)) in wanted.iter().zip(all) {
        for (a, b) in [(bead.a(), line[0]), (bead.b(), line[1])] {
            // Hundredths of a mm.
            assert!((a[0] - b[0]).abs() < 0.0056 && (a[1] - b[1]).abs() < 0.0056, "{a:?} {b:?}");
        }
        assert!((bead.width - painted.width).abs() < 0.006, "line {}", bead.line);
        assert_eq!(painted.colour, colour(bead.kind, bead.height > 0.3), "line {}", bead.line);
        colours.insert(painted.colour.clone());
    }
    // Wall, skin, thin and thick infill.
    assert_eq!(colours.len(), 4);
}

#[test]
fn the_legend_names_the_layer_and_what_is_on_it() {
    let text = svg::write(&drawn(&print(&bracket()), LAYER, 1200));
    let document = roxmltree::Document::parse(&text).unwrap();
    let words: Vec<_> = document.descendants().filter(|n| n.has_tag_name("text")).collect();
    let has = |wanted: &str| words.iter().any(|node| node.text() == Some(wanted));
    for wanted in ["layer 14 of 120", "z 2.8 mm", "height 0.2 mm", "outer wall", "skin"] {
        assert!(has(wanted), "{wanted}");
    }
    assert!(has("infill") && has("infill, thick") && has("x mm") && has("10 mm"));
    assert!(!has("support") && !has("travel"));
}

/// Red, green and blue of all pixels of the PNG.
fn pixels(drawing: &Drawing) -> Vec<u8> {
    let decoder = ::png::Decoder::new(std::io::Cursor::new(png::write(drawing).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!([info.width, info.height], drawing.size);
    pixels
}

#[test]
fn y_is_upwards_and_a_crop_ends_where_it_is_told() {
    let text = ";LAYER_CHANGE\n;TYPE:Skin\n;WIDTH:1\nG1 X0 Y10 Z0.2\nG1 X20 E1\n\
                ;TYPE:Perimeter\nG1 Y0\nG1 X18 E2";
    let drawing = drawn(&print(text), 1, 800);
    let dots = pixels(&drawing);
    let at = |point| {
        let [x, y] = drawing.view.pixel(point).map(|at| at as usize);
        let first = 3 * (y * drawing.size[0] as usize + x);
        Colour(dots[first..first + 3].try_into().unwrap())
    };
    assert_eq!(at([10.0, 10.0]), Colour::of(Role::Skin, false));
    assert_eq!(at([19.0, 0.0]), Colour::of(Role::InnerWall, false));
    assert_eq!(at([10.0, 0.0]), Colour([255; 3]));

    // Right of x = 5 there is only the panel.
    let frame = Frame { min: [0.0, 8.0], max: [5.0, 12.0] };
    let options = layer::Options { size: 800, below: 0, travels: false, frame };
    let drawing = layer::drawing(&print(text), 0, &options);
    let dots = pixels(&drawing);
    let row = drawing.view.pixel([5.0, 10.2])[1] as usize;
    let start = 3 * row * drawing.size[0] as usize;
    let skin = |x: f64| {
        let first = start + 3 * drawing.view.pixel([x, 10.2])[0] as usize;
        dots[first..first + 3] == Colour::of(Role::Skin, false).0
    };
    assert!(skin(4.9) && !skin(5.1));
}

#[test]
fn the_ink_of_a_png_covers_what_the_beads_cover() {
    let text = bracket();
    let mut drawing = drawn(&print(&text), LAYER, 2400);
    drawing.page.clear();
    let pixels = pixels(&drawing);
    assert_eq!(drawing.size.into_iter().max().unwrap().abs_diff(2400), 0);
    // Half covered by the palest edge is darker than this.
    let inked = pixels.chunks(3).filter(|dot| dot.iter().min().unwrap() < &190).count();
    let inked = inked as f64 / (drawing.view.scale * drawing.view.scale);

    // On a grid of its own, by the distance to each line. Edges of beads lie at round figures: places
    // of the grid do not, or those on an edge would count for both sides.
    let pixel = 0.031;
    let mut grid = std::collections::BTreeSet::new();
    let moves = crate::common::Print::read(&text).unwrap().moves;
    for bead in moves.iter().filter(|m| m.is_bead() && m.layer == Some(LAYER - 1)) {
        let (a, b, half) = (bead.a(), bead.b(), bead.width / 2.0);
        let range = |k: usize| {
            let (low, high) = (a[k].min(b[k]) - half, a[k].max(b[k]) + half);
            (low / pixel) as i32 - 1..=(high / pixel) as i32 + 1
        };
        for (x, y) in range(0).flat_map(|x| range(1).map(move |y| (x, y))) {
            let at = [x, y].map(|k| (f64::from(k) + 0.37) * pixel);
            if crate::common::section::distance(at, a, b) <= half {
                grid.insert((x, y));
            }
        }
    }
    let area = grid.len() as f64 * pixel * pixel;
    // Gaps narrower than a pixel are inked: 2.1 % here, less in a larger picture.
    assert!((inked / area - 1.0).abs() < 0.03, "{inked} mm² inked, {area} mm² covered");
}

#[test]
fn thick_infill_is_twice_as_high_in_a_cut_and_all_lies_in_the_print() {
    let print = print(&bracket());
    let cut = Cut::new(&print, Plane { axis: Axis::X, at: 20.0 });
    let heights = |colour: Colour| {
        let mut all: Vec<f64> =
            cut.sections.iter().filter(|s| s.colour == colour).map(|s| s.height).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let wall = heights(Colour::of(Role::OuterWall, false));
    // Two of each of the 30 layers of the plate.
    assert_eq!((wall.len(), wall[0], wall[wall.len() - 1]), (60, 0.2, 0.2));
    let thin = heights(Colour::of(Role::Infill, false));
    let thick = heights(Colour::of(Role::Infill, true));
    assert!(thick.len() > 50 && thick[thick.len() / 2] == 0.4, "{thick:?}");
    assert!(thin[thin.len() - 1] == 0.2 && thick.len() > thin.len());
    for section in &cut.sections {
        assert!(section.low > -15.01 && section.high < 15.01, "{section:?}");
        assert!(section.bottom > -1e-3 && section.bottom + section.height < 6.01, "{section:?}");
    }
    let drawing = cut.drawing(Plane { axis: Axis::X, at: 20.0 }, cut.frame(), 1200);
    let painted = beads(&svg::write(&drawing));
    let blue = Colour::of(Role::Infill, true).hex();
    assert!(painted.iter().any(|p| p.colour == blue && p.width == 0.4));
}

#[test]
fn travels_and_layers_below_are_drawn_only_when_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let file = fixtures().join(TILE);
    let draw = |words: &[&str]| {
        let run = slicer(&folder).arg("preview").arg(&file).args(words).assert().success();
        String::from_utf8(run.get_output().stdout.clone()).unwrap()
    };
    let base = ["--layer", "4", "--format", "svg", "-o", "-", "-q"];
    let plain = draw(&base);
    let travels = draw(&[&base[..], &["--travels"]].concat());
    let below = draw(&[&base[..], &["--below", "2"]].concat());
    assert!(!plain.contains("dasharray") && travels.contains("dasharray"));
    assert!(!plain.contains("layers below") && below.contains("layers below"));
    let count = |text: &str| beads(text).iter().map(|p| p.lines.len()).sum::<usize>();
    assert!(count(&plain) == count(&travels) && count(&plain) < count(&below));
    assert_eq!(plain, draw(&base));
}

#[test]
fn every_layer_gets_a_picture_or_none_does() {
    let folder = tempfile::tempdir().unwrap();
    let file = fixtures().join(TILE);
    let words = ["--all", "-o", "a.png", "--size", "400"];
    let run = |words: &[&str]| slicer(&folder).arg("preview").arg(&file).args(words).assert();
    run(&words).success().stdout("").stderr("a-0001.png to a-0008.png\n");
    let names: Vec<_> = (1..=8).map(|n| format!("a-{n:04}.png")).collect();
    assert_eq!(files(folder.path()), names);
    let first = fs::read(folder.path().join("a-0001.png")).unwrap();
    run(&words).success();
    assert_eq!(fs::read(folder.path().join("a-0001.png")).unwrap(), first);

    // The seventh name is taken by a folder.
    fs::create_dir(folder.path().join("b-0007.svg")).unwrap();
    let before = files(folder.path());
    run(&["--all", "-o", "b.svg"]).code(4).stdout("").stderr(predicate::str::contains("b-0007"));
    assert_eq!(files(folder.path()), before);
}

#[test]
fn what_is_wrong_is_said_in_one_line_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(fixtures().join(TILE), folder.path().join("tile.gcode")).unwrap();
    fs::write(folder.path().join("empty.gcode"), "; nothing\nG28\nG1 X5 F3000\n").unwrap();
    let before = files(folder.path());
    let fails = |words: &[&str], code, says: &str| {
        let run = slicer(&folder).arg("preview").args(words).assert().code(code).stdout("");
        let one_line = predicate::function(|text: &str| text.lines().count() == 1);
        run.stderr(predicate::str::contains(says)).stderr(one_line);
        assert_eq!(files(folder.path()), before, "{words:?}");
    };
    let out = ["tile.gcode", "-o", "a.svg"];
    let with = |more: &[&'static str]| [&out[..], more].concat();
    fails(&["empty.gcode", "-o", "a.svg"], 3, "empty.gcode: nothing is printed in it");
    fails(&["no.gcode", "-o", "a.svg"], 3, "no.gcode: cannot read");
    fails(&with(&["--layer", "9"]), 2, "--layer 9: tile.gcode has 8 layers; choose 1 to 8");
    fails(&with(&["--layer", "0"]), 2, "--layer 0");
    fails(&with(&["--cut", "x=99"]), 2, "--cut x=99: nothing is printed there");
    fails(&with(&["--cut", "z=1"]), 2, "it must be x=MM or y=MM");
    fails(&with(&["--crop", "90,90,95,95"]), 2, "--crop: nothing of tile.gcode");
    fails(&with(&["--crop", "90,90,90,95"]), 2, "its sides must be 0.1 to 10000 mm");
    fails(&with(&["--cut", "x=0", "--layer", "2"]), 2, "cannot be used with");
    fails(&["tile.gcode", "-o", "a.gif"], 2, "use .svg, .png or .html, or say --format");
    fails(&["tile.gcode", "-o", "no/a.svg"], 4, "there is no directory no");
    fails(&["tile.gcode", "-o", "-", "--format", "svg", "--all"], 2, "--all writes a file");
    fails(&["tile.gcode", "-o", "tile.gcode", "--format", "png"], 2, "would replace");
}

#[test]
fn the_layer_that_is_drawn_by_itself_shows_the_infill_of_its_pair() {
    let print = print(&bracket());
    let drawing = drawn(&print, layer::middle(&print) + 1, 1200);
    assert_eq!(drawing.title, "layer 60 of 120, z 12 mm, height 0.2 mm");
}

#[test]
fn files_of_nonsense_are_drawn_or_refused() {
    let lines = ["G1 X1e38 Y5 E1", "G1 X1 Y1 E1e30", "G1 X2 Y1 E2e30", "G1 Z1e9", "G1 X3 Y9 E3e30"];
    let text = lines.join("\n");
    let print = print(&text);
    for number in 1..=print.layers.len() {
        let drawing = drawn(&print, number, 400);
        assert!(!svg::write(&drawing).contains("inf"));
        png::write(&drawing).unwrap();
    }
    for axis in [Axis::X, Axis::Y] {
        let plane = Plane { axis, at: 1.5 };
        let cut = Cut::new(&print, plane);
        if !cut.sections.is_empty() {
            png::write(&cut.drawing(plane, cut.frame(), 400)).unwrap();
        }
    }
}

/// The pictures of the README, by the commands that fixtures/README.md gives.
///
/// `UPDATE_GOLDEN=1 cargo test --test commands preview` rewrites them, as in prints/golden.rs.
#[test]
fn the_pictures_of_the_readme_are_as_kept() {
    let folder = tempfile::tempdir().unwrap();
    let model = fixtures().join("bracket.stl");
    let words = ["--dual", "-q", "-o", "bracket.gcode"];
    slicer(&folder).arg(model).args(words).assert().success();
    crate::skins::wedge(&folder);
    let flat = ["-q", "-o", "flat.gcode"];
    slicer(&folder).arg(fixtures().join("wedge.stl")).args(flat).assert().success();
    for (name, file, words) in [
        ("bracket-layer-13.svg", "bracket.gcode", "--layer 13"),
        ("bracket-layer-14.svg", "bracket.gcode", "--layer 14"),
        ("bracket-cut.svg", "bracket.gcode", "--cut x=0 --crop 3,0,15.5,7"),
        ("wedge-cut-flat.svg", "flat.gcode", "--cut y=0.1 --crop -12.5,0,0.5,3.4"),
        ("wedge-cut.svg", "wedge.gcode", "--cut y=0.1 --crop -12.5,0,0.5,3.4"),
    ] {
        let readme = fs::read_to_string(fixtures().join("README.md")).unwrap();
        assert!(readme.contains(&format!("preview {file} {words} -o {name}")), "{words}");
        let words = words.split(' ').chain(["-q", "-o", name]);
        slicer(&folder).args(["preview", file]).args(words).assert().success();
        let made = fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(made.len() < 150_000);
        let path = fixtures().join("pictures").join(name);
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            fs::write(&path, &made).unwrap();
            continue;
        }
        assert!(fs::read_to_string(&path).unwrap_or_default() == made, "{name} differs");
    }
    assert!(std::env::var_os("UPDATE_GOLDEN").is_none(), "look at the pictures, and unset it");
}

/// What the cones of different eyes make of linear red, green and blue: G. M. Machado et al.,
/// "A Physiologically-based Model for Simulation of Color Vision Deficiency" (2009), severity 1.
const EYES: [[[f64; 3]; 3]; 4] = [
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
];

fn times(matrix: &[[f64; 3]; 3], [a, b, c]: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * a + row[1] * b + row[2] * c)
}

/// In CIELAB, as an eye sees it.
fn seen(Colour(bytes): Colour, eye: &[[f64; 3]; 3]) -> [f64; 3] {
    let linear = bytes.map(|byte| {
        let part = f64::from(byte) / 255.0;
        if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
    });
    let light = times(eye, linear).map(|part| part.clamp(0.0, 1.0));
    let xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
    let [x, y, z] = times(&xyz, light);
    let root = |t: f64| if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 };
    let [x, y, z] = [root(x / 0.9505), root(y), root(z / 1.089)];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[test]
fn colours_are_told_apart_by_all_eyes() {
    let roles = &Role::ALL[..7];
    let shades = roles.iter().flat_map(|role| [(*role, false), (*role, true)]);
    // Neither ironing nor non-planar skin is ever printed for several layers.
    let never = [(Role::Ironing, true), (Role::NonPlanar, true)];
    let shades = shades.filter(|shade| !never.contains(shade));
    let colours: Vec<_> = shades.map(|(role, thick)| Colour::of(role, thick)).collect();
    for eye in &EYES {
        for (k, a) in colours.iter().enumerate() {
            for b in &colours[..k] {
                let (p, q) = (seen(*a, eye), seen(*b, eye));
                let apart = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
                assert!(apart >= 17.0, "{} and {}: {apart:.1}", a.hex(), b.hex());
            }
        }
    }
}
