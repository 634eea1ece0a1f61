//! Units and the integer grid that every stage after placement works on.
//!
//! Lengths are millimetres (`f64`) in settings and reports, and grid units
//! ([`Coord`]) in geometry. One unit is a tenth of a micrometre, so that a
//! bed of one metre is 10⁷ units and a product of two differences, even when
//! summed four times, stays below 2⁵⁰: no `i64` expression on coordinates can
//! overflow.

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
/// Adding a half and cutting off is many times faster than [`f64::round`], which
/// is a call on processors without SSE 4.1; it differs only for the last number
/// below a half.
#[must_use]
#[inline]
pub fn nearest(value: f64) -> i64 {
    (value + 0.5_f64.copysign(value)) as i64
}
