//! `slicer check` -> exit codes, text and JSON, as a user or a script sees them; files of other slicers' form.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::{Solid, rectangle};
use crate::common::{fixtures, slice};
use assert_cmd::Command;
use slicer::check::finding::Code;
use std::fmt::Write as _;
use std::fs;
use std::sync::LazyLock;
use tempfile::TempDir;

static CUBE: LazyLock<String> =
    LazyLock::new(|| slice(&crate::common::fixture("cube_20.stl"), "generic-marlin", &[]).text);

/// The cube with a line of its top missing and a command that Marlin does not know.
fn faulty() -> String {
    let mut lines: Vec<&str> = CUBE.lines().collect();
    let top = lines.iter().rposition(|line| *line == ";TYPE:Top solid infill").unwrap();
    let long = |line: &str| line.contains(" E") && line.contains(" F");
    let at = top + lines[top..].iter().position(|line| long(line)).unwrap();
    let (travel, rest) = lines[at].split_once(" E").unwrap();
    let (e, feed) = rest.split_once(' ').unwrap();
    let text = format!("{travel} {feed}\nG92 E{e}");
    lines[at] = &text;
    format!("G161 Z F100\n{}\n", lines.join("\n"))
}

/// A folder with the cube, good and with faults.
pub(super) fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("good.gcode"), CUBE.as_str()).unwrap();
    fs::write(path.join("bad.gcode"), faulty()).unwrap();
    fs::copy(fixtures().join("cube_20.stl"), path.join("cube.stl")).unwrap();
    folder
}

/// Exit code, standard output and standard error.
pub(super) fn check(folder: &TempDir, words: &[&str], stdin: &[u8]) -> (i32, String, String) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    command.current_dir(folder.path()).arg("check").args(words).write_stdin(stdin);
    let output = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

#[test]
fn exit_codes_tell_clean_from_faulty_from_unreadable() {
    let folder = folder();
    let (code, out, err) = check(&folder, &["good.gcode", "--against", "cube.stl"], b"");
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    let is_clean = out.starts_with("good.gcode: clean") && out.contains(" in 100 layers and ");
    assert!(is_clean && out.contains("against cube.stl"), "{out}");
    let (code, out, err) = check(&folder, &["bad.gcode", "--against", "cube.stl"], b"");
    assert_eq!((code, err.as_str()), (1, ""), "{out}");
    let (code, out, _) = check(&folder, &["-", "-p", "generic-marlin"], CUBE.as_bytes());
    assert_eq!(code, 0, "{out}");
    assert!(out.contains("judged by the profile generic-marlin"), "{out}");
    assert!(out.contains("not judged: size, outline, surfaces"), "{out}");
    // Another machine: its bed is smaller and has its middle at 0.
    let (code, out, _) = check(&folder, &["good.gcode", "-p", "zcube-dual"], b"");
    assert!(code == 1 && out.contains("\noutside-volume: line "), "{out}");
}

#[test]
fn wrong_arguments_and_files_are_one_line() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("empty.gcode"), "").unwrap();
    fs::write(path.join("travels.gcode"), "G28\nG1 X10 Y10 Z5 F3000\nG1 X20\n").unwrap();
    let noise = (0..5000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8);
    fs::write(path.join("noise.gcode"), noise.collect::<Vec<u8>>()).unwrap();
    for (words, code, says) in [
        (&["empty.gcode"][..], 3, "empty.gcode: no move in it prints a line"),
        (&["travels.gcode"], 3, "travels.gcode: no move in it prints a line"),
        (&["noise.gcode"], 3, "noise.gcode: no move in it prints a line"),
        (&["cube.stl"], 2, "cube.stl: an STL is a model"),
        (&["none.gcode"], 3, "none.gcode: "),
        (&["good.gcode", "--against", "none.stl"], 3, "none.stl: "),
        (&["good.gcode", "--against", "good.gcode"], 3, "good.gcode: "),
        (&["good.gcode", "-p", "none"], 2, "unknown profile `none`"),
        (&["good.gcode", "-p", "thesis", "--set", "wals=2"], 2, "did you mean `walls`?"),
        (&["good.gcode", "--agianst", "cube.stl"], 2, "'--against'"),
        (&[], 2, "<FILE>"),
    ] {
        let (found, out, err) = check(&folder, words, b"");
        assert_eq!((found, out.as_str()), (code, ""), "{words:?}: {err}");
        assert!(err.starts_with("error: ") && err.contains(says), "{words:?}: {err}");
        assert_eq!(err.lines().count(), 1, "{words:?}: {err}");
    }
    let (code, _, err) = check(&folder, &["-"], b"");
    assert!(code == 3 && err.contains("no move in it prints a line"), "{err}");
}

