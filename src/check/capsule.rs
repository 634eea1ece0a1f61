//! A line with round ends -> what it covers, row by row.

use crate::reader::print::Step;
use crate::units::Bounded as _;

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
        let ([x, y], [to_x, to_y]) = (self.from, self.to);
        (
            [x.at_most(to_x) - self.radius, y.at_most(to_y) - self.radius],
            [x.at_least(to_x) + self.radius, y.at_least(to_y) + self.radius],
        )
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
        let straight = if rise > 0.0 {
            [low[1] + lift.abs(), high[1] - lift.abs()]
        } else {
            [f64::INFINITY, f64::NEG_INFINITY]
        };
        Flanks { low, high, square: self.radius * self.radius, slope, shift, lift, straight }
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
    /// From where to where along y both borders are straight.
    straight: [f64; 2],
}

impl Flanks {
    /// What of the line at height `y` lies within: one stretch, since the shape has no dents.
    ///
    /// Where both borders are straight that is all that is asked for: most rows of a long line. Those of short
    /// lines change from one border to another so often that taking one of three numbers is quicker than taking
    /// one of three ways.
    #[inline]
    pub(super) fn chord(&self, y: f64) -> Option<(f64, f64)> {
        let ([low_x, low_y], [high_x, high_y]) = (self.low, self.high);
        let middle = low_x + (y - low_y) * self.slope;
        let (from, to) = if self.straight[0] <= y && y <= self.straight[1] {
            (middle - self.shift, middle + self.shift)
        } else {
            let circle = |end_y: f64| {
                let away = y - end_y;
                (self.square - away * away).at_least(0.0).sqrt()
            };
            let (low, high) = (circle(low_y), circle(high_y));
            if low_y == high_y {
                (low_x.at_most(high_x) - low, low_x.at_least(high_x) + low)
            } else {
                let flank = |lift: f64, side: f64| {
                    let straight = middle + side * self.shift;
                    let upper = if y > high_y - lift { high_x + side * high } else { straight };
                    if y < low_y - lift { low_x + side * low } else { upper }
                };
                (flank(-self.lift, -1.0), flank(self.lift, 1.0))
            }
        };
        (from < to).then_some((from, to))
    }
}
