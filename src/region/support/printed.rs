//! Contours -> contours: those islands of a layer that have room for a bead.
//!
//! An island thinner than the thinnest bead is not printed. What stands on it hangs, and support may
//! stand where it would have been.

use crate::geom::boxes::Around;
use crate::geom::{Contour, double_area, edges, polygon};
use crate::units::Coord;
use std::borrow::Cow;

/// An island thinner than a line must be so long, in widths of it, to get a bead: half of its
/// outline. Round ones that are smaller get none, since the bead would have no length.
const LEAST_LONG: f64 = 1.75;

/// The islands of `contours` that get a bead: in which a disc as wide as a `line` has room
/// somewhere, or long ones as wide as the thinnest bead at `least`.
pub(super) fn printed(contours: &[Contour], [line, least]: [Coord; 2]) -> Cow<'_, [Contour]> {
    // A shape has room for a disc of the radius area / perimeter. So most layers, with a single
    // island, need no more than these two sums.
    let outer = || contours.iter().filter(|contour| double_area(contour) > 0);
    if outer().count() == 1 && is_roomy(contours, line) {
        return Cow::Borrowed(contours);
    }
    let islands = islands(contours);
    let holds = |island: &Vec<Contour>, disc: Coord| {
        is_roomy(island, disc) || !polygon::inset(island, (disc / 2).max(1)).is_empty()
    };
    let has_room = |island: &&Vec<Contour>| {
        holds(island, line) || (is_long(&island[0], line) && holds(island, least))
    };
    let kept: Vec<&Vec<Contour>> = islands.iter().filter(has_room).collect();
    if kept.len() == islands.len() {
        return Cow::Borrowed(contours);
    }
    Cow::Owned(kept.into_iter().flatten().cloned().collect())
}

/// Whether an area is so large for its outline that a disc must have room.
fn is_roomy(contours: &[Contour], least: Coord) -> bool {
    let area: i128 = contours.iter().map(|contour| double_area(contour)).sum();
    let around: f64 = contours.iter().flat_map(|c| edges(c)).map(|(p, q)| p.distance(q)).sum();
    area as f64 >= f64::from(least) * around
}

/// Whether an outer contour is long enough for a bead.
fn is_long(contour: &Contour, line: Coord) -> bool {
    let around: f64 = edges(contour).map(|(p, q)| p.distance(q)).sum();
    around >= 2.0 * LEAST_LONG * f64::from(line)
}

/// Each outer contour with the holes in it. Those of islands inside a hole are in it as well, which
/// makes it seem smaller than it is: then the exact test decides.
fn islands(contours: &[Contour]) -> Vec<Vec<Contour>> {
    let outer: Vec<&Contour> = contours.iter().filter(|c| double_area(c) > 0).collect();
    let around = Around::new(outer.iter().copied().enumerate());
    let mut islands: Vec<Vec<Contour>> = outer.iter().map(|&one| vec![one.clone()]).collect();
    for hole in contours.iter().filter(|c| double_area(c) < 0) {
        for k in hole.first().into_iter().flat_map(|&p| around.of(p)) {
            islands[k].push(hole.clone());
        }
    }
    islands
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point;

    #[test]
    fn an_island_thinner_than_a_bead_is_not_printed() {
        let block = |x: Coord, wide: Coord| -> Contour {
            [(x, 0), (x + wide, 0), (x + wide, 50_000), (x, 50_000)]
                .map(|(x, y)| Point { x, y })
                .to_vec()
        };
        let all = [block(0, 50_000), block(60_000, 3_000), block(70_000, 5_000)];
        let kept = |least| printed(&all, [4_000.max(least), least]).len();
        assert_eq!([2_000, 4_000, 6_000].map(kept), [3, 2, 1]);
        // A ring with a thin wall has a large outline and a large hole.
        let mut hole = block(61_000, 48_000);
        hole.iter_mut().for_each(|p| p.y = p.y.clamp(1_000, 49_000));
        hole.reverse();
        let ring = [block(60_000, 50_000), hole];
        assert_eq!(printed(&ring, [4_000, 900]).len(), 2);
        assert!(printed(&ring, [4_000, 1_200]).is_empty());
        // A tip as wide as it is long gets no bead, however thin a bead may be.
        let tip = [(0, 0), (3_000, 0), (3_000, 3_000), (0, 3_000)].map(|(x, y)| Point { x, y });
        assert!(printed(&[tip.to_vec()], [4_000, 1_000]).is_empty());
    }
}
