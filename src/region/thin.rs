//! Contours -> contours: inner walls without the places that are too thin for both of their passes.
//!
//! An inner wall is a loop. Where the room inside the wall around it is hardly wider than a
//! line, it would run out and back on itself: two beads in the room of one. There the loop is
//! left out, and [`super::strips`] gives the room one bead. Parts with a single wall are left
//! as they are.

use super::params::WallParams;
use super::wall_samples::SINGLE;
use crate::geom::spans::{Rows, Span};
use crate::geom::{Contour, edges, polygon};
use crate::units::{Coord, nearest};

/// Thin places of a loop shorter than this many line widths are left in it: they are corners,
/// or hardly longer than the shortest bead.
const SHORT: f64 = 5.0;

/// Loops are compared, and cut off, so much larger (2 µm), against rounding.
const ROUNDING: Coord = 20;

/// Whether some of the layer whose inside two crossing rasters show may be so thin. The question
/// is cheap: a thin place longer than a few lines gives a short span on two neighbouring rows
/// of one of the two rasters.
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

/// The loops of an inner wall without the places where their passes are too near to each other.
#[must_use]
pub fn open(loops: Vec<Contour>, params: &WallParams) -> Vec<Contour> {
    let half = (params.least_apart() / 2).max(1);
    let short = SHORT * f64::from(params.line_width);
    // Both passes of a thin place would meet, or vanish.
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
    /// How far apart both passes of an inner wall are at least: with a line's width more there
    /// is room for two beads where one would be too wide.
    fn least_apart(&self) -> Coord {
        nearest((SINGLE - 1.0) * f64::from(self.line_width)) as Coord
    }

    /// Inset at which the room inside `walls` walls vanishes when one bead can fill it.
    pub(super) fn inset_of_narrow(&self, walls: u32) -> Coord {
        self.inset_of(walls + 1) + self.least_apart() / 2
    }
}
