//! Two G-code files -> Difference: whether they print the same, and where and how much not.
//!
//! Bytes may differ where the print does not: lines in another order or direction, divided
//! otherwise, with other comments. What is compared is the plastic: where lines of each role lie,
//! how thick they are, how long they take, and which commands the printer gets besides. The files may
//! be from different slicers.
//!
//! 1. Layers are paired by their heights (`align`).
//! 2. In each pair, lines of each role are compared with those of the same role (`apart`): what of
//!    a line is farther than the tolerance from all lines of the other file is *far*; what lies in
//!    the same place with another amount of filament per mm is *unlike*.
//! 3. Commands besides moves are compared in their order (`codes`).
//! 4. Sums of length, filament and time are compared, by layer and for the file (`sums`).
//! 5. What differs becomes findings, the worst first (`findings`). Without findings the files are
//!    equal.
//!
//! If one of the files gives no roles, all lines count as one role.

mod align;
mod apart;
mod codes;
mod findings;
mod grid;
mod line;
mod pair;
mod sums;

pub use codes::{CodeDifference, Orders, Setting};
pub use findings::{File, Finding, Kind, Quantity};
pub use pair::{Flow, PairOfLayers, Place, RoleOfPair};
pub use sums::{Both, Extent, Sum};

use crate::estimate::Estimate;
use crate::reader::{Print, Role};
use align::Pair;
use codes::Code;
use rayon::prelude::*;
use serde::Serialize;
use sums::{Measure, ROLES};

/// Version of the JSON schema; raised when a field changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// Filament that sums may differ by besides the share, mm: decimals of a few lines.
const LEAST_FILAMENT: f64 = 0.01;

/// Length that sums may differ by besides the share, mm.
const LEAST_LENGTH: f64 = 0.1;

/// Time that prints may differ by besides the share, s.
const LEAST_TIME: f64 = 1.0;

/// How far files may differ and be the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// For places and heights, mm.
    pub place: f64,
    /// For sums of length, filament and time, and for the filament of each mm of line, as a
    /// share of the larger one.
    pub share: f64,
    /// Whether settings in the comments have to be the same, too.
    pub settings: bool,
}

/// A file as it is compared.
#[derive(Debug)]
pub struct Side {
    print: Print,
    estimate: Estimate,
    /// What comes before the first line, in each layer, and after the last line.
    codes: Vec<Vec<Code>>,
}

impl Side {
    /// A file of these bytes, read as `print` and timed as `estimate`. Both files are to be
    /// timed with the same limits.
    #[must_use]
    pub fn new(bytes: &[u8], print: Print, estimate: Estimate) -> Self {
        let codes = codes::by_layer(bytes, &print);
        Self { print, estimate, codes }
    }

    /// Whether the file gives roles of lines.
    fn has_roles(&self) -> bool {
        let mut moves = self.print.moves.iter();
        moves.any(|step| !matches!(step.role, Role::Other | Role::Travel | Role::Retraction))
    }

    /// Time of a role in the whole file, s.
    fn seconds(&self, role: Role, by_role: bool) -> f64 {
        let roles = self.estimate.roles.iter();
        let own = roles.filter(|one| sums::role(one.role, by_role) == role);
        own.fold(0.0, |sum, one| sum + one.seconds)
    }
}

/// What two files have and have not in common.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Whether they print the same within the tolerances.
    pub equal: bool,
    /// For places and heights, mm.
    pub tolerance_mm: f64,
    /// For sums, %.
    pub sums_percent: f64,
    /// Number of layers.
    pub layers: Both<usize>,
    /// Time of the whole file, s.
    pub time_s: Sum,
    /// Filament of the whole file, mm.
    pub filament_mm: Sum,
    /// Box around all lines, the start's among them.
    pub extent_mm: Both<Option<Extent>>,
    /// By role, those that occur.
    pub roles: Vec<RoleOfFile>,
    /// Retractions whose length only the printer knows (G10, G11).
    pub firmware_retractions: Both<u64>,
    /// Settings in the comments that differ. They make files unequal only if asked to.
    pub settings: Vec<Setting>,
    /// What makes the files unequal, worst first.
    pub findings: Vec<Finding>,
    /// Commands that differ after the last line.
    pub end: Orders,
    /// What comes before the first layer, and each layer.
    pub pairs: Vec<PairOfLayers>,
}

