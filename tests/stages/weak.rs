//! G-code with weak places -> warnings of `check`: each kind from a file that has it, and none without.
//!
//! The files in `fixtures/faults` are what this program once made of thin walls, bridges and bodies
//! that stand on nothing. The others are written here.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{Good, kinds, listed, warned};
use crate::common::{Kind, fixtures};
use slicer::check::finding::{Code, Severity};
use slicer::check::terms::Terms;
use slicer::check::{self, Verdict};
use slicer::reader::Print;
use std::fmt::Write as _;

fn judged(text: &str) -> Verdict {
    let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
    check::check(&print, &Terms::new(None, None, &print), None)
}

fn fault(name: &str) -> Verdict {
    judged(&std::fs::read_to_string(fixtures().join("faults").join(name)).unwrap())
}

fn has(verdict: &Verdict, code: Code) -> bool {
    verdict.counts.iter().any(|count| count.code == code)
}

/// The largest finding of a kind.
#[track_caller]
fn largest(verdict: &Verdict, code: Code) -> &check::finding::Finding {
    let found = verdict.findings.iter().find(|finding| finding.code == code);
    found.unwrap_or_else(|| panic!("no {}:\n{}", code.name(), listed(verdict)))
}

#[test]
fn walls_thinner_than_two_lines_were_overfilled() {
    for (name, percent) in [
        ("wall_0.60.gcode", 130.0..170.0),
        ("fin.gcode", 150.0..190.0),
        ("tube_04.gcode", 140.0..180.0),
        ("text_raised.gcode", 150.0..190.0),
        ("knife_up.gcode", 190.0..230.0),
    ] {
        let verdict = fault(name);
        let found = largest(&verdict, Code::Overfilled);
        assert!(percent.contains(&found.measure), "{name}: {found}");
        assert!(found.place.layer.is_some() && found.place.at_mm.is_some(), "{name}: {found}");
        assert_eq!(found.severity, Severity::Warning);
    }
}

#[test]
fn bodies_that_stand_on_nothing_are_errors() {
    for (name, z) in [
        ("top10.gcode", 1.4),
        ("floating.gcode", 2.2),
        ("table_pointed_feet.gcode", 0.6),
        ("cube_on_edge.gcode", 0.4),
        ("neck.gcode", 8.2),
        ("gap_in_z.gcode", 3.2),
    ] {
        let verdict = fault(name);
        let found = largest(&verdict, Code::Floating);
        assert_eq!((found.severity, found.place.z_mm), (Severity::Error, Some(z)), "{found}");
        assert!(verdict.fails());
    }
}

#[test]
fn layers_between_were_empty() {
    for (name, missing) in [("neck.gcode", 3.0), ("gap_in_z.gcode", 1.0)] {
        let verdict = fault(name);
        let found = largest(&verdict, Code::InTheAir);
        assert!((found.measure - missing).abs() < 0.01, "{name}: {found}");
    }
}

#[test]
fn an_edge_was_printed_twice() {
    let verdict = fault("knife_up.gcode");
    let found = largest(&verdict, Code::PrintedTwice);
    assert_eq!((found.place.layer, found.severity), (Some(97), Severity::Error), "{found}");
}

#[test]
fn a_bridge_was_laid_across() {
    let verdict = fault("bridge.gcode");
    let found = largest(&verdict, Code::Unanchored);
    assert_eq!((found.severity, found.place.z_mm), (Severity::Warning, Some(4.2)), "{found}");
    assert!(
        (3.0..5.0).contains(&found.measure) && found.text.ends_with("with a free end"),
        "{found}"
    );
    assert!(!verdict.fails(), "{}", listed(&verdict));
}

/// Lines by hand.
struct Hand {
    text: String,
    at: [f64; 2],
}

impl Hand {
    fn new() -> Self {
        let head = "; nozzle_diameter = 0.4\nM83\nM104 S200\nM109 S200\nG28\n";
        Self { text: head.to_owned(), at: [0.0; 2] }
    }

