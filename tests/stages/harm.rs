//! A sound file with one line more, or a few changed -> what `check` finds of what harms the machine or the print.
//!
//! Each edit is made at the start (before the first layer), in the middle (before a layer in the middle of
//! the part) or at the end (before the last command). The finding has to have the edit's line.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::{as_it_is, fixture, slice_placed};
use slicer::check::finding::{Code, Finding, Severity};
use slicer::check::terms::Terms;
use slicer::check::{self, Verdict};
use slicer::mesh::Placement;
use slicer::profile;
use slicer::reader::Print;
use std::path::Path;
use std::sync::LazyLock;

/// The cube at 8 mm, on 20 layers, from x 146 to 154 and y 146 to 154: each edit is judged in a moment.
static SOUND: LazyLock<String> = LazyLock::new(|| cube(&[]));

fn cube(set: &[(&str, &str)]) -> String {
    let thick = [("layer_height", "0.4"), ("first_layer_height", "0.4")];
    let small = Placement { scale: 0.4, ..as_it_is() };
    let set = [&thick, set].concat();
    slice_placed(&fixture("cube_20.stl"), "generic-marlin", &set, &small).text
}

/// Judged by the file's own settings, if it has any.
fn judge(text: &str) -> Verdict {
    let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
    let own = profile::recorded(&print.values).unwrap();
    let settings = own.as_ref().map(|own| &own.settings);
    check::check(&print, &Terms::new(settings, settings, &print), None)
}

/// Where an edit is made.
#[derive(Debug, Clone, Copy, PartialEq)]
enum At {
    Start,
    Middle,
    End,
}
use At::{End, Middle, Start};

/// Layer of the middle, from 0.
const MIDDLE: usize = 10;

/// `text` with lines before a place, and the first one's number.
fn with(text: &str, at: At, new: &str) -> (String, u64) {
    let mut lines: Vec<&str> = text.lines().collect();
    let layers = || (0..lines.len()).filter(|&k| lines[k] == ";LAYER_CHANGE");
    let index = match at {
        Start => layers().next().unwrap(),
        Middle => layers().nth(MIDDLE).unwrap(),
        End => lines.iter().rposition(|line| *line == "M84").unwrap(),
    };
    lines.splice(index..index, new.lines());
    (lines.join("\n") + "\n", index as u64 + 1)
}

/// The findings of a kind in the lines that were put in.
fn of_edit(verdict: &Verdict, code: Code, first: u64, count: u64) -> Vec<&Finding> {
    let is_it = |one: &&Finding| {
        one.code == code
            && one.place.line.is_some_and(|line| (first..first + count).contains(&line))
    };
    verdict.findings.iter().filter(is_it).collect()
}

/// Asserts that the edit is found with this severity, and says how much.
#[track_caller]
fn found(at: At, new: &str, code: Code, severity: Severity) -> f64 {
    let (text, line) = with(&SOUND, at, new);
    let verdict = judge(&text);
    let found = of_edit(&verdict, code, line, new.lines().count() as u64);
    let first = found.first();
    let first = first.unwrap_or_else(|| panic!("{at:?} {new:?}: {:?}", verdict.findings.first()));
    assert_eq!(first.severity, severity, "{at:?} {new:?}: {first}");
    assert_eq!(verdict.fails(), severity == Severity::Error, "{at:?} {new:?}");
    first.measure
}

/// As [`found`], of an error.
#[track_caller]
fn wrong(at: At, new: &str, code: Code) -> f64 {
    found(at, new, code, Severity::Error)
}

#[track_caller]
fn clean(text: &str, what: &str) {
    let verdict = judge(text);
    assert!(verdict.counts.is_empty(), "{what}: {}", verdict.findings[0]);
}

