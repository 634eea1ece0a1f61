//! Millimetres -> grid units: the integer grid of every stage after placement, and its rounding.
//!
//! Lengths are millimetres (`f64`) in settings and reports, and grid units
//! ([`Coord`]) in geometry. One unit is a tenth of a micrometre: far below what a printer can
//! resolve, and a bed of one metre is only 10⁷ units. A product of two differences, even a sum of
//! four of them, then stays below 2⁵⁰. So no `i64` expression on coordinates can overflow.

/// A coordinate or length in grid units; see [`UNITS_PER_MM`].
pub type Coord = i32;

/// Grid units in a millimetre.
pub const UNITS_PER_MM: f64 = 10_000.0;

/// The largest coordinate, in mm from the origin, that geometry accepts.
pub const MAX_COORDINATE_MM: f64 = 10_000.0;

/// Millimetres to the nearest grid unit (halves away from zero).
#[must_use]
pub fn to_units(mm: f64) -> Coord {
    nearest(mm * UNITS_PER_MM) as Coord
}

/// Grid units to millimetres.
#[must_use]
pub fn to_mm(units: Coord) -> f64 {
    f64::from(units) / UNITS_PER_MM
}

/// The whole number nearest to `value`, halves away from zero.
///
/// Adding a half and truncating is many times faster than [`f64::round`], which is a call on
/// processors without SSE 4.1. The results differ only for the largest number below a half.
#[must_use]
#[inline]
pub fn nearest(value: f64) -> i64 {
    (value + 0.5_f64.copysign(value)) as i64
}

/// A coordinate as G-code has it: a thousandth of a mm. Not a grid unit, of which it has ten.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Thousandths(pub i32);

/// A speed in mm/s, as all speeds are that stages hand to each other.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub struct MmPerS(pub f64);

/// A speed in mm/min, as the F word of G-code has it.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub struct MmPerMin(pub f64);

impl From<MmPerMin> for MmPerS {
    fn from(speed: MmPerMin) -> Self {
        Self(speed.0 / 60.0)
    }
}

impl From<MmPerS> for MmPerMin {
    fn from(speed: MmPerS) -> Self {
        Self(speed.0 * 60.0)
    }
}

/// Minimum and maximum for numbers that are never NaN: one instruction each. [`f64::min`] and
/// [`f64::max`] take five, since they handle NaN.
pub trait Bounded {
    /// This number, or `most` if that is smaller.
    #[must_use]
    fn at_most(self, most: Self) -> Self;
    /// This number, or `least` if that is larger.
    #[must_use]
    fn at_least(self, least: Self) -> Self;
}

impl Bounded for f64 {
    #[inline]
    fn at_most(self, most: Self) -> Self {
        if most < self { most } else { self }
    }

    #[inline]
    fn at_least(self, least: Self) -> Self {
        if least > self { least } else { self }
    }
}

/// Interpolates linearly from `low` at `low_v` to `high` at `high_v`, for `low_v <= v <= high_v`.
/// Rounds to the nearest unit, halves upwards.
#[must_use]
#[inline]
pub fn between(low: Coord, high: Coord, (v, low_v, high_v): (Coord, Coord, Coord)) -> Coord {
    let run = i64::from(high) - i64::from(low);
    let rise = i64::from(high_v) - i64::from(low_v);
    let up = i64::from(v) - i64::from(low_v);
    low + (2 * run * up + rise).div_euclid(2 * rise) as Coord
}

/// Sine and cosine of an angle in degrees. Exact for quarter turns; others come from `libm`, since
/// the system's functions differ between platforms.
#[must_use]
pub fn sin_cos(degrees: f64) -> (f64, f64) {
    let turn = degrees.rem_euclid(360.0);
    let quarter = (turn / 90.0).floor();
    let (sin, cos) = libm::sincos((turn - quarter * 90.0).to_radians());
    match quarter as i32 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Converts a sum of lengths in grid units to millimetres.
#[must_use]
pub fn sum_mm(units: i64) -> f64 {
    units as f64 / UNITS_PER_MM
}
