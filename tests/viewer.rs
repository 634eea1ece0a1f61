//! The HTML viewer: its packed moves read back by the written format, what the page is made of, and the page in a browser.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use assert_cmd::Command;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use slicer::estimate::{Options, estimate};
use slicer::motion::Limits;
use slicer::preview::{html, packed};
use slicer::reader::print::Step;
use slicer::reader::{Print, Role};
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Diameter of the filament, mm.
const FILAMENT: f64 = 1.75;

/// A file that has what is seldom: homing on the way, a prime line, thick lines, `<` in names.
const ODD: &str = "; by </script><script>alert(1)</script>\n; x = </script><!-- & \"\nG28\nG1 X-3.5 Y7 Z0.3 F6000\n\
    G1 X40 E3 F1200\n;LAYER_CHANGE\n;TYPE:Inner wall\n;WIDTH:0.45\n;HEIGHT:0.3\nG1 X50.125 Y8 E3.5\n\
    G1 E2.5 F2400\nG92 X0 Y0\nG1 X1 Y1 F9000\nG1 E3.5 F2400\n;LAYER_CHANGE\nG1 Z0.5\n;TYPE:Sparse infill\n\
    ;HEIGHT:0.4\nG1 X300.0004 Y-0.0006 E4.00004 F1234.567\n";

fn print(gcode: &[u8]) -> Print {
    Print::read(&mut &gcode[..], FILAMENT).unwrap()
}

fn page(gcode: &[u8], name: &str) -> String {
    let limits = Limits::new(&slicer::profile::load("generic-marlin", &[]).unwrap().settings);
    let options = Options { filament_diameter: FILAMENT, fixed_limits: false };
    let estimate = estimate(&mut &gcode[..], name, &limits, options).unwrap();
    let mut page = Vec::new();
    html::write(&print(gcode), &estimate, name, FILAMENT, &mut page).unwrap();
    String::from_utf8(page).unwrap()
}

/// The text of the script element with this id.
fn script<'a>(page: &'a str, id: &str) -> &'a str {
    let (_, rest) = page.split_once(&format!("id=\"{id}\">")).unwrap();
    rest.split_once("</script>").unwrap().0
}

fn slice(model: &str, words: &[&str]) -> Vec<u8> {
    let mut command = Command::cargo_bin("slicer").unwrap();
    command
        .args([model, "-q", "-o", "-"])
        .args(words)
        .assert()
        .success()
        .get_output()
        .stdout
        .clone()
}

/// A reader of the packed format that knows only what its description says.
struct Numbers<'a>(&'a [u8]);

impl Numbers<'_> {
    fn byte(&mut self) -> u8 {
        let (first, rest) = self.0.split_first().unwrap();
        self.0 = rest;
        *first
    }

    fn unsigned(&mut self) -> u64 {
        let mut value = 0;
        for place in 0.. {
            let byte = self.byte();
            value |= u64::from(byte & 0x7f) << (7 * place);
            if byte < 0x80 {
                break;
            }
        }
        value
    }

    fn signed(&mut self) -> i64 {
        let value = self.unsigned() as i64;
        if value % 2 == 0 { value / 2 } else { -(value + 1) / 2 }
    }

    fn list(&mut self, count: usize) -> Vec<i64> {
        (0..count).map(|_| self.signed()).collect()
    }

    /// Numbers that are written as differences.
    fn sums(&mut self, count: usize) -> Vec<i64> {
        let mut sum = 0;
        self.list(count).into_iter().map(|by| (sum, sum += by).0 + by).collect()
    }
}

/// A move as it is packed.
#[derive(Debug)]
struct Move {
    role: u8,
    from: [i64; 3],
    to: [i64; 3],
    filament: i64,
    feed: i64,
    width: i64,
    height: i64,
    line: i64,
}

fn unpack_block(block: &[u8]) -> Vec<Move> {
    let mut numbers = Numbers(block);
    let count = numbers.unsigned() as usize;
    let mut starts = vec![None; count];
    let mut at = 0;
    for _ in 0..numbers.unsigned() {
        at += numbers.unsigned() as usize;
        starts[at] = Some([numbers.signed(), numbers.signed(), numbers.signed()]);
    }
    let roles: Vec<u8> = (0..count).map(|_| numbers.byte()).collect();
    let ways: [Vec<i64>; 3] = std::array::from_fn(|_| numbers.list(count));
    let filament = numbers.list(count);
    let [feed, width, height, line]: [Vec<i64>; 4] = std::array::from_fn(|_| numbers.sums(count));
    assert!(numbers.0.is_empty(), "{} bytes are left", numbers.0.len());
    let mut place = [0; 3];
    let make = |k: usize| {
        let from = starts[k].unwrap_or(place);
        let to = std::array::from_fn(|axis| from[axis] + ways[axis][k]);
        place = to;
        let (filament, feed) = (filament[k], feed[k]);
        let (role, width, height, line) = (roles[k], width[k], height[k], line[k]);
        Move { role, from, to, filament, feed, width, height, line }
    };
    (0..count).map(make).collect()
}

