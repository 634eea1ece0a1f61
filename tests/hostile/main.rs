//! Damaged files -> a refusal in one line, or a product: never a panic, a hang or a file left behind.
//!
//! `HOSTILE_CASES=5000 cargo test --release --test hostile` tries harder.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "../common/mod.rs"]
mod common;
mod edits;
mod properties;
mod slopes;
mod sound;
mod steps;
mod witness;

use proptest::prelude::*;
use proptest::sample::Index;
use slicer::profile::keys::{self, Key, Kind, Limits};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf()
}

fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(root().join("fixtures").join(name)).unwrap()
}

/// Cases of a property; `HOSTILE_CASES` makes them more.
fn config(cases: u32) -> ProptestConfig {
    let told = std::env::var("HOSTILE_CASES").ok().and_then(|number| number.parse().ok());
    ProptestConfig {
        cases: told.unwrap_or(cases),
        failure_persistence: None,
        max_shrink_iters: 200,
        ..ProptestConfig::default()
    }
}

/// No case takes longer; in a release build most take milliseconds.
const LONGEST: Duration = Duration::from_secs(60);

/// Runs a case, which has to end in time.
fn in_time(name: &str, case: impl FnOnce()) {
    let start = Instant::now();
    case();
    let took = start.elapsed();
    assert!(took < LONGEST, "{name}: {took:?}");
}

/// What happens to a file.
#[derive(Debug, Clone)]
enum Damage {
    Flip(Index, u8),
    Byte(Index, u8),
    Cut(Index),
    Double(Index, Index),
    Swap(Index, Index, Index),
    Float(Index, u8),
    Word(Index, u8),
    Splice(Index, u8),
}

/// Numbers that are at an edge of something, in binary files.
const FLOATS: [f32; 10] =
    [0.0, -0.0, 1e-42, 1e9, -1e9, 1.000_000_1e9, 3.4e38, f32::INFINITY, f32::NAN, 1e-7];

/// The same in texts, and words that have a meaning somewhere.
const WORDS: [&str; 25] = [
    "1e400",
    "-0",
    "0x10",
    "1_000",
    "١",
    "nan(0x1)",
    "1.",
    ".5",
    "nan",
    "-inf",
    "1e9",
    "0.000000000000000000000000000001",
    "99999999999",
    "-1",
    "0",
    "facet",
    "endfacet",
    "solid",
    "vertex",
    "G92 E0",
    "G2 X1 I1",
    "M83",
    ";LAYER_CHANGE",
    "[x]",
    "\"\"\"",
];

fn damage() -> impl Strategy<Value = Vec<Damage>> {
    let at = any::<Index>;
    let one = prop_oneof![
        (at(), 0_u8..8).prop_map(|(at, bit)| Damage::Flip(at, bit)),
        (at(), any::<u8>()).prop_map(|(at, byte)| Damage::Byte(at, byte)),
        at().prop_map(Damage::Cut),
        (at(), at()).prop_map(|(from, to)| Damage::Double(from, to)),
        (at(), at(), at()).prop_map(|(a, b, c)| Damage::Swap(a, b, c)),
        (at(), any::<u8>()).prop_map(|(at, which)| Damage::Float(at, which)),
        (at(), any::<u8>()).prop_map(|(at, which)| Damage::Word(at, which)),
        (at(), any::<u8>()).prop_map(|(at, which)| Damage::Splice(at, which)),
    ];
    prop::collection::vec(one, 0..5)
}