    fn layer(&mut self, z: f64) {
        write!(self.text, ";LAYER_CHANGE\n;HEIGHT:0.2\nG1 Z{z:.3} F6000\n").unwrap();
    }

    /// A path of this width and 0.2 mm height; `closed` goes back to its beginning.
    fn path(&mut self, kind: &str, width: f64, points: &[[f64; 2]]) {
        write!(self.text, ";TYPE:{kind}\n;WIDTH:{width}\n").unwrap();
        for (k, &[x, y]) in points.iter().enumerate() {
            let length = (x - self.at[0]).hypot(y - self.at[1]);
            let e = if k == 0 {
                String::new()
            } else {
                format!(" E{:.6}", length * width * 0.2 / 2.405)
            };
            writeln!(self.text, "G1 X{x:.3} Y{y:.3}{e} F1800").unwrap();
            self.at = [x, y];
        }
    }

    /// A rectangular loop.
    fn loop_of(&mut self, kind: &str, [x, y]: [f64; 2], [w, d]: [f64; 2]) {
        let points = [[x, y], [x + w, y], [x + w, y + d], [x, y + d], [x, y]];
        self.path(kind, 0.4, &points);
    }
}

/// A box of 20 mm, `layers` high, with lines of infill that end `short` of the middle of its wall.
fn hollow(short: f64, layers: usize) -> Hand {
    let mut hand = Hand::new();
    for k in 0..layers {
        hand.layer(0.2 * (k + 1) as f64);
        hand.loop_of("External perimeter", [10.0, 10.0], [20.0, 20.0]);
        let (from, to) = (10.0 + short, 30.0 - short);
        for row in 1..20 {
            let at = 10.0 + f64::from(row);
            hand.path("Internal infill", 0.4, &[[from, at], [to, at]]);
            hand.path("Internal infill", 0.4, &[[at, from], [at, to]]);
        }
    }
    hand
}

#[test]
fn infill_that_does_not_reach_the_walls() {
    let verdict = judged(&hollow(1.0, 12).text);
    let found = largest(&verdict, Code::LooseInfill);
    assert!(found.measure < 1.0 && found.unit == "%" && found.place.at_mm.is_some(), "{found}");
    let verdict = judged(&hollow(0.4, 12).text);
    assert!(!has(&verdict, Code::LooseInfill), "{}", listed(&verdict));
}

/// A wall of two lines with their middles so far apart.
fn two_lines(apart: f64) -> Verdict {
    let mut hand = Hand::new();
    for k in 0..5 {
        hand.layer(0.2 * f64::from(k + 1));
        hand.loop_of("External perimeter", [10.0, 10.0], [30.0, apart]);
    }
    judged(&hand.text)
}

#[test]
fn room_between_walls_is_filled_but_not_twice() {
    let verdict = two_lines(0.4);
    assert!(
        !has(&verdict, Code::Overfilled) && !has(&verdict, Code::Underfilled),
        "{}",
        listed(&verdict)
    );
    let verdict = two_lines(0.1);
    assert!(largest(&verdict, Code::Overfilled).measure > 150.0);
    let verdict = two_lines(0.9);
    let found = largest(&verdict, Code::Underfilled);
    assert!((1.2..2.2).contains(&found.measure) && found.unit == "mm²", "{found}");
    // Air between two walls that face each other is no room.
    let mut hand = Hand::new();
    hand.layer(0.2);
    hand.loop_of("External perimeter", [10.0, 10.0], [30.0, 0.4]);
    hand.loop_of("External perimeter", [10.0, 11.2], [30.0, 0.4]);
    let verdict = judged(&hand.text);
    assert!(!has(&verdict, Code::Underfilled), "{}", listed(&verdict));
}

