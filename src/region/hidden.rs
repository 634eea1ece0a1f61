//! Beads in narrow rooms, and the layers around -> those that nothing exposes: they are infill.
//!
//! A room too narrow for sparse lines is filled by a bead between its walls, by beads along them, or
//! by solid lines. Where the layers above and below cover it, all of these are infill: they hold
//! the walls apart and are seen by nobody. Elsewhere they are part of a surface.

use super::classify::neighbours;
use super::params::RegionParams;
use super::per_raster::skin_turn;
use super::prepare::LayerRows;
use super::stretches::{Smooth, parted, stretches};
use super::walls::Wall;
use crate::geom::Point;
use crate::geom::outline::Columns;
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::spans::Rows;
use crate::units::{Bounded as _, Coord, nearest};

/// So far from what is exposed beads are still part of the surface, in line widths. A smaller value leaves
/// surfaces of short pieces.
const MARGIN: f64 = 2.0;

/// Shorter stretches between exposed ones belong to these, in line widths. A smaller value makes pieces that
/// change from one kind to the other and back; a larger one takes more for surface.
const LEAST: f64 = 5.0;

/// An area as its rows and its columns tell it. A strip between two rows is on no row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<'a> {
    rows: &'a Rows,
    columns: Columns<'a>,
}

impl<'a> Place<'a> {
    /// Of an area given on the two rasters of skins, whose rows are `pitch` apart: in the frame of the one
    /// that layer `k` prints.
    pub(super) fn new(k: usize, of: &'a [Rows; 2], pitch: Coord) -> Self {
        let (along, across) = skin_turn(k);
        let columns = Columns { rows: &of[across], pitch, left_turn: along == 0 };
        Self { rows: &of[along], columns }
    }

    pub(super) fn holds(&self, p: Point) -> bool {
        let pitch = self.columns.pitch;
        holds(self.rows, p, pitch) || self.columns.chord(nearest_row(p.x, pitch), p.y).is_some()
    }
}

/// The stretches of the wall `beads` of layer `k`: first those in its solid `rooms` that nothing exposes,
/// then the others. `rooms` and what is `exposed` are on the two rasters of skins.
#[must_use]
pub fn beads(
    k: usize,
    beads: Vec<Polyline>,
    rooms: Option<&[Rows; 2]>,
    exposed: &[Rows; 2],
    params: &RegionParams,
) -> (Vec<Polyline>, Vec<Polyline>) {
    let Some(rooms) = rooms.filter(|_| !beads.is_empty()) else { return (Vec::new(), beads) };
    let pitch = params.rasters.skin(skin_turn(k).1).pitch;
    // Beads go on beside rooms by a line: short ones lie mostly there.
    let rooms = [0, 1].map(|r| rooms[r].dilate(pitch, pitch));
    let [rooms, exposed] = [&rooms, exposed].map(|of| Place::new(k, of, pitch));
    let w = f64::from(pitch);
    let smooth = Smooth { close: 0.0, margin: MARGIN * w, least: LEAST * w };
    let place = |p: &LinePoint| Point { x: p.u, y: p.v };
    let covered = |p: &LinePoint| !exposed.holds(place(p));
    let all = beads.iter().flat_map(|bead| stretches(bead, pitch, smooth, covered));
    let [hidden, others] =
        parted(all.map(|(covered, stretch)| (covered && is_inside(&stretch, rooms), stretch)));
    (hidden, others)
}

/// Whether most of a bead lies in the `rooms`. Their rows leave out what lies between two of them.
fn is_inside(bead: &[LinePoint], rooms: Place<'_>) -> bool {
    let line: Vec<Point> = bead.iter().map(|p| Point { x: p.u, y: p.v }).collect();
    let places: Vec<Point> = places(&line, rooms.columns.pitch).collect();
    let inside = places.iter().filter(|&&p| rooms.holds(p)).count();
    2 * inside > places.len()
}

/// The indices of those `walls` of layer `k` that lie between the innermost loops, and that nothing
/// exposes. `layers(k)` is `None` outside the part.
#[must_use]
pub fn between_walls<'a>(
    k: usize,
    walls: &[Wall],
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    params: &RegionParams,
) -> Vec<usize> {
    let count = params.walls.count;
    let mut inner = walls.iter().enumerate().filter(|(_, w)| w.depth >= count.max(1)).peekable();
    if inner.peek().is_none() {
        return Vec::new();
    }
    let Some(around) = neighbours(k, layers, &params.skins) else { return Vec::new() };
    let along = skin_turn(k).0;
    let raster = params.rasters.skin(along);
    let covered =
        |p: Point| around.iter().all(|rows| holds(&rows.skin(along).cover, p, raster.pitch));
    let is_covered = |wall: &Wall| {
        let line: Vec<Point> = wall.path.iter().map(|&p| raster.frame.enter(p)).collect();
        places(&line, raster.pitch).all(covered)
    };
    inner.filter(|(_, wall)| is_covered(wall)).map(|(index, _)| index).collect()
}

fn nearest_row(v: Coord, pitch: Coord) -> i32 {
    nearest(f64::from(v) / f64::from(pitch)) as i32
}

/// Whether the row nearest to a place holds it.
fn holds(rows: &Rows, p: Point, pitch: Coord) -> bool {
    rows.span_at(nearest_row(p.y, pitch), p.x).is_some()
}

/// Places on `line`, at most `step` apart.
pub(super) fn places(line: &[Point], step: Coord) -> impl Iterator<Item = Point> {
    line.windows(2).flat_map(move |w| {
        let (from, to) = (w[0], w[1]);
        let steps = (from.distance(to) / f64::from(step)).ceil().at_least(1.0) as i64;
        let on = move |a: Coord, b: Coord, k: i64| a + (i64::from(b - a) * k / steps) as Coord;
        (0..=steps).map(move |k| Point { x: on(from.x, to.x, k), y: on(from.y, to.y, k) })
    })
}
