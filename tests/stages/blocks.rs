//! Start and end blocks with a fault -> what `check` finds of it, and that sound ones of any kind stay clean.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::{as_it_is, fixture, slice_placed};
use slicer::check::finding::{Code, Finding, Severity};
use slicer::check::terms::Terms;
use slicer::check::{self};
use slicer::mesh::Placement;
use slicer::profile;
use slicer::reader::Print;

/// A cube of 8 mm, on 20 layers.
fn cube(printer: &str, set: &[(&str, &str)]) -> String {
    let thick = [("layer_height", "0.4"), ("first_layer_height", "0.4")];
    let small = Placement { scale: 0.4, ..as_it_is() };
    slice_placed(&fixture("cube_20.stl"), printer, &[&thick, set].concat(), &small).text
}

/// The cube with these blocks.
fn with(printer: &str, start: &str, end: &str) -> String {
    cube(printer, &[("machine.start_gcode", start), ("machine.end_gcode", end)])
}

fn judge(text: &str) -> Vec<Finding> {
    let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
    let own = profile::recorded(&print.values).unwrap();
    let settings = own.as_ref().map(|own| &own.settings);
    check::check(&print, &Terms::new(settings, settings, &print), None).findings
}

/// Asserts that these are all findings, each with the beginning of its line of the file.
#[track_caller]
fn finds(text: &str, expected: &[(Code, Severity, &str)]) {
    let found = judge(text);
    let line = |one: &Finding| {
        let line = one.place.line.map_or(0, |line| line as usize - 1);
        text.lines().nth(line).unwrap().to_owned()
    };
    let all: Vec<_> = found.iter().map(|one| (one.code, one.severity, line(one))).collect();
    let is_it = all.len() == expected.len()
        && all.iter().zip(expected).all(|(found, expected)| {
            (found.0, found.1) == (expected.0, expected.1) && found.2.starts_with(expected.2)
        });
    assert!(is_it, "{all:#?}\n{found:#?}");
}

const START: &str = "G28\nM140 S{bed_temperature}\nM104 S{temperature}\nM190 S{bed_temperature}\n\
                     M109 S{temperature}\nG1 Z5 F300";
const END: &str = "M104 S0\nM140 S0\nM84";
use Severity::{Error, Warning};

#[test]
fn sound_blocks_are_clean() {
    finds(&with("generic-marlin", START, END), &[]);
    let relative = "M140 S{bed_temperature}\nG91\nG1 Z5 F300\nG90\nG28 X Y\nG28 Z\nM190 S{bed_temperature}\n\
                    M109 R{temperature}";
    finds(&with("generic-marlin", relative, END), &[]);
    // A macro may do all of it, and Klipper's files often have no more.
    let start = "PRINT_START BED={bed_temperature} EXTRUDER={temperature}";
    finds(&with("generic-klipper", start, "PRINT_END"), &[]);
    // Duets have files of their own for it.
    let start = "G28\nM190 S{bed_temperature}\nM109 S{temperature}";
    finds(&with("generic-reprapfirmware", start, "M0"), &[]);
}

#[test]
fn what_no_slicer_has_filled_in_is_found_and_waits_for_nothing() {
    let sound = with("generic-marlin", START, END);
    for broken in ["M109 S[first_layer_temperature]", "M109 S{temperature}", "M109 S"] {
        let text = sound.replace("M109 S210", broken);
        let found = judge(&text);
        let missing = found.iter().find(|one| one.code == Code::MissingNumber).unwrap();
        let line = text.lines().nth(missing.place.line.unwrap() as usize - 1).unwrap();
        assert_eq!((line, missing.severity), (broken, Error));
        assert!(found.iter().any(|one| one.code == Code::ColdExtrusion), "{broken}");
    }
    // What others of its numbers are missing.
    for broken in ["M104 S[x]", "G1 X[x] Y5 Z30", "G1 Z5 F", "G4 P", "M221 S"] {
        let text = sound.replace("G1 Z5 F300\n", &format!("G1 Z5 F300\n{broken}\n"));
        finds(&text, &[(Code::MissingNumber, Error, broken)]);
    }
    let start = "START BED={bed_temperature} E={temperature}";
    let text = with("generic-klipper", start, "END");
    let text = text.replace("E=210", "E=[first_layer_temperature]");
    finds(&text, &[(Code::MissingNumber, Error, "START BED=60 E=[")]);
    // A file whose words are texts, and comments.
    let text =
        sound.replace("G1 Z5 F300\n", "M117 S[x] {y} [1/2]\nG1 Z5 F300 ; to [temperature]\n");
    finds(&text, &[]);
}

