//! Names and texts of files that do harm, and files without an end -> what is shown and read of them.
//!
//! Everything that the program prints, draws or writes is looked through for control characters. Names
//! are tried that hold line feeds, and such that are no UTF-8, as only some systems allow.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::run::{folder, slicer};
use assert_cmd::Command;
use std::fs;

/// Two layers that print lines, with what does harm to a terminal in a comment, an unknown line and a
/// message; ESC, CSI as one character, a mark that turns the direction of text, and DEL.
const HARMFUL: &str = "G21\n;LAYER_CHANGE\n;TYPE:\u{1b}[31mX\n;\u{9b}2J = \u{202e}\u{7f}\nG1 Z0.2\n\
    G1 X10 E1\n\u{1b}[2JQ99 \u{1b}\nM117 \u{1b}[2J\nG1 X20 E2\n;LAYER_CHANGE\nG1 Z0.4\nG1 X0 E3\n\
    \u{9b}31m \u{202e}\u{7f}Q\n";

/// Whether a text has something in it that is not seen but obeyed.
fn acts(text: &str) -> bool {
    text.chars().any(|c| (c.is_control() && c != '\n') || c == '\u{202e}')
}

#[test]
fn text_of_a_file_reaches_no_terminal_page_or_picture_as_it_is() {
    let folder = folder();
    fs::write(folder.path().join("a.gcode"), HARMFUL).unwrap();
    fs::write(folder.path().join("b.gcode"), HARMFUL.replace("Q99", "Q98")).unwrap();
    let runs: &[&[&str]] = &[
        &["check", "a.gcode", "-p", "generic-marlin"],
        &["check", "a.gcode", "-p", "generic-marlin", "--json"],
        &["estimate", "a.gcode", "--layers"],
        &["estimate", "a.gcode", "--json"],
        &["diff", "a.gcode", "b.gcode", "--settings", "--all"],
        &["diff", "a.gcode", "b.gcode", "--json"],
        &["preview", "a.gcode", "-o", "a.svg"],
        &["preview", "a.gcode", "-o", "a.html"],
    ];
    let mut shown = String::new();
    for words in runs {
        let run = slicer(&folder).args(*words).output().unwrap();
        for bytes in [run.stdout, run.stderr] {
            let text = String::from_utf8(bytes).unwrap();
            assert!(!acts(&text), "{words:?}: {}", text.escape_debug());
            shown += &text;
        }
    }
    // It is there to be seen.
    assert!(shown.contains("\\u001b[2JQ99") && shown.contains("\\u202e"), "{shown}");
    for picture in ["a.svg", "a.html"] {
        let text = fs::read_to_string(folder.path().join(picture)).unwrap();
        let line = text.lines().find(|line| line.chars().any(|c| c.is_control() && c != '\t'));
        assert_eq!(line, None, "{picture}");
    }
}