#[test]
fn a_head_is_told_by_name_or_by_its_keys() {
    let folder = folder();
    for words in [
        &["good.gcode", "--head", "v6"][..],
        &["good.gcode", "--set", "head.cone=3"],
        &["good.gcode", "--head", "long-0.6", "--set", "head.discs=[[5,2]]"],
        &["good.gcode", "-p", "generic-marlin", "--head", "v6"],
    ] {
        let (code, out, err) = check(&folder, words, b"");
        assert_eq!((code, err.as_str()), (0, ""), "{words:?} {out}");
    }
    for (words, text) in [
        (["--head", "mk8"], "invalid value 'mk8' for '--head <NAME>'"),
        (["--set", "head.cone=90"], "--set: head.cone = 90 is out of range"),
        (["--set", "head.disc=3"], "--set: unknown key `head.disc`; did you mean `head.discs`?"),
        // What is no part of the head still wants a profile.
        (["--set", "walls=3"], "--set changes a profile; name one with -p, too"),
    ] {
        let (code, out, err) = check(&folder, &["good.gcode", words[0], words[1]], b"");
        assert_eq!((code, out.as_str()), (2, ""), "{err}");
        assert!(err.starts_with(&format!("error: {text}")) && err.lines().count() == 1, "{err}");
    }
}

#[test]
fn text_has_a_line_for_each_finding_with_its_place_and_measure() {
    let folder = folder();
    let (_, out, _) = check(&folder, &["bad.gcode", "--against", "cube.stl"], b"");
    let lines: Vec<&str> = out.lines().filter(|line| !line.starts_with("warning: ")).collect();
    assert!(lines[0].starts_with("bad.gcode: 2 findings"), "{out}");
    assert!(lines[0].contains(" in 100 layers and "), "{out}");
    assert_eq!(lines[1], "unknown-code: line 1: Marlin does not know G161");
    let form = r"^open-surface: layer 100 at 20 mm, x \S+ y \S+: \S+ mm² of a top or bottom";
    assert!(regex_lite::Regex::new(form).unwrap().is_match(lines[2]), "{out}");
    assert!(lines[3].starts_with("measured: outline printed 100.00 %"), "{out}");
    assert_eq!(lines.len(), 4, "{out}");

    // Of many of a kind the first are shown.
    let many = CUBE.replace("F1620", "F12000000");
    let (code, out, _) = check(&folder, &["-"], many.as_bytes());
    assert_eq!(code, 1);
    assert_eq!(out.matches("\ntoo-fast: line ").count(), 5, "{out}");
    assert!(out.contains("too-fast: and ") && out.contains(" more (--json lists them)"), "{out}");
}

