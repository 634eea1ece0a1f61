//! Tables of print times -> text, byte for byte what a person has looked at and kept in `fixtures/golden/`.
//!
//! The thesis's cube and bars on the clock that slicers are compared with, and what `slicer compare` says of
//! the bracket. `UPDATE_GOLDEN=1 cargo test --test prints tables` rewrites them, as in golden.rs.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::{Solid, as_it_is, fixtures, settings, slice_file};
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

/// Side, hole's side and height of the thesis's parts, mm: a cube, and bars of 27 cm³ of which F to
/// I are hollow.
const PARTS: [(&str, f64, f64, f64); 10] = [
    ("cube", 40.3222, 0.0, 40.3222),
    ("bar A", 51.9615, 0.0, 10.0),
    ("bar B", 42.4264, 0.0, 15.0),
    ("bar C", 30.0, 0.0, 30.0),
    ("bar D", 21.2132, 0.0, 60.0),
    ("bar E", 17.3205, 0.0, 90.0),
    ("bar F", 34.6410, 17.3205, 30.0),
    ("bar G", 31.8198, 10.6066, 30.0),
    ("bar H", 24.4949, 12.2474, 60.0),
    ("bar I", 20.0, 10.0, 90.0),
];

/// A square bar with a square hole.
fn bar(side: f64, hole: f64, height: f64) -> Solid {
    let square = |side: f64, low: f64, high: f64| {
        let half = side / 2.0;
        Solid::cuboid([-half, -half, low], [half, half, high])
    };
    let bar = square(side, 0.0, height);
    if hole > 0.0 { bar.and(&square(hole, 0.0, height).inside_out()) } else { bar }
}

/// Print time and filament of a part on the clock of the benches.
fn time(stl: &[u8], set: &[(&str, &str)]) -> (f64, f64) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.stl");
    fs::write(&path, stl).unwrap();
    let clock = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/bench/clock.toml");
    let settings = settings(clock.to_str().unwrap(), set);
    let (_, report) = slice_file(&path, &settings, &as_it_is()).unwrap();
    (report.time.total_s, report.filament.length_mm)
}

fn check(file: &str, made: &str) {
    let path = fixtures().join("golden").join(file);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::write(&path, made).unwrap();
        panic!("fixtures/golden/{file} is rewritten; look at it, and unset UPDATE_GOLDEN");
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == made, "fixtures/golden/{file} differs:\n{made}");
}

#[test]
fn the_thesis_parts_take_as_long_as_kept() {
    let ways: [&[(&str, &str)]; 4] = [
        &[("walls", "1")],
        &[("walls", "1"), ("dual.mode", "pair")],
        &[("walls", "1"), ("dual.mode", "interlaced")],
        &[
            ("walls", "1"),
            ("dual.mode", "pair"),
            ("dual.parts", "infill,support,inner-walls,inner-skin"),
        ],
    ];
    let mut table = String::from(
        "seconds, mm of filament\npart         plain        --dual    interlaced     all parts\n",
    );
    for (name, side, hole, height) in PARTS {
        let stl = bar(side, hole, height).stl();
        write!(table, "{name:<6}").unwrap();
        for way in ways {
            let (seconds, filament) = time(&stl, way);
            write!(table, " {seconds:>6.0} {filament:>6.0}").unwrap();
        }
        table.push('\n');
    }
    check("thesis-times.txt", &table);
}

#[test]
fn compare_says_of_the_bracket_what_is_kept() {
    let mut command = assert_cmd::Command::cargo_bin("slicer").unwrap();
    command.arg("compare").arg(fixtures().join("bracket.stl")).args(["-p", "generic-marlin"]);
    command.args(["--layer-height", "0.1", "--support", "--min-layer-time", "0"]);
    let out = command.assert().success().get_output().stdout.clone();
    check("bracket-compare.txt", &String::from_utf8(out).unwrap());
}
