//! `slicer mesh` and `--mesh` -> exit codes, text, JSON and mended files, as a user or a script sees them.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Bytes before the first triangle of a binary STL, and of each triangle.
const HEADER: usize = 84;
const RECORD: usize = 50;

/// A binary STL of some of the cube's triangles, each as it is or turned.
fn cube(kept: impl Fn(usize) -> bool, turned: impl Fn(usize) -> bool) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/cube_20.stl");
    let bytes = fs::read(path).unwrap();
    let mut out = bytes[..HEADER].to_vec();
    let mut count = 0_u32;
    for (k, record) in bytes[HEADER..].chunks(RECORD).enumerate().filter(|(k, _)| kept(*k)) {
        let mut record = record.to_vec();
        if turned(k) {
            // The second and the third corner change places.
            let second = record[24..36].to_vec();
            record.copy_within(36..48, 24);
            record[36..48].copy_from_slice(&second);
        }
        out.extend(record);
        count += 1;
    }
    out[80..HEADER].copy_from_slice(&count.to_le_bytes());
    out
}

/// A folder with the cube: sound, with a hole, inside out, and one face alone beside nothing.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: Vec<u8>| fs::write(folder.path().join(name), bytes).unwrap();
    write("sound.stl", cube(|_| true, |_| false));
    write("hole.stl", cube(|k| k != 5, |_| false));
    write("inverted.stl", cube(|_| true, |_| true));
    write("turned.stl", cube(|_| true, |k| k == 3));
    folder
}

/// Exit code, standard output and standard error.
fn run(folder: &TempDir, words: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    let output = command.current_dir(folder.path()).args(words).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

fn json(folder: &TempDir, file: &str) -> Value {
    let (code, out, err) = run(folder, &["mesh", file, "--json"]);
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    serde_json::from_str(&out).unwrap()
}

#[test]
fn a_sound_mesh_has_no_faults() {
    let folder = folder();
    let (code, out, err) = run(&folder, &["mesh", "sound.stl"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let expected = "sound.stl: binary STL; mended: 12 triangles, 1 shell, 20.000 x 20.000 x 20.000 mm, \
                    8000.0 mm³ (solid: 8000.0 mm³)\nno faults\n";
    assert_eq!(out, expected);
    let told = json(&folder, "sound.stl");
    for list in ["found", "mended", "left", "seen"] {
        assert_eq!(told[list], Value::Array(Vec::new()), "{list}");
    }
}

#[test]
fn faults_are_told_with_counts_and_places() {
    let folder = folder();
    for (file, fault, count, deed, deeds) in [
        ("hole.stl", "open-edge", 3, "filled-hole", 1),
        ("inverted.stl", "inverted-shell", 1, "turned-shell", 1),
        ("turned.stl", "flipped-edge", 3, "turned", 1),
    ] {
        let told = json(&folder, file);
        let [found, mended] = [("found", fault), ("mended", deed)].map(|(list, kind)| {
            let all = told[list].as_array().unwrap();
            all.iter().find(|one| one["kind"] == kind).unwrap_or_else(|| panic!("{told}"))
        });
        assert_eq!((&found["count"], &mended["count"]), (&count.into(), &deeds.into()), "{file}");
        assert_eq!(found["places"][0].as_array().unwrap().len(), 3);
        assert_eq!(told["left"], Value::Array(Vec::new()), "{file}");
        assert!((told["volume_mm3"].as_f64().unwrap() - 8000.0).abs() < 1e-6, "{file}");
        assert!((told["solid_mm3"].as_f64().unwrap() - 8000.0).abs() < 1.0, "{file}");
    }
}

#[test]
fn the_mended_mesh_is_sound_and_the_same_each_time() {
    let folder = folder();
    for file in ["hole.stl", "inverted.stl", "turned.stl"] {
        let (code, out, _) = run(&folder, &["mesh", file, "-o", "mended.stl"]);
        assert_eq!(code, 0, "{out}");
        let first = fs::read(folder.path().join("mended.stl")).unwrap();
        assert_eq!(first.len(), HEADER + 12 * RECORD, "{file}");
        let (code, out, _) = run(&folder, &["mesh", "mended.stl", "-o", "again.stl"]);
        assert!(code == 0 && out.ends_with("no faults\n"), "{file}: {out}");
        assert_eq!(first, fs::read(folder.path().join("again.stl")).unwrap(), "{file}");
    }
    let (code, out, err) = run(&folder, &["mesh", "sound.stl", "-o", "sound.stl"]);
    assert_eq!((code, out.as_str()), (2, ""));
    assert!(err.contains("would replace"), "{err}");
}

#[test]
fn the_policy_decides_what_becomes_of_a_hole() {
    let folder = folder();
    let sliced = |policy: &str, file: &str| {
        let _ = fs::remove_file(folder.path().join("o.gcode"));
        let (code, _, err) =
            run(&folder, &[file, "-q", "-p", "zcube-dual", "--mesh", policy, "-o", "o.gcode"]);
        (code, err, fs::read_to_string(folder.path().join("o.gcode")).ok())
    };
    let sound = sliced("strict", "sound.stl");
    assert_eq!((sound.0, sound.1.as_str()), (0, ""));
    for file in ["hole.stl", "inverted.stl", "turned.stl"] {
        let (code, err, text) = sliced("repair", file);
        assert_eq!(code, 0, "{err}");
        let moves = |text: &Option<String>| -> Vec<String> {
            let lines = text.as_deref().unwrap().lines();
            lines.filter(|line| line.starts_with('G')).map(str::to_owned).collect()
        };
        assert!(moves(&text) == moves(&sound.2), "{file} is not the sound cube");
        assert_eq!(err.contains("the mesh was mended: 1 hole filled"), file == "hole.stl", "{err}");
        let (code, err, text) = sliced("strict", file);
        assert_eq!((code, text), (3, None), "{err}");
        assert!(err.starts_with(&format!("error: {file}: the mesh has faults: ")), "{err}");
        assert_eq!(err.lines().count(), 1, "{err}");
    }
    let (code, err, _) = sliced("warn", "hole.stl");
    assert!(code == 0 && err.contains("the mesh is not closed"), "{err}");
}

#[test]
fn metres_and_centimetres_are_units() {
    let folder = folder();
    for (unit, scale) in [("cm", "0.1"), ("m", "0.001")] {
        let plain = ["sound.stl", "-q", "-p", "zcube-dual", "-o", "-"];
        let words = [&plain[..], &["--unit", unit, "--scale", scale]].concat();
        let (code, out, err) = run(&folder, &words);
        assert_eq!((code, err.as_str()), (0, ""));
        let (_, plain, _) = run(&folder, &plain);
        assert!(out == plain, "{unit}");
    }
}
