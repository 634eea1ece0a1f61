//! Farthest places of both halves -> Place: the farther one, as the file has it.

use super::apart::{Apart, Farthest};
use super::half::Half;
use super::line::Point;
use super::sums::Both;
use schemars::JsonSchema;
use serde::Serialize;

/// A place in one file that is far from all lines of its role in the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Place {
    /// How far, mm.
    pub distance_mm: f64,
    /// x, y and z, mm.
    pub at_mm: [f64; 3],
    /// Line of either file, from 1: the one that the place is on, and the nearest one of the other.
    pub line: Both<u32>,
}

/// The farther of the two places.
pub(super) fn farthest(one: &Apart, other: &Apart, halves: Both<&Half<'_>>) -> Option<Place> {
    let place = |found: Farthest, half: &Half<'_>, line: Both<u32>| Place {
        distance_mm: found.distance,
        at_mm: in_file(found.at, half),
        line,
    };
    let a = one
        .farthest
        .map(|found| place(found, halves.a, Both { a: found.number, b: found.nearest }));
    let b = other
        .farthest
        .map(|found| place(found, halves.b, Both { a: found.nearest, b: found.number }));
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.distance_mm > a.distance_mm { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// A place as the file has it, of one that is seen from the half's origin.
pub(super) fn in_file(at: Point, half: &Half<'_>) -> Point {
    std::array::from_fn(|axis| at[axis] + half.origin[axis])
}
