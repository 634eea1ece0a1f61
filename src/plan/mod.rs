//! Paths -> Toolpaths: sorts a layer's paths for printing, and decides how travels go.
//!
//! 1. [`order::Unordered`] divides paths among islands. An *island* is one outer contour with
//!    everything that is printed inside it.
//! 2. [`mod@order`] sorts the paths of each island, nearest first. Where walls begin, `seam` says.
//! 3. [`tour`] reorders runs of them where that saves time.
//! 4. [`travel`] decides for each path how the travel to it goes: straight or round a corner, with or
//!    without a retraction.
//!
//! Of a path's role only its [`Order`](crate::fill::Order) matters here.
//!
//! Guaranteed to the next stage: every path comes once, in the order of printing.

mod crossings;
mod detour;
mod marks;
mod next;
pub mod order;
mod params;
mod seam;
pub mod tour;
pub mod travel;
mod wipe;

pub use params::PlanParams;
pub use seam::Seams;

use crate::fill::Path;
use crate::geom::Point;
use crate::slice::Layer;
use crate::units::Coord;

/// A path, and how the travel to it goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PrintMove {
    /// The travel to the path retracts.
    pub retract: bool,
    /// Once the filament is pulled back, the nozzle first goes to these points, at the height where
    /// it is.
    pub wipe: Vec<Point>,
    /// The travel goes over these points.
    pub via: Vec<Point>,
    /// The travel rises at least so high above the bed before it goes sideways, grid units; 0 where nothing
    /// is in its way. From one path of a patch to the next it says all: elsewhere travels rise above
    /// everything that is printed in any case.
    pub over: Coord,
    /// The path is one of this patch of non-planar skin.
    pub patch: Option<u32>,
    /// The path.
    pub path: Path,
}

impl PrintMove {
    /// A path with a straight travel to it that does not retract.
    #[must_use]
    pub fn to(path: Path) -> Self {
        Self { retract: false, wipe: Vec::new(), via: Vec::new(), over: 0, patch: None, path }
    }
}

/// The paths of one layer in the order of printing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Toolpath {
    /// The layer, counted from 0.
    pub layer: usize,
    /// Top of the layer above the bed, grid units.
    pub z: Coord,
    /// Height of the layer, grid units.
    pub height: Coord,
    /// Where the nozzle is before this layer.
    pub from: Nozzle,
    /// The paths.
    pub moves: Vec<PrintMove>,
}

/// Where the nozzle is after some layers, and the height of what it must not hit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Nozzle {
    /// Position of the nozzle, if known.
    pub at: Option<Point>,
    /// The greatest z printed so far, and over patches of non-planar skin the clearance more; grid units
    /// above the bed. It is below the next layer unless a path rose above its own layer.
    pub highest: Coord,
}

impl Nozzle {
    /// The nozzle once `paths` of `layer` are printed as well.
    #[must_use]
    pub fn after(self, layer: &Layer, paths: &[Path]) -> Self {
        self.once(layer.z, paths, 0)
    }

    /// The nozzle once the paths of a patch are printed as well, over which travels keep the `clearance`.
    /// `z` is the top of the layer that they are printed on. Grid units.
    #[must_use]
    pub fn after_patch(self, z: Coord, paths: &[Path], clearance: Coord) -> Self {
        self.once(z, paths, clearance)
    }

    fn once(self, z: Coord, paths: &[Path], clearance: Coord) -> Self {
        let points = paths.iter().flat_map(|path| &path.points);
        let risen = points.map(|p| z + p.z + clearance).max();
        Self {
            at: paths.last().map(Path::end).or(self.at),
            highest: risen.map_or(self.highest, |risen| risen.max(self.highest)),
        }
    }
}