#[test]
fn travels_through_what_stands() {
    // 4 mm stand in the middle: the layers below it.
    for (at, new, depth) in [
        (Middle, "G0 Z0.4\nG0 X100 Y150\nG0 Z30\nG0 X150 Y150\nG0 Z4", 3.6),
        (Middle, "G0 Z30\nG0 X100 Y150\nG0 Z2\nG0 X200 Y150\nG0 Z30\nG0 X150 Y150\nG0 Z4", 2.0),
        // One layer too low.
        (Middle, "G0 Z3.6\nG0 X150 Y150\nG0 Z4", 0.4),
        (End, "G0 X150 Y150\nG0 Z-30", 38.0),
        (End, "G0 Z0.1\nG0 X100 Y100", 0.0),
        (End, "G0 X100 Y150\nG0 Z0.1\nG0 X200 Y150", 7.9),
    ] {
        let (text, line) = with(&SOUND, at, new);
        let verdict = judge(&text);
        let deepest = of_edit(&verdict, Code::ThroughPrint, line, new.lines().count() as u64);
        let deepest = deepest.iter().map(|one| one.measure).fold(0.0, f64::max);
        assert!((deepest - depth).abs() < 0.11, "{new:?}: {deepest}");
    }
}

#[test]
fn travels_over_what_stands_and_beside_it() {
    for (at, new) in [
        (Middle, "G0 X150 Y150\nG0 X100 Y100\nG0 X150 Y150"),
        (Middle, "G0 Z30\nG0 X100 Y100\nG0 Z0.4\nG0 X100 Y200\nG0 Z30\nG0 X150 Y150\nG0 Z4"),
        (End, "G0 X100 Y100\nG0 Z0.4\nG0 X144 Y144\nG0 X144 Y170\nG0 X156 Y170\nG0 X156 Y144"),
    ] {
        let new = &new.replace("Z30", "Z30 F600").replace("Y200", "Y200 F5400");
        clean(&with(&SOUND, at, new).0, new);
    }
}

#[test]
fn moves_beyond_the_machine_at_any_time() {
    for (at, new, out) in [
        (End, "G0 Z-30", 30.0),
        (Start, "G0 Y900\nG0 Y10", 600.0),
        (Middle, "G0 Y900\nG0 Y150", 600.0),
        (End, "G0 Y900", 600.0),
        (Start, "G0 X-500\nG0 X10", 500.0),
        (Middle, "G0 X-500\nG0 X150", 500.0),
        (End, "G0 X-500", 500.0),
        (Start, "G0 Z-3\nG0 Z2", 3.0),
        (Middle, "G0 Z-3\nG0 Z4", 3.0),
        (End, "G0 Z-3", 3.0),
        (End, "G0 X900000000", 899_999_700.0),
    ] {
        let measure = wrong(at, new, Code::OutsideVolume);
        assert!((measure - out).abs() < 1e-6 * out + 0.01, "{at:?} {new:?}: {measure}");
    }
    // Without a machine, too.
    let bare: String = SOUND
        .lines()
        .filter(|line| !line.starts_with("; "))
        .fold(String::new(), |text, line| text + line + "\n");
    clean(&bare, "without settings");
    for new in ["G0 X900000000", "G0 Z-3"] {
        let (text, line) = with(&bare, End, new);
        assert!(!of_edit(&judge(&text), Code::OutsideVolume, line, 1).is_empty(), "{new}");
    }
}

