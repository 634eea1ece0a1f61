//! Several models on a bed whose start block primes a line -> where they lie, and how many are said to fit.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::run::{folder, slicer};

/// Exit code and standard error of slicing so many copies of a low plate of 20 by 20 mm.
fn copies(printer: &str, count: usize) -> (i32, String) {
    let folder = folder();
    let count = count.to_string();
    let low = ["cube.stl", "-q", "--sink", "19", "--infill", "0", "-o", "a.gcode"];
    let run = slicer(&folder).args(low).args(["-p", printer, "--copies", &count]).output().unwrap();
    (run.status.code().unwrap(), String::from_utf8(run.stderr).unwrap())
}

#[test]
fn as_many_copies_fit_as_are_said_to() {
    for printer in ["ender-3", "generic-marlin"] {
        let (code, told) = copies(printer, 9999);
        assert_eq!(code, 3, "{told}");
        let rest = told.split_once("; --copies ").unwrap().1;
        let fit: usize = rest.split_once(" fits").unwrap().0.parse().unwrap();
        assert!(fit > 40, "{told}");
        assert_eq!(copies(printer, fit), (0, String::new()), "{printer}");
        let (code, told) = copies(printer, fit + 1);
        assert_eq!(code, 3, "{printer}: {told}");
    }
}
