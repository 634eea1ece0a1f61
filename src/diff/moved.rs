//! Layers of two files -> how far the second print lies from the first, if it moved as a whole.
//!
//! Heights first: all layers must lie as much higher or lower. Then the boxes around the lines of
//! each layer: most of them must be as large in both files, and lie as far apart. Else one part of
//! several moved, or its shape changed, and every line is to be looked at where it is.

use super::align::{Level, Pair, align};
use super::apart::SLACK;
use super::line::Point;
use super::sums::Extent;

/// The share of layers that must have moved like the whole.
const MOST: f64 = 0.5;

/// What moved by 1 moved by no 1.0000002: parts of a mm that are told.
const ROUND: f64 = 1e4;

/// A layer as it is compared with the other file's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Floor {
    pub(super) level: Level,
    /// Box around its lines.
    pub(super) extent: Option<Extent>,
    /// The middle of its lines in x and y, mm.
    pub(super) middle: [f64; 2],
}

/// How far all of the second file's layers lie above those of the first, mm; 0 if they do not lie
/// alike, or no farther than the tolerance.
pub(super) fn raised(a: &[Floor], b: &[Floor], tolerance: f64) -> f64 {
    let mut by = a.iter().zip(b).map(|(a, b)| b.level.z - a.level.z);
    let Some(first) = by.next().filter(|_| a.len() == b.len()) else { return 0.0 };
    let alike = by.all(|by| (by - first).abs() <= tolerance + SLACK);
    if alike && first.abs() > tolerance + SLACK { rounded(first) } else { 0.0 }
}

/// The pairs of layers, if the second file's are lowered by `raised`, mm.
pub(super) fn pairs(a: &[Floor], b: &[Floor], raised: f64, tolerance: f64) -> Vec<Pair> {
    let a: Vec<Level> = a.iter().map(|floor| floor.level).collect();
    let lower = |floor: &Floor| Level { z: floor.level.z - raised, ..floor.level };
    let b: Vec<Level> = b.iter().map(lower).collect();
    align(&a, &b, tolerance)
}

/// How far the second print moved as a whole, mm; `None` if it did not.
pub(super) fn moved(
    a: &[Floor],
    b: &[Floor],
    pairs: &[Pair],
    raised: f64,
    tolerance: f64,
) -> Option<Point> {
    let by = |pair: &Pair| {
        let (one, other) = (a.get(pair.a?)?, b.get(pair.b?)?);
        apart(one.extent?, other.extent?, tolerance)
    };
    let all: Vec<[f64; 2]> = pairs.iter().filter_map(by).collect();
    let usual: [f64; 2] = std::array::from_fn(|axis| {
        let mut sorted: Vec<f64> = all.iter().map(|by| by[axis]).collect();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or_default()
    });
    let alike = all.iter().filter(|by| {
        (0..2).all(|axis| (by[axis] - usual[axis]).abs() <= 2.0 * (tolerance + SLACK))
    });
    let is_far = usual.iter().any(|by| by.abs() > tolerance + SLACK);
    let most = alike.count() as f64 > MOST * pairs.len() as f64;
    let [x, y] = if is_far && most { usual.map(rounded) } else { [0.0; 2] };
    (x != 0.0 || y != 0.0 || raised != 0.0).then_some([x, y, raised])
}

/// How far a box lies from one of the same size, in x and y.
pub(super) fn apart(a: Extent, b: Extent, tolerance: f64) -> Option<[f64; 2]> {
    let mut by = [0.0; 2];
    for (axis, by) in by.iter_mut().enumerate() {
        let [low, high] = [b.min[axis] - a.min[axis], b.max[axis] - a.max[axis]];
        if (low - high).abs() > 2.0 * (tolerance + SLACK) {
            return None;
        }
        *by = 0.5 * (low + high);
    }
    Some(by)
}

pub(super) fn rounded(value: f64) -> f64 {
    (value * ROUND).round() / ROUND
}
