//! Prints -> accelerations in force: tests that each line is printed with what is asked for its role, and timed with it.
//!
//! A reader of its own goes through the text, keeps what the commands say, and looks at each move.
//! Times are those that the library's reader and clock find in the file.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::{Run, beside_droop, fixture, slice, slice_shipped};
use slicer::estimate::{Options, estimate};
use slicer::motion::Limits;
use slicer::reader::{Firmware, OwnFilament};
use slicer::warning::Warning;
use std::collections::BTreeMap;

/// Each kind of line with its key, acceleration and jerk; none has those of another.
const ROLES: [(&str, &str, &str, &str); 9] = [
    ("External perimeter", "outer_wall", "500", "5"),
    ("Perimeter", "inner_wall", "800", "8"),
    ("Overhang perimeter", "overhang", "400", "4"),
    ("Solid infill", "skin", "950", "11"),
    ("Top solid infill", "top_skin", "450", "6"),
    ("Bridge infill", "bridge", "350", "3"),
    ("Internal infill", "infill", "990", "12"),
    ("Support material", "support", "850", "13"),
    ("Gap fill", "gap", "600", "7"),
];

/// The same of the first layer and of travels.
const OTHERS: [(&str, &str, &str); 2] = [("first_layer", "300", "2.5"), ("travel", "700", "14")];

/// All keys of `[acceleration]` and `[jerk]`, as `--set` takes them.
fn all_keys() -> Vec<(String, String)> {
    let roles = ROLES.iter().map(|&(_, key, acceleration, jerk)| (key, acceleration, jerk));
    let keys = roles.chain(OTHERS).flat_map(|(key, acceleration, jerk)| {
        [("acceleration", acceleration), ("jerk", jerk)]
            .map(|(table, value)| (format!("{table}.{key}"), value.to_owned()))
    });
    keys.collect()
}

fn lent(keys: &[(String, String)]) -> Vec<(&str, &str)> {
    keys.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect()
}

/// A print with every kind of line, and these keys.
fn overhang(profile: &str, keys: &[(&str, &str)]) -> Run {
    let more =
        [("support.enabled", "true"), ("dual.mode", "pair"), ("infill", "40"), ("speed.gap", "30")];
    slice(&fixture("overhang.stl"), profile, &[&more, keys].concat())
}

/// What the file has told the printer.
#[derive(Debug, Default)]
struct Told {
    /// By the letter or name of the word, after the command: `M204 P`.
    values: BTreeMap<String, f64>,
    /// Commands that said nothing new.
    repeated: usize,
}

impl Told {
    fn read(&mut self, line: &str) {
        let mut words = line.split(' ');
        let Some(command @ ("M204" | "M205" | "M566" | "SET_VELOCITY_LIMIT")) = words.next() else {
            return;
        };
        for word in words {
            let (name, value) = word.split_once('=').unwrap_or_else(|| word.split_at(1));
            let value: f64 = value.parse().unwrap();
            let before = self.values.insert(format!("{command} {name}"), value);
            self.repeated += usize::from(before == Some(value));
        }
    }

    fn is(&self, name: &str, value: f64) -> bool {
        self.values.get(name).is_some_and(|now| (now - value).abs() < 1e-9)
    }
}

/// A move of the text: the role that the comments say, or none for a travel, and whether it is on the
/// first layer.
type Seen<'a> = (Option<&'a str>, bool);

/// Goes through the layers of a file, and shows `look` each move with what is in force. Returns what is
/// in force in the end block.
fn walk<'a>(text: &'a str, mut look: impl FnMut(Seen<'a>, &Told)) -> Told {
    let print = text.find(";LAYER_CHANGE").unwrap();
    let end = text.rfind(";TYPE:Custom").unwrap();
    let (mut told, mut layers, mut role) = (Told::default(), 0, "");
    for line in text[print..end].lines() {
        told.read(line);
        layers += usize::from(line == ";LAYER_CHANGE");
        role = line.strip_prefix(";TYPE:").unwrap_or(role);
        let has = |word: &str| line.split(' ').any(|one| one.starts_with(word));
        if line.starts_with("G1 ") && (has("X") || has("Y")) {
            look((has("E").then_some(role), layers == 1), &told);
        }
    }
    told
}

