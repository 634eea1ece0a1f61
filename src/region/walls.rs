//! Contours -> Walls: loops parallel to the contours, one line width apart.

use super::dual::groups::{Block, Grouping};
use super::params::WallParams;
use super::thin;
use crate::geom::follow::follow;
use crate::geom::{Contour, double_area, polygon};
use crate::units::UNITS_PER_MM;

/// One closed wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    /// The middle of its bead, solid on the left.
    pub path: Contour,
    /// Counted from the outside; 0 is the outer wall.
    pub depth: u32,
    /// How many layers it is printed for: this one and those below it.
    pub layers: u32,
}

/// The walls of `contours`, from the outside inwards. Where the part is too thin
/// for a wall there is none; nor for an inner wall's two passes, if it `may_be_thin`.
#[must_use]
pub fn walls(contours: &[Contour], may_be_thin: bool, params: &WallParams) -> Vec<Wall> {
    let mut walls = Vec::new();
    let mut ring = contours.to_vec();
    for depth in 0..params.count {
        let distance = if depth == 0 { params.outer_inset } else { params.line_width };
        if distance > 0 {
            ring = polygon::inset(&ring, distance);
        }
        if depth > 0 && may_be_thin {
            ring = thin::open(ring, params);
        }
        walls.extend(ring.iter().map(|path| Wall { path: path.clone(), depth, layers: 1 }));
    }
    walls
}

/// Walls of two layers are printed at once if they are no further apart than one part
/// in so many of a line's width.
const ALIKE: i32 = 10;

/// For each wall of each layer of `block`, how many layers it is printed for: none if a
/// layer above prints it. The outer wall is for its own layer; an inner one goes on in
/// that of the next layer which runs along it.
#[must_use]
pub fn share(
    block: &Block,
    layers: &[&[Wall]],
    grouping: &Grouping,
    params: &WallParams,
) -> Vec<Vec<u32>> {
    let far = params.line_width / ALIKE;
    let mut out: Vec<Vec<u32>> = layers.iter().map(|walls| vec![1; walls.len()]).collect();
    for n in 1..layers.len() {
        let k = block.layers.start + n;
        for (i, wall) in layers[n].iter().enumerate().filter(|(_, w)| w.depth > 0) {
            if grouping.ends(grouping.wall_phase(wall.depth), k - 1, block) {
                continue;
            }
            let goes_on = |&j: &usize| {
                let below = &layers[n - 1][j];
                out[n - 1][j] > 0
                    && below.depth == wall.depth
                    && follow(&below.path, &wall.path, far)
            };
            if let Some(j) = (0..layers[n - 1].len()).find(goes_on) {
                out[n][i] += std::mem::take(&mut out[n - 1][j]);
            }
        }
    }
    out
}

/// Corners of a wall sharper than this (half the turn's tangent) are cut off by the
/// offset: what is outside of them is a thin place.
const SHARPEST_CORNER: f64 = 1.75;

/// The area of `contours` that is too thin for the outer wall, mm²: what they have
/// more than the walls with a strip of the inset around them. The strip around a
/// polygon has the area `P·d + d²·Σ tan(φ/2)` with perimeter `P` and turns `φ`.
/// Nothing is too thin for no wall, or for one on the contour.
#[must_use]
pub fn thin_area(contours: &[Contour], walls: &[Wall], params: &WallParams) -> f64 {
    if params.count == 0 || params.outer_inset == 0 {
        return 0.0;
    }
    let d = f64::from(params.outer_inset);
    let area = |c: &Contour| double_area(c) as f64 / 2.0;
    let strip = |c: &Contour| {
        let (length, turns) = length_and_turns(c);
        length * d + turns * d * d
    };
    let whole: f64 = contours.iter().map(area).sum();
    let outer = walls.iter().filter(|w| w.depth == 0);
    let walled: f64 = outer.map(|w| area(&w.path) + strip(&w.path)).sum();
    ((whole - walled) / (UNITS_PER_MM * UNITS_PER_MM)).max(0.0)
}

/// The perimeter of a polygon and the sum of the tangents of half its turns, left positive.
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
