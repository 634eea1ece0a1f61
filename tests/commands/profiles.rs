//! Profiles of one's own and shipped ones -> what a run prints with, and what it says of it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use assert_cmd::Command;
use predicates::prelude::*;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// The program in `folder`, with profiles of one's own in its folder `config`.
fn slicer(folder: &TempDir) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    let config = folder.path().join("config");
    command.current_dir(folder.path()).env_remove("SLICER_NO_USER_CONFIG");
    // The user's folder, by the conventions of the platforms.
    command.env("XDG_CONFIG_HOME", &config).env("HOME", &config).env("APPDATA", &config);
    command.env_remove("SLICER_PROFILES");
    command
}

fn write(folder: &TempDir, name: &str, text: &str) {
    let path = folder.path().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

/// The folder with the cube of the fixtures in it.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let cube = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/cube_20.stl");
    fs::copy(cube, folder.path().join("part.stl")).unwrap();
    folder
}

/// What standard error says of a run that slices the cube, a quarter as large.
fn said(command: &mut Command, words: &[&str]) -> String {
    let job = ["part.stl", "--scale", "0.25", "-o", "a.gcode"];
    let done = command.args([&job[..], words].concat()).assert().success();
    String::from_utf8(done.get_output().stderr.clone()).unwrap()
}

#[test]
fn profiles_are_listed_by_kind_shown_and_checked() {
    let folder = folder();
    let kinds = regex_lite::Regex::new(
        "(?s)^printers\n  zcube-dual .*\nmaterials\n  pla .*\nprints\n  standard .*  thesis ",
    )
    .unwrap();
    slicer(&folder)
        .args(["profile", "list"])
        .assert()
        .success()
        .stdout(predicate::function(|text: &str| kinds.is_match(text)))
        .stderr("");
    let from_a_line = regex_lite::Regex::new("outer_wall_inset = 0  # thesis:\\d+").unwrap();
    let shown = slicer(&folder)
        .args(["profile", "show", "thesis", "--set", "walls=2"])
        .assert()
        .success()
        .stdout(predicate::str::contains("walls = 2  # --set"))
        .stdout(predicate::function(|text: &str| from_a_line.is_match(text)))
        .stderr("");
    fs::write(folder.path().join("mine.toml"), &shown.get_output().stdout).unwrap();
    slicer(&folder)
        .args(["profile", "check", "mine.toml"])
        .assert()
        .success()
        .stdout("mine.toml: good\n");
}

#[test]
fn the_summary_says_for_what_it_was_sliced_and_whether_that_was_chosen() {
    let folder = folder();
    let text = said(&mut slicer(&folder), &[]);
    assert!(
        text.contains("printer zcube-dual (not chosen), material pla-thesis, print one-wall\n"),
        "{text}"
    );
    let text = said(
        &mut slicer(&folder),
        &["-p", "generic-klipper", "--material", "petg", "--print", "fine"],
    );
    assert!(
        text.starts_with("part.stl: printer generic-klipper, material petg, print fine\n"),
        "{text}"
    );
    let gcode = fs::read_to_string(folder.path().join("a.gcode")).unwrap();
    for line in ["layer_height = 0.12", "filament.temperature = 240", "filament.name = \"PETG\""] {
        assert!(gcode.contains(&format!("\n; {line}\n")), "{line}");
    }
}

