//! Surface and outline -> Paths: the lines of one skin.

use super::params::NonPlanarParams;
use super::surface::Surface;
use crate::fill::Path;
use crate::geom::{Contour, Point};
use crate::units::Coord;

/// What a skin is laid on.
pub trait Base: Sync {
    /// How high plastic stands at a place, grid units above the bed.
    fn height(&self, at: Point) -> f64;
}

/// Where a skin lies.
#[derive(Debug)]
pub struct Skin<'a> {
    /// The surface that it follows.
    pub surface: &'a Surface,
    /// Its outline in plan.
    pub area: &'a [Contour],
    /// How far below the surface its top lies, grid units.
    pub lowered: Coord,
    /// The top of the layer that it is printed after, grid units above the bed.
    pub layer_top: Coord,
    /// Direction of its lines, degrees.
    pub direction: f64,
}

/// The paths of a skin, in the order of printing. The z of their points is relative to `layer_top`, their
/// height is the room between the base and the skin.
#[must_use]
pub fn paths(_skin: &Skin<'_>, _base: &dyn Base, _params: &NonPlanarParams) -> Vec<Path> {
    todo!()
}
