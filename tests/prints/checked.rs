//! Slopes that were once called faulty -> prints with skins in which `check` finds no error.
//!
//! Each of these prints is sound, as a look at its cut shows; what was wrong was the verdict:
//! - A line across a slope lies half over the next tread of its staircase, which is of the layer that the skins are
//!   printed after.
//! - The lowest skin is thin where a level layer ends just below it: a skin is as high as the ones above.
//! - Down a slope each line ends higher than the next one lies. Nothing stands so high beyond its end, on a rim above
//!   the slope neither.
//! - Wide lines spread their plastic over more than a square of a millimetre.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{Good, kinds};
use crate::common::relief::Relief;
use crate::common::{Run, slice};
use slicer::check::finding::Code;
use slicer::check::terms::Terms;
use slicer::check::{Verdict, check};
use slicer::{profile, reader};

/// What `check` says of a print by its own settings.
fn judged(run: &Run) -> Verdict {
    let print = reader::Print::read(&mut run.text.as_bytes(), 1.75).unwrap();
    let settings = profile::recorded(&print.values).unwrap().unwrap().settings;
    let terms = Terms::new(Some(&settings), Some(&settings), &print);
    assert!(terms.head.is_some() && !print.facts.patches.is_empty());
    check(&print, &terms, None)
}

fn printed(part: &Relief, set: &[(&str, &str)]) -> Run {
    let on = [("nonplanar.enabled", "true")];
    slice(&part.solid().stl(), "generic-marlin", &[&on, set].concat())
}

#[test]
fn lines_across_a_wedge_lie_on_its_treads() {
    let across: &[(&str, &str)] =
        &[("nonplanar.enabled", "true"), ("head.name", "v6"), ("nonplanar.directions", "auto")];
    let good = Good::of("wedge.stl", "prusa-mk3s", across);
    assert_eq!(kinds(&good.judge(&good.text)), []);
    // Where the tread is missing, they do lie in the air.
    let bare = good.with(|m| m.patch > 0 || m.e <= 0.0 || m.to[2] < 2.0);
    assert!(kinds(&good.judge(&bare)).contains(&Code::InTheAir));
}

#[test]
fn skins_of_a_valley_have_as_much_plastic_as_room() {
    let surface = |x: f64, _| 3.0 + 0.012 * (x - 8.0) * (x - 8.0);
    let valley = Relief { sides: [16.0, 12.0], surface, squares: [48, 1] };
    for wall in ["0", "1", "2"] {
        let run = printed(&valley, &[("nonplanar.wall", wall), ("layer_height", "0.3")]);
        assert_eq!(kinds(&judged(&run)), [], "{wall}");
    }
}

#[test]
fn the_head_clears_the_slope_that_it_goes_down() {
    let surface =
        |x: f64, y: f64| (1600.0 - (x - 17.0) * (x - 17.0) - (y - 4.0) * (y - 4.0)).sqrt() - 34.0;
    let cap = Relief { sides: [34.0, 8.0], surface, squares: [102, 24] };
    let run = printed(&cap, &[("head.name", "v6"), ("layer_height", "0.3")]);
    assert_eq!(kinds(&judged(&run)), []);
}

#[test]
fn the_head_clears_the_rim_that_it_comes_from() {
    let surface = |x: f64, _| 9.0 - 0.42 * (x - 6.0).max(0.0);
    let rim = Relief { sides: [18.0, 12.0], surface, squares: [3, 1] };
    let run = printed(&rim, &[("head.name", "v6"), ("machine.nozzle_diameter", "1.0")]);
    assert_eq!(kinds(&judged(&run)), []);
}

/// Not a verdict, but a print that was wrong: what is known of the surface alone is not known of wide lines on it.
#[test]
fn the_head_clears_the_sides_of_wide_lines() {
    let surface =
        |x: f64, y: f64| 5.0 + 3.0 * libm::sin((x - 12.0) / 8.0) * libm::cos((y - 10.0) / 7.0);
    let hills = Relief { sides: [24.0, 20.0], surface, squares: [30, 30] };
    let run = printed(&hills, &[("head.name", "v6"), ("machine.nozzle_diameter", "0.8")]);
    assert_eq!(kinds(&judged(&run)), []);
    let areas = run.report.nonplanar.as_ref().map(|skins| skins.areas.skin_mm2);
    assert!(areas.is_some_and(|skin| skin > 400.0), "{areas:?}");
}

#[test]
fn wide_lines_on_a_roof_have_as_much_plastic_as_room() {
    let surface = |x: f64, _| 3.0 + 0.3057 * (9.0 - (x - 9.0).abs());
    let roof = Relief { sides: [18.0, 12.0], surface, squares: [2, 1] };
    let run = printed(&roof, &[("head.name", "v6"), ("machine.nozzle_diameter", "0.8")]);
    assert_eq!(kinds(&judged(&run)), []);
}

/// Not a verdict either: a turn at the end of a row fills what is open on its own side, and not beyond the row.
#[test]
fn the_narrow_end_of_a_patch_is_covered() {
    let surface = |x: f64, y: f64| 5.67 + 0.042 * (x - 8.0) * (y - 9.5);
    let saddle = Relief { sides: [16.0, 19.0], surface, squares: [39, 39] };
    let set = [
        ("head.name", "v6"),
        ("machine.nozzle_diameter", "0.8"),
        ("layer_height", "0.2"),
        ("nonplanar.wall", "2"),
    ];
    assert_eq!(kinds(&judged(&printed(&saddle, &set))), []);
}
