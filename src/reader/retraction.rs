//! G10 and G11 -> moves of the filament: how far and how fast a printer pulls it back by itself.
//!
//! How far is not in G10: M207 says it (Klipper: SET_RETRACTION), or the printer's own settings, which a
//! file does not have. Then nothing is known, and G10 is only an event.

use super::Change;
use super::firmware::{M207, OwnFilament};
use super::words::{self, Words};
use crate::units::{MmPerMin, MmPerS};

/// Feed of a hop where nobody says one: firmwares lift as fast as the axis goes, which clocks know.
const HOP: MmPerS = MmPerS(1000.0);

/// What G10 and G11 do.
#[derive(Debug, Clone)]
pub(super) struct Retraction {
    /// How far filament is pulled back, mm; 0 where only the printer knows.
    length: f64,
    /// Feed of the way back, if it is known.
    back: Option<MmPerS>,
    /// Feed of the way out, if it is another.
    out: Option<MmPerS>,
    /// What is pushed out more, mm.
    surplus: f64,
    hop: f64,
    hop_feed: MmPerS,
    /// What is pulled back now, mm.
    pulled: f64,
    /// How far the nozzle is lifted now, mm.
    pub(super) lifted: f64,
}

/// What G10 or G11 moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pull {
    /// Filament pushed out, mm.
    pub(super) filament: f64,
    /// `None` is the feed of the moves before.
    pub(super) feed: Option<MmPerS>,
    /// How far the nozzle is lifted after it, mm, and how fast it gets there.
    pub(super) lifted: f64,
    pub(super) hop_feed: MmPerS,
}

impl Default for Retraction {
    fn default() -> Self {
        Self {
            length: 0.0,
            back: None,
            out: None,
            surplus: 0.0,
            hop: 0.0,
            hop_feed: HOP,
            pulled: 0.0,
            lifted: 0.0,
        }
    }
}

impl Retraction {
    /// As an Ultimaker 2 knows it.
    pub(super) fn own(&mut self, own: OwnFilament) {
        (self.length, self.back) = (own.retraction, Some(own.speed));
    }

    /// Whether it is known how far G10 pulls.
    pub(super) fn is_known(&self) -> bool {
        self.length > 0.0
    }

    /// G10 (`back`) or G11. A second one after the other moves nothing.
    pub(super) fn pull(&mut self, back: bool) -> Pull {
        let (pulled, lifted) = if back { (self.length, self.hop) } else { (0.0, 0.0) };
        let surplus = if !back && self.pulled > 0.0 { self.surplus } else { 0.0 };
        let filament = match (back, self.pulled > 0.0) {
            (true, true) => 0.0,
            (true, false) => -pulled,
            (false, _) => self.pulled + surplus,
        };
        if !(back && self.pulled > 0.0) {
            self.pulled = pulled;
        }
        let feed = if back { self.back } else { self.out.or(self.back) };
        Pull { filament, feed, lifted, hop_feed: self.hop_feed }
    }

    /// M207. `unit` is millimetres in a unit of the file. Returns what changes besides.
    pub(super) fn m207(&mut self, rule: M207, words: Words<'_>, unit: f64) -> Option<Change> {
        let mut jerk = [None; 4];
        for (letter, value) in words {
            let Some(value) = value.map(|value| value * unit) else { continue };
            match (rule, letter) {
                (M207::Nothing, _) => {}
                (M207::Jerk, b'X') => (jerk[0], jerk[1]) = (Some(value), Some(value)),
                (M207::Jerk, b'Z') => jerk[2] = Some(value),
                (M207::Jerk, b'E') => jerk[3] = Some(value),
                (M207::Jerk, _) => {}
                (_, b'S') => self.length = value.max(0.0),
                (_, b'Z') => self.hop = value.max(0.0),
                (_, b'F') => {
                    self.back = feed(value);
                    if rule == M207::Surplus {
                        self.out = None;
                    }
                }
                (M207::Surplus, b'T') => self.out = feed(value),
                (M207::Surplus, b'R') => self.surplus = value,
                (M207::HopsApart, b'Q') => self.hop_feed = feed(value).unwrap_or(HOP),
                _ => {}
            }
        }
        let jerks = rule == M207::Jerk && jerk.iter().any(Option::is_some);
        jerks.then(|| Change { jerk, ..Change::default() })
    }

    /// M208.
    pub(super) fn m208(&mut self, rule: M207, words: Words<'_>, unit: f64) {
        if !matches!(rule, M207::Hops | M207::HopsApart) {
            return;
        }
        for (letter, value) in words {
            let Some(value) = value.map(|value| value * unit) else { continue };
            match letter {
                b'S' => self.surplus = value,
                b'F' => self.out = feed(value),
                _ => {}
            }
        }
    }

    /// The words of Klipper's SET_RETRACTION, such as `RETRACT_LENGTH=0.8`; feeds are in mm/s.
    pub(super) fn klipper(&mut self, words: &[u8]) {
        for word in words.split(u8::is_ascii_whitespace) {
            let mut halves = word.splitn(2, |&byte| byte == b'=');
            let (Some(name), Some(value)) = (halves.next(), halves.next()) else { continue };
            let Some(value) = words::number(value).0.filter(|value| *value >= 0.0) else {
                continue;
            };
            let speed = || Some(MmPerS(value)).filter(|_| value > 0.0);
            match name.to_ascii_uppercase().as_slice() {
                b"RETRACT_LENGTH" => self.length = value,
                b"RETRACT_SPEED" => self.back = speed(),
                b"UNRETRACT_EXTRA_LENGTH" => self.surplus = value,
                b"UNRETRACT_SPEED" => self.out = speed(),
                _ => {}
            }
        }
    }
}

fn feed(per_minute: f64) -> Option<MmPerS> {
    (per_minute > 0.0).then(|| MmPerMin(per_minute).into())
}
