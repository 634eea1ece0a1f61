//! `slicer preview` of non-planar skins: cuts along and across them, and pictures of patches.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::fixtures;
use crate::preview::{TILE, files, print, slicer};
use ::slicer::preview::colours::Colour;
use ::slicer::preview::cut::{Axis, Cut, Plane};
use ::slicer::preview::svg;
use ::slicer::reader::Role;
use predicates::prelude::*;
use std::fs;
use tempfile::TempDir;

/// The ramp with non-planar skins, sliced in `folder`; returns its G-code.
pub(super) fn wedge(folder: &TempDir) -> String {
    let words = ["--nonplanar", "--head", "long-0.6", "-q", "-o", "wedge.gcode"];
    slicer(folder).arg(fixtures().join("wedge.stl")).args(words).assert().success();
    fs::read_to_string(folder.path().join("wedge.gcode")).unwrap()
}

#[test]
fn skins_follow_the_surface_in_a_cut_along_them_and_across() {
    let folder = tempfile::tempdir().unwrap();
    let print = print(&wedge(&folder));
    let surface = |x: f64| 1.6 + (x + 12.0) / 12.0;
    // Through the middle of a line, wherever they lie: half-way between two, both are hardly cut.
    let runs_along = |s: &&::slicer::reader::print::Step| {
        s.role == Role::NonPlanar && s.is_line() && s.from[1] == s.to[1] && s.from[1].abs() < 1.0
    };
    let at = f64::from(print.moves.iter().find(runs_along).unwrap().from[1]);
    let along = |at| Cut::new(&print, Plane { axis: Axis::Y, at });
    let strip = |cut: Cut| {
        let width = |section: &::slicer::preview::cut::Section| section.high - section.low;
        let strips = cut.sections.into_iter().filter(|section| !section.course.is_empty());
        strips.max_by(|a, b| width(a).total_cmp(&width(b))).unwrap()
    };
    let longest = strip(along(at));
    assert!(longest.low < -11.9 && longest.high > 11.9, "{longest:?}");
    for spot in &longest.course {
        // The first of two skins of 0.2 mm.
        let off = spot.top - (surface(spot.at) - 0.2);
        assert!(off.abs() < 0.025, "{spot:?}: {off}");
        // It fills the steps of the base, layers of 0.2 mm.
        assert!((0.09..0.31).contains(&spot.height), "{spot:?}");
    }
    // Stretches over a step's edge take the mean of both sides.
    let on_step = |spot: &&::slicer::preview::course::Spot| {
        let steps = (spot.top - spot.height) / 0.2;
        (steps - steps.round()).abs() < 0.1
    };
    let on_steps = longest.course.iter().filter(on_step).count();
    assert!(10 * on_steps > 7 * longest.course.len(), "{longest:?}");
    // Lines across the plane are as high above the bed as the surface is there.
    let across = along(at).sections;
    let skin = Colour::of(Role::NonPlanar, false);
    let tops = across.iter().filter(|s| s.colour == skin && s.course.is_empty());
    let off = tops.map(|s| (s.top() - surface(f64::midpoint(s.low, s.high))).abs());
    let off: Vec<f64> = off.collect();
    assert!(off.len() > 50 && off.iter().all(|off| *off < 0.025), "{off:?}");
    // A strip is drawn as one filled outline.
    let plane = Plane { axis: Axis::Y, at };
    let cut = along(at);
    let text = svg::write(&cut.drawing(plane, cut.frame(), 1200));
    let document = roxmltree::Document::parse(&text).unwrap();
    let filled = document.descendants().filter(|node| {
        node.has_tag_name("g") && node.attribute("fill") == Some(skin.hex().as_str())
    });
    assert_eq!(filled.count(), 1);
}

#[test]
fn a_patch_has_a_picture_of_its_own_which_its_layer_leaves_out() {
    let folder = tempfile::tempdir().unwrap();
    let text = wedge(&folder);
    let print = print(&text);
    let home = ::slicer::preview::patch::home(&print, 1).unwrap() + 1;
    let draw = |words: &[&str]| {
        let more = ["--format", "svg", "-o", "-", "-q"];
        let run = slicer(&folder).args(["preview", "wedge.gcode"]).args(words).args(more).assert();
        String::from_utf8(run.success().get_output().stdout.clone()).unwrap()
    };
    let skin = Colour::of(Role::NonPlanar, false).hex();
    let layer = draw(&["--layer", &home.to_string()]);
    assert!(!layer.contains(&skin) && layer.contains(">then skin 1<"));
    let patch = draw(&["--patch", "1"]);
    let title = format!("<title>skin 1, after layer {home}, z 1.");
    assert!(patch.contains(&title), "{patch:.400}");
    // From the lowest to the highest colour of the scale, and both are in the legend.
    for part in [0.0, 1.0] {
        let colour = Colour::on_scale(part).hex();
        assert!(patch.matches(&colour).count() >= 2, "{colour}");
    }
    assert!(patch.contains(">z 3."), "{patch:.4000}");
    let fails = |words: &[&str], says: &str| {
        let run = slicer(&folder).arg("preview").args(words).args(["-o", "a.svg"]).assert();
        run.code(2).stderr(predicate::str::contains(says));
    };
    fails(&["wedge.gcode", "--patch", "2"], "--patch 2: wedge.gcode has only patch 1");
    fails(&["wedge.gcode", "--patch", "1", "--layer", "2"], "cannot be used with");
    fs::copy(fixtures().join(TILE), folder.path().join("tile.gcode")).unwrap();
    fails(&["tile.gcode", "--patch", "1"], "--patch 1: tile.gcode has no non-planar skin");

    let words = ["preview", "wedge.gcode", "--all", "-o", "a.png", "--size", "400", "-q"];
    slicer(&folder).args(words).assert().success();
    let mut names: Vec<_> = (1..=print.layers.len()).map(|n| format!("a-{n:04}.png")).collect();
    names.push(format!("a-{home:04}-skin-1.png"));
    names.sort();
    let made: Vec<_> = files(folder.path()).into_iter().filter(|n| n.starts_with("a-")).collect();
    assert_eq!(made, names);
}
