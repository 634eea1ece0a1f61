//! Two layers -> PairOfLayers: what they have and have not in common, role by role.
//!
//! Words used here: a *pair* is two layers of the same height, or a layer that only one file has, or
//! the *start*, which is all before the first layer; a *half* is one file's part of a pair.
//!
//! Lines are compared with their heights above the layer, so that a file whose layers all lie a
//! little higher differs once, in its heights, and not in every line. Distances are taken both ways:
//! a line that only one file has is far from all of the other's, whichever file it is in. Of places
//! and amounts the worst one is kept with its lines in both files, for people to look up.
//!
//! Time is compared twice. The time at the feeds asked for depends on the lines alone, and must be
//! the same for each role. The time that the machine takes depends on the order of lines, too; it is
//! reported for each layer, but must be the same only for the whole file.

use super::align::Pair;
use super::apart::{Apart, Farthest, Unlike, apart};
use super::codes::{self, Orders};
use super::line::Line;
use super::sums::{self, Both, Extent, Measure, ROLES, Sum};
use super::{LEAST_FILAMENT, LEAST_LENGTH, Side, Tolerances, is_plastic};
use crate::reader::Role;
use crate::reader::print::{Layer, Step};
use serde::Serialize;

/// Time at the feeds asked for that sums may differ by besides the share, s.
const LEAST_TIME: f64 = 0.1;

/// A layer that both files have, or one of them; or what comes before the first layer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairOfLayers {
    /// Which one, counted from 1; 0 is what comes before the first. `None` where a file has none.
    pub layer: Both<Option<usize>>,
    /// Height of the nozzle where most of its lines lie, mm.
    pub z_mm: Both<Option<f64>>,
    /// How far it lies above the layer below, mm.
    pub height_mm: Both<Option<f64>>,
    /// Time with the way to it, s. It need not be the same: other ways between the same lines
    /// change it. See [`RoleOfPair::asked_time_s`].
    pub time_s: Both<f64>,
    /// Box around its lines.
    pub extent_mm: Both<Option<Extent>>,
    /// Commands that differ. Before the first layer: until its first line.
    pub orders: Orders,
    /// By role, those that leave plastic.
    pub roles: Vec<RoleOfPair>,
}

/// The lines of one role in both layers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RoleOfPair {
    /// The role; `other` is all that extrudes if one of the files gives no roles.
    pub role: Role,
    /// Number of moves.
    pub moves: Both<u64>,
    /// Length, mm.
    pub length_mm: Sum,
    /// Filament, mm.
    pub filament_mm: Sum,
    /// Time at the feeds that the file asks for, s: no order of lines changes it.
    pub asked_time_s: Sum,
    /// Length of each file's lines that is farther than the tolerance from all lines of the
    /// role in the other file, mm.
    pub far_mm: Both<f64>,
    /// The place of either file that is farthest from the lines of the other; `None` if none
    /// is too far or if the other has no such lines.
    pub farthest: Option<Place>,
    /// Length of each file's lines where the other has lines, but with another amount of
    /// filament for each mm, mm.
    pub unlike_mm: Both<f64>,
    /// The two lines whose filament differs most.
    pub most_unlike: Option<Flow>,
}

/// A place in one file that is far from all lines of its role in the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Place {
    /// How far, mm.
    pub distance_mm: f64,
    /// x, y and z, mm.
    pub at_mm: [f64; 3],
    /// Line of either file, from 1: the one that the place is on, and the nearest one of the other.
    pub line: Both<u32>,
}

/// Two lines in the same place with different amounts of filament.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Flow {
    /// Filament for each mm of line, mm.
    pub filament_per_mm: Both<f64>,
    /// Width and height by the file, mm.
    pub section_mm: Both<[f64; 2]>,
    /// x, y and z, mm.
    pub at_mm: [f64; 3],
    /// Line of either file, from 1.
    pub line: Both<u32>,
}

/// One file's part of a pair.
struct Half<'a> {
    moves: &'a [Step],
    layer: Option<&'a Layer>,
    /// Counted from 1.
    number: Option<usize>,
    seconds: f64,
}

impl<'a> Half<'a> {
    /// What comes before the first layer.
    fn start(side: &'a Side) -> Self {
        let moves = &side.print.moves[side.print.start.clone()];
        Self { moves, layer: None, number: Some(0), seconds: side.estimate.start_seconds }
    }

    fn layer(side: &'a Side, index: Option<usize>) -> Self {
        let layer = index.and_then(|index| side.print.layers.get(index));
        let time = index.and_then(|index| side.estimate.layers.get(index));
        Self {
            moves: layer.map_or(&[], |layer| side.print.moves_of(layer)),
            layer,
            number: index.map(|index| index + 1),
            seconds: time.map_or(0.0, |time| time.seconds),
        }
    }

