//! Contours and walls -> area: what is too thin to be printed.

use super::Wall;
use crate::geom::boxes::Around;
use crate::geom::{Contour, Point, double_area};
use crate::region::params::WallParams;
use crate::units::{Coord, UNITS_PER_MM};

/// Limit for the tangent of half a turn, when the strip outside a wall is computed. The offset cuts
/// off sharper corners, so what is outside of them is not printed. A larger value misses thin
/// tips; a smaller one counts every acute corner as thin.
const SHARPEST_CORNER: f64 = 1.75;

/// What an inset may lose, in squares of a line: the tips of sharp corners. A larger value leaves out
/// short fins; a smaller one only costs time.
const LEAST: f64 = 0.5;

/// The area of `contours` that `walls` leave open outside the outer loops, mm². It is their area
/// less that of the loops with a strip of the inset around them. The strip around a polygon has
/// the area `P·d + d²·Σ tan(φ/2)`, with perimeter `P`, inset `d` and turns `φ`. The result is 0
/// without walls, or with the wall on the contour, and less than nothing where loops hold too much. Loops must
/// have their nominal inset.
pub(super) fn outside_loops(contours: &[Contour], loops: &[Wall], params: &WallParams) -> f64 {
    if params.count == 0 || params.outer_inset == 0 {
        return 0.0;
    }
    let outer = loops.iter().filter(|w| w.depth == 0).map(|w| &w.path);
    outside(contours, outer, params.outer_inset) / (UNITS_PER_MM * UNITS_PER_MM)
}

/// Whether something is too thin for an inset: `inner`, which are those of `outer` by `distance`, with
/// a strip as wide around them do not make up `outer`.
pub(super) fn loses(
    (outer, inner): (&[Contour], &[Contour]),
    distance: Coord,
    params: &WallParams,
) -> bool {
    let line = f64::from(params.line_width);
    outside(outer, inner.iter(), distance) > LEAST * line * line
}

/// The area of `contours` that lies beyond a strip as wide as `distance` around `insets`, in square
/// grid units.
fn outside<'a>(
    contours: &[Contour],
    insets: impl Iterator<Item = &'a Contour>,
    distance: Coord,
) -> f64 {
    let d = f64::from(distance);
    let area = |c: &Contour| double_area(c) as f64 / 2.0;
    let strip = |c: &Contour| {
        let (length, turns) = length_and_turns(c);
        length * d + turns * d * d
    };
    let whole: f64 = contours.iter().map(area).sum();
    whole - insets.map(|c| area(c) + strip(c)).sum::<f64>()
}

/// The islands that a wall lies in. Some corners of it may lie outside.
fn around_of(wall: &Wall, around: &Around<'_>) -> impl Iterator<Item = usize> {
    let around = |p: &Point| Some(around.of(*p).collect::<Vec<_>>()).filter(|all| !all.is_empty());
    wall.path.iter().find_map(around).unwrap_or_default().into_iter()
}

/// The area of those of several islands of which nothing is printed, mm².
pub(super) fn bare(contours: &[Contour], walls: &[Wall]) -> f64 {
    let islands = || contours.iter().enumerate().filter(|(_, c)| double_area(c) > 0);
    if islands().nth(1).is_none() {
        return 0.0;
    }
    let around = Around::new(islands());
    let mut bare: Vec<bool> = contours.iter().map(|c| double_area(c) > 0).collect();
    walls.iter().flat_map(|wall| around_of(wall, &around)).for_each(|k| bare[k] = false);
    let lost = contours.iter().zip(bare).filter(|(_, bare)| *bare);
    lost.map(|(c, _)| double_area(c) as f64 / 2.0).sum::<f64>() / (UNITS_PER_MM * UNITS_PER_MM)
}

/// The area that single beads cover, mm², with a half circle at each end.
pub(super) fn under_beads(beads: &[Wall]) -> f64 {
    let area = |bead: &Wall| {
        let sides = bead.path.windows(2).zip(bead.widths.iter().skip(1));
        let sides: f64 = sides.map(|(p, &w)| p[0].distance(p[1]) * f64::from(w)).sum();
        let ends = bead.widths.first().zip(bead.widths.last());
        let ends = ends
            .filter(|_| !bead.closed)
            .map_or(0, |(&a, &b)| i64::from(a).pow(2) + i64::from(b).pow(2));
        sides + ends as f64 * std::f64::consts::PI / 8.0
    };
    beads.iter().filter(|b| b.depth == 0).map(area).sum::<f64>() / (UNITS_PER_MM * UNITS_PER_MM)
}

/// The perimeter of a polygon, and the sum of the tangents of half its turns; left turns are
/// positive.
fn length_and_turns(contour: &Contour) -> (f64, f64) {
    let n = contour.len();
    let edge = |k: usize| {
        let (a, b) = (contour[k % n], contour[(k + 1) % n]);
        (f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y), a.distance(b))
    };
    (0..n).fold((0.0, 0.0), |(length, turns), k| {
        let ((ax, ay, a), (bx, by, b)) = (edge(k), edge(k + 1));
        let half = (ax * by - ay * bx) / (a * b + ax * bx + ay * by).max(f64::MIN_POSITIVE);
        (length + a, turns + half.clamp(-SHARPEST_CORNER, SHARPEST_CORNER))
    })
}
