//! Two G-code files -> Difference: whether they print the same, and where and how much not.
//!
//! Bytes may differ where the print does not: lines in another direction, divided otherwise, with
//! other comments. What is compared is the plastic: where lines of each role lie, how thick they are,
//! how long they take; where walls begin; where the nozzle goes without a line, since it may hit
//! something there; and which commands the printer gets besides. The files may be from different
//! slicers.
//!
//! 1. If the second print moved as a whole, it is looked at where the first one lies (`moved`); so are single
//!    parts of a plate (`parts`).
//!    Layers are paired by their heights (`align`).
//! 2. In each pair, lines of each role are compared with those of the same role (`apart`): what of
//!    a line is farther than the tolerance from all lines of the other file is *far*; what lies in
//!    the same place with another amount of filament per mm is *unlike*.
//!    Lines of a patch of non-planar skin are compared with those of the same patch (`patches`).
//! 3. Travels are compared likewise (`travels`), and the places where walls begin (`seams`).
//! 4. Commands besides moves are compared in their order (`codes`), and limits that are set (`limits`).
//! 5. Sums of length, filament and time are compared, by layer and for the file (`sums`).
//! 6. What differs becomes findings, the worst first (`findings`). Without findings the files are
//!    equal.
//!
//! Neither file is held as a whole: layers come one after the other (`side`), and some pairs are
//! compared side by side (`window`).
//!
//! If one of the files gives no roles, all lines count as one role.

mod align;
mod apart;
mod codes;
mod finding;
mod findings;
mod grid;
mod half;
mod limits;
mod line;
mod moved;
mod pair;
mod parts;
mod patches;
mod place;
mod seams;
mod show;
mod side;
mod sums;
mod travels;
mod way;
mod window;

pub use codes::{CodeDifference, Orders, Setting};
pub use finding::{File, Finding, Kind, Ordered, Quantity};
pub use pair::{Flow, PairOfLayers, RoleOfPair};
pub use place::Place;
pub use seams::SeamsOfPair;
pub use show::Strand;
pub use side::Side;
pub use sums::{Both, Extent, Sum};
pub use travels::TravelsOfPair;

use crate::reader::{Error, Role};
use align::Pair;
use pair::Rules;
use parts::Parts;
use rayon::prelude::*;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::Serialize;
use show::strands;
use std::borrow::Cow;
use sums::{Measure, ROLES};
use window::Of;

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
    /// For places where walls begin, mm.
    pub seams: f64,
    /// Whether ways without a line, and what is pulled back between lines, have to be the same.
    pub travels: bool,
    /// Whether settings in the comments have to be the same, too.
    pub settings: bool,
}

impl Default for Tolerances {
    /// Decimals of a file are equal, and whatever can be seen is not: a seam of the same print that
    /// begins elsewhere is some mm away.
    fn default() -> Self {
        Self { place: 0.01, share: 0.001, seams: 0.1, travels: true, settings: false }
    }
}

/// What two files have and have not in common.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Difference {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Whether they print the same within the tolerances.
    pub equal: bool,
    /// For places and heights, mm.
    pub tolerance_mm: f64,
    /// For sums, %.
    pub sums_percent: f64,
    /// For places where walls begin, mm; `None` if they are not compared.
    pub seams_mm: Option<f64>,
    /// Whether travels are compared.
    pub travels: bool,
    /// How far the second print moved as a whole, in x, y and z, mm; the rest is compared as if it had
    /// not. `None` if it did not.
    pub moved_mm: Option<[f64; 3]>,
    /// Parts that moved alone; the rest is compared as if they had not.
    pub parts_moved: Vec<PartMoved>,
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
    /// Limits of the machine, such as accelerations, and long waits that only one of the files sets.
    pub limits_told: Option<CodeDifference>,
    /// Settings in the comments that differ. They make files unequal only if asked to.
    pub settings: Vec<Setting>,
    /// What makes the files unequal, worst first.
    pub findings: Vec<Finding>,
    /// Commands that differ after the last line.
    pub end: Orders,
    /// What the nozzle does after the last line; `None` if it is not compared.
    pub end_travels: Option<TravelsOfPair>,
    /// What comes before the first layer, and each layer.
    pub pairs: Vec<PairOfLayers>,
}

