//! Moves of a file -> straight moves of the nozzle and of the filament.
//!
//! - A move from an unknown place counts as one of no length.
//! - Arcs (G2, G3) become straight pieces, as many as keep close to them. A short file may ask for
//!   arcs that need any number of pieces: what it may have is bounded by its bytes (see
//!   [`pieces`](super::pieces)). An arc that would need more is read coarser, and once round whatever
//!   its P says; that is counted.
//! - While the printer's own retraction has lifted the nozzle, all moves lie that much higher.

use super::firmware::{Ab, Factors};
use super::missing;
use super::state::State;
use super::words::Words;
use super::{Event, Motion, Role};
use crate::geom::arc::{Arc, MOST_PIECES};
use crate::units::{MmPerMin, MmPerS};

/// The words that a move may have.
#[derive(Default)]
struct Target {
    axes: [Option<f64>; 3],
    /// A, B or E, and its number.
    filament: Option<(u8, f64)>,
    /// I, J and R of an arc.
    arc: [Option<f64>; 3],
    /// Whole turns that an arc makes besides.
    turns: f64,
}

impl State {
    pub(super) fn straight(&mut self, words: Words<'_>, sink: &mut dyn FnMut(Event)) {
        let target = self.target(words);
        let to = self.places.end(target.axes, self.relative);
        let filament = self.push_filament(target.filament);
        self.go(to, filament, sink);
    }

    pub(super) fn arc(&mut self, words: Words<'_>, clockwise: bool, sink: &mut dyn FnMut(Event)) {
        let target = self.target(words);
        let from = self.places.at.map(Option::unwrap_or_default);
        let to = self.places.end(target.axes, self.relative);
        let end = [to[0].unwrap_or_default(), to[1].unwrap_or_default()];
        let filament = self.push_filament(target.filament);
        let start = [from[0], from[1]];
        let arc = match target.arc {
            [None, None, Some(radius)] => Arc::by_radius(start, end, radius, clockwise),
            [None, None, None] => None,
            [i, j, _] => {
                let middle = [from[0] + i.unwrap_or(0.0), from[1] + j.unwrap_or(0.0)];
                Some(Arc { from: start, to: end, middle, clockwise })
            }
        };
        let Some(arc) = arc else { return self.go(to, filament, sink) };
        let (count, turns) = self.divide(&arc, target.turns);
        let top = to[2].unwrap_or_default();
        let pieces = f64::from(count);
        for (k, [x, y]) in arc.divided(count, turns).enumerate() {
            let z = from[2] + (top - from[2]) * (k + 1) as f64 / pieces;
            self.go([Some(x), Some(y), Some(z)], filament / pieces, sink);
        }
    }

    /// How many pieces the arc gets, and how many turns more it is given.
    fn divide(&mut self, arc: &Arc, mut turns: f64) -> (u32, f64) {
        let mut wanted = arc.pieces(turns);
        let mut is_coarse = false;
        if turns > 0.0 && wanted > MOST_PIECES {
            turns = 0.0;
            wanted = arc.pieces(turns);
            is_coarse = true;
        }
        let count = self.pieces.take(wanted.min(MOST_PIECES) as u32);
        if f64::from(count) < wanted {
            turns = 0.0;
            is_coarse = true;
        }
        if is_coarse {
            if self.summary.coarse_arcs == 0 {
                self.summary.first_coarse_arc = self.summary.lines;
            }
            self.summary.coarse_arcs += 1;
        }
        (count, turns)
    }

    /// The words of a move; F takes effect at once.
    fn target(&mut self, mut words: Words<'_>) -> Target {
        let mut target = Target::default();
        while let Some((letter, value)) = words.next() {
            let Some(value) = value else {
                let is_computed = words.bracket == Some(b'{') && self.computes();
                if missing::OF_MOVES.contains(&letter) && !is_computed {
                    self.numberless = self.numberless.or(Some(letter));
                }
                continue;
            };
            let length = value * self.unit;
            match letter {
                b'X' | b'Y' | b'Z' => target.axes[usize::from(letter - b'X')] = Some(length),
                b'E' => target.filament = Some((letter, length)),
                b'A' | b'B' if self.rules.ab != Ab::Nothing => {
                    target.filament = Some((letter, length));
                }
                b'I' => target.arc[0] = Some(length),
                b'J' => target.arc[1] = Some(length),
                b'R' => target.arc[2] = Some(length),
                b'P' if self.rules.turns => target.turns = value.max(0.0).floor(),
                b'F' if value > 0.0 => self.feed = MmPerMin(length).into(),
                _ => {}
            }
        }
        target
    }

    fn go(&mut self, to: [Option<f64>; 3], filament: f64, sink: &mut dyn FnMut(Event)) {
        let from = std::mem::replace(&mut self.places.at, to);
        // From an unknown place the way is unknown, too: none is counted.
        let mut to = to.map(Option::unwrap_or_default);
        let mut from: [f64; 3] = std::array::from_fn(|axis| from[axis].unwrap_or(to[axis]));
        let moves = from != to;
        let (feed, filament) = self.scaled(moves, filament);
        let role = match (moves, filament > 0.0) {
            // The filament alone may move, or the nozzle up: neither lays a line.
            (true, true) if self.is_in_patch => Role::NonPlanar,
            (true, true) => self.role,
            (true, false) => Role::Travel,
            (false, _) if filament != 0.0 => Role::Retraction,
            (false, _) => return,
        };
        from[2] += self.retraction.lifted;
        to[2] += self.retraction.lifted;
        let (width, height) = (self.width, self.height);
        sink(Event::Move(Motion { from, to, filament, feed, role, width, height }));
    }

    /// Feed and filament by the factors of M220 and M221.
    fn scaled(&self, moves: bool, filament: f64) -> (MmPerS, f64) {
        let counts = match self.rules.factors {
            Factors::All => true,
            Factors::Lines => moves && filament != 0.0,
        };
        if counts {
            (MmPerS(self.feed.0 * self.feed_factor), filament * self.flow())
        } else {
            (self.feed, filament)
        }
    }

    /// G10 (`back`) or G11.
    pub(super) fn retract(&mut self, back: bool, sink: &mut dyn FnMut(Event)) {
        if !self.retraction.is_known() {
            self.summary.firmware_retractions += 1;
            return sink(Event::FirmwareRetraction { back });
        }
        let before = self.retraction.lifted;
        let pull = self.retraction.pull(back);
        self.retraction.lifted = pull.lifted;
        let at = self.places.at.map(Option::unwrap_or_default);
        let lifted = |by: f64| [at[0], at[1], at[2] + by];
        let (width, height) = (self.width, self.height);
        let hop = Motion {
            from: lifted(before),
            to: lifted(pull.lifted),
            filament: 0.0,
            feed: pull.hop_feed,
            role: Role::Travel,
            width,
            height,
        };
        // The nozzle is lifted after the way back, and let down before the way out.
        let place = if back { hop.from } else { hop.to };
        let pulled = Motion {
            from: place,
            to: place,
            filament: pull.filament,
            feed: pull.feed.unwrap_or(self.feed),
            role: Role::Retraction,
            ..hop
        };
        let both = if back { [pulled, hop] } else { [hop, pulled] };
        let some = |motion: &Motion| motion.filament != 0.0 || motion.from != motion.to;
        both.into_iter().filter(some).for_each(|motion| sink(Event::Move(motion)));
    }
}
