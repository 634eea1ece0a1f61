//! Surface -> the sides of its rim beside which the part ends upright: no top goes on there.

use super::Surface;
use crate::geom::{Contour, Point, polygon};
use crate::units::{Coord, nearest};

impl Surface {
    /// The same, with the sides of its rim beside which the part ends upright.
    pub(super) fn with_upright(self, upright: Vec<[Point; 2]>) -> Self {
        Self { upright, ..self }
    }

    /// The sides of its rim beside which the part ends upright, in plan: no top goes on there.
    #[must_use]
    pub fn upright(&self) -> &[[Point; 2]] {
        &self.upright
    }

    /// What lies so near to where the part ends upright, on both sides, in plan; square at its ends.
    #[must_use]
    pub fn near_upright(&self, by: Coord) -> Vec<Contour> {
        let around = |[a, b]: &[Point; 2]| {
            let length = a.distance(*b);
            if length == 0.0 {
                return None;
            }
            let along = |d: Coord| nearest(f64::from(by) * f64::from(d) / length) as Coord;
            let [dx, dy] = [along(b.x - a.x), along(b.y - a.y)];
            let corner = |p: &Point, u: Coord, v: Coord| Point {
                x: p.x + u * dx - v * dy,
                y: p.y + u * dy + v * dx,
            };
            Some(vec![corner(a, -1, -1), corner(b, 1, -1), corner(b, 1, 1), corner(a, -1, 1)])
        };
        polygon::union(&self.upright.iter().filter_map(around).collect::<Vec<_>>())
    }
}
