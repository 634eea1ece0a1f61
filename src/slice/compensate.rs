//! Contours -> contours: moved by what printers get wrong, outlines and holes apart.
//!
//! Parts come out too wide and holes too narrow by tenths of a millimetre, and the first layer is
//! pressed wide on the bed (the elephant's foot). Each contour is offset to make up for it; what meets
//! then is one, and what is thinner than it loses is gone, to be judged as any other missing place.

use super::Heights;
use crate::geom::nest::{Nest, turned};
use crate::geom::{Contour, polygon};
use crate::units::Coord;

/// How far contours are moved, grid units; nothing by default.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Compensation {
    /// Outer contours outwards, inwards if negative.
    pub outline: Coord,
    /// Holes wider, narrower if negative.
    pub hole: Coord,
    /// The first layer inwards. Layers above it as much less as they lie higher: what is drawn in so
    /// grows back no flatter than at 45°.
    pub foot: Coord,
}

impl Compensation {
    /// The contours (as from [`polygon::union`]) of layer `k` of `heights`, moved.
    pub(super) fn apply(self, contours: Vec<Contour>, k: usize, heights: &Heights) -> Vec<Contour> {
        let bottom = heights.top(k) - heights.height(k);
        let foot = (self.foot - bottom).max(0);
        let [outline, hole] = [self.outline - foot, self.hole + foot];
        match (outline, hole) {
            (0, 0) => contours,
            // All sides alike: one offset does not let bodies and holes meet in between.
            (outline, hole) if outline == -hole => grown(&contours, outline),
            (outline, hole) => apart(&contours, outline, hole),
        }
    }
}

/// Outer contours moved by `outline`, holes by `hole`, both outwards.
fn apart(contours: &[Contour], outline: Coord, hole: Coord) -> Vec<Contour> {
    let nest = Nest::new(contours);
    let island = |k: usize| {
        let holes: Vec<Contour> = nest
            .within(Some(k))
            .flat_map(|hole_of| grown(&[turned(&contours[hole_of])], hole))
            .collect();
        let body = grown(&contours[k..=k], outline);
        if holes.is_empty() { body } else { polygon::difference(&body, &holes, 0) }
    };
    polygon::union(&nest.outer().flat_map(island).collect::<Vec<_>>())
}

/// Contours offset by `distance`, which may be negative or 0.
fn grown(contours: &[Contour], distance: Coord) -> Vec<Contour> {
    match distance {
        0 => contours.to_vec(),
        1.. => polygon::outset(contours, distance),
        _ => polygon::inset(contours, -distance),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point;
    use proptest::prelude::*;

    fn square(half: Coord) -> Contour {
        [(-1, -1), (1, -1), (1, 1), (-1, 1)]
            .map(|(x, y)| Point { x: x * half, y: y * half })
            .to_vec()
    }

    /// Half the sides of the squares, by falling size.
    fn halves(contours: &[Contour]) -> Vec<Coord> {
        let half = |c: &Contour| c.iter().map(|p| p.x.abs().max(p.y.abs())).max().unwrap_or(0);
        let mut halves: Vec<Coord> = contours.iter().map(half).collect();
        halves.sort_unstable_by(|a, b| b.cmp(a));
        halves
    }

    proptest! {
        #[test]
        fn outlines_and_holes_move_by_what_is_asked_on_their_own(
            outline in -3_000..3_000, hole in -3_000..3_000, foot in 0..6_000, k in 0_usize..5,
        ) {
            // A frame with a frame in its hole.
            let contours =
                vec![square(100_000), turned(&square(80_000)), square(60_000), turned(&square(40_000))];
            let heights = Heights::even(2_000, 1_000, 20_000);
            let moved = Compensation { outline, hole, foot }.apply(contours, k, &heights);
            let bottom = heights.top(k) - heights.height(k);
            let drawn_in = (foot - bottom).max(0);
            let by = |half: Coord, by: Coord| half + by;
            let (o, h) = (outline - drawn_in, hole + drawn_in);
            let wanted = [by(100_000, o), by(80_000, h), by(60_000, o), by(40_000, h)];
            let found = halves(&moved);
            prop_assert_eq!(found.len(), 4);
            prop_assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= 2), "{:?}", found);
        }
    }

    #[test]
    fn what_is_thinner_than_it_loses_is_gone() {
        let moved = |outline| {
            let heights = Heights::even(2_000, 2_000, 20_000);
            Compensation { outline, ..Compensation::default() }.apply(
                vec![square(2_000)],
                0,
                &heights,
            )
        };
        assert!(moved(-2_001).is_empty());
        assert_eq!(halves(&moved(-1_500)), [500]);
    }
}