fn unpack(page: &str) -> Vec<Vec<Move>> {
    let deflated = STANDARD.decode(script(page, "moves-data")).unwrap();
    let mut bytes = Vec::new();
    flate2::read::DeflateDecoder::new(&deflated[..]).read_to_end(&mut bytes).unwrap();
    let mut numbers = Numbers(&bytes);
    let mut blocks = Vec::new();
    while !numbers.0.is_empty() {
        let length = numbers.unsigned() as usize;
        let (block, rest) = numbers.0.split_at(length);
        numbers.0 = rest;
        blocks.push(unpack_block(block));
    }
    blocks
}

/// Within half of the unit that it is written in, and a little for the floats.
fn same(packed: i64, unit: f64, value: f32) {
    let (found, value) = (packed as f64 * unit, f64::from(value));
    assert!((found - value).abs() <= 0.5 * unit + 2e-7 * value.abs(), "{found} is not {value}");
}

fn same_move(found: &Move, step: &Step, thick: bool) {
    for axis in 0..3 {
        same(found.from[axis], 1e-3, step.from[axis]);
        same(found.to[axis], 1e-3, step.to[axis]);
    }
    same(found.filament, 1e-5, step.filament);
    same(found.feed, 1.0 / 60.0, step.feed);
    same(found.width, 1e-3, step.width);
    same(found.height, 1e-3, step.height);
    assert_eq!(found.line, i64::from(step.line));
    assert_eq!(Role::ALL[usize::from(found.role & !packed::THICK)], step.role);
    assert_eq!(found.role & packed::THICK != 0, thick, "{step:?}");
}

#[test]
fn packed_moves_are_those_of_the_file() {
    let sliced = slice("fixtures/bracket.stl", &["--dual"]);
    for gcode in [&sliced[..], ODD.as_bytes(), include_bytes!("../fixtures/clock.gcode")] {
        let (print, page) = (print(gcode), page(gcode, "a.gcode"));
        let blocks = unpack(&page);
        assert_eq!(blocks.len(), print.layers.len() + 1);
        assert_eq!(blocks[0].len(), print.start.len());
        for (found, step) in blocks[0].iter().zip(&print.moves[print.start.clone()]) {
            same_move(found, step, false);
        }
        for (layer, block) in print.layers.iter().zip(&blocks[1..]) {
            let steps = print.moves_of(layer);
            assert_eq!(block.len(), steps.len());
            for (found, step) in block.iter().zip(steps) {
                same_move(found, step, f64::from(step.height) > 1.5 * layer.height);
            }
        }
        let packed: i64 = blocks.iter().flatten().map(|one| one.filament).sum();
        let pushed: f64 = print.moves.iter().map(|step| f64::from(step.filament)).sum();
        let moves = print.moves.len() as f64;
        assert!((packed as f64 * 1e-5 - pushed).abs() < 1e-5 * moves.sqrt().max(1.0));
    }
    let thick = unpack(&page(&sliced, "a.gcode")).into_iter().flatten();
    assert!(thick.filter(|one| one.role & packed::THICK != 0).count() > 1000);
    assert!(unpack(&page(ODD.as_bytes(), "a.gcode"))[1].iter().any(|one| one.from == [0, 0, 300]));
}

#[test]
fn nothing_in_a_name_or_in_the_file_ends_an_element() {
    let name = "</script><script>alert(1)</script>\"&{{facts}}.gcode";
    let (plain, odd) = (page(ODD.as_bytes(), "a.gcode"), page(ODD.as_bytes(), name));
    let clean = page(b"G1 X9 Y9 Z0.2\nG1 X20 E1\n", "a.gcode");
    let elements =
        |page: &str| ["<script", "</script", "<!--"].map(|word| page.matches(word).count());
    assert_eq!(elements(&plain), elements(&clean));
    assert_eq!(elements(&odd), elements(&clean));
    assert!(odd.contains("<title>&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&quot;&amp;{{facts}}.gcode</title>"));
    let facts: Value = serde_json::from_str(script(&odd, "facts-json")).unwrap();
    assert_eq!(facts["name"], name);
    assert_eq!(facts["settings"][0][1], "</script><!-- & \"");
}

#[test]
fn the_page_needs_no_network_and_is_the_same_every_time() {
    let one = page(ODD.as_bytes(), "a.gcode");
    assert_eq!(one, page(ODD.as_bytes(), "a.gcode"));
    for word in ["http:", "https:", "src=", "url(", "@import", "{{"] {
        assert!(!one.contains(word), "{word} is in the page");
    }
    assert!(one.contains("default-src 'none'"));
}

