//! Runs that fail, are killed, or get no threads -> files and reports: a failed run changes nothing and tells why.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::run::{folder, slicer};
use assert_cmd::Command;
use boon::{Compiler, Schemas};
use serde_json::Value;
use slicer::error::details::CODES;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Arguments of a quick run.
const CUBE: [&str; 6] = ["cube.stl", "-q", "-p", "generic-marlin", "--scale", "0.2"];

fn files(folder: &TempDir) -> Vec<String> {
    let entries = fs::read_dir(folder.path()).unwrap();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn report(folder: &TempDir) -> Value {
    serde_json::from_slice(&fs::read(folder.path().join("a.json")).unwrap()).unwrap()
}

/// A closed box between these heights, as facets of an ASCII STL.
pub(super) fn body(side: f64, low: f64, high: f64) -> String {
    let corner = |i: usize| {
        let [x, y] = [i & 1, i >> 1 & 1].map(|bit| if bit == 0 { 0.0 } else { side });
        format!("vertex {x} {y} {}\n", if i & 4 == 0 { low } else { high })
    };
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let facet = |triangle: [usize; 3]| {
        let corners: String = triangle.map(corner).concat();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    triangles.map(facet).collect()
}

pub(super) fn write_stl(path: &Path, bodies: &str) {
    fs::write(path, format!("solid a\n{bodies}endsolid a\n")).unwrap();
}

/// Arguments, exit code, and the report's code, file and place.
type Case<'a> = (&'a [&'a str], i32, &'a str, Option<&'a str>, &'a str);

#[test]
fn a_failure_is_reported_by_code_file_and_place() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let schema = slicer(&folder).args(["report", "schema"]).output().unwrap().stdout;
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("schema.json", serde_json::from_slice(&schema).unwrap()).unwrap();
    let index = compiler.compile("schema.json", &mut schemas).unwrap();
    write_stl(&path("hanging.stl"), &(body(10.0, 0.0, 2.0) + &body(10.0, 5.0, 8.0)));
    fs::write(path("text.stl"), "no model\n").unwrap();
    let whole = fs::read(path("cube.stl")).unwrap();
    fs::write(path("cut.stl"), &whole[..300]).unwrap();
    let broken = "solid a\nfacet normal 0 0 0\nouter lop\n";
    fs::write(path("word.stl"), broken).unwrap();
    fs::write(path("mine.toml"), "inherits = \"generic-marlin\"\n\nwalls = 1000\n").unwrap();
    let cases: &[Case] = &[
        (&["nix.stl"], 3, "unreadable", Some("nix.stl"), "null"),
        (&["text.stl"], 3, "not-a-model", Some("text.stl"), "null"),
        (&["cut.stl"], 3, "damaged", Some("cut.stl"), "null"),
        (&["word.stl"], 3, "damaged", Some("word.stl"), r#"{"line":3}"#),
        (&["cube.stl", "--max-triangles", "5"], 3, "too-large", Some("cube.stl"), "null"),
        (&["cube.stl", "--scale", "90"], 3, "does-not-fit", Some("cube.stl"), "null"),
        (&["cube.stl", "--copies", "9999"], 3, "does-not-fit", Some("cube.stl"), "null"),
        (&["cube.stl", "--scale", "0.001"], 3, "nothing-to-print", Some("cube.stl"), "null"),
        (
            &["cube.stl", "--set", "wals=1"],
            2,
            "unknown-setting",
            None,
            r#"{"given_by":"--set","key":"wals"}"#,
        ),
        (
            &["cube.stl", "-p", "mine.toml"],
            2,
            "bad-value",
            Some("mine.toml"),
            r#"{"key":"walls","line":3}"#,
        ),
        (&["cube.stl", "-p", "nix"], 2, "unknown-profile", None, "null"),
        (&["cube.stl", "-o", "no/a"], 4, "unwritable", Some("no/a"), "null"),
    ];
    for (words, exit, code, file, place) in cases {
        // An earlier run was done.
        fs::write(path("a.json"), "{}").unwrap();
        let words = [&["-q", "-o", "a.gcode", "--report", "a.json"], *words].concat();
        let run = slicer(&folder).args(&words).assert().code(*exit).stdout("");
        let told = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        let found = report(&folder);
        schemas.validate(&found, index).unwrap();
        let error = &found["error"];
        assert_eq!(error["code"], *code, "{words:?}");
        assert_eq!(error["file"].as_str(), *file, "{words:?}");
        assert_eq!(error["place"], serde_json::from_str::<Value>(place).unwrap(), "{words:?}");
        assert_eq!(told, format!("error: {}\n", error["message"].as_str().unwrap()));
        assert_eq!(found["exit_code"], *exit);
        assert!(!path("a.gcode").exists());
        let mut wrong = found.clone();
        wrong["error"]["code"] = "no-such-code".into();
        assert!(schemas.validate(&wrong, index).is_err());
    }
    let hanging = ["hanging.stl", "-q", "-o", "a.gcode", "--report", "-"];
    let run = slicer(&folder).args(hanging).assert().code(3);
    let found: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    assert_eq!(found["error"]["code"], "floats");
    assert!(found["error"]["place"]["layer"].as_u64().unwrap() > 10, "{found}");
    schemas.validate(&found, index).unwrap();
}

#[test]
fn a_report_says_what_was_written_and_with_which_exit_code() {
    let folder = folder();
    let schema = slicer(&folder).args(["report", "schema"]).output().unwrap().stdout;
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("schema.json", serde_json::from_slice(&schema).unwrap()).unwrap();
    let index = compiler.compile("schema.json", &mut schemas).unwrap();
    // Cold all along: a finding of --check, which keeps the file back.
    let cold = "machine.start_gcode=G28\nM190 S{bed_temperature}\n";
    let slow = ["--strict", "--set", "speed.skin=1"];
    for (words, exit, output) in [
        (&["-o", "./a.gcode"] as &[&str], 0, Some("./a.gcode")),
        (&["-o", "-"], 0, Some("-")),
        (&[&slow[..], &["-o", "a.gcode"]].concat(), 1, Some("a.gcode")),
        (&["--check", "--set", cold, "-o", "b.gcode"], 1, None),
    ] {
        let words = [&CUBE, words, &["--report", "a.json"]].concat();
        slicer(&folder).args(&words).assert().code(exit);
        let found = report(&folder);
        schemas.validate(&found, index).unwrap();
        assert_eq!(found["exit_code"], exit, "{words:?}");
        assert!(found["error"].is_null());
        assert_eq!(found["output"].as_str(), output, "{words:?}");
        assert!(found.as_object().unwrap().contains_key("output"));
    }
    assert!(!folder.path().join("b.gcode").exists());
}

#[test]
fn a_command_line_that_is_not_understood_is_reported_where_it_names_a_report() {
    let folder = folder();
    let path = folder.path().join("a.json");
    let wrong = ["cube.stl", "-o", "a.gcode", "--report", "a.json", "--foo"];
    for there in [None, Some("{\n  \"schema\": 5,\n  \"exit_code\": 0\n}\n")] {
        there.into_iter().for_each(|text| fs::write(&path, text).unwrap());
        slicer(&folder).args(wrong).assert().code(2);
        let told = report(&folder);
        assert_eq!((&told["exit_code"], &told["error"]["code"]), (&2.into(), &"usage".into()));
    }
    // A model may stand where the report's name was left out.
    let model = fs::read(folder.path().join("cube.stl")).unwrap();
    slicer(&folder).args(["--report", "cube.stl", "-o", "a.gcode"]).assert().code(2);
    assert_eq!(fs::read(folder.path().join("cube.stl")).unwrap(), model);
}

#[test]
fn the_page_for_scripts_lists_every_code_of_a_failure() {
    let readme = fs::read_to_string("src/cli/SCRIPTS.md").unwrap();
    for (code, exit, _) in CODES {
        assert!(readme.contains(&format!("`{code}`")), "{code}");
        let row = readme
            .lines()
            .find(|line| line.contains(&format!("`{code}`")) && line.starts_with('|'));
        assert!(row.unwrap().split('|').nth(1).unwrap().contains(&exit.to_string()), "{code}");
    }
}

/// A report that is not asked for in so many words stays as it is.
#[test]
fn a_report_that_would_replace_an_input_replaces_nothing() {
    let folder = folder();
    let before = fs::read(folder.path().join("cube.stl")).unwrap();
    let words = ["cube.stl", "-o", "a.gcode", "--report", "cube.stl"];
    slicer(&folder).args(words).assert().code(2);
    assert_eq!(fs::read(folder.path().join("cube.stl")).unwrap(), before);
    assert_eq!(files(&folder), ["cube.stl"]);
}

#[cfg(target_os = "linux")]
#[test]
fn g_code_and_report_are_put_in_place_together_or_not_at_all() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("a.gcode"), "old").unwrap();
    let run = |more: &[&str]| slicer(&folder).args(CUBE).args(more).assert();
    run(&["-o", "a.gcode", "--report", "/dev/full"]).code(4);
    assert_eq!(fs::read(path("a.gcode")).unwrap(), b"old");
    run(&["-o", "-", "--report", "/dev/full"]).code(4).stdout("");
    fs::write(path("a.json"), "{}").unwrap();
    run(&["-o", "/dev/full", "--report", "a.json"]).code(4);
    assert_eq!(report(&folder)["error"]["code"], "unwritable");
    assert_eq!(files(&folder), ["a.gcode", "a.json", "cube.stl"]);
    run(&["-o", "a.gcode", "--report", "a.json"]).code(0);
    assert!(report(&folder)["error"].is_null() && fs::read(path("a.gcode")).unwrap() != b"old");
}

