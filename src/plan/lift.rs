//! Settings -> Lift: how far a raft lifts the print, and the toolpaths that it lifts.
//!
//! Everything up to the toolpaths is planned as if the part stood on the bed, so that its paths and
//! the groups of dual injection are those of a print without a raft. Only then they are lifted.

use super::Toolpath;
use crate::fill::adhesion::raft::RaftParams;
use crate::fill::{Path, Place};
use crate::profile::Settings;
use crate::units::{Coord, to_units};

/// How far a raft lifts the print; not at all without one.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Lift {
    /// Heights of the raft's layers, from the bed upwards, grid units.
    pub heights: Vec<Coord>,
    /// Between the raft and the part, grid units.
    pub gap: Coord,
    /// How much of it support and skirt fill, which stand on the raft, grid units: their first beads are
    /// higher by that, and never higher than the nozzle is wide.
    pub filled: Coord,
}

impl Lift {
    /// How far the raft that `settings` ask for lifts the print.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        RaftParams::new(settings).map_or_else(Self::default, |raft| Self {
            heights: raft.heights().collect(),
            gap: raft.gap(),
            filled: (to_units(settings.machine.nozzle_diameter - settings.first_layer_height))
                .clamp(0, raft.gap()),
        })
    }

    /// Layers of the raft.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.heights.len()
    }

    /// From the bed to the bottom of the part, grid units.
    #[must_use]
    pub fn by(&self) -> Coord {
        self.heights.iter().sum::<Coord>() + self.gap
    }

    /// Lifts toolpaths that were planned on the bed. What is no part of the model reaches down to the
    /// raft: support is thrown away with it, and has to stand until then.
    pub fn raise(&self, toolpaths: &mut [Toolpath]) {
        if self.layers() == 0 {
            return;
        }
        for toolpath in toolpaths {
            let stands = |path: &Path| {
                path.role.facts().place == Place::Helper
                    && path.layers as usize == toolpath.layer + 1
            };
            let paths = toolpath.moves.iter_mut().map(|next| &mut next.path);
            for path in paths.filter(|path| stands(path)) {
                path.points.iter_mut().for_each(|point| point.height += self.filled);
            }
            let over = toolpath.moves.iter_mut().map(|next| &mut next.over);
            over.filter(|over| **over > 0).for_each(|over| *over += self.by());
            toolpath.layer += self.layers();
            toolpath.z += self.by();
            toolpath.from.highest += self.by();
        }
    }
}
