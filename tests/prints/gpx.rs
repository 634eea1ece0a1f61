//! Blocks and prints of every printer that goes through GPX, for every material -> GPX: not a word of complaint.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

use crate::printers::names;
use slicer::profile::template::{PrintFacts, render, values};
use slicer::profile::{DialectName, ProfileKind, load};
use std::fs;
use std::process::Command;

/// Converts `gcode`; GPX's exit code is always 0, so its silence is the only proof.
fn assert_silent(gcode: &str, machine: &str, least_bytes: u64, what: &str) {
    let folder = tempfile::tempdir().unwrap();
    let (from, to) = (folder.path().join("a.gcode"), folder.path().join("a.x3g"));
    fs::write(&from, gcode).unwrap();
    let run = Command::new("gpx").args(["-I", "-m", machine]).args([&from, &to]).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&run.stdout), "", "{what}");
    assert_eq!(String::from_utf8_lossy(&run.stderr), "", "{what}");
    // Silence alone would also come from doing nothing.
    let bytes = fs::metadata(&to).unwrap().len();
    assert!(bytes > least_bytes, "{what}: only {bytes} bytes");
}

/// GPX's name of a printer.
fn machine(printer: &str) -> &'static str {
    match printer {
        "replicator-2" => "r2",
        "replicator-2x" => "r2x",
        _ => "r1d",
    }
}

fn is_installed() -> bool {
    let is = Command::new("gpx").arg("-?").output().is_ok();
    if !is {
        println!("skipped: gpx is not installed");
    }
    is
}

/// The shipped printers whose files go through GPX.
fn printers() -> Vec<String> {
    let dialect = |name: &str| load([name], &[]).unwrap().settings.machine.dialect;
    let mut printers = names(ProfileKind::Printer);
    printers.retain(|name| dialect(name) == DialectName::Makerbot);
    assert!(printers.len() >= 4, "{printers:?}");
    printers
}

#[test]
fn blocks_convert_in_silence() {
    if !is_installed() {
        return;
    }
    for printer in printers() {
        for material in names(ProfileKind::Material) {
            let settings = load([&printer, &material], &[]).unwrap().settings;
            let values = values(&settings, &PrintFacts { height: 10.0, ..PrintFacts::default() });
            let block = |key, text: &str| render(key, text, &values).unwrap();
            let start = block("machine.start_gcode", &settings.machine.start_gcode);
            let end = block("machine.end_gcode", &settings.machine.end_gcode);
            let print = "G1 X0 Y0 Z0.2 F5400\nG1 X10 Y0 E0.5 F1620\n";
            let what = format!("{printer} {material}");
            assert_silent(&format!("{start}{print}{end}"), machine(&printer), 200, &what);
        }
    }
}

#[test]
fn whole_prints_convert_in_silence() {
    if !is_installed() {
        return;
    }
    for profile in printers().into_iter().chain(["thesis".to_owned()]) {
        for (name, fan) in [("bracket.stl", "0"), ("overhang.stl", "100")] {
            let set = [("dual.mode", "pair"), ("support.enabled", "true"), ("filament.fan", fan)];
            let run = crate::common::slice(&crate::common::fixture(name), &profile, &set);
            // A move takes 40 bytes or so.
            let moves = run.print.moves.len() as u64;
            assert!(moves > 1000, "{name}");
            let what = format!("{name} {profile}");
            assert_silent(&run.text, machine(&profile), 20 * moves, &what);
        }
    }
}