#[test]
fn every_file_that_had_a_say_is_named_but_not_in_the_gcode() {
    let folder = folder();
    write(&folder, "config/slicer/printers/secret-printer.toml", "inherits = \"generic-marlin\"\n");
    write(&folder, "secret.toml", "infill = 11\n");
    let words = ["-p", "secret-printer", "-p", "./secret.toml", "--report", "r.json"];
    let text = said(&mut slicer(&folder), &words);
    assert!(
        text.starts_with("part.stl: printer secret-printer, material pla, print standard; with "),
        "{text}"
    );
    assert!(text.contains("secret-printer.toml, ./secret.toml\n"), "{text}");
    let report: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("r.json")).unwrap()).unwrap();
    assert_eq!(report["profile"], "secret-printer");
    assert_eq!(report["is_profile_chosen"], true);
    let names: Vec<_> = report["profiles"].as_array().unwrap().iter().collect();
    assert_eq!(names.len(), 5);
    assert_eq!(names[4]["file"], "./secret.toml");
    assert!(names[0].get("file").is_none());
    let gcode = fs::read_to_string(folder.path().join("a.gcode")).unwrap();
    assert!(gcode.contains("\n; infill = 11\n") && !gcode.contains("secret"));
}

#[test]
fn ones_own_profiles_are_found_in_order_and_can_be_left_out() {
    let folder = folder();
    write(&folder, "config/slicer/default.toml", "inherits = \"generic-marlin\"\n");
    write(&folder, "config/slicer/materials/mine.toml", "[filament]\ntemperature = 201\n");
    write(&folder, "farm/materials/mine.toml", "[filament]\ntemperature = 202\n");
    let text = said(&mut slicer(&folder), &[]);
    assert!(
        text.starts_with("part.stl: printer default.toml, material pla, print standard"),
        "{text}"
    );
    let shown = |command: &mut Command, words: &[&str]| {
        let words = [&["profile", "show"], words].concat();
        let done = command.args(words).assert().success();
        String::from_utf8(done.get_output().stdout.clone()).unwrap()
    };
    let own = shown(&mut slicer(&folder), &["--material", "mine"]);
    assert!(own.contains("\ntemperature = 201 ") && own.contains("\"Marlin printer\""), "{own}");
    let farm = shown(slicer(&folder).env("SLICER_PROFILES", "farm"), &["--material", "mine"]);
    assert!(farm.contains("\ntemperature = 202  # farm/materials/mine.toml:2\n"), "{farm}");
    for command in [
        slicer(&folder).args(["--no-user-config", "part.stl", "-o", "a", "--material", "mine"]),
        slicer(&folder).env("SLICER_NO_USER_CONFIG", "1").args([
            "part.stl",
            "-o",
            "a",
            "--material",
            "mine",
        ]),
    ] {
        command.assert().code(2).stderr(predicate::str::contains("unknown profile `mine`"));
    }
    let text = said(slicer(&folder).env("SLICER_NO_USER_CONFIG", "1"), &[]);
    assert!(text.contains("printer zcube-dual (not chosen),"), "{text}");
}

#[test]
fn a_printer_that_nobody_chose_is_a_warning_whatever_else_was_chosen() {
    let folder = folder();
    let warns = "warning: part.stl: no printer chosen: this file is for the ZCube Dual; choose one with -p \
                 (slicer profile list)\n";
    for words in [&[][..], &["--material", "petg"], &["-p", "petg"], &["--print", "fine"]] {
        let mut command = slicer(&folder);
        command.args(["part.stl", "-q", "-o", "a.gcode", "--report", "r.json", "--strict"]);
        command.args(words);
        command.assert().code(1).stderr(predicate::str::starts_with(warns));
        let report: serde_json::Value =
            serde_json::from_slice(&fs::read(folder.path().join("r.json")).unwrap()).unwrap();
        assert_eq!(report["profile"], "zcube-dual", "{words:?}");
        assert_eq!(report["is_profile_chosen"], false, "{words:?}");
        assert_eq!(report["warnings"][0]["code"], "no-printer", "{words:?}");
    }
    let words = ["part.stl", "-q", "-o", "a.gcode", "--strict", "-p", "ender-3"];
    slicer(&folder).args(words).args(["--material", "petg"]).assert().success().stderr("");
}

