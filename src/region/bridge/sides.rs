//! Contours of two layers -> Sides: the directions of the straight sides beside an opening.
//!
//! A bridge is laid square to what carries it, or along the walls beside it, to the tenth of a degree: its lines
//! then end on the carrier and none runs out at a side. A few directions that lie evenly around cannot tell
//! this, since the parts of a plate, and the pillars of a part, may stand at any angle.

use crate::geom::boxes::{extent, meet};
use crate::geom::frame::Frame;
use crate::geom::segment::way;
use crate::geom::{Contour, Point, edges, side};

/// Number of directions that a bridge may have. They begin with that of the layer's skin.
pub const COUNT: usize = 1800;

/// From one direction to the next, degrees. The directions make half a turn.
pub const STEP: f64 = 180.0 / COUNT as f64;

/// Shorter sides tell no direction (2 mm): those of round contours. A larger value misses those of small pillars.
const LEAST: f64 = 20_000.0;

/// Most directions that are tried for one opening, each with the one across.
const MOST: usize = 4;

/// The straight sides of contours, with their lengths.
#[derive(Debug, Default)]
pub struct Sides(Vec<([Point; 2], f64)>);

impl Sides {
    /// Those of `contours`, in `frame`.
    pub fn new<'a>(contours: impl Iterator<Item = &'a Contour>, frame: Frame) -> Self {
        let long = |(p, q): (Point, Point)| {
            let length = p.distance(q);
            (length >= LEAST).then(|| ([frame.enter(p), frame.enter(q)], length))
        };
        Self(contours.flat_map(|contour| edges(contour)).filter_map(long).collect())
    }

    /// The directions of the longest sides that come into the box from `low` to `high`, and those across, as numbers
    /// of [`STEP`]s: the nearest to the rows first.
    #[must_use]
    pub fn directions(&self, [low, high]: [Point; 2]) -> Vec<usize> {
        let mut found: Vec<(usize, f64)> = Vec::new();
        for ([p, q], length) in self.0.iter().filter(|(side, _)| meets(side, low, high)) {
            let turn = turn(*p, *q);
            match found.iter_mut().find(|(other, _)| *other == turn) {
                Some((_, sum)) => *sum += length,
                None => found.push((turn, *length)),
            }
        }
        found.sort_by(|(a, long), (b, longer)| longer.total_cmp(long).then(a.cmp(b)));
        found.truncate(MOST);
        let both = |(turn, _): &(usize, f64)| [*turn, turn + COUNT / 2];
        let mut turns: Vec<usize> = found.iter().flat_map(both).collect();
        turns.sort_by_key(|turn| ((*turn).min(COUNT - turn), *turn));
        turns
    }
}

/// Whether a side comes into the box from `low` to `high`.
fn meets(ends: &[Point; 2], low: Point, high: Point) -> bool {
    let [p, q] = *ends;
    let corners = [low, Point { x: high.x, ..low }, high, Point { y: high.y, ..low }];
    let sides = corners.map(|corner| side(p, q, corner).signum());
    extent(ends).is_some_and(|around| meet(around, (low, high)))
        && sides.iter().any(|side| *side != sides[0])
}

/// The direction of a side, which counts the same both ways, or of the one across: less than a right angle.
fn turn(p: Point, q: Point) -> usize {
    let real = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let [x, y] = way(real(p), real(q));
    let degrees = libm::atan2(y, x).to_degrees() + 360.0;
    (degrees / STEP).round() as usize % (COUNT / 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_rectangle_tells_its_two_directions(
            degrees in 0.0..180.0_f64, wide in 20_100..400_000_i32, deep in 20_100..400_000_i32
        ) {
            let p = |x, y| Point { x, y };
            let contour = vec![p(0, 0), p(wide, 0), p(wide, deep), p(0, deep)];
            let sides = Sides::new(std::iter::once(&contour), Frame::new(-degrees));
            let far = 1_000_000;
            let found = sides.directions([p(-far, -far), p(far, far)]);
            let own = (degrees / STEP).round() as usize % COUNT;
            for turn in &found {
                let off = turn.abs_diff(own) % (COUNT / 2);
                prop_assert!(off.min(COUNT / 2 - off) <= 1, "{} of {:?}", degrees, found);
            }
            prop_assert!(found.len() >= 2);
            prop_assert!(sides.directions([p(900_000, 900_000), p(far, far)]).is_empty());
        }
    }
}
