//! Print -> verdicts: asserts what must hold for every print, whatever the model and the profile.

use super::gcode::{Kind, Move, Print, WALLS};
use super::section::Section;
use super::solid::Solid;
use slicer::profile::{Origin, Settings};

/// Coordinates are written in thousandths of a mm.
const ROUNDING: f64 = 0.0011;

/// Lowest and highest x and y that the machine reaches.
pub(crate) fn bed(settings: &Settings) -> [[f64; 2]; 2] {
    let machine = &settings.machine;
    [machine.bed_width, machine.bed_depth].map(|side| match machine.origin {
        Origin::Centre => [-side / 2.0, side / 2.0],
        Origin::FrontLeft => [0.0, side],
    })
}

/// All checks that need no model.
pub(crate) fn sound(print: &Print, settings: &Settings, what: &str) {
    assert!(print.beads().next().is_some(), "{what}: nothing is printed");
    heights_rise(print, settings.retraction.z_hop, what);
    filament_is_pulled_and_given_back(print, settings, what);
    stays_on_the_bed(print, settings, what);
    walls_close(print, settings, what);
    progress_rises(print, what);
}

/// Each layer rises by its height, beads lie at their layer's z, and Z never falls within the print, but
/// from a lift by `hop`, mm.
pub(crate) fn heights_rise(print: &Print, hop: f64, what: &str) {
    let mut below = 0.0;
    for (k, layer) in print.layers.iter().enumerate() {
        let rise = layer.z - below;
        assert!((rise - layer.height).abs() < ROUNDING, "{what}: layer {k} rises by {rise}");
        below = layer.z;
    }
    let mut highest = 0.0;
    for m in print.moves.iter().filter(|m| m.layer.is_some() && m.kind != Kind::Custom) {
        let fallen = highest - m.to[2];
        assert!(fallen <= hop + ROUNDING, "{what}: line {} lowers the nozzle", m.line);
        highest = m.to[2];
        if let Some(k) = m.layer.filter(|_| m.is_bead()) {
            let z = print.layers[k].z;
            assert!((m.to[2] - z).abs() < ROUNDING, "{what}: line {} prints off layer {k}", m.line);
        }
    }
}

/// Between the first and the last bead, filament is retracted only by the set length and without
/// moving, and is restored before any bead.
pub(crate) fn filament_is_pulled_and_given_back(print: &Print, settings: &Settings, what: &str) {
    let last = print.moves.iter().rposition(Move::is_bead).unwrap_or(0);
    let on_layers = |m: &&Move| m.layer.is_some() && m.kind != Kind::Custom;
    for m in print.moves[..=last].iter().filter(on_layers) {
        let line = m.line;
        if m.e < 0.0 {
            let by = -m.e;
            assert!(m.length() == 0.0, "{what}: line {line} pulls on the way");
            assert!(
                (by - settings.retraction.length).abs() < 2e-5,
                "{what}: line {line} pulls {by}"
            );
            assert!(m.pulled == 0.0, "{what}: line {line} pulls twice");
        } else if m.e > 0.0 && m.length() == 0.0 {
            assert!((m.e - m.pulled).abs() < 2e-5, "{what}: line {line} pushes out of nothing");
        } else if m.e > 0.0 {
            assert!(m.pulled == 0.0, "{what}: line {line} prints with filament pulled back");
        }
    }
}

/// Every bead, with its width, is on the bed and below the machine's height.
pub(crate) fn stays_on_the_bed(print: &Print, settings: &Settings, what: &str) {
    let bed = bed(settings);
    for m in print.beads() {
        let half = m.width / 2.0;
        for p in [m.a(), m.b()] {
            for axis in 0..2 {
                let [low, high] = bed[axis];
                let on = low <= p[axis] - half && p[axis] + half <= high;
                assert!(on, "{what}: line {} leaves the bed at {p:?}", m.line);
            }
        }
        assert!(m.to[2] <= settings.machine.bed_height, "{what}: line {} is too high", m.line);
    }
}

/// Walls end where they began, unless they run along the middle of what is too thin for a loop: then
/// their width is not that of a line.
pub(crate) fn walls_close(print: &Print, settings: &Settings, what: &str) {
    for chain in print.chains_of(&WALLS) {
        let (first, last) = (chain[0], chain[chain.len() - 1]);
        let (a, b) = (first.a(), last.b());
        let is_thin = chain.iter().any(|m| (m.width - settings.line_width).abs() > 0.005);
        let is_inner = chain.iter().all(|m| m.kind != Kind::OuterWall);
        assert!(
            a == b || is_thin || is_inner,
            "{what}: the wall from line {} starts at {a:?}, ends at {b:?}",
            first.line
        );
    }
}

/// The progress begins at 0, never falls and ends at 100.
pub(crate) fn progress_rises(print: &Print, what: &str) {
    let percents = &print.progress;
    assert_eq!(percents.first(), Some(&0), "{what}");
    assert_eq!(percents.last(), Some(&100), "{what}");
    assert!(percents.is_sorted(), "{what}: {percents:?}");
}

/// The body `solid` (as it lies on the bed) at the middle of layer `k`.
pub(crate) fn section(print: &Print, solid: &Solid, k: usize) -> Section {
    let layer = print.layers[k];
    // Planes at mid-height may meet a face exactly. A vertex on the plane counts as above it.
    Section::new(solid, layer.z - layer.height / 2.0)
}

/// The furthest that a bead of `layers` reaches out of the body, and its line. Support is skipped.
pub(crate) fn furthest_out(
    print: &Print,
    solid: &Solid,
    layers: &[usize],
    keep: impl Fn(&Move) -> bool,
) -> (f64, usize) {
    let mut worst = (0.0, 0);
    for &k in layers {
        let section = section(print, solid, k);
        let beads = print.beads().filter(|m| m.layer == Some(k) && !m.kind.is_support());
        for m in beads.filter(|m| keep(m)) {
            let steps = (m.length() / 0.2).ceil().clamp(1.0, 400.0);
            for step in 0..=steps as usize {
                let out = section.reach(m.at(step as f64 / steps), m.width / 2.0);
                if out > worst.0 {
                    worst = (out, m.line);
                }
            }
        }
    }
    worst
}

/// Lines of travels that leave the body without a retraction. Travels below the minimum length are
/// skipped.
pub(crate) fn stringing_travels(
    print: &Print,
    solid: &Solid,
    settings: &Settings,
    layers: &[usize],
) -> Vec<usize> {
    let mut lines = Vec::new();
    for &k in layers {
        let section = section(print, solid, k);
        let travels = print.moves.iter().filter(|m| m.layer == Some(k) && m.is_travel());
        let long = travels.filter(|m| m.length() > settings.retraction.min_travel + ROUNDING);
        let leaves = |m: &&Move| {
            let steps = (m.length() / 0.1).ceil() as usize;
            let out = |k: usize| section.signed_distance(m.at(k as f64 / steps as f64), 0.1);
            // What drips on the way from support to support is broken off with it.
            (0..=steps).any(|k| out(k) > 0.03) && (0..=steps).any(|k| out(k) < -0.03)
        };
        lines.extend(long.filter(|m| m.pulled == 0.0).filter(leaves).map(|m| m.line));
    }
    lines
}
