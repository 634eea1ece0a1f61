//! Paths -> Toolpaths: in which order a layer's paths are printed, and how the nozzle gets to each.
//!
//! An *island* is one outer contour with all that is printed inside it. Paths are divided among
//! islands ([`order::Unordered`]), put in an order ([`mod@order`]), and runs of them are reordered
//! where that saves time ([`tour`]). Each then says whether the filament is pulled back on the
//! way to it ([`travel`]). Nothing here depends on what a path is for beyond its role's
//! [`Place`](crate::fill::Place).
//!
//! Guaranteed to the next stage: every path comes once, in the order of printing.

pub mod order;
mod params;
pub mod tour;
pub mod travel;

pub use params::PlanParams;

use crate::fill::Path;
use crate::geom::Point;
use crate::slice::Layer;
use crate::units::Coord;

/// A path and how the nozzle gets to it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PrintMove {
    /// The filament is pulled back on the way.
    pub retract: bool,
    /// The path.
    pub path: Path,
}

/// All that is printed on one layer, in order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Toolpath {
    /// The layer, counted from 0.
    pub layer: usize,
    /// Top of the layer above the bed, grid units.
    pub z: Coord,
    /// Height of the layer, grid units.
    pub height: Coord,
    /// Where the head comes from.
    pub from: Head,
    /// What is printed.
    pub moves: Vec<PrintMove>,
}

/// Where the head is after some layers, and what it must not hit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Head {
    /// Where the nozzle is on the bed, if known.
    pub at: Option<Point>,
    /// The highest place that was printed so far above the bed, grid units. Lower than the
    /// next layer unless a path rose above its own.
    pub highest: Coord,
}

impl Head {
    /// Where the head is once `paths` of `layer` are printed as well.
    #[must_use]
    pub fn after(self, layer: &Layer, paths: &[Path]) -> Self {
        let risen = paths.iter().flat_map(|path| &path.points).map(|p| layer.z + p.z).max();
        Self {
            at: paths.last().map(Path::end).or(self.at),
            highest: risen.map_or(self.highest, |risen| risen.max(self.highest)),
        }
    }
}
