//! G-code -> what hosts find in it: name, pictures, sums and settings, in the forms that they look for; pictures of models.
//!
//! `MOONRAKER_METADATA=…/metadata.py cargo test --test commands hosts` asks Moonraker's own script as
//! well (of 2025-10 or later; it needs Python and Pillow).

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

use crate::common::{Run, as_it_is, fixture, slice_placed};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use slicer::mesh::Placement;
use slicer::profile::recorded;
use std::path::Path;
use std::process::Command;

/// Profile, copies, settings.
type What = (&'static str, u32, &'static [(&'static str, &'static str)]);

/// Prints that differ in what hosts read.
const PRINTS: [What; 4] = [
    ("generic-klipper", 1, &[]),
    ("generic-klipper", 4, &[("dual.mode", "pair"), ("filament.name", "Galaxy \"PETG\" black")]),
    ("generic-marlin", 2, &[("first_layer_height", "0.3"), ("machine.thumbnails", "220x124")]),
    ("zcube-dual", 1, &[("dual.mode", "pair"), ("filament.name", "Blend 7")]),
];

fn print((profile, copies, set): What) -> Run {
    let placement = Placement { copies, ..as_it_is() };
    slice_placed(&fixture("bracket.stl"), profile, set, &placement)
}

/// The last MiB, which is all that hosts read of a file's end.
fn tail(text: &str) -> &str {
    let start = text.len().saturating_sub(1 << 20);
    text.get(start..).unwrap()
}

/// What follows the first `; KEY = `, as hosts look for it.
fn value<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let begin = format!("; {key} = ");
    text.lines().find_map(|line| line.strip_prefix(begin.as_str()))
}

/// Seconds of `1d 2h 3m 4s`.
fn seconds(words: &str) -> f64 {
    let unit = |word: &str| -> f64 {
        let (number, unit) = word.split_at(word.len() - 1);
        let times = [("d", 86_400.0), ("h", 3_600.0), ("m", 60.0), ("s", 1.0)];
        number.parse::<f64>().unwrap() * times.iter().find(|(name, _)| *name == unit).unwrap().1
    };
    words.split(' ').map(unit).sum()
}

/// The height after the last `;BEFORE_LAYER_CHANGE`, mm.
fn height(text: &str) -> f64 {
    let mark = ";BEFORE_LAYER_CHANGE\n;";
    let after = &text[text.rfind(mark).unwrap() + mark.len()..];
    after.lines().next().unwrap().parse().unwrap()
}

/// Width, height and PNG of each picture before the first code.
fn thumbnails(text: &str) -> Vec<([u32; 2], Vec<u8>)> {
    let head: Vec<&str> = text.lines().take_while(|line| line.starts_with(';')).collect();
    let mut found = Vec::new();
    let mut lines = head.into_iter();
    while let Some(line) = lines.next() {
        let Some(words) = line.strip_prefix("; thumbnail begin ") else { continue };
        let (size, length) = words.split_once(' ').unwrap();
        let (width, height) = size.split_once('x').unwrap();
        let data = lines.by_ref().take_while(|line| *line != "; thumbnail end");
        let letters: String = data.map(|line| line.strip_prefix("; ").unwrap()).collect();
        assert_eq!(letters.len(), length.parse::<usize>().unwrap());
        let size = [width, height].map(|side| side.parse().unwrap());
        found.push((size, STANDARD.decode(letters).unwrap()));
    }
    found
}

/// Size and share of pixels that show something.
fn seen(png: &[u8]) -> ([u32; 2], f64) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut rgba = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgba).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgba);
    let solid = rgba.chunks(4).filter(|pixel| pixel[3] == 255).count();
    ([info.width, info.height], solid as f64 / (rgba.len() / 4) as f64)
}

/// Material word that hosts sort by.
fn material(name: &str) -> Option<&'static str> {
    ["PLA", "PETG"].into_iter().find(|word| name.contains(word))
}

