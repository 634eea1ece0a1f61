//! `slicer steps` and `slicer play`: totals, events, the path back, refusals, and what is left behind.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::run::{folder, slicer};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

const MOTORS: [&str; 10] = [
    "-p",
    "generic-marlin",
    "--set",
    "steps.x=80",
    "--set",
    "steps.y=80",
    "--set",
    "steps.z=400",
    "--set",
    "steps.e=93",
];

const SMALL: &str = "G28\nG1 X1 Y-0.5 Z0.3 F600\nG1 X2 E1\nG1 E0\nG4 P250\n";

/// A folder with a file and its stream.
fn made(text: &str) -> TempDir {
    let folder = folder();
    fs::write(folder.path().join("a.gcode"), text).unwrap();
    let words = ["steps", "a.gcode", "-q", "-o", "a.steps"];
    slicer(&folder).args(words).args(MOTORS).assert().success().stdout("");
    folder
}

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn a_stream_is_played_with_its_totals_and_a_line_for_each_step() {
    let folder = made(SMALL);
    let told = slicer(&folder).args(["play", "a.steps", "--json", "--events", "e.txt"]).assert();
    let told = json(&told.code(1).get_output().stdout);
    assert_eq!(told["steps"], serde_json::json!({"x": 160, "y": 40, "z": 120, "e": 186}));
    assert_eq!(told["end_mm"]["x"], 2.0);
    assert_eq!(told["end_mm"]["y"], -0.5);
    assert_eq!(told["findings"][0]["code"], "beyond-switch");
    assert_eq!(told["findings"][0]["axis"], "y");
    assert_eq!(told["findings"].as_array().unwrap().len(), 1);
    assert!(told["seconds"].as_f64().unwrap() > 0.4);
    assert!(told["highest_rate"]["x"].as_f64().unwrap() > 700.0);
    let events = fs::read_to_string(folder.path().join("e.txt")).unwrap();
    let lines: Vec<Vec<&str>> = events
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(' ').collect())
        .collect();
    assert_eq!(lines.len(), 160 + 40 + 120 + 186);
    let mut at = 0_u64;
    let mut ends = [0; 4];
    for line in &lines {
        let time: u64 = line[0].parse().unwrap();
        assert!(time >= at);
        at = time;
        let axis = ["X", "Y", "Z", "E"].iter().position(|axis| *axis == line[1]).unwrap();
        ends[axis] += if line[2] == "+" { 1 } else { -1 };
        assert_eq!(line.len(), 3);
    }
    assert_eq!(ends, [160, -40, 120, 0]);
    // The dwell at the end counts.
    assert!(told["seconds"].as_f64().unwrap() >= at as f64 / 1e6 + 0.249);
}

