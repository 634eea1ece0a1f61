//! Events -> Print: a whole G-code file as layers of moves, held compactly.
//!
//! Words used here: a *move* (or step) is a straight way of the nozzle; a *line* is a move that goes
//! sideways and extrudes; the *start* is all moves before the first layer; a *note* is what happens
//! between two moves.
//!
//! Moves are collected as they come, with floats of 32 bits: files have millions, and positions with
//! three decimals below 10 m survive that. Beside them the facts of the file are gathered ([`Facts`]),
//! its layers among them.
//!
//! Then each line gets its width and height: from comments where the file has them, else the height
//! of the layer, and the width that its plastic fills at that height.
//!
//! Who needs a layer at a time reads a [`Stream`](super::Stream) instead: it gives the same moves.

use super::facts::Gatherer;
use super::{Event, Facts, Firmware, Heating, Motion, Role};
use std::f64::consts::FRAC_PI_4;
use std::io::{self, BufRead};
use std::ops::{Deref, DerefMut, Range};

/// Lines of code that the reader does not know and that are kept, of a file: the first show what
/// it is.
pub(super) const MOST_UNKNOWN: u64 = 1000;

/// A whole G-code file: its moves, and the facts of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Print {
    /// What is known of the file as a whole.
    pub facts: Facts,
    /// All moves, in the file's order.
    pub moves: Vec<Step>,
    /// What lies between the moves, in the file's order.
    pub notes: Vec<Note>,
}

impl Deref for Print {
    type Target = Facts;

    fn deref(&self) -> &Facts {
        &self.facts
    }
}

impl DerefMut for Print {
    fn deref_mut(&mut self) -> &mut Facts {
        &mut self.facts
    }
}

/// One layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Its part of [`Print::moves`].
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
    /// What it prints, if anything.
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
}

impl Step {
    /// Way of the nozzle, mm.
    #[must_use]
    pub fn length(&self) -> f64 {
        let way = |axis: usize| f64::from(self.to[axis]) - f64::from(self.from[axis]);
        (way(0) * way(0) + way(1) * way(1) + way(2) * way(2)).sqrt()
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

impl Print {
    /// Reads a whole file. `filament_diameter`, in mm, gives the widths of lines without a comment,
    /// unless the file has a diameter of its own.
    ///
    /// As [`Self::read_as`] for no firmware in particular.
    ///
    /// # Errors
    /// Only what reading the bytes gives: no content is an error.
    pub fn read(source: &mut dyn BufRead, filament_diameter: f64) -> io::Result<Self> {
        Self::read_as(source, Firmware::default(), filament_diameter)
    }

    /// Reads a whole file by the rules of a firmware.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_as(
        source: &mut dyn BufRead,
        firmware: Firmware,
        filament_diameter: f64,
    ) -> io::Result<Self> {
        let (mut gatherer, mut moves) = (Gatherer::default(), Kept::default());
        let summary = super::read(source, firmware, &mut |line, event| {
            gatherer.event(line, &event);
            moves.event(line, event);
        })?;
        let facts = gatherer.facts(summary, filament_diameter);
        let Kept { mut moves, notes, .. } = moves;
        facts.measure(0, &mut moves);
        Ok(Self { facts, moves, notes })
    }

    /// The moves of a layer.
    #[must_use]
    pub fn moves_of(&self, layer: &Layer) -> &[Step] {
        &self.moves[layer.moves.clone()]
    }

    /// The lines of all layers.
    pub fn lines(&self) -> impl Iterator<Item = &Step> {
        let steps = self.layers.iter().flat_map(|layer| self.moves_of(layer));
        steps.filter(|step| step.is_line())
    }

    /// Height of the nozzle at the highest line of all layers, mm; 0 without one.
    #[must_use]
    pub fn top(&self) -> f64 {
        self.lines().map(|step| step.heights()[1]).fold(0.0, f64::max)
    }
}

/// What of the events is kept: moves, not measured yet, and notes.
#[derive(Default)]
pub(super) struct Kept {
    pub(super) moves: Vec<Step>,
    pub(super) notes: Vec<Note>,
    /// Lines of unknown code so far, those before these moves included.
    pub(super) unknown: u64,
}

impl Kept {
    pub(super) fn event(&mut self, line: u64, event: Event) {
        let at = self.moves.len();
        let what = match event {
            Event::Move(motion) => return self.moves.push(Step::of(line, &motion)),
            Event::Heating(heating) => What::Heating(heating),
            Event::FirmwareRetraction { back } => What::FirmwareRetraction { back },
            Event::Unknown(code) => {
                self.unknown += 1;
                if self.unknown > MOST_UNKNOWN {
                    return;
                }
                What::Unknown(String::from_utf8_lossy(&code).into_owned())
            }
            _ => return,
        };
        self.notes.push(Note { at, line, what });
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
            let boxed = f64::from(self.filament) * area / self.length() / height;
            self.width = (boxed + (1.0 - FRAC_PI_4) * height) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn print(text: &str) -> Print {
        Print::read(&mut text.as_bytes(), 1.75).unwrap()
    }

    #[test]
    fn layers_begin_at_marks_and_end_where_the_next_begins() {
        let text = "; by hand\n;a = 1\nG1 X1 E1 ; b = 2\n;LAYER_CHANGE\nG1 Z0.3\nM104 S200\n\
                    ;TYPE:Skin\n;WIDTH:0.5\nG1 X9 E2\n;LAYER_CHANGE\nG1 Z0.5\nG1 X1 E3\n\
                    ;LAYER_CHANGE\nFOO\nG1 Z9";
        let print = print(text);
        assert_eq!(print.start, 0..1);
        let layers: Vec<_> = print.layers.iter().map(|l| (l.moves.clone(), l.z as f32)).collect();
        assert_eq!(layers, [(1..3, 0.3), (3..6, 0.5)]);
        assert!((print.layers[1].height - 0.2).abs() < 1e-6);
        let line = print.moves[2];
        assert_eq!((line.width, line.height, line.role, line.line), (0.5, 0.3, Role::Skin, 9));
        assert!(print.marked && print.has_widths && !print.has_heights);
        assert_eq!(print.head, ["by hand", "a = 1"]);
        assert_eq!((print.value("a"), print.value("b")), (Some("1"), Some("2")));
        let notes: Vec<_> = print.notes.iter().map(|note| (note.at, note.line)).collect();
        assert_eq!(notes, [(2, 6), (5, 14)]);
    }

    #[test]
    fn widths_that_no_comment_tells_come_from_the_plastic() {
        let print = print("G1 Z0.2\nG1 X10 E0.3326");
        let line = print.moves[1];
        assert_eq!(line.height, 0.2);
        // 0.4 × 0.2 mm as a box.
        assert!((line.width - 0.443).abs() < 0.001, "{}", line.width);
        assert_eq!(print.layers.len(), 1);
    }
}