#[test]
fn sums_and_settings_stand_in_the_last_mib_in_the_words_of_hosts() {
    for what in PRINTS {
        let run = print(what);
        let (text, settings, report) = (tail(&run.text), &run.settings, &run.report);
        let nozzle = settings.filament.temperature;
        let bed = settings.filament.bed_temperature;
        let numbers = [
            ("layer_height", settings.layer_height, 0.0),
            ("first_layer_height", settings.first_layer_height, 0.0),
            ("filament used [mm]", report.filament.length_mm, 0.005),
            ("filament used [cm3]", report.filament.volume_cm3, 0.005),
            ("filament used [g]", report.filament.weight_g, 0.005),
            ("total filament used [g]", report.filament.weight_g, 0.005),
            ("total layers count", report.layers.count as f64, 0.0),
            ("num_layers", report.layers.count as f64, 0.0),
            ("total toolchanges", 0.0, 0.0),
            ("filament_diameter", settings.filament.diameter, 0.0),
            ("nozzle_diameter", settings.machine.nozzle_diameter, 0.0),
            ("first_layer_temperature", nozzle, 0.0),
            ("temperature", nozzle, 0.0),
            ("first_layer_bed_temperature", bed, 0.0),
            ("bed_temperature", bed, 0.0),
            ("single_extruder_multi_material", 0.0, 0.0),
        ];
        for (key, expected, slack) in numbers {
            let found: f64 = value(text, key).unwrap_or("none").parse().unwrap();
            assert!((found - expected).abs() <= slack + 1e-9, "{what:?}: {key} = {found}");
        }
        let time = seconds(value(text, "estimated printing time (normal mode)").unwrap());
        assert!((time - report.time.total_s).abs() <= 0.5, "{what:?}: {time}");
        assert!((height(text) - report.layers.top_mm).abs() < 1e-9, "{what:?}");
        let name = &settings.filament.name;
        let quoted = format!("\"{}\"", name.replace('"', "\\\""));
        assert_eq!(value(text, "filament_settings_id"), Some(quoted.as_str()));
        assert_eq!(value(text, "filament_type"), material(name));
        assert_eq!(value(text, "printer_model"), Some(settings.machine.name.as_str()));
        // Prusa's `bgcode` wants both marks and nothing but values between them.
        let (_, after) = text.split_once("\n; prusaslicer_config = begin\n").unwrap();
        let (between, _) = after.split_once("\n; prusaslicer_config = end\n").unwrap();
        assert!(between.lines().count() > 8, "{between}");
        assert!(between.lines().all(|line| line.starts_with("; ") && line.contains(" = ")));
    }
}

#[test]
fn the_name_is_ours_and_the_form_is_told() {
    let run = print(PRINTS[0]);
    let mut lines = run.text.lines();
    let first = lines.next().unwrap();
    let (name, after) =
        first.strip_prefix("; generated by ").and_then(|rest| rest.split_once(" on ")).unwrap();
    assert_eq!(name, slicer::NAME);
    // A date in form alone: it would change the bytes from day to day.
    assert!(after.starts_with("0000-00-00 at 00:00:00"), "{after}");
    // PrusaSlicer's viewer goes by the first comment with the name of a slicer that it knows, and
    // refuses what it takes for PrusaSlicer's: it must find another name before that one.
    let second = lines.next().unwrap();
    assert!(second.contains("CraftWare") && !second.contains("generated by"), "{second}");
    // For clients that know a list of slicers; those look for a version before " on".
    let third = lines.next().unwrap();
    let known = format!("; generated by PrusaSlicer compatible {} on ", slicer::NAME);
    assert!(third.starts_with(&known), "{third}");
    // They look at the first 10 000 characters. More of it would be a lie.
    assert_eq!(run.text.matches("generated by").count(), 2);
}

#[test]
fn thumbnails_show_the_models() {
    for what in PRINTS {
        let run = print(what);
        let wanted: Vec<[u32; 2]> =
            run.settings.machine.thumbnails.iter().map(|size| [size.width, size.height]).collect();
        let found = thumbnails(&run.text);
        let sizes: Vec<[u32; 2]> = found.iter().map(|(size, _)| *size).collect();
        assert_eq!(sizes, wanted, "{what:?}");
        for (size, png) in &found {
            let (inside, share) = seen(png);
            assert_eq!(inside, *size);
            // The bracket is a flat bar: by eye a fifth of a square picture.
            assert!((0.1..0.6).contains(&share), "{what:?}: {share} of {size:?} is filled");
        }
        let shares: Vec<f64> = found.iter().map(|(_, png)| seen(png).1).collect();
        let same = shares.iter().all(|share| (share - shares[0]).abs() < 0.1);
        assert!(same, "{what:?}: {shares:?}");
        assert_eq!(run.text.matches("thumbnail begin").count(), wanted.len());
    }
    assert!(print(PRINTS[3]).settings.machine.thumbnails.is_empty());
}

#[test]
fn what_is_written_for_hosts_leaves_the_settings_as_they_were() {
    for what in PRINTS {
        let run = print(what);
        let print = slicer::reader::Print::read(&mut run.text.as_bytes(), 1.75).unwrap();
        let mut read = recorded(&print.values).unwrap().unwrap().settings;
        let mut made = run.settings;
        for settings in [&mut read, &mut made] {
            // Not in the file, and decided by the model.
            settings.description.clear();
            settings.machine.start_gcode.clear();
            settings.machine.end_gcode.clear();
            settings.angle = slicer::profile::Angle::Degrees(0.0);
        }
        assert_eq!(read, made, "{what:?}");
        assert_eq!(print.layers.len(), run.report.layers.count);
    }
}

