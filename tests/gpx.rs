//! Start and end blocks for MakerBot machines -> GPX: it converts them without a word.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use slicer::gcode::template::{PrintFacts, render, values};
use slicer::profile::{DialectName, builtin_names, load};
use std::fs;
use std::process::Command;

/// GPX's exit code is always 0, so its silence is the only proof.
#[test]
fn blocks_convert_in_silence() {
    if Command::new("gpx").arg("-?").output().is_err() {
        println!("skipped: gpx is not installed");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for name in builtin_names() {
        let settings = load(name, &[]).unwrap().settings;
        if settings.machine.dialect != DialectName::Makerbot {
            continue;
        }
        let values = values(&settings, &PrintFacts { height: 10.0, ..PrintFacts::default() });
        let start = render("machine.start", &settings.machine.start, &values).unwrap();
        let end = render("machine.end", &settings.machine.end, &values).unwrap();
        let (gcode, x3g) = (folder.path().join("a.gcode"), folder.path().join("a.x3g"));
        let print = "G1 X0 Y0 Z0.2 F5400\nG1 X10 Y0 E0.5 F1620\n";
        fs::write(&gcode, format!("{start}{print}{end}")).unwrap();
        let run =
            Command::new("gpx").args(["-I", "-m", "r1d"]).args([&gcode, &x3g]).output().unwrap();
        assert_eq!(String::from_utf8_lossy(&run.stdout), "", "{name}");
        assert_eq!(String::from_utf8_lossy(&run.stderr), "", "{name}");
        // Silence alone would also come from doing nothing.
        assert!(fs::metadata(&x3g).unwrap().len() > 200, "{name}");
        fs::remove_file(&x3g).unwrap();
    }
}
