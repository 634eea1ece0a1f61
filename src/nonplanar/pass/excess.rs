//! Surface and widths of lines -> where the head touches no line on it, told at a glance.
//!
//! The *excess* of a line is what it may stand over its surface: on a slope across it, half its width times the
//! slope. A head that is clear of a surface higher by that is clear of all lines on it.

use super::glance::{Glance, Under};
use super::touch::mm;
use crate::geom::boxes::extent;
use crate::geom::{Contour, side};
use crate::nonplanar::field::Field;
use crate::nonplanar::grid::{self, CELL, Spot};
use crate::nonplanar::params::NonPlanarParams;
use crate::nonplanar::skin::WIDEST;
use crate::nonplanar::surface::Surface;
use crate::units::{Coord, to_mm};
use std::sync::OnceLock;

/// Slopes change over half a line: the excess is this many times what it is on a plane.
const BENT: f64 = 1.1;

/// Widths of lines, in line widths, for which it is told at a glance what is clear of them.
const WIDTHS: [f64; 4] = [1.05, 1.25, 1.5, WIDEST];

/// A surface that is higher by the excess of its lines, at a glance, for each of [`WIDTHS`]; once it is asked for.
#[derive(Debug, Default)]
pub(super) struct OfLines([OnceLock<Higher>; WIDTHS.len()]);

impl OfLines {
    /// For lines up to this width, grid units.
    pub(super) fn up_to(
        &self,
        width: Coord,
        piece: (&Field, &[Contour]),
        params: &NonPlanarParams,
    ) -> &Higher {
        let wide = |share: f64| share * f64::from(params.line_width);
        let last = WIDTHS.len() - 1;
        let k = WIDTHS.iter().position(|share| f64::from(width) <= wide(*share)).unwrap_or(last);
        self.0[k].get_or_init(|| Higher::new(piece, wide(WIDTHS[k]).max(f64::from(width)), params))
    }
}

/// A surface that is higher by the excess of its lines.
#[derive(Debug)]
pub(super) struct Higher {
    glance: Option<Glance>,
    /// The largest excess, mm.
    excess: f64,
}

impl Higher {
    /// Over the area of a piece, of lines of this width, grid units.
    fn new((field, area): (&Field, &[Contour]), width: f64, params: &NonPlanarParams) -> Self {
        let (from, to) = extent(area.iter().flatten()).unwrap_or_default();
        let floor = |v: Coord| v.div_euclid(CELL) - 1;
        let (low, high) = ([floor(from.x), floor(from.y)], [floor(to.x) + 3, floor(to.y) + 3]);
        let [columns, rows] =
            [0, 1].map(|axis| usize::try_from(high[axis] - low[axis]).unwrap_or(0));
        let half = BENT * mm(width) / 2.0;
        let mut heights = vec![f32::NEG_INFINITY; columns * rows];
        let (mut excess, mut range) = (0.0_f64, [f64::MAX, f64::MIN]);
        for [x, y] in grid::spots(&grid::cells(area), CELL) {
            let Some((z, [along, across])) = field.plane([x, y]) else { continue };
            let (z, own) = (mm(z), half * along.hypot(across));
            excess = excess.max(own);
            range = [range[0].min(z), range[1].max(z + own)];
            let at = [x - low[0], y - low[1]].map(|v| usize::try_from(v).unwrap_or(0));
            heights[at[1] * columns + at[0]] = (z + own) as f32;
        }
        let under = under(params, range[1] - range[0] + to_mm(CELL), excess);
        Self { glance: under.map(|under| Glance::new(low, columns, heights, under)), excess }
    }

    /// Whether a tip on the surface over a cell, or as far below it as its lines are, certainly touches none of
    /// these. The surface lies at `z`, mm.
    pub(super) fn is_clear(&self, cell: Spot, z: f64) -> bool {
        let glance = self.glance.as_ref();
        glance.is_some_and(|glance| glance.is_clear(cell, z + self.excess))
    }
}

/// The cone below a head that lays lines with this excess on a surface that rises by no more than `most`, mm.
fn under(params: &NonPlanarParams, most: f64, excess: f64) -> Option<Under> {
    Under::pressing(&params.head, to_mm(params.height), most, Some(excess))
}

/// Whether a surface is so gentle that no line on it, up to this width, grid units, is ever in the way. Its straight
/// ways have to lie on it.
pub(super) fn is_gentle(surface: &Surface, width: Coord, params: &NonPlanarParams) -> bool {
    let [contour] = surface.outline() else { return false };
    let corner = |k: usize| contour[k % contour.len()];
    let turns_left = |k: usize| side(corner(k), corner(k + 1), corner(k + 2)) >= 0;
    let slope = libm::tan(surface.steepest().to_radians());
    let excess = BENT * mm(f64::from(width)) / 2.0 * slope;
    let most = to_mm(surface.bounds()[1] - surface.bounds()[0]) + excess;
    under(params, most, excess).is_some_and(|under| slope <= under.rise)
        && (0..contour.len()).all(turns_left)
}
