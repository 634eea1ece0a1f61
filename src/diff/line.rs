//! Moves -> Line: a straight line of plastic in space, and how far it lies from points and other lines.
//!
//! Words used here: a line's places are numbered from 0 at its start to 1 at its end; a *part* is
//! such a range; *reach* is the distance within which places count as the same.
//!
//! The part of a line that lies within reach of another line is one range, because the distance from
//! a convex set is a convex function along a line. It is found exactly: the places within reach of
//! the other's two ends (where a parabola is below reach²), and those that lie beside it, within
//! reach of the endless line through it; the three ranges together make the part.

use crate::geom::segment::{self, along, dot, way};
use crate::reader::print::Step;

/// A place, mm.
pub(super) type Point = [f64; 3];

/// A part of a line: where it begins and ends, 0 being the line's start and 1 its end.
pub(super) type Part = [f64; 2];

/// Squared share of its length by which a parallel line may leave another: rounding of floats. Without
/// it nearly parallel lines divide by nearly 0.
const PARALLEL: f64 = 1e-20;

/// Rounding of a filament length with five decimals, mm; two of them make a difference.
const FILAMENT_ROUNDING: f64 = 2e-5;

/// Rounding of a coordinate with three decimals, mm; two of them make a difference.
const PLACE_ROUNDING: f64 = 1e-3;

/// A line has to be so many times as long as places may be apart to be known by its ends.
const SHORT: f64 = 10.0;

/// A straight line of plastic, or a way without. Places are seen from an origin: heights are above the
/// layer, and a print that moved as a whole lies where it was.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub(super) from: Point,
    pub(super) to: Point,
    /// mm.
    pub(super) length: f64,
    /// Filament for each mm of line, mm.
    pub(super) flow: f64,
    /// Width and height by the file, mm.
    pub(super) section: [f64; 2],
    /// Line of the file, from 1.
    pub(super) number: u32,
}

impl Line {
    /// The line that this move lays, as seen from `origin`.
    pub(super) fn new(step: &Step, origin: Point) -> Self {
        let length = step.length();
        Self {
            from: seen(step.from, origin),
            to: seen(step.to, origin),
            length,
            flow: f64::from(step.filament) / length,
            section: [f64::from(step.width), f64::from(step.height)],
            number: step.line,
        }
    }

    /// The way of a move that lays no line, as seen from `origin`.
    pub(super) fn way(step: &Step, origin: Point) -> Self {
        Self { flow: 0.0, section: [0.0; 2], ..Self::new(step, origin) }
    }

    /// A place where something is without a line.
    pub(super) fn dot(at: Point, number: u32) -> Self {
        // The length says only how large cells are to be; 0 would be divided by.
        Self { from: at, to: at, length: 1.0, flow: 0.0, section: [0.0; 2], number }
    }

    /// The place at `t`, from 0 to 1.
    pub(super) fn at(&self, t: f64) -> Point {
        along(self.from, t, way(self.from, self.to))
    }

    /// How far `point` is from the nearest place of this line, mm.
    pub(super) fn distance(&self, point: Point) -> f64 {
        segment::distance2(point, [self.from, self.to]).sqrt()
    }

    /// The part of this line that is no farther than `reach` from `other`. It is one part,
    /// because the distance from something convex is a convex function.
    pub(super) fn part_near(&self, other: &Self, reach: f64) -> Option<Part> {
        if self.is_far_from(other, reach) {
            return None;
        }
        let (u, v) = (way(self.from, self.to), way(other.from, other.to));
        let w = way(other.from, self.from);
        let ends = joined(within(w, u, reach), within(way(v, w), u, reach));
        joined(ends, part_beside(w, u, v, reach))
    }

    /// Whether both begin and end at the same places, in this or the other order. Lines that are not much
    /// longer than `reach` are not told apart so.
    pub(super) fn has_ends_of(&self, other: &Self, reach: f64) -> bool {
        let near = |a: Point, b: Point| dot(way(a, b), way(a, b)) <= reach * reach;
        let same = near(self.from, other.from) && near(self.to, other.to);
        let turned = near(self.from, other.to) && near(self.to, other.from);
        self.length > SHORT * reach && (same || turned)
    }

    /// Whether already the boxes around both are too far from each other.
    fn is_far_from(&self, other: &Self, reach: f64) -> bool {
        (0..2).any(|axis| {
            let low = self.from[axis].min(self.to[axis]) - reach;
            let high = self.from[axis].max(self.to[axis]) + reach;
            other.from[axis].max(other.to[axis]) < low
                || other.from[axis].min(other.to[axis]) > high
        })
    }

