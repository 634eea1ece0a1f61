//! Mesh -> Layers: where the planes of a print cut the mesh.
//!
//! Every layer is cut at half its height. A vertex on the plane counts as above
//! it: then each triangle either crosses a plane or does not, each closed mesh
//! gives closed contours, and no case is special. Guaranteed to the next stage:
//! contours are closed, do not cross, run counter-clockwise around solid and
//! clockwise around holes, and keep within the stated tolerance of the mesh.

mod chain;
mod heights;
mod simplify;
pub mod volume;

pub use chain::Slicer;
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
    /// What the plane cuts out of the mesh.
    pub contours: Vec<Contour>,
    /// The longest gap that had to be closed by a straight line, grid units; 0 if none.
    pub closed_gap: Coord,
}

impl Layer {
    /// What the contours enclose over the layer's height, mm³.
    #[must_use]
    pub fn volume_mm3(&self) -> f64 {
        let area: i128 = self.contours.iter().map(|contour| double_area(contour)).sum();
        area as f64 / 2.0 * f64::from(self.height) / UNITS_PER_MM.powi(3)
    }
}
