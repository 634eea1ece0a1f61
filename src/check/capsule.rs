//! A line with round ends -> what it covers, row by row.

use crate::reader::print::Step;
use nalgebra::Vector2;

/// All places within `radius` of the stretch from `from` to `to`, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Capsule {
    pub(super) from: [f64; 2],
    pub(super) to: [f64; 2],
    pub(super) radius: f64,
}

impl Capsule {
    /// What a line covers, as wide as the part `share` of its width.
    pub(super) fn of(step: &Step, share: f64) -> Self {
        let flat = |at: [f32; 3]| [f64::from(at[0]), f64::from(at[1])];
        let radius = f64::from(step.width) * share / 2.0;
        Self { from: flat(step.from), to: flat(step.to), radius }
    }

    /// The same with x and y exchanged.
    pub(super) fn flipped(self) -> Self {
        let flip = |[x, y]: [f64; 2]| [y, x];
        Self { from: flip(self.from), to: flip(self.to), ..self }
    }

    /// Lowest and highest x and y.
    pub(super) fn extent(&self) -> ([f64; 2], [f64; 2]) {
        let (from, to) = (Vector2::from(self.from), Vector2::from(self.to));
        let (low, high) = from.inf_sup(&to);
        (low.add_scalar(-self.radius).into(), high.add_scalar(self.radius).into())
    }

    /// Its borders.
    pub(super) fn flanks(&self) -> Flanks {
        let (low, high) =
            if self.from[1] <= self.to[1] { (self.from, self.to) } else { (self.to, self.from) };
        let [run, rise] = [high[0] - low[0], high[1] - low[1]];
        let length = (run * run + rise * rise).sqrt();
        let (slope, shift, lift) = if rise > 0.0 {
            (run / rise, self.radius * length / rise, self.radius * run / length)
        } else {
            (0.0, 0.0, 0.0)
        };
        Flanks { low, high, square: self.radius * self.radius, slope, shift, lift }
    }
}

/// A capsule by its borders to the left and to the right: each is a straight line between the places
/// where it touches the circles around the ends, and an arc beyond.
pub(super) struct Flanks {
    /// The ends; `low` has the lesser y.
    low: [f64; 2],
    high: [f64; 2],
    /// The radius, squared.
    square: f64,
    /// Run per rise; 0 for a line along x.
    slope: f64,
    /// Distance along x from the middle line to the straight border.
    shift: f64,
    /// How much lower than the ends the straight part of the right border ends; the left: higher.
    lift: f64,
}

impl Flanks {
    /// What of the line at height `y` lies within: one stretch, since the shape has no dents.
    pub(super) fn chord(&self, y: f64) -> Option<(f64, f64)> {
        let circle = |end: [f64; 2]| {
            let away = y - end[1];
            (self.square - away * away).max(0.0).sqrt()
        };
        let (from, to) = if self.low[1] == self.high[1] {
            let half = circle(self.low);
            (self.low[0].min(self.high[0]) - half, self.low[0].max(self.high[0]) + half)
        } else {
            let flank = |lift: f64, side: f64| {
                if y < self.low[1] - lift {
                    self.low[0] + side * circle(self.low)
                } else if y > self.high[1] - lift {
                    self.high[0] + side * circle(self.high)
                } else {
                    self.low[0] + (y - self.low[1]) * self.slope + side * self.shift
                }
            };
            (flank(-self.lift, -1.0), flank(self.lift, 1.0))
        };
        (from < to).then_some((from, to))
    }
}
