//! Every shipped printer, material and print together -> a file that passes the check; dialects read back alike.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::Solid;
use crate::common::{as_it_is, fixture};
use rayon::prelude::*;
use slicer::check::finding::Code;
use slicer::check::terms::Terms;
use slicer::check::{Verdict, check};
use slicer::estimate::{Estimate, Options, estimate};
use slicer::motion::Limits;
use slicer::profile::{
    DialectName, Override, ProfileKind, Settings, Shelf, ValueOrigin, Wanted, load_from,
};
use slicer::progress::Progress;
use slicer::reader::{Firmware, OwnFilament, Print, Role};
use slicer::units::MmPerS;
use slicer::{Job, Model, profile};

/// Names of the shipped profiles of a kind.
pub(crate) fn names(kind: ProfileKind) -> Vec<String> {
    let all = Shelf::default().all();
    all.into_iter().filter(|found| found.kind == Some(kind)).map(|found| found.name).collect()
}

fn settings(wanted: &[Wanted], set: &[(&str, &str)]) -> Settings {
    let given = |(key, value): &(&str, &str)| Override {
        key: (*key).to_owned(),
        value: (*value).to_owned(),
        origin: ValueOrigin::Set,
    };
    let set: Vec<Override> = set.iter().map(given).collect();
    load_from(&Shelf::default(), wanted, &set).unwrap().settings
}

fn slice(stl: &[u8], settings: &Settings) -> String {
    let job = Job {
        models: vec![Model::bytes("model.stl", stl)],
        placement: as_it_is(),
        settings: settings.clone(),
        sources: profile::Sources::default(),
    };
    let mut out = std::io::Cursor::new(Vec::new());
    slicer::slice(&job, &mut out, &Progress::default()).unwrap();
    String::from_utf8(out.into_inner()).unwrap()
}

/// The rules by which a printer reads its files.
fn firmware(settings: &Settings) -> Firmware {
    match settings.machine.dialect {
        DialectName::Marlin => Firmware::Marlin,
        DialectName::Klipper => Firmware::Klipper,
        DialectName::Reprapfirmware => Firmware::RepRap,
        DialectName::Makerbot => Firmware::Sailfish,
        DialectName::Ultigcode => Firmware::Ultimaker(OwnFilament {
            diameter: settings.filament.diameter,
            retraction: settings.retraction.length,
            speed: MmPerS(settings.retraction.speed),
        }),
    }
}

fn read(text: &str, settings: &Settings) -> Print {
    let diameter = settings.filament.diameter;
    Print::read_as(&mut text.as_bytes(), firmware(settings), diameter).unwrap()
}

fn verdict(text: &str, settings: &Settings) -> Verdict {
    let print = read(text, settings);
    check(&print, &Terms::new(Some(settings), Some(settings), &print), None)
}

fn passes(stl: &[u8], names: [&str; 3]) {
    let kinds = [ProfileKind::Printer, ProfileKind::Material, ProfileKind::Print];
    let wanted = [0, 1, 2].map(|k| Wanted::of(kinds[k], names[k]));
    // Pictures are slow to draw, and no part of the print; the block is too small for some.
    let set = [("machine.thumbnails", "[]"), ("machine.min_part_size", "0")];
    let settings = settings(&wanted, &set);
    let verdict = verdict(&slice(stl, &settings), &settings);
    assert!(!verdict.fails(), "{names:?}: {:?}", verdict.findings);
    // A layer of strands on the block is nine.
    assert!(verdict.moves > 5, "{names:?}");
}

#[test]
fn every_printer_prints_every_material_in_every_way() {
    let [printers, materials, prints] = ProfileKind::ALL.map(names);
    let block = Solid::cuboid([0.0; 3], [4.0, 4.0, 0.8]).stl();
    let jobs: Vec<[&str; 3]> = printers
        .iter()
        .flat_map(|a| materials.iter().map(move |b| (a, b)))
        .flat_map(|(a, b)| prints.iter().map(move |c| [a.as_str(), b, c]))
        // Strands of 1 mm leave no other nozzle.
        .filter(|[printer, _, print]| *print != "strand" || *printer == "narino")
        .collect();
    assert!(jobs.len() >= 14 * 6 * 6, "{}", jobs.len());
    jobs.par_iter().for_each(|names| passes(&block, *names));
}

