//! What is exposed on the rows of a skin -> the same on other rasters, with what lies between their lines.
//!
//! A strip that is narrower than the distance of lines and runs along them may lie between two of them. Then
//! the rows across, which carry the skin, see it, and the others do not: they would print infill through the
//! skin. So what of it no line of another raster crosses is brought to the nearest ones.

use super::rooms;
use super::scan::around;
use crate::geom::raster::{Raster, crossed};
use crate::geom::spans::{Rows, Span};
use crate::units::Coord;
use std::borrow::Cow;

/// How far around it a narrow strip is brought to other lines, in quarters of their distance. Half of it reaches
/// the nearest one just so; a larger value makes skin wider.
const REACH: Coord = 3;

/// What of `exposed`, rows of `its`, lies between two lines of another `raster`; `None` if nothing does.
#[must_use]
pub fn missed(exposed: &Rows, its: Raster, raster: Raster) -> Option<Rows> {
    let enter = |u: Coord, j: i32| {
        let at = crate::geom::Point { x: u, y: j * its.pitch };
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

/// What is exposed on a `raster` whose lines run inside `fill`, with what only `exposed`, rows of `its`, tell.
#[must_use]
pub fn with_missed<'a>(
    own: Cow<'a, Rows>,
    (raster, fill): (Raster, &Rows),
    (its, exposed): (Raster, &Rows),
) -> Cow<'a, Rows> {
    match missed(exposed, its, raster) {
        Some(missed) => Cow::Owned(own.or(&missed.and(fill))),
        None => own,
    }
}
