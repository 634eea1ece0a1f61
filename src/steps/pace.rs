//! Planned times of steps -> times in whole µs that the board and its motors can keep.
//!
//! Words used here: a step is *due* when the plan has it; it is *late* by what it comes after that.
//!
//! - A time is rounded where it is handed out, never where it is added up: the sum of the plan is kept
//!   in µs and a fraction of one.
//! - Two steps are at least a pulse apart; two of one axis at least its least interval; where the axis
//!   turns round, at least the wait for that. A step that is due earlier is late.
//! - What is late by no more than the shortest interval is caught up by the steps after it: the plan
//!   itself is within the rates, and only corners and rounding bring two steps too close. What is late
//!   by more puts off all that follows. That is time that the plan does not have; it is added up as
//!   *waits*.

use super::axis::AXES;
use super::machine::Machine;

/// Long ago, µs: before any step.
const NEVER: i64 = i64::MIN / 4;

/// A clock of whole µs.
#[derive(Debug, Clone)]
pub(super) struct Pace {
    /// The end of the moves so far: whole µs, and what is left of one.
    due: i64,
    rest: f64,
    /// By how much the plan is put off, µs.
    waits: i64,
    /// When the last step was.
    before: i64,
    /// When each axis has stepped last, and which of them went towards lower numbers.
    last: [i64; AXES],
    backwards: u8,
    interval: [i64; AXES],
    turn: [i64; AXES],
    pulse: i64,
    patience: i64,
}

impl Pace {
    /// At rest, at time 0.
    #[must_use]
    pub(super) fn new(machine: &Machine) -> Self {
        let interval = machine.interval.map(i64::from);
        Self {
            due: 0,
            rest: 0.0,
            waits: 0,
            before: 0,
            last: [NEVER; AXES],
            backwards: 0,
            interval,
            turn: interval.map(|interval| interval.max(i64::from(machine.turn))),
            pulse: i64::from(machine.pulse),
            patience: interval.into_iter().min().unwrap_or(1),
        }
    }

    /// When the axes of `mask` step that are due so many µs after the beginning of this move. `backwards`
    /// has a bit for each axis that goes towards lower numbers.
    #[inline]
    pub(super) fn step(&mut self, after: f64, mask: u8, backwards: u8) -> i64 {
        // Half up: what is before zero is no time.
        let due = self.due + (self.rest + after + 0.5) as i64 + self.waits;
        let mut at = due.max(self.before + self.pulse);
        let turns = mask & (backwards ^ self.backwards);
        let mut bits = mask;
        while bits != 0 {
            let axis = (bits.trailing_zeros() as usize) % AXES;
            bits &= bits - 1;
            let apart = if turns >> axis & 1 == 1 { self.turn } else { self.interval };
            at = at.max(self.last[axis] + apart[axis]);
        }
        let mut bits = mask;
        while bits != 0 {
            let axis = (bits.trailing_zeros() as usize) % AXES;
            bits &= bits - 1;
            self.last[axis] = at;
        }
        self.backwards ^= turns;
        if at - due > self.patience {
            self.waits += at - due - self.patience;
        }
        self.before = at;
        at
    }

    /// The move ends, or nothing moves for so long, µs.
    pub(super) fn pass(&mut self, time: f64) {
        let sum = self.rest + time;
        let whole = sum.floor();
        self.due += whole as i64;
        self.rest = sum - whole;
    }

    /// The end of all so far, µs.
    #[must_use]
    pub(super) fn end(&self) -> i64 {
        (self.due + i64::from(self.rest >= 0.5) + self.waits).max(self.before)
    }

    /// Waits that the plan does not have, µs.
    #[must_use]
    pub(super) fn waits(&self) -> i64 {
        self.waits
    }
}