/// Acceleration and jerk asked for a move.
fn asked((role, first): Seen<'_>) -> [f64; 2] {
    let of = |key: &str| OTHERS.iter().find(|other| other.0 == key).map(|&(_, a, j)| (a, j));
    let line = || {
        let role = role?.trim_end_matches(" interface");
        let found = ROLES.iter().find(|one| one.0 == role);
        found.map(|&(_, _, a, j)| (a, j))
    };
    let asked = match (role, first) {
        (None, _) => of("travel"),
        (_, true) => of("first_layer"),
        _ => line(),
    };
    let (acceleration, jerk) = asked.unwrap_or_else(|| panic!("{role:?}"));
    [acceleration, jerk].map(|number| number.parse().unwrap())
}

#[test]
fn every_move_is_driven_as_its_role_asks_in_the_dialects_own_words() {
    let keys = all_keys();
    // The words for lines, travels and corners; what a mm/s of jerk is there, and the machine's own.
    let dialects = [
        ("generic-marlin", ["M204 P", "M204 T", "M205 X", "M205 Y"], 1.0, [1000.0, 1000.0, 10.0]),
        ("witbox-2", ["M204 S", "M204 S", "M205 X", "M205 X"], 1.0, [1000.0, 1000.0, 20.0]),
        ("ultimaker-2", ["M204 S", "M204 S", "M205 X", "M205 X"], 1.0, [3000.0, 3000.0, 20.0]),
        (
            "generic-klipper",
            [
                "SET_VELOCITY_LIMIT ACCEL",
                "SET_VELOCITY_LIMIT ACCEL",
                "SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY",
                "SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY",
            ],
            1.0,
            [1000.0, 1000.0, 5.0],
        ),
        (
            "generic-reprapfirmware",
            ["M204 P", "M204 T", "M566 X", "M566 Y"],
            60.0,
            [1000.0, 1000.0, 10.0],
        ),
    ];
    for (profile, [line, travel, x, y], unit, own) in dialects {
        let run = overhang(profile, &lent(&keys));
        let mut seen: BTreeMap<Seen<'_>, usize> = BTreeMap::new();
        let end = walk(&run.text, |step, told| {
            *seen.entry(step).or_default() += 1;
            let [acceleration, jerk] = asked(step);
            let what = format!("{profile}: {step:?} {told:?}");
            assert!(told.is(if step.0.is_some() { line } else { travel }, acceleration), "{what}");
            assert!(told.is(x, unit * jerk) && told.is(y, unit * jerk), "{what}");
        });
        assert_eq!(end.repeated, 0, "{profile}");
        for role in ROLES.iter().map(|role| role.0).filter(|role| *role != "Gap fill") {
            assert!(seen.contains_key(&(Some(role), false)), "{profile}: no {role}");
        }
        // The end block has what the machine has.
        for (name, value) in [line, travel, x].into_iter().zip([own[0], own[1], unit * own[2]]) {
            assert!(end.is(name, value), "{profile}: {name} {end:?}");
        }
        assert!(end.values.len() <= 4, "{profile}: {end:?}");
    }
}

#[test]
fn junction_deviation_stands_for_a_jerk_by_marlins_formula() {
    let keys = all_keys();
    let run = overhang("ender-3", &lent(&keys));
    let end = walk(&run.text, |step, told| {
        let [acceleration, jerk] = asked(step);
        // The axes bear 500 mm/s².
        let acceleration = acceleration.min(500.0);
        // Marlin takes 0.01 to 0.3 mm.
        let deviation = (0.4 * jerk * jerk / acceleration).clamp(0.01, 0.3);
        assert!((told.values["M205 J"] - deviation).abs() < 1e-4, "{step:?} {told:?}");
    });
    assert!(end.is("M205 J", 0.08) && end.is("M204 P", 500.0), "{end:?}");
}

