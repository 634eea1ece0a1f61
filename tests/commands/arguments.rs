//! Command lines -> exit codes, streams and files, as a user or a script sees them.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::run::slicer;
use assert_cmd::Command;
use predicates::prelude::*;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("part.stl"), "solid part\nendsolid part\n").unwrap();
    folder
}

fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The run fails with this code and these words in exactly one line on stderr,
/// says nothing on stdout, and leaves no file.
fn fails(folder: &TempDir, words: &[&str], code: i32, says: &str) {
    let before = files(folder.path());
    let one_line = predicate::function(|text: &str| text.lines().count() == 1);
    slicer(folder)
        .args(words)
        .assert()
        .code(code)
        .stdout("")
        .stderr(predicate::str::starts_with("error: ").and(predicate::str::contains(says)))
        .stderr(one_line);
    assert_eq!(files(folder.path()), before, "{words:?}");
}

#[test]
fn wrong_flags_are_one_line_with_a_tip() {
    let folder = folder();
    fails(&folder, &["part.stl", "-o", "a", "--wals", "2"], 2, "'--walls'");
    fails(&folder, &["part.stl"], 2, "--output <OUT>, such as -o part.gcode; see `slicer --help`");
    fs::write(folder.path().join("-dash.stl"), "").unwrap();
    fails(&folder, &["-dash.stl", "-o", "a"], 2, "begins with a dash; write ./-dash.stl");
    fs::remove_file(folder.path().join("-dash.stl")).unwrap();
    fails(&folder, &["-o", "a"], 2, "<INPUT>");
    fails(&folder, &["part.stl", "-o", "a", "--pattern", "gird"], 2, "grid");
    fails(&folder, &["part.stl", "-o", "a", "--scale", "0"], 2, "more than 0");
    fails(&folder, &["part.stl", "-o", "a", "--rotate", "1,2"], 2, "3 numbers");
    fails(&folder, &["part.stl", "-o", "a", "-q", "-v"], 2, "cannot be used with");
    fails(&folder, &["part.stl", "-o", "a", "--threads", "0"], 2, "--threads");
}

#[test]
fn a_value_behind_a_switch_is_no_file_that_cannot_be_read() {
    let folder = folder();
    let run = |words: &[&str], says| {
        fails(&folder, &[&["part.stl", "-o", "a"], words].concat(), 2, says);
    };
    run(&["--raft", "3"], "write --raft --set raft.interface_layers=3");
    run(&["--ironing", "topmost"], "write --ironing=topmost");
    run(&["--dual", "interlaced"], "write --dual-mode interlaced");
    run(&["--nonplanar=v6"], "write --nonplanar --head v6");
    run(&["--head", "v6"], "--head: has no effect while nonplanar.enabled is off; add --nonplanar");
    run(&["--head", "mk8"], "measure any other, and write it as [head]");
    // It may well be a file.
    fails(&folder, &["-o", "a", "--raft", "part.obj"], 3, "part.obj: cannot be read");
    std::fs::write(folder.path().join("3"), "solid part\nendsolid part\n").unwrap();
    fails(&folder, &["-o", "a", "--raft", "3"], 3, "3: ");
}

