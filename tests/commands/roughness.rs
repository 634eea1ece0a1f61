//! `slicer roughness` -> exit codes, text and JSON, of a small wedge that is printed flat.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::{Solid, rectangle};
use crate::common::{as_it_is, settings, slice_with};
use assert_cmd::Command;
use boon::{Compiler, Schemas};
use serde_json::Value;
use slicer::mesh::Placement;
use std::fs;
use tempfile::TempDir;

/// The rise of the wedge's top along x.
const RISE: f64 = 0.2;

/// 12 × 6 mm, from 2 mm up.
fn wedge() -> Solid {
    let level = Solid::prism(&rectangle([0.0, 0.0], [12.0, 6.0]), 0.0, 2.0);
    level.map(|[x, y, z]| [x, y, if z > 1.0 { z + RISE * x } else { z }])
}

/// The wedge, and prints of it: in the middle of the bed, and elsewhere.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("wedge.stl"), wedge().stl()).unwrap();
    let level = Solid::cuboid([0.0, 0.0, 0.0], [12.0, 6.0, 9.0]);
    fs::write(path.join("block.stl"), level.stl()).unwrap();
    let away = Placement { at: Some([41.3, 52.9]), ..as_it_is() };
    for (name, placement) in [("flat.gcode", as_it_is()), ("away.gcode", away)] {
        let run = slice_with(&wedge().stl(), settings("generic-marlin", &[]), &placement);
        fs::write(path.join(name), run.text).unwrap();
    }
    folder
}

/// Exit code, standard output and standard error.
fn roughness(folder: &TempDir, words: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    let output = command.current_dir(folder.path()).arg("roughness").args(words).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

#[test]
fn a_flat_print_of_a_wedge_is_as_rough_as_its_steps() {
    let folder = folder();
    let (code, out, err) =
        roughness(&folder, &["flat.gcode", "--against", "wedge.stl", "--lc", "2.5", "--json"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let found: Value = serde_json::from_str(&out).unwrap();
    let ra = 1000.0 * 0.2 * RISE.atan().cos() / 4.0;
    let whole = &found["whole"];
    for kind in ["unfiltered", "filtered"] {
        // A wedge so small has ends and corners where no line fits.
        for (key, expected) in [("ra_um", ra), ("sa_um", ra), ("rq_um", ra * 1.1547)] {
            let value = whole[kind][key].as_f64().unwrap();
            assert!((value - expected).abs() < 0.05 * expected, "{kind} {key}: {value}");
        }
    }
    assert!(whole["coverage"].as_f64().unwrap() > 0.98, "{whole}");
    assert!(whole["mean_um"].as_f64().unwrap().abs() < 5.0, "{whole}");
    assert_eq!(found["moved_mm"], serde_json::json!([0.0, 0.0]));
    let patch = &found["patches"][0];
    assert_eq!((patch["low_mm"][2].as_f64().unwrap() * 10.0).round(), 20.0, "{patch}");
    assert_eq!(patch["direction_deg"].as_f64().unwrap().round(), 0.0);
    // What is printed elsewhere is found there, and is the same print.
    let words = ["away.gcode", "--against", "wedge.stl", "--lc", "2.5", "--json"];
    let away: Value = serde_json::from_str(&roughness(&folder, &words).1).unwrap();
    let moved = away["moved_mm"].as_array().unwrap();
    assert!(moved.iter().all(|by| by.as_f64().unwrap().abs() > 5.0), "{moved:?}");
    let both = [&found, &away].map(|one| one["whole"]["filtered"]["ra_um"].as_f64().unwrap());
    assert!((both[0] - both[1]).abs() < 0.5, "{both:?}");
    // The schema says what JSON holds.
    let schema: Value = serde_json::from_str(&roughness(&folder, &["--schema"]).1).unwrap();
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("schema.json", schema).unwrap();
    let index = compiler.compile("schema.json", &mut schemas).unwrap();
    schemas.validate(&found, index).unwrap();
    let mut wrong = found.clone();
    wrong["whole"]["coverage"] = "much".into();
    assert!(schemas.validate(&wrong, index).is_err());
}

#[test]
fn the_table_has_units_and_the_same_values_for_any_number_of_threads() {
    let folder = folder();
    let (code, out, err) = roughness(&folder, &["away.gcode", "--against", "wedge.stl"]);
    assert_eq!((code, err.as_str()), (0, ""));
    for words in ["µm", "mm²", "Gauss 8 mm", "5° to 15°", "patch 1", "from where it was expected"]
    {
        assert!(out.contains(words), "{words}:\n{out}");
    }
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    command.current_dir(folder.path()).env("RAYON_NUM_THREADS", "1");
    let alone = command.args(["roughness", "away.gcode", "--against", "wedge.stl"]).output();
    assert_eq!(String::from_utf8(alone.unwrap().stdout).unwrap(), out);
}

#[test]
fn wrong_arguments_and_files_are_one_line() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("travels.gcode"), "G28\nG1 X10 Y10 Z5 F3000\n").unwrap();
    // A part that has no top.
    let needle =
        Solid::cone(3.0, 40.0, 16).map(|[x, y, z]| [x, y, if z > 1.0 { z + 40.0 * x } else { z }]);
    fs::write(path.join("needle.stl"), needle.stl()).unwrap();
    for (words, code, says) in [
        (&["travels.gcode", "--against", "wedge.stl"][..], 3, "travels.gcode: no move in it"),
        (&["none.gcode", "--against", "wedge.stl"], 3, "none.gcode: "),
        (&["flat.gcode", "--against", "none.stl"], 3, "none.stl: "),
        (&["flat.gcode", "--against", "needle.stl"], 3, "flat.gcode: no face of the model"),
        (&["flat.gcode", "--against", "block.stl"], 3, "flat.gcode: no plastic lies near"),
        (&["flat.gcode", "--against", "wedge.stl", "--rotate", "0,0,180"], 3, "does not fit"),
        (&["flat.gcode", "--against", "wedge.stl", "--lc", "0"], 2, "0.01 to 100"),
        (&["flat.gcode"], 2, "--against"),
    ] {
        let (found, out, err) = roughness(&folder, words);
        assert_eq!((found, out.as_str()), (code, ""), "{words:?}: {err}");
        assert!(err.starts_with("error: ") && err.contains(says), "{words:?}: {err}");
        assert_eq!(err.lines().count(), 1, "{err}");
    }
}
