//! Lines of patches of non-planar skin -> findings of patches that take too much or too little plastic.
//!
//! A line is judged by others of its role ([`beads`](super::beads)); if all are wrong, none is odd. A
//! patch is judged by its room alone, which is its lines' length from above times the width and height
//! that the file tells: lines are spaced from above, and their heights are those of upright room.

use super::finding::{Code, Finding, Findings, Place, short};
use super::terms::Terms;
use crate::reader::Facts;
use crate::reader::print::Step;
use std::collections::BTreeMap;

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

/// All patches so far, by their numbers.
#[derive(Debug, Default)]
pub(super) struct Patches {
    sums: BTreeMap<u32, Sums>,
}

impl Patches {
    /// The next line of non-planar skin, in a layer from 0.
    pub(super) fn line(
        &mut self,
        (facts, terms): (&Facts, &Terms),
        step: &Step,
        layer: Option<usize>,
    ) {
        let Some(patch) = facts.patch_at(u64::from(step.line)) else { return };
        let first = (step.line, layer.map(|layer| layer + 1));
        let sums = self.sums.entry(patch.number);
        let sums = sums.or_insert(Sums { plastic: 0.0, room: 0.0, first });
        sums.plastic += terms.plastic(step);
        sums.room += step.room();
    }

    /// Judges all patches, if the file tells widths and heights.
    pub(super) fn finish(self, facts: &Facts, found: &mut Findings) {
        if !facts.has_widths || !facts.has_heights {
            return;
        }
        for (number, Sums { plastic, room, first: (line, layer) }) in self.sums {
            let fills = plastic / room;
            if room < LEAST_ROOM || (BOUNDS[0]..=BOUNDS[1]).contains(&fills) {
                continue;
            }
            let percent = short(100.0 * fills);
            let text =
                format!("patch {number} takes {percent} % of the plastic that it has room for");
            let code = if fills > 1.0 { Code::Overfilled } else { Code::Underfilled };
            let place = Place { line: Some(u64::from(line)), layer, ..Place::default() };
            found.add(Finding::of(code, percent, "%", text).at(place));
        }
    }
}