    fn z(&self) -> f64 {
        self.layer.map_or(0.0, |layer| layer.z)
    }

    fn lines(&self, role: Role, by_role: bool) -> Vec<Line> {
        let steps = self.moves.iter();
        let lines = steps.filter(|step| step.is_line() && sums::role(step.role, by_role) == role);
        lines.map(|step| Line::new(step, self.z())).collect()
    }
}

/// Compares two layers, or what comes before the first ones.
pub(super) fn compare(
    a: &Side,
    b: &Side,
    pair: Option<Pair>,
    by_role: bool,
    tolerances: &Tolerances,
) -> (PairOfLayers, Both<Measure>) {
    let halves = match pair {
        None => Both { a: Half::start(a), b: Half::start(b) },
        Some(pair) => Both { a: Half::layer(a, pair.a), b: Half::layer(b, pair.b) },
    };
    let halves = halves.as_ref();
    let measures = halves.map(|half| Measure::new(half.moves, by_role));
    let of_role = |index: usize| role(halves, measures.as_ref(), index, by_role, tolerances);
    let plastic = (0..ROLES).filter(|&index| is_plastic(Role::ALL[index]));
    let roles = plastic.map(of_role).filter(|role| role.moves.a + role.moves.b > 0).collect();
    let numbers = halves.map(|half| half.number.unwrap_or(usize::MAX));
    let orders = match (a.codes.get(numbers.a), b.codes.get(numbers.b)) {
        (Some(a), Some(b)) => codes::orders(Both { a, b }),
        _ => Orders::default(),
    };
    let found = PairOfLayers {
        layer: halves.map(|half| half.number),
        z_mm: halves.map(|half| half.layer.map(|layer| layer.z)),
        height_mm: halves.map(|half| half.layer.map(|layer| layer.height)),
        time_s: halves.map(|half| half.seconds),
        extent_mm: measures.as_ref().map(|measure| measure.extent),
        orders,
        roles,
    };
    (found, measures)
}

fn role(
    halves: Both<&Half<'_>>,
    measures: Both<&Measure>,
    index: usize,
    by_role: bool,
    tolerances: &Tolerances,
) -> RoleOfPair {
    let role = Role::ALL[index];
    let tally = measures.map(|measure| measure.roles[index]);
    let lines = halves.map(|half| half.lines(role, by_role));
    let Tolerances { place, share, .. } = *tolerances;
    let one = apart(&lines.a, &lines.b, place, share);
    let other = apart(&lines.b, &lines.a, place, share);
    RoleOfPair {
        role,
        moves: tally.map(|tally| tally.moves),
        length_mm: Sum::new(tally.a.length, tally.b.length, share, LEAST_LENGTH),
        filament_mm: Sum::new(tally.a.filament, tally.b.filament, share, LEAST_FILAMENT),
        asked_time_s: Sum::new(tally.a.asked, tally.b.asked, share, LEAST_TIME),
        far_mm: Both { a: one.far, b: other.far },
        farthest: farthest(&one, &other, halves),
        unlike_mm: Both { a: one.unlike, b: other.unlike },
        most_unlike: most_unlike(&one, &other, halves),
    }
}

/// The farther of the two places.
fn farthest(one: &Apart, other: &Apart, halves: Both<&Half<'_>>) -> Option<Place> {
    let place = |found: Farthest, z: f64, line: Both<u32>| Place {
        distance_mm: found.distance,
        at_mm: [found.at[0], found.at[1], found.at[2] + z],
        line,
    };
    let a = one
        .farthest
        .map(|found| place(found, halves.a.z(), Both { a: found.number, b: found.nearest }));
    let b = other
        .farthest
        .map(|found| place(found, halves.b.z(), Both { a: found.nearest, b: found.number }));
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.distance_mm > a.distance_mm { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// The two lines whose filament differs more.
fn most_unlike(one: &Apart, other: &Apart, halves: Both<&Half<'_>>) -> Option<Flow> {
    let flow = |found: &Unlike, z: f64, lines: Both<&Line>| Flow {
        filament_per_mm: lines.map(|line| line.flow),
        section_mm: lines.map(|line| line.section),
        at_mm: [found.at[0], found.at[1], found.at[2] + z],
        line: lines.map(|line| line.number),
    };
    let a = one.most_unlike.as_ref();
    let b = other.most_unlike.as_ref();
    if b.is_some_and(|b| a.is_none_or(|a| b.share() > a.share())) {
        return b.map(|b| flow(b, halves.b.z(), Both { a: &b.other, b: &b.line }));
    }
    a.map(|a| flow(a, halves.a.z(), Both { a: &a.line, b: &a.other }))
}
