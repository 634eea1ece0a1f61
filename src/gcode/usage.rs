//! Moves -> Usage: sums lengths and filament, and converts filament to volume, weight and price.

use super::flow::Flows;
use super::moves::{Kind, Moves};
use super::reshaped::{Arced, Short, SlopeFeeds};
use crate::fill::{Both, RoleTable};
use crate::profile::Settings;
use crate::units::Coord;

/// Path and filament extruded for one role.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Used {
    /// Length of path, mm.
    pub length: f64,
    /// Filament, mm.
    pub filament: f64,
}

/// Path, travels and filament of a layer or of a print.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Usage {
    /// What was extruded, by role.
    pub roles: RoleTable<Both<Used>>,
    /// Number of travels.
    pub travels: usize,
    /// Length of all travels, mm.
    pub travel_length: f64,
    /// Number of travels that retract.
    pub retractions: usize,
    /// Plastic flow, and feeds that the flow limit lowered.
    pub flows: Flows,
    /// Lines that are written as arcs.
    pub arced: Arced,
    /// Lines shorter than the printer can be fed.
    pub short: Short,
    /// What holds the feeds of lines on slopes down.
    pub slopes: SlopeFeeds,
    /// The greatest z of the nozzle while it prints, grid units above the bed.
    pub highest: Coord,
}

impl Usage {
    /// The usage of one layer.
    #[must_use]
    pub fn of(layer: &Moves) -> Self {
        let lines = layer.arcs.iter().map(|arc| arc.lines).sum();
        let arced = Arced { arcs: layer.arcs.len(), lines };
        let flows = layer.flows.clone();
        let (short, slopes) = (layer.short, layer.slopes);
        let mut usage = Self { flows, arced, short, slopes, ..Self::default() };
        let beads = layer.moves.iter().filter(|step| matches!(step.kind, Kind::Extrude(_)));
        usage.highest = match layer.risen.is_empty() {
            true => layer.z,
            false => beads.map(|step| step.z).max().unwrap_or_default(),
        };
        let mut on_its_way = false;
        for step in &layer.moves {
            match step.kind {
                Kind::Extrude(bead) => {
                    on_its_way = false;
                    let used = usage.roles[bead.role].of_mut(bead.thick);
                    used.length += step.length;
                    used.filament += step.filament;
                }
                Kind::Travel => {
                    // A travel may have corners.
                    usage.travels += usize::from(!on_its_way);
                    on_its_way = true;
                    usage.travel_length += step.length;
                }
                Kind::Retract => usage.retractions += 1,
                Kind::Restore | Kind::Z | Kind::Wait(_) => {}
            }
        }
        usage
    }

    /// Total filament, mm.
    #[must_use]
    pub fn filament(&self) -> f64 {
        self.roles.iter().flat_map(|(_, both)| [both.thin.filament, both.thick.filament]).sum()
    }

    /// Adds another layer's usage.
    pub fn add(&mut self, other: &Self) {
        for (role, theirs) in other.roles.iter() {
            for (thick, theirs) in theirs.iter() {
                let mine = self.roles[role].of_mut(thick);
                mine.length += theirs.length;
                mine.filament += theirs.filament;
            }
        }
        self.travels += other.travels;
        self.travel_length += other.travel_length;
        self.retractions += other.retractions;
        self.flows.add(&other.flows);
        self.arced.arcs += other.arced.arcs;
        self.arced.lines += other.arced.lines;
        self.short.add(&other.short);
        self.slopes.add(&other.slopes);
        self.highest = self.highest.max(other.highest);
    }
}

/// An amount of filament in the units in which it is sold.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Material {
    /// Length, mm.
    pub mm: f64,
    /// Volume, cm³.
    pub cm3: f64,
    /// Weight, g.
    pub grams: f64,
    /// Price, in the currency of `filament.cost`, if that is set.
    pub cost: Option<f64>,
}

impl Material {
    /// Converts `mm` of the filament in `settings`.
    #[must_use]
    pub fn new(mm: f64, settings: &Settings) -> Self {
        let cm3 = mm * settings.filament_area() / 1000.0;
        let grams = cm3 * settings.filament.density;
        let per_kg = settings.filament.cost;
        Self { mm, cm3, grams, cost: (per_kg > 0.0).then_some(per_kg * grams / 1000.0) }
    }
}