#[cfg(unix)]
#[test]
fn names_forge_no_messages() {
    let folder = folder();
    let name = "a\nerror: forged \u{1b}[31m";
    let path = |end: &str| format!("{name}{end}");
    let run = |words: &[&str], code: i32| {
        let run = slicer(&folder).args(words).output().unwrap();
        assert_eq!(run.status.code(), Some(code), "{words:?}");
        let all = [run.stdout, run.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        for text in &all {
            assert!(!text.lines().any(|line| line.starts_with("error: forged")), "{text}");
            assert!(!acts(text), "{}", text.escape_debug());
        }
        all.concat()
    };
    let shown = "a\\nerror: forged \\u001b[31m";
    let lone = |words: &[&str], code: i32| {
        let text = run(words, code);
        assert!(text.lines().count() == 1 && text.contains(shown), "{text}");
    };
    // Nothing has this name yet.
    lone(&[&path(".stl"), "-o", "a.gcode"], 3);
    for command in ["check", "estimate", "mesh"] {
        lone(&[command, &path(".gcode")], 3);
    }
    lone(&["preview", &path(".gcode"), "-o", "a.svg"], 3);
    lone(&["diff", &path(".gcode"), "cube.stl"], 3);
    lone(&["cube.stl", "-o", &path("/a.gcode")], 4);
    lone(&["cube.stl", "-o", "a.gcode", "-p", &path(".toml")], 2);
    lone(&["cube.stl", "-o", "a.gcode", "-p", name], 2);
    lone(&[&format!("--{name}")], 2);
    // Files of this name: a broken profile, then good ones.
    fs::write(folder.path().join(path(".toml")), "walls = 1000\n").unwrap();
    lone(&["cube.stl", "-o", "a.gcode", "-p", &path(".toml")], 2);
    fs::write(folder.path().join(path(".toml")), "inherits = \"generic-marlin\"\n").unwrap();
    let (stl, gcode) = (path(".stl"), path(".gcode"));
    // A flaw, so that there is a warning.
    let mut bytes = fs::read(folder.path().join("cube.stl")).unwrap();
    bytes.push(0);
    fs::write(folder.path().join(&stl), bytes).unwrap();
    let made =
        run(&[&stl, "-o", &gcode, "-p", &path(".toml"), "--scale", "0.2", "--report", "a.json"], 0);
    assert!(made.contains("warning: ") && made.contains(shown), "{made}");
    run(&["check", &gcode, "--against", &stl, "--scale", "0.2"], 0);
    run(&["mesh", &stl, "-o", &path(".mended.stl")], 0);
    run(&["profile", "check", &path(".toml")], 0);
    run(&["profile", "show", "-v", &path(".toml")], 0);
    run(&["preview", &gcode, "-o", &path(".html")], 0);
    run(&["preview", &gcode, "--all", "-o", &path(".svg")], 0);
    for written in [gcode.as_str(), "a.json", &path(".html"), &path("-0001.svg")] {
        let text = fs::read_to_string(folder.path().join(written)).unwrap();
        let forged = text.lines().find(|line| line.starts_with("error: forged"));
        assert!(forged.is_none() && !text.contains('\u{1b}'), "{written}");
    }
}

#[test]
fn control_characters_in_blocks_are_refused_with_file_key_and_line() {
    let folder = folder();
    for (text, line) in [
        ("M104 S{temperature}\\u0000\\u001b[2J\\r\\nM140 S{bed_temperature}", 1),
        ("M104 S{temperature}\\nM117 \\u009b2J\\nM140 S{bed_temperature}", 2),
    ] {
        let profile = format!("inherits = \"generic-marlin\"\n[machine]\nend_gcode = \"{text}\"\n");
        fs::write(folder.path().join("ctrl.toml"), profile).unwrap();
        let words = ["cube.stl", "-o", "a.gcode", "-p", "ctrl.toml"];
        let run = slicer(&folder).args(words).assert().code(2);
        let told = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        let start = format!(
            "error: ctrl.toml:3: machine.end_gcode, line {line} of it: there is a control character"
        );
        assert!(told.starts_with(&start) && told.lines().count() == 1 && !acts(&told), "{told}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_utf_8_work() {
    use std::ffi::{OsStr, OsString};
    use std::os::unix::ffi::OsStrExt as _;
    let folder = folder();
    let name = |end: &str| -> OsString {
        OsStr::from_bytes(&[b"n\xff\xfe", end.as_bytes()].concat()).to_owned()
    };
    let at = |end: &str| folder.path().join(name(end));
    fs::copy(folder.path().join("cube.stl"), at(".stl")).unwrap();
    fs::write(at(".toml"), "inherits = \"generic-marlin\"\nwalls = 3\n").unwrap();
    fs::write(at(".material"), "inherits = \"pla\"\n[filament]\nname = \"Odd\"\n").unwrap();
    let run = |words: &[&dyn AsRef<OsStr>]| {
        let mut command = slicer(&folder);
        command.args(words);
        let run = command.assert().success();
        String::from_utf8(run.get_output().stdout.clone()).unwrap()
    };
    let (stl, toml, gcode, json) = (name(".stl"), name(".toml"), name(".gcode"), name(".json"));
    let material = name(".material");
    run(&[
        &stl,
        &"-o",
        &gcode,
        &"-p",
        &toml,
        &"--material",
        &material,
        &"--report",
        &json,
        &"--scale",
        &"0.2",
    ]);
    let text = fs::read_to_string(at(".gcode")).unwrap();
    assert!(text.contains("; walls = 3\n") && text.contains("; filament.name = \"Odd\"\n"));
    let report: serde_json::Value =
        serde_json::from_slice(&fs::read(at(".json")).unwrap()).unwrap();
    assert_eq!(report["models"][0]["file"], "n\u{fffd}\u{fffd}.stl");
    assert_eq!(report["profile"], "n\u{fffd}\u{fffd}.toml");
    assert!(run(&[&"check", &gcode, &"--against", &stl, &"--scale", &"0.2"]).contains("clean"));
    assert!(run(&[&"estimate", &gcode, &"-p", &toml]).contains("print time"));
    assert!(run(&[&"diff", &gcode, &gcode]).contains("equal"));
    assert!(run(&[&"mesh", &stl, &"-o", &name(".mended.stl")]).contains("no faults"));
    assert!(run(&[&"profile", &"check", &toml]).contains("good"));
    assert!(run(&[&"profile", &"show", &toml]).contains("walls = 3"));
    for end in [".svg", ".png", ".html"] {
        run(&[&"preview", &gcode, &"-o", &name(end)]);
        assert!(fs::metadata(at(end)).unwrap().len() > 100);
    }
    run(&[&"preview", &gcode, &"--all", &"-o", &name(".svg")]);
    assert!(at("-0001.svg").is_file());
    // It is known for what it is.
    slicer(&folder).arg(&stl).arg("-o").arg(&stl).assert().code(2);
}

#[cfg(unix)]
#[test]
fn devices_are_refused_and_pipes_are_read() {
    let folder = folder();
    fs::write(folder.path().join("a.gcode"), HARMFUL).unwrap();
    let words: &[&[&str]] = &[
        &["check", "/dev/zero"],
        &["estimate", "/dev/zero"],
        &["diff", "/dev/zero", "a.gcode"],
        &["roughness", "/dev/zero", "--against", "a.stl"],
        &["preview", "/dev/zero", "-o", "a.svg"],
        &["preview", "/dev/zero", "-o", "a.html"],
    ];
    for words in words {
        let run = slicer(&folder).args(*words).assert().code(3);
        let told = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        assert!(told.starts_with("error: /dev/zero: it is a device"), "{told}");
    }
    let shell = |script: &str| {
        let program = assert_cmd::cargo::cargo_bin!("slicer");
        let script = script.replace("slicer", &format!("'{}'", program.display()));
        Command::new("bash").args(["-c", &script]).current_dir(folder.path()).assert()
    };
    shell("slicer estimate - < /dev/zero").code(3);
    shell("cat a.gcode | slicer estimate -").code(0);
    shell("slicer estimate <(cat a.gcode)").code(0);
    shell("slicer estimate - < a.gcode").code(0);
}

#[test]
fn no_more_moves_are_read_than_allowed() {
    let folder = folder();
    let text = "G1 Z0.2\n".to_owned() + &"G1 X1 E1\nG1 X2 E2 ;back\n;G1\n\n".repeat(50);
    fs::write(folder.path().join("a.gcode"), text).unwrap();
    let commands: &[&[&str]] = &[
        &["check", "a.gcode"],
        &["estimate", "a.gcode"],
        &["diff", "a.gcode", "a.gcode"],
        &["preview", "a.gcode", "-o", "a.svg"],
        &["preview", "a.gcode", "-o", "a.html"],
    ];
    for words in commands {
        let run = |most: &str| slicer(&folder).args(*words).args(["--max-moves", most]).output();
        let enough = run("101").unwrap();
        assert!(!String::from_utf8(enough.stderr).unwrap().contains("--max-moves"), "{words:?}");
        assert_ne!(enough.status.code(), Some(3), "{words:?}");
        let fewer = run("100").unwrap();
        assert_eq!(fewer.status.code(), Some(3), "{words:?}");
        let told = String::from_utf8(fewer.stderr).unwrap();
        assert!(told.starts_with("error: a.gcode: it has more than 100 moves; raise --max-moves"));
    }
}
