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
pub use super::step::{Layer, Note, Order, Step, What};
use super::{Event, Facts, Firmware, Reading};
use std::io::{self, BufRead};
use std::ops::{Deref, DerefMut, Range};

/// Lines of code that the reader does not know, and of those without a number, that are kept of a file: the
/// first show what it is.
pub(super) const MOST_UNKNOWN: u64 = 1000;

/// Commands that stand between the lines of nearly every print, or are for heaters: no note of them
/// as commands is kept.
const EVERYDAY_G: &[u32] = &[4, 11, 17, 21, 90, 91];
const EVERYDAY_M: &[u32] = &[
    6, 73, 82, 83, 104, 105, 109, 110, 114, 115, 116, 117, 118, 133, 134, 140, 190, 201, 203, 204,
    205, 400, 486, 566, 572, 900,
];

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
        reading: impl Into<Reading>,
        filament_diameter: f64,
    ) -> io::Result<Self> {
        let (mut gatherer, mut moves) = (Gatherer::default(), Kept::default());
        let summary = super::read(source, reading, &mut |line, event| {
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

    /// The moves of the start, 0, or of a layer, from 1, and the notes before, between and after them.
    #[must_use]
    pub fn section(&self, index: usize) -> (Range<usize>, &[Note]) {
        let layer = index.checked_sub(1);
        let range = layer.map_or(&self.start, |layer| &self.layers[layer].moves).clone();
        let note = |at: usize| self.notes.partition_point(|note| note.at < at);
        let first = if index == 0 { 0 } else { note(range.start) };
        let end = if index == self.layers.len() { self.notes.len() } else { note(range.end) };
        (range, &self.notes[first..end])
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

/// Whether no note is kept of a command. G92 is kept where it names an axis, or none at all, and G10
/// where it is no retraction.
fn is_everyday(letter: u8, number: u32, code: &[u8]) -> bool {
    let bare = || code.iter().skip(1).all(|byte| !byte.is_ascii_alphabetic());
    let names = |axes: &[u8]| code.iter().any(|byte| axes.contains(&byte.to_ascii_uppercase()));
    match (letter, number) {
        (b'G', 10) => !names(b"LXYZUVW"),
        (b'G', 92) => !bare() && !names(b"XYZ"),
        (b'G', number) => EVERYDAY_G.contains(&number),
        (b'M', number) => EVERYDAY_M.contains(&number),
        _ => false,
    }
}

/// What of the events is kept: moves, not measured yet, and notes.
#[derive(Default)]
pub(super) struct Kept {
    pub(super) moves: Vec<Step>,
    pub(super) notes: Vec<Note>,
    /// Lines of unknown code so far, those before these moves included.
    pub(super) unknown: u64,
    /// Likewise lines with a word that has no number.
    pub(super) numberless: u64,
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
            Event::NoNumber { letter, code } => {
                self.numberless += 1;
                if self.numberless > MOST_UNKNOWN {
                    return;
                }
                What::NoNumber { letter, code: String::from_utf8_lossy(&code).into_owned() }
            }
            Event::Command { letter, number, code } if !is_everyday(letter, number, &code) => {
                What::Command(Order::new(letter, number, &code))
            }
            _ => return,
        };
        self.notes.push(Note { at, line, what });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reader::Role;

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
