//! What makes two files unequal: each kind of finding with its measures.
//!
//! Words used here: a *finding* is one cause, told once; a *kind* sorts findings by what spoils a
//! print most; the *weight* sorts those of a kind, by how far, how much or how long.
//!
//! Layers are counted from 1; 0 is what comes before the first, and no layer is what comes after the
//! last line. Places are as the file has them. The JSON form is stable: kinds and fields may be
//! added, and none changes its meaning.

use super::PartMoved;
use super::codes::{CodeDifference, Setting};
use super::pair::Flow;
use super::place::Place;
use super::sums::{Both, Sum};
use crate::reader::Role;
use schemars::JsonSchema;
use serde::Serialize;

/// One of the two files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum File {
    /// The first.
    A,
    /// The second.
    B,
}

/// What a sum is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Way of the nozzle, mm.
    Length,
    /// Filament, mm.
    Filament,
    /// s.
    Time,
    /// Time at the feeds that the file asks for, s.
    AskedTime,
}

/// What is in another order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Ordered {
    /// Lines.
    Lines,
    /// Travels alone.
    Travels,
}

/// Something that makes two files unequal. Layers are counted from 1; 0 is what comes before
/// the first.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Finding {
    /// Layers that the other file does not have.
    LayersOnlyIn {
        /// The file that has them.
        file: File,
        /// Which ones.
        layers: Vec<usize>,
        /// Length of their lines, mm.
        length_mm: f64,
    },
    /// The print as a whole lies elsewhere in the second file. All else is compared as if it did not.
    Moved {
        /// How far, in x, y and z, mm.
        by_mm: [f64; 3],
    },
    /// A part of a plate lies elsewhere in the second file. All else is compared as if it did not.
    PartMoved(PartMoved),
    /// Layers at other heights.
    Heights {
        /// How many.
        count: usize,
        /// The one that differs most.
        layer: Both<usize>,
        /// Its height of the nozzle, mm.
        z_mm: Both<f64>,
    },
    /// Commands for heaters differ.
    Heaters {
        /// In this layer; `None` is after the last line.
        layer: Option<Both<usize>>,
        /// What.
        difference: CodeDifference,
    },
    /// Other commands differ.
    Commands {
        /// In this layer; `None` is after the last line.
        layer: Option<Both<usize>>,
        /// What.
        difference: CodeDifference,
    },
    /// Limits of the machine, such as accelerations, or long waits that only one file sets.
    Limits {
        /// What, and the first line of the file.
        difference: CodeDifference,
    },
    /// Lines of a role that the other file has nowhere in the same layer.
    RoleOnlyIn {
        /// The file that has them.
        file: File,
        /// Their role.
        #[schemars(with = "String")]
        role: Role,
        /// In these of its layers.
        layers: Vec<usize>,
        /// Of these patches of non-planar skin.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        patches: Vec<u32>,
        /// Their length, mm.
        length_mm: f64,
    },
    /// Lines where the other file has none of their role.
    Lines {
        /// In this layer.
        layer: Both<usize>,
        /// Their role.
        #[schemars(with = "String")]
        role: Role,
        /// The patch of non-planar skin that they are of.
        #[serde(skip_serializing_if = "Option::is_none")]
        patch: Option<Both<Option<u32>>>,
        /// Length of all lines of the role there, mm.
        length_mm: Both<f64>,
        /// Length that is farther than the tolerance from the other file's lines, mm.
        far_mm: Both<f64>,
        /// The farthest place.
        farthest: Place,
    },
    /// Lines in the same place with another amount of filament.
    Flow {
        /// In this layer.
        layer: Both<usize>,
        /// Their role.
        #[schemars(with = "String")]
        role: Role,
        /// The patch of non-planar skin that they are of.
        #[serde(skip_serializing_if = "Option::is_none")]
        patch: Option<Both<Option<u32>>>,
        /// Their length, mm.
        unlike_mm: Both<f64>,
        /// The two that differ most.
        most_unlike: Flow,
    },
    /// A sum that differs where no other finding explains it.
    Sum {
        /// In this layer; `None` for the whole file.
        layer: Option<Both<usize>>,
        /// Of this role; `None` for all together.
        #[schemars(with = "Option<String>")]
        role: Option<Role>,
        /// What is summed up.
        quantity: Quantity,
        /// The sums.
        sum: Sum,
    },
    /// The nozzle goes, without a line, where it does not in the other file.
    Travels {
        /// On the way to this layer or in it; `None` is after the last line.
        layer: Option<Both<usize>>,
        /// Length of all travels there, mm.
        length_mm: Both<f64>,
        /// Length that is farther than the tolerance from the other file's travels, mm.
        far_mm: Both<f64>,
        /// Lowest and highest z of them, mm.
        z_mm: Both<Option<[f64; 2]>>,
        /// The farthest place.
        farthest: Place,
    },
    /// Walls begin elsewhere, though their lines are the same.
    Seams {
        /// The kind of wall.
        #[schemars(with = "String")]
        role: Role,
        /// In these layers of the first file.
        layers: Vec<usize>,
        /// How many walls.
        moved: Both<usize>,
        /// The layer with the one that is farthest.
        layer: Both<usize>,
        /// Where it begins.
        farthest: Place,
    },
    /// Filament is pulled back, or pushed out again, by other amounts.
    Retractions {
        /// In these layers of the first file.
        layers: Vec<usize>,
        /// The first of them; `None` is after the last line.
        layer: Option<Both<usize>>,
        /// What is pulled back there, mm.
        pulled_mm: Both<f64>,
        /// What is pushed out there without a line, mm.
        pushed_mm: Both<f64>,
    },
    /// Retractions whose length only the printer knows (G10, G11) are not as many.
    FirmwareRetractions {
        /// How many, back and forth.
        count: Both<u64>,
    },
    /// The same things in another order: travels, or lines, whose travels are others then.
    Order {
        /// Which.
        of: Ordered,
        /// In these layers of the first file.
        layers: Vec<usize>,
        /// The first of them; `None` is after the last line.
        layer: Option<Both<usize>>,
        /// The file's lines there, from which on.
        line: Both<u32>,
        /// The place of all these layers that is farthest from the other file's travels.
        farthest: Option<Place>,
    },
    /// A setting in the comments, where they have to be the same.
    Setting(Setting),
}

