//! Wall beads and narrow rooms -> the beads without those of rooms that they would leave in crumbs.
//!
//! Beads along walls fill a room whose walls run beside each other. In one that tapers, such as the tooth of a
//! rack, they end where it gets narrower, and the rest is crumbs of lines, each with a travel. There lines alone
//! fill the room in one go.

use super::hidden::places;
use super::params::RegionParams;
use super::per_raster::skin_turn;
use super::wall_beads::taken;
use crate::geom::Point;
use crate::geom::islands::Islands;
use crate::geom::polyline::{LinePoint, Polyline, area};
use crate::geom::spans::Rows;
use crate::units::Coord;

/// The least part of a room that beads have to fill, of what they and the lines beside them would fill. A larger
/// value fills bent strips with lines that are all turns; a smaller one leaves crumbs in rooms that taper.
const LEAST: f64 = 0.75;

/// A piece that beads leave is a crumb if it is nowhere wider than so many lines. With a larger value the hub of a wheel
/// takes the beads of its spokes; with a smaller one crumbs pass.
const WIDEST: Coord = 4;

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
    let islands = Islands::new(rows);
    let left = rows.minus(&taken(&beads, raster.frame, raster, &params.beads));
    let crumbs = crumbs(&left, &islands, raster.pitch);
    // Rows tell the length of narrow rooms, not their width: what beads fill is what they hold.
    let rooms: Vec<Option<usize>> =
        beads.iter().map(|bead| room(bead, &islands, raster.pitch)).collect();
    let mut filled = vec![0.0; islands.count()];
    for (bead, room) in beads.iter().zip(&rooms) {
        if let Some(room) = room {
            filled[*room] += area(bead);
        }
    }
    let is_wedge = |room: usize| filled[room] < LEAST * (filled[room] + crumbs[room]);
    let kept = beads.into_iter().zip(rooms).filter(|(_, room)| !room.is_some_and(is_wedge));
    kept.map(|(bead, _)| bead).collect()
}

/// The area of what is `left` of each room in crumbs.
fn crumbs(left: &Rows, rooms: &Islands<'_>, pitch: Coord) -> Vec<f64> {
    let pieces = Islands::new(left);
    let core = left.erode(WIDEST * pitch / 2, pitch);
    let wide = pieces.any(|j, span| core.overlapping(j, span).is_some());
    let mut crumbs = vec![0.0; rooms.count()];
    for (j, row) in left.iter() {
        let small = row.iter().zip(pieces.row(j)).filter(|(_, piece)| !wide[**piece]);
        for (span, _) in small {
            if let Some(room) = rooms.at(j, span.start) {
                crumbs[room] += span.len() as f64 * f64::from(pitch);
            }
        }
    }
    crumbs
}

/// The room that holds most of a bead; `None` if most of it lies in none.
fn room(bead: &[LinePoint], islands: &Islands<'_>, pitch: Coord) -> Option<usize> {
    let line: Vec<Point> = bead.iter().map(|p| Point { x: p.u, y: p.v }).collect();
    let at = |p: Point| islands.beside(p, pitch);
    let mut found: Vec<Option<usize>> = places(&line, pitch).map(at).collect();
    let all = found.len();
    found.sort_unstable();
    let most = found.chunk_by(|a, b| a == b).max_by_key(|same| same.len())?;
    most[0].filter(|_| 2 * most.len() > all)
}
