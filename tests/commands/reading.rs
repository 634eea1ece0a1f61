//! By whose rules `estimate`, `check`, `diff` and `preview` read a file: `--firmware`, `-p`, the file's own
//! words.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::run::with as slicer;

/// Relative moves with E made absolute (M82): 2.8 mm of filament in Marlin 2, 7.0 mm in Klipper.
const SQUARE: &str = "M104 S210\nG28\nM109 S210\nG21\nG91\nM82\nG92 E0\nG1 Z0.2 F1000\nG1 X20 Y20 F5400\n\
    G1 X20 E0.7 F1200\nG1 Y20 E1.4\nG1 X-20 E2.1\nG1 Y-20 E2.8\n";

fn filament(words: &[&str], text: &str) -> f64 {
    let words = [&["estimate", "--json"], words].concat();
    let told = slicer(&words).write_stdin(text).assert().success();
    let json: serde_json::Value = serde_json::from_slice(&told.get_output().stdout).unwrap();
    json["filament_mm"].as_f64().unwrap()
}

#[test]
fn the_flag_counts_before_the_profile_and_both_before_the_file() {
    let of =
        |words: &[&str], text: &str| (filament(&[&["-"], words].concat(), text) * 10.0).round();
    let marlin = format!("{SQUARE};FLAVOR:Marlin\n");
    assert_eq!(of(&[], SQUARE), 70.0);
    assert_eq!(of(&[], &marlin), 28.0);
    assert_eq!(of(&["-p", "generic-marlin"], SQUARE), 28.0);
    assert_eq!(of(&["-p", "generic-klipper"], &marlin), 70.0);
    assert_eq!(of(&["-p", "generic-klipper", "--firmware", "marlin"], SQUARE), 28.0);
    assert_eq!(of(&["--firmware", "klipper"], &marlin), 70.0);
    slicer(&["estimate", "-", "--firmware", "mach9"]).write_stdin(SQUARE).assert().code(2);
}

#[test]
fn what_stands_at_the_end_of_a_long_file_counts() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.gcode");
    let text = format!("{SQUARE}{}; gcode_flavor = marlin2\n", ";\n".repeat(300_000));
    std::fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap();
    assert!((filament(&[path], "") - 2.8).abs() < 1e-6);
    let told = slicer(&["check", path]).assert().get_output().stdout.clone();
    assert!(String::from_utf8_lossy(&told).contains("read as marlin reads it"));
}

#[test]
fn what_one_file_of_two_says_counts_for_both() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let said = file("a.gcode", &format!("{SQUARE}; gcode_flavor = marlin2\n"));
    let (silent, other) =
        (file("b.gcode", SQUARE), file("c.gcode", &format!("{SQUARE}; gcode_flavor = klipper\n")));
    slicer(&["diff", &said, &silent]).assert().code(0);
    slicer(&["diff", &said, &other]).assert().code(1);
    slicer(&["diff", &said, &other, "--firmware", "marlin"]).assert().code(0);
}

#[test]
fn arcs_that_are_too_much_for_the_file_are_told() {
    let arcs = "G2 X100 Y100 I90 E1\n".repeat(300);
    let text = format!("M104 S200\nM109 S200\nM83\nG1 X100 Y100 Z0.2 F3000\n{arcs}");
    let told = slicer(&["estimate", "-", "--json"]).write_stdin(&*text).assert().success();
    let json: serde_json::Value = serde_json::from_slice(&told.get_output().stdout).unwrap();
    let (coarse, moves) = (&json["not_counted"]["coarse_arcs"], json["moves"].as_u64().unwrap());
    assert!(coarse.as_u64().unwrap() > 100 && moves < 80_000, "{coarse} {moves}");
    let told = slicer(&["check", "-"]).write_stdin(text).assert().get_output().stdout.clone();
    assert!(String::from_utf8_lossy(&told).contains("arcs go exactly (the first in line "));
}
