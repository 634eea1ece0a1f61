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
    /// The centre line of its bead, with the solid on the left.
    pub path: Contour,
    /// Counted from the outside; 0 is the outer wall.
    pub depth: u32,
    /// How many layers it is printed for: this one and those below it.
    pub layers: u32,
}

/// The walls of `contours`, from the outside inwards. Where the part is too thin for a wall, there
/// is none. If the layer `may_be_thin`, inner walls are cut off where their two passes do not fit.
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

/// Walls of two layers are printed at once if they are at most this fraction (one tenth) of a
/// line's width apart. A larger distance lets thick walls hang over or leave gaps to the outer
/// wall on slopes; a smaller one shares nothing but upright walls.
const ALIKE: i32 = 10;

/// For each wall of each layer of `block`, the number of layers it is printed for: 0 if a layer
/// above prints it. The outer wall is always for its own layer. An inner one continues in a wall
/// of the next layer that runs along it.
#[must_use]
pub fn share(
    block: &Block,
    layers: &[&[Wall]],
    grouping: &Grouping,
    params: &WallParams,
) -> Vec<Vec<u32>> {
    let tolerance = params.line_width / ALIKE;
    let mut out: Vec<Vec<u32>> = layers.iter().map(|walls| vec![1; walls.len()]).collect();
    for n in 1..layers.len() {
        let k = block.layers.start + n;
        for (i, wall) in layers[n].iter().enumerate().filter(|(_, w)| w.depth > 0) {
            if grouping.ends(grouping.wall_phase(wall.depth), k - 1, block) {
                continue;
            }
            let continues = |&j: &usize| {
                let below = &layers[n - 1][j];
                out[n - 1][j] > 0
                    && below.depth == wall.depth
                    && follow(&below.path, &wall.path, tolerance)
            };
            if let Some(j) = (0..layers[n - 1].len()).find(continues) {
                out[n][i] += std::mem::take(&mut out[n - 1][j]);
            }
        }
    }
    out
}

/// Limit for the tangent of half a turn, when the strip outside a wall is computed. The offset cuts
/// off sharper corners, so what is outside of them is not printed. A larger value misses thin
/// tips; a smaller one counts every acute corner as thin.
const SHARPEST_CORNER: f64 = 1.75;

/// The area of `contours` that is too thin for the outer wall, mm². It is their area less that of
/// the walls with a strip of the inset around them. The strip around a polygon has the area
/// `P·d + d²·Σ tan(φ/2)`, with perimeter `P`, inset `d` and turns `φ`. The result is 0 without
/// walls, or with the wall on the contour.
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
