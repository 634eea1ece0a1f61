//! Small islands -> G-code, read back: each gets its plastic, and `check` tells one that gets none.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{errors, kinds};
use crate::common::solid::{Outline, star};
use crate::common::{Kind, Run, Solid, as_it_is, slice};
use slicer::check::finding::Code;
use slicer::check::terms::Terms;
use slicer::check::{self, Verdict};
use slicer::{Model, profile, reader};

/// How far apart the islands stand, mm.
const APART: f64 = 6.0;

/// A flower with petals.
fn flower(size: f64, petals: u32, part: f64) -> Outline {
    let angle = |k: i32| f64::from(k) * std::f64::consts::TAU / 120.0 * f64::from(petals);
    star(&(0..120).map(|k| size * (1.0 + part * angle(k).cos())).collect::<Vec<_>>())
}

/// Rays that meet in the middle.
fn rays(count: usize, width: f64, reach: f64) -> Outline {
    let meet = width / 2.0 / (std::f64::consts::PI / count as f64).sin();
    let ray = |k: usize| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / count as f64).sin_cos();
        [(meet.min(0.9 * reach), 0.0), (reach, -width / 2.0), (reach, width / 2.0)]
            .map(|(x, y)| [x, y])
            .map(|[x, y]| [x * cos - y * sin, x * sin + y * cos])
    };
    // The inner corners lie between two rays.
    let between = |k: usize| {
        let half = std::f64::consts::PI / count as f64;
        let (sin, cos) = (2.0 * half * k as f64 + half).sin_cos();
        [meet * cos, meet * sin]
    };
    (0..count).flat_map(|k| [ray(k)[1], ray(k)[2], between(k)]).collect()
}

/// These outlines in a row, 1.2 mm high.
fn row(outlines: &[Outline]) -> Solid {
    let stand = |(k, outline): (usize, &Outline)| {
        Solid::prism(outline, 0.0, 1.2).shifted([APART * k as f64, 0.0, 0.0])
    };
    outlines.iter().enumerate().map(stand).fold(Solid::default(), |all, one| all.and(&one))
}

fn area(outline: &Outline) -> f64 {
    let sides = outline.iter().zip(outline.iter().cycle().skip(1));
    sides.map(|(a, b)| (a[0] * b[1] - b[0] * a[1]) / 2.0).sum()
}

/// Plastic over solid of each of the islands on a layer.
fn filled(run: &Run, outlines: &[Outline], layer: usize) -> Vec<f64> {
    let first = run.middle()[0] - APART * (outlines.len() - 1) as f64 / 2.0;
    let mut sums = vec![0.0; outlines.len()];
    for bead in run.print.beads().filter(|m| m.layer == Some(layer)) {
        sums[((bead.to[0] - first) / APART).round() as usize] += bead.e * run.filament_area();
    }
    sums.iter().zip(outlines).map(|(sum, outline)| sum / area(outline) / 0.2).collect()
}

#[test]
fn flowers_and_stars_get_their_plastic_and_no_more() {
    let flowers =
        [(0.37, 7, 0.43), (0.7, 6, 0.38), (0.45, 6, 0.26), (0.54, 4, 0.2), (0.86, 5, 0.41)];
    let mut outlines: Vec<Outline> = flowers.map(|(size, n, part)| flower(size, n, part)).to_vec();
    outlines.extend([(5, 0.45, 1.1), (7, 0.5, 1.4)].map(|(n, width, reach)| rays(n, width, reach)));
    for walls in ["1", "2", "3"] {
        let run = slice(&row(&outlines).stl(), "generic-marlin", &[("walls", walls)]);
        for layer in [0, 1, 3] {
            let filled = filled(&run, &outlines, layer);
            assert!(filled.iter().all(|share| (0.7..1.6).contains(share)), "{walls} {filled:?}");
        }
    }
}

/// What `check` says of a text, against these bytes.
fn judged(text: &str, stl: &[u8]) -> Verdict {
    let print = reader::Print::read(&mut text.as_bytes(), 1.75).unwrap();
    let settings = profile::recorded(&print.values).unwrap().unwrap().settings;
    let terms = Terms::new(Some(&settings), Some(&settings), &print);
    let bed = slicer::bed(&settings.machine);
    let models = [Model::bytes("row.stl", stl.to_vec())];
    let placed = slicer::place(&models, &as_it_is(), &bed, &Default::default()).unwrap();
    check::check(&print, &terms, Some(check::Model { mesh: &placed.mesh, offset: placed.offset }))
}

#[test]
fn an_island_without_any_plastic_is_told() {
    // 0.34 mm²: too little for a finding along its outline or of its surface.
    let outlines = [flower(1.6, 3, 0.1), flower(0.33, 3, 0.0), flower(1.6, 3, 0.1)];
    let stl = row(&outlines).stl();
    let run = slice(&stl, "generic-marlin", &[]);
    assert_eq!(kinds(&judged(&run.text, &stl)), []);
    let middle = run.middle()[0];
    let is_island =
        |m: &crate::common::Move| m.kind != Kind::Custom && (m.to[0] - middle).abs() < APART / 2.0;
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
    let verdict = judged(&(lines.join("\n") + "\n"), &stl);
    let told = errors(&verdict).find(|f| f.text.contains("nothing is printed of an island"));
    let told = told.unwrap_or_else(|| panic!("{:?}", kinds(&verdict)));
    assert_eq!((told.code, told.place.layer), (Code::OpenOutline, Some(4)));
    assert!((told.place.at_mm.unwrap()[0] - middle).abs() < 1.0);
}
