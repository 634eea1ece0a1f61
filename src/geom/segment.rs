//! Point and segment -> how far along the segment the nearest place lies, and how far away it is.
//!
//! For the plane and for space, on floats; whole grid units below 2⁵³ are exact as floats. All stages
//! call these most of all: plain loops are short code in any build, calls of closures only in some.

/// The product of two vectors' lengths and the cosine between them.
#[must_use]
#[inline]
pub fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    let mut sum = a[0] * b[0];
    for axis in 1..N {
        sum += a[axis] * b[axis];
    }
    sum
}

/// From `a` to `b`.
#[must_use]
#[inline]
pub fn way<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    let mut way = b;
    for axis in 0..N {
        way[axis] -= a[axis];
    }
    way
}

/// `a` + `t` · `way`.
#[must_use]
#[inline]
pub fn along<const N: usize>(a: [f64; N], t: f64, way: [f64; N]) -> [f64; N] {
    let mut place = a;
    for axis in 0..N {
        place[axis] += t * way[axis];
    }
    place
}

/// The part of the segment from the origin to `way` after which it is nearest to `point`: from 0
/// to 1, and 0 for a segment of no length.
#[must_use]
#[inline]
pub fn nearest_part<const N: usize>(point: [f64; N], way: [f64; N]) -> f64 {
    let square = dot(way, way);
    if square > 0.0 { (dot(point, way) / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// The squared distance from `point` to the segment from `a` to `b`.
#[must_use]
#[inline]
pub fn distance2<const N: usize>(point: [f64; N], [a, b]: [[f64; N]; 2]) -> f64 {
    let (arm, segment) = (way(a, point), way(a, b));
    let off = along(arm, -nearest_part(arm, segment), segment);
    dot(off, off)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_place_lies_beside_or_at_an_end() {
        let segment = [[1.0, 1.0], [5.0, 1.0]];
        for (point, square) in
            [([3.0, 4.0], 9.0), ([-2.0, 5.0], 25.0), ([8.0, 5.0], 25.0), ([4.0, 1.0], 0.0)]
        {
            assert_eq!(distance2(point, segment), square, "{point:?}");
        }
        assert_eq!(distance2([1.0, 2.0, 2.0], [[0.0; 3]; 2]), 9.0);
        assert_eq!(nearest_part([1.0, 7.0], [4.0, 0.0]), 0.25);
    }
}
