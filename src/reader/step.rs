//! Motion -> Step: a move held compactly, and what lies between moves.
//!
//! Words used here: a *move* (or step) is a straight way of the nozzle; a *line* is a move that goes
//! sideways and extrudes; a *note* is what happens between two moves.

use super::{Heating, Motion, Role, words};
use std::f64::consts::FRAC_PI_4;
use std::ops::Range;

/// Words of a command that are kept: more than any has.
const MOST_WORDS: usize = 16;

/// One layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Its part of the file's moves.
    pub moves: Range<usize>,
    /// Height of the nozzle where most of its lines lie, mm.
    pub z: f64,
    /// How far it lies above the layer below, or the bed, mm.
    pub height: f64,
}

/// A straight move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Where the nozzle is before it, mm.
    pub from: [f32; 3],
    /// Where the nozzle is after it, mm.
    pub to: [f32; 3],
    /// Filament pushed out, mm; below 0 it is pulled back.
    pub filament: f32,
    /// Feed asked for, mm/s.
    pub feed: f32,
    /// Width of the line, mm: by the file's comments, else by its plastic; 0 for what is no line.
    pub width: f32,
    /// Height of the line, mm: by the file's comments, else that of its layer; 0 for what is no line.
    pub height: f32,
    /// What it prints, if anything. All lines of a patch are non-planar skin; which patch it is tells
    /// [`Facts::patch_at`](super::Facts::patch_at).
    pub role: Role,
    /// Line of the file, from 1.
    pub line: u32,
}

/// Something that happens between two moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// How many moves come before it.
    pub at: usize,
    /// Line of the file, from 1.
    pub line: u64,
    /// What.
    pub what: What,
}

/// See [`Note`].
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// A command for a heater.
    Heating(Heating),
    /// G10 (back) or G11.
    FirmwareRetraction {
        /// Whether filament is pulled back.
        back: bool,
    },
    /// Code that the reader does not know: the first thousand lines of it.
    Unknown(String),
    /// A word of a command has no number where it needs one.
    NoNumber {
        /// The word's letter.
        letter: u8,
        /// The whole line of code.
        code: String,
    },
    /// A command other than a move, but for those that stand everywhere in a print.
    Command(Order),
}

/// A command with its words.
#[derive(Debug, Clone, PartialEq)]
pub struct Order {
    /// `G`, `M` or `T`, mostly.
    pub letter: u8,
    /// What follows the letter, without its fraction.
    pub number: u32,
    /// Whether the number has a fraction, as that of `M862.1`.
    pub has_part: bool,
    /// The letters that follow, each with its number if it has one.
    pub words: Vec<(u8, Option<f64>)>,
}

impl Order {
    pub(super) fn new(letter: u8, number: u32, code: &[u8]) -> Self {
        let read = words::command(code);
        let (has_part, words) = read.map_or((false, Vec::new()), |(command, words)| {
            (command.has_part, words.take(MOST_WORDS).collect())
        });
        Self { letter, number, has_part, words }
    }

    /// Whether one of the words has this letter.
    #[must_use]
    pub fn has(&self, letter: u8) -> bool {
        self.words.iter().any(|(one, _)| *one == letter)
    }

    /// The number of the first word with this letter.
    #[must_use]
    pub fn value(&self, letter: u8) -> Option<f64> {
        self.words.iter().find(|(one, _)| *one == letter)?.1
    }
}

impl Step {
    /// Way of the nozzle, mm.
    #[must_use]
    pub fn length(&self) -> f64 {
        let way = |axis: usize| f64::from(self.to[axis]) - f64::from(self.from[axis]);
        (way(0) * way(0) + way(1) * way(1) + way(2) * way(2)).sqrt()
    }

    /// Way of the nozzle from above, mm.
    #[must_use]
    pub fn plan_length(&self) -> f64 {
        let way = |axis: usize| f64::from(self.to[axis]) - f64::from(self.from[axis]);
        (way(0) * way(0) + way(1) * way(1)).sqrt()
    }

    /// Room of the line by its width and height, mm³. It is as long as it is from above: lines are
    /// spaced, and heights told, from above, so that a slope makes a bead thinner and as much longer.
    #[must_use]
    pub fn room(&self) -> f64 {
        self.plan_length() * f64::from(self.width) * f64::from(self.height)
    }

    /// Lowest and highest height of the nozzle, mm.
    #[must_use]
    pub fn heights(&self) -> [f64; 2] {
        let [from, to] = [self.from[2], self.to[2]].map(f64::from);
        if from < to { [from, to] } else { [to, from] }
    }

    /// Whether it lays down a line: it goes sideways and pushes filament.
    #[must_use]
    pub fn is_line(&self) -> bool {
        self.filament > 0.0 && (self.from[0] != self.to[0] || self.from[1] != self.to[1])
    }
}

impl Step {
    /// A move of this line, not measured yet.
    pub(super) fn of(line: u64, motion: &Motion) -> Self {
        let narrow = |at: [f64; 3]| at.map(|at| at as f32);
        Self {
            from: narrow(motion.from),
            to: narrow(motion.to),
            filament: motion.filament as f32,
            feed: motion.feed.0 as f32,
            width: motion.width.unwrap_or(0.0) as f32,
            height: motion.height.unwrap_or(0.0) as f32,
            role: motion.role,
            line: u32::try_from(line).unwrap_or(u32::MAX),
        }
    }

    /// Fills in the width and height that comments do not give; `layer` is the layer's height,
    /// `area` the filament's cross-section.
    pub(super) fn measure(&mut self, layer: f64, area: f64) {
        if !self.is_line() {
            (self.width, self.height) = (0.0, 0.0);
            return;
        }
        if self.height == 0.0 {
            self.height = layer as f32;
        }
        if self.width == 0.0 {
            // A bead with round ends is as much wider than a box of the same height and volume.
            let height = f64::from(self.height);
            let boxed = f64::from(self.filament) * area / self.plan_length() / height;
            self.width = (boxed + (1.0 - FRAC_PI_4) * height) as f32;
        }
    }
}