/// Kinds of findings, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// [`Finding::LayersOnlyIn`].
    Layers,
    /// [`Finding::Moved`] and [`Finding::PartMoved`].
    Moved,
    /// [`Finding::Heights`].
    Heights,
    /// [`Finding::Heaters`].
    Heaters,
    /// [`Finding::RoleOnlyIn`].
    Roles,
    /// [`Finding::Lines`].
    Lines,
    /// [`Finding::Flow`].
    Flow,
    /// [`Finding::Sum`] of a layer.
    LayerSum,
    /// [`Finding::Travels`].
    Travels,
    /// [`Finding::Commands`].
    Commands,
    /// [`Finding::Limits`].
    Limits,
    /// [`Finding::Retractions`] and [`Finding::FirmwareRetractions`].
    Retractions,
    /// [`Finding::Seams`].
    Seams,
    /// [`Finding::Order`].
    Order,
    /// [`Finding::Sum`] of the file.
    FileSum,
    /// [`Finding::Setting`].
    Setting,
}

impl Finding {
    /// Its worst place, if it has one, mm.
    #[must_use]
    pub fn at_mm(&self) -> Option<[f64; 3]> {
        match self {
            Self::Lines { farthest, .. }
            | Self::Travels { farthest, .. }
            | Self::Seams { farthest, .. } => Some(farthest.at_mm),
            Self::Order { farthest, .. } => farthest.map(|place| place.at_mm),
            Self::Flow { most_unlike, .. } => Some(most_unlike.at_mm),
            _ => None,
        }
    }

