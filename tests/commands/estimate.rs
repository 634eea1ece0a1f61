//! `slicer estimate`: times worked out by hand, changes of limits in the file, and errors.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::run::with as slicer;
use slicer::estimate::{Estimate, Options, estimate};
use slicer::motion::{Junction, Limits};
use slicer::reader::Role;

const CLOCK: &str = "fixtures/clock.gcode";

fn limits() -> Limits {
    Limits {
        feed: [300.0; 4],
        acceleration: [1000.0; 4],
        print_acceleration: 1000.0,
        travel_acceleration: 1000.0,
        retract_acceleration: 1000.0,
        junction: Junction::Jerk([0.0; 4]),
        look_ahead: None,
        minimum_speed: 0.0,
    }
}

fn of_text(text: &str, limits: &Limits, fixed_limits: bool) -> Estimate {
    let options = Options { filament_diameter: 1.75, fixed_limits, ..Options::default() };
    estimate(&mut text.as_bytes(), "x.gcode", limits, options).unwrap()
}

/// A move from rest to rest at 1000 mm/s².
fn alone(distance: f64, feed: f64) -> f64 {
    let reached = feed.min((1000.0 * distance).sqrt());
    2.0 * reached / 1000.0 + (distance - reached * reached / 1000.0) / reached
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9 * b.max(1.0), "{a} is not {b}");
}

#[test]
fn times_by_role_and_by_layer_are_those_worked_out_by_hand() {
    let found = of_text(include_str!("../../fixtures/clock.gcode"), &limits(), false);
    let z = alone(10.0, 100.0);
    let start = z + alone(10.0, 10.0);
    let first =
        alone(9.8, 10.0) + 2.0 * alone(100.0, 50.0) + alone(100.0, 100.0) + alone(1.0, 20.0);
    let up = alone(0.2, 10.0);
    let second = up + alone(100.0, 150.0) + alone(1.0, 20.0) + alone(100.0, 50.0) + 0.5;
    // The wall from x = 10 to 110, and so on: all sides are 100 mm.
    near(found.start_seconds, start);
    assert_eq!(found.layers.len(), 2);
    near(found.layers[0].seconds, first);
    near(found.layers[1].seconds, second);
    near(found.seconds, start + first + second);
    near(found.dwell_seconds, 0.5);
    assert_eq!((found.layers[0].z_mm, found.layers[1].z_mm), (0.2, 0.4));
    let of = |role| found.roles.iter().find(|one| one.role == role).unwrap();
    near(of(Role::OuterWall).seconds, 3.0 * alone(100.0, 50.0));
    near(of(Role::Infill).seconds, alone(100.0, 100.0));
    near(of(Role::Retraction).seconds, 2.0 * alone(1.0, 20.0));
    assert_eq!(of(Role::Retraction).moves, 2);
    near(found.filament_mm, 17.0);
    near(found.peak_flow_mm3_s, 0.04 * 100.0 * std::f64::consts::PI * 1.75 * 1.75 / 4.0 * 1.0);
    let not = found.not_counted;
    assert_eq!((not.heating, not.homing, not.unknown_lines), (1, 2, 1));
    let all: f64 = found.roles.iter().map(|role| role.seconds).sum();
    near(all + found.dwell_seconds, found.seconds);
}

#[test]
fn limits_in_the_file_hold_from_there_on_unless_told_otherwise() {
    let text = "G1 X100 F6000\nM204 P500 T500\nG1 X0\nM203 X10\nM201 X100\nG1 X100";
    near(of_text(text, &limits(), true).seconds, 3.0 * 1.1);
    let changed = 1.1 + 1.2 + (10.0 + 0.1);
    near(of_text(text, &limits(), false).seconds, changed);
    let klipper = "SET_VELOCITY_LIMIT ACCEL=500 VELOCITY=50\nG1 X100 F6000";
    near(of_text(klipper, &limits(), false).seconds, 2.1);
}

#[test]
fn the_table_is_for_people_and_json_for_programs() {
    let told = slicer(&["estimate", CLOCK, "-p", "generic-marlin", "--layers"]).assert().success();
    let text = String::from_utf8(told.get_output().stdout.clone()).unwrap();
    assert!(text.starts_with("print time"), "{text}");
    for part in [
        "outer wall",
        "2 layers: ",
        "not counted: wait for heat, 2 times homing, 1 unknown line (the first is line 30)",
    ] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
    let told = slicer(&["estimate", "-", "--json"]).pipe_stdin(CLOCK).unwrap().assert().success();
    let json: serde_json::Value = serde_json::from_slice(&told.get_output().stdout).unwrap();
    assert_eq!(json["schema"], 1);
    assert_eq!(json["layers"].as_array().unwrap().len(), 2);
    assert_eq!(json["roles"][0]["role"], "outer-wall");
}

