//! A sound file's text + changed moves -> a text in which all else stays as it is.
//!
//! Where E counts on, `G92` sets it back after a changed move; the move after it is written in full,
//! since words stay in force until the next. [`Sound::counts`] asks whether two texts print
//! something else or lead the nozzle another way, by more than 0.3 mm.
//!
//! Words: a *bead* is a move that lays plastic on a layer.

use super::common::gcode::{Move, Print};
use std::collections::BTreeMap;

/// A way or a line that is off by less is the same, mm.
pub(super) const SAME: f64 = 0.3;

/// Plastic that differs by less is the same, mm of filament of 1.75 mm: a cube of 0.3 mm.
const SAME_FILAMENT: f64 = 0.027 / 2.405;

/// Ways are compared at places so far apart, mm, and at so many at most.
const PITCH: (f64, usize) = (0.1, 2000);

/// A sound file.
pub(crate) struct Sound {
    pub(super) lines: Vec<String>,
    pub(super) print: Print,
    pub(super) relative: bool,
    /// Beads of the layers, by their places in the moves.
    pub(super) beads: Vec<usize>,
    /// Lowest and highest corner of the beads on the layers.
    pub(super) extent: [[f64; 3]; 2],
}

/// Chance, from a seed: SplitMix64 (Steele, Lea and Flood, 2014).
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.next() % count.max(1) as u64) as usize
    }

    pub(super) fn pick<T: Copy>(&mut self, of: &[T]) -> Option<T> {
        (!of.is_empty()).then(|| of[self.below(of.len())])
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// One of eight ways of 0.4 mm.
    pub(super) fn shift(&mut self) -> [f64; 2] {
        let (sin, cos) = (self.below(8) as f64 * std::f64::consts::FRAC_PI_4).sin_cos();
        [0.4 * cos, 0.4 * sin]
    }
}

/// The number of a word of a line.
pub(super) fn word(line: &str, letter: char) -> Option<f64> {
    let code = line.split(';').next()?;
    code.split_whitespace().skip(1).find_map(|word| word.strip_prefix(letter)?.parse().ok())
}

pub(super) fn with_word(line: &str, letter: char, to: &str) -> String {
    let words = line.split(' ').map(|word| {
        if word.starts_with(letter) { format!("{letter}{to}") } else { word.to_owned() }
    });
    words.collect::<Vec<_>>().join(" ")
}

impl Sound {
    pub(crate) fn new(text: &str) -> Self {
        let print = Print::read(text).unwrap();
        let beads: Vec<usize> =
            (0..print.moves.len()).filter(|&k| print.moves[k].is_bead()).collect();
        let mut extent = [[f64::MAX; 3], [f64::MIN; 3]];
        for at in beads.iter().flat_map(|&k| [print.moves[k].from, print.moves[k].to]) {
            for axis in 0..3 {
                extent[0][axis] = extent[0][axis].min(at[axis]);
                extent[1][axis] = extent[1][axis].max(at[axis]);
            }
        }
        let relative = text.lines().any(|line| line.trim() == "M83");
        Self { lines: text.lines().map(str::to_owned).collect(), print, relative, beads, extent }
    }

    /// The file with other moves at these places.
    pub(super) fn rewritten(&self, changed: &BTreeMap<usize, Move>) -> String {
        let mut lines = self.lines.clone();
        for (&k, new) in changed {
            self.write(&mut lines, k, new);
            if !changed.contains_key(&(k + 1))
                && let Some(after) = self.print.moves.get(k + 1)
            {
                self.write(&mut lines, k + 1, after);
            }
        }
        lines.join("\n") + "\n"
    }

    /// Writes the move in full in place of the one with this number.
    fn write(&self, lines: &mut [String], k: usize, new: &Move) {
        let old = &self.print.moves[k];
        let line = &mut lines[old.line - 1];
        let told = word(&self.lines[old.line - 1], 'E');
        let before = told.map_or(0.0, |e| if self.relative { 0.0 } else { e - old.e });
        let [x, y, z] = new.to;
        let mut text = format!("G1 X{x:.3} Y{y:.3} Z{z:.3}");
        if new.e != 0.0 {
            text += &format!(" E{:.5}", before + new.e);
        }
        text += &format!(" F{:.3}", new.feed);
        if let Some(told) = told.filter(|_| !self.relative && new.e != old.e) {
            text += &format!("\nG92 E{told}");
        }
        *line = text;
    }

    /// The file with a text before a line (from 0).
    pub(super) fn inserted(&self, line: usize, text: &str) -> String {
        let [before, after] = [&self.lines[..line], &self.lines[line..]];
        format!("{}\n{text}{}\n", before.join("\n"), after.join("\n"))
    }

    /// The file without these lines (from 1).
    pub(super) fn without(&self, lines: &[usize]) -> String {
        let stays = |k: &usize| !lines.contains(&(k + 1));
        let rest = (0..self.lines.len()).filter(stays).map(|k| self.lines[k].as_str());
        rest.collect::<Vec<_>>().join("\n") + "\n"
    }

    /// Whether the text prints something else than this file, or leads the nozzle another way. What is
    /// no G-code any more counts.
    pub(crate) fn counts(&self, text: &str) -> bool {
        let Ok(other) = Print::read(text) else { return true };
        let (a, b) = (&self.print.moves[..], &other.moves[..]);
        let same = |a: &Move, b: &Move| a.from == b.from && a.to == b.to && a.e == b.e;
        let first = a.iter().zip(b).take_while(|(a, b)| same(a, b)).count();
        let (a, b) = (&a[first..], &b[first..]);
        let last = a.iter().rev().zip(b.iter().rev()).take_while(|(a, b)| same(a, b)).count();
        let (a, b) = (&a[..a.len() - last], &b[..b.len() - last]);
        let pushed = |of: &[Move]| of.iter().map(|m| m.e).sum::<f64>();
        let beads = |of: &[Move]| -> Vec<Move> {
            of.iter().copied().filter(|m| m.e > 0.0 && m.length() > 0.0).collect()
        };
        let laid = |of: &[Move]| pushed(&beads(of));
        (pushed(a) - pushed(b)).abs() > SAME_FILAMENT
            || (laid(a) - laid(b)).abs() > SAME_FILAMENT
            || is_apart(a, b)
            || is_apart(b, a)
            || is_apart(&beads(a), &beads(b))
            || is_apart(&beads(b), &beads(a))
    }
}

/// Whether a place of one way is farther than [`SAME`] from the other.
fn is_apart(one: &[Move], other: &[Move]) -> bool {
    one.iter().any(|m| {
        let length: f64 =
            (0..3).map(|axis| (m.to[axis] - m.from[axis]).powi(2)).sum::<f64>().sqrt();
        let count = ((length / PITCH.0) as usize).clamp(1, PITCH.1);
        (0..=count).any(|k| {
            let t = k as f64 / count as f64;
            let at = [0, 1, 2].map(|axis| m.from[axis] + t * (m.to[axis] - m.from[axis]));
            other.iter().all(|other| distance(at, other) > SAME)
        })
    })
}

/// From a place to a move, mm.
fn distance(at: [f64; 3], m: &Move) -> f64 {
    let way = [0, 1, 2].map(|axis| m.to[axis] - m.from[axis]);
    let to = [0, 1, 2].map(|axis| at[axis] - m.from[axis]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let t = if dot(way, way) > 0.0 { (dot(way, to) / dot(way, way)).clamp(0.0, 1.0) } else { 0.0 };
    let off = [0, 1, 2].map(|axis| to[axis] - t * way[axis]);
    dot(off, off).sqrt()
}
