//! Two layers -> PairOfLayers: what they have and have not in common, role by role.
//!
//! Words used here: a *pair* is two layers of the same height, or a layer that only one file has, or
//! the *start*, which is all before the first layer; a *half* is one file's part of a pair (`half`).
//!
//! Lines are compared as seen from each half's origin, so that a file whose layers all lie a
//! little higher differs once, in its heights, and not in every line. Distances are taken both ways:
//! a line that only one file has is far from all of the other's, whichever file it is in. Of places
//! and amounts the worst one is kept with its lines in both files, for people to look up.
//!
//! Time is compared twice. The time at the feeds asked for depends on the lines alone, and must be
//! the same for each role. The time that the machine takes depends on the order of lines, too; it is
//! reported for each layer, but must be the same only for the whole file.

use super::apart::{Apart, Unlike, apart};
use super::codes::{self, Code, Orders};
use super::half::Half;
use super::line::{Line, Point};
use super::patches;
use super::place::{Place, farthest, in_file};
use super::seams::{self, SeamsOfPair, WALLS};
use super::sums::{Both, Extent, Measure, ROLES, Sum};
use super::travels::{self, TravelsOfPair};
use super::{LEAST_FILAMENT, LEAST_LENGTH, Tolerances, is_plastic};
use crate::reader::Role;
use schemars::JsonSchema;
use serde::Serialize;

/// Time at the feeds asked for that sums may differ by besides the share, s.
const LEAST_TIME: f64 = 0.1;

/// A layer that both files have, or one of them; or what comes before the first layer.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
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
    /// What the nozzle does between the lines, on its way to the layer and in it; `None` where
    /// only one file has the layer, or if it is not compared.
    pub travels: Option<TravelsOfPair>,
    /// Where walls begin, by kind of wall; only where their lines are the same.
    pub seams: Vec<SeamsOfPair>,
}

/// The lines of one role in both layers.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RoleOfPair {
    /// The role; `other` is all that extrudes if one of the files gives no roles.
    #[schemars(with = "String")]
    pub role: Role,
    /// The patch of non-planar skin that they are of, by its number in either file: patches are
    /// compared one by one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patch: Option<Both<Option<u32>>>,
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

/// Two lines in the same place with different amounts of filament.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
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

/// How pairs are compared.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules<'a> {
    pub(super) tolerances: &'a Tolerances,
    /// Whether both files give roles.
    pub(super) by_role: bool,
    /// How far the second print moved as a whole, mm.
    pub(super) moved: Option<Point>,
}

/// Compares two layers, or what comes before the first ones. `slack` is how far the layers lie apart
/// in z, here and before, mm; `codes` are those of both.
pub(super) fn compare(
    halves: Both<&Half<'_>>,
    codes: Both<&[Code]>,
    slack: f64,
    rules: Rules<'_>,
) -> (PairOfLayers, Both<Measure>) {
    let Rules { tolerances, by_role, .. } = rules;
    let measures = halves.map(|half| Measure::new(half.steps, by_role));
    let of_role = |index: usize| role(halves, measures.as_ref(), index, rules);
    let is_whole = |role: Role| is_plastic(role) && !(by_role && role == Role::NonPlanar);
    let plastic = (0..ROLES).filter(|&index| is_whole(Role::ALL[index]));
    let patches = if by_role { patches(halves, rules) } else { Vec::new() };
    let roles = plastic.map(of_role).chain(patches).filter(|role| role.moves.a + role.moves.b > 0);
    let roles: Vec<RoleOfPair> = roles.collect();
    let both = halves.a.number.is_some() && halves.b.number.is_some();
    let travels = (both && tolerances.travels).then(|| travels(halves, &roles, slack, rules));
    let has_same_lines = |wall: &Role| {
        let own = roles.iter().find(|one| one.role == *wall);
        own.is_some_and(|own| own.far_mm.a + own.far_mm.b == 0.0)
    };
    let walls = WALLS.iter().filter(|wall| both && by_role && has_same_lines(wall));
    let seams = walls.filter_map(|wall| seams::compare(halves, *wall, tolerances.seams));
    let found = PairOfLayers {
        layer: halves.map(|half| half.number),
        z_mm: halves.map(|half| half.level.map(|[z, _]| z)),
        height_mm: halves.map(|half| half.level.map(|[_, height]| height)),
        time_s: halves.map(|half| half.seconds),
        extent_mm: measures.as_ref().map(|measure| measure.extent),
        orders: if both { codes::orders(codes) } else { Orders::default() },
        travels,
        seams: seams.collect(),
        roles,
    };
    (found, measures)
}

/// The lines of non-planar skin, patch by patch.
fn patches(halves: Both<&Half<'_>>, rules: Rules<'_>) -> Vec<RoleOfPair> {
    let compared = patches::all(halves).into_iter().map(|(patch, steps)| {
        let own = Both {
            a: Half { steps: &steps.a, ..*halves.a },
            b: Half { steps: &steps.b, ..*halves.b },
        };
        let own = own.as_ref();
        let measures = own.map(|half| Measure::new(half.steps, rules.by_role));
        let found = role(own, measures.as_ref(), Role::NonPlanar as usize, rules);
        RoleOfPair { patch: Some(patch), ..found }
    });
    compared.collect()
}

/// Travels, and whether others come from another order of the same lines.
fn travels(
    halves: Both<&Half<'_>>,
    roles: &[RoleOfPair],
    slack: f64,
    rules: Rules<'_>,
) -> TravelsOfPair {
    let mut travels = travels::compare(halves, rules.tolerances, slack, rules.moved);
    let same = |role: &RoleOfPair| role.far_mm.a + role.far_mm.b + role.unlike_mm.a == 0.0;
    travels.has_same_lines = roles.iter().all(same);
    if travels.other_from.is_some() && travels.has_same_lines {
        let lines = halves.map(Half::all_lines);
        let lines = lines.as_ref().map(Vec::as_slice);
        travels.lines_other_from = travels::other_from(lines, rules.tolerances.place);
    }
    travels
}

fn role(
    halves: Both<&Half<'_>>,
    measures: Both<&Measure>,
    index: usize,
    rules: Rules<'_>,
) -> RoleOfPair {
    let role = Role::ALL[index];
    let tally = measures.map(|measure| measure.roles[index]);
    let lines = halves.map(|half| half.lines(role, rules.by_role));
    let Tolerances { place, share, .. } = *rules.tolerances;
    let one = apart(&lines.a, &lines.b, place, share);
    let other = apart(&lines.b, &lines.a, place, share);
    RoleOfPair {
        role,
        patch: None,
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

/// The two lines whose filament differs more.
fn most_unlike(one: &Apart, other: &Apart, halves: Both<&Half<'_>>) -> Option<Flow> {
    let flow = |found: &Unlike, half: &Half<'_>, lines: Both<&Line>| Flow {
        filament_per_mm: lines.map(|line| line.flow),
        section_mm: lines.map(|line| line.section),
        at_mm: in_file(found.at, half),
        line: lines.map(|line| line.number),
    };
    let a = one.most_unlike.as_ref();
    let b = other.most_unlike.as_ref();
    if b.is_some_and(|b| a.is_none_or(|a| b.share() > a.share())) {
        return b.map(|b| flow(b, halves.b, Both { a: &b.other, b: &b.line }));
    }
    a.map(|a| flow(a, halves.a, Both { a: &a.line, b: &a.other }))
}