/// The file with the damage done; `others` are spliced in.
fn damaged(file: &[u8], damages: &[Damage], others: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = file.to_vec();
    for damage in damages {
        if bytes.is_empty() {
            return bytes;
        }
        let length = bytes.len();
        let between = |a: &Index, b: &Index| {
            let (a, b) = (a.index(length), b.index(length));
            a.min(b)..a.max(b)
        };
        match damage {
            Damage::Flip(at, bit) => bytes[at.index(length)] ^= 1 << bit,
            Damage::Byte(at, byte) => bytes[at.index(length)] = *byte,
            Damage::Cut(at) => bytes.truncate(at.index(length)),
            Damage::Double(a, b) => {
                let part = bytes[between(a, b)].to_vec();
                bytes.splice(between(a, b).start..between(a, b).start, part);
            }
            Damage::Swap(a, b, c) => {
                let part = between(a, b);
                let by = c.index(part.len().max(1));
                bytes[part].rotate_left(by);
            }
            Damage::Float(at, which) => {
                // A number of a record, or of any other place.
                let record = at.index(length.saturating_sub(84) / 50 + 1);
                let place = 84 + 50 * record + 4 * (usize::from(*which) % 12);
                let number = FLOATS[usize::from(*which) / 12 % FLOATS.len()].to_le_bytes();
                if let Some(slot) = bytes.get_mut(place..place + 4) {
                    slot.copy_from_slice(&number);
                }
            }
            Damage::Word(at, which) => {
                let blank = |&byte: &u8| byte.is_ascii_whitespace();
                let from = at.index(length);
                let from = from + bytes[from..].iter().position(blank).unwrap_or(0);
                let from = (from + 1).min(length);
                let to = from + bytes[from..].iter().position(blank).unwrap_or(0);
                let word = WORDS[usize::from(*which) % WORDS.len()];
                bytes.splice(from..to, word.bytes());
            }
            Damage::Splice(at, which) => {
                let other = &others[usize::from(*which) % others.len()];
                let at = at.index(length);
                bytes.truncate(at);
                bytes.extend_from_slice(&other[at.min(other.len())..]);
            }
        }
    }
    bytes
}

/// Small bodies, so that a case is quick.
fn models() -> Vec<Vec<u8>> {
    ["cube_20.stl", "cube_ascii.stl", "two_shells.stl", "cavity.stl"].map(fixture).to_vec()
}

/// The cubes of the fixtures are too high for a quick case.
fn low(mut binary: Vec<u8>) -> Vec<u8> {
    if binary.starts_with(b"solid") {
        return String::from_utf8(binary).unwrap().replace("20", "8").into_bytes();
    }
    for number in
        binary[84..].chunks_exact_mut(50).flat_map(|record| record[12..48].chunks_exact_mut(4))
    {
        let value = f32::from_le_bytes([number[0], number[1], number[2], number[3]]);
        number.copy_from_slice(&(value * 0.3).to_le_bytes());
    }
    binary
}

#[test]
fn damaged_models_are_refused_or_sliced() {
    let models: Vec<Vec<u8>> = models().into_iter().map(low).collect();
    models.iter().for_each(|model| properties::stl(model));
    proptest!(config(60), |(which in 0..models.len(), damages in damage())| {
        let file = damaged(&models[which], &damages, &models);
        in_time("a model", || properties::stl(&file));
    });
}

#[test]
fn damaged_profiles_are_refused_or_give_settings() {
    let names =
        ["printers/zcube-dual", "prints/thesis", "printers/generic-marlin", "materials/petg"];
    let read = |name: &&str| std::fs::read(root().join(format!("profiles/{name}.toml"))).unwrap();
    let profiles: Vec<Vec<u8>> = names.iter().map(read).collect();
    profiles.iter().for_each(|text| properties::profile(text));
    proptest!(config(100), |(which in 0..profiles.len(), damages in damage())| {
        let file = damaged(&profiles[which], &damages, &profiles);
        in_time("a profile", || properties::profile(&file));
    });
}

/// A value for a key: an edge of what it may hold, something between, or nonsense.
fn value(kind: &Kind, chance: f64, which: u8) -> String {
    let between = |min: f64, max: f64| match which % 8 {
        0 => min.to_string(),
        1 => max.to_string(),
        2 => (min + (max - min) * chance * 1e-3).to_string(),
        3 => (min + (max - min) * chance).to_string(),
        4 => format!("{:.2}", min.max(1e-3) * (max / min.max(1e-3)).powf(chance)),
        5 => "auto".to_owned(),
        6 => WORDS[usize::from(which) / 8 % WORDS.len()].to_owned(),
        _ => format!("{:.1}", min + 10.0 * chance),
    };
    match kind {
        Kind::Number { min, max } | Kind::NumberOrAuto { min, max } => between(*min, *max),
        Kind::Count { min, max } | Kind::CountOrAuto { min, max } => {
            between(f64::from(*min), f64::from(*max)).replace(".0", "")
        }
        Kind::Word(words) | Kind::Words(words) => words[usize::from(which) % words.len()].clone(),
        Kind::NumbersOrAuto(Limits { min, max, .. }) => {
            let list = [between(*min, *max), between(*max, *min)];
            list[..1 + usize::from(which / 128)].join(",")
        }
        Kind::Rows { columns, limits: Limits { min, max, .. } } => {
            let row = vec![between(*min, *max); *columns].join(",");
            format!("[{}]", vec![format!("[{row}]"); usize::from(which) % 3].join(","))
        }
        Kind::Switch => which.is_multiple_of(2).to_string(),
        _ => WORDS[usize::from(which) % WORDS.len()].to_owned(),
    }
}