#[test]
fn nothing_is_told_where_nothing_is_asked_and_only_what_is_asked() {
    for profile in ["generic-marlin", "generic-klipper", "generic-reprapfirmware", "ultimaker-2"] {
        let run = slice(&fixture("tile.stl"), profile, &[]);
        assert_eq!(walk(&run.text, |_, _| {}).values.len(), 0, "{profile}");
        assert_eq!(run.report.motion, None, "{profile}");
        // What is the machine's own already is told once, and never again.
        let same = slice(&fixture("tile.stl"), profile, &[("acceleration.travel", "1000")]);
        let commands = same.text.lines().filter(|line| line.starts_with("M204 ")).count();
        assert!(commands <= 3 || profile == "ultimaker-2", "{profile}: {commands}");
    }
    let one = slice(&fixture("tile.stl"), "generic-marlin", &[("jerk.skin", "6")]);
    let told = walk(&one.text, |(role, _), told| {
        let jerk = if role.is_some_and(|role| role.ends_with("olid infill")) { 6.0 } else { 10.0 };
        assert!(told.is("M205 X", jerk), "{role:?} {told:?}");
    });
    assert!(told.values.keys().all(|name| name.starts_with("M205")), "{told:?}");
    // On a machine with one acceleration, travels get theirs, too.
    let one = slice(&fixture("tile.stl"), "generic-klipper", &[("acceleration.wall", "600")]);
    walk(&one.text, |(role, _), told| {
        let is_wall = role.is_some_and(|role| role.ends_with("erimeter"));
        let acceleration = if is_wall { 600.0 } else { 1000.0 };
        assert!(told.is("SET_VELOCITY_LIMIT ACCEL", acceleration), "{role:?} {told:?}");
    });
}

#[test]
fn no_more_is_asked_for_than_the_axes_bear() {
    let high = [
        ("limits.acceleration_x", "1500"),
        ("limits.acceleration_y", "1200"),
        ("acceleration.infill", "4000"),
        ("acceleration.travel", "1300"),
        ("acceleration.wall", "1200"),
    ];
    let run = slice(&fixture("cube_20.stl"), "generic-marlin", &high);
    let mut most: f64 = 0.0;
    walk(&run.text, |_, told| {
        let values = ["M204 P", "M204 T"].map(|name| told.values.get(name).copied());
        most = values.into_iter().flatten().fold(most, f64::max);
    });
    assert_eq!(most, 1200.0);
    let held: Vec<(&str, f64, f64)> = run
        .report
        .warnings
        .iter()
        .map(|warning| match warning {
            Warning::AccelerationHeld { setting, asked_mm_s2, given_mm_s2 } => {
                (setting.as_str(), *asked_mm_s2, *given_mm_s2)
            }
            other => panic!("{other}"),
        })
        .collect();
    let expected =
        [("acceleration.infill", 4000.0, 1200.0), ("acceleration.travel", 1300.0, 1200.0)];
    assert_eq!(held, expected);
    let drives = run.report.motion.unwrap().drives;
    let infill = drives.iter().find(|row| row.of == "infill").unwrap();
    assert_eq!((infill.acceleration_mm_s2, infill.jerk_mm_s), (Some(1200.0), None));
}

#[test]
fn a_jerk_beyond_what_marlin_takes_is_said_to_be_held() {
    let set = [("jerk.wall", "50"), ("jerk.skin", "8"), ("jerk.infill", "0.5")];
    let deviation = [("limits.junction", "deviation")];
    let run = slice(&fixture("tile.stl"), "generic-marlin", &[&set[..], &deviation].concat());
    let held: Vec<String> = run.report.warnings.iter().map(ToString::to_string).collect();
    assert!(held.len() == 2 && held[0].contains("jerk.wall = 50 is held to 27.4 mm/s"), "{held:?}");
    assert!(held[1].contains("jerk.infill = 0.5 is held to 5.0 mm/s"), "{held:?}");
    // 0.3 mm at 1000 mm/s², by 0.4 · jerk² / acceleration.
    assert!(run.text.contains("\nM205 J0.3\n"));
    let drives = run.report.motion.unwrap().drives;
    let wall = drives.iter().find(|row| row.of == "outer wall").unwrap();
    assert_eq!(wall.jerk_mm_s, Some(27.39));
    // Another rule of corners takes any.
    assert!(slice(&fixture("tile.stl"), "generic-klipper", &set).report.warnings.is_empty());
}

