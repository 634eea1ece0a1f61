//! Contours -> contours: inner walls without the places that are too thin for both of their passes.
//!
//! An inner wall is a loop. Where the room for it is hardly wider than a line, the loop would run
//! out and back on itself: two beads in the room of one, up to a third too much plastic. There the
//! loop is cut off, and [`super::strips`] gives the room one bead. Parts with a single wall are
//! not changed.

use super::params::WallParams;
use super::wall_samples::SINGLE;
use crate::geom::spans::{Rows, Span};
use crate::geom::{Contour, edges, polygon};
use crate::units::{Coord, nearest};

/// Shorter thin places stay in a loop, in line widths: they are corners, or hardly longer than the
/// shortest bead. With a smaller value corners lose their wall; with a larger one short thin
/// places get too much plastic.
const SHORT: f64 = 5.0;

/// Loops are grown by this (2 µm) before they are compared or cut, so that rounding to the grid
/// leaves no slivers along their edges.
const ROUNDING: Coord = 20;

/// Whether a layer may have such thin places, given its inside on two crossing rasters. This is a
/// cheap test to skip most layers: a thin place longer than a few lines has short spans on two
/// neighbouring rows of at least one raster.
#[must_use]
pub fn may_be_thin(insides: [&Rows; 2], params: &WallParams) -> bool {
    let limit = f64::from(2 * params.inset_of_narrow(params.count)) * std::f64::consts::SQRT_2;
    let is_short = |s: &&Span| (s.len() as f64) < limit;
    params.count > 1
        && insides.iter().any(|rows| {
            rows.iter().any(|(j, row)| {
                let next = rows.row(j + 1);
                let mut short = row.iter().filter(is_short);
                short.any(|a| next.iter().filter(is_short).any(|b| a.overlaps(*b)))
            })
        })
}

/// Cuts off the places where two passes of an inner wall are too near to each other.
#[must_use]
pub fn open(loops: Vec<Contour>, params: &WallParams) -> Vec<Contour> {
    let half = (params.least_apart() / 2).max(1);
    let short = SHORT * f64::from(params.line_width);
    // Shrunk by half, the passes of a thin place would meet or vanish. If none do, nothing is thin.
    if polygon::keep_shape(&loops, half, short) {
        return loops;
    }
    let opened = polygon::outset(&polygon::inset(&loops, half), half + ROUNDING);
    let mut thin = polygon::difference(&loops, &opened, ROUNDING);
    thin.retain(|c| edges(c).map(|(p, q)| p.distance(q)).sum::<f64>() >= 2.0 * short);
    if thin.is_empty() {
        return loops;
    }
    polygon::difference(&loops, &polygon::outset(&thin, ROUNDING), 2 * ROUNDING)
}

impl WallParams {
    /// Minimum distance of the two passes of an inner wall. Their room is one line width more: at
    /// this distance it reaches the width from which one bead is too wide ([`SINGLE`]).
    fn least_apart(&self) -> Coord {
        nearest((SINGLE - 1.0) * f64::from(self.line_width)) as Coord
    }

    /// Inset at which the room inside `walls` walls vanishes when one bead can fill it.
    pub(super) fn inset_of_narrow(&self, walls: u32) -> Coord {
        self.inset_of(walls + 1) + self.least_apart() / 2
    }
}
