//! Lines of a run -> turns of a spiral: where one round ends and the next begins.
//!
//! A spiral (vase mode) has no level line and no comment that marks a layer: every line rises a little,
//! and the way goes round and round. The direction of a way round a simple outline turns by 360 degrees
//! for each round, whatever the outline; a skin that follows a surface turns forth and back. A run is
//! taken for a spiral after one round and a half: a seam may begin with a ramp of one round.

use std::f64::consts::{PI, TAU};

/// Rounds after which a run is taken for a spiral.
const LEAST_ROUNDS: f64 = 1.5;

/// No round rises more than this, mm: the highest line of the widest nozzles.
const HIGHEST: f64 = 2.0;

/// Directions are rounded to this, radians: a round may end this early.
const ROUNDING: f64 = 1e-6;

/// The rounds of a run so far.
#[derive(Debug, Default)]
pub(super) struct Spiral {
    /// Where the run began, mm.
    low: f64,
    /// Direction of the last line, radians.
    heading: Option<f64>,
    /// How far the direction has turned, radians, to the left.
    turned: f64,
    /// Rounds that have begun.
    rounds: u32,
    /// Whether a line did not rise.
    is_broken: bool,
}

impl Spiral {
    /// Takes the next line; whether a round begins with it, the first one left out.
    pub(super) fn line(&mut self, [from, to]: [[f64; 3]; 2]) -> bool {
        self.is_broken |= to[2] <= from[2];
        if self.is_broken {
            return false;
        }
        let heading = (to[1] - from[1]).atan2(to[0] - from[0]);
        let Some(before) = self.heading.replace(heading) else {
            (self.low, self.rounds) = (from[2], 1);
            return false;
        };
        let change = heading - before;
        self.turned += if change > PI {
            change - TAU
        } else if change < -PI {
            change + TAU
        } else {
            change
        };
        let round = f64::from(self.rounds);
        if self.turned.abs() + ROUNDING < TAU * round {
            return false;
        }
        self.is_broken |= from[2] - self.low > HIGHEST * round;
        self.rounds += 1;
        !self.is_broken
    }

    /// Whether all lines so far are those of a spiral, and enough of them.
    pub(super) fn is_one(&self) -> bool {
        !self.is_broken && self.turned.abs() > TAU * LEAST_ROUNDS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines through points, each 0.01 mm higher than the one before.
    fn rounds(points: &[[f64; 2]]) -> (Vec<usize>, bool) {
        let mut spiral = Spiral::default();
        let height = |k: usize| 0.2 + 0.01 * k as f64;
        let lines = points.windows(2).enumerate().filter_map(|(k, ends)| {
            let at = |end: usize| [ends[end][0], ends[end][1], height(k + end)];
            spiral.line([at(0), at(1)]).then_some(k)
        });
        (lines.collect(), spiral.is_one())
    }

    #[test]
    fn a_round_turns_once_whatever_the_outline_and_a_zigzag_never() {
        let square = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]];
        let notched = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [5.0, 9.0], [4.0, 2.0], [0.0, 9.0]];
        let thrice = |outline: &[[f64; 2]]| [outline, outline, outline].concat();
        assert_eq!(rounds(&thrice(&square)), (vec![4, 8], true));
        assert_eq!(rounds(&thrice(&notched)), (vec![6, 12], true));
        let mut clockwise = thrice(&square);
        clockwise.reverse();
        assert_eq!(rounds(&clockwise), (vec![4, 8], true));
        let zigzag: Vec<_> = (0..90).map(|k| [9.0 * f64::from(k / 2 % 2), f64::from(k)]).collect();
        assert_eq!(rounds(&zigzag), (vec![], false));
    }
}