#[test]
fn files_that_are_meant_and_settings_of_other_slicers_are_told() {
    let folder = folder();
    let refuses = |words: &[&str], says: &str| {
        let mut command = slicer(&folder);
        command.args(["part.stl", "-o", "a.gcode"]).args(words);
        let told = command.assert().code(2);
        let text = String::from_utf8(told.get_output().stderr.clone()).unwrap();
        assert_eq!(text, format!("error: {says}\n"));
    };
    write(&folder, "mine.toml", "infill = 30\n");
    refuses(&["-p", "mine"], "unknown profile `mine`; there is such a file: write mine.toml");
    refuses(
        &["-p", "mk3s"],
        "unknown profile `mk3s`; did you mean `prusa-mk3s`?; `slicer profile list` names all, and a file \
         ends in .toml or is given as ./mk3s",
    );
    refuses(
        &["-p", "mine.toml"],
        "mine.toml: `description` has no value; set it, or begin the file with inherits = \
         \"YOUR PRINTER\", such as \"ender-3\" (slicer profile list)",
    );
    let others = "is no profile of this program, and settings of other slicers are not read; begin with \
                  `slicer profile new ender-3 > mine.toml`, or another printer of `slicer profile list`";
    write(&folder, "config.ini", "# generated by PrusaSlicer 2.7.1\n\narc_fitting = disabled\n");
    refuses(&["-p", "./config.ini"], &format!("./config.ini: {others}"));
    refuses(&["-p", "config.ini"], &format!("config.ini: {others}"));
    write(&folder, "theirs.toml", "# generated by PrusaSlicer 2.7.1\n\narc_fitting = disabled\n");
    refuses(&["-p", "theirs.toml"], &format!("theirs.toml: {others}"));
}

#[test]
fn a_new_profile_inherits_and_is_good() {
    let folder = folder();
    for (name, says) in [
        ("generic-klipper", "\n[machine]\n# name = \"Klipper printer\"\n"),
        ("petg", "\n[filament]\n# name = \"PETG\"\n# temperature = 240  # °C\n"),
        ("fine", "\n# layer_height = 0.12  # mm\n"),
    ] {
        let new = slicer(&folder).args(["profile", "new", name]).assert().success();
        let text = String::from_utf8(new.get_output().stdout.clone()).unwrap();
        assert!(
            text.contains(says) && text.contains(&format!("inherits = \"{name}\"\n")),
            "{text}"
        );
        // What is in comments is said as it would be.
        let spoken = text.replace("\n# Whatever", "").replace("\n# ", "\n");
        let spoken = spoken.replace("# Whatever is not said here is as in", "#");
        write(&folder, "mine.toml", &spoken.replace("\n`slicer", "\n# `slicer"));
        slicer(&folder).args(["profile", "check", "mine.toml"]).assert().success();
    }
    slicer(&folder)
        .args(["profile", "new", "pteg"])
        .assert()
        .code(2)
        .stderr(predicate::str::contains("did you mean `petg`?"));
}

#[test]
fn a_part_where_the_nozzle_is_primed_is_refused() {
    let folder = folder();
    slicer(&folder)
        .args(["part.stl", "-p", "generic-marlin", "--at", "35,13", "-o", "a"])
        .assert()
        .code(3)
        .stderr(predicate::str::starts_with(
            "error: part.stl: the start block primes the nozzle at x ",
        ));
    slicer(&folder)
        .args(["part.stl", "-q", "-p", "generic-marlin", "--at", "35,25", "-o", "a"])
        .assert()
        .success();
}

/// Exit code, standard output and standard error.
fn ran(command: &mut Command, words: &[&str]) -> (i32, String, String) {
    let run = command.args(words).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (run.status.code().unwrap(), text(run.stdout), text(run.stderr))
}