/// A pipe is opened once: its reader leaves when that is closed.
#[cfg(unix)]
#[test]
fn a_failure_is_reported_to_a_pipe() {
    let folder = folder();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for words in [&["nix.stl"][..], &["cube.stl", "--set", "wals=1"], &["cube.stl", "-o", "no/a"]] {
        let reader = pipe.clone();
        let reader = std::thread::spawn(move || fs::read(reader).unwrap());
        let words = [&["-q", "-o", "a.gcode", "--report", "pipe"], words].concat();
        slicer(&folder).args(&words).timeout(std::time::Duration::from_secs(60)).assert().failure();
        let found: Value = serde_json::from_slice(&reader.join().unwrap()).unwrap();
        assert!(found["error"]["code"].is_string(), "{words:?}");
    }
}

/// Nobody reads the G-code: that is no failure, and the report is there.
#[cfg(unix)]
#[test]
fn a_reader_that_stops_reading_keeps_no_report_away() {
    let folder = folder();
    let program = assert_cmd::cargo::cargo_bin!("slicer");
    let script = format!(
        "{{ sleep 0.2; '{}' {} -o - --report a.json; echo $? >&2; }} | true",
        program.display(),
        CUBE.join(" ")
    );
    let mut shell = Command::new("sh");
    shell.args(["-c", &script]).current_dir(folder.path()).assert().stderr("0\n");
    assert!(report(&folder)["layers"]["count"].as_u64().unwrap() > 10);
}

