//! Mesh -> Layers: cuts the mesh with one horizontal plane for each layer.
//!
//! Every layer is cut at half its height. A vertex on the plane counts as above it. Then each triangle
//! either crosses a plane or does not, a closed mesh always gives closed contours, and no case is
//! special.
//!
//! Guaranteed to the next stage: contours are closed and do not cross. They run counter-clockwise
//! around solid and clockwise around holes, and stay within the given tolerance of the mesh.

mod chain;
mod compensate;
mod heights;
mod simplify;
pub mod volume;

pub use chain::Slicer;
pub use compensate::Compensation;
pub use heights::Heights;

use crate::geom::{Contour, double_area};
use crate::units::{Coord, UNITS_PER_MM};

/// One layer of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Counted from 0 at the bed.
    pub index: usize,
    /// Top of the layer above the bed, grid units.
    pub z: Coord,
    /// Height, grid units.
    pub height: Coord,
    /// The contours where the plane cuts the mesh.
    pub contours: Vec<Contour>,
    /// The longest gap in a contour that was closed by a straight line, grid units; 0 if none.
    pub closed_gap: Coord,
}

impl Layer {
    /// The volume that the contours enclose over the layer's height, mm³.
    #[must_use]
    pub fn volume_mm3(&self) -> f64 {
        let area: i128 = self.contours.iter().map(|contour| double_area(contour)).sum();
        area as f64 / 2.0 * f64::from(self.height) / UNITS_PER_MM.powi(3)
    }
}
