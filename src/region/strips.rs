//! Scans + walls -> Strips: room between walls that is too thin for two beads and gets one.
//!
//! Where [`super::thin`] cut off an inner wall, the room gets one bead of its full width.
//! [`super::wall_beads`] lays it like the bead in a thin strip of skin. Where the room inside the
//! innermost wall is too thin for infill, it is filled in the same way.

use super::params::RegionParams;
use super::scan::Scan;
use super::walls::Wall;
use crate::geom::Contour;
use crate::geom::spans::Rows;

/// The room inside one of the walls, on the two rasters of skins.
#[derive(Debug, Clone)]
pub struct Strip {
    /// Where a bead inside that wall may run.
    pub room: [Rows; 2],
    /// The part of it that is too thin for two beads and holds no part of the next wall.
    pub narrow: [Rows; 2],
}

/// The room inside each of `walls` on the rasters of skins, from the outside inwards. `innermost`
/// is the room inside the last wall, where lines run.
#[must_use]
pub fn strips(
    scans: [&Scan; 2],
    walls: &[Wall],
    innermost: [&Rows; 2],
    params: &RegionParams,
) -> Vec<Strip> {
    let count = params.walls.count;
    (1..=count)
        .map(|depth| {
            let next = walls.iter().filter(|w| w.depth == depth);
            let next: Vec<Contour> = next.map(|w| w.path.clone()).collect();
            let inset = params.walls.inset_of(depth) + params.beads.wall_to_fill;
            let room = [0, 1].map(|r| match depth == count {
                true => innermost[r].clone(),
                false => scans[r].inset(inset),
            });
            let narrow = [0, 1].map(|r| {
                if depth < count {
                    apart(&room[r], Scan::new(&next, params.rasters.skin(r)).inside())
                } else {
                    apart(&room[r], &scans[r].inset(params.walls.inset_of_narrow(depth)))
                }
            });
            Strip { room, narrow }
        })
        .collect()
}

/// The spans of `rows` that overlap none of `others`.
#[must_use]
pub fn apart(rows: &Rows, others: &Rows) -> Rows {
    rows.filter(|j, span| !others.row(j).iter().any(|other| span.overlaps(*other)))
}
