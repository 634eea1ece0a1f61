//! Outline of a skin -> Beads along its edge, and what they leave to the lines.

use super::runs::{Bead, Leg};
use crate::geom::decimate::{decimate, most_missed};
use crate::geom::segment::distance2;
use crate::geom::{Contour, Point, edges, polygon};
use crate::nonplanar::params::NonPlanarParams;
use crate::units::Coord;

/// Corners that miss the straight way by less are left out (10 µm): the edge of a skin may have one at
/// each step of the grid that it was found on.
const LEAST_CORNER: f64 = 100.0;

/// The beads along the edge of `area`, from the outside inwards, and the area within them.
pub(super) fn walls(area: &[Contour], params: &NonPlanarParams) -> (Vec<Bead>, Vec<Contour>) {
    let width = params.line_width;
    let mut beads = Vec::new();
    for k in 0..i32::try_from(params.wall).unwrap_or(0) {
        let middles = polygon::inset(area, k * width + width / 2);
        beads.extend(middles.iter().map(|middle| around(&simpler(middle), width)));
    }
    let taken = i32::try_from(params.wall).unwrap_or(0) * width;
    let rest = if taken > 0 { polygon::inset(area, taken) } else { area.to_vec() };
    (beads, rest)
}

/// A bead once around.
fn around(middle: &Contour, width: Coord) -> Bead {
    let widths = [f64::from(width); 2];
    edges(middle).map(|(from, to)| Leg { from, to, widths }).collect()
}

/// A contour without corners that hardly bend it.
fn simpler(contour: &Contour) -> Contour {
    let place = |k: usize| contour.get(k % contour.len()).copied().unwrap_or_default();
    let at = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let split = |a: usize, b: usize| {
        let way = [at(place(a)), at(place(b))];
        most_missed(a, b, LEAST_CORNER, |k| distance2(at(place(k)), way).sqrt())
    };
    let kept = decimate(contour.len() + 1, split);
    kept.into_iter().filter(|&k| k < contour.len()).map(place).collect()
}
