//! Runs of a farm -> their logs: every line of error and warning names the file that it is about.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::failures::{body, write_stl};
use super::run::{folder, slicer};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// A folder with a cube, a body that hangs over another one, and a body with a part that begins in the air.
fn plate() -> TempDir {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    write_stl(&path("gap.stl"), &(body(10.0, 0.0, 2.0) + &body(10.0, 5.0, 8.0)));
    let high = body(4.0, 5.0, 8.0).replace("vertex ", "vertex 1");
    write_stl(&path("odd.stl"), &(body(8.0, 0.0, 8.0) + &high));
    folder
}

/// Exit code, standard error, and the report.
fn run(folder: &TempDir, words: &[&str]) -> (i32, String, Value) {
    let always = ["-q", "-p", "generic-marlin", "-o", "a.gcode", "--report", "a.json"];
    let run = slicer(folder).args(words).args(always).output().unwrap();
    let report = fs::read(folder.path().join("a.json")).unwrap();
    let told = String::from_utf8(run.stderr).unwrap();
    (run.status.code().unwrap(), told, serde_json::from_slice(&report).unwrap())
}

#[test]
fn an_error_of_a_job_names_the_model() {
    let folder = plate();
    for (words, starts, file) in [
        (&["gap.stl"] as &[&str], "error: gap.stl: nothing is printed on layers", Some("gap.stl")),
        (&["odd.stl"], "error: odd.stl: a body begins in the air", Some("odd.stl")),
        // Of several models that whose box holds the place.
        (&["cube.stl", "odd.stl"], "error: odd.stl: a body begins in the air", Some("odd.stl")),
        (&["odd.stl", "cube.stl"], "error: odd.stl: a body begins in the air", Some("odd.stl")),
        // Without a place it is about all of them.
        (
            &["cube.stl", "odd.stl", "--scale", "0.001"],
            "error: cube.stl, odd.stl: nothing to",
            None,
        ),
        (
            &["cube.stl", "--copies", "999"],
            "error: cube.stl: 999 models with gaps",
            Some("cube.stl"),
        ),
    ] {
        let (code, told, report) = run(&folder, words);
        assert_eq!((code, told.lines().count()), (3, 1), "{told}");
        assert!(told.starts_with(starts), "{words:?}: {told}");
        assert_eq!(report["error"]["file"].as_str(), file, "{words:?}");
    }
}

#[test]
fn a_warning_of_a_job_names_the_model() {
    let folder = plate();
    let slow = ["--set", "speed.skin=1", "--scale", "0.3"];
    for (models, starts) in [
        (&["cube.stl"] as &[&str], "warning: cube.stl: speed.skin = 1"),
        (&["cube.stl", "cube.stl"], "warning: cube.stl, cube.stl: speed.skin = 1"),
    ] {
        let (code, told, _) = run(&folder, &[models, &slow as &[&str], &["--strict"]].concat());
        let lines: Vec<&str> = told.lines().collect();
        assert_eq!((code, lines.len()), (1, 2), "{told}");
        assert!(lines[0].starts_with(starts), "{told}");
        assert!(lines[1].starts_with("error: cube.stl"), "{told}");
    }
    let warn = ["cube.stl", "odd.stl", "--set", "floating=warn"];
    let (code, told, _) = run(&folder, &warn);
    assert_eq!(code, 0, "{told}");
    let air = told.lines().find(|line| line.contains("begin in the air")).unwrap();
    assert!(air.starts_with("warning: odd.stl: "), "{told}");
}

#[test]
fn the_report_tells_where_each_model_lies() {
    let folder = plate();
    let words = ["cube.stl", "--copies", "2", "--at", "60,70", "--scale", "0.2"];
    for (raft, low) in [(false, 0.0), (true, 0.5)] {
        let raft: &[&str] = if raft { &["--raft"] } else { &[] };
        let (code, told, report) = run(&folder, &[&words, raft].concat());
        assert_eq!(code, 0, "{told}");
        let bodies = report["models"][0]["bodies"].as_array().unwrap();
        assert_eq!(bodies.len(), 2);
        let side = |of: usize, axis: usize| {
            let [a, b] = ["min_mm", "max_mm"].map(|end| bodies[of][end][axis].as_f64().unwrap());
            (a, b)
        };
        // Both lie about the place that was asked for, and are as large as the cube.
        let middle = |axis| {
            (side(0, axis).0.min(side(1, axis).0) + side(0, axis).1.max(side(1, axis).1)) / 2.0
        };
        assert!((middle(0) - 60.0).abs() < 1e-3 && (middle(1) - 70.0).abs() < 1e-3, "{bodies:?}");
        for (of, axis) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)] {
            let (a, b) = side(of, axis);
            assert!((b - a - 4.0).abs() < 1e-3, "{bodies:?}");
        }
        assert!(side(0, 2).0 >= low, "{bodies:?}");
    }
}

#[test]
fn summary_and_notes_name_the_model() {
    let folder = plate();
    let job = ["cube.stl", "-p", "ender-3", "--material", "abs", "-o", "a.gcode"];
    let run = slicer(&folder).args(job).output().unwrap();
    let told = String::from_utf8(run.stderr).unwrap();
    assert!(told.contains("cube.stl: printer ender-3, material abs, print standard\n"), "{told}");
    let mut notes = told.lines().filter(|line| line.starts_with("note: "));
    assert!(notes.all(|line| line.starts_with("note: cube.stl: ")), "{told}");
}

#[test]
fn wide_places_that_are_slower_are_a_note_and_no_warning() {
    let folder = plate();
    for (printer, print) in [
        ("voron-2.4", "standard"),
        ("voron-2.4", "strong"),
        ("prusa-mk3s", "draft"),
        ("prusa-mk4", "draft"),
    ] {
        let job = ["cube.stl", "-p", printer, "--print", print, "--strict", "-o", "a.gcode"];
        let run = slicer(&folder).args(job).args(["--report", "a.json"]).output().unwrap();
        let told = String::from_utf8(run.stderr).unwrap();
        assert!(run.status.success() && !told.contains("warning"), "{printer} {print}: {told}");
        let report: Value =
            serde_json::from_slice(&fs::read(folder.path().join("a.json")).unwrap()).unwrap();
        let slowed = report["flow"]["slowed"].as_array().unwrap();
        let has_note = told.contains("note: cube.stl: wide places of ");
        assert_eq!(has_note, !slowed.is_empty(), "{printer} {print}: {told}");
    }
    // Lines of the usual size are too fast.
    let fast =
        ["--set", "speed.infill=300", "--set", "limits.speed_x=500", "--set", "limits.speed_y=500"];
    let job = ["cube.stl", "-q", "-p", "ender-3", "-o", "a.gcode"];
    let run = slicer(&folder).args(job).args(fast).output().unwrap();
    let told = String::from_utf8(run.stderr).unwrap();
    assert!(told.contains("warning: cube.stl: infill: slowed down from 300 "), "{told}");
}