#[test]
fn the_path_comes_back_as_moves_that_print_the_same() {
    let folder = folder();
    let slice = ["cube.stl", "-q", "-o", "a.gcode", "--set", "speed.infill=40"];
    slicer(&folder).args(slice).args(MOTORS).assert().success();
    let words = ["steps", "a.gcode", "-q", "-o", "a.steps", "--set", "steps.ramps=false"];
    slicer(&folder).args(words).args(MOTORS).assert().success();
    let play = ["play", "a.steps", "-q", "--gcode", "b.gcode"];
    // The start block primes beside the bed, which is a finding or none.
    slicer(&folder).args(play).assert().stderr("");
    // Commands to the heaters and limits of the machine are no steps, and a stream tells no roles.
    let diff =
        ["diff", "a.gcode", "b.gcode", "--tolerance", "0.00625", "--json", "-p", "generic-marlin"];
    let told = slicer(&folder).args(diff).assert();
    let told = json(&told.get_output().stdout);
    let kinds: Vec<&str> = told["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["kind"].as_str().unwrap())
        .collect();
    let about_motion = |kind: &&&str| !["heaters", "commands", "limits"].contains(*kind);
    assert_eq!(kinds.iter().filter(about_motion).count(), 0, "{kinds:?}");
    // At most two bytes a step.
    let bytes = fs::metadata(folder.path().join("a.steps")).unwrap().len();
    let played = slicer(&folder).args(["play", "a.steps", "--json"]).assert();
    let played = json(&played.get_output().stdout);
    let steps: u64 =
        ["x", "y", "z", "e"].iter().map(|axis| played["steps"][axis].as_u64().unwrap()).sum();
    assert!(bytes <= 2 * steps, "{bytes} bytes for {steps} steps");
}

#[test]
fn slicing_into_steps_is_slicing_and_then_making_steps() {
    let folder = folder();
    slicer(&folder).args(["cube.stl", "-q", "-o", "a.gcode"]).args(MOTORS).assert().success();
    let words = ["steps", "a.gcode", "-q", "-o", "a.steps"];
    slicer(&folder).args(words).args(MOTORS).assert().success();
    for threads in ["1", "2"] {
        let slice = ["cube.stl", "-q", "-o", "b.steps", "--threads", threads];
        slicer(&folder).args(slice).args(MOTORS).assert().success();
        let [a, b] = ["a.steps", "b.steps"].map(|name| fs::read(folder.path().join(name)).unwrap());
        assert!(a == b, "{threads} threads");
    }
}

#[test]
fn a_printer_without_steps_is_refused_before_anything_is_made() {
    let folder = made(SMALL);
    for words in [
        &["steps", "a.gcode", "-o", "b.steps", "-p", "generic-marlin"][..],
        &["steps", "a.gcode", "-o", "b.steps", "-p", "witbox-2"],
        &["cube.stl", "-q", "-o", "b.steps", "-p", "generic-marlin"],
    ] {
        let refused = slicer(&folder).args(words).assert().code(2).stdout("");
        let said = text(&refused.get_output().stderr);
        assert!(said.starts_with("error: steps.x is not set"), "{said}");
        assert!(!folder.path().join("b.steps").exists());
    }
    for profile in ["replicator", "witbox-1"] {
        slicer(&folder)
            .args(["steps", "a.gcode", "-o", "c.steps", "-p", profile])
            .assert()
            .success();
    }
    let mut far = slicer(&folder);
    far.args(["steps", "-", "-o", "b.steps"]).args(MOTORS);
    let far = far.write_stdin("G1 X1\nG1 Y900000000\n").assert().code(3);
    let said = text(&far.get_output().stderr);
    assert_eq!(
        said,
        "error: <stdin>: line 2: Y goes farther than steps can be counted; give a file for this machine\n"
    );
}

#[test]
fn damaged_streams_are_refused_with_their_block() {
    let long = "G1 X100 Y30 F6000\nG1 X0 Y0\n".repeat(3);
    let folder = made(&long);
    let good = fs::read(folder.path().join("a.steps")).unwrap();
    // Blocks begin after the header, and have their length in them.
    let mut blocks = vec![216];
    while let Some(at) = blocks.last().copied().filter(|at| *at < good.len()) {
        blocks.push(at + 14 + usize::from(u16::from_le_bytes([good[at + 2], good[at + 3]])));
    }
    assert!(blocks.len() > 6 && blocks.windows(2).all(|two| two[1] - two[0] <= 512));
    let block = |k: usize| good[blocks[k]..blocks[k + 1]].to_vec();
    let with = |parts: &[&[u8]]| parts.concat();
    let mut turned = good.clone();
    turned[blocks[3] + 40] ^= 4;
    let mut header = good.clone();
    header[50] ^= 1;
    let mut newer = good.clone();
    newer[8] = 2;
    let (one, rest) = good.split_at(blocks[2]);
    let cases: [(Vec<u8>, &str); 10] = [
        (good[..blocks[4] + 7].to_vec(), "block 4 is cut off"),
        (good[..blocks[4]].to_vec(), "block 4 is cut off"),
        (turned, "block 3 is damaged"),
        (with(&[one, &good[blocks[3]..]]), "block 2 is missing: block 3 is in its place"),
        (with(&[one, &block(1), rest]), "block 2 is missing: block 1 is in its place"),
        (
            with(&[one, &block(3), &block(2), &good[blocks[4]..]]),
            "block 2 is missing: block 3 is in its place",
        ),
        (with(&[&good, b"\n"]), "is the last, and more bytes follow"),
        (header, "its header is damaged"),
        (newer, "it is of version 2 of the format, and this program knows version 1"),
        (b"G1 X1\n".to_vec(), "it is no stream of steps"),
    ];
    for (bytes, why) in cases {
        fs::write(folder.path().join("b.steps"), bytes).unwrap();
        let play = ["play", "b.steps", "--json", "--events", "e.txt", "--gcode", "g.gcode"];
        let refused = slicer(&folder).args(play).assert().code(3).stdout("");
        let said = text(&refused.get_output().stderr);
        assert!(said.starts_with("error: b.steps: ") && said.contains(why), "{said} is not {why}");
        assert_eq!(said.lines().count(), 1);
        assert!(!folder.path().join("e.txt").exists() && !folder.path().join("g.gcode").exists());
    }
    slicer(&folder)
        .args(["play", "-", "-q"])
        .write_stdin(good)
        .assert()
        .success()
        .stdout("")
        .stderr("");
}

#[test]
fn what_a_stream_cannot_hold_is_refused_with_its_line() {
    let cases = [
        ("G1 X1 F600\nG10\nG11\n", "a.gcode: line 2: G10 or G11 pulls filament back"),
        ("G1 X1 F600\nG5 X2 Y2 I1 J0 P0 Q1\n", "a.gcode: line 2: G5 is a curve"),
        ("G1 X1 F600\nT0\nT1\nG1 E1\n", "a.gcode: line 3: T1 is a tool"),
    ];
    for (code, why) in cases {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.gcode"), code).unwrap();
        let words = ["steps", "a.gcode", "-p", "witbox-1", "-o", "a.steps"];
        let refused = slicer(&folder).args(words).assert().code(3).stdout("");
        let told = text(&refused.get_output().stderr);
        assert!(told.contains(why) && told.lines().count() == 1, "{told}");
        assert!(!folder.path().join("a.steps").exists());
    }
}

#[test]
fn where_it_begins_is_told_and_asked_for() {
    let folder = made("G1 X20 Y20\n");
    let words =
        ["steps", "a.gcode", "-o", "b.steps", "--json", "--start", "10,5,0.5", "--coils", "half"];
    let told =
        json(&slicer(&folder).args(words).args(MOTORS).assert().success().get_output().stdout);
    assert_eq!(told["start_mm"], serde_json::json!({"x": 10.0, "y": 5.0, "z": 0.5, "e": 0.0}));
    assert_eq!(told["steps"]["x"], 800);
    assert_eq!(told["steps"]["y"], 1200);
    assert_eq!(told["steps"]["z"], 0);
    let both = ["steps", "a.gcode", "-o", "-", "--json"];
    slicer(&folder).args(both).args(MOTORS).assert().code(2);
    slicer(&folder).args(["play", "a.steps", "--events", "-", "--json"]).assert().code(2);
}

#[test]
fn check_warns_of_a_feed_that_a_motor_cannot_make() {
    let text = "M104 S210\nM109 S210\nG28\nG1 Z0.2 F600\nG1 X20 Y20 F6000\nG1 X50 E1 F1800\nG1 X50 Y40 E2\n";
    let folder = made(text);
    let check = ["check", "a.gcode", "--json", "-p", "generic-marlin"];
    let found = |set: &[&str]| -> Vec<(String, u64, f64)> {
        let told = slicer(&folder).args(check).args(set).assert();
        let told = json(&told.get_output().stdout);
        let all = told["findings"].as_array().unwrap().clone();
        let ours = all.iter().filter(|one| one["code"] == "too-many-steps");
        ours.map(|one| {
            assert_eq!(one["severity"], "warning");
            let place = one["line"].as_u64().unwrap();
            (one["text"].as_str().unwrap().to_owned(), place, one["measure"].as_f64().unwrap())
        })
        .collect()
    };
    assert_eq!(found(&["--set", "steps.x=80"]), []);
    assert_eq!(found(&["--set", "steps.x=80", "--set", "steps.rate_x=6000"]), []);
    let slow = found(&["--set", "steps.x=80", "--set", "steps.rate_x=1000"]);
    let lines: Vec<u64> = slow.iter().map(|one| one.1).collect();
    // The travel and the line along x; the line along y takes no step of x.
    assert!(lines.contains(&5) && lines.contains(&6) && lines.len() == 2, "{slow:?}");
    let line = slow.iter().find(|one| one.1 == 6).unwrap();
    assert!((line.2 - 2400.0).abs() < 1.0);
    assert_eq!(line.0, "2400 steps/s of x, where its motor makes 1000");
    // What is made of it is slower, and told.
    let words = ["steps", "a.gcode", "-o", "b.steps", "--json", "--set", "steps.rate_x=1000"];
    let told = slicer(&folder).args(words).args(MOTORS).assert().success();
    let told = json(&told.get_output().stdout);
    assert_eq!(told["warnings"][0]["code"], "too-many-steps");
    assert_eq!(told["warnings"][0]["line"], 5);
    assert_eq!(told["warnings"][0]["moves"], 2);
    let played = slicer(&folder).args(["play", "b.steps", "--json"]).assert().success();
    assert_eq!(json(&played.get_output().stdout)["highest_rate"]["x"], 1000.0);
}

#[test]
fn estimate_tells_the_highest_rates_where_the_profile_has_steps() {
    let folder = made("G1 X100 Y50 F3000\nG1 X100 Y0 E10\n");
    let told = slicer(&folder).args(["estimate", "a.gcode", "--json"]).args(MOTORS).assert();
    let rates = json(&told.success().get_output().stdout)["highest_rate"].clone();
    let is = |axis: &str, rate: f64| {
        let told = rates[axis].as_f64().unwrap();
        assert!((told - rate).abs() < 1e-6 * rate.max(1.0), "{axis}: {told} is not {rate}");
    };
    is("x", 50.0 * 80.0 * 100.0 / 12_500.0_f64.sqrt());
    is("y", 50.0 * 80.0);
    is("z", 0.0);
    is("e", 50.0 * 93.0 * 10.0 / 50.0);
    let told = slicer(&folder).args(["estimate", "a.gcode"]).args(MOTORS).assert().success();
    assert!(
        text(&told.get_output().stdout).contains("steps/s at most: x 3578, y 4000, z 0, e 930\n")
    );
    let none =
        slicer(&folder).args(["estimate", "a.gcode", "--json", "-p", "generic-marlin"]).assert();
    assert!(json(&none.get_output().stdout)["highest_rate"].is_null());
}

/// What the events of a stream say of strands: lowest and highest x and y while plastic comes, mm; heights at
/// which it comes, in steps; the last time, s; and the least time between two steps of each axis, µs.
struct Judged {
    ends: [[f64; 2]; 2],
    heights: Vec<i64>,
    seconds: f64,
    least: [u64; 4],
}

/// Judges a text of events by mm of a step alone.
fn judged(events: &str, mm: f64) -> Judged {
    let (mut at, mut last) = ([0_i64; 4], [None::<u64>; 4]);
    let mut judged = Judged {
        ends: [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]],
        heights: Vec::new(),
        seconds: 0.0,
        least: [u64::MAX; 4],
    };
    for line in events.lines().filter(|line| !line.starts_with('#')) {
        let words: Vec<&str> = line.split(' ').collect();
        let time: u64 = words[0].parse().unwrap();
        let axis = ["X", "Y", "Z", "E"].iter().position(|axis| *axis == words[1]).unwrap();
        at[axis] += if words[2] == "+" { 1 } else { -1 };
        if let Some(before) = last[axis].replace(time) {
            judged.least[axis] = judged.least[axis].min(time - before);
        }
        judged.seconds = time as f64 / 1e6;
        if axis < 3 {
            continue;
        }
        for (k, place) in [at[0], at[1]].map(|steps| steps as f64 * mm).into_iter().enumerate() {
            judged.ends[0][k] = judged.ends[0][k].min(place);
            judged.ends[1][k] = judged.ends[1][k].max(place);
        }
        if judged.heights.last() != Some(&at[2]) {
            judged.heights.push(at[2]);
        }
    }
    judged
}

