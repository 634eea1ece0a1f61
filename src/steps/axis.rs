//! Steps per mm -> Scale: millimetres to steps and back, exactly.
//!
//! Words used here and in the files beside this one:
//! - a *picometre* (pm) is 10⁻⁹ mm. What a file says in at most nine decimals is a whole number of them,
//!   so that sums of moves are exact however many there are;
//! - a *place* of an axis is where the true path is, in units of 2⁻³² step. It is worked out anew from
//!   the picometres for every end of a move, so that its rounding never adds up;
//! - the *nearest step* to a place is what the motor stands at: half a step is rounded up.

use serde::Serialize;

/// A value for each axis, as programs read it.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Axes<T> {
    x: T,
    y: T,
    z: T,
    e: T,
}

impl<T> From<[T; AXES]> for Axes<T> {
    fn from([x, y, z, e]: [T; AXES]) -> Self {
        Self { x, y, z, e }
    }
}

/// Axes of a machine: x, y, z and the filament.
pub const AXES: usize = 4;

/// Their letters.
pub const LETTERS: [char; AXES] = ['X', 'Y', 'Z', 'E'];

/// Picometres in a millimetre.
pub const PM: i64 = 1_000_000_000;

/// A whole step as a place.
pub const STEP: i64 = 1 << 32;

/// Steps that an axis may be away from its zero: differences of two places still fit 63 bits.
pub const MOST_STEPS: i64 = 1 << 29;

/// Steps for a mm, as a ratio of two whole numbers without a common factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Scale {
    /// Steps.
    pub steps: u64,
    /// In so many mm.
    pub mm: u64,
}

impl Scale {
    /// Of a number as people write it: its shortest decimals count. `None` for what is no number of
    /// steps, or has more digits than a double holds.
    #[must_use]
    pub fn new(steps_per_mm: f64) -> Option<Self> {
        if !(steps_per_mm > 0.0 && steps_per_mm.is_finite()) {
            return None;
        }
        let text = steps_per_mm.to_string();
        let (whole, part) = text.split_once('.').unwrap_or((&text, ""));
        let steps: u64 = format!("{whole}{part}").parse().ok()?;
        let mm = 10_u64.checked_pow(u32::try_from(part.len()).ok()?)?;
        Self::of(steps, mm)
    }

    /// Of a ratio; `None` if it is no positive number.
    #[must_use]
    pub fn of(steps: u64, mm: u64) -> Option<Self> {
        let common = common(steps, mm);
        (steps > 0 && mm > 0).then(|| Self { steps: steps / common, mm: mm / common })
    }

    /// The place of so many picometres, rounded to 2⁻³² step; `None` beyond [`MOST_STEPS`].
    #[must_use]
    pub fn place(&self, pm: i64) -> Option<i64> {
        let (number, unit) = (i128::from(pm) * i128::from(self.steps), self.unit());
        let (whole, rest) = (number.div_euclid(unit), number.rem_euclid(unit));
        let whole = i64::try_from(whole).ok().filter(|steps| steps.abs() < MOST_STEPS)?;
        // Below one step: it fits 32 bits, or is a whole step after rounding.
        let part = ((rest << 32) + unit / 2) / unit;
        Some((whole << 32) + i64::try_from(part).ok()?)
    }

    /// The place of so many mm, as a caller has them; `None` for what is no number or too far.
    #[must_use]
    pub fn place_of_mm(&self, mm: f64) -> Option<i64> {
        self.place(picometres(mm)?)
    }

    /// Millimetres of so many steps.
    #[must_use]
    pub fn mm(&self, steps: f64) -> f64 {
        steps * self.mm as f64 / self.steps as f64
    }

    /// Steps for a mm, as a number.
    #[must_use]
    pub fn per_mm(&self) -> f64 {
        self.steps as f64 / self.mm as f64
    }

    fn unit(&self) -> i128 {
        i128::from(self.mm) * i128::from(PM)
    }
}

/// Millimetres as picometres; `None` beyond 9 000 km, and for what is no number.
#[must_use]
pub fn picometres(mm: f64) -> Option<i64> {
    let pm = (mm * PM as f64).round();
    (pm.abs() < 9e18).then_some(pm as i64)
}

/// The nearest step to a place.
#[must_use]
pub fn nearest(place: i64) -> i64 {
    (place + STEP / 2) >> 32
}

/// Euclid's.
fn common(mut a: u64, mut b: u64) -> u64 {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a.max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_ratios() {
        let scale = |number: f64| Scale::new(number).map(|one| (one.steps, one.mm));
        assert_eq!(scale(80.0), Some((80, 1)));
        assert_eq!(scale(96.275202), Some((48_137_601, 500_000)));
        assert_eq!(scale(0.1), Some((1, 10)));
        let long = scale(1.0 / 0.1014).unwrap();
        assert!((long.0 as f64 / long.1 as f64 - 1.0 / 0.1014).abs() < 1e-14);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(scale(bad), None);
        }
    }

    #[test]
    fn places_are_exact_and_rounded_alike_on_both_sides_of_zero() {
        let scale = Scale::new(80.0).unwrap();
        assert_eq!(scale.place_of_mm(1.0), Some(80 * STEP));
        assert_eq!(scale.place_of_mm(-0.00625), Some(-STEP / 2));
        // A nanometre is 343 597.38 units.
        assert_eq!(scale.place_of_mm(1e-6), Some(343_597));
        assert_eq!(scale.place_of_mm(-1e-6), Some(-343_597));
        assert_eq!(scale.place(i64::MAX), None);
        assert_eq!([-1, 0, 1].map(|k| nearest(k * STEP / 2)), [0, 0, 1]);
    }
}
