//! Wall beads and narrow rooms -> the beads without those of rooms that they would leave in crumbs.
//!
//! Beads along walls fill a room whose walls run beside each other. In one that tapers, such as the tooth of a
//! rack, they end where it gets narrower, and the rest is crumbs of lines, each with a travel. There lines alone
//! fill the room in one go.

use super::hidden::holds;
use super::params::RegionParams;
use super::per_raster::skin_turn;
use super::wall_beads::taken;
use crate::geom::Point;
use crate::geom::islands::Islands;
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::spans::{Rows, intersect, total};

/// The least part of a room that beads have to fill. A larger value fills bent strips with lines that are all
/// turns; a smaller one leaves crumbs in rooms that taper.
const LEAST: f64 = 0.75;

/// The `beads` of layer `k`, in the frame of its skin's raster, without those of the `rooms` that they leave in
/// crumbs.
#[must_use]
pub fn without_wedges(
    k: usize,
    beads: Vec<Polyline>,
    rooms: &[Rows; 2],
    params: &RegionParams,
) -> Vec<Polyline> {
    if beads.is_empty() {
        return beads;
    }
    let along = skin_turn(k).0;
    let (rows, raster) = (&rooms[along], params.rasters.skin(along));
    let wedges = wedges(rows, &taken(&beads, raster.frame, raster, &params.beads));
    let is_there = |p: &&LinePoint| holds(&wedges, Point { x: p.u, y: p.v }, raster.pitch);
    let lies_there = |bead: &Polyline| 2 * bead.iter().filter(is_there).count() > bead.len();
    beads.into_iter().filter(|bead| !lies_there(bead)).collect()
}

/// The rooms of which less than [`LEAST`] is `filled`.
fn wedges(rooms: &Rows, filled: &Rows) -> Rows {
    let islands = Islands::new(rooms);
    let mut sums = vec![[0; 2]; islands.count()];
    let mut inside = Vec::new();
    for (j, row) in rooms.iter() {
        for (span, island) in row.iter().zip(islands.row(j)) {
            inside.clear();
            intersect(&[*span], filled.row(j), &mut inside);
            sums[*island][0] += span.len();
            sums[*island][1] += total(&inside);
        }
    }
    let is_wedge = |[all, filled]: [i64; 2]| (filled as f64) < LEAST * all as f64;
    islands.select(|island| is_wedge(sums[island]))
}
