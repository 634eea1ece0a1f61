//! Schemas that the program prints, and files -> verdict of a validator that is not ours.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use assert_cmd::Command;
use boon::{Compiler, Schemas};
use serde_json::Value;
use slicer::profile::builtin_names;
use slicer::profile::foreign;
use slicer::profile::keys::{KEYS, Key, Kind};
use std::fs;

fn slicer(words: &[&str]) -> Value {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    let run = command.args(words).assert().success();
    serde_json::from_slice(&run.get_output().stdout).unwrap()
}

/// The schema that these words print, as a question: is this value as it says?
fn validator(words: &[&str]) -> impl Fn(&Value) -> Result<(), String> {
    let mut schemas = Schemas::new();
    let mut compiler = Compiler::new();
    compiler.add_resource("schema.json", slicer(words)).unwrap();
    let index = compiler.compile("schema.json", &mut schemas).unwrap();
    move |value| schemas.validate(value, index).map_err(|error| error.to_string())
}

#[test]
fn shipped_profiles_are_as_their_schema_says_and_wrong_ones_are_not() {
    let is_valid = validator(&["profile", "schema"]);
    let read = |text: &str| toml::from_str::<Value>(text).unwrap();
    let mut count = 0;
    for kind in ["printers", "materials", "prints"] {
        for entry in fs::read_dir(format!("profiles/{kind}")).unwrap() {
            let path = entry.unwrap().path();
            is_valid(&read(&fs::read_to_string(&path).unwrap())).unwrap();
            count += 1;
        }
    }
    assert_eq!(count, builtin_names().count());
    for text in [
        "inherits = \"thesis\"",
        "inherits = [\"ender-3\", \"petg\"]\n[defaults]\nprint = \"fine\"",
        "angle = \"auto\"\n[dual]\nratio = 3\nparts = [\"infill\"]",
        "angle = -90.5\n[machine]\nthumbnails = [\"32x32\"]\n[support]\nenabled = true",
    ] {
        is_valid(&read(text)).unwrap();
    }
    for text in [
        "wals = 2",
        "[defaults]\nprinte = \"fine\"",
        "walls = -1",
        "walls = 2.5",
        "seam = \"reer\"",
        "angle = 400",
        "[speed]\nwall = 1620",
        "[speed]\nwal = 20",
        "[dual]\nratio = 1",
        "[dual]\nparts = [\"walls\"]",
        "[machine]\nthumbnails = [\"large\"]",
        "[filament]\nname = 7",
    ] {
        assert!(is_valid(&read(text)).is_err(), "{text}");
    }
    // What is shown is a profile, too.
    let show = Command::new(assert_cmd::cargo::cargo_bin!("slicer"))
        .args(["profile", "show", "thesis", "-v"])
        .output()
        .unwrap();
    is_valid(&read(&String::from_utf8(show.stdout).unwrap())).unwrap();
}

#[test]
fn reports_are_as_their_schema_says() {
    let is_valid = validator(&["report", "schema"]);
    let reports = [
        &["fixtures/bracket.stl", "--dual", "--check"][..],
        &["fixtures/overhang.stl", "--support", "-p", "generic-marlin", "--set", "speed.wall=1"],
        &["fixtures/tile.stl", "-p", "replicator"],
        // Its middle is thinner than a line of this width, and the flow is more than is molten.
        &["fixtures/tile.stl", "--line-width", "1", "--set", "machine.max_volumetric_speed=1"],
    ];
    let mut codes = Vec::new();
    for words in reports {
        let report = slicer(&[words, &["-q", "-o", "/dev/null", "--report", "-"]].concat());
        is_valid(&report).unwrap();
        let warnings = report["warnings"].as_array().unwrap();
        codes.extend(warnings.iter().map(|one| one["code"].as_str().unwrap().to_owned()));
        let mut wrong = report.clone();
        wrong["layers"]["count"] = "many".into();
        assert!(is_valid(&wrong).is_err());
    }
    assert!(codes.iter().any(|code| code == "slow-speed"), "{codes:?}");
    assert!(codes.iter().any(|code| code == "flow-limited"), "{codes:?}");
}

const LIST: &str = "profiles/README.md";
const BEGIN: &str = "<!-- keys: begin -->\n";
const END: &str = "<!-- keys: end -->\n";

/// A table for each table of a profile, with a row for each key.
fn list_of_keys() -> String {
    let mut text = String::new();
    let mut table = None;
    for key in KEYS.iter() {
        let (inside, name) = key.name.split_once('.').unwrap_or(("", &key.name));
        if table.replace(inside) != Some(inside) {
            let head =
                if inside.is_empty() { String::new() } else { format!("\n### `[{inside}]`\n") };
            text += &format!(
                "{head}\n| key | unit | allowed | default | meaning |\n|---|---|---|---|---|\n"
            );
        }
        let allowed = match key.kind {
            Kind::Switch => "`true`, `false`".to_owned(),
            Kind::Text | Kind::Block => "text".to_owned(),
            _ => key.allowed().replace(" | ", ", "),
        };
        let default = default(key);
        text += &format!("| `{name}` | {} | {allowed} | {default} | {} |\n", key.unit, key.doc);
    }
    text + "\n"
}

fn default(key: &Key) -> String {
    match &key.default {
        Some(value) => format!("`{}`", value.to_string().replace('"', "")),
        None if key.optional => "unset".to_owned(),
        None => String::new(),
    }
}

/// Our keys beside their names in other slicers.
fn list_of_names() -> String {
    let row = |(ours, theirs): (&str, foreign::Names)| {
        let list = |names: &[&str]| -> String {
            let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
            names.join(", ")
        };
        let [prusa, orca, cura] = theirs.map(list);
        format!("| `{ours}` | {prusa} | {orca} | {cura} |\n")
    };
    let rows: String = foreign::names().map(row).collect();
    let head = "| here | PrusaSlicer, Slic3r | OrcaSlicer, if other | Cura |\n|---|---|---|---|";
    format!("\n{head}\n{rows}\n")
}

/// Compares what stands in the list of profiles between two marks with what is `made` for it.
fn is_as_declared(begin: &str, end: &str, made: &str) {
    let kept = fs::read_to_string(LIST).unwrap();
    let (before, rest) = kept.split_once(begin).unwrap();
    let (_, after) = rest.split_once(end).unwrap();
    let made = format!("{before}{begin}{made}{end}{after}");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::write(LIST, made).unwrap();
        panic!("{LIST} is rewritten; look at it, and unset UPDATE_GOLDEN");
    }
    assert!(
        kept == made,
        "{LIST} does not list what src/profile/ declares; see \"All keys\" there"
    );
}

#[test]
fn the_list_of_keys_is_as_declared() {
    is_as_declared(BEGIN, END, &list_of_keys());
}

#[test]
fn the_list_of_names_is_as_declared() {
    is_as_declared("<!-- names: begin -->\n", "<!-- names: end -->\n", &list_of_names());
}

#[test]
fn the_list_of_placeholders_is_whole() {
    let settings = slicer::profile::load(["generic-marlin"], &[]).unwrap().settings;
    let text = fs::read_to_string(LIST).unwrap();
    for (name, _) in slicer::profile::template::values(&settings, &Default::default()) {
        assert!(text.contains(&format!("`{{{name}}}`")), "{name}");
    }
}
