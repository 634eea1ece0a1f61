//! Contours -> Strips: where a part is too thin for both passes of an inner wall, and one bead has to do.
//!
//! An inner wall is a loop. Where the room inside the wall around it is hardly wider than a
//! line, it would go out and back on itself: two beads in the room of one. There the loop is
//! left out, and the room gets one bead as wide as it is, which [`super::wall_beads`] lays like that
//! in a thin strip of skin. The room inside the innermost wall is filled in the same way where
//! it is too thin for infill. Parts with a single wall are left as they are.

use super::scan::Scan;
use super::wall_samples::SINGLE;
use super::walls::Wall;
use super::{Params, PreparedRows};
use crate::geom::spans::{Rows, Span};
use crate::geom::{Contour, edges, polygon};
use crate::units::{Coord, nearest};

/// Thin places of a loop shorter than this many line widths are left in it: they are corners,
/// or hardly longer than the shortest bead.
const SHORT: f64 = 5.0;

/// Loops are compared, and cut off, so much larger (2 µm), against rounding.
const ROUNDING: Coord = 20;

/// The room inside one of the walls, on the two rasters of skins.
#[derive(Debug, Clone)]
pub struct Strip {
    /// Where a bead inside that wall may run.
    pub room: [Rows; 2],
    /// What of it is too thin for two beads, and has no part of the next wall.
    pub narrow: [Rows; 2],
}

/// Whether some of the layer that `scans` holds may be so thin. It costs little to ask: a thin
/// place that is longer than a few lines is crossed by two rows of one of two crossing rasters
/// in a short way.
#[must_use]
pub fn may_be_thin(scans: &[Scan], params: &Params) -> bool {
    let limit = f64::from(2 * params.inset_of_narrow(params.walls)) * std::f64::consts::SQRT_2;
    let is_short = |s: &&Span| (s.len() as f64) < limit;
    params.inner_walls
        && scans.iter().take(2).map(Scan::inside).any(|rows| {
            rows.iter().any(|(j, row)| {
                let next = rows.row(j + 1);
                let mut short = row.iter().filter(is_short);
                short.any(|a| next.iter().filter(is_short).any(|b| a.overlaps(*b)))
            })
        })
}

/// For each of `walls`, from the outside inwards, the room inside it; that inside the last is
/// what `rows` have for lines.
#[must_use]
pub fn strips(
    scans: &[Scan],
    walls: &[Wall],
    rows: &[PreparedRows],
    params: &Params,
) -> Vec<Strip> {
    (1..=params.walls)
        .map(|depth| {
            let next = walls.iter().filter(|w| w.depth == depth);
            let next: Vec<Contour> = next.map(|w| w.path.clone()).collect();
            let inset = params.within(depth).fill_inset;
            let room = [0, 1].map(|r| match depth == params.walls {
                true => rows[r].fill.clone(),
                false => scans[r].inset(inset),
            });
            let narrow = [0, 1].map(|r| {
                if depth < params.walls {
                    apart(&room[r], Scan::new(&next, params.rasters[r]).inside())
                } else {
                    apart(&room[r], &scans[r].inset(params.inset_of_narrow(depth)))
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

/// The loops of an inner wall without the places where their passes are too near to each other.
#[must_use]
pub fn open(loops: Vec<Contour>, params: &Params) -> Vec<Contour> {
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

impl Params {
    /// How far apart both passes of an inner wall are at least: with a line's width more there
    /// is room for two beads where one would be too wide.
    fn least_apart(&self) -> Coord {
        nearest((SINGLE - 1.0) * f64::from(self.line_width)) as Coord
    }

    /// How far from the contour nothing is left where a bead inside so many walls fills the room.
    fn inset_of_narrow(&self, walls: u32) -> Coord {
        self.outer_inset + walls as Coord * self.line_width + self.least_apart() / 2
    }

    /// The same for the strips within so many of the walls, at least one.
    #[must_use]
    pub fn within(&self, walls: u32) -> Self {
        let fill_inset =
            self.outer_inset + (walls as Coord - 1) * self.line_width + self.wall_to_fill();
        Self { walls, fill_inset, only_strips: true, ..self.clone() }
    }
}
