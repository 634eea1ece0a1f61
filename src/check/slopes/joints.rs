//! Two lines, one after the other -> where they join, and what of each stands there.

use crate::geom::segment;
use crate::reader::print::Step;

/// Cosine of the angle up to which a line goes on as the one before.
const STRAIGHT: f64 = 0.8;

/// Where a line begins and where it ends: if another one that goes on in about its direction is joined to it there,
/// the direction of both together, of length 1. Beyond a joint the other line is what stands, as high as the nozzle
/// passes there, and not the round end of this one.
pub(super) type Joints = [Option<[f64; 2]>; 2];

/// The direction of two lines together, of length 1, if the second begins where the first ends and goes on in about
/// its direction.
pub(super) fn joint(before: &Step, step: &Step) -> Option<[f64; 2]> {
    let way = |step: &Step| {
        let [x, y, _] = segment::way(step.from.map(f64::from), step.to.map(f64::from));
        [x, y].map(|by| by / step.plan_length())
    };
    let ([ax, ay], [bx, by]) = (way(before), way(step));
    let (cosine, both) = (ax * bx + ay * by, [ax + bx, ay + by]);
    let length = both[0].hypot(both[1]);
    // A line of no length has no direction.
    (before.to == step.from && cosine > STRAIGHT).then(|| both.map(|by| by / length))
}

/// What of a stretch along x at `y` lies no further than `grow` mm beyond a joint, in the direction `by` from it.
pub(super) fn before(
    (left, right): (f64, f64),
    y: f64,
    (joint, by): ([f64; 2], [f64; 2]),
    grow: f64,
) -> Option<(f64, f64)> {
    let rest = grow - (y - joint[1]) * by[1];
    let end = || joint[0] + rest / by[0];
    let (left, right) = if by[0] > 0.0 {
        (left, right.min(end()))
    } else if by[0] < 0.0 {
        (left.max(end()), right)
    } else if rest >= 0.0 {
        (left, right)
    } else {
        return None;
    };
    (left < right).then_some((left, right))
}