#[cfg(unix)]
#[test]
fn permissions_and_owner_of_what_is_replaced_are_kept() {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, chown};
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("new"), "").unwrap();
    let fresh = fs::metadata(path("new")).unwrap();
    let names = ["a.gcode", "a.json", "mended.stl"];
    for mode in [0o600, 0o664] {
        for name in names {
            fs::write(path(name), "old").unwrap();
            fs::set_permissions(path(name), fs::Permissions::from_mode(mode)).unwrap();
            if fresh.uid() == 0 {
                chown(path(name), Some(65534), Some(65533)).unwrap();
            }
        }
        let owner = fs::metadata(path("a.gcode")).map(|data| (data.uid(), data.gid())).unwrap();
        slicer(&folder).args(CUBE).args(["-o", "a.gcode", "--report", "a.json"]).assert().success();
        slicer(&folder).args(["mesh", "cube.stl", "-o", "mended.stl"]).assert().success();
        for name in names {
            let data = fs::metadata(path(name)).unwrap();
            assert_eq!(data.mode() & 0o777, mode, "{name}");
            assert_eq!((data.uid(), data.gid()), owner, "{name}");
            assert!(data.len() > 3);
        }
    }
    // The report of a failure, too.
    slicer(&folder).args(["nix.stl", "-o", "a.gcode", "--report", "a.json"]).assert().code(3);
    assert_eq!(fs::metadata(path("a.json")).unwrap().mode() & 0o777, 0o664);
    slicer(&folder).args(CUBE).args(["-o", "b.gcode"]).assert().success();
    assert_eq!(fs::metadata(path("b.gcode")).unwrap().mode(), fresh.mode());
}

