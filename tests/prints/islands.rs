//! Small islands -> G-code, read back: `check` tells one that gets no plastic.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{errors, judge_made, kinds};
use crate::common::solid::{Outline, star};
use crate::common::{Kind, Move, Solid, slice};
use slicer::check::finding::Code;

/// How far apart the islands stand, mm.
const APART: f64 = 6.0;

/// A flower with petals.
fn flower(size: f64, petals: u32, part: f64) -> Outline {
    let angle = |k: i32| f64::from(k) * std::f64::consts::TAU / 120.0 * f64::from(petals);
    star(&(0..120).map(|k| size * (1.0 + part * angle(k).cos())).collect::<Vec<_>>())
}

/// These outlines in a row, 1.2 mm high.
fn row(outlines: &[Outline]) -> Solid {
    let stand = |(k, outline): (usize, &Outline)| {
        Solid::prism(outline, 0.0, 1.2).shifted([APART * k as f64, 0.0, 0.0])
    };
    outlines.iter().enumerate().map(stand).fold(Solid::default(), |all, one| all.and(&one))
}

#[test]
fn an_island_without_any_plastic_is_told() {
    // 0.34 mm²: too little for a finding along its outline or of its surface.
    let outlines = [flower(1.6, 3, 0.1), flower(0.33, 3, 0.0), flower(1.6, 3, 0.1)];
    let stl = row(&outlines).stl();
    let run = slice(&stl, "generic-marlin", &[]);
    assert_eq!(kinds(&judge_made(&run.text, &stl)), []);
    let middle = run.middle()[0];
    let is_island = |m: &Move| m.kind != Kind::Custom && (m.to[0] - middle).abs() < APART / 2.0;
    let mut lines: Vec<String> = run.text.lines().map(str::to_owned).collect();
    for bead in run.print.beads().filter(|m| m.layer == Some(3) && is_island(m)) {
        // The same way without plastic.
        let line = &mut lines[bead.line - 1];
        let words: Vec<&str> = line.split_whitespace().collect();
        let e = words.iter().find(|word| word.starts_with('E')).unwrap();
        let set = format!("G92 {e}");
        *line = words.iter().filter(|word| *word != e).copied().collect::<Vec<_>>().join(" ");
        line.push_str(&format!("\n{set}"));
    }
    let verdict = judge_made(&(lines.join("\n") + "\n"), &stl);
    let told = errors(&verdict).find(|f| f.text.contains("nothing is printed of an island"));
    let told = told.unwrap_or_else(|| panic!("{:?}", kinds(&verdict)));
    assert_eq!((told.code, told.place.layer), (Code::OpenOutline, Some(4)));
    assert!((told.place.at_mm.unwrap()[0] - middle).abs() < 1.0);
}