#[test]
fn commands_that_change_what_the_rest_relies_on() {
    for (new, measure) in [
        ("G92 X0 Y0", 0.0..170.0),
        ("G92 Z0", 3.9..4.1),
        ("M206 X5", 5.0..5.01),
        ("M206 Z-1", 1.0..1.01),
        ("M92 X160", 160.0..160.1),
        ("M92 E900", 900.0..900.1),
        ("M221 S500", 500.0..500.1),
        ("M220 S500", 500.0..500.1),
        ("M220 S10", 10.0..10.1),
        ("G28", 1.0..1.1),
        ("G28 Z", 1.0..1.1),
        ("M84", 1.0..1.1),
        ("M18", 1.0..1.1),
        ("M18 X", 1.0..1.1),
        ("M112", 1.0..1.1),
        ("M401", 1.0..1.1),
        ("G5 I0 J3 P0 Q-3 X130 Y130", 1.0..1.1),
        ("G5.1 I0 J3 X130 Y130", 1.0..1.1),
        ("G38.2 Z0", 1.0..1.1),
        ("T5", 5.0..5.1),
        ("M104 S0", 0.0..0.1),
        ("M104 S150", 150.0..150.1),
        ("M109 S150", 150.0..150.1),
        ("M104 S290", 290.0..290.1),
        ("M140 S0", 60.0..60.1),
        ("M190 S30", 30.0..30.1),
        ("M140 S200", 200.0..200.1),
        ("M302", 1.0..1.1),
        ("M302 P1", 1.0..1.1),
        ("G10 L2 P1 X5 Y5", 1.0..1.1),
        ("G55", 1.0..1.1),
        ("G29", 1.0..1.1),
        ("M502", 1.0..1.1),
        ("M851 Z-1", 1.0..1.01),
        ("M290 Z-0.5", 0.5..0.51),
        ("M211 S0", 1.0..1.1),
        ("M81", 1.0..1.1),
        ("M999", 1.0..1.1),
        ("M200 D1.75", 1.0..1.1),
        ("M107", 99.0..101.0),
    ] {
        let (text, line) = with(&SOUND, Middle, new);
        let verdict = judge(&text);
        let found = of_edit(&verdict, Code::ChangesTheMachine, line, 1);
        let errors = found.iter().filter(|one| one.severity == Severity::Error);
        let measures: Vec<f64> = errors.map(|one| one.measure).collect();
        assert!(measures.iter().any(|one| measure.contains(one)), "{new}: {measures:?}");
        assert!(verdict.fails());
    }
    for new in ["G20", "G91"] {
        let verdict = judge(&with(&SOUND, Middle, new).0);
        let has = |code| verdict.counts.iter().any(|count| count.code == code);
        assert!(has(Code::OutsideVolume), "{new}");
    }
}

#[test]
fn pauses_and_what_the_print_may_do() {
    for new in [
        "M0",
        "M1",
        "M25",
        "M226",
        "M600",
        "M601",
        "M500",
        "G28 X Y",
        "M18 E",
        "M220 S80",
        "M204 P900 T900",
    ] {
        found(Middle, new, Code::ChangesTheMachine, Severity::Warning);
    }
    for new in [
        "M105",
        "M400",
        "M73 P50",
        "M117 hello",
        "M106 S255",
        "M190 S60",
        "M104 S205",
        "M220 S100",
        "M221 S100",
        "M900 K0.05",
        "M204 S1000",
        "M84 S600",
        "T0",
        "G54",
        "M302 S170",
    ] {
        clean(&with(&SOUND, Middle, new).0, new);
    }
}

#[test]
fn what_a_start_block_may_do_and_what_not() {
    for new in [
        "M221 S95",
        "M220 S80",
        "G28",
        "G29",
        "M420 S0",
        "M84\nG28\nG1 Z2",
        "M92 E93",
        "M206 X1",
        "M302",
        "M211 S0",
        "G92 Z2",
        "M501",
        "M107",
        "M18\nG28",
    ] {
        assert!(!judge(&with(&SOUND, Start, new).0).fails(), "{new}");
    }
    for new in ["M221 S500", "M84", "T5", "M112"] {
        wrong(Start, new, Code::ChangesTheMachine);
    }
    for new in ["M92 E200", "G92 X5", "M302 P1"] {
        found(Start, new, Code::ChangesTheMachine, Severity::Warning);
    }
}

#[test]
fn what_an_end_block_may_do_and_what_not() {
    for new in
        ["M84", "G28 X Y", "M18", "M81", "M104 S0", "M109 R150\nM104 S0", "M107", "M106 S255", "M0"]
    {
        clean(&with(&SOUND, End, new).0, new);
    }
    for (new, celsius) in
        [("M104 S300", 300.0), ("M109 S240", 240.0), ("M140 S200", 200.0), ("M140 S75", 75.0)]
    {
        assert_eq!(wrong(End, new, Code::ChangesTheMachine), celsius);
    }
    assert_eq!(wrong(End, "M109 R150", Code::LeftOn), 150.0);
    wrong(End, "M112", Code::ChangesTheMachine);
    for new in ["G28", "M302"] {
        found(End, new, Code::ChangesTheMachine, Severity::Warning);
    }
}