#[test]
fn the_clock_for_comparing_files_minds_corners_and_retractions_only() {
    // 100 mm/s on each axis, the last from 0 to 100 mm of z, and a retraction between the two.
    let text = "M204 P9\nG1 X100 F6000\nG1 Y100\nG1 E-1 F1200\nG1 Z100 F6000\n";
    let clock = ["estimate", "-", "-p", "tests/bench/clock.toml", "--fixed-limits", "--json"];
    let told = slicer(&clock).write_stdin(text).assert().success();
    let json: serde_json::Value = serde_json::from_slice(&told.get_output().stdout).unwrap();
    // The corner of 90° is taken at 15 / √2 mm/s: that much sooner there, on both sides.
    let corner = 15.0 / 2.0_f64.sqrt();
    let gained = corner / 1000.0 - corner * corner / 2000.0 / 100.0;
    let seconds = 3.0 * alone(100.0, 100.0) + alone(1.0, 20.0) - 2.0 * gained;
    near(json["seconds"].as_f64().unwrap(), seconds);
}

/// The file's own settings time it, and give what the summary, the report and the file's head say.
#[test]
fn a_file_of_ours_takes_as_long_by_its_own_settings_as_its_report_says() {
    let folder = tempfile::tempdir().unwrap();
    let (out, report) = (folder.path().join("a.gcode"), folder.path().join("a.json"));
    for printer in ["zcube-dual", "generic-klipper", "voron-2.4", "prusa-mk4", "witbox-1"] {
        let mut made = slicer(&["fixtures/tile.stl", "-q", "-p", printer, "-o"]);
        made.arg(&out).arg("--report").arg(&report);
        // More than the printer is set to: Klipper does as it is told.
        made.args(["--set", "machine.acceleration=2000"]);
        made.assert().success();
        let json = |bytes: &[u8]| serde_json::from_slice::<serde_json::Value>(bytes).unwrap();
        let told = &json(&std::fs::read(&report).unwrap())["time"];
        let mut estimate = slicer(&["estimate", "--json"]);
        let read = json(&estimate.arg(&out).assert().success().get_output().stdout);
        assert_eq!(read["limits"], "the file's own settings");
        let seconds = |value: &serde_json::Value| value.as_f64().unwrap();
        // The way to the first line begins where the start block ends, which only the file says.
        let read = seconds(&read["seconds"])
            - seconds(&read["start_seconds"])
            - seconds(&read["layers"][0]["seconds"])
            - seconds(&read["end_seconds"]);
        let told = seconds(&told["total_s"]) - seconds(&told["layers"][0]["time_s"]);
        assert!((read - told).abs() < 0.5, "{printer}: {read} s, {told} s told");
    }
    let mut by_profile = slicer(&["estimate", "--json", "-p", "generic-marlin"]);
    let read = by_profile.arg(&out).assert().success().get_output().stdout.clone();
    assert!(String::from_utf8(read).unwrap().contains("\"limits\": \"profile generic-marlin"));
}

/// Somebody has to go on after a pause; M0 ends a job of RepRapFirmware.
#[test]
fn pauses_are_counted_and_not_timed() {
    let pauses = |flavour: &str| {
        let text = format!("{flavour}\nG1 X9 E1 F600\nM600\nM0\nM400\nG1 X0 E2\n");
        let told = slicer(&["estimate", "-"]).write_stdin(text).assert().success();
        String::from_utf8(told.get_output().stdout.clone()).unwrap()
    };
    assert!(pauses("").contains("not counted: 2 pauses\n"), "{}", pauses(""));
    assert!(pauses("; gcode_flavor = reprapfirmware").contains("not counted: 1 pause\n"));
}

#[test]
fn a_file_takes_as_long_by_its_own_settings_as_by_its_printer() {
    // The last one retracts by itself, as far and as fast as its profile says.
    for printer in ["generic-klipper", "ultimaker-2"] {
        let words = ["fixtures/cube_20.stl", "--scale", "0.2", "-q", "-o", "-", "-p", printer];
        let text = slicer(&words).assert().success().get_output().stdout.clone();
        let seconds = |by: &[&str]| {
            let words = [&["estimate", "-", "--json"][..], by].concat();
            let told = slicer(&words).write_stdin(text.clone()).assert().success();
            let json: serde_json::Value =
                serde_json::from_slice(&told.get_output().stdout).unwrap();
            json["seconds"].as_f64().unwrap()
        };
        near(seconds(&[]), seconds(&["-p", printer]));
    }
}

#[test]
fn errors_name_the_file_the_cause_and_what_to_do() {
    for (words, code, part) in [
        (&["estimate", "no.gcode"][..], 3, "error: no.gcode: cannot read: "),
        (&["estimate", "fixtures/cube_20.stl"], 3, "there is no move in it; give a G-code file"),
        (
            &["estimate", CLOCK, "--set", "limits.jerk_x=-1"],
            2,
            "limits.jerk_x = -1 is out of range",
        ),
        (&["estimate"], 2, "see `slicer estimate --help`"),
    ] {
        let failed = slicer(words).assert().code(code);
        let text = String::from_utf8(failed.get_output().stderr.clone()).unwrap();
        assert!(text.contains(part) && text.lines().count() == 1, "{text}");
    }
    slicer(&["estimate", "-"]).write_stdin("").assert().code(3);
}

