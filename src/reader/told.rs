//! Events -> the limits that a file tells the machine, each value once, and its long waits.
//!
//! A file may set an acceleration at every change of role: what is kept is each value of each limit with the
//! first line that sets it. That is enough to say which values are new in the print, and which one file has and
//! another has not; and it is bounded.

use super::Change;

/// Values that are kept: files have a few for each limit.
const MOST_LIMITS: usize = 256;

/// Waits that are kept, and the shortest, s: shorter ones let something settle or cool, and the clock counts them.
const MOST_WAITS: usize = 1000;
const LONG: f64 = 20.0;

/// What a limit is of; axes are x, y, z and the filament.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Limit {
    /// The highest speed of an axis, mm/s.
    Speed(usize),
    /// The highest acceleration of an axis, mm/s².
    Acceleration(usize),
    /// Acceleration of moves that extrude, or of all, mm/s².
    Lines,
    /// Acceleration of moves that do not, mm/s².
    Travels,
    /// Acceleration of the filament alone, mm/s².
    Filament,
    /// Sudden change of speed of an axis, mm/s.
    Jerk(usize),
    /// Junction deviation, mm.
    Deviation,
    /// Klipper's speed through a corner of 90°, mm/s.
    Corner,
    /// Klipper's part of a move that is left for cruising.
    Cruise,
    /// Klipper's acceleration for short sprints, mm/s².
    Sprints,
}

/// A value of a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Told {
    /// Of what.
    pub limit: Limit,
    /// In the limit's unit.
    pub value: f64,
    /// The first line of the file that sets it, from 1.
    pub line: u64,
    /// How many moves come before.
    pub at: usize,
}

/// G4 that waits for long.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LongWait {
    /// How long, s.
    pub seconds: f64,
    /// Line of the file, from 1.
    pub line: u64,
    /// How many moves come before.
    pub at: usize,
}

impl Limit {
    /// What it is, for people.
    #[must_use]
    pub fn name(self) -> String {
        let of = |axis: usize| ["x", "y", "z", "the filament"].get(axis).copied().unwrap_or("?");
        match self {
            Self::Speed(axis) => format!("highest speed of {}", of(axis)),
            Self::Acceleration(axis) => format!("highest acceleration of {}", of(axis)),
            Self::Lines => "acceleration".to_owned(),
            Self::Travels => "acceleration of travels".to_owned(),
            Self::Filament => "acceleration of the filament alone".to_owned(),
            Self::Jerk(axis) => format!("jerk of {}", of(axis)),
            Self::Deviation => "junction deviation".to_owned(),
            Self::Corner => "square corner velocity".to_owned(),
            Self::Cruise => "minimum cruise ratio".to_owned(),
            Self::Sprints => "acceleration to deceleration".to_owned(),
        }
    }

    /// Its unit; empty for a ratio.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Speed(_) | Self::Jerk(_) | Self::Corner => "mm/s",
            Self::Deviation => "mm",
            Self::Cruise => "",
            Self::Acceleration(_) | Self::Lines | Self::Travels => "mm/s²",
            Self::Filament | Self::Sprints => "mm/s²",
        }
    }
}

/// What a change sets.
fn all(change: &Change) -> impl Iterator<Item = (Limit, f64)> {
    let axes = |limit: fn(usize) -> Limit, values: [Option<f64>; 4]| {
        values.into_iter().enumerate().map(move |(axis, value)| (limit(axis), value))
    };
    let others = [
        (Limit::Lines, change.print),
        (Limit::Travels, change.travel),
        (Limit::Filament, change.retract),
        (Limit::Deviation, change.deviation),
        (Limit::Corner, change.square_corner_velocity),
        (Limit::Cruise, change.minimum_cruise_ratio),
        (Limit::Sprints, change.accel_to_decel),
    ];
    axes(Limit::Speed, change.feed)
        .chain(axes(Limit::Acceleration, change.acceleration))
        .chain(others)
        .chain(axes(Limit::Jerk, change.jerk))
        .filter_map(|(limit, value)| Some((limit, value?)))
}

/// Adds what a change sets, but for what is known.
pub(super) fn add(known: &mut Vec<Told>, change: &Change, (line, at): (u64, usize)) {
    for (limit, value) in all(change) {
        let is_same = |told: &Told| told.limit == limit && told.value == value;
        if known.len() < MOST_LIMITS && !known.iter().any(is_same) {
            known.push(Told { limit, value, line, at });
        }
    }
}

/// Adds a wait, if it is long.
pub(super) fn wait(known: &mut Vec<LongWait>, seconds: f64, (line, at): (u64, usize)) {
    if seconds >= LONG && known.len() < MOST_WAITS {
        known.push(LongWait { seconds, line, at });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reader::Print;

    #[test]
    fn each_value_is_kept_once_with_its_first_line() {
        let text = "M204 P500 T900\nG1 X1 E1\nM204 P500\nM204 P700\nM203 X9\nG4 S3600\nG4 P500\n\
                    SET_VELOCITY_LIMIT ACCEL=500 SQUARE_CORNER_VELOCITY=3\nM204 P700";
        let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
        let found: Vec<_> =
            print.limits.iter().map(|told| (told.limit, told.value, told.line, told.at)).collect();
        let expected = [
            (Limit::Lines, 500.0, 1, 0),
            (Limit::Travels, 900.0, 1, 0),
            (Limit::Lines, 700.0, 4, 1),
            (Limit::Speed(0), 9.0, 5, 1),
            (Limit::Travels, 500.0, 8, 1),
            (Limit::Corner, 3.0, 8, 1),
        ];
        assert_eq!(found, expected);
        assert_eq!(print.waits, [LongWait { seconds: 3600.0, line: 6, at: 1 }]);
        // What a file has without end is bounded.
        let text: String = (0..100_000).map(|k| format!("M204 S{k}\nG4 S99\n")).collect();
        let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
        assert_eq!((print.limits.len(), print.waits.len()), (MOST_LIMITS, MOST_WAITS));
    }
}
