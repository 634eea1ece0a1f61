//! Directions of bridges -> directions: bridges on both sides of a thin carrier lie in one.
//!
//! The anchors of two bridges that run in different directions need room beside each other. The wall of a tube, or
//! a rib, is too thin for both: the lines of one would reach out over the other opening, and those of the other
//! end there in the air. In one direction lines go straight on over it.
//!
//! Algorithm: bridges that are nearer to each other than an anchor is long are a group. Each takes the direction of
//! the largest of its group if its own lines hold nearly as well in that. Slots at all angles keep theirs.

use super::Open;
use super::direction::{Direction, suits};
use crate::geom::islands::Islands;
use crate::region::params::RegionParams;
use crate::units::Coord;

/// Lets the bridges among the `islands` of `open` agree on the directions `found`.
pub(super) fn agree(
    found: &mut [Option<Direction>],
    islands: &Islands<'_>,
    open: &Open<'_>,
    anchor: Coord,
    params: &RegionParams,
) {
    let bridges: Vec<usize> = (0..islands.count()).filter(|k| found[*k].is_some()).collect();
    if bridges.len() < 2 {
        return;
    }
    let largest = largest_beside(&bridges, islands, open, anchor);
    for (island, leader) in bridges.into_iter().zip(largest) {
        let Some((own, leader)) = found[island].zip(leader.and_then(|leader| found[leader])) else {
            continue;
        };
        let site = open.site(island, islands);
        if own.turn != leader.turn && suits(&site, leader.turn, &own, params.insets.fill) {
            found[island] = Some(Direction { turn: leader.turn, ..own });
        }
    }
}

/// The largest bridge of each one's group; the first of equal ones.
fn largest_beside(
    bridges: &[usize],
    islands: &Islands<'_>,
    open: &Open<'_>,
    anchor: Coord,
) -> Vec<Option<usize>> {
    let is_bridge = |island: usize| bridges.binary_search(&island).is_ok();
    let near = islands.select(is_bridge).dilate(anchor / 2, open.raster.pitch);
    let groups = Islands::new(&near);
    let mut group_of = vec![None; islands.count()];
    for (j, row) in open.rows.iter() {
        for (span, island) in row.iter().zip(islands.row(j)) {
            group_of[*island] = group_of[*island].or_else(|| groups.at(j, span.start));
        }
    }
    let lengths = islands.lengths();
    let mut largest: Vec<Option<usize>> = vec![None; groups.count()];
    for &island in bridges {
        let Some(group) = group_of[island] else { continue };
        if largest[group].is_none_or(|other| lengths[other] < lengths[island]) {
            largest[group] = Some(island);
        }
    }
    bridges.iter().map(|island| group_of[*island].and_then(|group| largest[group])).collect()
}
