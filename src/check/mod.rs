//! Print + Terms + model -> Verdict: an independent witness of what a G-code file prints.
//!
//! It reads the finished text and shares no code with what slices, plans or writes, so that it does
//! not repeat their faults. It works on any slicer's files; what a file gives no means to judge is
//! listed as not judged.
//!
//! - A *finding* is one thing that is wrong, with a place, a measure and a severity: errors fail the
//!   check, warnings do not.
//! - A *witness* is a file here that looks for a few kinds of findings. Each gets the moves of the
//!   print, and some the model, and returns what it found.
//! - *Terms* are what the file or a profile says of the machine and the beads.
//! - The *verdict* is all findings, sorted, and what was measured on the way.
//!
//! Beads are drawn on rows of spans, layer by layer; a thick bead fills the layers below it too.

mod against;
mod align;
mod anchors;
mod beads;
mod bodies;
mod capsule;
mod contact;
mod dialect;
mod filled;
mod fills;
pub mod finding;
mod ground;
mod heat;
mod laid;
mod moves;
mod part;
mod posts;
mod raft;
mod rows;
mod runs;
mod samples;
mod sets;
mod stack;
mod surfaces;
pub mod terms;

use crate::mesh::Mesh;
use crate::reader::print::Step;
use crate::reader::{Print, Role};
use filled::Filled;
use finding::{Code, Count, Finding, Findings};
use schemars::JsonSchema;
use serde::Serialize;
use terms::Terms;

/// Version of the JSON schema; raised when a field changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// No print is wider or deeper, mm: larger than any machine's bed.
const WIDEST: f64 = 10_000.0;

/// What was meant to be printed.
#[derive(Debug, Clone, Copy)]
pub struct Model<'a> {
    /// As it lies on the bed, but for `offset`.
    pub mesh: &'a Mesh,
    /// Where its middle is expected, in the machine's coordinates, mm. A file may have it elsewhere.
    pub offset: [f64; 2],
}

/// The report on a file.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Verdict {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Layers of the file.
    pub layers: usize,
    /// Moves of the file.
    pub moves: usize,
    /// What is wrong: by kind, errors and the largest of each first, at most [`finding::MOST_LISTED`] of each.
    pub findings: Vec<Finding>,
    /// How many findings there are of each kind.
    pub counts: Vec<Count>,
    /// What could not be judged, and why.
    pub not_judged: Vec<String>,
    /// What was measured on the way.
    pub measures: Measures,
}

/// What was measured on the way; `None` where the model is needed and not given.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct Measures {
    /// Plastic of all lines of the layers, mm³.
    pub plastic_mm3: f64,
    /// Longest stretch of a line that only its ends carry, mm.
    pub longest_bridge_mm: f64,
    /// Longest end of a line with nothing below that only the line itself and its neighbours hold, mm.
    pub longest_end_mm: f64,
    /// Length of lines in the air where the part itself has nothing below, mm.
    pub part_hangs_mm: f64,
    /// Volume of the model's cuts, mm³.
    pub part_mm3: Option<f64>,
    /// What of the printable outline is printed, part of 1.
    pub outline: Option<f64>,
    /// What of the printable top and bottom surfaces is closed, part of 1.
    pub surface: Option<f64>,
    /// Plastic of walls and skins for the room that they cover.
    pub solid: Option<f64>,
    /// Density of the sparse infill away from walls and skins, part of 1.
    pub infill: Option<f64>,
}

impl Verdict {
    /// Whether something is wrong that is more than a weak place.
    #[must_use]
    pub fn fails(&self) -> bool {
        self.counts.iter().any(|count| count.errors > 0)
    }
}

