//! `slicer check` in CI -> several files at once, warnings that fail, and findings alone.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::check::{check, folder};
use serde_json::Value;
use std::fs;

#[test]
fn several_files_have_a_verdict_each_and_the_highest_exit_code() {
    let folder = folder();
    let (code, out, err) = check(&folder, &["good.gcode", "bad.gcode"], b"");
    assert_eq!((code, err.as_str()), (1, ""), "{out}");
    let lines: Vec<&str> = out.lines().collect();
    assert!(lines[0].starts_with("good.gcode: clean"), "{out}");
    assert!(lines.iter().any(|line| line.starts_with("bad.gcode: 1 finding")), "{out}");
    assert!(lines.contains(&"bad.gcode: unknown-code: line 1: Marlin does not know G161"), "{out}");
    // One that cannot be read keeps no other from being judged.
    let (code, out, err) = check(&folder, &["nix.gcode", "good.gcode"], b"");
    assert!(code == 3 && err.starts_with("error: nix.gcode: "), "{err}");
    assert!(out.starts_with("nix.gcode: not judged\ngood.gcode: clean"), "{out}");
    let (code, _, err) = check(&folder, &["-", "-"], b"");
    assert!(code == 2 && err.contains("given twice"), "{err}");
    let (code, _, err) = check(&folder, &["-", "--against", "-"], b"");
    assert!(code == 2 && err.contains("given twice"), "{err}");
    let (code, _, err) = check(&folder, &["good.gcode", "bad.gcode", "--against", "-"], b"");
    assert!(code == 2 && err.contains("is read once"), "{err}");
}

#[test]
fn json_of_several_files_has_an_object_on_each_line() {
    let folder = folder();
    let words = ["good.gcode", "nix.gcode", "bad.gcode", "--json"];
    let (code, out, _) = check(&folder, &words, b"");
    let rows: Vec<Value> = out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((code, rows.len()), (3, 3));
    let names: Vec<_> = rows.iter().map(|row| row["file"].as_str().unwrap()).collect();
    assert_eq!(names, ["good.gcode", "nix.gcode", "bad.gcode"]);
    assert_eq!(rows[1]["error"]["code"], "unreadable");
    assert_eq!(rows[1]["exit_code"], 3);
    // Each is as it is alone.
    let alone: Value =
        serde_json::from_str(&check(&folder, &["bad.gcode", "--json"], b"").1).unwrap();
    assert_eq!(rows[2], alone);
}

#[test]
fn quiet_leaves_findings_and_strict_counts_warnings() {
    let folder = folder();
    let (code, out, err) = check(&folder, &["good.gcode", "bad.gcode", "-q"], b"");
    assert_eq!((code, err.as_str()), (1, ""));
    assert!(out.lines().all(|line| line.starts_with("bad.gcode: ")), "{out}");
    assert!(out.contains("unknown-code") && !out.contains("measured"), "{out}");
    assert_eq!(check(&folder, &["good.gcode", "-q"], b""), (0, String::new(), String::new()));
    // A part that hangs is a weak place, and no more.
    let part = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/overhang.stl");
    super::run::slicer(&folder).args([part, "-q", "-o", "weak.gcode"]).assert().success();
    let (code, out, _) = check(&folder, &["weak.gcode"], b"");
    assert!(code == 0 && out.contains("\nwarning: "), "{out}");
    assert_eq!(check(&folder, &["weak.gcode", "--strict"], b"").0, 1);
    assert_eq!(
        check(&folder, &["good.gcode", "--strict", "-q"], b""),
        (0, String::new(), String::new())
    );
    // Errors come first, whatever their kinds.
    let weak = fs::read_to_string(folder.path().join("weak.gcode")).unwrap();
    let at = weak.find(";LAYER_CHANGE").unwrap();
    let hot = format!("{}M104 S0\n{}", &weak[..at], &weak[at..]);
    fs::write(folder.path().join("both.gcode"), hot.replace(" F1620", " F99999")).unwrap();
    let (_, out, _) = check(&folder, &["both.gcode", "-q"], b"");
    let first = out.lines().position(|line| line.contains(": warning: ")).unwrap();
    assert!(first > 0 && out.lines().skip(first).all(|line| line.contains(": warning: ")), "{out}");
}

