//! Any bytes -> nothing: what has to hold whatever a file holds. For `tests/hostile/main.rs` and `tests/fuzz/`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use slicer::Job;
use slicer::check::{self, Model, terms::Terms};
use slicer::diff::{Side, Tolerances, diff};
use slicer::error::Error;
use slicer::estimate::{self, estimate};
use slicer::geom::{Contour, double_area, polygon};
use slicer::mesh::{Mesh, Placement, edges, place, read};
use slicer::motion::Limits;
use slicer::preview::{layer, svg};
use slicer::profile::{self, Override, Settings, ValueOrigin};
use slicer::progress::Progress;
use slicer::reader::Print;
use slicer::slice::{Heights, Slicer};
use slicer::steps;
use std::cell::RefCell;

/// Triangles and layers, at most, so that a case is quick.
const MOST_TRIANGLES: usize = 3_000;
const MOST_HEIGHT_MM: f64 = 12.0;

/// A refusal is one line, short enough to be read, with an exit code that is documented.
fn is_good_refusal(error: &Error, code: u8, names: &str) {
    let text = error.to_string();
    assert!(!text.contains(char::is_control), "{text:?}");
    assert!(text.contains(names) || names.is_empty(), "{text:?} does not name {names}");
    assert!(text.chars().count() < 600, "{text:?}");
    assert_eq!(error.exit_code(), code, "{text}");
}

fn settings(set: &[(&str, &str)]) -> Settings {
    let with = |&(key, value): &(&str, &str)| Override {
        key: key.to_owned(),
        value: value.to_owned(),
        origin: ValueOrigin::Set,
    };
    let overrides: Vec<Override> = set.iter().map(with).collect();
    profile::load(["generic-marlin"], &overrides).unwrap().settings
}

/// Bytes of a model are refused, or sliced into G-code that this program's own reader knows.
pub(crate) fn stl(bytes: &[u8]) {
    let model = match read::from_bytes("x.stl", bytes, MOST_TRIANGLES) {
        Ok(model) => model,
        Err(error) => return is_good_refusal(&error.into(), 3, "x.stl: "),
    };
    let settings =
        settings(&[("layer_height", "0.2"), ("support.enabled", "true"), ("dual.mode", "pair")]);
    let placement = Placement { max_triangles: MOST_TRIANGLES, ..Placement::default() };
    let bed = slicer::bed(&settings.machine);
    let placed = match place::place(vec![model], &placement, &bed) {
        Ok(placed) => placed,
        Err(error) => return is_good_refusal(&error.into(), 3, ""),
    };
    if placed.size_mm[2] > MOST_HEIGHT_MM || placed.size_mm[0].max(placed.size_mm[1]) > 60.0 {
        return;
    }
    let job = Job {
        models: vec![slicer::Model::path("x.stl")],
        placement,
        settings,
        sources: slicer::profile::Sources::default(),
    };
    let mut out = std::io::Cursor::new(Vec::new());
    match slicer::slice_placed(&job, &placed, &mut out, &Progress::default()) {
        Ok(report) => assert!(report.filament.length_mm.is_finite()),
        Err(error) => return is_good_refusal(&error, 3, ""),
    }
    let text = String::from_utf8(out.into_inner()).unwrap();
    is_plain_gcode(&text);
    let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
    assert_eq!(print.summary.unknown, 0, "line {}", print.summary.first_unknown);
    assert!(print.lines().next().is_some(), "no line is printed");
    let terms = Terms::new(Some(&job.settings), Some(&job.settings), &print);
    let model = Model { mesh: &placed.mesh, offset: placed.offset };
    drop(check::check(&print, &terms, Some(model)));
}

/// Every word of the moves is a letter and a finite number.
fn is_plain_gcode(text: &str) {
    for line in text.lines().filter(|line| line.starts_with("G0 ") || line.starts_with("G1 ")) {
        let code = line.split(';').next().unwrap_or_default();
        for word in code.split_whitespace().skip(1) {
            let number: Option<f64> = word.get(1..).and_then(|number| number.parse().ok());
            assert!(number.is_some_and(f64::is_finite), "{line}");
        }
    }
}

