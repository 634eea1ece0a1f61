//! Mesh -> Surfaces: the tops of a part that slope gently, each in one piece and with one height at each place.

use crate::geom::{Contour, Point};
use crate::units::Coord;

/// A piece of the part's top, with one height over each place of its outline. Grid units.
#[derive(Debug)]
pub struct Surface {}

impl Surface {
    /// Its outline in plan, outer contours counter-clockwise, as from [`crate::geom::polygon::union`].
    #[must_use]
    pub fn outline(&self) -> &[Contour] {
        todo!()
    }

    /// Its height over a place, grid units; `None` beside it.
    #[must_use]
    pub fn z(&self, _at: Point) -> Option<f64> {
        todo!()
    }

    /// How it rises along x and along y at a place; `None` beside it.
    #[must_use]
    pub fn slope(&self, _at: Point) -> Option<[f64; 2]> {
        todo!()
    }

    /// Where it is lower than `below` and not lower than `from`, in plan, as from a union.
    #[must_use]
    pub fn between(&self, _from: Coord, _below: Coord) -> Vec<Contour> {
        todo!()
    }

    /// Where the straight way from `a` to `b` crosses its edges: the share of the way and the height,
    /// grid units, in order. The ends are among them, if they lie on the surface.
    #[must_use]
    pub fn profile(&self, _a: Point, _b: Point) -> Vec<(f64, f64)> {
        todo!()
    }
}