#[test]
fn any_settings_are_refused_or_slice_a_part() {
    let keys: Vec<&Key> = keys::KEYS.iter().collect();
    let one = (any::<Index>(), 0.0..1.0_f64, any::<u8>());
    proptest!(config(60), |(set in prop::collection::vec(one, 1..5))| {
        let pair = |(key, chance, which): &(Index, f64, u8)| {
            let key = keys[key.index(keys.len())];
            (key.name.clone(), value(&key.kind, *chance, *which))
        };
        let set: Vec<(String, String)> = set.iter().map(pair).collect();
        in_time("settings", || properties::set(&set));
    });
}

#[test]
fn damaged_gcode_is_read_timed_checked_compared_and_drawn() {
    let clock = fixture("clock.gcode");
    let mut text = "M83\nG28\n".to_owned();
    for z in 1..6 {
        let _ = writeln!(text, ";LAYER_CHANGE\nG1 Z{}.2 F600\n;TYPE:External perimeter", z);
        for k in 0..20 {
            let _ = writeln!(text, "G1 X{} Y{} E0.{k} F1200", k * 3, k % 7 * 5);
        }
        text += "G10\nG2 X5 Y5 I2 J2 E1\nG4 P10\nM204 S500\n";
    }
    let files = [clock[..clock.len().min(20_000)].to_vec(), text.into_bytes()];
    files.iter().for_each(|file| properties::gcode(file));
    proptest!(config(60), |(which in 0..files.len(), damages in damage())| {
        let file = damaged(&files[which], &damages, &files);
        in_time("G-code", || properties::gcode(&file));
    });
}

#[test]
fn any_triangles_are_cut_into_contours_that_do_not_overlap() {
    proptest!(config(60), |(
        count in 3_u8..30,
        bytes in prop::collection::vec(any::<u8>(), 0..500),
    )| {
        properties::contours(&[&[count], &bytes[..]].concat());
    });
}

/// What has to hold of a file's bytes.
type Property = fn(&[u8]);

/// Every file that was once a fault: the folder's name says which property it goes to.
#[test]
fn what_was_once_a_fault_is_none() {
    let properties: [(&str, Property); 4] = [
        ("stl", properties::stl),
        ("profile", properties::profile),
        ("gcode", properties::gcode),
        ("contours", properties::contours),
    ];
    for (name, property) in properties {
        let Ok(folder) = std::fs::read_dir(root().join("tests/hostile").join(name)) else {
            continue;
        };
        for entry in folder {
            let path = entry.unwrap().path();
            println!("{}", path.display());
            property(&std::fs::read(path).unwrap());
        }
    }
}

/// Reads a text; the triangles that it gives, or why it gives none.
fn read(bytes: &[u8]) -> Result<usize, String> {
    properties::stl(bytes);
    let mesh = slicer::mesh::read::from_bytes("x.stl", bytes, 1000);
    mesh.map(|mesh| mesh.triangles.len()).map_err(|error| error.to_string())
}

#[test]
fn odd_texts_are_read_or_refused_with_their_line() {
    let cube = String::from_utf8(low(fixture("cube_ascii.stl"))).unwrap();
    let (_, facets) = cube.split_once('\n').unwrap();
    let named = |name: &[u8]| [b"solid ", name, b"\n", facets.as_bytes()].concat();
    let digits = format!("0.{}", "0".repeat(10_000));
    let utf16 =
        |bytes: fn(u16) -> [u8; 2]| cube.encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
    for good in [
        named(b"W\xfcrfel"),
        named("Würfel 立方体".as_bytes()),
        named(&b"x".repeat(10_000_000)),
        [b"\xef\xbb\xbf", cube.as_bytes()].concat(),
        cube.replace('\n', "\r").into_bytes(),
        cube.replacen('\n', &" ".repeat(10_000_000), 1).into_bytes(),
        cube.replace(" 0", " -0").into_bytes(),
        cube.replace(" 0", " 0.").into_bytes(),
        cube.replace(" 0", " .0e-0").into_bytes(),
        cube.replace(" 0", &format!(" {digits}")).into_bytes(),
    ] {
        assert_eq!(read(&good), Ok(12), "{}", String::from_utf8_lossy(&good[..60]));
    }
    assert_eq!(read(cube.repeat(3).as_bytes()), Ok(36));
    for word in ["1e400", "0x10", "1_000", "١", "nan(0x1)", "1,5", "--1", "1e", "∞"] {
        let said = read(cube.replacen("vertex 0", &format!("vertex {word}"), 1).as_bytes());
        assert!(
            said.as_ref().is_err_and(|said| said.starts_with("x.stl: line ")),
            "{word}: {said:?}"
        );
    }
    for (bad, says) in [
        (b"solid".to_vec(), "no triangles"),
        (utf16(u16::to_le_bytes), "UTF-16"),
        (utf16(u16::to_be_bytes), "UTF-16"),
        (
            cube.replacen("outer loop", "facet normal 0 0 0 outer loop", 1).into_bytes(),
            "'facet' stands",
        ),
        (cube.replacen("vertex", "vertex\0", 1).into_bytes(), "NUL"),
    ] {
        let said = read(&bad);
        assert!(said.as_ref().is_err_and(|said| said.contains(says)), "{says}: {said:?}");
    }
}

