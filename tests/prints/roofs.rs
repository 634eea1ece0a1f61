//! Gables and hipped roofs -> G-code, read back: nowhere does a layer get more plastic than it has room.
//!
//! What skin and infill share is decided twice, along the lines of both directions. Near the ridge of
//! a roof rooms are narrow and the strips that are seen from above narrower still: there the two may differ.
//!
//! Words: a *pixel* is a small square of a layer; its *room* is what of it lies inside the part in the
//! middle of the layer. What a bead puts on a layer is its plastic by the share of its height that lies there.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::rectangle;
use crate::common::{Move, Run, Section, Solid, slice};

/// Side of a pixel, mm.
const PIXEL: f64 = 0.1;

/// Side of the squares that are judged, and their distance, in pixels.
const SQUARE: usize = 16;
const APART: usize = 5;

/// Plastic over room: at ends of lines and in corners neighbours overlap by some of it. What is filled twice
/// has 1.5 or more.
const MOST: f64 = 1.35;

/// Room of a square that is judged, mm².
const LEAST_ROOM: f64 = 1.2;

/// Half the width of a roof, mm, and its length.
const HALF: f64 = 5.0;
const LENGTH: f64 = 18.0;

/// A roof with two sloping sides on walls `foot` high.
fn gable(height: f64, foot: f64) -> Solid {
    let outline =
        vec![[-HALF, 0.0], [HALF, 0.0], [HALF, foot], [0.0, foot + height], [-HALF, foot]];
    Solid::prism(&outline, 0.0, LENGTH).map(|[x, y, z]| [z, x, y])
}

/// A roof with four.
fn hipped(height: f64, foot: f64) -> Solid {
    let eaves = || rectangle([0.0, -HALF], [LENGTH, HALF]);
    let ridge = rectangle([HALF, -0.01], [LENGTH - HALF, 0.01]);
    Solid::tower(&[(eaves(), 0.0), (eaves(), foot), (ridge, foot + height)])
}

/// Values of the pixels of a layer.
struct Map {
    low: [f64; 2],
    count: [usize; 2],
    values: Vec<f64>,
}

impl Map {
    fn over(low: [f64; 2], high: [f64; 2]) -> Self {
        let count = [0, 1].map(|axis| ((high[axis] - low[axis]) / PIXEL).ceil() as usize + 1);
        Self { low, count, values: vec![0.0; count[0] * count[1]] }
    }

    fn middle(&self, k: usize) -> [f64; 2] {
        let at = [k % self.count[0], k / self.count[0]];
        [0, 1].map(|axis| self.low[axis] + (at[axis] as f64 + 0.5) * PIXEL)
    }

    fn add(&mut self, at: [f64; 2], value: f64) {
        let index = [0, 1].map(|axis| ((at[axis] - self.low[axis]) / PIXEL).max(0.0) as usize);
        if index[0] < self.count[0] && index[1] < self.count[1] {
            self.values[index[1] * self.count[0] + index[0]] += value;
        }
    }

    /// Spreads a `bead` that covers `area` evenly over what it covers.
    fn lay(&mut self, bead: &Move, area: f64) {
        let (a, b, length) = (bead.a(), bead.b(), bead.length());
        let width = area / length;
        let across = [(a[1] - b[1]) / length * width, (b[0] - a[0]) / length * width];
        let [along, aside] = [length, width].map(|size| (size / 0.04).ceil().max(1.0) as usize);
        let part = |k: usize, of: usize| (k as f64 + 0.5) / of as f64;
        for (k, n) in (0..along).flat_map(|k| (0..aside).map(move |n| (k, n))) {
            let (t, s) = (part(k, along), part(n, aside) - 0.5);
            let at = [0, 1].map(|i| a[i] + t * (b[i] - a[i]) + s * across[i]);
            self.add(at, area / (along * aside) as f64);
        }
    }

    /// The sums of squares, with their first pixels.
    fn squares(&self) -> impl Iterator<Item = (usize, f64)> {
        let starts = |axis: usize| (0..self.count[axis].saturating_sub(SQUARE)).step_by(APART);
        let firsts = starts(1).flat_map(move |y| starts(0).map(move |x| y * self.count[0] + x));
        firsts.map(|first| {
            let rows = (0..SQUARE).map(|j| first + j * self.count[0]);
            (first, rows.map(|row| self.values[row..row + SQUARE].iter().sum::<f64>()).sum())
        })
    }
}

/// Where a layer has most plastic for its room: how much, layer and place.
fn fullest(run: &Run, solid: &Solid) -> (f64, usize, [f64; 2]) {
    let solid = solid.on_bed(run.middle());
    let beads: Vec<&Move> = run.print.moves.iter().filter(|m| m.is_bead()).collect();
    let mut worst = (0.0, 0, [0.0; 2]);
    for (k, head) in run.print.layers.iter().enumerate() {
        let section = Section::new(&solid, head.z - head.height / 2.0);
        let Some((low, high)) = section.extent() else { continue };
        let (low, high) = (low.map(|v| v - 1.0), high.map(|v| v + 1.0));
        let (mut laid, mut room) = (Map::over(low, high), Map::over(low, high));
        for bead in &beads {
            let within =
                bead.to[2].min(head.z) - (bead.to[2] - bead.height).max(head.z - head.height);
            if within > 0.01 {
                let area = bead.e * run.filament_area() / bead.height;
                laid.lay(bead, area * within / head.height);
            }
        }
        for pixel in 0..room.values.len() {
            let is_inside = section.is_inside(room.middle(pixel));
            room.values[pixel] = if is_inside { PIXEL * PIXEL } else { 0.0 };
        }
        for ((first, plastic), (_, room)) in laid.squares().zip(room.squares()) {
            if room >= LEAST_ROOM && plastic / room > worst.0 {
                worst =
                    (plastic / room, k + 1, laid.middle(first + SQUARE / 2 * (laid.count[0] + 1)));
            }
        }
    }
    worst
}

#[test]
fn no_place_of_a_roof_has_more_plastic_than_room() {
    let (mut wrong, mut all) = (Vec::new(), Vec::new());
    // Not interlaced: the turns of its lanes lie one on another in so narrow a room.
    for (mode, infill) in [("off", "20"), ("pair", "20"), ("pair", "40")] {
        let set = [("dual.mode", mode), ("infill", infill)];
        for height in [3.5, 4.1, 4.7] {
            for foot in [0.02, 0.07, 0.12, 0.17] {
                for (name, roof) in
                    [("gable", gable(height, foot)), ("hipped", hipped(height, foot))]
                {
                    let run = slice(&roof.stl(), "generic-marlin", &set);
                    let (fullest, layer, at) = fullest(&run, &roof);
                    all.push(fullest);
                    if fullest > MOST {
                        wrong.push(format!(
                            "{name} {height} mm on {foot} mm, {mode} {infill} %, layer {layer}, {at:.1?}: {fullest:.2}"
                        ));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), all.len(), wrong.join("\n"));
}