#[test]
fn wrong_settings_name_the_flag() {
    let folder = folder();
    let run = |words: &[&str], says| {
        fails(&folder, &[&["part.stl", "-o", "a"], words].concat(), 2, says);
    };
    run(&["--layer-height", "-1"], "--layer-height: layer_height = -1 is out of range");
    run(&["--layer-height", "x"], "--layer-height: layer_height is the text `x`");
    run(&["--layer-height", "0.5"], "--layer-height: layer_height = 0.5 mm is more than");
    run(&["--dual", "--layer-height", "0.3"], "make thick lines 0.6 mm tall, above the 0.4 mm");
    run(&["--set", "wals=2"], "--set: unknown key `wals`; did you mean `walls`?");
    run(&["--set", "perimeters=2"], "--set: unknown key `perimeters`; here it is `walls`");
    run(
        &["--spiral-mode"],
        "unexpected argument '--spiral-mode' found; a spiral vase is not supported",
    );
    run(&["--brim", "-1"], "--brim: brim.width = -1 is out of range");
    run(&["--raft", "--brim", "5"], "--brim: has no effect with a raft");
    let off = ["part.stl", "-o", "a", "--raft", "--brim", "0"];
    fails(&folder, &off, 3, "part.stl: holds no triangles");
    run(&["--brim-width", "5"], "unexpected argument '--brim-width' found; use --brim");
    run(&["--skirts", "2"], "unexpected argument '--skirts' found; use --skirt");
    run(&["--perimeters", "2"], "unexpected argument '--perimeters' found; use --walls");
    run(&["--set", "walls"], "there is no `=`");
    run(&["-p", "generic"], "unknown profile `generic`");
    run(&["-p", "mine.toml"], "mine.toml: cannot read this profile");
}

#[test]
fn of_a_flag_given_twice_the_last_holds_and_lists_grow() {
    let folder = folder();
    fs::write(folder.path().join("petg.toml"), "[filament]\nname = \"PETG\"\n").unwrap();
    write_block(&folder.path().join("block.stl"));
    let words = [
        "block.stl",
        "-q",
        "--walls",
        "7",
        "--set",
        "tolerance=0.02",
        "-p",
        "generic-marlin",
        "--walls",
        "4",
        "--infill=10",
        "--set",
        "seam=nearest",
        "-p",
        "./petg.toml",
        "--infill=11",
        "-o",
        "a",
        "-o",
        "-",
    ];
    let told = slicer(&folder).args(words).assert().success().stderr("");
    let text = String::from_utf8(told.get_output().stdout.clone()).unwrap();
    for line in [
        "walls = 4",
        "infill = 11",
        "tolerance = 0.02",
        "seam = \"nearest\"",
        "machine.name = \"Marlin printer\"",
        "filament.name = \"PETG\"",
    ] {
        assert!(text.contains(&format!("\n; {line}\n")), "{line}");
    }
    let words =
        ["profile", "show", "--set", "walls=3", "witbox-1", "./petg.toml", "--set", "walls=5"];
    let told = slicer(&folder).args(words).assert().success();
    let text = String::from_utf8(told.get_output().stdout.clone()).unwrap();
    assert!(text.contains("walls = 5  # --set") && text.contains("PETG"), "{text}");
}

#[test]
fn wrong_profiles_name_file_and_line() {
    let folder = folder();
    let profile = |text: &str| fs::write(folder.path().join("mine.toml"), text).unwrap();
    let run = |says| {
        fails(&folder, &["part.stl", "-o", "a", "-p", "mine.toml"], 2, says);
        fails(&folder, &["profile", "check", "mine.toml"], 2, says);
    };
    profile("inherits = \"zcube-dual\"\n\n[speed]\nwal = 1\n");
    run("mine.toml:4: unknown key `speed.wal`; did you mean `speed.wall`?");
    profile("inherits = \"zcube-dual\"\ninfill = 120\n");
    run("mine.toml:2: infill = 120 is out of range; it must be 0 to 100 %");
    profile("inherits = \"zcube-dual\"\nwalls = \n");
    run("mine.toml:2: this is no valid TOML");
    profile("inherits = \"mine.toml\"\n");
    run("mine.toml:1: inherits goes round in a circle: mine.toml -> mine.toml");
    profile("inherits = \"zcub-dual\"\n");
    run("mine.toml:1: inherits: unknown profile `zcub-dual`; did you mean `zcube-dual`?");
    profile(
        "inherits = \"zcube-dual\"\n[machine]\nstart_gcode = '''\nG21\nM104 S{temprature}\n'''\n",
    );
    run("mine.toml:3: machine.start_gcode, line 2 of it: unknown placeholder {temprature}");
}

