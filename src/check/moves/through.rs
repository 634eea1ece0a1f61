//! Moves in the file's order -> findings of travels that go through what stands, by the nozzle's flat end.
//!
//! The end of a nozzle is flat and some 2.5 times as wide as its hole. A travel at the height of the
//! lines below it scrapes over them, as travels do; one that is lower by more than [`DEEP`] pushes them
//! aside, or is stopped by them. A move that goes up where it stands does no harm that has not been done.
//! What lines of layers run into is `falling-z`.
//!
//! Only a move that lies lower than the highest line so far is looked at, place by place.

use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::samples::Samples;
use crate::check::standing::Standing;
use crate::check::terms::Terms;
use crate::reader::print::Step;

/// How deep the nozzle may lie in what stands, mm: half of a thick layer, and more than skins are bent.
const DEEP: f64 = 0.16;

/// On a slope the flat end's uphill edge lies in it where a line begins: so much deeper a move that only sinks
/// may go, by the flat end's radius, up to 31 degrees.
const UPHILL: f64 = 0.6;

/// The nozzle's flat end by its hole, and its width where nobody tells the hole, mm.
const FLAT: f64 = 2.5;
const USUAL_FLAT: f64 = 1.0;

/// A nozzle no higher than this above plastic drags over it, mm: what end blocks lift at least.
const TOUCH: f64 = 0.05;

/// So much of a way over the finished print is told, mm: less is where the nozzle leaves it.
const LEAST_DRAG: f64 = 3.0;

/// Distance of the places that are looked at, mm.
const STEP: f64 = 0.25;

/// So many places are looked at of one move: of a longer one every so often.
const MOST_PLACES: f64 = 4000.0;

/// Travels through what stands.
pub(crate) struct Through {
    standing: Standing,
    /// Half the width of the nozzle's flat end, mm.
    radius: f64,
    /// How deep a move may lie that only sinks, mm.
    most_sunk: f64,
    /// Whether nobody knows how high the nozzle is: it was sent to an end stop.
    is_lost: bool,
    /// Whether a drag over the finished print was found: one is enough.
    has_dragged: bool,
}

impl Through {
    /// `has_slopes` tells whether lines go over slopes.
    pub(crate) fn new(terms: &Terms, has_slopes: bool) -> Self {
        let radius = terms.nozzle.map_or(USUAL_FLAT, |nozzle| FLAT * nozzle) / 2.0;
        let most_sunk = if has_slopes { DEEP + UPHILL * radius } else { DEEP };
        let standing = Standing::default();
        Self { standing, radius, most_sunk, is_lost: false, has_dragged: false }
    }

    /// The nozzle is sent to where only the printer knows; the reader takes that for 0.
    pub(crate) fn lose(&mut self) {
        self.is_lost = true;
    }

    /// The next move of the file; `is_of_layer` tells lines of layers from those that only prime.
    pub(crate) fn step(&mut self, step: &Step, is_of_layer: bool, found: &mut Findings) {
        let is_line = step.is_line();
        self.is_lost &= step.to[2] == 0.0;
        if self.is_lost {
            return;
        }
        let lowest = step.heights()[0];
        if lowest < self.standing.highest() - DEEP && !(is_line && is_of_layer) && !rises(step) {
            self.look(step, found);
        }
        if is_line {
            self.standing.lay(step);
        }
    }

    /// A move after the last line of the print, which may go over it at its own height.
    pub(crate) fn after(&mut self, step: &Step, found: &mut Findings) {
        let z = step.heights()[0];
        let is_travel = !step.is_line() && step.filament >= 0.0;
        // What is lower is looked at by itself.
        let level = self.standing.highest() - DEEP..self.standing.highest() + TOUCH;
        if self.has_dragged || self.is_lost || !is_travel || !level.contains(&z) || rises(step) {
            return;
        }
        let pitch = STEP.max(step.length() / MOST_PLACES);
        let mut touches = |at| self.standing.around(at, self.radius) > z - TOUCH;
        let over: f64 = Samples::of(step, pitch)
            .map(|sample| (sample.at, sample.length))
            .filter(|(at, _)| touches(*at))
            .map(|(_, length)| length)
            .sum();
        if over >= LEAST_DRAG {
            self.has_dragged = true;
            let text = format!(
                "the nozzle drags over {} mm of the finished print: nothing lifts it before; write G1 \
                 Z{{park_z}} F600 before this line of the end block",
                short(over)
            );
            found.add(Finding::warning(Code::ThroughPrint, over, "mm", text));
        }
    }

    fn look(&mut self, step: &Step, found: &mut Findings) {
        let pitch = STEP.max(step.length() / MOST_PLACES);
        let (mut deepest, mut length, mut at) = (0.0, 0.0, [0.0; 2]);
        for sample in Samples::of(step, pitch) {
            // A move that only sinks ends where it is deepest.
            let z = if sample.length > 0.0 { sample.z } else { f64::from(step.to[2]) };
            if z >= self.standing.highest() - DEEP {
                continue;
            }
            let depth = self.standing.around(sample.at, self.radius) - z;
            let most = if sample.length > 0.0 { DEEP } else { self.most_sunk };
            if depth > most {
                length += sample.length;
                if depth > deepest {
                    (deepest, at) = (depth, sample.at);
                }
            }
        }
        if deepest > 0.0 {
            let way =
                if length > 0.0 { format!("over {} mm ", short(length)) } else { String::new() };
            let text = format!(
                "the nozzle goes {way}through what stands up to {} mm higher",
                short(deepest)
            );
            // The line and the layer are the move's.
            let at_mm = Some(at.map(short));
            let finding = Finding::of(Code::ThroughPrint, deepest, "mm", text);
            found.add(finding.at(Place { at_mm, ..Place::default() }));
        }
    }
}

/// Whether a move only goes up.
fn rises(step: &Step) -> bool {
    step.from[0] == step.to[0] && step.from[1] == step.to[1] && step.to[2] >= step.from[2]
}
