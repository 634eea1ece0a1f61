//! What is exposed on the rows of a skin -> what of it the raster across misses.
//!
//! A strip that is narrower than the distance of lines and runs along them may lie between two of them. Then
//! the rows across, which carry the skin, see it, and the others do not: solid infill would be printed through
//! the skin. So what of it no line of the other raster crosses is brought to the nearest ones.

use super::rooms;
use super::scan::around;
use crate::geom::Point;
use crate::geom::raster::{Raster, crossed};
use crate::geom::spans::{Rows, Span};
use crate::units::Coord;

/// How far around it a narrow strip is brought to other lines, in quarters of their distance. Half of it reaches
/// the nearest one just so; a larger value makes skin wider.
const REACH: Coord = 3;

/// What of `exposed`, rows of `its`, lies between two lines of another `raster`; `None` if nothing does.
#[must_use]
pub fn missed(exposed: &Rows, its: Raster, raster: Raster) -> Option<Rows> {
    let enter = |u: Coord, j: i32| {
        let at = Point { x: u, y: j * its.pitch };
        raster.frame.enter(its.frame.leave(at)).y
    };
    let is_missed = |(j, span): &(i32, Span)| {
        let (a, b) = (enter(span.start, *j), enter(span.end, *j));
        crossed(a.min(b), a.max(b), raster.pitch).is_empty()
    };
    let spans = exposed.iter().flat_map(|(j, row)| row.iter().map(move |span| (j, *span)));
    let short = spans.filter(|(_, span)| span.len() < i64::from(2 * raster.pitch));
    let missed: Vec<(i32, Span)> = short.filter(is_missed).collect();
    if missed.is_empty() {
        return None;
    }
    let mut edges = rooms::edges(missed.into_iter(), its, raster);
    edges.iter_mut().for_each(|(_, _, radius)| *radius = REACH * raster.pitch / 4);
    Some(around(&edges, raster))
}