#[test]
fn what_this_program_writes_is_read_to_the_last_line() {
    for name in ["tile@zcube-dual", "tile@generic-marlin", "tile@thesis"] {
        let profile = name.split('@').nth(1).unwrap();
        let file = format!("fixtures/golden/{name}.gcode");
        let told = slicer(&["estimate", &file, "-p", profile, "--json"]).assert().success();
        let json: serde_json::Value = serde_json::from_slice(&told.get_output().stdout).unwrap();
        assert_eq!(json["not_counted"]["unknown_lines"], 0, "{file}");
        assert!(json["seconds"].as_f64().unwrap() > 1.0);
    }
}

#[test]
fn the_print_time_is_that_of_the_file_and_the_whole_is_told_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    slicer(&["fixtures/cube_20.stl", "-q", "--scale", "0.3", "-p", "ender-3", "-o"])
        .arg(at("a.gcode"))
        .arg("--report")
        .arg(at("a.json"))
        .assert()
        .success();
    let read = |name: &str| std::fs::read_to_string(at(name)).unwrap();
    let report: serde_json::Value = serde_json::from_str(&read("a.json")).unwrap();
    let told = slicer(&["estimate", "--json"]).arg(at("a.gcode")).assert().success().stderr("");
    let json: serde_json::Value = serde_json::from_slice(&told.get_output().stdout).unwrap();
    let of = |key: &str| json[key].as_f64().unwrap();
    let total = report["time"]["total_s"].as_f64().unwrap();
    // But for the way to the first line, which begins where the start block ends.
    assert!((of("print_seconds") - total).abs() < 3.0, "{} {total}", of("print_seconds"));
    near(of("print_seconds"), of("seconds") - of("start_seconds") - of("end_seconds"));
    assert!(of("seconds") > of("print_seconds") + 5.0);
    assert_eq!(json["limits_by"], "file");
    let told = slicer(&["estimate"]).arg(at("a.gcode")).assert().success();
    let text = String::from_utf8(told.get_output().stdout.clone()).unwrap();
    let whole = of("seconds").round() as u64;
    let whole = format!("\nwhole file     0:{:02}:{:02}   with ", whole / 60, whole % 60);
    assert!(text.starts_with("print time") && text.contains(&whole), "{text}");

    // Cut off before its settings.
    let text = read("a.gcode");
    std::fs::write(at("cut.gcode"), &text[..text.len() / 2]).unwrap();
    let told =
        slicer(&["estimate", "--json", "--no-user-config"]).arg(at("cut.gcode")).assert().success();
    let json: serde_json::Value = serde_json::from_slice(&told.get_output().stdout).unwrap();
    assert_eq!(json["limits_by"], "default");
    let err = String::from_utf8(told.get_output().stderr.clone()).unwrap();
    assert!(
        err.starts_with("warning: ") && err.contains("cut.gcode: the file holds no settings"),
        "{err}"
    );
    assert!(err.contains("zcube-dual") && err.lines().count() == 1, "{err}");
    let named = slicer(&["estimate", "--json", "-p", "ender-3"])
        .arg(at("cut.gcode"))
        .assert()
        .success()
        .stderr("");
    let json: serde_json::Value = serde_json::from_slice(&named.get_output().stdout).unwrap();
    assert_eq!(json["limits_by"], "profile");
}

#[test]
fn several_files_have_a_line_each() {
    let run = |words: &[&str]| {
        let run = slicer(words).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (run.status.code().unwrap(), text(run.stdout), text(run.stderr))
    };
    let (code, out, _) = run(&["estimate", CLOCK, CLOCK, "-p", "generic-marlin"]);
    let lines: Vec<&str> = out.lines().collect();
    assert_eq!((code, lines.len()), (0, 2), "{out}");
    assert!(lines.iter().all(|line| line.starts_with("fixtures/clock.gcode: print time 0:00:")));
    let words = ["estimate", CLOCK, "nix.gcode", CLOCK, "--json", "-p", "generic-marlin"];
    let (code, out, err) = run(&words);
    let rows: Vec<serde_json::Value> =
        out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((code, rows.len()), (3, 3), "{err}");
    assert_eq!((&rows[0], rows[1]["exit_code"].as_u64()), (&rows[2], Some(3)));
    assert_eq!(rows[0]["file"], CLOCK);
    let (_, alone, _) = run(&["estimate", CLOCK, "--json", "-p", "generic-marlin"]);
    let alone: serde_json::Value = serde_json::from_str(&alone).unwrap();
    assert!(alone.get("file").is_none() && alone["seconds"] == rows[0]["seconds"]);
    let (code, _, err) = run(&["estimate", CLOCK, CLOCK, "-p", "nix"]);
    assert!(code == 2 && err.lines().count() == 1, "{err}");
}
