//! Difference -> Findings: what makes two files unequal, worst first.
//!
//! A cause is reported once, where it says most:
//! - layers that only one file has, and roles that only one file has in a layer, are one finding for
//!   all layers together, not one for each;
//! - layers at other heights likewise, with the one that differs most;
//! - lines that are far or unlike are a finding for each layer and role, with the worst place;
//! - a sum of a layer is a finding only if no line of it is: lines that are drawn twice lie nowhere
//!   else, and only their sum shows;
//! - sums of the file come last.
//!
//! Findings are sorted by [`Kind`], in the order of what spoils a print most, and in a kind by how
//! far, how much or how long. Their JSON form is stable.

use super::codes::{CodeDifference, Orders, Setting};
use super::pair::{Flow, PairOfLayers, Place, RoleOfPair};
use super::sums::{Both, Sum};
use super::{Difference, Tolerances};
use crate::reader::Role;
use serde::Serialize;

/// One of the two files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum File {
    /// The first.
    A,
    /// The second.
    B,
}

/// What a sum is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
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

/// Something that makes two files unequal. Layers are counted from 1; 0 is what comes before
/// the first.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// Lines of a role that the other file has nowhere in the same layer.
    RoleOnlyIn {
        /// The file that has them.
        file: File,
        /// Their role.
        role: Role,
        /// In these of its layers.
        layers: Vec<usize>,
        /// Their length, mm.
        length_mm: f64,
    },
    /// Lines where the other file has none of their role.
    Lines {
        /// In this layer.
        layer: Both<usize>,
        /// Their role.
        role: Role,
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
        role: Role,
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
        role: Option<Role>,
        /// What is summed up.
        quantity: Quantity,
        /// The sums.
        sum: Sum,
    },
    /// A setting in the comments, where they have to be the same.
    Setting(Setting),
}

/// Kinds of findings, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// [`Finding::LayersOnlyIn`].
    Layers,
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
    /// [`Finding::Commands`].
    Commands,
    /// [`Finding::Sum`] of the file.
    FileSum,
    /// [`Finding::Setting`].
    Setting,
}

impl Finding {
    /// Of what kind it is.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::LayersOnlyIn { .. } => Kind::Layers,
            Self::Heights { .. } => Kind::Heights,
            Self::Heaters { .. } => Kind::Heaters,
            Self::RoleOnlyIn { .. } => Kind::Roles,
            Self::Lines { .. } => Kind::Lines,
            Self::Flow { .. } => Kind::Flow,
            Self::Sum { layer: Some(_), .. } => Kind::LayerSum,
            Self::Commands { .. } => Kind::Commands,
            Self::Sum { layer: None, .. } => Kind::FileSum,
            Self::Setting(_) => Kind::Setting,
        }
    }

    /// How bad it is among those of its kind: a distance in mm, where there is one, and then
    /// a length in mm or a share.
    fn weight(&self) -> [f64; 2] {
        match self {
            Self::LayersOnlyIn { length_mm, .. } | Self::RoleOnlyIn { length_mm, .. } => {
                [*length_mm, 0.0]
            }
            Self::Lines { far_mm, farthest, .. } => [farthest.distance_mm, far_mm.a.max(far_mm.b)],
            Self::Flow { most_unlike: Flow { filament_per_mm: flow, .. }, unlike_mm, .. } => {
                let share = (flow.a - flow.b).abs() / flow.a.max(flow.b);
                [share, unlike_mm.a.max(unlike_mm.b)]
            }
            Self::Sum { sum, .. } => [sum.share(), 0.0],
            Self::Heights { .. }
            | Self::Heaters { .. }
            | Self::Commands { .. }
            | Self::Setting(_) => [0.0; 2],
        }
    }
}

/// What in this difference makes the files unequal, worst first.
pub(super) fn findings(difference: &Difference, tolerances: &Tolerances) -> Vec<Finding> {
    let mut found = Vec::new();
    for file in [File::A, File::B] {
        found.extend(only_in(file, &difference.pairs));
        let roles = Role::ALL.into_iter();
        found.extend(roles.filter_map(|role| role_only_in(file, role, &difference.pairs)));
    }
    found.extend(heights(&difference.pairs, tolerances.place));
    for pair in &difference.pairs {
        if let Both { a: Some(a), b: Some(b) } = pair.layer {
            of_layer(pair, Both { a, b }, &mut found);
        }
    }
    of_orders(&difference.end, None, &mut found);
    of_file(difference, &mut found);
    if tolerances.settings {
        found.extend(difference.settings.iter().cloned().map(Finding::Setting));
    }
    // Of equals the first in the file comes first: sorting keeps their order.
    found.sort_by(|a, b| {
        let ([a1, a2], [b1, b2]) = (a.weight(), b.weight());
        a.kind().cmp(&b.kind()).then(b1.total_cmp(&a1)).then(b2.total_cmp(&a2))
    });
    found
}