/// RepRapFirmware and the Duet Software Framework read a file from its end: the first height that they
/// find is the part's, but for moves whose comment begins with an E.
#[test]
fn reprapfirmware_does_not_take_the_parking_height_for_the_parts() {
    let named = |name: &String| settings(&[Wanted::of(ProfileKind::Printer, name.as_str())], &[]);
    let dialect = DialectName::Reprapfirmware;
    let all: Vec<Settings> = names(ProfileKind::Printer).iter().map(named).collect();
    for settings in all.iter().filter(|settings| settings.machine.dialect == dialect) {
        let raised = settings.machine.end_gcode.lines().filter(|line| line.contains('Z'));
        let comments: Vec<&str> = raised.map(|line| line.split_once("; ").unwrap().1).collect();
        assert!(!comments.is_empty(), "{}", settings.machine.name);
        assert!(comments.iter().all(|comment| comment.starts_with('E')), "{comments:?}");
    }
}

#[test]
fn one_printer_of_each_kind_prints_the_bracket() {
    let bracket = fixture("bracket.stl");
    let jobs = [
        ["replicator-2", "pla", "strong"],
        ["prusa-mk3s", "petg", "standard"],
        ["voron-2.4", "abs", "draft"],
        ["ultimaker-2", "tpu", "one-wall"],
        ["generic-reprapfirmware", "asa", "fine"],
    ];
    jobs.par_iter().for_each(|names| passes(&bracket, *names));
}

/// Two blocks in a dialect, with the same motion for all of them, and how it reads.
fn in_dialect(dialect: &str) -> (String, Print, Estimate) {
    let set = [
        ("machine.dialect", dialect),
        ("machine.start_gcode", ""),
        ("machine.end_gcode", ""),
        ("filament.bed_temperature", "0"),
        ("filament.diameter", "2.85"),
        ("retraction.length", "4.5"),
        ("machine.thumbnails", "[]"),
    ];
    let settings = settings(&[Wanted::any("generic-marlin")], &set);
    let block = || Solid::cuboid([0.0; 3], [8.0, 6.0, 2.0]);
    let text = slice(&block().and(&block().shifted([15.0, 0.0, 0.0])).stl(), &settings);
    let print = read(&text, &settings);
    let options = Options {
        filament_diameter: settings.filament.diameter,
        fixed_limits: true,
        firmware: firmware(&settings),
        volumes: None,
    };
    let time = estimate(&mut text.as_bytes(), "a", &Limits::new(&settings), options).unwrap();
    (text, print, time)
}

#[test]
fn dialects_read_back_to_the_same_moves_filament_and_time() {
    let (_, marlin, time) = in_dialect("marlin");
    assert!(marlin.moves.iter().any(|step| step.filament < 0.0));
    for dialect in ["reprapfirmware", "ultigcode"] {
        let (_, print, its_time) = in_dialect(dialect);
        assert_eq!(print.moves.len(), marlin.moves.len(), "{dialect}");
        for (a, b) in print.moves.iter().zip(&marlin.moves) {
            assert_eq!(
                (a.from, a.to, a.role),
                (b.from, b.to, b.role),
                "{dialect}: line {}",
                a.line
            );
            assert_eq!((a.width, a.height), (b.width, b.height), "{dialect}: line {}", a.line);
            assert!((a.feed - b.feed).abs() < 0.01, "{dialect}: line {}", a.line);
            assert!((a.filament - b.filament).abs() < 3e-5, "{dialect}: line {}", a.line);
        }
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-4 * b, "{dialect}: {a} {b}");
        near(its_time.filament_mm, time.filament_mm);
        near(its_time.seconds, time.seconds);
        // On the way of a short move, whose E has few digits.
        let peaks = [its_time.peak_flow_mm3_s, time.peak_flow_mm3_s];
        assert!((peaks[0] - peaks[1]).abs() < 2e-3 * peaks[1], "{dialect}: {peaks:?}");
        assert_eq!(its_time.not_counted.firmware_retractions, 0, "{dialect}");
    }
}

#[test]
fn an_ultimakers_file_says_what_its_printer_asks_for_and_nothing_more() {
    let (text, print, time) = in_dialect("ultigcode");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], ";FLAVOR:UltiGCode");
    let number =
        |line: &str, key: &str| -> f64 { line.strip_prefix(key).unwrap().trim().parse().unwrap() };
    let (seconds, plastic) = (number(lines[1], ";TIME:"), number(lines[2], ";MATERIAL:"));
    // The way from the origin to the print is not the slicer's: it does not know where the head is.
    let way = f64::hypot(150.0, 150.0) / 90.0;
    assert!((seconds + way - time.seconds).abs() < 1.5, "{seconds} {}", time.seconds);
    let area = std::f64::consts::PI * 2.85 * 2.85 / 4.0;
    let used: f64 = print.lines().map(|step| f64::from(step.filament) * area).sum();
    assert!((plastic - used).abs() < 1.0 + 1e-4 * used, "{plastic} {used}");
    let code = lines.iter().filter(|line| !line.starts_with(';') && !line.is_empty());
    let mut words: Vec<&str> = code.map(|line| line.split_whitespace().next().unwrap()).collect();
    words.sort_unstable();
    words.dedup();
    assert_eq!(words, ["G1", "G10", "G11", "G90", "G92", "M106", "M82"]);
}