/// The cube of 20 mm on the stepper machine of Nariño, as its motors go.
fn on_narino(set: &[&str]) -> Judged {
    let folder = folder();
    let words = ["cube.stl", "-q", "-p", "narino", "-o", "a.steps"];
    slicer(&folder).args(words).args(set).assert().success();
    let play = ["play", "a.steps", "-q", "--events", "e.txt"];
    slicer(&folder).args(play).assert().success();
    judged(&fs::read_to_string(folder.path().join("e.txt")).unwrap(), 0.1014)
}

#[test]
fn the_stepper_machine_makes_the_size_in_steps_and_the_sources_way_a_strand_more() {
    for (set, more) in [(&[][..], 0.0), (&["--set", "outer_wall_inset=0"], 1.0)] {
        let judged = on_narino(set);
        for axis in 0..2 {
            // The strand is as wide as 1 mm, half of it on each side.
            let size = judged.ends[1][axis] - judged.ends[0][axis] + 1.0;
            assert!((size - 20.0 - more).abs() <= 0.1, "{set:?}: {size}");
        }
        // 0.6, 1.6 … 19.6 mm, by steps of 0.01325 mm.
        let heights: Vec<i64> =
            (0..20).map(|k| ((0.6 + f64::from(k)) / 0.01325).round() as i64).collect();
        assert_eq!(judged.heights, heights);
        assert_eq!(judged.least[..2], [12_500; 2]);
        assert!(judged.least.iter().all(|least| *least >= 12_500), "{:?}", judged.least);
    }
}