fn only_in(file: File, pairs: &[PairOfLayers]) -> Option<Finding> {
    let (mut layers, mut length_mm) = (Vec::new(), 0.0);
    for pair in pairs {
        let own = match (file, pair.layer) {
            (File::A, Both { a: own, b: None }) | (File::B, Both { a: None, b: own }) => own,
            _ => None,
        };
        let Some(own) = own else { continue };
        layers.push(own);
        let length = |role: &RoleOfPair| role.length_mm.a + role.length_mm.b;
        length_mm += pair.roles.iter().map(length).sum::<f64>();
    }
    (!layers.is_empty()).then_some(Finding::LayersOnlyIn { file, layers, length_mm })
}

fn role_only_in(file: File, role: Role, pairs: &[PairOfLayers]) -> Option<Finding> {
    let (mut layers, mut length_mm) = (Vec::new(), 0.0);
    for pair in pairs {
        let Both { a: Some(a), b: Some(b) } = pair.layer else { continue };
        let Some(found) = pair.roles.iter().find(|one| one.role == role) else { continue };
        let (number, own) = match file {
            File::A => (a, found.far_mm.a),
            File::B => (b, found.far_mm.b),
        };
        if own > 0.0 && found.farthest.is_none() {
            layers.push(number);
            length_mm += own;
        }
    }
    (!layers.is_empty()).then_some(Finding::RoleOnlyIn { file, role, layers, length_mm })
}

fn heights(pairs: &[PairOfLayers], tolerance: f64) -> Option<Finding> {
    let mut count = 0;
    let mut worst: Option<(f64, Both<usize>, Both<f64>)> = None;
    for pair in pairs {
        let (Both { a: Some(a), b: Some(b) }, Both { a: Some(low), b: Some(high) }) =
            (pair.layer, pair.z_mm)
        else {
            continue;
        };
        let apart = (low - high).abs();
        if apart <= tolerance + super::apart::SLACK {
            continue;
        }
        count += 1;
        if worst.is_none_or(|(most, ..)| apart > most) {
            worst = Some((apart, Both { a, b }, Both { a: low, b: high }));
        }
    }
    worst.map(|(_, layer, z_mm)| Finding::Heights { count, layer, z_mm })
}

fn of_layer(pair: &PairOfLayers, layer: Both<usize>, found: &mut Vec<Finding>) {
    of_orders(&pair.orders, Some(layer), found);
    for role in &pair.roles {
        of_role(role, layer, found);
    }
}

fn of_orders(orders: &Orders, layer: Option<Both<usize>>, found: &mut Vec<Finding>) {
    let Orders { heaters, commands } = orders.clone();
    found.extend(heaters.map(|difference| Finding::Heaters { layer, difference }));
    found.extend(commands.map(|difference| Finding::Commands { layer, difference }));
}

fn of_role(pair: &RoleOfPair, layer: Both<usize>, found: &mut Vec<Finding>) {
    let RoleOfPair { role, far_mm, farthest, unlike_mm, .. } = *pair;
    if far_mm.a + far_mm.b > 0.0 && farthest.is_none() {
        // Reported for all layers together.
        return;
    }
    let before = found.len();
    if let Some(farthest) = farthest {
        let length_mm = Both { a: pair.length_mm.a, b: pair.length_mm.b };
        found.push(Finding::Lines { layer, role, length_mm, far_mm, farthest });
    }
    if let Some(most_unlike) = pair.most_unlike {
        found.push(Finding::Flow { layer, role, unlike_mm, most_unlike });
    }
    // Lines that are drawn twice lie nowhere else: only the sums show it.
    if found.len() == before {
        for (quantity, sum) in [
            (Quantity::Length, pair.length_mm),
            (Quantity::Filament, pair.filament_mm),
            (Quantity::AskedTime, pair.asked_time_s),
        ] {
            if !sum.equal {
                found.push(Finding::Sum { layer: Some(layer), role: Some(role), quantity, sum });
            }
        }
    }
}

fn of_file(difference: &Difference, found: &mut Vec<Finding>) {
    let mut offer = |role, quantity, sum: Sum| {
        if !sum.equal {
            found.push(Finding::Sum { layer: None, role, quantity, sum });
        }
    };
    offer(None, Quantity::Time, difference.time_s);
    offer(None, Quantity::Filament, difference.filament_mm);
    for row in difference.roles.iter().filter(|row| row.decides) {
        offer(Some(row.role), Quantity::Length, row.length_mm);
        offer(Some(row.role), Quantity::Filament, row.filament_mm);
    }
}