#[test]
fn skins_that_are_thin() {
    let good = Good::of("cube_20.stl", "generic-marlin", &[]);
    let thin = good.with(|m| {
        if m.layer == Some(99) && m.kind == Kind::Skin {
            m.e *= 0.6;
        }
        true
    });
    let verdict = good.judge(&thin);
    let found = largest(&verdict, Code::Underfilled);
    assert_eq!((found.place.layer, found.severity), (Some(100), Severity::Warning), "{found}");
}

#[test]
fn lines_narrower_than_the_nozzle_lays() {
    let line = |width: f64, length: f64| {
        let mut hand = Hand::new();
        hand.layer(0.2);
        hand.path("External perimeter", width, &[[10.0, 10.0], [10.0 + length, 10.0]]);
        judged(&hand.text)
    };
    let verdict = line(0.25, 10.0);
    let found = largest(&verdict, Code::NarrowBead);
    assert!((found.measure - 10.0).abs() < 1e-3 && found.text.contains("0.25 mm"), "{found}");
    assert!(!has(&line(0.3, 10.0), Code::NarrowBead));
    assert!(!has(&line(0.25, 0.9), Code::NarrowBead));
}

/// Two posts, and from layer 10 on a beam of three lines that joins them; an island between the posts
/// begins at layer `first`.
fn beam(first: Option<usize>) -> Verdict {
    let mut hand = Hand::new();
    for k in 0..12 {
        hand.layer(0.2 * (k + 1) as f64);
        if k < 10 {
            hand.loop_of("External perimeter", [10.0, 10.0], [4.0, 0.8]);
            hand.loop_of("External perimeter", [22.0, 10.0], [4.0, 0.8]);
            if first.is_some_and(|first| k >= first) {
                hand.loop_of("External perimeter", [17.0, 10.0], [2.0, 0.8]);
            }
        } else {
            for row in 0..3 {
                let y = 10.0 + 0.4 * f64::from(row);
                hand.path("Solid infill", 0.4, &[[10.0, y], [26.0, y]]);
            }
        }
    }
    hand.text += "M104 S0\n";
    judged(&hand.text)
}

#[test]
fn an_island_that_grows_together_with_the_rest_is_a_weak_place() {
    let verdict = beam(None);
    assert!(
        !has(&verdict, Code::Floating) && !has(&verdict, Code::Unanchored),
        "{}",
        listed(&verdict)
    );
    let verdict = beam(Some(5));
    let found = largest(&verdict, Code::Floating);
    assert_eq!((found.severity, found.place.layer), (Severity::Warning, Some(6)), "{found}");
    assert!((found.measure - 5.6).abs() < 0.01, "{found}");
    assert_eq!(kinds(&verdict), [], "{}", listed(&verdict));
}

#[test]
fn a_line_that_ends_in_the_air() {
    let beam = |to: f64| {
        let mut hand = Hand::new();
        for k in 0..3 {
            hand.layer(0.2 * f64::from(k + 1));
            hand.loop_of("External perimeter", [10.0, 10.0], [4.0, 4.0]);
            if k == 2 {
                hand.path("Solid infill", 0.4, &[[10.0, 12.0], [to, 12.0]]);
            }
        }
        judged(&hand.text)
    };
    let verdict = beam(20.0);
    let found = largest(&verdict, Code::Unanchored);
    assert!(
        (found.measure - 5.7).abs() < 0.3 && found.text.ends_with("with a free end"),
        "{found}"
    );
    assert!(!has(&beam(16.5), Code::Unanchored));
}

