//! Wall beads and narrow places -> the beads without those that would leave these in crumbs, or fill them in pieces.
//!
//! Beads along walls fill a room whose walls run beside each other. In one that tapers, such as the tooth of a
//! rack, they end where it gets narrower, and the rest is crumbs of lines, each with a travel. There lines alone
//! fill the room in one go.
//!
//! So it is in a strip of skin between walls whose width changes, such as that between engraved letters and the edge
//! of their plate: as many beads as have room begin and end on the way. There it is the number of pieces that counts.

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

/// A strip between walls is no wider than so many lines: three beads beside each wall.
const STRIP: Coord = 6;

/// Lines take a strip if its beads and what they leave are smaller on average, in squares of a line's width. A larger
/// value fills strips with lines that are all turns; a smaller one leaves patchwork on tops.
const LEAST_PIECE: f64 = 20.0;

/// A bead belongs to the room that holds more than this part of it.
const OF_ROOM: f64 = 0.5;

/// A bead belongs to the strip that holds more than this part of it: it may go on into what is broader.
const OF_STRIP: f64 = 0.25;

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
        beads.iter().map(|bead| room(bead, &islands, raster.pitch, OF_ROOM)).collect();
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

/// The `beads` of layer `k`, in the frame of its skin's raster, without those of strips between walls that they
/// would fill piece by piece. `fill` is what walls leave and `skin` what of it is exposed, on the rows of that raster.
#[must_use]
pub fn without_patchwork(
    k: usize,
    beads: Vec<Polyline>,
    (fill, skin): (&Rows, &Rows),
    params: &RegionParams,
) -> Vec<Polyline> {
    // A lone bead is no patchwork.
    if beads.len() < 2 || skin.is_empty() {
        return beads;
    }
    let raster = params.rasters.skin(skin_turn(k).0);
    let pitch = raster.pitch;
    let half = STRIP * pitch / 2;
    // Rounded corners are no strips.
    let broad = fill.erode(half, pitch).dilate(half + pitch / 2, pitch);
    let strips = skin.and(fill).minus(&broad);
    if strips.is_empty() {
        return beads;
    }
    let left = strips.minus(&taken(&beads, raster.frame, raster, &params.beads));
    let strips = Islands::new(&strips);
    let own: Vec<Option<usize>> =
        beads.iter().map(|bead| room(bead, &strips, pitch, OF_STRIP)).collect();
    let mut pieces = pieces_left(&left, &strips, pitch);
    for (bead, strip) in beads.iter().zip(&own) {
        if let Some(strip) = strip {
            pieces[*strip].beads += 1;
            pieces[*strip].area += area(bead);
        }
    }
    let least = LEAST_PIECE * f64::from(pitch) * f64::from(pitch);
    let is_patchwork = |strip: usize| pieces[strip].is_patchwork(least);
    let kept = beads.into_iter().zip(own).filter(|(_, strip)| !strip.is_some_and(is_patchwork));
    kept.map(|(bead, _)| bead).collect()
}

/// What a strip is filled by.
#[derive(Debug, Clone, Copy, Default)]
struct Filling {
    beads: usize,
    /// What is left beside these, to be filled by lines.
    rests: usize,
    /// The area of both, grid units squared.
    area: f64,
}

impl Filling {
    /// Whether beads and rests are smaller on average. A lone bead, and beads that leave nothing, are tidy.
    fn is_patchwork(&self, least: f64) -> bool {
        let count = (self.beads + self.rests) as f64;
        self.beads > 1 && self.rests > 0 && self.area < least * count
    }
}

/// The pieces that are `left` of each strip.
fn pieces_left(left: &Rows, strips: &Islands<'_>, pitch: Coord) -> Vec<Filling> {
    let mut found = vec![Filling::default(); strips.count()];
    let pieces = Islands::new(left);
    let mut of_piece = vec![None; pieces.count()];
    for (j, row) in left.iter() {
        for (span, piece) in row.iter().zip(pieces.row(j)) {
            of_piece[*piece] = of_piece[*piece].or_else(|| strips.at(j, span.start));
        }
    }
    // What is shorter than a line is wide is not printed.
    let lengths = pieces.lengths().into_iter().zip(of_piece);
    for (length, strip) in lengths.filter(|(length, _)| *length >= i64::from(pitch)) {
        if let Some(strip) = strip {
            found[strip].rests += 1;
            found[strip].area += length as f64 * f64::from(pitch);
        }
    }
    found
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

/// The room that holds most of a bead, and more than `part` of it.
fn room(bead: &[LinePoint], islands: &Islands<'_>, pitch: Coord, part: f64) -> Option<usize> {
    let line: Vec<Point> = bead.iter().map(|p| Point { x: p.u, y: p.v }).collect();
    let at = |p: Point| islands.beside(p, pitch);
    let found: Vec<Option<usize>> = places(&line, pitch).map(at).collect();
    let mut inside: Vec<usize> = found.iter().flatten().copied().collect();
    inside.sort_unstable();
    let most = inside.chunk_by(|a, b| a == b).max_by_key(|same| same.len())?;
    (most.len() as f64 > part * found.len() as f64).then_some(most[0])
}