#[cfg(unix)]
#[test]
fn what_killed_runs_leave_is_removed_and_of_others_nothing() {
    use std::io::Write as _;
    use std::process::{Command as Process, Stdio};
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    // These two hold the locks of runs that go on, the others are left behind.
    let live = [".slicer-live.part", ".slicer-batch.part"].map(|name| {
        let file = fs::File::create(path(name)).unwrap();
        file.lock().unwrap();
        file
    });
    fs::write(path(".slicer-batch-3.part"), "half").unwrap();
    fs::write(path(".slicer-gone.part"), "half").unwrap();
    fs::write(path("a.json"), "{}").unwrap();
    let mut child = Process::new(env!("CARGO_BIN_EXE_slicer"))
        .args(["-", "-q", "-o", "a.gcode", "--report", "a.json"])
        .current_dir(folder.path())
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    // It waits for the rest of its model.
    child.stdin.as_mut().unwrap().write_all(b"solid waiting\n").unwrap();
    for _ in 0..500 {
        if !path(".slicer-gone.part").exists() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    child.kill().unwrap();
    assert_eq!(child.wait().unwrap().code(), None);
    assert_eq!(report(&folder)["error"]["code"], "unfinished");
    slicer(&folder).args(CUBE).args(["-o", "a.gcode"]).assert().success();
    let held = [".slicer-batch-3.part", ".slicer-batch.part", ".slicer-live.part"];
    assert_eq!(files(&folder), [&held[..], &["a.gcode", "a.json", "cube.stl"]].concat());
    drop(live);
    slicer(&folder).args(CUBE).args(["-o", "a.gcode"]).assert().success();
    assert_eq!(files(&folder), ["a.gcode", "a.json", "cube.stl"]);
}

#[test]
fn pictures_of_all_layers_leave_nothing_beside_them() {
    let folder = folder();
    slicer(&folder).args(CUBE).args(["-o", "a.gcode"]).assert().success();
    let draw = ["preview", "a.gcode", "--all", "-q", "-o", "p.svg"];
    // A link to another folder is followed; a folder in the way leaves none of the pictures.
    fs::create_dir(folder.path().join("p-0020.svg")).unwrap();
    slicer(&folder).args(draw).assert().code(4);
    assert_eq!(files(&folder), ["a.gcode", "cube.stl", "p-0020.svg"]);
    fs::remove_dir(folder.path().join("p-0020.svg")).unwrap();
    slicer(&folder).args(draw).assert().success();
    assert_eq!(files(&folder).len(), 22);
}

#[test]
fn a_number_of_threads_in_the_environment_is_bounded() {
    let folder = folder();
    let run = |threads: &str, out: &str| {
        let mut command = slicer(&folder);
        command.env("RAYON_NUM_THREADS", threads).args(CUBE).args(["-o", out]);
        command.assert().success();
        fs::read(folder.path().join(out)).unwrap()
    };
    let one = run("1", "one.gcode");
    for threads in ["100000", "0", "many", "99999999999999999999"] {
        assert_eq!(run(threads, "a.gcode"), one, "{threads}");
    }
}

/// A user who has no thread left. The superuser always has some: then another one runs it, if that works.
#[cfg(target_os = "linux")]
#[test]
fn without_threads_the_run_goes_on_alone() {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};
    let folder = folder();
    let root = fs::metadata(folder.path()).unwrap().uid() == 0;
    let program = assert_cmd::cargo::cargo_bin!("slicer").display().to_string();
    let as_another = "setpriv --reuid=65534 --regid=65534 --clear-groups --";
    let prefix = if root { as_another } else { "" };
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o777)).unwrap();
    let shell = |script: String| {
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", &script]).current_dir(folder.path());
        shell.output().unwrap()
    };
    if !shell(format!("{prefix} '{program}' --version")).status.success() {
        return;
    }
    slicer(&folder).args(CUBE).args(["-o", "many.gcode"]).assert().success();
    let words = CUBE.join(" ");
    let limited = format!("ulimit -u 1 && exec \"{program}\" {words} -o alone.gcode");
    let run = shell(format!("exec {prefix} bash -c '{limited}'"));
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(read("alone.gcode") == read("many.gcode"));
}
