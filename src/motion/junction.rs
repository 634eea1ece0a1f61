//! Two successive moves -> the highest speed between them, by each firmware's rule.

use super::block::Course;
use crate::units::Bounded as _;

/// Cosine beyond which two moves turn back, within rounding: Marlin's own threshold.
const STRAIGHT: f64 = 0.999_999;

/// Marlin: a corner is coasted through only if that is faster than this share of stopping there.
const WORTH_COASTING: f64 = 0.99;

/// Marlin: moves shorter than this count as pieces of an arc, mm.
const SHORT: f64 = 1.0;

/// Marlin: cosine of 135°; two short moves at a wider angle count as pieces of an arc.
const ARC: f64 = -std::f64::consts::FRAC_1_SQRT_2;

/// Marlin's classic jerk, mm/s: the speed at which no axis changes its own by more than
/// its jerk. `inverse` is 1 / jerk.
pub(super) fn jerk(before: &Course, after: &Course, inverse: &[f64; 4]) -> f64 {
    let shared = before.cruise.at_most(after.cruise);
    let mut worst = 1.0_f64;
    for (axis, inverse) in inverse.iter().enumerate() {
        // As the firmware has it: only the move before is slowed down to what both can do.
        let leaving = before.direction[axis] * shared;
        let entering = after.direction[axis] * after.cruise;
        let apart = (leaving - entering).abs();
        // Turning back, or one of them stands still: it may come in and leave at its jerk.
        let turning = leaving.abs().at_least(entering.abs());
        let change = if leaving * entering > 0.0 { apart } else { turning };
        worst = worst.at_least(change * inverse);
    }
    let speed = shared / worst;
    let threshold = speed * WORTH_COASTING;
    if before.rest > threshold && after.rest > threshold {
        // No gain in coasting through: stop and start again.
        return after.rest.at_most(before.cruise);
    }
    speed
}

/// Jerk as a vector, mm/s: the highest speed that both moves can have at which the change in
/// x and y together, and in z, is within the jerk. `inverse` is 1 / jerk.
pub(super) fn vector_jerk(before: &Course, after: &Course, inverse: &[f64; 4]) -> f64 {
    let shared = before.cruise.at_most(after.cruise);
    // In jerks, per mm/s of the shared speed.
    let [x, y, z, e]: [f64; 4] = std::array::from_fn(|axis| {
        (after.direction[axis] - before.direction[axis]) * inverse[axis]
    });
    let mut change = (x * x + y * y).sqrt().at_least(z.abs());
    if !(before.moves_nozzle && after.moves_nozzle) {
        change = change.at_least(e.abs());
    }
    shared / (shared * change).at_least(1.0)
}

/// Sailfish's "maximum speed change": the share of its speed at which the move after begins,
/// so that no axis changes its own by more than this from what the move before began with.
/// It is 0 if an axis turns back or halts.
pub(super) fn speed_change(before: &Course, after: &Course, most: &[f64; 4]) -> f64 {
    let smallest = most.iter().copied().fold(f64::INFINITY, f64::min);
    if after.cruise <= smallest {
        return 1.0;
    }
    let mut share = 1.0_f64;
    for (axis, most) in most.iter().enumerate() {
        let was = before.direction[axis] * before.cruise * before.slowed;
        let will = after.direction[axis] * after.cruise;
        if (will - was).abs() > *most {
            if will == 0.0 {
                return 0.0;
            }
            let bound = if will > was { was + most } else { was - most };
            share = share.at_most(bound / will);
        }
    }
    share.at_least(0.0)
}

/// Marlin's junction deviation, squared speed: the corner as an arc that passes the
/// corner at this distance, at no more than the acceleration towards its middle.
pub(super) fn deviation(before: &Course, after: &Course, acceleration: &[f64; 4]) -> f64 {
    let (from, to) = (unit(&before.direction), unit(&after.direction));
    let cosine = -dot(&from, &to);
    if cosine > STRAIGHT {
        return 0.0;
    }
    let across = unit(&std::array::from_fn(|axis| to[axis] - from[axis]));
    let mut most = after.acceleration;
    for (direction, limit) in across.iter().zip(acceleration) {
        if direction.abs() * most > *limit {
            most = limit / direction.abs();
        }
    }
    // In line: the half angle's sine is one, and any speed will do.
    let sine = half_sine(cosine);
    let mut squared = f64::INFINITY;
    if sine < 1.0 {
        squared = most * after.deviation * sine / (1.0 - sine);
    }
    if after.distance < SHORT && cosine < ARC {
        let turn = small_turn(cosine);
        if turn > 0.0 {
            squared = squared.min(after.distance * most / turn);
        }
    }
    squared
}

/// Klipper's rule, squared speed: an arc as above, one that either move is long enough
/// for, and no sudden change of the filament's speed.
pub(super) fn square_corner(before: &Course, after: &Course, extruder_velocity: f64) -> f64 {
    if !before.moves_nozzle || !after.moves_nozzle {
        return 0.0;
    }
    let mut squared = f64::INFINITY;
    let change = (after.direction[3] - before.direction[3]).abs();
    if change > 0.0 {
        let speed = extruder_velocity / change;
        squared = speed * speed;
    }
    let cosine = -(before.direction[0] * after.direction[0]
        + before.direction[1] * after.direction[1]
        + before.direction[2] * after.direction[2]);
    let sine = half_sine(cosine);
    let half_cosine = (0.5 * (1.0 + cosine)).at_least(0.0).sqrt();
    if sine < 1.0 && half_cosine > 0.0 {
        let arc = sine / (1.0 - sine);
        let tangent = 0.5 * sine / half_cosine;
        for course in [before, after] {
            squared = squared.min(arc * course.deviation * course.acceleration);
            squared = squared.min(course.distance * course.acceleration * tangent);
        }
    }
    squared
}

/// Sine of half the angle whose cosine this is.
fn half_sine(cosine: f64) -> f64 {
    (0.5 * (1.0 - cosine)).at_least(0.0).sqrt()
}

/// The angle in radians by which the path turns, if by no more than 45°. `cosine` is that of
/// the angle between the two moves. The first terms of the arc sine are right to 10⁻⁵.
fn small_turn(cosine: f64) -> f64 {
    let half = (0.5 * (1.0 + cosine)).at_least(0.0).sqrt();
    let square = half * half;
    let series = 1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * (15.0 / 336.0)));
    2.0 * half * series
}

fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
}

/// The vector of length 1 in this direction; a zero vector stays zero.
fn unit(vector: &[f64; 4]) -> [f64; 4] {
    let length = dot(vector, vector).sqrt();
    let inverse = 1.0 / length;
    if length > 0.0 { vector.map(|part| part * inverse) } else { *vector }
}