/// A part of a plate that moved alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct PartMoved {
    /// The lowest and the highest corner of the box around its lines in the first file, in x and y, mm.
    pub box_mm: [[f64; 2]; 2],
    /// How far it moved in x and y, mm.
    pub by_mm: [f64; 2],
}

/// What moves of one role add up to in either file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct RoleOfFile {
    /// The role; `other` is all that extrudes if one of the files gives no roles.
    #[schemars(with = "String")]
    pub role: Role,
    /// Whether its length and filament have to be the same in the file: those of travels and
    /// retractions need not, which are compared place by place. What they take is a part of the whole
    /// time.
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

/// The JSON Schema of a [`Difference`].
#[must_use]
pub fn schema() -> serde_json::Value {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.into_generator().into_root_schema_for::<Difference>().to_value()
}

/// Compares two files, some layers at a time.
///
/// # Errors
/// [`Cause::Unreadable`](crate::reader::Cause::Unreadable).
pub fn diff(a: &Side, b: &Side, tolerances: &Tolerances) -> Result<Difference, Error> {
    let by_role = a.has_roles && b.has_roles;
    let place = tolerances.place;
    let raised = moved::raised(&a.floors, &b.floors, place);
    let layers = moved::pairs(&a.floors, &b.floors, raised, place);
    let moved = moved::moved(&a.floors, &b.floors, &layers, raised, place);
    let rules = Rules { tolerances, by_role, moved };
    let parts = match moved {
        None if parts::lie_apart(&a.floors, &b.floors, &layers, place) => Parts::new(a, b, place)?,
        _ => Parts::default(),
    };
    let slack = slack(a, b, &layers, raised);
    let last_slack = slack.last().copied().unwrap_or_default();
    let [x, y, _] = moved.unwrap_or_default();
    let mut pairs: Vec<PairOfLayers> = Vec::with_capacity(layers.len() + 1);
    let mut all = Both { a: Measure::default(), b: Measure::default() };
    let mut end_travels = None;
    window::each(a, b, &layers, &mut |first, some| {
        let compared = some.par_iter().enumerate().map(|(k, window::Moves { pair, moves })| {
            let lie_back =
                |steps| if *pair == Of::Start { Cow::Borrowed(steps) } else { parts.back(steps) };
            let moves = Both { a: Cow::Borrowed(&moves.a[..]), b: lie_back(&moves.b[..]) };
            let halves = match pair {
                Of::Start => Both { a: a.start(&moves.a), b: b.start(&moves.b) },
                Of::End => Both { a: a.end(&moves.a), b: b.end(&moves.b) },
                Of::Layers(pair) => Both {
                    a: a.layer(pair.a, [0.0; 2], &moves.a),
                    b: b.layer(pair.b, [x, y], &moves.b),
                },
            };
            let halves = halves.as_ref();
            if *pair == Of::End {
                let travels = travels::compare(halves, tolerances, last_slack, moved);
                return (None, Some(travels), halves.map(|half| Measure::new(half.steps, by_role)));
            }
            let slack = slack.get(first + k).copied().unwrap_or_default();
            let codes = Both { a: a.codes.of(halves.a.number), b: b.codes.of(halves.b.number) };
            let (found, measures) = pair::compare(halves, codes, slack, rules);
            (Some(found), None, measures)
        });
        for (found, travels, measures) in compared.collect::<Vec<_>>() {
            pairs.extend(found);
            end_travels = travels.or(end_travels.take());
            all = Both { a: all.a.and(&measures.a), b: all.b.and(&measures.b) };
        }
    })?;
    let end_travels = end_travels.filter(|_| tolerances.travels);
    Ok(whole(Both { a, b }, all, (rules, &parts), pairs, end_travels))
}

