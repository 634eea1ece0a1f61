//! Plan of a move -> Ramp: when each part of its way is reached.
//!
//! A move speeds up evenly, goes on at one speed and slows down evenly, as the planner of
//! [`motion`](crate::motion) has it. On a ramp from speed v at acceleration a the way s takes
//! `(√(v² + 2as) − v) / a`; slowing down is speeding up seen from the end.
//! Only sums, products, quotients and square roots are used: the same on every platform.

use crate::motion::Timed;

/// When a move is where. Times in µs, ways in mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ramp {
    way: f64,
    /// Where speeding up ends, and where slowing down begins.
    up: f64,
    down: f64,
    /// Speeds at both ends, mm/s, and their squares.
    ends: [f64; 2],
    squares: [f64; 2],
    /// Twice the acceleration, mm/s².
    twice: f64,
    /// When speeding up ends.
    up_time: f64,
    time: f64,
    /// µs for a mm between the ramps.
    cruising: f64,
    /// µs for a mm/s more or less.
    per_speed: f64,
}

impl Ramp {
    /// Of a move of so many mm, as the planner has timed it.
    pub(super) fn new<T>(way: f64, timed: &Timed<T>) -> Self {
        let Timed { entry, exit, peak, acceleration, .. } = *timed;
        let length = |slow: f64| ((peak * peak - slow * slow) / (2.0 * acceleration)).max(0.0);
        let up = length(entry).min(way);
        let down = (way - length(exit)).max(up);
        let per_speed = 1e6 / acceleration;
        Self {
            way,
            up,
            down,
            ends: [entry, exit],
            squares: [entry * entry, exit * exit],
            twice: 2.0 * acceleration,
            up_time: (peak - entry).max(0.0) * per_speed,
            time: timed.seconds * 1e6,
            cruising: 1e6 / peak,
            per_speed,
        }
    }

    /// At one speed from beginning to end, mm/s.
    #[must_use]
    pub(super) fn even(way: f64, speed: f64) -> Self {
        let cruising = 1e6 / speed;
        Self {
            way,
            up: 0.0,
            down: way,
            ends: [0.0; 2],
            squares: [0.0; 2],
            twice: 0.0,
            up_time: 0.0,
            time: way * cruising,
            cruising,
            per_speed: 0.0,
        }
    }

    /// How long the move takes, µs.
    #[must_use]
    pub(super) fn time(&self) -> f64 {
        self.time
    }

    /// When so many mm of the way are behind, µs.
    #[inline]
    #[must_use]
    pub(super) fn at(&self, way: f64) -> f64 {
        if way < self.up {
            let speed = (self.squares[0] + self.twice * way).sqrt();
            (speed - self.ends[0]) * self.per_speed
        } else if way <= self.down {
            self.up_time + (way - self.up) * self.cruising
        } else {
            let left = (self.way - way).max(0.0);
            let speed = (self.squares[1] + self.twice * left).sqrt();
            self.time - (speed - self.ends[1]) * self.per_speed
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Clock, Junction, Limits, Move};
    use crate::units::MmPerS;

    fn limits() -> Limits {
        Limits {
            feed: [300.0; 4],
            acceleration: [1000.0; 4],
            print_acceleration: 1000.0,
            travel_acceleration: 1000.0,
            retract_acceleration: 1000.0,
            junction: Junction::Jerk([8.0; 4]),
            look_ahead: Some(16),
            minimum_speed: 0.05,
        }
    }

    #[test]
    fn speeds_change_by_the_acceleration_and_the_end_is_the_planners_time() {
        let mut clock = Clock::new(limits());
        let ways = [10.0, 0.1, 30.0, 2.0];
        for way in ways {
            clock.push(Move { delta: [way, 0.5 * way, 0.0, 0.0], feed: MmPerS(90.0), tag: way });
            clock.push(Move { delta: [0.0, way, 0.0, 0.0], feed: MmPerS(40.0), tag: way });
        }
        clock.finish();
        let mut moves = 0;
        for timed in clock.drain() {
            moves += 1;
            let bend = if moves % 2 == 1 { 1.25_f64.sqrt() } else { 1.0 };
            let way = timed.tag * bend;
            let ramp = Ramp::new(way, &timed);
            assert!(ramp.at(0.0).abs() < 1e-6);
            assert!((ramp.at(way) - ramp.time()).abs() < 1e-6 * ramp.time().max(1.0));
            let speeds: Vec<f64> = (0..1000)
                .map(|k| {
                    let [a, b] = [k, k + 1].map(|k| ramp.at(way * f64::from(k) / 1000.0));
                    assert!(b > a);
                    way / 1000.0 / (b - a) * 1e6
                })
                .collect();
            let top = speeds.iter().copied().fold(0.0, f64::max);
            assert!((top - timed.peak).abs() < 0.02 * timed.peak, "{top} of {}", timed.peak);
            assert!((speeds[0] - timed.entry).abs() < 0.05 * timed.peak);
        }
        assert_eq!(moves, 2 * ways.len());
    }

    #[test]
    fn without_ramps_all_parts_take_alike() {
        let ramp = Ramp::even(10.0, 20.0);
        assert_eq!([0.0, 5.0, 10.0].map(|way| ramp.at(way)), [0.0, 250_000.0, 500_000.0]);
        assert_eq!(ramp.time(), 500_000.0);
    }
}