    /// The layers where it is to be seen best, the worst first; none where it is in no layer.
    #[must_use]
    pub fn layers(&self) -> Vec<Both<Option<usize>>> {
        let both = |layer: &Both<usize>| Both { a: Some(layer.a), b: Some(layer.b) };
        match self {
            Self::LayersOnlyIn { file, layers, .. } | Self::RoleOnlyIn { file, layers, .. } => {
                let own = |number: usize| match file {
                    File::A => Both { a: Some(number), b: None },
                    File::B => Both { a: None, b: Some(number) },
                };
                layers.first().copied().map(own).into_iter().collect()
            }
            Self::Heights { layer, .. }
            | Self::Lines { layer, .. }
            | Self::Flow { layer, .. }
            | Self::Seams { layer, .. } => vec![both(layer)],
            Self::Heaters { layer, .. }
            | Self::Commands { layer, .. }
            | Self::Sum { layer, .. }
            | Self::Travels { layer, .. }
            | Self::Retractions { layer, .. }
            | Self::Order { layer, .. } => layer.iter().map(both).collect(),
            Self::PartMoved(_) => vec![Both { a: Some(1), b: Some(1) }],
            Self::Moved { .. }
            | Self::Limits { .. }
            | Self::FirmwareRetractions { .. }
            | Self::Setting(_) => Vec::new(),
        }
    }

    /// Of what kind it is.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::LayersOnlyIn { .. } => Kind::Layers,
            Self::Moved { .. } | Self::PartMoved(_) => Kind::Moved,
            Self::Limits { .. } => Kind::Limits,
            Self::Heights { .. } => Kind::Heights,
            Self::Heaters { .. } => Kind::Heaters,
            Self::RoleOnlyIn { .. } => Kind::Roles,
            Self::Lines { .. } => Kind::Lines,
            Self::Flow { .. } => Kind::Flow,
            Self::Sum { layer: Some(_), .. } => Kind::LayerSum,
            Self::Travels { .. } => Kind::Travels,
            Self::Commands { .. } => Kind::Commands,
            Self::Retractions { .. } | Self::FirmwareRetractions { .. } => Kind::Retractions,
            Self::Seams { .. } => Kind::Seams,
            Self::Order { .. } => Kind::Order,
            Self::Sum { layer: None, .. } => Kind::FileSum,
            Self::Setting(_) => Kind::Setting,
        }
    }

    /// How bad it is among those of its kind: a distance in mm, where there is one, and then
    /// a length in mm or a share.
    pub(super) fn weight(&self) -> [f64; 2] {
        match self {
            Self::LayersOnlyIn { length_mm, .. } | Self::RoleOnlyIn { length_mm, .. } => {
                [*length_mm, 0.0]
            }
            Self::Lines { far_mm, farthest, .. } | Self::Travels { far_mm, farthest, .. } => {
                [farthest.distance_mm, far_mm.a.max(far_mm.b)]
            }
            Self::Seams { farthest, .. } => [farthest.distance_mm, 0.0],
            Self::Flow { most_unlike: Flow { filament_per_mm: flow, .. }, unlike_mm, .. } => {
                let share = (flow.a - flow.b).abs() / flow.a.max(flow.b);
                [share, unlike_mm.a.max(unlike_mm.b)]
            }
            Self::Sum { sum, .. } => [sum.share(), 0.0],
            Self::PartMoved(PartMoved { by_mm: [x, y], .. }) => [x.hypot(*y), 0.0],
            Self::Moved { .. }
            | Self::Limits { .. }
            | Self::Heights { .. }
            | Self::Retractions { .. }
            | Self::FirmwareRetractions { .. }
            | Self::Order { .. }
            | Self::Heaters { .. }
            | Self::Commands { .. }
            | Self::Setting(_) => [0.0; 2],
        }
    }
}
