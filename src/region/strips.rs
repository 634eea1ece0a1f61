//! Scans + walls -> Strips: room between walls that is too thin for two beads, where one has to do.
//!
//! Where [`super::thin`] left out an inner wall the room gets one bead as wide as it is, which
//! [`super::wall_beads`] lays like that in a thin strip of skin. The room inside the innermost
//! wall is filled in the same way where it is too thin for infill.

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
    /// What of it is too thin for two beads, and has no part of the next wall.
    pub narrow: [Rows; 2],
}

/// For each of `walls`, from the outside inwards, the room inside it on the rasters of skins.
/// `innermost` is the room inside the last, where lines run.
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

/// The spans of `rows` that do not meet any of `others`.
#[must_use]
pub fn apart(rows: &Rows, others: &Rows) -> Rows {
    rows.filter(|j, span| !others.row(j).iter().any(|other| span.overlaps(*other)))
}