#[test]
fn json_is_stable() {
    let folder = folder();
    let words = ["bad.gcode", "--against", "cube.stl", "--json"];
    let (code, out, err) = check(&folder, &words, b"");
    assert_eq!((code, err.as_str()), (1, ""));
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&json["schema"], &json["layers"]), (&1.into(), &100.into()));
    assert_eq!(json["counts"][0]["code"], "unknown-code");
    let errors = |list: &str, is_error: fn(&serde_json::Value) -> bool| {
        let list = json[list].as_array().unwrap().iter();
        list.filter(|one| is_error(one)).cloned().collect::<Vec<_>>()
    };
    let counts = errors("counts", |one| one["errors"] != 0);
    assert_eq!(counts[1], serde_json::json!({"code": "open-surface", "count": 1, "errors": 1}));
    let findings = errors("findings", |one| one["severity"] == "error");
    assert_eq!((&findings[0]["line"], &findings[0]["code"]), (&1.into(), &"unknown-code".into()));
    let surface = &findings[1];
    assert_eq!((&surface["layer"], &surface["z_mm"]), (&100.into(), &20.0.into()));
    assert!((130.0..170.0).contains(&surface["at_mm"][0].as_f64().unwrap()));
    assert!((3.0..15.0).contains(&surface["measure"].as_f64().unwrap()), "{surface}");
    assert_eq!(surface["unit"], "mm²");
    assert!(surface.get("line").is_none() && surface["text"].is_string());
    assert!(json["not_judged"].as_array().unwrap().is_empty());
    for key in ["outline", "surface", "solid", "infill"] {
        assert!((0.1..1.1).contains(&json["measures"][key].as_f64().unwrap()), "{key}: {out}");
    }
    let (again, bad) =
        (check(&folder, &words, b"").1, check(&folder, &["bad.gcode", "--json"], b"").1);
    assert_eq!(again, out);
    let json: serde_json::Value = serde_json::from_str(&bad).unwrap();
    assert!(json["measures"]["outline"].is_null() && json["not_judged"].is_array());

    let (code, out, _) = check(&folder, &["good.gcode", "--json"], b"");
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    let findings = json["findings"].as_array().unwrap();
    assert!(code == 0 && findings.iter().all(|one| one["severity"] == "warning"), "{out}");
    let names = "unknown-code missing-number not-homed outside-volume through-print head-hits changes-the-machine wrong-temperature \
                 cold-extrusion left-on too-fast too-many-steps too-much-flow unpaired-retraction odd-bead falling-z in-the-air floating unanchored \
                 printed-twice uncovered-skin double-skin overfilled underfilled narrow-bead slender-support loose-infill \
                 wrong-sums wrong-marks wrong-size open-outline open-surface outside-part wrong-infill wrong-volume";
    assert_eq!(Code::ALL.map(Code::name).join(" "), names);
}

#[test]
fn limits_that_change_in_the_print_and_long_waits_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let middle = CUBE.match_indices(";LAYER_CHANGE").nth(50).unwrap().0;
    let judged = |line: &str| {
        let text = format!("{}{line}\n{}", &CUBE[..middle], &CUBE[middle..]);
        fs::write(folder.path().join("one.gcode"), text).unwrap();
        check(&folder, &["one.gcode"], b"")
    };
    let number = CUBE[..middle].lines().count() + 1;
    for (line, is_error, told) in [
        ("M203 X1", true, "the highest speed of x is set to 1 mm/s in the print: it crawls"),
        (
            "M204 S90000",
            true,
            "the acceleration is set to 90000 mm/s² in the print, where the machine does",
        ),
        (
            "M205 X3",
            false,
            "the jerk of x is set to 3 mm/s in the print, which the file's settings do not ask for",
        ),
        ("G4 S3600", false, "the nozzle stands still for 3600 s in the print"),
    ] {
        let (code, out, _) = judged(line);
        let place = format!("changes-the-machine: line {number}, layer 50: {told}");
        assert!(out.contains(&place), "{line}: {out}");
        assert_eq!(code, i32::from(is_error), "{out}");
    }
    assert!(judged("G4 S3").1.contains(": clean"));
    // What the file's own settings ask for by role is fine.
    let keys = [
        ("acceleration.outer_wall", "700"),
        ("acceleration.travel", "900"),
        ("jerk.infill", "4"),
        ("jerk.outer_wall", "6"),
    ];
    for printer in ["generic-marlin", "prusa-mk3s", "voron-2.4", "ender-3"] {
        let made = slice(&crate::common::fixture("cube_20.stl"), printer, &keys).text;
        assert!(["M204", "SET_VELOCITY"].iter().any(|word| made.contains(word)), "{printer}");
        fs::write(folder.path().join("one.gcode"), made).unwrap();
        let (_, out, _) = check(&folder, &["one.gcode"], b"");
        assert!(!out.contains("changes-the-machine"), "{printer}: {out}");
    }
}

