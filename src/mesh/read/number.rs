//! Number -> verdict: which numbers of a file can be coordinates.

/// The largest coordinate that is accepted, in the file's unit.
///
/// A kilometre in micrometres is 10⁹; what is larger comes from a damaged file. Without the
/// limit, squares of such numbers would overflow `f32`.
pub const MAX_NUMBER: f32 = 1e9;

/// Whether a number can be a coordinate; false for NaN too.
pub(super) fn usable(number: f32) -> bool {
    number.abs() <= MAX_NUMBER
}