    /// Whether both have the same plastic for each mm, within the decimals of a file.
    /// Ends may lie `reach` apart, which makes short lines longer or shorter.
    pub(super) fn is_as_thick(&self, other: &Self, share: f64, reach: f64) -> bool {
        let shorter = self.length.min(other.length);
        let most = self.flow.max(other.flow);
        let ends = 2.0 * (reach + PLACE_ROUNDING) / shorter;
        let allowed = most * (share + ends) + FILAMENT_ROUNDING / shorter;
        (self.flow - other.flow).abs() <= allowed
    }
}

/// A place of the file, as seen from `origin`.
pub(super) fn seen(at: [f32; 3], origin: Point) -> Point {
    way(origin, at.map(f64::from))
}

/// Where `w` + t·`u` is no longer than `reach`, within 0 to 1.
fn within(w: Point, u: Point, reach: f64) -> Option<Part> {
    let square = dot(u, u);
    let middle = if square > 0.0 { -dot(w, u) / square } else { 0.0 };
    let nearest = along(w, middle, u);
    let room = reach * reach - dot(nearest, nearest);
    if room < 0.0 {
        return None;
    }
    if square == 0.0 {
        return Some([0.0, 1.0]);
    }
    let half = (room / square).sqrt();
    clipped([middle - half, middle + half])
}

/// Where `w` + t·`u` lies beside the stretch from 0 to `v`, no farther than `reach`.
fn part_beside(w: Point, u: Point, v: Point, reach: f64) -> Option<Part> {
    let square = dot(v, v);
    if square == 0.0 {
        return None;
    }
    let (first, rise) = (dot(w, v) / square, dot(u, v) / square);
    let beside = if rise == 0.0 {
        (0.0..=1.0).contains(&first).then_some([0.0, 1.0])?
    } else {
        let (a, b) = (-first / rise, (1.0 - first) / rise);
        clipped([a.min(b), a.max(b)])?
    };
    let across_w = along(w, -first, v);
    let mut across_u = along(u, -rise, v);
    if dot(across_u, across_u) <= PARALLEL * dot(u, u) {
        across_u = [0.0; 3];
    }
    let near = within(across_w, across_u, reach)?;
    let part = [near[0].max(beside[0]), near[1].min(beside[1])];
    (part[0] <= part[1]).then_some(part)
}

/// From the first of both to the last.
fn joined(a: Option<Part>, b: Option<Part>) -> Option<Part> {
    let (Some(one), Some(other)) = (a, b) else { return a.or(b) };
    Some([one[0].min(other[0]), one[1].max(other[1])])
}

fn clipped([low, high]: Part) -> Option<Part> {
    (low <= 1.0 && high >= 0.0).then_some([low.max(0.0), high.min(1.0)])
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    pub(in crate::diff) fn line(from: [f64; 2], to: [f64; 2]) -> Line {
        let length = ((to[0] - from[0]).powi(2) + (to[1] - from[1]).powi(2)).sqrt();
        let (from, to) = ([from[0], from[1], 0.0], [to[0], to[1], 0.0]);
        Line { from, to, length, flow: 0.03, section: [0.4, 0.2], number: 1 }
    }

    fn places() -> impl Strategy<Value = [[f64; 2]; 4]> {
        let place = || prop::array::uniform2(-4.0..4.0_f64);
        [place(), place(), place(), place()]
    }

    proptest! {
        #[test]
        fn the_part_near_is_where_the_distance_is_small([a, b, c, d] in places(), reach in 0.1..3.0_f64) {
            let (one, other) = (line(a, b), line(c, d));
            let part = one.part_near(&other, reach);
            for k in 0..=100 {
                let t = f64::from(k) / 100.0;
                let distance = other.distance(one.at(t));
                let inside = part.is_some_and(|[low, high]| (low..=high).contains(&t));
                prop_assert!(inside == (distance <= reach) || (distance - reach).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn parallel_and_crossing_lines() {
        let one = line([0.0, 0.0], [10.0, 0.0]);
        assert_eq!(one.part_near(&line([10.0, 0.0], [0.0, 0.0]), 0.01), Some([0.0, 1.0]));
        assert_eq!(one.part_near(&line([0.0, 0.02], [10.0, 0.02]), 0.01), None);
        let half = one.part_near(&line([5.0, 0.0], [20.0, 0.0]), 0.01).unwrap();
        assert!((half[0] - 0.499).abs() < 1e-9 && half[1] == 1.0);
        let cross = one.part_near(&line([5.0, -5.0], [5.0, 5.0]), 0.01).unwrap();
        assert!((cross[0] - 0.499).abs() < 1e-9 && (cross[1] - 0.501).abs() < 1e-9);
    }
}