#[test]
fn at_twice_the_rate_the_stepper_machine_takes_half_the_time() {
    let twice = [
        "steps.rate_x=160",
        "steps.rate_y=160",
        "steps.rate_e=160",
        "speed.wall=16.2",
        "speed.infill=16.2",
        "speed.travel=16.2",
    ];
    let twice: Vec<&str> = twice.iter().flat_map(|set| ["--set", *set]).collect();
    let (usual, twice) = (on_narino(&[]), on_narino(&twice));
    assert_eq!(twice.least[..2], [6_250; 2]);
    // All but the way up: 22 mm and back to the plate's edge at about a mm a second.
    let up = 32.0;
    let share = (twice.seconds - up) / (usual.seconds - up);
    assert!((share - 0.5).abs() < 0.005, "{share}");
    assert_eq!(usual.ends, twice.ends);
}

#[test]
fn a_part_too_small_for_the_stepper_machine_is_refused_in_a_line() {
    let folder = folder();
    let words = ["cube.stl", "-p", "narino", "--scale", "0.2", "-o", "a.steps"];
    let refused = slicer(&folder).args(words).assert().code(3).stdout("");
    let said = text(&refused.get_output().stderr);
    assert!(said.starts_with("error: cube.stl: the model is 4.00 × 4.00 × 4.00 mm"), "{said}");
    assert!(said.contains("machine.min_part_size") && said.lines().count() == 1, "{said}");
    assert!(!folder.path().join("a.steps").exists());
}

