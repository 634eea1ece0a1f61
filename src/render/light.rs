//! Triangle -> tone: how bright a flat face is under two lamps and a sky.
//!
//! Plain arrays, since this runs for every triangle that has a sample.

use super::view::TO_EYE;

/// Towards the main lamp, times 11: at the front left above. Tops are brightest, then fronts, then
/// right sides. Chosen so that the three visible faces of a box differ clearly, which a test holds.
const LAMP: ([f64; 3], f64) = ([-2.0, -6.0, 9.0], 11.0);
/// Towards the fill lamp, times 7: at the right, for faces that the main lamp leaves dark.
const FILL: ([f64; 3], f64) = ([6.0, -2.0, 3.0], 7.0);

/// Brightness from the sky, and from each lamp on a face that looks straight at it. Chosen by eye:
/// together just above 1, so that only faces towards the main lamp reach full brightness.
const AMBIENT: f64 = 0.2;
const OF_LAMP: f64 = 0.68;
const OF_FILL: f64 = 0.2;

/// Brightness of a face, 0 to 255, by Lambert's law; `None` if it has no area. The side that looks
/// at the eye is lit, whichever way the face is wound.
pub(super) fn tone([a, b, c]: [[i32; 3]; 3]) -> Option<u8> {
    let u = |axis: usize| i64::from(b[axis]) - i64::from(a[axis]);
    let v = |axis: usize| i64::from(c[axis]) - i64::from(a[axis]);
    let across = |one: usize, other: usize| (u(one) * v(other) - u(other) * v(one)) as f64;
    let normal = [across(1, 2), across(2, 0), across(0, 1)];
    let length = dot(normal, normal).sqrt();
    if length == 0.0 {
        return None;
    }
    let [x, y, z] = TO_EYE;
    let towards = dot(normal, [x as f64, y as f64, z as f64]);
    let towards = length.copysign(towards);
    let of = |(lamp, scale): ([f64; 3], f64)| (dot(normal, lamp) / (scale * towards)).max(0.0);
    let sum = AMBIENT + OF_LAMP * of(LAMP) + OF_FILL * of(FILL);
    Some((sum.min(1.0) * 255.0 + 0.5) as u8)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