fn preview(folder: &Path, words: &[&str]) -> std::process::Output {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    command.current_dir(folder).arg("preview").args(words).output().unwrap()
}

#[test]
fn preview_draws_models_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // By its ending, and by how it begins.
    for (fixture_name, name) in
        [("bracket.stl", "a.STL"), ("bracket.stl", "binary"), ("cube_ascii.stl", "ascii.txt")]
    {
        std::fs::write(path.join(name), fixture(fixture_name)).unwrap();
        let run = preview(path, &[name, "-q", "--size", "400", "-o", "out.png"]);
        assert!(run.status.success(), "{run:?}");
        assert!(run.stdout.is_empty() && run.stderr.is_empty(), "{run:?}");
        let picture = std::fs::read(path.join("out.png")).unwrap();
        let (size, solid) = seen(&picture);
        assert_eq!((size[0].max(size[1]), solid), (400, 1.0), "{name}");
    }
    std::fs::write(path.join("cut.stl"), &fixture("bracket.stl")[..200_000]).unwrap();
    let refused: [(&[&str], i32, &str); 5] = [
        (&["cut.stl", "-o", "no.png"], 3, "it is cut off"),
        (&["none.stl", "-o", "no.png"], 3, "none.stl: cannot be read"),
        (&["a.STL", "-o", "no.svg"], 2, "use .png"),
        (&["a.STL", "-o", "no.png", "--cut", "x=0"], 2, "--cut: a.STL is a model"),
        (&["a.STL", "-o", "no.png", "--size", "4000"], 2, "at most 3000 pixels"),
    ];
    for (words, code, why) in refused {
        let run = preview(path, words);
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(code), "{said}");
        assert!(said.contains(why) && said.lines().count() == 1, "{said}");
        assert!(!path.join(words[2]).exists());
    }
}

/// What Moonraker's script says of a file.
fn moonraker(script: &str, text: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.gcode"), text).unwrap();
    let mut python = Command::new("python3");
    let run = python.args([script, "-f", "a.gcode", "-p"]).arg(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{said}");
    assert!(!said.contains("MetadataError"), "{said}");
    serde_json::from_slice::<Value>(&run.stdout).unwrap()["metadata"].take()
}

#[test]
fn moonraker_itself_reads_all_of_it() {
    let Ok(script) = std::env::var("MOONRAKER_METADATA") else {
        println!("skipped: MOONRAKER_METADATA does not name Moonraker's metadata.py");
        return;
    };
    for what in PRINTS {
        let run = print(what);
        let (settings, report) = (&run.settings, &run.report);
        let found = moonraker(&script, &run.text);
        let text = |key: &str| found[key].as_str().unwrap_or_default().to_owned();
        assert_eq!(format!("{} {}", text("slicer"), text("slicer_version")), slicer::NAME);
        let numbers = [
            ("layer_count", report.layers.count as f64, 0.0),
            ("object_height", report.layers.top_mm, 1e-9),
            ("estimated_time", report.time.total_s, 0.5),
            ("nozzle_diameter", settings.machine.nozzle_diameter, 0.0),
            ("layer_height", settings.layer_height, 0.0),
            ("first_layer_height", settings.first_layer_height, 0.0),
            ("first_layer_extr_temp", settings.filament.temperature, 0.0),
            ("first_layer_bed_temp", settings.filament.bed_temperature, 0.0),
            ("filament_total", report.filament.length_mm, 0.005),
            ("filament_weight_total", report.filament.weight_g, 0.005),
            ("filament_change_count", 0.0, 0.0),
            ("mmu_print", 0.0, 0.0),
        ];
        for (key, expected, slack) in numbers {
            let value = found[key].as_f64().unwrap_or(f64::NAN);
            assert!((value - expected).abs() <= slack + 1e-9, "{what:?}: {key} is {}", found[key]);
        }
        assert_eq!(text("filament_name"), settings.filament.name);
        assert_eq!(found["filament_type"].as_str(), material(&settings.filament.name));
        assert_eq!(text("printer_model"), settings.machine.name);
        let sizes: Vec<[u64; 2]> = found["thumbnails"].as_array().map_or(Vec::new(), |list| {
            let side = |one: &Value, key: &str| one[key].as_u64().unwrap();
            list.iter().map(|one| [side(one, "width"), side(one, "height")]).collect()
        });
        for size in &settings.machine.thumbnails {
            assert!(sizes.contains(&[size.width, size.height].map(u64::from)), "{sizes:?}");
        }
        let byte = |key: &str| found[key].as_u64().unwrap() as usize;
        let code = &run.text[byte("gcode_start_byte")..byte("gcode_end_byte")];
        assert!(code.trim_start().starts_with(['G', 'M']), "{:?}", code.get(..20));
        assert!(code.contains(";LAYER_CHANGE") && !code.contains("; thumbnail"));
    }
}
