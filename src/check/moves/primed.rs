//! Moves in the file's order -> a finding of what the print lays on what the start block has primed.
//!
//! A start block draws a line or two, or a heap, to fill the nozzle. The part must keep clear of it: it
//! would stand on it, and the nozzle would drag the one through the other. What is pushed out high above
//! the bed falls where nobody knows, and is not looked at.

use crate::check::beads;
use crate::check::finding::{Code, Finding, Findings, short};
use crate::check::samples::Samples;
use crate::geom::segment;
use crate::reader::Role;
use crate::reader::print::Step;

/// What is pushed out higher than this is not looked at, mm.
const LOW: f64 = 2.0;

/// Least filament of a heap, mm, and how far it reaches, mm.
const LEAST_HEAP: f64 = 0.5;
const HEAP: f64 = 1.0;

/// Half the width of a primed line at most, mm: what a file without comments lets believe of its plastic.
const MOST_HALF: f64 = 0.6;

/// Pieces that a start block primes, at most; what has more is no start block.
const MOST_PIECES: usize = 32;

/// Heights that touch no more than this are above each other, mm.
const SLACK: f64 = 0.05;

/// Lines overlap where their middles are nearer than this part of what both reach.
const NEAR: f64 = 0.8;

/// Distance of the places of a line that are looked at, mm.
const STEP: f64 = 0.25;

/// Longer lines are on no machine, mm, and are found as such.
const LONGEST: f64 = 10_000.0;

/// Least length on it that is found, mm.
const LEAST: f64 = 1.0;

/// Plastic of the start block.
struct Piece {
    ends: [[f64; 2]; 2],
    top: f64,
    reach: f64,
}

/// What is primed, and what lies on it.
#[derive(Default)]
pub(crate) struct Primed {
    pieces: Vec<Piece>,
    /// Filament that is pulled back, mm.
    pulled: f64,
    highest: f64,
    /// Length of lines on it, mm, and the first with its layer.
    length: f64,
    first: Option<(usize, Step)>,
}

impl Primed {
    /// A move of the start block.
    pub(crate) fn start(&mut self, step: &Step) {
        let [from, to] = [step.from, step.to].map(|at| at.map(f64::from));
        let filament = f64::from(step.filament);
        let pushed = filament - self.pulled;
        self.pulled = (self.pulled - filament).max(0.0);
        if to[2] > LOW || self.pieces.len() >= MOST_PIECES {
            return;
        }
        let reach = match step.is_line() {
            true => (f64::from(step.width) / 2.0).min(MOST_HALF),
            false if pushed >= LEAST_HEAP => HEAP,
            false => return,
        };
        let ends = [[from[0], from[1]], [to[0], to[1]]];
        self.pieces.push(Piece { ends, top: to[2], reach });
        self.highest = self.highest.max(to[2]);
    }

    /// A line of a layer, counted from 0.
    pub(crate) fn line(&mut self, step: &Step, layer: usize) {
        let bottom = step.heights()[0] - f64::from(step.height);
        // Nearly all lines are higher.
        if bottom >= self.highest - SLACK || step.role == Role::Adhesion {
            return;
        }
        if step.length() > LONGEST {
            return;
        }
        let half = f64::from(step.width) / 2.0;
        let on = |at: [f64; 2]| {
            self.pieces.iter().any(|piece| {
                let near = NEAR * (piece.reach + half);
                bottom < piece.top - SLACK && segment::distance2(at, piece.ends) < near * near
            })
        };
        let length: f64 = Samples::of(step, STEP)
            .filter(|sample| on(sample.at))
            .map(|sample| sample.length)
            .sum();
        if length > 0.0 {
            self.length += length;
            self.first = self.first.or(Some((layer, *step)));
        }
    }

    /// The file ends.
    pub(crate) fn finish(self, found: &mut Findings) {
        let Some((layer, step)) = self.first.filter(|_| self.length >= LEAST) else { return };
        let length = short(self.length);
        let text = format!("{length} mm of lines lie on what the start block has primed there");
        let finding = Finding::of(Code::PrintedTwice, self.length, "mm", text);
        found.add(finding.at(beads::place(layer, &step)));
    }
}
