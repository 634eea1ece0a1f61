//! What the pass gives: patches with their paths, and how much of the top they cover.

use super::base::{Base, Lowered};
use super::params::NonPlanarParams;
use super::surface::find::Surfaces;
use super::tally::Areas;
use crate::fill::Path;
use crate::geom::{Contour, Point};
use crate::units::Coord;

/// A path of a skin, and how high the travel to it goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// The path; z relative to the top of the patch's layer.
    pub path: Path,
    /// The travel to it goes at least so high above the bed; 0 where the straight way is clear.
    pub over: Coord,
}

/// A piece of a surface that is printed as skins. Grid units.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Its number in the order of printing, counted from 1.
    pub number: u32,
    /// Its surface, by the order of [`Surfaces::surfaces`].
    pub surface: usize,
    /// It is printed after the paths of this layer.
    pub layer: usize,
    /// The top of that layer above the bed.
    pub top: Coord,
    /// Where each skin lies in plan, from the lowest up; each within the next.
    pub areas: Vec<Vec<Contour>>,
    /// Its paths in the order of printing.
    pub strokes: Vec<Stroke>,
    /// Its lowest and its highest corner in plan.
    pub extent: [Point; 2],
    /// Its lowest and its highest z above the bed.
    pub bounds: [Coord; 2],
    /// Its steepest slope, degrees.
    pub steepest: f64,
    /// Direction of the lines of each skin, from the lowest up, degrees.
    pub directions: Vec<f64>,
    /// What of the piece is skin, and why the rest is none.
    pub mm2: Areas,
}

/// The patches of a print.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Patches {
    /// In the order of printing.
    pub patches: Vec<Patch>,
    /// Of all tops: skin, level, and why the rest is flat.
    pub mm2: Areas,
}

impl Patches {
    /// What is left of the layers under the patches; `params` are those they were made with.
    #[must_use]
    pub fn base<'a>(&self, surfaces: &'a Surfaces, params: &NonPlanarParams) -> Base<'a> {
        let (height, raised) = (params.height, params.raised());
        let lowered = |patch: &Patch| {
            let surface = surfaces.surfaces.get(patch.surface)?;
            let (areas, grown) = (patch.areas.clone(), params.outline.max(0));
            Some(Lowered { surface, areas, height, raised, grown, beyond: params.beyond })
        };
        Base::new(self.patches.iter().filter_map(lowered).collect())
    }
}
