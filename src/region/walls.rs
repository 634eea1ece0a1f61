//! Contours -> Walls: loops parallel to the contours, one line width apart.

use super::Params;
use crate::geom::{Contour, double_area, polygon};
use crate::units::{Coord, UNITS_PER_MM};

/// One closed wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    /// The middle of its bead, solid on the left.
    pub path: Contour,
    /// Counted from the outside; 0 is the outer wall.
    pub depth: u32,
}

/// The walls of `contours`, from the outside inwards. Where the part is too thin
/// for a wall there is none.
#[must_use]
pub fn walls(contours: &[Contour], params: &Params) -> Vec<Wall> {
    let mut walls = Vec::new();
    let mut ring = contours.to_vec();
    for depth in 0..params.walls {
        let distance = if depth == 0 { params.outer_inset } else { params.line_width };
        if distance > 0 {
            ring = polygon::inset(&ring, distance);
        }
        walls.extend(ring.iter().map(|path| Wall { path: path.clone(), depth }));
    }
    walls
}

/// The area of `contours` that is too thin for the outer wall, mm²: what their
/// area has more than the walls' area and the strip of half a wall around them.
/// Corners make it a little too large, by about the square of the inset each.
#[must_use]
pub fn thin_area(contours: &[Contour], walls: &[Wall], inset: Coord) -> f64 {
    let area = |c: &Contour| double_area(c) as f64 / 2.0;
    let length = |c: &Contour| -> f64 {
        c.iter().zip(c.iter().cycle().skip(1)).map(|(a, b)| a.distance(*b)).sum()
    };
    let whole: f64 = contours.iter().map(area).sum();
    let outer = walls.iter().filter(|w| w.depth == 0);
    let walled: f64 = outer.map(|w| area(&w.path) + length(&w.path) * f64::from(inset)).sum();
    ((whole - walled) / (UNITS_PER_MM * UNITS_PER_MM)).max(0.0)
}