#[test]
fn what_the_printer_cannot_be_told_has_no_effect_and_a_warning() {
    let keys = all_keys();
    let keys = [lent(&keys), vec![("filament.pressure_advance", "0.05")]].concat();
    for profile in ["zcube-dual", "replicator-2"] {
        let plain = slice(&fixture("bracket.stl"), profile, &[]);
        let asked = slice(&fixture("bracket.stl"), profile, &keys);
        let moves = |run: &Run| run.text.split("; settings_format").next().unwrap().to_owned();
        assert!(moves(&asked) == moves(&plain), "{profile}");
        assert_eq!(asked.report.time, plain.report.time, "{profile}");
        assert_eq!(asked.report.motion, None);
        let warnings = beside_droop(&asked);
        let [Warning::NoEffect { settings, .. }] = warnings.as_slice() else {
            panic!("{profile}: {warnings:?}");
        };
        assert!(keys.iter().all(|(key, _)| settings.iter().any(|one| one == key)), "{settings:?}");
        assert_eq!(settings.len(), keys.len());
    }
    // Corners by a rule that the firmware has no command for.
    let rule = [("limits.junction", "jerk"), ("jerk.wall", "6")];
    let run = slice(&fixture("tile.stl"), "generic-klipper", &rule);
    assert!(!run.text.contains("SQUARE_CORNER"));
    let said = run.report.warnings[0].to_string();
    assert!(said.starts_with("jerk.wall has no effect: "), "{said}");
}

#[test]
fn pressure_advance_is_set_once_after_the_start_block() {
    let lines = [
        ("generic-marlin", Some("M900 K0.045")),
        ("generic-klipper", Some("SET_PRESSURE_ADVANCE ADVANCE=0.045")),
        ("generic-reprapfirmware", Some("M572 D0 S0.045")),
        ("ultimaker-2", None),
    ];
    for (profile, line) in lines {
        let plain = slice(&fixture("tile.stl"), profile, &[]);
        let run = slice(&fixture("tile.stl"), profile, &[("filament.pressure_advance", "0.045")]);
        let Some(line) = line else {
            assert!(matches!(run.report.warnings[..], [Warning::NoEffect { .. }]), "{profile}");
            continue;
        };
        let added: Vec<&str> = run.text.lines().filter(|one| *one == line).collect();
        assert_eq!(added.len(), 1, "{profile}");
        // Nothing else is changed, and the reader takes it for nothing that it does not know.
        let rest = run.text.replace(&format!("{line}\n"), "");
        let rest = rest.replace("; filament.pressure_advance = 0.045\n", "");
        assert!(rest == plain.text, "{profile}");
        assert!(run.text.find(line) < run.text.find(";LAYER_CHANGE"), "{profile}");
        let unknown = time(&run).not_counted.unknown_lines;
        assert_eq!(unknown, 0, "{profile}");
        assert_eq!(run.report.motion.unwrap().pressure_advance_s, Some(0.045));
    }
}

/// What the file takes, without its end block.
fn time(run: &Run) -> slicer::estimate::Estimate {
    let end = run.text.rfind(";TYPE:Custom").unwrap();
    let settings = &run.settings;
    let (diameter, retraction) = (settings.filament.diameter, settings.retraction.length);
    let speed = slicer::units::MmPerS(settings.retraction.speed);
    let own = Firmware::Ultimaker(OwnFilament { diameter, retraction, speed });
    let is_own = settings.machine.dialect == slicer::profile::DialectName::Ultigcode;
    let firmware = if is_own { own } else { Firmware::default() };
    let options = Options { filament_diameter: diameter, firmware, ..Options::default() };
    let text = &run.text.as_bytes()[..end];
    estimate(&mut &text[..], "test", &Limits::new(settings), options).unwrap()
}