#[test]
fn a_report_tells_the_rates_that_estimate_gives_of_the_file() {
    let folder = folder();
    let tile = format!("{}/fixtures/tile.stl", env!("CARGO_MANIFEST_DIR"));
    for (printer, limits) in
        [("replicator", [28_235.0, 28_235.0, 7_800.0, 2_567.0]), ("witbox-1", [0.0; 4])]
    {
        let words = [tile.as_str(), "-p", printer, "-o", "a.gcode", "--report", "a.json"];
        let told = slicer(&folder).args(words).assert().success();
        let told = text(&told.get_output().stderr);
        let report = json(&fs::read(folder.path().join("a.json")).unwrap());
        let estimate = slicer(&folder).args(["estimate", "a.gcode", "--json"]).assert().success();
        let rates = json(&estimate.get_output().stdout)["highest_rate"].clone();
        for (axis, limit) in ["x", "y", "z", "e"].into_iter().zip(limits) {
            let motor = &report["steps"][axis];
            assert_eq!(motor["highest_rate_per_s"], rates[axis], "{printer}, {axis}");
            let of = |key: &str| motor[key].as_f64().unwrap();
            assert!(of("highest_rate_per_s") > 0.0 && of("limit_per_s") > 0.0);
            assert!(
                (of("share") * of("limit_per_s") / of("highest_rate_per_s") - 1.0).abs() < 1e-9
            );
            assert!(limit == 0.0 || of("limit_per_s") == limit, "{printer}, {axis}");
            let line =
                format!("{axis} {:.0} ({:.0} %)", of("highest_rate_per_s"), 100.0 * of("share"));
            assert!(told.contains(&line), "{line}: {told}");
        }
        // On the way to a stream it is the same.
        let words = [tile.as_str(), "-p", printer, "-q", "-o", "a.steps", "--report", "b.json"];
        slicer(&folder).args(words).assert().success();
        let other = json(&fs::read(folder.path().join("b.json")).unwrap());
        assert_eq!(other["steps"], report["steps"]);
    }
    let words = [tile.as_str(), "-p", "generic-marlin", "-o", "a.gcode", "--report", "a.json"];
    let told = slicer(&folder).args(words).assert().success();
    assert!(!text(&told.get_output().stderr).contains("steps/s"));
    assert!(json(&fs::read(folder.path().join("a.json")).unwrap())["steps"].is_null());
}
