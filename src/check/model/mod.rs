//! Print + Part -> findings against the model, layer by layer, and the sums over all of them.
//!
//! Layers are cut and judged in batches, side by side on all threads, so that few cuts are held at a
//! time. A layer is unsure, and not judged, if a cut does not close, or if it runs along a face of the
//! model: then another slicer may rightly count the face to the other side.
//!
//! Sums over all layers are judged at the end:
//! - plastic of walls and skins for the room that they cover;
//! - density of the sparse infill, plastic per room, where there is enough room away from walls: for
//!   the whole print against what the file asks for, and for blocks of layers against the whole
//!   print. Thick lines fill several layers, so that a single layer has no density.

pub(crate) mod against;
pub(crate) mod align;
pub(crate) mod part;
pub(crate) mod raft;
pub(crate) mod roof;

use crate::check::filled::Filled;
use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::rows::Lattice;
use crate::check::survey::{Survey, both};
use crate::check::terms::Terms;
use crate::reader::Facts;
use against::{Areas, Judge, Verdict};
use part::{Part, Section};
use rayon::prelude::*;
use roof::Roof;
use std::ops::Range;

/// Distance of rows, mm: an eighth of a usual line.
const PITCH: f64 = 0.05;

/// Rows of a layer at most; larger prints get rows further apart.
const MOST_ROWS: f64 = 6000.0;

/// Layers over which infill is measured together: three of the largest usual groups of thick infill.
const BLOCK: usize = 12;

/// Least room for infill by which a block is judged, mm³: in less, single lines make the density.
const LEAST_ROOM: f64 = 150.0;

/// A layer with less room for infill does not count, mm², and a block with fewer layers that do is
/// not judged.
const LEAST_CORE: f64 = 20.0;
const LEAST_LAYERS: usize = 5;

/// Density of a block over the print's: rows of a wide grid fall in or out of a block, …
const BLOCK_SLACK: [f64; 2] = [0.5, 1.7];

/// … and of the whole print over what is asked for, which slicers reckon in different ways. Infill
/// that is missing on a few layers shows in a block, not here.
const INFILL_SLACK: [f64; 2] = [0.65, 1.4];

/// Least room for infill by which the whole print is judged, mm³.
const ENOUGH_ROOM: f64 = 1000.0;

/// Plastic of walls and skins over the room that they cover: overlaps count for the higher bound,
/// gaps that the map closes for the lower.
const SOLID_SLACK: [f64; 2] = [0.8, 1.25];

/// Sums over all layers.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sums {
    /// Areas times heights, mm³, but for rim and surface: mm².
    pub(crate) total: Areas,
    /// Density of the infill, part of 1, if there is enough of it.
    pub(crate) density: Option<f64>,
}

/// All layers by the part.
pub(crate) struct Surfaces<'a> {
    part: &'a Part,
    terms: &'a Terms,
    has_roles: bool,
    lattice: Lattice,
    /// The part's surface, if lines stray.
    roof: Option<Roof>,
    areas: Vec<Areas>,
    unsure: usize,
}

