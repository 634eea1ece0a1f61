//! Prints of 100 % infill, and without walls -> G-code, read back: no room stays open, and none is filled twice.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::{circle, rectangle};
use crate::common::{Kind, Move, Run, Solid, slice};

/// Distance of places that are looked at, mm.
const STEP: f64 = 0.1;

fn distance(m: &Move, p: [f64; 2]) -> f64 {
    let (a, b) = (m.a(), m.b());
    let way = [b[0] - a[0], b[1] - a[1]];
    let square = way[0] * way[0] + way[1] * way[1];
    let t = ((p[0] - a[0]) * way[0] + (p[1] - a[1]) * way[1]) / square.max(1e-12);
    let t = t.clamp(0.0, 1.0);
    ((p[0] - a[0] - t * way[0]).powi(2) + (p[1] - a[1] - t * way[1]).powi(2)).sqrt()
}

/// Shares of the places of a grid, inside a box around the bed's middle, that no bead of this layer covers,
/// and that beads of skin and of infill both cover.
fn shares(run: &Run, layer: usize, half: [f64; 2]) -> [f64; 2] {
    let middle = run.middle();
    let beads: Vec<&Move> = run.print.beads().filter(|m| m.layer == Some(layer)).collect();
    let count = half.map(|half| (2.0 * half / STEP) as i32);
    let (mut all, mut open, mut both) = (0.0, 0.0, 0.0);
    for (i, j) in (0..count[0]).flat_map(|i| (0..count[1]).map(move |j| (i, j))) {
        let at = |k: usize, i: i32| middle[k] - half[k] + STEP * (f64::from(i) + 0.5);
        let p = [at(0, i), at(1, j)];
        let covers = |m: &&&Move, part: f64| distance(m, p) < part * m.width / 2.0;
        let has = |kind: Kind| beads.iter().any(|m| m.kind == kind && covers(&m, 0.7));
        all += 1.0;
        open += f64::from(u8::from(!beads.iter().any(|m| covers(&m, 1.1))));
        both += f64::from(u8::from(has(Kind::Skin) && has(Kind::Infill)));
    }
    [open, both].map(|count| count / all)
}

#[test]
fn solid_infill_reaches_the_walls() {
    // The room inside the walls is 0.3 mm wider than a number of lines.
    let block = Solid::cuboid([0.0; 3], [14.3, 9.3, 3.0]);
    for set in [&[("infill", "100")] as &[_], &[("infill", "100"), ("dual.mode", "pair")]] {
        let run = slice(&block.stl(), "generic-marlin", &[set, &[("angle", "0")]].concat());
        for layer in [7, 8] {
            // In pairs the upper layer prints for both.
            let layer = if set.len() > 1 { 7 } else { layer };
            let [open, _] = shares(&run, layer, [6.0, 3.5]);
            assert!(open < 0.004, "{layer} {open}");
        }
    }
}

#[test]
fn solid_infill_never_runs_through_skin() {
    // Steps narrower than a line, along the lines across the skin.
    let step = |k: usize| {
        let x = 14.0 - 0.2 * k as f64;
        Solid::cuboid([0.0, 0.0, 0.0], [x, 12.0, 2.0 + 0.2 * k as f64])
    };
    let stairs = (0..6).map(step).fold(Solid::default(), |all, one| all.and(&one));
    let set = [("infill", "100"), ("dual.mode", "interlaced"), ("angle", "0")];
    let run = slice(&stairs.stl(), "generic-marlin", &set);
    let twice = (4..14).map(|layer| shares(&run, layer, [6.0, 5.0])[1]);
    let most = twice.fold(0.0, f64::max);
    assert!(most < 0.02, "{most}");
}

#[test]
fn skins_reach_the_outline_without_walls() {
    for (outline, half) in [
        (rectangle([0.0; 2], [12.3, 9.1]), [6.1, 4.5]),
        (rectangle([0.0; 2], [12.1, 9.3]), [6.0, 4.6]),
        (circle(8.0, 96), [5.0, 5.0]),
    ] {
        let part = Solid::prism(&outline, 0.0, 1.0);
        let set = [("walls", "0"), ("angle", "0")];
        let run = slice(&part.stl(), "generic-marlin", &set);
        for layer in [0, 4] {
            let [open, _] = shares(&run, layer, half);
            assert!(open < 0.01, "{half:?} {layer} {open}");
        }
    }
}
