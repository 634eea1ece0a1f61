//! Small round islands -> beads of their rings, read back: each goes round once, without jerks, in its own room.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::{Outline, circle, star};
use crate::common::{Kind, Move, Run, Solid, slice};
use std::f64::consts::{PI, TAU};

const KINDS: [Kind; 5] =
    [Kind::OuterWall, Kind::InnerWall, Kind::Overhang, Kind::Skin, Kind::Infill];

/// How far apart the islands stand, mm.
const APART: f64 = 14.0;

/// Beads may have this much more plastic than there is room.
const MOST: f64 = 1.07;

const RADII: [f64; 6] = [0.8, 1.06, 1.5, 2.0, 2.9, 4.0];

/// A circle whose every second side is very short, as walls have them that are inset from facets.
fn chamfered(radius: f64, corners: usize) -> Outline {
    let turn = TAU / corners as f64;
    let corner = |k: usize| [-0.01, 0.01].map(|off| turn * k as f64 + off / radius);
    (0..corners).flat_map(corner).map(|a| [radius * a.cos(), radius * a.sin()]).collect()
}

/// A circle with ripples around it.
fn rippled(radius: f64, ripples: f64, deep: f64) -> Outline {
    let angle = |k: u32| TAU * f64::from(k) / 96.0;
    star(&(0..96).map(|k| radius + deep * (ripples * angle(k)).cos()).collect::<Vec<_>>())
}

/// A circle whose corners lie up to `deep` inside it, as if by chance.
fn fuzzy(radius: f64, deep: f64) -> Outline {
    star(
        &(0..48_u32)
            .map(|k| radius - deep * f64::from(k * k * 37 % 101) / 101.0)
            .collect::<Vec<_>>(),
    )
}

fn outlines(radius: f64) -> Vec<Outline> {
    let oval = circle(radius, 40).iter().map(|[x, y]| [*x, 0.7 * y]).collect();
    vec![
        circle(radius, 6),
        circle(radius, 11),
        circle(radius, 96),
        chamfered(radius, 16),
        chamfered(radius, 24),
        rippled(radius, 8.0, 0.06 * radius),
        rippled(radius, 13.0, 0.04 * radius),
        fuzzy(radius, 0.12),
        oval,
    ]
}

fn area(outline: &Outline) -> f64 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>() / 2.0
}

/// The islands in rows, with their middles and areas.
fn plate() -> (Solid, Vec<([f64; 2], f64)>) {
    let all = RADII.iter().enumerate().flat_map(|(row, &radius)| {
        let of_row = outlines(radius).into_iter().enumerate();
        of_row.map(move |(k, outline)| (outline, [APART * k as f64, APART * row as f64]))
    });
    let mut plate = Solid::default();
    let mut islands = Vec::new();
    for (outline, [x, y]) in all {
        plate = plate.and(&Solid::prism(&outline, 0.0, 1.6).shifted([x, y, 0.0]));
        islands.push(([x, y], area(&outline)));
    }
    (plate, islands)
}

/// How far the direction turns from one bead to the next, radians.
fn turn(before: &Move, after: &Move) -> f64 {
    let angle = |m: &Move| (m.to[1] - m.from[1]).atan2(m.to[0] - m.from[0]);
    (angle(after) - angle(before) + PI).rem_euclid(TAU) - PI
}

/// What is wrong with a bead of this `line` width.
fn fault(bead: &[Move], line: f64) -> Option<String> {
    let (first, last) = (bead.first()?, bead.last()?);
    let is_closed =
        bead.len() > 2 && (last.to[0] - first.from[0]).hypot(last.to[1] - first.from[1]) < 0.06;
    let turns: Vec<(f64, f64, f64)> =
        bead.windows(2).map(|m| (turn(&m[0], &m[1]), m[0].length(), m[1].length())).collect();
    let around = turns.iter().map(|(turn, ..)| turn).sum::<f64>().abs().to_degrees();
    // Zigzags turn back from line to line, but none ends where it begins.
    let jerks =
        |(turn, a, b): &&(f64, f64, f64)| turn.abs().to_degrees() > 120.0 && a.min(*b) < line / 2.0;
    if !is_closed {
        return None;
    }
    // Once, and what turns into it from lines that lead on to it.
    if around > 540.0 {
        return Some(format!("winds by {around:.0}°"));
    }
    turns
        .iter()
        .find(jerks)
        .map(|(turn, a, b)| format!("jerks by {:.0}° between {a:.2} and {b:.2}", turn.to_degrees()))
}

/// The area that the beads around `middle` cover on a layer if none lies on another, mm².
fn covered(run: &Run, layer: usize, middle: [f64; 2]) -> f64 {
    let is_here = |m: &&Move| {
        m.layer == Some(layer)
            && KINDS.contains(&m.kind)
            && (0..2).all(|axis| (m.from[axis] - middle[axis]).abs() < APART / 2.0)
    };
    run.print.beads().filter(is_here).map(|m| m.e * run.filament_area() / m.height).sum()
}

/// What is wrong with the print of a plate of islands.
fn faults(walls: &str, nozzle: &str, dual: &str) -> Vec<String> {
    let line = nozzle.parse::<f64>().unwrap();
    let (plate, islands) = plate();
    let set = [("walls", walls), ("machine.nozzle_diameter", nozzle), ("dual.mode", dual)];
    let run = slice(&plate.stl(), "generic-marlin", &set);
    let (low, high) = plate.extent();
    let shift = [0, 1].map(|axis| run.middle()[axis] - f64::midpoint(low[axis], high[axis]));
    let what = format!("{walls} walls, {nozzle} mm, {dual}");
    let mut out = Vec::new();
    for kind in KINDS {
        for bead in run.print.chains(kind) {
            if let Some(fault) = fault(&bead, line) {
                let Move { line, layer, kind, .. } = bead[0];
                out.push(format!("{what}: {kind:?} of layer {layer:?} in line {line} {fault}"));
            }
        }
    }
    for (middle, area) in islands {
        let at = [0, 1].map(|axis| middle[axis] + shift[axis]);
        let covered = covered(&run, 3, at);
        if covered > MOST * area {
            out.push(format!("{what}: {covered:.2} mm² in {area:.2} at {at:?}"));
        }
    }
    out
}

#[test]
fn rings_in_small_round_rooms_go_round_once() {
    let mut found = Vec::new();
    for nozzle in ["0.4", "0.8"] {
        for walls in ["1", "2", "3"] {
            for dual in ["off", "pair"] {
                found.extend(faults(walls, nozzle, dual));
            }
        }
    }
    assert!(found.is_empty(), "{} faults:\n{}", found.len(), found.join("\n"));
}
