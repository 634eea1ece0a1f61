//! Steps and marks -> moves of G-code: where the nozzle went, for `preview`, `check` and `diff`.
//!
//! Moves end where the stream marks the end of a move of the file, at its true end, which is within half
//! a step of where the axes stand, and have its feed. A stream of coils has no marks: there every step is
//! a move, as fast as it came.

use super::axis::{AXES, LETTERS};
use super::decode::Item;
use super::format::{Form, Header, UM};
use std::fmt::Write as _;

/// Parts of a step that a mark counts.
const PARTS: f64 = 65_536.0;

/// Writes moves.
#[derive(Debug, Clone)]
pub struct Path {
    header: Header,
    /// Where the axes stand, in steps.
    steps: [i64; AXES],
    /// Where the last move ended, mm, and when the last step was, µs.
    at: [f64; AXES],
    time: i64,
    feed: u32,
}

impl Path {
    /// From where the stream begins; writes where that is.
    #[must_use]
    pub fn new(header: &Header, text: &mut String) -> Self {
        let machine = &header.machine;
        let at = machine.mm(machine.start);
        text.push_str("; the path of a stream of steps\nG21\nG90\nM82\nG92");
        for axis in 0..AXES {
            let _ = write!(text, " {}{:.6}", LETTERS[axis], at[axis]);
        }
        text.push('\n');
        Self { header: header.clone(), steps: machine.start, at, time: 0, feed: 0 }
    }

    /// Adds an item, and the move that it ends.
    pub fn item(&mut self, item: &Item, text: &mut String) {
        match *item {
            Item::Step { at, mask, backwards } => {
                for axis in (0..AXES).filter(|axis| mask >> axis & 1 == 1) {
                    self.steps[axis] += if backwards >> axis & 1 == 1 { -1 } else { 1 };
                }
                if matches!(self.header.form, Form::Coils(_)) {
                    let to = self.place([0; AXES]);
                    let feed = self.way(to) * UM / ((at - self.time).max(1) as f64 / 1e6);
                    self.go(to, feed.round() as u32, text);
                }
                self.time = at;
            }
            Item::Mark { parts, feed } => self.go(self.place(parts), feed, text),
        }
    }

    /// Where the axes stand, and so many parts of a step on, mm.
    fn place(&self, parts: [i16; AXES]) -> [f64; AXES] {
        let scale = &self.header.machine.scale;
        std::array::from_fn(|axis| {
            scale[axis].mm(self.steps[axis] as f64 + f64::from(parts[axis]) / PARTS)
        })
    }

    /// How far it is to there: of the nozzle, or of the filament where only that moves, mm.
    fn way(&self, to: [f64; AXES]) -> f64 {
        let [x, y, z, e] = std::array::from_fn(|axis| to[axis] - self.at[axis]);
        let nozzle = (x * x + y * y + z * z).sqrt();
        if nozzle > 0.0 { nozzle } else { e.abs() }
    }

    fn go(&mut self, to: [f64; AXES], feed: u32, text: &mut String) {
        text.push_str("G1");
        for axis in 0..AXES {
            if to[axis] != self.at[axis] {
                let _ = write!(text, " {}{:.6}", LETTERS[axis], to[axis]);
            }
        }
        if feed != self.feed {
            let _ = write!(text, " F{:.3}", f64::from(feed) * 60.0 / UM);
        }
        text.push('\n');
        (self.at, self.feed) = (to, feed);
    }
}
