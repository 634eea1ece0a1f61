//! Lines of patches of non-planar skin + their marks -> findings of patches with wrong plastic or wrong marks.
//!
//! A line is judged by others of its role ([`beads`](super::beads)); if all are wrong, none is odd. A
//! patch is judged by its room alone, which is its lines' length from above times the width and height
//! that the file tells: lines are spaced from above, and their heights are those of upright room.
//!
//! - Plastic far from that room is told for the whole patch.
//! - Plastic by the lines' length in space grows as their slope does. Told heights are rounded to 0.02 mm, and
//!   drift between two tellings; lines of the usual height hardly do. Over those the plastic is compared with
//!   `1 + k · (secant of the slope - 1)` by least squares: sound files of scans and of machine parts have k
//!   from -0.06 to 0.06 where lines are steep enough, wrong ones 1.
//! - Marks: a patch ends before another begins, and before the file does. This program gives each number once.

use super::finding::{Code, Finding, Findings, Place, short};
use super::terms::Terms;
use crate::reader::Facts;
use crate::reader::print::Step;
use std::collections::{BTreeMap, BTreeSet};

/// Plastic over room: told widths and heights are rounded, and change along a line.
const BOUNDS: [f64; 2] = [0.7, 1.3];

/// Least room by which a patch is judged, mm³: some lines.
const LEAST_ROOM: f64 = 2.0;

/// Part of the usual height by which heights differ that are the usual one.
const USUAL: f64 = 0.05;

/// The root of the mean square of secant - 1 from which on slopes count: lines of 11 degrees.
const LEAST_SECANT: f64 = 0.02;

/// From here on plastic grows with the slope.
const LEAST_GROWTH: f64 = 0.5;

/// A line: height, room, plastic, secant of its slope - 1.
type Line = [f32; 4];

/// Lines of a patch.
#[derive(Debug)]
struct Own {
    lines: Vec<Line>,
    /// Line of the file and layer, from 1, of its first line.
    first: (u32, Option<usize>),
}

/// All patches so far, by their numbers.
#[derive(Debug, Default)]
pub(super) struct Patches {
    all: BTreeMap<u32, Own>,
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
        let own = self.all.entry(patch.number);
        let own = own.or_insert_with(|| Own { lines: Vec::new(), first });
        let plan = step.plan_length();
        if plan > 0.0 {
            let secant = step.length() / plan - 1.0;
            let line = [f64::from(step.height), step.room(), terms.plastic(step), secant];
            own.lines.push(line.map(|value| value as f32));
        }
    }

    /// Judges all patches: their marks, and their plastic if the file tells widths and heights.
    pub(super) fn finish(self, (facts, terms): (&Facts, &Terms), found: &mut Findings) {
        marks(facts, terms, found);
        if !facts.has_widths || !facts.has_heights {
            return;
        }
        for (number, own) in self.all {
            let (line, layer) = own.first;
            let place = Place { line: Some(u64::from(line)), layer, ..Place::default() };
            found.extend(judged(number, &own.lines).map(|finding| finding.at(place)));
        }
    }
}

/// What is wrong with a patch's plastic.
fn judged(number: u32, lines: &[Line]) -> Option<Finding> {
    let sum = |of: usize| lines.iter().map(|line| f64::from(line[of])).sum::<f64>();
    let (room, plastic) = (sum(1), sum(2));
    let fills = plastic / room;
    if room < LEAST_ROOM {
        return None;
    }
    let percent = short(100.0 * fills);
    if !(BOUNDS[0]..=BOUNDS[1]).contains(&fills) {
        let text = format!("patch {number} takes {percent} % of the plastic that it has room for");
        let code = if fills > 1.0 { Code::Overfilled } else { Code::Underfilled };
        return Some(Finding::of(code, percent, "%", text));
    }
    grows(lines).then(|| {
        let text = format!(
            "patch {number} takes {percent} % of the plastic that it has room for: as much as its lines are \
             long in space, not from above"
        );
        Finding::of(Code::Overfilled, percent, "%", text)
    })
}

/// Whether the plastic of lines of the usual height grows with their slope. See the head of this file.
fn grows(lines: &[Line]) -> bool {
    let heights = lines.iter().map(|line| f64::from(line[0])).collect();
    let Some(usual) = super::median(heights) else { return false };
    let (mut room, mut square, mut more) = (0.0, 0.0, 0.0);
    for line in lines {
        let [height, own, plastic, secant] = line.map(f64::from);
        if (height - usual).abs() <= USUAL * usual {
            room += own;
            square += own * secant * secant;
            more += (plastic - own) * secant;
        }
    }
    let is_steep = square > LEAST_SECANT * LEAST_SECANT * room && room >= LEAST_ROOM;
    is_steep && more > LEAST_GROWTH * square
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