#[test]
fn facts_are_those_of_the_print() {
    let facts: Value =
        serde_json::from_str(script(&page(ODD.as_bytes(), "a.gcode"), "facts-json")).unwrap();
    // The prime line before the first layer counts neither for the size nor for the scales.
    assert_eq!(facts["bounds"][0], serde_json::json!([-0.201, -0.226, 0.0]));
    assert_eq!(facts["scales"]["speed"], serde_json::json!([20.0, 20.576]));
    assert_eq!(facts["scales"]["height"], serde_json::json!([0.3, 0.4]));
    assert_eq!(facts["layers"].as_array().unwrap().len(), 2);
    assert_eq!(facts["head"], "by </script><script>alert(1)</script>");
}

#[test]
fn values_that_are_no_numbers_of_a_printer_do_no_harm() {
    for gcode in ["G1 X1e30 Y-1e30 E1e20 F1e20\nG1 X2 E-1e30\n", "G1 X1\n", "G1 X1e-9 E1e-9\n"] {
        let page = page(gcode.as_bytes(), "a.gcode");
        assert_eq!(
            unpack(&page).iter().map(Vec::len).sum::<usize>(),
            print(gcode.as_bytes()).moves.len()
        );
    }
}

#[test]
fn parts_of_the_page_are_short() {
    for entry in
        fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/preview/viewer")).unwrap()
    {
        let path = entry.unwrap().path();
        let lines = fs::read_to_string(&path).unwrap().lines().count();
        assert!(lines <= 500, "{} has {lines} lines", path.display());
    }
}

#[test]
fn the_command_writes_the_page_and_refuses_what_is_for_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("clock.html");
    let slicer = |words: &[&str]| {
        let mut command = Command::cargo_bin("slicer").unwrap();
        command.args(["preview", "fixtures/clock.gcode", "-o"]).arg(&out).args(words);
        command
    };
    slicer(&[]).assert().success().stderr("2 layers, 13 moves\n");
    let page = fs::read_to_string(&out).unwrap();
    assert!(page.contains("<title>clock.gcode</title>"));
    let refused = slicer(&["--layer", "1"]).assert().code(2);
    let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(told.starts_with("error: --layer is for pictures"), "{told}");
}

/// Chromium, if it is there.
fn chromium() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let mut paths =
        std::env::split_paths(&folders).flat_map(|folder| names.map(|name| folder.join(name)));
    paths.find(|path| path.is_file())
}

/// What the page says of itself at a place; `query` asks for a way to draw.
fn state(chromium: &Path, page: &Path, query: &str, place: &str) -> Value {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(chromium)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader"])
        .args([
            "--enable-unsafe-swiftshader",
            "--window-size=1000,700",
            "--virtual-time-budget=4000",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg("--dump-dom")
        .arg(format!("file://{}{query}#{place}", page.display()))
        .timeout(std::time::Duration::from_secs(60))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout).into_owned();
    let (_, rest) = dom
        .split_once("data-state=\"")
        .unwrap_or_else(|| panic!("the page shows nothing: {dom:.2000}"));
    let text = rest.split_once('"').unwrap().0.replace("&quot;", "\"").replace("&amp;", "&");
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_browser_shows_the_layer_the_moves_and_what_is_pointed_at() {
    let Some(chromium) = chromium() else {
        eprintln!(
            "skipped: there is no chromium in PATH; install it to test the page in a browser"
        );
        return;
    };
    let gcode = slice("fixtures/bracket.stl", &["--dual"]);
    let print = print(&gcode);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bracket.html");
    fs::write(&file, page(&gcode, "bracket.gcode")).unwrap();
    let layer = &print.layers[13];
    let steps = print.moves_of(layer);
    // The middle of the longest thick line, where no other lies over it.
    let thick = |step: &&Step| f64::from(step.height) > 1.5 * layer.height;
    let long = |a: &&Step, b: &&Step| a.length().total_cmp(&b.length());
    let line = steps.iter().filter(thick).max_by(long).unwrap();
    let [x, y] = [0, 1].map(|axis| f64::midpoint(line.from[axis].into(), line.to[axis].into()));
    let shown = steps.len() - 5;

    let place = format!("layer=14&move={shown}&colour=flow&at={x},{y}");
    for (query, painter) in [("", "WebglPainter"), ("?canvas", "CanvasPainter")] {
        let state = state(&chromium, &file, query, &place);
        assert_eq!(state["layers"], print.layers.len());
        assert_eq!((&state["layer"], &state["moves"]), (&14.into(), &steps.len().into()));
        assert_eq!((&state["move"], &state["colour"]), (&shown.into(), &"flow".into()));
        assert_eq!(state["painter"], painter);
        let tip = state["tip"].as_str().unwrap();
        let said: Vec<&str> = tip.lines().collect();
        assert_eq!(said[0], "infill, thick", "{tip}");
        assert!(said[1].ends_with("mm wide, 0.4 mm high"), "{tip}");
        assert_eq!(*said.last().unwrap(), format!("line {} of the file", line.line), "{tip}");
    }
    // Beside the part there is nothing, and no move is shown before the first.
    let empty = state(&chromium, &file, "", "layer=999&move=0&at=0,40");
    assert_eq!((&empty["layer"], &empty["move"]), (&print.layers.len().into(), &0.into()));
    assert_eq!(empty["tip"], "");
}