#[test]
fn the_clock_times_what_is_told() {
    let keys = all_keys();
    let profiles = ["generic-marlin", "generic-klipper", "generic-reprapfirmware"];
    for profile in profiles.into_iter().chain(["ender-3", "witbox-2", "ultimaker-2"]) {
        let plain = overhang(profile, &[]);
        for set in [lent(&keys), vec![("acceleration.wall", "300"), ("jerk.infill", "3")]] {
            let run = overhang(profile, &set);
            let (read, said) = (time(&run), &run.report.time);
            assert_eq!(read.layers.len(), said.layers.len(), "{profile}");
            // The start block has a part in the first layer; the last has the last retraction.
            let inner = 1..read.layers.len() - 1;
            for (read, said) in read.layers[inner.clone()].iter().zip(&said.layers[inner]) {
                let apart = (read.seconds - said.time_s).abs();
                assert!(apart < 1e-3, "{profile}: {read:?} {said:?}");
            }
            // It makes a difference.
            assert!(said.total_s > 1.002 * plain.report.time.total_s, "{profile}");
        }
    }
}

#[test]
fn layers_that_are_slowed_down_take_the_least_time_with_their_accelerations() {
    // So little that the time is another by far: a cooling that knows the machine's alone would slow
    // down lines that are slow already.
    let set = [
        ("acceleration.wall", "60"),
        ("acceleration.skin", "80"),
        ("acceleration.infill", "80"),
        ("acceleration.travel", "200"),
        ("jerk.wall", "1"),
        ("cooling.min_layer_time", "30"),
    ];
    for profile in ["generic-marlin", "generic-klipper"] {
        let run = slice_shipped(&fixture("cube_20.stl"), profile, &set);
        let cooling = run.report.cooling.as_ref().unwrap();
        assert!(cooling.slowed_layers > 50 && cooling.quick_layers == 0, "{cooling:?}");
        let layers = time(&run).layers;
        let near = layers.iter().filter(|layer| (30.0..30.3).contains(&layer.seconds)).count();
        assert!(near > 50, "{profile}: {near} of {}", layers.len());
    }
}

#[test]
fn the_prusas_have_their_makers_accelerations() {
    for (profile, walls, infill) in [("prusa-mk3s", 800.0, 1000.0), ("prusa-mk4", 1500.0, 4000.0)] {
        let run = slice_shipped(&fixture("cube_20.stl"), profile, &[]);
        assert!(run.report.warnings.is_empty(), "{profile}: {:?}", run.report.warnings);
        walk(&run.text, |(role, first), told| {
            let wanted = match role {
                Some("External perimeter") if !first => walls,
                Some("Internal infill") => infill,
                _ => return,
            };
            assert!(told.is("M204 P", wanted), "{profile}: {role:?} {told:?}");
        });
    }
}

#[test]
fn on_a_raft_its_base_and_the_parts_first_layer_are_first_layers() {
    let set = [("raft.enabled", "true"), ("acceleration.first_layer", "300"), ("infill", "0")];
    let run = slice(&fixture("tile.stl"), "generic-marlin", &set);
    let (mut told, mut layer, mut seen) = (Told::default(), 0, Vec::new());
    let end = run.text.rfind(";TYPE:Custom").unwrap();
    let begin = run.text.find(";LAYER_CHANGE").unwrap();
    for line in run.text[begin..end].lines() {
        told.read(line);
        layer += usize::from(line == ";LAYER_CHANGE");
        if line.starts_with("G1 X") && line.contains(" E") {
            let acceleration = told.values["M204 P"];
            seen.resize(layer, acceleration);
            assert_eq!(seen[layer - 1], acceleration, "layer {layer}");
        }
    }
    assert_eq!(seen[..5], [300.0, 1000.0, 1000.0, 300.0, 1000.0]);
    let drives = run.report.motion.unwrap().drives;
    let base = drives.iter().find(|row| row.of == "raft base").unwrap();
    assert_eq!(base.acceleration_mm_s2, Some(300.0));
}