/// Runs the program with `bytes` at its standard input; exit code and standard error.
fn run(words: &[&str], bytes: &[u8], folder: &Path) -> (Option<i32>, String) {
    use std::io::Write as _;
    let mut child = Command::new(env!("CARGO_BIN_EXE_slicer"))
        .args(words)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A pipe that the program closes early is what is wanted.
    child.stdin.take().unwrap().write_all(bytes).ok();
    let output = child.wait_with_output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_pipe_is_read_as_a_file_is_and_a_failure_leaves_no_output() {
    let models: Vec<Vec<u8>> = models().into_iter().map(low).collect();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("x.gcode");
    proptest!(config(25), |(which in 0..models.len(), damages in damage())| {
        let bytes = damaged(&models[which], &damages, &models);
        let (code, said) = run(&["-", "-q", "-p", "witbox-1", "-o", "x.gcode"], &bytes, folder.path());
        let file = slicer::mesh::read::from_bytes("<stdin>", &bytes, 1000);
        match code {
            Some(0) => prop_assert!(std::fs::remove_file(&out).is_ok()),
            Some(3) => {
                prop_assert!(!out.exists());
                prop_assert_eq!(said.lines().count(), 1, "{}", said);
                if let Err(error) = file {
                    prop_assert_eq!(said.trim_end(), format!("error: {error}"));
                }
            }
            _ => prop_assert!(false, "{code:?}: {said}"),
        }
        prop_assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    });
}

#[test]
fn a_model_with_too_many_triangles_is_refused_with_the_flag() {
    let folder = tempfile::tempdir().unwrap();
    for (name, says) in [("cube_20.stl", "announces 12"), ("cube_ascii.stl", "has more than 11")] {
        let words = ["-", "-q", "-o", "x.gcode", "--max-triangles"];
        let (code, said) = run(&[&words[..], &["11"]].concat(), &fixture(name), folder.path());
        assert_eq!(code, Some(3), "{said}");
        assert!(said.contains(says) && said.contains("--max-triangles"), "{said}");
        let (code, said) = run(&[&words[..], &["12"]].concat(), &fixture(name), folder.path());
        assert_eq!(code, Some(0), "{said}");
        std::fs::remove_file(folder.path().join("x.gcode")).unwrap();
    }
    let words = ["-", "-q", "-o", "x.gcode", "--copies", "4", "--max-triangles", "40"];
    let (code, said) = run(&words, &fixture("cube_20.stl"), folder.path());
    assert!(code == Some(3) && said.contains("48 triangles, and 40 are allowed"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_source_that_never_ends_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["/dev/zero", "/dev/urandom"] {
        let (code, said) = run(&[name, "-q", "-o", "x.gcode"], b"", folder.path());
        assert!(code == Some(3) && said.lines().count() == 1, "{said}");
    }
    let (code, said) = run(&["-", "-o", "x.gcode", "-p", "/dev/zero"], b"", folder.path());
    assert!(code == Some(2) && said.contains("larger than any profile"), "{said}");
    // 40 MB of text, of which far less may be read.
    let text = b"solid\n".repeat(7_000_000);
    let (code, said) = run(&["-", "-q", "-o", "x.gcode"], &text, folder.path());
    assert!(code == Some(3) && said.contains("only 0 triangles until here"), "{said}");
}
