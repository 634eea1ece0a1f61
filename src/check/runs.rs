//! Pieces of a chain -> its stretches: those that nothing carries, and those on other lines of the layer.

use super::samples::Sample;
use crate::reader::print::Step;

/// Lines are printed twice over this many mm; or over the share `WHOLE` of a line that is longer
/// than `LEAST_WHOLE`.
const LEAST_TWICE: f64 = 10.0;
const LEAST_WHOLE: f64 = 2.0;
const WHOLE: f64 = 0.8;

/// Stretches of a line that nothing carries.
#[derive(Default)]
pub(super) struct Runs {
    /// Those at the line's ends.
    pub(super) ends: Vec<Vec<Sample>>,
    pub(super) longest_bridge: f64,
    /// The one that goes on.
    run: Vec<Sample>,
    pub(super) is_carried_before: bool,
}

impl Runs {
    pub(super) fn add(&mut self, carried: bool, place: Sample) {
        if !carried {
            self.run.push(place);
            return;
        }
        let length: f64 = self.run.iter().map(|place| place.length).sum();
        if !self.is_carried_before && length > 0.0 {
            self.ends.push(std::mem::take(&mut self.run));
        }
        self.longest_bridge =
            self.longest_bridge.max(if self.is_carried_before { length } else { 0.0 });
        self.run.clear();
        self.is_carried_before = true;
    }

    /// Ends the line: what still hangs is an end, too.
    pub(super) fn end(&mut self) {
        if !self.run.is_empty() {
            self.ends.push(std::mem::take(&mut self.run));
        }
    }
}

/// Stretches of a line that run on other lines.
#[derive(Default)]
pub(super) struct Twice {
    found: Vec<(f64, Step)>,
    length: f64,
    last: Option<Step>,
}

impl Twice {
    pub(super) fn add(&mut self, laid: bool, length: f64, step: &Step) {
        if laid {
            self.length += length;
            self.last = Some(*step);
        } else {
            self.end();
        }
    }

    pub(super) fn end(&mut self) {
        self.found.extend(self.last.take().map(|step| (self.length, step)));
        self.length = 0.0;
    }

    /// Those that are long, or nearly all of the line, which is `all` mm long.
    pub(super) fn ends(mut self, all: f64) -> Vec<(f64, Step)> {
        self.end();
        let least = LEAST_TWICE.min((WHOLE * all).max(LEAST_WHOLE));
        self.found.retain(|(length, _)| *length >= least);
        self.found
    }
}