#[test]
fn heaters_that_stay_on_are_found() {
    let (nozzle, bed) = ((Code::LeftOn, Error, "M109 S210"), (Code::LeftOn, Warning, "M190 S60"));
    finds(&with("generic-marlin", START, "M84"), &[nozzle, bed]);
    finds(&with("generic-marlin", START, "M104 S0\nM84"), &[bed]);
    finds(&with("generic-marlin", START, "M140 S0\nM104 T0 S0\nM84"), &[]);
    finds(
        &with("generic-marlin", START, "M140 S0\nM104 S180"),
        &[(Code::LeftOn, Error, "M104 S180")],
    );
    // Filaments of several temperatures through one nozzle: no command says whose it heats.
    let start = format!("{START}\nT0\nM104 S215\nT1\nM104 S240\n");
    let found = judge(&with("generic-marlin", &start, "M140 S0\nM104 S0"));
    assert!(found.iter().all(|one| one.code != Code::LeftOn), "{found:?}");
    // The same in a file of nobody's, whose machine is not known.
    let text = with("generic-marlin", START, "M84");
    let bare = &text[..text.find("\n; settings").unwrap_or(text.len())];
    let lines = bare.lines().filter(|line| !line.starts_with("; "));
    let bare: String = lines.map(|line| format!("{line}\n")).collect();
    assert!(judge(&bare).iter().any(|one| one.code == Code::LeftOn));
}

#[test]
fn a_print_without_homing_is_found() {
    let start = START.replace("G28\n", "");
    let is = |text: &str| {
        let found = judge(text);
        let one = found.iter().find(|one| one.code == Code::NotHomed);
        one.map(|one| (one.severity, one.text.clone(), one.measure))
    };
    let (severity, text, axes) = is(&with("generic-marlin", &start, END)).unwrap();
    assert_eq!((severity, axes), (Error, 3.0));
    assert!(text.contains("homing x, y, z"), "{text}");
    let (_, text, axes) = is(&with("generic-marlin", &format!("G28 X Y\n{start}"), END)).unwrap();
    assert!(axes == 1.0 && text.contains("homing z"), "{text}");
    assert_eq!(is(&with("generic-marlin", &format!("G92 X0 Y0 Z0\n{start}"), END)), None);
    assert_eq!(is(&with("generic-klipper", &format!("HOME\n{start}"), END)), None);
    let (severity, ..) = is(&with("generic-reprapfirmware", &start, END)).unwrap();
    assert_eq!(severity, Warning);
}

#[test]
fn a_bed_that_is_off_for_the_whole_print_is_found() {
    let start = format!("{START}\nM140 S0");
    finds(&with("generic-marlin", &start, END), &[(Code::WrongTemperature, Error, "M140 S0")]);
    // Heated through, and then as hot as asked for.
    let start = START.replace("M190 S{bed_temperature}", "M190 S85\nM190 R{bed_temperature}");
    finds(&with("generic-marlin", &start, END), &[]);
}

#[test]
fn another_place_of_0_after_homing_is_told() {
    for (line, by) in [("G92 Z0.2", 0.2), ("G92 X5", 5.0)] {
        let start = START.replace("G28\n", &format!("G28\n{line}\n"));
        let found = judge(&with("generic-marlin", &start, END));
        let told = found.iter().find(|one| one.code == Code::ChangesTheMachine).unwrap();
        assert_eq!((told.severity, told.measure), (Warning, by), "{told}");
    }
    finds(&with("generic-marlin", &START.replace("G28\n", "G28\nG92 X0 Y0 Z0\n"), END), &[]);
    // Homed after a move, the axis is at 0, not where it was; and an end stop may lie far from that.
    for homed in ["G28 X Y\nG1 X100 Y100 Z10 F3000\nG28 Z\nG92 Z0\n", "G28\nG92 Z250\n"] {
        let found = judge(&with("generic-marlin", &START.replace("G28\n", homed), END));
        assert!(found.iter().all(|one| one.code != Code::ChangesTheMachine), "{found:?}");
    }
}

#[test]
fn a_flow_that_the_start_block_sets_is_deliberate() {
    for flow in ["M221 S95", "M221 S95 T0", "M221 T1 S110", "M221 S80"] {
        finds(&with("generic-marlin", &format!("{START}\n{flow}"), END), &[]);
    }
    // The sums are compared all the same.
    let text = with("generic-marlin", &format!("{START}\nM221 S95"), END);
    let sum = text.lines().find(|line| line.starts_with("; filament used [mm] = ")).unwrap();
    let found = judge(&text.replace(sum, "; filament used [mm] = 9999"));
    assert!(found.iter().any(|one| one.code == Code::WrongSums), "{found:#?}");
}

#[test]
fn a_start_block_in_inches_leaves_the_print_in_millimetres() {
    let start = START.replace("G1 Z5 F300", "G20\nG1 Z0.5 F20");
    let text = with("generic-marlin", &start, END);
    finds(&text, &[]);
    assert!(text.contains("G1 Z0.5 F20\nG21\nG90\n"), "{}", &text[..600]);
    let text = with("generic-marlin", &format!("{start}\nG21 ; mm"), END);
    assert!(text.contains("G21 ; mm\nG90\n") && !text.contains("G21\nG90\n"));
}
