//! Mesh and layers -> Curved: the patches of non-planar skin, for the stages that leave room for them and print them.

use super::lift::Lift;
use crate::mesh::place::Placed;
use crate::nonplanar::base::Base;
use crate::nonplanar::find::Surfaces;
use crate::nonplanar::patch::{Patch, Patches};
use crate::plan::PrintMove;
use crate::profile::Settings;
use crate::region::curved::CurvedTops;
use crate::region::window::Support;
use crate::report::nonplanar::{self, NonPlanarReport};
use crate::slice::Slicer;
use crate::units::{Coord, to_mm, to_units};

/// The surfaces of a mesh, and the patches on them.
pub struct Found {
    surfaces: Surfaces,
    patches: Patches,
}

impl Found {
    /// What is told of them, on a print that is lifted by a raft.
    #[must_use]
    pub fn report(&self, lift: &Lift) -> NonPlanarReport {
        nonplanar::report(&self.patches, (lift.layers(), to_mm(lift.by())))
    }
}

/// The patches of a job, if it asks for any.
#[must_use]
pub fn find(
    settings: &Settings,
    placed: &Placed,
    slicer: &Slicer<'_>,
    support: Option<&Support>,
) -> Option<Found> {
    let _ = (settings, placed, slicer, support);
    None
}

/// Patches, and what is left of the layers below them.
pub struct Curved<'a> {
    patches: &'a Patches,
    base: Base<'a>,
    /// Whether travels to patches pull the filament back.
    retracts: bool,
}

impl<'a> Curved<'a> {
    /// The patches on these `surfaces`.
    #[must_use]
    pub fn new(found: &'a Found, settings: &Settings) -> Self {
        let Found { surfaces, patches } = found;
        let height = to_units(settings.layer_height);
        Self {
            patches,
            base: patches.base(surfaces, height),
            retracts: settings.retraction.length > 0.0,
        }
    }

    /// For the layers below the patches.
    #[must_use]
    pub fn tops(&self) -> &dyn CurvedTops {
        &self.base
    }

    /// What is printed after the paths of layer `k`, in its order.
    #[must_use]
    pub fn after(&self, k: usize) -> Vec<PrintMove> {
        let moves = |patch: &'a Patch| {
            patch.strokes.iter().map(|stroke| PrintMove {
                retract: self.retracts && stroke.over > 0,
                over: stroke.over,
                patch: Some(patch.number),
                ..PrintMove::to(stroke.path.clone())
            })
        };
        self.patches.after(k).flat_map(moves).collect()
    }

    /// The highest place of all patches above the bed, grid units; 0 without any.
    #[must_use]
    pub fn highest(&self) -> Coord {
        self.patches.patches.iter().map(|patch| patch.bounds[1]).max().unwrap_or(0)
    }
}