#[test]
fn outputs_that_cannot_be_written_are_told_before_the_work() {
    let folder = folder();
    fs::create_dir(folder.path().join("dir")).unwrap();
    fails(&folder, &["part.stl", "-o", "no/a.gcode"], 4, "there is no directory no; create it");
    fails(&folder, &["part.stl", "-o", "dir"], 4, "it is a directory");
    let words = ["part.stl", "-o", "a.gcode", "--report", "no/a.json"];
    fails(&folder, &words, 4, "there is no directory no; create it");
}

#[test]
fn no_two_arguments_may_mean_the_same_file() {
    let folder = folder();
    fails(&folder, &["part.stl", "-o", "-", "--report", "-"], 2, "standard output");
    fails(&folder, &["part.stl", "-o", "./part.stl"], 2, "would replace part.stl");
    fails(&folder, &["part.stl", "-o", "a", "--report", "./a"], 2, "the same file");
    fails(&folder, &["-", "-", "-o", "a"], 2, "standard input holds one model");
    // Nor may a product look like a model.
    fails(&folder, &["part.stl", "-o", "next.STL"], 2, "next.STL is a model's name");
    fails(&folder, &["part.stl", "-o", "a", "--report", "b.stl"], 2, "b.stl is a model's name");
    // Nor replace a profile that is read, be it inherited.
    fs::write(folder.path().join("base"), "walls = 3\n").unwrap();
    fs::write(folder.path().join("mine.toml"), "inherits = [\"ender-3\", \"./base\"]\n").unwrap();
    for out in ["mine.toml", "base"] {
        let words = ["part.stl", "-p", "./mine.toml", "-o", out];
        fails(&folder, &words, 2, "the output would replace");
    }
    // A name is no file.
    write_block(&folder.path().join("block.stl"));
    let words = ["block.stl", "-q", "--material", "pla", "-o", "pla"];
    slicer(&folder).args(words).assert().success();
    assert!(fs::read_to_string(folder.path().join("pla")).unwrap().contains(";LAYER_CHANGE"));
}

#[test]
fn formats_that_are_not_written_are_refused() {
    let folder = folder();
    for (out, remedy) in [
        ("a.3mf", "choose .gcode"),
        ("a.toml", "-p reads one; choose .gcode"),
        ("a.INI", "choose .gcode"),
        ("a.json", "--report writes a report"),
        ("a.html", "`slicer preview` draws it"),
        ("a.svg", "`slicer preview` draws it"),
        ("a.png", "`slicer preview` draws it"),
        ("a.bgcode", "`bgcode`"),
        ("a.X3G", "`gpx`"),
        ("a.gcode.gz", "-o - | gzip"),
    ] {
        fails(&folder, &["part.stl", "-o", out], 2, &format!("{out}: this format is not written"));
        fails(&folder, &["part.stl", "-o", out], 2, remedy);
    }
}

#[test]
fn the_word_help_is_meant_as_the_flag() {
    let folder = folder();
    for words in [&["help"] as &[&str], &["help", "check"], &["help", "profile", "show"]] {
        let by_flag = [&words[1..], &["--help"]].concat();
        let by_flag = slicer(&folder).args(by_flag).assert().success();
        let by_flag = by_flag.get_output().stdout.clone();
        slicer(&folder).args(words).assert().success().stdout(by_flag);
    }
    fails(&folder, &["check"], 2, "see `slicer check --help`");
    fails(&folder, &["profile", "show", "--frob"], 2, "see `slicer profile show --help`");
    write_block(&folder.path().join("block.stl"));
    fails(&folder, &["block.stl", "-o", "a", "--sink", "30"], 3, "--sink 30 cuts off all");
}

#[test]
fn a_run_alone_shows_short_help_and_fails() {
    let folder = folder();
    slicer(&folder).assert().code(2).stdout("").stderr(predicate::str::contains("--output"));
}

#[test]
fn help_is_a_product_with_examples_and_exit_codes() {
    let folder = folder();
    slicer(&folder)
        .arg("--help")
        .assert()
        .success()
        .stdout(predicate::str::contains("Examples:").and(predicate::str::contains("Exit codes:")))
        .stderr("");
}

