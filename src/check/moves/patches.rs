//! Lines of patches of non-planar skin + their marks -> findings of patches with wrong plastic or wrong marks.
//!
//! A line is judged by others of its role ([`beads`](crate::check::beads)); if all are wrong, none is odd. A
//! patch is judged by its room alone, which is its lines' length from above times the width and height
//! that the file tells: lines are spaced from above, and their heights are those of upright room.
//!
//! - Plastic far from that room is told for the whole patch.
//! - Marks: a patch ends before another begins, and before the file does. This program gives each number once.

use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::terms::Terms;
use crate::reader::Facts;
use crate::reader::print::Step;
use std::collections::{BTreeMap, BTreeSet};

/// Plastic over room: told widths and heights are rounded, and change along a line.
const BOUNDS: [f64; 2] = [0.7, 1.3];

/// Least room by which a patch is judged, mm³: some lines.
const LEAST_ROOM: f64 = 2.0;

/// Sums of a patch.
#[derive(Debug, Clone, Copy)]
struct Sums {
    /// mm³.
    plastic: f64,
    room: f64,
    /// Line of the file and layer, from 1, of its first line.
    first: (u32, Option<usize>),
}

impl Sums {
    fn add(&mut self, step: &Step, terms: &Terms) {
        self.plastic += terms.plastic(step);
        self.room += step.room();
    }
}

/// All patches so far, by their numbers.
#[derive(Debug, Default)]
pub(crate) struct Patches {
    all: BTreeMap<u32, Sums>,
}

impl Patches {
    /// The next line of non-planar skin, in a layer from 0.
    pub(crate) fn line(
        &mut self,
        (facts, terms): (&Facts, &Terms),
        step: &Step,
        layer: Option<usize>,
    ) {
        let Some(patch) = facts.patch_at(u64::from(step.line)) else { return };
        let first = (step.line, layer.map(|layer| layer + 1));
        let sums = self.all.entry(patch.number);
        let nothing = Sums { plastic: 0.0, room: 0.0, first };
        sums.or_insert(nothing).add(step, terms);
    }

    /// Judges all patches: their marks, and their plastic if the file tells widths and heights.
    pub(crate) fn finish(self, (facts, terms): (&Facts, &Terms), found: &mut Findings) {
        marks(facts, terms, found);
        if !facts.has_widths || !facts.has_heights {
            return;
        }
        for (number, sums) in self.all {
            let (line, layer) = sums.first;
            let place = Place { line: Some(u64::from(line)), layer, ..Place::default() };
            found.extend(judged(number, &sums).map(|finding| finding.at(place)));
        }
    }
}

/// What is wrong with a patch's plastic.
fn judged(number: u32, sums: &Sums) -> Option<Finding> {
    let fills = sums.plastic / sums.room;
    if sums.room < LEAST_ROOM {
        return None;
    }
    let percent = short(100.0 * fills);
    (!(BOUNDS[0]..=BOUNDS[1]).contains(&fills)).then(|| {
        let text = format!("patch {number} takes {percent} % of the plastic that it has room for");
        let code = if fills > 1.0 { Code::Overfilled } else { Code::Underfilled };
        Finding::of(code, percent, "%", text)
    })
}

/// Patches that have no end, and numbers that come twice in a file of this program's.
fn marks(facts: &Facts, terms: &Terms, found: &mut Findings) {
    let mut known = BTreeSet::new();
    for (k, patch) in facts.patches.iter().enumerate() {
        let place = Place { line: Some(patch.lines.start), ..Place::default() };
        let next = facts.patches.get(k + 1).map_or(u64::MAX, |next| next.lines.start);
        let number = patch.number;
        if patch.lines.end >= next {
            let text = format!("patch {number} has no `;NONPLANAR_END`");
            found.add(Finding::of(Code::WrongMarks, 1.0, "marks", text).at(place));
        }
        if terms.is_own && !known.insert(number) {
            let text = format!("a second patch has the number {number}");
            found.add(Finding::of(Code::WrongMarks, 1.0, "marks", text).at(place));
        }
    }
}
