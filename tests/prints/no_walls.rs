//! Prints without walls -> G-code, read back: skins reach the outline.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::{circle, rectangle};
use crate::common::{Move, Run, Solid, slice};

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

/// The share of the places of a grid, inside a box around the bed's middle, that no bead of this layer covers.
fn open(run: &Run, layer: usize, half: [f64; 2]) -> f64 {
    let middle = run.middle();
    let beads: Vec<&Move> = run.print.beads().filter(|m| m.layer == Some(layer)).collect();
    let count = half.map(|half| (2.0 * half / STEP) as i32);
    let at = |k: usize, i: i32| middle[k] - half[k] + STEP * (f64::from(i) + 0.5);
    let places = (0..count[0]).flat_map(|i| (0..count[1]).map(move |j| [at(0, i), at(1, j)]));
    let is_open = |p: &[f64; 2]| !beads.iter().any(|m| distance(m, *p) < 1.1 * m.width / 2.0);
    places.filter(is_open).count() as f64 / f64::from(count[0] * count[1])
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
            let open = open(&run, layer, half);
            assert!(open < 0.01, "{half:?} {layer} {open}");
        }
    }
}
