//! Contours <-> places: the cells of the pile, and the lattice of places where the head is tried.
//!
//! - A *cell* is a square of 0.1 mm; its middle lies at whole multiples of that. It is inside of an area
//!   if its middle is.
//! - A *place* is the middle of every second cell of every second row, 0.2 mm from the next: closer than
//!   0.25 mm, and each has the height of its cell.
//!
//! Refused places become an area: the squares around them grow by half a line, so that the lines beside
//! keep half a line more. Their staircase of sides is smoothed by no more than that.

use super::surface::rim::rim;
use crate::geom::decimate::{decimate, most_missed};
use crate::geom::frame::Frame;
use crate::geom::nest::Nest;
use crate::geom::raster::Raster;
use crate::geom::segment::distance2;
use crate::geom::spans::{Rows, Span};
use crate::geom::{Contour, Point, double_area, polygon};
use crate::region::scan::Scan;
use crate::units::{Coord, UNITS_PER_MM, to_mm};
use std::collections::BTreeSet;
use std::ops::Range;

/// Side of a cell.
pub(super) const CELL: Coord = 1_000;

/// Distance of places.
pub(super) const STEP: Coord = 2 * CELL;

/// Contours are simplified within this: 2 µm.
const TOLERANCE: Coord = 20;

/// A cell or a place by column and row, counted from the origin.
pub(super) type Spot = [i32; 2];

/// The rows of cells, or of places.
pub(super) fn raster(pitch: Coord) -> Raster {
    Raster { frame: Frame::new(0.0), pitch }
}

/// The cells inside of an area.
pub(super) fn cells(area: &[Contour]) -> Rows {
    Scan::new(area, raster(CELL)).inside().clone()
}

/// The places inside of an area that lie so far from its edge.
pub(super) fn places(area: &[Contour], inset: Coord) -> Vec<Spot> {
    spots(&Scan::new(area, raster(STEP)).inset(inset), STEP)
}

/// Columns whose middles lie in a span.
pub(super) fn columns(span: Span, pitch: Coord) -> Range<i32> {
    let up = |v: Coord| -(-v).div_euclid(pitch);
    up(span.start)..up(span.end)
}

/// The cells or places in rows.
pub(super) fn spots(rows: &Rows, pitch: Coord) -> Vec<Spot> {
    let mut out = Vec::new();
    for (j, row) in rows.iter() {
        for &span in row {
            out.extend(columns(span, pitch).map(|column| [column, j]));
        }
    }
    out
}

/// The cell in the middle of a place.
pub(super) fn cell_of([column, row]: Spot) -> Spot {
    [2 * column, 2 * row]
}

/// The cell around a point.
pub(super) fn cell_around(at: Point) -> Spot {
    let along = |v: Coord| (v + CELL / 2).div_euclid(CELL);
    [along(at.x), along(at.y)]
}

/// The column and the row of a cell or a place, counted from the lowest ones; `None` before these.
#[inline]
pub(super) fn counted([x, y]: Spot, low: Spot) -> Option<[usize; 2]> {
    Some([usize::try_from(x - low[0]).ok()?, usize::try_from(y - low[1]).ok()?])
}

/// The place nearest to a point, mm.
pub(super) fn place_at(at: [f64; 2]) -> Spot {
    at.map(|v| (v / to_mm(STEP)).round() as i32)
}

/// The middle of a cell, mm.
pub(super) fn middle(cell: Spot) -> [f64; 2] {
    cell.map(|v| f64::from(v) * to_mm(CELL))
}

/// The area around places, grown by half a line.
pub(super) fn around(places: &BTreeSet<Spot>, line_width: Coord) -> Vec<Contour> {
    let by = (line_width / 2 + STEP / 2) / STEP;
    let near = |[x, y]: &Spot| 4 * (x * x + y * y) <= (2 * by + 1) * (2 * by + 1);
    let disc: Vec<Spot> =
        (-by..=by).flat_map(|x| (-by..=by).map(move |y| [x, y])).filter(near).collect();
    let grown = |&[x, y]: &Spot| disc.iter().map(move |[dx, dy]| [x + dx, y + dy]);
    let squares: BTreeSet<Spot> = places.iter().flat_map(grown).collect();
    let half = STEP / 2;
    let corner = |[x, y]: Spot, dx: Coord, dy: Coord| Point { x: x * STEP + dx, y: y * STEP + dy };
    let square = |&at: &Spot| {
        [(-half, -half), (half, -half), (half, half), (-half, half)]
            .map(|(dx, dy)| corner(at, dx, dy))
    };
    let outline = rim(squares.iter().map(square));
    polygon::union(&outline.iter().map(smoothed).collect::<Vec<_>>())
}

/// A contour without the steps of its squares.
fn smoothed(contour: &Contour) -> Contour {
    let mm = |k: usize| {
        let p = contour[k % contour.len()];
        [to_mm(p.x), to_mm(p.y)]
    };
    // Halves are kept apart by their ends.
    let n = contour.len();
    let half = n / 2;
    let kept = |from: usize, to: usize| {
        let off = |a: usize, b: usize, k: usize| {
            distance2(mm(from + k), [mm(from + a), mm(from + b)]).sqrt()
        };
        let least = to_mm(STEP) * 0.99;
        decimate(to - from + 1, |a, b| most_missed(a, b, least, |k| off(a, b, k)))
            .into_iter()
            .map(move |k| from + k)
    };
    let mut all: Vec<usize> = kept(0, half).chain(kept(half, n).skip(1)).collect();
    all.pop();
    let out: Contour = all.into_iter().map(|k| contour[k]).collect();
    if out.len() < 3 { contour.clone() } else { out }
}

/// What is left of an area without another.
pub(super) fn without(area: &[Contour], other: &[Contour]) -> Vec<Contour> {
    if other.is_empty() { area.to_vec() } else { polygon::difference(area, other, TOLERANCE) }
}

/// An area without its places narrower than three lines; the same area if there are none.
pub(super) fn opened(area: &[Contour], line_width: Coord) -> Vec<Contour> {
    let core = polygon::inset(area, (line_width * 3 / 2).max(1));
    // Further out than they were moved in, so that all but narrow places keeps its outline.
    let around = polygon::outset(&core, line_width * 7 / 4);
    if core.is_empty() || polygon::difference(area, &around, TOLERANCE).is_empty() {
        return if core.is_empty() { Vec::new() } else { area.to_vec() };
    }
    polygon::intersection(area, &around)
}

/// The pieces of an area, each with its holes.
pub(super) fn pieces(area: &[Contour]) -> Vec<Vec<Contour>> {
    let nest = Nest::new(area);
    let piece = |k: usize| {
        let all = std::iter::once(k).chain(nest.within(Some(k)));
        all.map(|k| area[k].clone()).collect()
    };
    nest.outer().map(piece).collect()
}

/// Area in plan, mm².
pub(super) fn area_mm2(area: &[Contour]) -> f64 {
    let twice: i128 = area.iter().map(|contour| double_area(contour)).sum();
    twice as f64 / 2.0 / UNITS_PER_MM.powi(2)
}