#[test]
fn each_profile_is_checked_by_itself_and_a_pile_by_flags() {
    let folder = folder();
    let wrong = "inherits = \"ender-3\"\nwals = 3\nwalls = 1000\n[speed]\nwall = 5000\n";
    write(&folder, "a.toml", "inherits = \"ender-3\"\nlayer_height = 0.3\n");
    write(&folder, "b.toml", wrong);
    write(&folder, "c.toml", "inherits = \"generic-marlin\"\n[speed]\nskin = 1\n");
    let (code, out, err) =
        ran(&mut slicer(&folder), &["profile", "check", "a.toml", "b.toml", "c.toml"]);
    assert_eq!((code, out.as_str()), (2, "a.toml: good\nb.toml: 3 faults\nc.toml: good\n"));
    let lines: Vec<&str> = err.lines().collect();
    let starts = [
        "error: b.toml:2: unknown key `wals`",
        "error: b.toml:3: walls = 1000",
        "error: b.toml:5: speed.wall = 5000",
        "warning: c.toml: speed.skin = 1",
    ];
    assert_eq!(lines.len(), starts.len(), "{err}");
    for (line, starts) in lines.iter().zip(starts) {
        assert!(line.starts_with(starts), "{err}");
    }
    // Flags lie over each file: the two together cannot print.
    let fine = ["profile", "check", "a.toml", "--set", "machine.nozzle_diameter=0.2"];
    let (code, _, err) = ran(&mut slicer(&folder), &fine);
    assert!(code == 2 && err.contains("layer_height"), "{err}");
    // A pile.
    let pile = ["profile", "check", "-p", "./a.toml", "--material", "petg"];
    assert_eq!(
        ran(&mut slicer(&folder), &pile),
        (0, "a.toml + petg: good\n".into(), String::new())
    );
    let (code, _, err) = ran(&mut slicer(&folder), &["profile", "check"]);
    assert!(code == 2 && err.contains("<FILE>"), "{err}");
}

#[test]
fn the_list_marks_the_default_that_holds() {
    let folder = folder();
    let list = |command: &mut Command| ran(command, &["profile", "list"]).1;
    let marked = |text: &str| {
        let lines = text.lines().filter(|line| line.contains("the default"));
        lines.map(|line| line.split_whitespace().next().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(marked(&list(&mut slicer(&folder))), ["zcube-dual"]);
    write(
        &folder,
        "config/slicer/default.toml",
        "inherits = \"ender-3\"\ndescription = \"Mine\"\n",
    );
    let text = list(&mut slicer(&folder));
    assert_eq!(marked(&text), ["default.toml"]);
    assert!(
        text.contains("Mine; the default (") && text.contains("slicer/default.toml)\n"),
        "{text}"
    );
    let (_, json, _) = ran(&mut slicer(&folder), &["profile", "list", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let all = json.as_array().unwrap();
    let defaults = all.iter().filter(|one| one["is_default"] == true);
    assert_eq!(
        defaults.map(|one| one["name"].as_str().unwrap()).collect::<Vec<_>>(),
        ["default.toml"]
    );
    assert!(all[0]["file"].as_str().unwrap().ends_with("default.toml"));
    assert_eq!(
        all.iter().filter(|one| one["kind"] == "printer").count(),
        text.split("materials").next().unwrap().lines().count() - 1
    );
    assert!(all.iter().any(|one| one["name"] == "petg"
        && one["kind"] == "material"
        && one.get("file").is_none()));
}

#[test]
fn a_number_of_skin_layers_that_a_thickness_outdoes_is_told() {
    let folder = folder();
    write(&folder, "mine.toml", "inherits = \"ender-3\"\ntop_layers = 2\n");
    let says = "top_layers has no effect: top_thickness = 0.8 mm asks for more, 4 layers; set top_thickness = 0 \
                beside it\n";
    let checks = slicer(&folder).args(["profile", "check", "mine.toml"]).assert().success();
    checks.stderr(format!("warning: mine.toml: {says}"));
    let text = said(&mut slicer(&folder), &["-q", "-p", "mine.toml"]);
    assert_eq!(text, format!("warning: part.stl: {says}"));
}
