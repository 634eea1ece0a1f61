//! M201, M203 to M205, M566 and Klipper's SET_VELOCITY_LIMIT -> Change: other limits from here on.

use super::words::{self, Words};

/// New limits of the machine; `None` leaves one as it is. Arrays are x, y, z, e.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Change {
    /// Highest speeds, mm/s.
    pub feed: [Option<f64>; 4],
    /// Highest accelerations, mm/s².
    pub acceleration: [Option<f64>; 4],
    /// Acceleration of moves that extrude, mm/s².
    pub print: Option<f64>,
    /// Acceleration of moves that do not, mm/s².
    pub travel: Option<f64>,
    /// Acceleration of the filament alone, mm/s².
    pub retract: Option<f64>,
    /// Jerk, mm/s.
    pub jerk: [Option<f64>; 4],
    /// Junction deviation, mm.
    pub deviation: Option<f64>,
    /// Klipper: speed through a corner of 90°, mm/s.
    pub square_corner_velocity: Option<f64>,
    /// Klipper: part of a move that is left for cruising.
    pub minimum_cruise_ratio: Option<f64>,
    /// Klipper before 2024: acceleration for short sprints, mm/s².
    pub accel_to_decel: Option<f64>,
}

impl Change {
    /// Reads the words of M201, M203, M204, M205 or M566; `None` for any other number.
    pub(super) fn of_code(number: u32, words: Words<'_>) -> Option<Self> {
        let mut change = Self::default();
        // The old form of M204: S is for all moves, T for the filament alone.
        let mut old = None;
        let mut tool = None;
        for (letter, value) in words {
            let Some(value) = value else { continue };
            let axis = b"XYZE".iter().position(|&axis| axis == letter);
            match (number, letter, axis) {
                (201, _, Some(axis)) => change.acceleration[axis] = Some(value),
                (203, _, Some(axis)) => change.feed[axis] = Some(value),
                (205, _, Some(axis)) => change.jerk[axis] = Some(value),
                // RepRapFirmware's jerk is in mm/min.
                (566, _, Some(axis)) => change.jerk[axis] = Some(value / 60.0),
                (205, b'J', _) => change.deviation = Some(value),
                (204, b'P', _) => change.print = Some(value),
                (204, b'R', _) => change.retract = Some(value),
                (204, b'S', _) => old = Some(value),
                (204, b'T', _) => tool = Some(value),
                (201 | 203 | 204 | 205 | 566, ..) => {}
                _ => return None,
            }
        }
        if old.is_some() {
            (change.print, change.travel) = (old, old);
            change.retract = tool.or(change.retract);
        } else {
            change.travel = tool;
        }
        matches!(number, 201 | 203 | 204 | 205 | 566).then_some(change)
    }

    /// Reads the words of SET_VELOCITY_LIMIT, such as `ACCEL=3000`.
    pub(super) fn of_klipper(words: &[u8]) -> Self {
        let mut change = Self::default();
        for word in words.split(u8::is_ascii_whitespace) {
            let mut halves = word.splitn(2, |&byte| byte == b'=');
            let (Some(name), Some(value)) = (halves.next(), halves.next()) else { continue };
            let value = words::number(value).0.filter(|value| *value >= 0.0);
            match name.to_ascii_uppercase().as_slice() {
                b"ACCEL" => (change.print, change.travel) = (value, value),
                b"VELOCITY" => (change.feed[0], change.feed[1]) = (value, value),
                b"SQUARE_CORNER_VELOCITY" => change.square_corner_velocity = value,
                b"MINIMUM_CRUISE_RATIO" => change.minimum_cruise_ratio = value,
                b"ACCEL_TO_DECEL" => change.accel_to_decel = value,
                _ => {}
            }
        }
        change
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(line: &str) -> Change {
        let (code, words) = words::command(line.as_bytes()).unwrap();
        Change::of_code(code.number, words).unwrap()
    }

    #[test]
    fn old_and_new_forms() {
        let new = of("M204 P1250 R1500 T2000");
        assert_eq!(
            (new.print, new.retract, new.travel),
            (Some(1250.0), Some(1500.0), Some(2000.0))
        );
        let old = of("M204 S500 T1500");
        assert_eq!((old.print, old.retract, old.travel), (Some(500.0), Some(1500.0), Some(500.0)));
        assert_eq!(of("M201 X9000 E10000").acceleration[3], Some(10_000.0));
        assert_eq!(of("M566 X600 Y300 P1").jerk, [Some(10.0), Some(5.0), None, None]);
        assert_eq!(of("M203 Z12").feed, [None, None, Some(12.0), None]);
        assert_eq!(of("M205 X8 J0.02").deviation, Some(0.02));
        let klipper = Change::of_klipper(b" accel=3000  SQUARE_CORNER_VELOCITY=8 X=");
        assert_eq!((klipper.print, klipper.square_corner_velocity), (Some(3000.0), Some(8.0)));
    }
}