/// A text is refused as a profile, or gives settings that their own dump gives again.
pub(crate) fn profile(text: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, text).unwrap();
    let name = path.to_str().unwrap();
    match profile::load([name], &[]) {
        Ok(loaded) => {
            let dumped = profile::dump(&loaded.settings);
            let again = profile::recorded(&dumped).unwrap().unwrap();
            assert_eq!(profile::dump(&again.settings), dumped);
        }
        // Of this file, or of one beside it that it inherits from.
        Err(error) => is_good_refusal(&error.into(), 2, folder.path().to_str().unwrap()),
    }
}

/// Settings are refused in a line, or give settings that their own dump gives again, and a small part
/// is sliced by them, or refused.
pub(crate) fn set(pairs: &[(String, String)]) {
    let with = |(key, value): &(String, String)| Override {
        key: key.clone(),
        value: value.clone(),
        origin: ValueOrigin::Set,
    };
    let overrides: Vec<Override> = pairs.iter().map(with).collect();
    let settings = match profile::load(["generic-marlin"], &overrides) {
        Ok(loaded) => loaded.settings,
        Err(error) => return is_good_refusal(&error.into(), 2, ""),
    };
    let dumped = profile::dump(&settings);
    let again = profile::recorded(&dumped).unwrap().unwrap();
    assert_eq!(profile::dump(&again.settings), dumped);
    let job = Job {
        models: vec![slicer::Model::Bytes { name: "x.stl".to_owned(), bytes: small().into() }],
        placement: Placement::default(),
        settings,
        sources: slicer::profile::Sources::default(),
    };
    let mut out = std::io::Cursor::new(Vec::new());
    match slicer::slice(&job, &mut out, &Progress::default()) {
        Ok(report) => assert!(report.filament.length_mm.is_finite()),
        Err(error) => return assert!(!error.to_string().contains('\n'), "{error}"),
    }
    let text = String::from_utf8(out.into_inner()).unwrap();
    let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
    assert!(print.lines().next().is_some(), "no line is printed");
}

/// A block of 3 by 3 by 1 mm, as an STL file.
fn small() -> Vec<u8> {
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2].map(|one| one as f32);
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut bytes = vec![0; 80];
    bytes.extend(12_u32.to_le_bytes());
    for [a, b, c, d] in faces {
        for triangle in [[a, b, c], [a, c, d]] {
            bytes.extend([0; 12]);
            for [x, y, z] in triangle.map(corner) {
                bytes.extend([3.0 * x, 3.0 * y, z].map(f32::to_le_bytes).concat());
            }
            bytes.extend([0; 2]);
        }
    }
    bytes
}

/// Bytes are read as G-code, timed, checked, compared with themselves and drawn.
pub(crate) fn gcode(bytes: &[u8]) {
    let settings = settings(&[]);
    let print = Print::read(&mut &*bytes, 1.75).unwrap();
    drop(check::check(&print, &Terms::new(Some(&settings), None, &print), None));
    let options = estimate::Options { filament_diameter: 1.75, ..estimate::Options::default() };
    let time = || estimate(&mut &*bytes, "x.gcode", &Limits::new(&settings), options);
    let (a, b) = match (time(), time()) {
        (Ok(a), Ok(b)) => (a, b),
        (Err(error), _) | (_, Err(error)) => {
            return is_good_refusal(&error.into(), 3, "x.gcode");
        }
    };
    assert!(a.seconds.is_finite() && a.seconds >= 0.0, "{}", a.seconds);
    let index = layer::middle(&print);
    let frame = layer::frame(&print, &print.layers);
    if !frame.is_empty() {
        let options = layer::Options { size: 400, below: 1, travels: true, frame };
        drop(svg::write(&layer::drawing(&print, index, &options)));
    }
    let [a, b] = [a, b].map(|time| Side::of_bytes(bytes, time).unwrap());
    let tolerances = Tolerances { settings: true, ..Tolerances::default() };
    let found = diff(&a, &b, &tolerances).unwrap();
    assert!(found.equal, "a file differs from itself: {:?}", found.findings);
}

/// Takes a megabyte.
struct Little(Vec<u8>);

