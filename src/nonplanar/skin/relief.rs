//! What the lines of a skin must know of its surface and of what they are laid on.
//!
//! Skins ask of a surface only this. So tests can lay them on surfaces of known formulas.

use crate::geom::Point;
use crate::nonplanar::surface::Surface;
use std::fmt::Debug;

/// A surface with one height over each place. Grid units.
pub trait Relief: Debug + Sync {
    /// Its height over a place; `None` beside it.
    fn z(&self, at: Point) -> Option<f64>;

    /// How it rises along x and along y at a place; `None` beside it.
    fn slope(&self, at: Point) -> Option<[f64; 2]>;

    /// Where the straight way from `a` to `b` bends: the share of the way and the height, in order. The
    /// ends are among them, if they lie on the surface.
    fn profile(&self, a: Point, b: Point) -> Vec<(f64, f64)>;
}

impl Relief for Surface {
    fn z(&self, at: Point) -> Option<f64> {
        Self::z(self, at)
    }

    fn slope(&self, at: Point) -> Option<[f64; 2]> {
        Self::slope(self, at)
    }

    fn profile(&self, a: Point, b: Point) -> Vec<(f64, f64)> {
        Self::profile(self, a, b)
    }
}

/// What a skin is laid on.
pub trait Base: Sync {
    /// How high plastic stands at a place, grid units above the bed.
    fn height(&self, at: Point) -> f64;
}