/// What moves of one role add up to in either file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RoleOfFile {
    /// The role; `other` is all that extrudes if one of the files gives no roles.
    pub role: Role,
    /// Whether its length and filament have to be the same: those of travels and retractions
    /// need not, which leave no plastic. What they take is a part of the whole time.
    pub decides: bool,
    /// Number of moves.
    pub moves: Both<u64>,
    /// Length of the nozzle's way, mm.
    pub length_mm: Sum,
    /// Filament pushed out less that pulled back, mm.
    pub filament_mm: Sum,
    /// Time, s. It never decides: how corners are taken changes it, and other ways to lines.
    pub time_s: Sum,
}

/// Compares two files.
#[must_use]
pub fn diff(a: &Side, b: &Side, tolerances: &Tolerances) -> Difference {
    let by_role = a.has_roles() && b.has_roles();
    let layers = align::align(&a.print.layers, &b.print.layers, tolerances.place);
    // Before the layers comes what both draw before them.
    let pairs: Vec<Option<Pair>> = [None].into_iter().chain(layers.into_iter().map(Some)).collect();
    let compared = pairs.par_iter().map(|pair| pair::compare(a, b, *pair, by_role, tolerances));
    let (pairs, measures): (Vec<PairOfLayers>, Vec<Both<Measure>>) = compared.unzip();
    let mut all = Both { a: Measure::default(), b: Measure::default() };
    for measure in &measures {
        all = Both { a: all.a.and(&measure.a), b: all.b.and(&measure.b) };
    }
    let share = tolerances.share;
    let mut difference = Difference {
        schema: SCHEMA,
        equal: false,
        tolerance_mm: tolerances.place,
        sums_percent: 100.0 * share,
        layers: Both { a: a.print.layers.len(), b: b.print.layers.len() },
        time_s: Sum::new(a.estimate.seconds, b.estimate.seconds, share, LEAST_TIME),
        filament_mm: filament(all.as_ref(), share),
        extent_mm: all.map(|measure| measure.extent),
        roles: roles(a, b, all.as_ref(), by_role, share),
        firmware_retractions: Both {
            a: a.print.summary.firmware_retractions,
            b: b.print.summary.firmware_retractions,
        },
        settings: codes::settings(&a.print, &b.print),
        findings: Vec::new(),
        end: match (a.codes.last(), b.codes.last()) {
            (Some(a), Some(b)) => codes::orders(Both { a, b }),
            _ => Orders::default(),
        },
        pairs,
    };
    difference.findings = findings::findings(&difference, tolerances);
    difference.equal = difference.findings.is_empty();
    difference
}

/// Filament that is pushed out, without retractions.
fn filament(all: Both<&Measure>, share: f64) -> Sum {
    let sum = |measure: &Measure| {
        let roles = Role::ALL.iter().zip(&measure.roles);
        roles.filter(|(role, _)| is_plastic(**role)).map(|(_, tally)| tally.filament).sum()
    };
    let sums = all.map(sum);
    Sum::new(sums.a, sums.b, share, LEAST_FILAMENT)
}

/// Whether moves of this role leave plastic.
fn is_plastic(role: Role) -> bool {
    !matches!(role, Role::Travel | Role::Retraction)
}

fn roles(a: &Side, b: &Side, all: Both<&Measure>, by_role: bool, share: f64) -> Vec<RoleOfFile> {
    let row = |index: usize| {
        let role = Role::ALL[index];
        let tally = all.map(|measure| measure.roles[index]);
        RoleOfFile {
            role,
            decides: is_plastic(role),
            moves: tally.map(|tally| tally.moves),
            length_mm: Sum::new(tally.a.length, tally.b.length, share, LEAST_LENGTH),
            filament_mm: Sum::new(tally.a.filament, tally.b.filament, share, LEAST_FILAMENT),
            time_s: Sum::new(a.seconds(role, by_role), b.seconds(role, by_role), share, LEAST_TIME),
        }
    };
    (0..ROLES).map(row).filter(|row| row.moves.a + row.moves.b > 0).collect()
}
