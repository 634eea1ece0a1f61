//! Settings -> Lift: how far a raft lifts the print.

use super::raft::RaftParams;
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
}