#[test]
fn temperatures_that_no_such_material_takes() {
    let nozzle = |celsius: u32| {
        let text = SOUND.replace("M104 S210", &format!("M104 S{celsius}"));
        text.replace("M109 S210", &format!("M109 S{celsius}"))
    };
    for (text, code, celsius) in [
        (nozzle(500), Code::WrongTemperature, 500.0),
        (nozzle(290), Code::WrongTemperature, 290.0),
        (nozzle(140), Code::WrongTemperature, 140.0),
        (SOUND.replace("M190 S60", "M190 S200"), Code::WrongTemperature, 200.0),
        (SOUND.replace("M140 S60", "M140 S130"), Code::WrongTemperature, 130.0),
    ] {
        let verdict = judge(&text);
        let first = verdict.findings.iter().find(|one| one.code == code).unwrap();
        let line = text.lines().nth(first.place.line.unwrap() as usize - 1).unwrap();
        assert!(
            first.measure == celsius && line.ends_with(&format!("S{celsius}")),
            "{first}: {line}"
        );
    }
    for celsius in [0, 20] {
        let verdict = judge(&nozzle(celsius));
        assert!(verdict.counts.iter().any(|count| count.code == Code::ColdExtrusion), "{celsius}");
    }
    for celsius in [190, 230] {
        clean(&nozzle(celsius), "in the range");
    }
}

#[test]
fn a_fan_that_stays_off() {
    let off = SOUND.lines().map(|line| if line.starts_with("M106") { "M107" } else { line });
    let verdict = judge(&off.fold(String::new(), |text, line| text + line + "\n"));
    let found = &verdict.findings[0];
    assert_eq!((found.code, found.measure), (Code::ChangesTheMachine, 100.0), "{found}");
    clean(&cube(&[("filament.fan", "0"), ("cooling.bridge_fan", "0")]), "no fan wanted");
}

#[test]
fn settings_that_push_out_five_times_as_much() {
    let set = [("extrusion.multiplier", "5"), ("machine.max_volumetric_speed", "99")];
    let verdict = judge(&cube(&set));
    let found = verdict.findings.iter().find(|one| one.severity == Severity::Error).unwrap();
    assert_eq!((found.code, found.measure), (Code::Overfilled, 5.0), "{found}");
}

#[test]
fn lifts_that_no_machine_does() {
    let fast = |feed: &str| {
        let lines = SOUND.lines().map(|line| match line.rsplit_once(" F") {
            Some((lift, _)) if lift.starts_with("G0 Z") || lift.starts_with("G1 Z") => {
                format!("{lift} F{feed}\n")
            }
            _ => format!("{line}\n"),
        });
        lines.collect::<String>()
    };
    let verdict = judge(&fast("60000"));
    assert_eq!((verdict.counts[0].code, verdict.findings[0].measure), (Code::TooFast, 1000.0));
    // Beyond this machine's 16.7 mm/s.
    let verdict = judge(&fast("1800"));
    assert_eq!((verdict.counts[0].code, verdict.findings[0].measure), (Code::TooFast, 30.0));
    clean(&fast("900"), "slow lifts");
}

#[test]
fn the_part_where_the_start_block_primes() {
    let moved = |x: f64, y: f64| {
        let to = format!("G0 X{x} Y{y} F5400");
        let text = SOUND.replacen("G0 X5 Y3 F5400", &to, 1);
        text.replacen("G1 X65 E6", &format!("G1 X{} E6", x + 60.0), 1)
    };
    let verdict = judge(&moved(120.0, 150.0));
    let found = &verdict.findings[0];
    assert_eq!((found.code, found.place.layer), (Code::PrintedTwice, Some(1)), "{found}");
    assert!(found.measure > 5.0, "{found}");
    clean(&moved(120.0, 130.0), "beside the part");
}

#[test]
fn one_after_the_other() {
    clean(&sequential(false), "over the first");
    // The nozzle goes straight from the first to the second, not over it.
    let verdict = judge(&sequential(true));
    let found = verdict.findings.iter().find(|one| one.code == Code::ThroughPrint).unwrap();
    assert!((found.measure - 3.8).abs() < 0.11, "{found}");
    // Lower than what is printed there.
    assert!(!verdict.counts.iter().any(|count| count.code == Code::FallingZ));
}