impl std::io::Write for Little {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if self.0.len() + bytes.len() > 1 << 20 {
            return Err(std::io::Error::other("it is full"));
        }
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Any G-code becomes a stream that plays to the end, or is refused.
pub(crate) fn steps(bytes: &[u8]) {
    let motors = [("steps.x", "8"), ("steps.y", "8"), ("steps.z", "40"), ("steps.e", "9")];
    let settings = settings(&motors);
    let (reading, form) = (slicer::reader::Reading::of(bytes), steps::Form::Steps);
    let options = steps::Options { reading, form, start: None };
    let mut out = Little(Vec::new());
    match steps::make(&mut &*bytes, "x.gcode", &settings, options, &mut out) {
        Ok(made) => {
            let played = steps::play(&mut out.0.as_slice(), "x.steps", |_| {}, |_, _| {}).unwrap();
            assert_eq!(played.totals, made.totals);
            assert!(played.findings.iter().all(|one| one.code == "beyond-switch"));
        }
        Err(steps::Failure::Reader(error)) => is_good_refusal(&error.into(), 3, "x.gcode"),
        Err(steps::Failure::Steps(error)) => is_good_refusal(&error.into(), 3, "x.gcode"),
        Err(steps::Failure::Write(_)) => assert!(out.0.len() > 1 << 19),
        Err(steps::Failure::Profile(error)) => panic!("{error}"),
    }
}

/// Any bytes as a stream of steps are refused, or played.
pub(crate) fn stream(bytes: &[u8]) {
    let (path, mut text) = (RefCell::new(None), String::new());
    let begin = |header: &steps::Header| {
        *path.borrow_mut() = Some(steps::Path::new(header, &mut String::new()));
    };
    let each = |_, item: &steps::Item| {
        if let Some(path) = path.borrow_mut().as_mut() {
            text.clear();
            path.item(item, &mut text);
        }
    };
    if let Err(error) = steps::play(&mut &*bytes, "x.steps", begin, each) {
        is_good_refusal(&error.into(), 3, "x.steps");
    }
}

/// Any triangles on the grid, open, folded and crossing, are cut into layers of contours that
/// enclose something and do not overlap.
///
/// A byte tells how many corners there are, six bytes each where it lies, three bytes what a
/// triangle's corners are.
pub(crate) fn contours(bytes: &[u8]) {
    let Some((&count, rest)) = bytes.split_first() else { return };
    let (corners, faces) = rest.split_at(rest.len().min(6 * usize::from(count)));
    let number = |two: &[u8]| i32::from(i16::from_le_bytes([two[0], two[1]]));
    let vertex = |six: &[u8]| [number(&six[..2]), number(&six[2..4]), number(&six[4..]).abs()];
    let vertices: Vec<[i32; 3]> = corners.chunks_exact(6).map(vertex).collect();
    if vertices.is_empty() {
        return;
    }
    let index = |&byte: &u8| u32::from(byte) % vertices.len() as u32;
    let triangle = |three: &[u8]| [index(&three[0]), index(&three[1]), index(&three[2])];
    let triangles: Vec<[u32; 3]> = faces.chunks_exact(3).take(400).map(triangle).collect();
    let adjacency = edges::adjacency(&vertices, &triangles);
    let mesh = Mesh { vertices, triangles };
    let heights = Heights::even(2_000, 2_000, 1 << 15);
    let slicer = Slicer::new(&mesh, &adjacency, heights, 60);
    for layer in (0..slicer.blocks()).flat_map(|block| slicer.block(block)) {
        are_apart(&layer.contours);
    }
}

/// Contours that neither cross nor overlap are what their union is, but for rounding.
fn are_apart(contours: &[Contour]) {
    let area = |contours: &[Contour]| contours.iter().map(|c| double_area(c)).sum::<i128>();
    assert!(contours.iter().all(|contour| contour.len() >= 3 && double_area(contour) != 0));
    let (once, twice) = (area(contours), area(&polygon::union(contours)));
    let around: f64 = contours.iter().map(length).sum();
    // Needles of 2 µm are rounding: the union loses some of them, a third of what simplifying may.
    let rounding = 20.0 * around + 1e4;
    assert!(once as f64 >= -rounding, "inside out: {once}");
    assert!(((once - twice) as f64).abs() <= rounding, "{once} {twice} {contours:?}");
}

fn length(contour: &Contour) -> f64 {
    let after = contour.iter().cycle().skip(1);
    contour.iter().zip(after).map(|(a, b)| (a.distance2(*b) as f64).sqrt()).sum()
}