#[test]
fn our_file_without_a_comment_is_judged_but_for_what_it_primes() {
    let folder = tempfile::tempdir().unwrap();
    let made = slice(&crate::common::fixture("cube_20.stl"), "prusa-mk3s", &[]).text;
    let code = |line: &str| line.split(';').next().unwrap_or_default().trim_end().to_owned() + "\n";
    let bare: String = made.lines().filter(|line| !line.starts_with(';')).map(code).collect();
    fs::write(folder.path().join("bare.gcode"), &bare).unwrap();
    let (code, out, _) = check(&folder, &["bare.gcode", "-p", "prusa-mk3s"], b"");
    assert!(code == 0 && out.starts_with("bare.gcode: clean"), "{out}");
}

/// How a slicer writes a file.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// `;TYPE:`, `;WIDTH:` and `;HEIGHT:` comments, and E of each move.
    Prusa,
    /// `;LAYER:` and `;TYPE:WALL-OUTER`, and E from the start.
    Cura,
    /// Nothing but code.
    Bare,
}

/// Lines are so wide and high, mm.
const WIDTH: f64 = 0.4;
const HEIGHT: f64 = 0.2;

/// Writes moves in a form.
struct Writer {
    form: Form,
    text: String,
    at: [f64; 2],
    e: f64,
}

impl Writer {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn kind(&mut self, prusa: &str, cura: &str) {
        match self.form {
            Form::Prusa => writeln!(self.text, ";TYPE:{prusa}\n;WIDTH:{WIDTH}").unwrap(),
            Form::Cura => writeln!(self.text, ";TYPE:{cura}").unwrap(),
            Form::Bare => {}
        }
    }

    fn travel(&mut self, [x, y]: [f64; 2]) {
        writeln!(self.text, "G0 X{x:.3} Y{y:.3} F6000").unwrap();
        self.at = [x, y];
    }

    fn print(&mut self, [x, y]: [f64; 2]) {
        let area = std::f64::consts::PI * 1.75 * 1.75 / 4.0;
        let e = (x - self.at[0]).hypot(y - self.at[1]) * WIDTH * HEIGHT / area;
        self.e = if self.form == Form::Prusa { e } else { self.e + e };
        writeln!(self.text, "G1 X{x:.3} Y{y:.3} E{:.5} F1800", self.e).unwrap();
        self.at = [x, y];
    }

    /// A closed square around 100, 100 whose middle line is `half` from there.
    fn square(&mut self, half: f64) {
        let corner = |x: f64, y: f64| [100.0 + x * half, 100.0 + y * half];
        self.travel(corner(-1.0, -1.0));
        for [x, y] in [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            self.print(corner(x, y));
        }
    }
}

/// Half the tower's side, mm.
const HALF: f64 = 6.0;

/// A square tower of five layers: two walls, a solid bottom and top, and nothing between.
fn tower(form: Form) -> String {
    let mut writer = Writer { form, text: String::new(), at: [0.0; 2], e: 0.0 };
    let head = if form == Form::Prusa { "M83" } else { "M82\nG92 E0" };
    writer.line(&format!("G21\nG90\n{head}\nM104 S200\nM109 S200\nG28"));
    for layer in 0..5 {
        let z = HEIGHT * f64::from(layer + 1);
        match form {
            Form::Prusa => writer.line(&format!(";LAYER_CHANGE\n;Z:{z:.1}\n;HEIGHT:{HEIGHT}")),
            Form::Cura => writer.line(&format!(";LAYER:{layer}")),
            Form::Bare => {}
        }
        writer.line(&format!("G0 Z{z:.3} F600"));
        writer.kind("Perimeter", "WALL-INNER");
        writer.square(HALF - 1.5 * WIDTH);
        writer.kind("External perimeter", "WALL-OUTER");
        writer.square(HALF - 0.5 * WIDTH);
        if [0, 4].contains(&layer) {
            writer.kind("Solid infill", "SKIN");
            // Lines on both sides of the middle, up to the walls.
            let end = HALF - 2.5 * WIDTH;
            let lines = ((2.0 * end) / WIDTH).round() as usize;
            for k in 0..=lines {
                let y = 100.0 - end + k as f64 * WIDTH;
                let side = if k % 2 == 0 { end } else { -end };
                writer.travel([100.0 - side, y]);
                writer.print([100.0 + side, y]);
            }
        }
    }
    writer.line("M104 S0\nM84");
    writer.text
}