/// All that is told of two files, of what their layers have told.
fn whole(
    sides: Both<&Side>,
    all: Both<Measure>,
    (rules, parts): (Rules<'_>, &Parts),
    pairs: Vec<PairOfLayers>,
    end_travels: Option<TravelsOfPair>,
) -> Difference {
    let Rules { tolerances, by_role, moved } = rules;
    let share = tolerances.share;
    let seconds = sides.map(|side| side.estimate.seconds);
    let mut difference = Difference {
        schema: SCHEMA,
        equal: false,
        tolerance_mm: tolerances.place,
        sums_percent: 100.0 * share,
        seams_mm: Some(tolerances.seams).filter(|mm| mm.is_finite()),
        travels: tolerances.travels,
        moved_mm: moved,
        parts_moved: parts.moved.clone(),
        layers: sides.map(|side| side.floors.len()),
        time_s: Sum::new(seconds.a, seconds.b, share, LEAST_TIME),
        filament_mm: filament(all.as_ref(), share),
        extent_mm: all.map(|measure| measure.extent),
        roles: roles(sides.a, sides.b, all.as_ref(), by_role, share),
        firmware_retractions: sides.map(Side::firmware_retractions),
        limits_told: limits::difference(sides.map(Side::facts)),
        settings: codes::settings(&sides.a.values, &sides.b.values),
        findings: Vec::new(),
        end: codes::end(sides.map(|side| &side.codes)),
        end_travels,
        pairs,
    };
    difference.findings = findings::findings(&difference, tolerances);
    difference.equal = difference.findings.is_empty();
    difference
}

/// How far layers lie apart in z, mm: for the start and each pair, with the one before it, since the
/// way from one layer to the next has both heights.
fn slack(a: &Side, b: &Side, pairs: &[Pair], raised: f64) -> Vec<f64> {
    let mut before = 0.0;
    let apart = |pair: &Pair| {
        let floors = (pair.a.and_then(|k| a.floors.get(k)), pair.b.and_then(|k| b.floors.get(k)));
        let (Some(one), Some(other)) = floors else { return 0.0 };
        (other.level.z - raised - one.level.z).abs()
    };
    let own = std::iter::once(0.0).chain(pairs.iter().map(apart));
    own.map(|own: f64| own.max(std::mem::replace(&mut before, own))).collect()
}

/// The strands of layers for pictures, counted from 1; see [`Strand`]. The first one has what comes
/// before it, too, and the last what comes after. With `in_place` a print that moved as a whole is
/// shown where it lies.
///
/// # Errors
/// As [`diff()`].
pub fn views(
    a: &Side,
    b: &Side,
    layers: &[Both<Option<usize>>],
    found: &Difference,
    in_place: bool,
) -> Result<Vec<Vec<Strand>>, Error> {
    let [x, y, _] = found.moved_mm.filter(|_| !in_place).unwrap_or_default();
    let wanted = layers.iter().copied();
    let (kept_a, kept_b) = rayon::join(
        || window::some(a, wanted.clone().filter_map(|layer| layer.a)),
        || window::some(b, wanted.clone().filter_map(|layer| layer.b)),
    );
    let (kept_a, kept_b) = (kept_a?, kept_b?);
    let rules = show::Rules {
        by_role: a.has_roles && b.has_roles,
        reach: found.tolerance_mm,
        share: found.sums_percent / 100.0,
        travels: found.travels,
    };
    let last = Both { a: a.floors.len(), b: b.floors.len() };
    let view = |layer: &Both<Option<usize>>| {
        let of = |kept: &'_ window::Kept, number: Option<usize>| {
            number.and_then(|number| kept.get(&number).cloned()).unwrap_or_default()
        };
        let both = |a: Option<usize>, b: Option<usize>| (of(&kept_a, a), of(&kept_b, b));
        let index = layer.map(|number| number.and_then(|number| number.checked_sub(1)));
        let (own, other) = both(layer.a, layer.b);
        let own =
            Both { a: &a.layer(index.a, [0.0; 2], &own), b: &b.layer(index.b, [x, y], &other) };
        let mut all = strands(own, &rules);
        if index == (Both { a: Some(0), b: Some(0) }) {
            let (own, other) = both(Some(0), Some(0));
            all.extend(strands(Both { a: &a.start(&own), b: &b.start(&other) }, &rules));
        }
        if *layer == last.map(Some) {
            let (own, other) = both(Some(last.a + 1), Some(last.b + 1));
            all.extend(strands(Both { a: &a.end(&own), b: &b.end(&other) }, &rules));
        }
        all
    };
    Ok(layers.iter().map(view).collect())
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
