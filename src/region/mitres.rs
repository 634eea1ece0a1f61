//! Walls -> Ways beside their sharp corners: where loops reach further inwards than the rows' inset.
//!
//! Rows are inset by an exact distance, so that around a corner that sticks into the part they end on an
//! arc. Loops are inset with mitres: their corners lie beyond that arc, at a right angle and three walls by
//! a whole line. Without this, lines would end on the loop.

use super::params::{RegionParams, WallParams};
use super::scan::around_in_part;
use super::walls::Wall;
use crate::geom::raster::Raster;
use crate::geom::segment::{along, dot, way};
use crate::geom::spans::Rows;
use crate::geom::{Point, side};
use crate::units::{Bounded as _, nearest};

/// How far beyond the arc a corner may lie, in line widths (20 µm). A smaller value looks at each corner of
/// a polygon that stands for a circle.
const BEYOND: f64 = 0.05;

/// How far along the loop a corner may matter, in insets: a mitre is up to √3 long on each side, and where it is
/// cut off, the corners of the cut lie within it. A larger value only costs time.
const FAR: f64 = 2.0;

/// A way along a loop, from a corner on.
pub type Way = (Point, Point);

/// The ways along the innermost loops of `walls` beside corners that lie beyond the rows' inset.
#[must_use]
pub fn mitres(walls: &[Wall], params: &WallParams) -> Vec<Way> {
    let mut ways = Vec::new();
    for wall in walls.iter().filter(|wall| wall.closed && wall.depth + 1 == params.count) {
        let [.., mut before, mut corner] = wall.path[..] else { continue };
        for &next in &wall.path {
            // The solid is on the left: a corner that sticks into it is a turn to the right.
            if side(before, corner, next) < 0 {
                beside([before, corner, next], params, &mut ways);
            }
            (before, corner) = (corner, next);
        }
    }
    ways
}

/// Adds the ways on both sides of a corner, if it lies far beyond the arc.
fn beside([before, corner, next]: [Point; 3], params: &WallParams, ways: &mut Vec<Way>) {
    let real = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let (from, to) = (way(real(corner), real(before)), way(real(corner), real(next)));
    let (far, near) = (dot(from, from).sqrt(), dot(to, to).sqrt());
    // Of half the turn; the contour turns by the same.
    let cosine = -dot(from, to) / (far * near);
    let cosine_of_half = f64::midpoint(1.0, cosine).at_least(0.0).sqrt();
    let inset = f64::from(params.inset_of(params.count));
    if inset * (1.0 - cosine_of_half) <= BEYOND * f64::from(params.line_width) * cosine_of_half {
        return;
    }
    let reach = FAR * inset;
    for (arm, length) in [(from, far), (to, near)] {
        let [x, y] = along(real(corner), (reach / length).at_most(1.0), arm);
        ways.push((corner, Point { x: nearest(x) as i32, y: nearest(y) as i32 }));
    }
}

/// What `mitres` take from the rows of `raster`: the middles of lines keep as far from them as from walls.
#[must_use]
pub fn taken(mitres: &[Way], raster: Raster, params: &RegionParams) -> Rows {
    let radius = params.beads.wall_to_fill;
    around_in_part(mitres.iter().map(|&(p, q)| (p, q, radius)), raster)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::segment::distance2;
    use crate::geom::{Contour, edges};
    use crate::profile;
    use crate::region::prepare::prepare;
    use crate::slice::Layer;
    use crate::units::{sin_cos, to_units};
    use proptest::prelude::*;

    /// A hole with `corners` of a regular polygon, 6 mm from its middle to each, in a block.
    fn holed(corners: usize, degrees: f64) -> Vec<Contour> {
        let p = |x: f64, y: f64| Point { x: to_units(x), y: to_units(y) };
        let corner = |k: usize| {
            let (sin, cos) = sin_cos(degrees - 360.0 * k as f64 / corners as f64);
            p(6.0 * cos, 6.0 * sin)
        };
        let block = vec![p(-15.0, -15.0), p(15.0, -15.0), p(15.0, 15.0), p(-15.0, 15.0)];
        vec![block, (0..corners).map(corner).collect()]
    }

    proptest! {
        #[test]
        fn lines_end_no_nearer_to_a_corner_of_a_loop_than_to_its_sides(
            corners in 3..9_usize, degrees in 0.0..90.0_f64, walls in 1..6_u32
        ) {
            let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
            settings.walls = walls;
            let params = RegionParams::new(&settings);
            let contours = holed(corners, degrees);
            let layer = Layer { index: 0, z: 2_000, height: 2_000, contours, closed_gap: 0 };
            let (own, rows) = prepare(layer, &params);
            let real = |p: Point| [f64::from(p.x), f64::from(p.y)];
            let loops: Vec<_> = own.walls.iter().filter(|w| w.depth + 1 == walls).collect();
            prop_assert!(!loops.is_empty());
            // 20 µm for what is left to arcs, and rounding.
            let least = f64::from(params.beads.wall_to_fill) - 210.0;
            for r in 0..2 {
                let raster = params.rasters.skin(r);
                for (j, row) in rows.skin(r).fill.iter() {
                    for u in row.iter().flat_map(|span| [span.start, span.end]) {
                        let end = real(raster.frame.leave(Point { x: u, y: j * raster.pitch }));
                        for (p, q) in loops.iter().flat_map(|wall| edges(&wall.path)) {
                            let away = distance2(end, [real(p), real(q)]).sqrt();
                            prop_assert!(away > least, "{} at {:?}", away, end);
                        }
                    }
                }
            }
        }
    }
}