#[test]
fn completions_and_the_manual_are_printed() {
    let folder = folder();
    for words in [&["completions", "bash"][..], &["completions", "fish"], &["man"]] {
        slicer(&folder)
            .args(words)
            .assert()
            .success()
            .stdout(
                predicate::str::contains("layer-height")
                    .or(predicate::str::contains("layer\\-height")),
            )
            .stderr("");
    }
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_failure() {
    let folder = folder();
    // `true` never reads, so the pipe is closed under the long text.
    let program = assert_cmd::cargo::cargo_bin!("slicer");
    let script =
        format!("{{ sleep 0.2; '{}' profile show; echo $? >&2; }} | true", program.display());
    let mut shell = Command::new("sh");
    shell.args(["-c", &script]).current_dir(folder.path()).assert().stderr("0\n");
}

/// A closed block of 12 x 10 x 4 mm.
fn write_block(path: &Path) {
    let corner = |i: usize| {
        let pick = |bit: usize, size: usize| if i & bit == 0 { 0 } else { size };
        format!("vertex {} {} {}\n", pick(1, 12), pick(2, 10), pick(4, 4))
    };
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut text = "solid block\n".to_owned();
    for [a, b, c, d] in quads {
        for triangle in [[a, b, c], [a, c, d]] {
            text += "facet normal 0 0 0\nouter loop\n";
            text.extend(triangle.map(corner));
            text += "endloop\nendfacet\n";
        }
    }
    fs::write(path, text + "endsolid block\n").unwrap();
}

#[test]
fn a_good_run_writes_its_products_and_a_summary_of_four_lines_and_one_on_quick_layers() {
    let folder = folder();
    write_block(&folder.path().join("block.stl"));
    let args = ["block.stl", "-p", "zcube-dual", "-o", "a.gcode", "--report", "a.json"];
    let args = [&args[..], &["--strict", "--dual"]].concat();
    for (seconds, lines) in [("0", 4), ("10", 5)] {
        let as_many = predicate::function(move |text: &str| text.lines().count() == lines);
        let run = slicer(&folder).args(&args).args(["--min-layer-time", seconds]).assert();
        run.success().stdout("").stderr(as_many);
    }
    assert_eq!(files(folder.path()), ["a.gcode", "a.json", "block.stl", "part.stl"]);
    let report = fs::read(folder.path().join("a.json")).unwrap();
    assert!(serde_json::from_slice::<serde_json::Value>(&report).unwrap().is_object());
}

#[test]
fn the_product_is_the_same_on_stdout_and_on_any_number_of_threads() {
    let folder = folder();
    write_block(&folder.path().join("block.stl"));
    let words = ["block.stl", "-p", "zcube-dual", "-o", "a.gcode", "-q"];
    slicer(&folder).args(words).assert().success().stderr("");
    let file = fs::read(folder.path().join("a.gcode")).unwrap();
    for threads in ["1", "3"] {
        let words = ["block.stl", "-p", "zcube-dual", "-q", "-o", "-", "--threads", threads];
        slicer(&folder).args(words).assert().success().stdout(file.clone()).stderr("");
    }
}

/// A model that leaves nothing to print is only found out when all layers are planned.
#[test]
fn a_refused_job_writes_neither_to_a_pipe_nor_to_files() {
    let folder = folder();
    write_block(&folder.path().join("block.stl"));
    let words = ["block.stl", "--scale", "0.03", "--set", "min_feature=1", "-q", "-o"];
    let says = "everything is too thin for a line";
    fails(&folder, &[&words[..], &["-"]].concat(), 3, says);
    fails(&folder, &[&words[..], &["a.gcode"]].concat(), 3, says);
}

/// A run that is told to stop removes its unfinished file.
#[cfg(unix)]
#[test]
fn interrupted_run_leaves_nothing() {
    use std::io::Write as _;
    use std::process::{Command as Process, Stdio};
    let folder = tempfile::tempdir().unwrap();
    let report = || fs::read_to_string(folder.path().join("a.json")).unwrap();
    fs::write(folder.path().join("a.json"), "of an earlier run").unwrap();
    // Reads its model from standard input, which stays open: it waits until it is stopped.
    let mut child = Process::new(env!("CARGO_BIN_EXE_slicer"))
        .args(["-", "-o", "part.gcode", "--report", "a.json"])
        .current_dir(folder.path())
        .stdin(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    input.write_all(b"solid waiting\n").unwrap();
    for _ in 0..500 {
        if report().contains("\"unfinished\"") {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert!(report().contains("\"unfinished\""), "the run was never begun");
    let killed = Process::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(report().contains("\"interrupted\""), "{}", report());
    assert_eq!(files(folder.path()), ["a.json"]);
}

/// A cube with a byte too many.
fn cube_with_a_flaw() -> Vec<u8> {
    let mut bytes =
        std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/cube_20.stl")).unwrap();
    bytes.push(0);
    bytes
}

#[test]
fn strict_counts_what_the_check_warns_of() {
    let folder = tempfile::tempdir().unwrap();
    let part = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/overhang.stl");
    for (strict, code) in [(false, 0), (true, 1)] {
        let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_slicer"));
        command.current_dir(folder.path()).args([part, "-o", "a.gcode", "-q", "--check"]);
        if strict {
            command.arg("--strict");
        }
        let output = command.output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{text}");
        assert!(text.contains("warning: unanchored") && !text.contains("--json"), "{text}");
    }
}

#[test]
fn strict_run_with_a_warning_is_done_but_exits_with_1() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("cube.stl"), cube_with_a_flaw()).unwrap();
    for (strict, code) in [(false, 0), (true, 1)] {
        let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_slicer"));
        command.current_dir(folder.path()).args(["cube.stl", "-o", "a.gcode", "-q"]);
        command.args(["-p", "zcube-dual"]);
        if strict {
            command.arg("--strict");
        }
        let output = command.output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{text}");
        assert!(text.starts_with("warning: cube.stl: ignored 1 byte after"), "{text}");
        assert_eq!(text.contains("error: cube.stl: 1 warning with --strict"), strict, "{text}");
        assert!(folder.path().join("a.gcode").is_file());
        std::fs::remove_file(folder.path().join("a.gcode")).unwrap();
    }
}

#[test]
fn a_product_that_the_check_finds_fault_with_is_not_put_in_place() {
    let folder = folder();
    write_block(&folder.path().join("block.stl"));
    fs::write(folder.path().join("a.gcode"), "old").unwrap();
    // Axes that are slower than the feeds asked for.
    let words = ["block.stl", "-p", "zcube-dual", "-q", "--check", "--set", "limits.speed_x=1"];
    let words = [&words[..], &["--report", "a.json"]].concat();
    for out in ["a.gcode", "-"] {
        let run = slicer(&folder).args(&words).args(["-o", out]).assert().code(1).stdout("");
        run.stderr(
            predicate::str::starts_with("block.stl: too-fast: line ")
                .and(predicate::str::contains("error: block.stl: --check has findings")),
        );
        assert_eq!(fs::read(folder.path().join("a.gcode")).unwrap(), b"old");
        let report = fs::read(folder.path().join("a.json")).unwrap();
        let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
        assert_eq!(report["check"]["findings"][0]["code"], "too-fast");
    }
    assert_eq!(files(folder.path()), ["a.gcode", "a.json", "block.stl", "part.stl"]);
}

#[test]
fn a_product_that_the_check_finds_clean_is_the_same_as_without_it() {
    let folder = folder();
    write_block(&folder.path().join("block.stl"));
    let plain = ["block.stl", "-p", "zcube-dual", "-q", "--dual", "--copies", "2", "-o", "-"];
    let product = slicer(&folder).args(plain).output().unwrap().stdout;
    let checked = slicer(&folder).args(plain).arg("--check").assert().success();
    checked.stdout(product).stderr("");
}