/// Judges a file. `model` is what it was made from, if that is known.
#[must_use]
pub fn check(print: &Print, terms: &Terms, model: Option<Model<'_>>) -> Verdict {
    let (mut found, mut not_judged) = (Findings::default(), Vec::new());
    let has_roles = print.moves.iter().any(|step| step.role == Role::OuterWall);
    what_is_missing(print, terms, model.is_some(), has_roles, &mut not_judged);

    moves::check(print, terms, &mut found, &mut not_judged);
    beads::odd(print, terms, &mut found);
    beads::narrow(print, terms, &mut found);
    beads::sums(print, &mut found);
    // A print wider than any machine is not checked place by place: its map would fill the memory.
    let absurd = is_absurd(print, &mut found);
    let part = model.filter(|_| !absurd).and_then(|model| {
        let say = (&mut found, &mut not_judged);
        align::place(print, (model, terms), has_roles, say)
    });
    let looked_at = if absurd { &Print::default() } else { print };
    // Side by side, each with findings of its own: how lines lie on each other, and on the part.
    let mut piled = Findings::default();
    let (stacked, (sums, places)) = rayon::join(
        || stack::check(looked_at, part.as_ref(), &mut piled),
        || {
            let filled = Filled::new(looked_at);
            let mut places = Findings::default();
            if has_roles {
                fills::check(&filled, terms, &mut places);
                contact::check(&filled, terms, &mut places);
                posts::check(&filled, &mut places);
            }
            let say = (&mut found, &mut not_judged);
            let part = part.as_ref();
            let sums = part.map(|part| surfaces::check(&filled, part, terms, has_roles, say));
            (sums, places)
        },
    );
    found.extend(piled);
    found.extend(places);

    let filament: f64 = print.lines().map(|step| f64::from(step.filament)).sum();
    let share = |[all, some]: [f64; 2]| if all > 0.0 { some / all } else { 1.0 };
    let (findings, counts) = found.sorted();
    Verdict {
        schema: SCHEMA,
        layers: print.layers.len(),
        moves: print.moves.len(),
        findings,
        counts,
        not_judged,
        measures: Measures {
            plastic_mm3: filament * terms.filament_area,
            longest_bridge_mm: stacked.longest_bridge,
            longest_end_mm: stacked.longest_end,
            part_hangs_mm: stacked.part_hangs,
            part_mm3: sums.map(|sums| sums.total.part),
            outline: sums.map(|sums| share(sums.total.rim)),
            surface: sums.map(|sums| share(sums.total.surface)),
            solid: sums.map(|sums| share(sums.total.solid)),
            infill: sums.and_then(|sums| sums.density),
        },
    }
}

/// Whether lines lie further apart than on any machine; then that is a finding.
fn is_absurd(print: &Print, found: &mut Findings) -> bool {
    let Some((low, high)) = extent(print.lines()) else { return false };
    let side = (high[0] - low[0]).max(high[1] - low[1]);
    if side <= WIDEST {
        return false;
    }
    let text = format!("lines lie {side:.0} mm apart, further than on any machine");
    found.add(Finding::of(Code::OutsideVolume, side, "mm", text));
    true
}

/// What cannot be judged because the file or the caller does not give it.
fn what_is_missing(
    print: &Print,
    terms: &Terms,
    has_model: bool,
    has_roles: bool,
    not_judged: &mut Vec<String>,
) {
    let mut say = |what: &str| not_judged.push(what.to_owned());
    if terms.machine.is_none() {
        say("volume, commands, speeds and flow: the file does not tell the machine; give -p");
    }
    if !has_model {
        say("size, outline, surfaces, infill and volume: give the model with --against");
    }
    if !has_roles {
        say("what lines are for: no comment of the file tells it");
    }
    if !print.has_widths {
        say("the plastic of single lines: no comment tells how wide they are");
    }
}

/// The middle one of some values by their order; `None` of none.
fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (middle < values.len()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Lowest and highest x and y that lines cover, mm.
fn extent<'a>(steps: impl Iterator<Item = &'a Step>) -> Option<([f64; 2], [f64; 2])> {
    part::extent_of(steps.flat_map(|step| {
        let (low, high) = capsule::Capsule::of(step, 1.0).extent();
        [low, high]
    }))
}