/// Two pillars 10 mm apart, and over them a plate inside a wall, with zigzag lines between the
/// pillars: across, with turns that lie so far on the pillars, or along the gap.
fn bridge(rests: f64, along: bool) -> Verdict {
    let mut hand = Hand::new();
    for k in 0..6 {
        hand.layer(0.2 * f64::from(k + 1));
        if k < 5 {
            for x in [10.0, 24.0] {
                hand.loop_of("External perimeter", [x, 10.0], [4.0, 8.0]);
                hand.loop_of("Perimeter", [x + 0.4, 10.4], [3.2, 7.2]);
            }
            continue;
        }
        hand.loop_of("External perimeter", [10.0, 10.0], [18.0, 8.0]);
        // The outer lines of the pillars reach 0.2 mm into the gap.
        let (from, to) = (14.2 - rests, 23.8 + rests);
        let lines = if along { 23 } else { 19 };
        let points = (0..lines).flat_map(|row| {
            let at = 0.4 * f64::from(row);
            let ends = if along {
                [[14.6 + at, 10.3], [14.6 + at, 17.7]]
            } else {
                [[from, 10.3 + at], [to, 10.3 + at]]
            };
            if row % 2 == 0 { ends } else { [ends[1], ends[0]] }
        });
        hand.path("Bridge infill", 0.4, &points.collect::<Vec<_>>());
    }
    judged(&hand.text)
}

#[test]
fn a_bridge_that_does_not_rest_on_its_pillars() {
    for rests in [2.0, 0.2] {
        let verdict = bridge(rests, false);
        assert!(!has(&verdict, Code::Unanchored), "{rests}: {}", listed(&verdict));
    }
    let verdict = bridge(-0.6, false);
    let found = largest(&verdict, Code::Unanchored);
    assert!((7.5..9.5).contains(&found.measure), "{found}");
    assert!(found.text.ends_with("with a free end"), "{found}");
}

#[test]
fn a_bridge_along_its_free_edges() {
    let verdict = bridge(0.2, true);
    let found = largest(&verdict, Code::Unanchored);
    assert!((6.0..9.0).contains(&found.measure), "{found}");
}

#[test]
fn skin_along_the_lines_below_it() {
    // Over lines of infill 2.5 mm apart, along x.
    let over = |is_along: bool| {
        let mut hand = Hand::new();
        for k in 0..4 {
            hand.layer(0.2 * f64::from(k + 1));
            hand.loop_of("External perimeter", [10.0, 10.0], [20.0, 20.0]);
            for row in 1..8 {
                let y = 10.0 + 2.5 * f64::from(row);
                if k < 3 {
                    hand.path("Internal infill", 0.4, &[[10.3, y], [29.7, y]]);
                }
            }
            let turned = |[u, v]: [f64; 2]| if is_along { [u, v] } else { [v, u] };
            for row in 0..49 {
                let v = 10.4 + 0.4 * f64::from(row);
                if k == 3 {
                    hand.path("Solid infill", 0.4, &[[10.3, v], [29.7, v]].map(turned));
                }
            }
        }
        judged(&hand.text)
    };
    let verdict = over(true);
    let found = largest(&verdict, Code::Unanchored);
    assert!(found.text.ends_with("beside what they should rest on"), "{found}");
    assert!(!has(&over(false), Code::Unanchored), "{}", listed(&over(false)));
}

#[test]
fn support_that_is_too_slender() {
    let post = |wide: bool| {
        let mut hand = Hand::new();
        for k in 0..40 {
            hand.layer(0.2 * f64::from(k + 1));
            hand.loop_of("External perimeter", [30.0, 30.0], [9.0, 9.0]);
            if wide {
                hand.loop_of("Support material", [10.0, 10.0], [4.0, 4.0]);
            } else {
                hand.path("Support material", 0.4, &[[10.0, 10.0], [14.0, 10.0]]);
            }
        }
        judged(&hand.text)
    };
    let verdict = post(false);
    let found = largest(&verdict, Code::SlenderSupport);
    // 8 mm on 0.4 mm.
    assert!((18.0..22.0).contains(&found.measure), "{found}");
    assert_eq!((found.place.layer, found.severity), (Some(40), Severity::Warning), "{found}");
    assert!(!has(&post(true), Code::SlenderSupport), "{}", listed(&post(true)));
}

#[test]
fn warnings_alone_do_not_fail() {
    let verdict = fault("wall_0.60.gcode");
    assert!(warned(&verdict).contains(&Code::Overfilled) && kinds(&verdict).is_empty());
    assert!(!verdict.fails());
}