#[test]
fn files_of_other_form_are_judged_as_far_as_they_tell() {
    let folder = tempfile::tempdir().unwrap();
    let low = [-HALF; 2];
    let stl = Solid::prism(&rectangle(low, [HALF; 2]), 0.0, 5.0 * HEIGHT).stl();
    fs::write(folder.path().join("tower.stl"), stl).unwrap();
    let (volume, roles, widths) = (
        "not judged: volume, commands",
        "not judged: what lines are for",
        "not judged: the plastic of",
    );
    for (form, listed) in [
        (Form::Prusa, &[volume][..]),
        (Form::Cura, &[volume, widths]),
        (Form::Bare, &[volume, roles, widths]),
    ] {
        let text = tower(form);
        let (code, out, err) =
            check(&folder, &["-", "--against", "tower.stl", "--at", "100,100"], text.as_bytes());
        assert_eq!((code, err.as_str()), (0, ""), "{out}");
        assert!(
            out.contains(": clean in 5 layers and ") && out.contains("without a profile"),
            "{out}"
        );
        let not: Vec<&str> = out.lines().filter(|line| line.starts_with("not judged: ")).collect();
        let fits = not.iter().zip(listed).all(|(line, start)| line.starts_with(start));
        assert!(fits && not.len() == listed.len(), "{out}");

        // With a profile all of the machine is judged, wherever the model is put.
        let words = ["-", "--against", "tower.stl", "-p", "generic-marlin"];
        let (code, out, _) = check(&folder, &words, text.as_bytes());
        assert!(code == 0 && !out.contains(volume), "{out}");
        assert!(
            out.contains("where on the bed the part lies: its middle is at x 100 y 100"),
            "{out}"
        );

        // A wall less, and a line of the top less.
        let without = |line: &str, again: usize| {
            let lines: Vec<&str> = text.lines().collect();
            let at = lines.iter().rposition(|l| l.starts_with(line)).unwrap() - again;
            let removed = lines[at].split(" E").next().unwrap().to_owned();
            let e = lines[at].split(" E").nth(1).unwrap().split(' ').next().unwrap();
            let set_e = if form == Form::Prusa { String::new() } else { format!("\nG92 E{e}") };
            let mut lines: Vec<String> = lines.into_iter().map(str::to_owned).collect();
            lines[at] = removed + &set_e;
            lines.join("\n") + "\n"
        };
        let words = ["-", "--against", "tower.stl", "--at", "100,100"];
        let (code, out, _) = check(&folder, &words, without("G1 X94.200 Y105.800", 0).as_bytes());
        assert!(code == 1 && out.contains("open-outline: layer 5 at 1 mm"), "{out}");
        let (code, out, _) = check(&folder, &words, without("M104 S0", 5).as_bytes());
        assert!(code == 1 && out.contains("open-surface: layer 5 at 1 mm"), "{out}");
    }
}

#[test]
fn lines_as_wide_as_no_machine_take_no_time() {
    let text =
        ";LAYER_CHANGE\n;TYPE:Perimeter\nG1 Z0.2\nG1 X1 Y1 E1\nG1 X900000000 E2\nG1 Y90000000 E3\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wide.gcode");
    std::fs::write(&path, text).unwrap();
    let mut command = assert_cmd::Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    let run = command.arg("check").arg(&path).args(["--against", "fixtures/cube_20.stl"]);
    let run = run.timeout(std::time::Duration::from_secs(20)).assert().code(1);
    let told = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(told.contains("mm apart, further than on any machine"), "{told}");
}