#[test]
fn a_file_of_volumes_is_known_without_a_profile() {
    let (text, with, _) = in_dialect("ultigcode");
    let without = Print::read(&mut text.as_bytes(), 1.75).unwrap();
    assert_eq!(without.filament_diameter, 2.85);
    for (a, b) in with.lines().zip(without.lines()) {
        assert!((a.filament - b.filament).abs() <= 1e-6 * b.filament, "line {}", a.line);
    }
    let own = profile::recorded(&without.values).unwrap().unwrap().settings;
    let terms = Terms::new(Some(&own), Some(&own), &without);
    assert!(!check(&without, &terms, None).fails());
}

#[test]
fn a_macro_that_does_everything_is_a_start_block() {
    for (relative, mode) in [("true", "M83"), ("false", "M82")] {
        let set = [
            ("machine.start_gcode", "PRINT_START BED={bed_temperature} EXTRUDER={temperature}"),
            ("machine.relative_e", relative),
        ];
        let settings = settings(&[Wanted::any("generic-klipper")], &set);
        let text = slice(&Solid::cuboid([0.0; 3], [6.0, 5.0, 1.0]).stl(), &settings);
        let modes: Vec<&str> = text.lines().filter(|line| ["M82", "M83"].contains(line)).collect();
        assert_eq!(modes, [mode]);
        // A macro may end with relative coordinates.
        assert!(text.contains(&format!("\nG90\n{mode}\n")));
        let start = text.find("PRINT_START BED=60 EXTRUDER=210\n").unwrap();
        assert!(text.find(mode).unwrap() > start);
    }
}

/// What is outside the volume, as the check says it.
fn outside(text: &str, settings: &Settings) -> Vec<String> {
    let findings = verdict(text, settings).findings;
    let outside = findings.into_iter().filter(|found| found.code == Code::OutsideVolume);
    outside.map(|found| found.text).collect()
}

#[test]
fn the_nozzle_may_go_where_no_part_may_lie() {
    let block = Solid::cuboid([0.0; 3], [6.0, 5.0, 1.0]).stl();
    let stated = settings(&[Wanted::any("prusa-mk3s")], &[]);
    let text = slice(&block, &stated);
    assert!(text.contains("G0 X5 Y-3 "), "the nozzle is no longer primed beside the sheet");
    assert_eq!(outside(&text, &stated), Vec::<String>::new());
    let nearer = settings(&[Wanted::any("prusa-mk3s")], &[("machine.reach.min_y", "-1")]);
    let found = outside(&text, &nearer);
    assert!(found[0].contains("2 mm beyond the nozzle's y of -1 to 212.5"), "{found:?}");
    // A line of the print there is another matter.
    let first = text.find(";TYPE:External perimeter").unwrap();
    let beside = format!("{};TYPE:Skirt\nG1 Y-2\nG1 X30 E5\n{}", &text[..first], &text[first..]);
    let found = outside(&beside, &stated);
    assert!(found[0].contains("2 mm beyond the machine's y of 0 to 210"), "{found:?}");
}

#[test]
fn what_shrinks_is_printed_larger_by_that() {
    let block = Solid::cuboid([0.0; 3], [49.0, 19.6, 9.9]).stl();
    let set = [("filament.shrinkage", "2"), ("filament.shrinkage_z", "1"), ("brim.where", "off")];
    let settings = settings(&[Wanted::any("generic-marlin")], &set);
    let print = read(&slice(&block, &settings), &settings);
    let walls = print.moves.iter().filter(|step| step.is_line() && step.role == Role::OuterWall);
    let (mut low, mut high) = ([f32::MAX; 2], [f32::MIN; 2]);
    for step in walls {
        for axis in 0..2 {
            low[axis] = low[axis].min(step.to[axis]);
            high[axis] = high[axis].max(step.to[axis]);
        }
    }
    // Middles of lines of 0.4 mm.
    for (axis, size) in [(0, 50.0), (1, 20.0)] {
        assert!((high[axis] - low[axis] + 0.4 - size).abs() < 0.01, "{low:?} {high:?}");
    }
    assert_eq!(print.layers.len(), 50);
}
