//! Steps and marks -> moves of G-code: where the nozzle went, for `preview`, `check` and `diff`.
//!
//! Moves end where the stream marks the end of a move of the file, at its true end, which is within half
//! a step of where the axes stand. A stream of coils has no marks: there every step is a move.
//!
//! F is the highest speed within the move, by the axis that steps most: its times are whole µs, so that
//! as many of its steps as there are, up to 64, are looked at together.

use super::axis::{AXES, LETTERS};
use super::decode::Item;
use super::format::{Form, Header};
use std::fmt::Write as _;

/// Steps over which a speed is taken at most.
const WINDOW: usize = 64;

/// Writes moves.
#[derive(Debug, Clone)]
pub struct Path {
    header: Header,
    /// Where the axes stand, in steps.
    steps: [i64; AXES],
    /// Where the last move ended, mm.
    at: [f64; AXES],
    axes: [Timing; AXES],
}

/// When an axis has stepped since the move began.
#[derive(Debug, Clone, Copy)]
struct Timing {
    /// The last times, µs, in a ring.
    times: [i64; WINDOW],
    count: usize,
    /// Shortest time of so many steps, for 1, 4, 16 and 63.
    shortest: [i64; WINDOWS.len()],
}

const WINDOWS: [usize; 4] = [1, 4, 16, 63];

impl Timing {
    const NONE: Self = Self { times: [0; WINDOW], count: 0, shortest: [i64::MAX; WINDOWS.len()] };

    fn step(&mut self, at: i64) {
        for (shortest, window) in self.shortest.iter_mut().zip(WINDOWS) {
            if self.count >= window {
                let before = self.times[(self.count - window) % WINDOW];
                *shortest = (*shortest).min(at - before);
            }
        }
        self.times[self.count % WINDOW] = at;
        self.count += 1;
    }

    /// Most steps a second; 0 where there are not two.
    fn rate(&self) -> f64 {
        let known = self.shortest.iter().zip(WINDOWS).rev().find(|(time, _)| **time < i64::MAX);
        known.map_or(0.0, |(time, window)| window as f64 * 1e6 / (*time).max(1) as f64)
    }
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
        Self { header: header.clone(), steps: machine.start, at, axes: [Timing::NONE; AXES] }
    }

    /// Adds an item, and the move that it ends.
    pub fn item(&mut self, item: &Item, text: &mut String) {
        match *item {
            Item::Step { at, mask, backwards } => {
                for axis in (0..AXES).filter(|axis| mask >> axis & 1 == 1) {
                    self.steps[axis] += if backwards >> axis & 1 == 1 { -1 } else { 1 };
                    self.axes[axis].step(at);
                }
                if matches!(self.header.form, Form::Coils(_)) {
                    self.go([0; AXES], text);
                }
            }
            Item::Mark(parts) => self.go(parts, text),
        }
    }

    /// A move to where the axes stand, and so many parts of a step on.
    fn go(&mut self, parts: [i16; AXES], text: &mut String) {
        let scale = &self.header.machine.scale;
        let to: [f64; AXES] = std::array::from_fn(|axis| {
            scale[axis].mm(self.steps[axis] as f64 + f64::from(parts[axis]) / 65_536.0)
        });
        text.push_str("G1");
        for axis in 0..AXES {
            if to[axis] != self.at[axis] {
                let _ = write!(text, " {}{:.6}", LETTERS[axis], to[axis]);
            }
        }
        if let Some(speed) = self.speed(to) {
            let _ = write!(text, " F{:.3}", 60.0 * speed);
        }
        text.push('\n');
        self.at = to;
        self.axes.iter_mut().for_each(|axis| (axis.count, axis.shortest) = (0, Timing::NONE.shortest));
    }

    /// Highest speed of the move to `to`, mm/s; `None` where no axis makes two steps.
    fn speed(&self, to: [f64; AXES]) -> Option<f64> {
        let delta: [f64; AXES] = std::array::from_fn(|axis| to[axis] - self.at[axis]);
        let nozzle = (delta[0] * delta[0] + delta[1] * delta[1] + delta[2] * delta[2]).sqrt();
        let way = if nozzle > 0.0 { nozzle } else { delta[3].abs() };
        let most = (0..AXES).max_by_key(|axis| self.axes[*axis].count)?;
        let rate = self.axes[most].rate();
        let steps = delta[most].abs() * self.header.machine.scale[most].per_mm();
        (rate > 0.0 && steps > 0.0).then(|| rate / steps * way)
    }
}