/// A square tower whose outer wall begins on each layer by rising from the one below over 8 mm, and ends by
/// fading over that: a scarf seam, as Orca writes it. `flow` is what a line gets in the middle of a side.
fn scarfed(flow: f64) -> String {
    let area = std::f64::consts::PI * 1.75 * 1.75 / 4.0;
    let mut text = "G90\nM83\nM104 S210\nM109 S210\nG28\n".to_owned();
    let line = |text: &mut String, from: [f64; 2], to: [f64; 3], part: f64| {
        let e = (to[0] - from[0]).hypot(to[1] - from[1]) * WIDTH * HEIGHT * part / area;
        writeln!(text, "G1 X{:.3} Y{:.3} Z{:.3} E{e:.5} F1500", to[0], to[1], to[2]).unwrap();
        [to[0], to[1]]
    };
    for layer in 1..=10 {
        let (low, z) = (HEIGHT * f64::from(layer - 1), HEIGHT * f64::from(layer));
        writeln!(
            text,
            ";LAYER_CHANGE\n;Z:{z:.3}\n;HEIGHT:{HEIGHT}\n;TYPE:Outer wall\n;WIDTH:{WIDTH}"
        )
        .unwrap();
        let (mut at, y) = ([100.0, 90.0], 90.0);
        let start = if layer == 1 { z } else { low };
        writeln!(text, "G1 Z{:.3} F600\nG1 X100 Y{y} F6000\nG1 Z{start:.3} F600", z + 0.4).unwrap();
        for k in (1..=10).filter(|_| layer > 1) {
            let part = f64::from(k) / 10.0;
            at = line(&mut text, at, [100.0 + 8.0 * part, y, low + HEIGHT * part], part - 0.05);
        }
        let part = if layer == 5 { flow } else { 1.0 };
        for ([x, y], part) in
            [([110.0, y], 1.0), ([110.0, 110.0], part), ([90.0, 110.0], 1.0), ([90.0, y], 1.0)]
        {
            at = line(&mut text, at, [x, y, z], part);
        }
        at = line(&mut text, at, [100.0, y, z], 1.0);
        for k in (1..=10).filter(|_| layer > 1) {
            let part = f64::from(k) / 10.0;
            at = line(&mut text, at, [100.0 + 8.0 * part, y, z], 1.05 - part);
        }
    }
    text + "M104 S0\nM84\n"
}

#[test]
fn scarf_seams_of_other_slicers_are_no_fault() {
    let folder = tempfile::tempdir().unwrap();
    for words in [&["-"][..], &["-", "--head", "v6"], &["-", "-p", "generic-marlin"]] {
        let (code, out, _) = check(&folder, words, scarfed(1.0).as_bytes());
        assert!(code == 0 && out.contains(": clean in 10 layers and "), "{words:?} {out}");
        let (code, out, _) = check(&folder, words, scarfed(0.3).as_bytes());
        assert!(code == 1 && out.contains("\nodd-bead: line "), "{words:?} {out}");
        assert!(out.contains(": 1 finding "), "{words:?} {out}");
    }
}

/// The thesis's machine lays 1.2 times the plastic that a box of a line's size holds, on flat skins and others.
#[test]
fn skins_are_held_against_the_factors_of_their_settings() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    let words = ["--nonplanar", "--head", "long-0.6", "-q", "-o", "wedge.gcode"];
    command.current_dir(folder.path()).arg(fixtures().join("wedge.stl")).args(words);
    command.assert().success();
    let (code, out, _) = check(&folder, &["wedge.gcode"], b"");
    assert!(code == 0 && out.contains("wedge.gcode: clean"), "{out}");
    // The same plastic is too much by settings that ask for less.
    let text = fs::read_to_string(folder.path().join("wedge.gcode")).unwrap();
    let less =
        text.replace("; extrusion.skin_factor = 0.04\n", "; extrusion.skin_factor = 0.025\n");
    let (code, out, _) = check(&folder, &["-"], less.as_bytes());
    assert!(code == 1 && out.contains("double-skin: ") && out.contains("overfilled: "), "{out}");
}