impl<'a> Surfaces<'a> {
    /// `None` without a line and without a part.
    pub(crate) fn new(
        part: &'a Part,
        (survey, terms): (&Survey, &'a Terms),
        has_roles: bool,
    ) -> Option<Self> {
        let (low, high) = both(survey.part, part.extent())?;
        let lattice = Lattice::new(PITCH, high[1] - low[1], MOST_ROWS);
        let strays = survey.strays.iter().any(|strays| !strays.is_empty());
        let roof = if strays { Roof::of(part) } else { None };
        Some(Self { part, terms, has_roles, lattice, roof, areas: Vec::new(), unsure: 0 })
    }

    /// Judges some layers side by side.
    pub(crate) fn batch(&self, filled: &Filled<'_>, layers: Range<usize>) -> Vec<Verdict> {
        let &Filled { window, survey } = filled;
        let (lattice, terms, has_roles) = (self.lattice, self.terms, self.has_roles);
        let roof = &self.roof;
        let judge = Judge { window, survey, lattice, terms, has_roles, roof };
        // From the layer below the first to that above the last.
        let cuts: Vec<Section> = (layers.start..layers.end + 2)
            .into_par_iter()
            .map(|above| match above.checked_sub(1) {
                Some(layer) => self.part.section(layer, lattice),
                None => Section::empty(),
            })
            .collect();
        let judged = layers.clone().into_par_iter().map(|index| {
            let k = index - layers.start;
            let three = &cuts[k..k + 3];
            if survey.between[index] || survey.is_skin[index] {
                return Verdict::default();
            }
            let is_sure = three.iter().all(|cut| cut.closes)
                && (terms.is_own
                    || !(index.saturating_sub(1)..=index + 1)
                        .any(|k| self.part.is_along_a_face(k)));
            if is_sure {
                judge.layer(index, [&three[0], &three[1], &three[2]])
            } else {
                Verdict { is_unsure: true, ..Verdict::default() }
            }
        });
        judged.collect()
    }

    /// The next layer.
    pub(crate) fn layer(&mut self, verdict: Verdict, found: &mut Findings) {
        self.unsure += usize::from(verdict.is_unsure);
        self.areas.push(verdict.areas);
        found.extend(verdict.findings);
    }

    /// Judges the sums.
    pub(crate) fn finish(
        self,
        (facts, survey): (&Facts, &Survey),
        (found, notes): (&mut Findings, &mut Vec<String>),
    ) -> Sums {
        if self.unsure > 0 {
            notes.push(format!(
                "{} of {} layers against the part: its outline does not close, or they are cut \
                 along a face of it",
                self.unsure,
                self.areas.len()
            ));
        }
        let heights = (self.terms, &survey.heights[..]);
        sums(facts, heights, (&self.areas, self.has_roles), found)
    }
}

/// Adds up, and judges the amounts.
fn sums(
    facts: &Facts,
    (terms, heights): (&Terms, &[f64]),
    (areas, has_roles): (&[Areas], bool),
    found: &mut Findings,
) -> Sums {
    let mut sums = Sums::default();
    for (areas, height) in areas.iter().zip(heights) {
        let total = &mut sums.total;
        total.part += areas.part * height;
        total.solid[0] += areas.solid[0] * height;
        total.solid[1] += areas.solid[1];
        total.sparse[0] += areas.sparse[0] * height;
        total.sparse[1] += areas.sparse[1];
        for k in 0..2 {
            total.rim[k] += areas.rim[k];
            total.surface[k] += areas.surface[k];
        }
    }
    let [room, plastic] = sums.total.solid;
    if room > 0.0 && facts.has_widths && !is_within(plastic / room, SOLID_SLACK) {
        let percent = short(100.0 * plastic / room);
        let text =
            format!("walls and skins take {percent} % of the plastic that they have room for");
        found.add(Finding::of(Code::WrongVolume, percent, "%", text));
    }
    let [room, plastic] = sums.total.sparse;
    sums.density = (room >= ENOUGH_ROOM).then_some(plastic / room);
    if has_roles {
        infill(facts, terms, areas, &sums, found);
    } else {
        sums.density = None;
    }
    sums
}

fn is_within(value: f64, [low, high]: [f64; 2]) -> bool {
    (low..=high).contains(&value)
}

/// Judges the density of the sparse infill: in all, and by blocks of layers.
fn infill(facts: &Facts, terms: &Terms, areas: &[Areas], sums: &Sums, found: &mut Findings) {
    if let (Some(asked), Some(density)) = (terms.infill, sums.density)
        && !is_within(density, INFILL_SLACK.map(|slack| slack * asked))
    {
        let [percent, asked] = [density, asked].map(|part| short(100.0 * part));
        let text =
            format!("the sparse infill is {percent} % dense, where {asked} % were asked for");
        found.add(Finding::of(Code::WrongInfill, percent, "%", text));
        return;
    }
    let Some(usual) = sums.density.filter(|density| *density > 0.0) else { return };
    // Thick lines fill layers below their own: a last block must not be of a few layers only.
    for k in 0..(areas.len() / BLOCK).max(1) {
        let first = k * BLOCK;
        let rest = areas.len() - first;
        let block = first..first + if rest < 2 * BLOCK { rest } else { BLOCK };
        let (mut room, mut plastic) = (0.0, 0.0);
        for index in block.clone() {
            room += areas[index].sparse[0] * facts.layers[index].height;
            plastic += areas[index].sparse[1];
        }
        // A thick line may fill layers of the block before: few layers have no density.
        let layers = block.clone().filter(|k| areas[*k].sparse[0] >= LEAST_CORE).count();
        if layers < LEAST_LAYERS
            || room < LEAST_ROOM
            || is_within(plastic / room / usual, BLOCK_SLACK)
        {
            continue;
        }
        let percent = [plastic / room, usual].map(|part| short(100.0 * part));
        let text = format!(
            "the sparse infill of layers {} to {} is {} % dense, where {} % is usual",
            first + 1,
            block.end,
            percent[0],
            percent[1]
        );
        let finding = Finding::of(Code::WrongInfill, percent[0], "%", text);
        found.add(Finding {
            place: Place { layer: Some(first + 1), ..Place::default() },
            ..finding
        });
    }
}
