//! Corners on the grid -> differences and products: exact vectors of integers.
//!
//! Signs of these products decide what crosses and what lies inside, so they must be exact; a
//! vector of `f64` is a nalgebra one.

/// A corner on the integer grid.
pub(crate) type Corner = [i32; 3];

/// `a` − `b`; exact.
pub(crate) fn minus<T: Copy + Into<i64>>(a: [T; 3], b: [T; 3]) -> [i64; 3] {
    let side = |axis: usize| a[axis].into() - b[axis].into();
    [side(0), side(1), side(2)]
}

/// The cross product of two differences of corners; exact below 2³¹ units a side.
pub(crate) fn cross(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The scalar product. Exact for a cross product and a difference: on a grid of 2²⁸ it is below
/// 2⁸⁷.
pub(crate) fn dot(a: [i64; 3], b: [i64; 3]) -> i128 {
    (0..3).map(|axis| i128::from(a[axis]) * i128::from(b[axis])).sum()
}

/// The square of the distance between two corners, grid units²; exact.
pub(crate) fn distance2(a: Corner, b: Corner) -> i64 {
    let by = minus(a, b);
    by[0] * by[0] + by[1] * by[1] + by[2] * by[2]
}

/// Normal of a triangle, as long as twice its area, grid units².
pub(crate) fn normal<T: Copy + Into<i64>>([a, b, c]: [[T; 3]; 3]) -> [i64; 3] {
    cross(minus(b, a), minus(c, a))
}

/// Length of a vector.
pub(crate) fn length(v: [i64; 3]) -> f64 {
    v.iter().map(|&side| side as f64 * side as f64).sum::<f64>().sqrt()
}
