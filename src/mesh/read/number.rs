//! Number -> verdict: which numbers of a file can be coordinates.

/// Largest number accepted as a coordinate, in the file's unit. What is above
/// is a damaged file, not a model.
pub const MAX_NUMBER: f32 = 1e9;

/// Whether a number can be a coordinate; false for NaN too.
pub(crate) fn usable(number: f32) -> bool {
    number.abs() <= MAX_NUMBER
}

/// Says why a number is not [`usable`].
pub(crate) fn complaint(number: f32) -> String {
    if number.is_finite() {
        format!("the coordinate {number:e} is absurdly large")
    } else {
        format!("a coordinate is {number}, which is no finite number")
    }
}