/// Two towers of 4 mm by hand, one after the other; `through` lets the nozzle go low into the second's place
/// through the first.
fn sequential(through: bool) -> String {
    let mut text = "; nozzle_diameter = 0.4\nM83\nM104 S200\nM109 S200\nG28\n".to_owned();
    let area = std::f64::consts::PI * 1.75 * 1.75 / 4.0;
    let e = |length: f64| length * 0.4 * 0.2 / area;
    for (tower, x) in [(0, 50.0), (1, 100.0)] {
        if tower == 1 {
            text += if through { "G0 Z0.2\nG0 X40 Y52 F6000\n" } else { "G0 Z20\n" };
        }
        for layer in 1..=20 {
            let z = 0.2 * f64::from(layer);
            if layer == 1 {
                text += &format!(";LAYER_CHANGE\n;HEIGHT:0.2\nG0 X{x} Y50 F6000\nG0 Z{z:.1}\n");
            } else {
                text += &format!(";LAYER_CHANGE\n;HEIGHT:0.2\nG0 Z{z:.1}\nG0 X{x} Y50 F6000\n");
            }
            text += ";TYPE:External perimeter\n;WIDTH:0.4\n";
            for [dx, dy] in [[10.0, 0.0], [10.0, 10.0], [0.0, 10.0], [0.0, 0.0]] {
                text += &format!("G1 X{} Y{} E{:.5} F1800\n", x + dx, 50.0 + dy, e(10.0));
            }
        }
    }
    text + "M104 S0\n"
}

#[test]
fn without_comments_the_part_is_judged_all_the_same() {
    let code = |text: &str| {
        let lines = text.lines().map(|line| line.split(';').next().unwrap().trim_end());
        lines.filter(|line| !line.is_empty()).fold(String::new(), |all, line| all + line + "\n")
    };
    let set = [("layer_height", "0.4"), ("first_layer_height", "0.2")];
    let run = slice_placed(&fixture("cube_20.stl"), "generic-marlin", &set, &as_it_is());
    let against =
        |text: &str| crate::common::damage::judge_bare(text, "generic-marlin", "cube_20.stl");
    let verdict = against(&code(&run.text));
    assert!(verdict.counts.is_empty(), "{}", verdict.findings[0]);
    assert!(
        !verdict.not_judged.iter().any(|not| not.starts_with("the part")),
        "{:?}",
        verdict.not_judged
    );
    assert!(
        verdict.measures.outline.unwrap() > 0.999 && verdict.layers >= 50,
        "{} layers, {:?}",
        verdict.layers,
        verdict.measures
    );
    // A wall that is missing is found.
    let lines: Vec<&str> = run.text.lines().collect();
    let layer =
        lines.iter().enumerate().filter(|(_, line)| **line == ";LAYER_CHANGE").nth(25).unwrap().0;
    let wall =
        layer + lines[layer..].iter().position(|line| line.starts_with(";TYPE:External")).unwrap();
    let wall = wall + lines[wall..].iter().position(|line| line.contains(" E")).unwrap();
    let (to, e) = lines[wall].split_once(" E").unwrap();
    let e = e.split(' ').next().unwrap();
    let mut lines: Vec<String> = lines.into_iter().map(str::to_owned).collect();
    lines[wall] = format!("{to}\nG92 E{e}");
    let verdict = against(&code(&lines.join("\n")));
    let found = verdict.findings.iter().find(|one| one.code == Code::OpenOutline).unwrap();
    assert_eq!(found.place.layer, Some(26), "{found}");
}

#[test]
fn every_shipped_printer_prints_clean() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/printers");
    let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let names: Vec<String> =
        files.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    assert!(names.len() >= 14, "{names:?}");
    for name in &names {
        let any_size = [("machine.min_part_size", "0")];
        let run = slice_placed(&fixture("tile.stl"), name, &any_size, &as_it_is());
        let verdict = judge(&run.text);
        assert!(!verdict.fails(), "{name}: {}", verdict.findings[0]);
        let none_of = [Code::ThroughPrint, Code::ChangesTheMachine, Code::WrongTemperature];
        let others = verdict.counts.iter().filter(|count| none_of.contains(&count.code));
        assert_eq!(others.count(), 0, "{name}: {}", verdict.findings[0]);
    }
}