#[test]
fn a_plate_held_against_one_part_is_answered() {
    let folder = folder();
    let words = [
        "cube.stl",
        "-q",
        "-p",
        "generic-marlin",
        "--scale",
        "0.3",
        "--copies",
        "2",
        "-o",
        "two.gcode",
    ];
    super::run::slicer(&folder).args(words).assert().success();
    let (code, out, _) =
        check(&folder, &["two.gcode", "--against", "cube.stl", "--scale", "0.3"], b"");
    assert!(code == 1 && out.contains("wrong-size"), "{out}");
    assert!(out.contains("note: a file of several parts") && out.contains("--copies"), "{out}");
    let both = ["two.gcode", "--against", "cube.stl", "--scale", "0.3", "--copies", "2"];
    let (code, out, _) = check(&folder, &both, b"");
    assert!(code == 0 && !out.contains("note: "), "{out}");
}

#[test]
fn known_codes_are_listed_and_do_not_count() {
    let folder = folder();
    let (code, out, _) = check(&folder, &["bad.gcode", "--allow", "unknown-code,left-on"], b"");
    assert!(code == 0 && out.starts_with("bad.gcode: clean (1 allowed) in "), "{out}");
    assert!(out.contains("\nallowed: unknown-code: line 1: Marlin does not know G161\n"), "{out}");
    let words = ["bad.gcode", "--json", "--strict", "--allow", "unknown-code"];
    let (code, out, _) = check(&folder, &words, b"");
    let row: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, &row["allowed"]), (0, &serde_json::json!(["unknown-code"])));
    assert_eq!(row["counts"][0]["code"], "unknown-code");
    let (code, _, _) = check(&folder, &["bad.gcode", "--allow", "left-on"], b"");
    assert_eq!(code, 1);
    // Warnings with --strict.
    let part = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/overhang.stl");
    let job = [part, "-q", "-p", "ender-3", "-o", "weak.gcode"];
    super::run::slicer(&folder).args(job).assert().success();
    let (code, out, _) = check(&folder, &["weak.gcode", "--strict", "--json"], b"");
    let row: Value = serde_json::from_str(&out).unwrap();
    let counts = row["counts"].as_array().unwrap();
    let codes: Vec<&str> = counts.iter().map(|one| one["code"].as_str().unwrap()).collect();
    assert!(code == 1 && !codes.is_empty());
    let words = ["weak.gcode", "--strict", "--allow", &codes.join(",")];
    let (code, out, _) = check(&folder, &words, b"");
    assert!(code == 0 && out.contains("\nallowed: "), "{out}");
    let (code, _, err) = check(&folder, &["good.gcode", "--allow", "unkown-code"], b"");
    assert!(code == 2 && err.contains("did you mean `unknown-code`?"), "{err}");
    let (code, _, err) = check(&folder, &["good.gcode", "--allow", "anchor"], b"");
    assert!(code == 2 && err.contains("did you mean `unanchored`?"), "{err}");
}

#[test]
fn a_model_among_the_files_is_told_where_it_goes() {
    let folder = folder();
    let words = ["good.gcode", "--against", "cube.stl", "cube.stl"];
    let (code, _, err) = check(&folder, &words, b"");
    let says = "error: cube.stl: an STL is a model: repeat --against before each\n";
    assert_eq!((code, err.as_str()), (2, says));
    let (code, _, err) = check(&folder, &["cube.stl"], b"");
    assert!(code == 2 && err.contains("give the model after --against"), "{err}");
}

#[test]
fn an_end_block_that_drags_the_nozzle_over_the_print_is_seen() {
    let folder = folder();
    let aside = "G1 X{min_x} Y{min_y} F6000\nG1 X{max_x} Y{max_y}\nM104 S0\nM140 S0\n";
    let run = |block: &str| {
        let block = format!("machine.end_gcode={block}");
        let job = ["cube.stl", "-q", "-p", "ender-3", "--set", &block, "-o", "end.gcode"];
        let told = super::run::slicer(&folder).args(job).output().unwrap();
        let told = String::from_utf8(told.stderr).unwrap();
        (told, check(&folder, &["end.gcode"], b""))
    };
    let (told, (code, out, _)) = run(aside);
    let says =
        "warning: cube.stl: machine.end_gcode, line 1 of it: `G1 X{min_x} Y{min_y} F6000` drags";
    assert!(told.starts_with(says), "{told}");
    assert!(code == 0 && out.contains("\nwarning: through-print: line "), "{out}");
    assert!(out.contains("mm of the finished print: nothing lifts it before"), "{out}");
    let (told, (code, out, _)) = run(&format!("G1 Z{{park_z}} F600\n{aside}"));
    assert!(told.is_empty() && code == 0 && out.starts_with("end.gcode: clean in"), "{told}{out}");
}
