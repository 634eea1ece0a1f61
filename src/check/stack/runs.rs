//! Stretches of lines -> stretches of a chain: those that are carried or not, and those on other lines.

use crate::reader::print::Step;

/// Lines are printed twice over this many mm; or over the share `WHOLE` of a line that is longer
/// than `LEAST_WHOLE`.
const LEAST_TWICE: f64 = 10.0;
const LEAST_WHOLE: f64 = 2.5;
const WHOLE: f64 = 0.8;

/// Makes stretches from 0 to 1 disjoint and sorts them; those nearer to each other, or to an end,
/// than `gap` become one.
pub(crate) fn united(ways: &mut Vec<[f64; 2]>, gap: f64) {
    if ways.iter().any(|[from, to]| *from <= gap && *to >= 1.0 - gap) {
        ways.clear();
        ways.push([0.0, 1.0]);
        return;
    }
    if ways.len() > 1 {
        ways.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    }
    let mut count = 0_usize;
    for k in 0..ways.len() {
        let [from, to] = ways[k];
        let from = if from <= gap { 0.0 } else { from };
        let to = if to >= 1.0 - gap { 1.0 } else { to };
        match count.checked_sub(1).map(|last| &mut ways[last]) {
            Some(last) if from <= last[1] + gap => last[1] = last[1].max(to),
            _ => {
                ways[count] = [from, to];
                count += 1;
            }
        }
    }
    ways.truncate(count);
}

/// A stretch of a chain that is carried all along, or nowhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Run {
    pub(crate) carried: bool,
    /// mm.
    pub(crate) length: f64,
    /// Its beginning and its end: a line of the chain, and a place of that from 0 to 1.
    pub(crate) from: (usize, f64),
    pub(crate) to: (usize, f64),
}

/// The runs of a chain, one after the other.
#[derive(Default)]
pub(crate) struct Runs {
    pub(crate) all: Vec<Run>,
}

impl Runs {
    /// Adds the next line, which is `length` mm long and carried over these parts of it.
    pub(crate) fn add(&mut self, line: usize, length: f64, carried: &[[f64; 2]]) {
        let mut at = 0.0;
        for &[from, to] in carried {
            self.push(false, line, length, [at, from]);
            self.push(true, line, length, [from, to]);
            at = to;
        }
        self.push(false, line, length, [at, 1.0]);
    }

    fn push(&mut self, carried: bool, line: usize, length: f64, [from, to]: [f64; 2]) {
        if from >= to {
            return;
        }
        let length = length * (to - from);
        match self.all.last_mut() {
            Some(last) if last.carried == carried => {
                last.length += length;
                last.to = (line, to);
            }
            _ => self.all.push(Run { carried, length, from: (line, from), to: (line, to) }),
        }
    }

    /// Length of all that is not carried, mm.
    pub(crate) fn hanging(&self) -> f64 {
        self.all.iter().filter(|run| !run.carried).map(|run| run.length).sum()
    }

    /// The longest run that is not carried at one of the ends, and the longest between two that are.
    pub(crate) fn longest(&self) -> (f64, f64) {
        let (mut end, mut bridge) = (0.0_f64, 0.0_f64);
        for (k, run) in self.all.iter().enumerate().filter(|(_, run)| !run.carried) {
            let is_end = k == 0 || k + 1 == self.all.len();
            let longest = if is_end { &mut end } else { &mut bridge };
            *longest = longest.max(run.length);
        }
        (end, bridge)
    }
}

/// Stretches of a line that run on other lines.
#[derive(Default)]
pub(crate) struct Twice {
    found: Vec<(f64, Step)>,
    length: f64,
    last: Option<Step>,
}

impl Twice {
    /// Adds the next line, which is `length` mm long and lies on others over these parts of it.
    pub(crate) fn step(&mut self, laid: &[[f64; 2]], length: f64, step: &Step) {
        let mut at = 0.0;
        for &[from, to] in laid {
            if from > at {
                self.end();
            }
            self.length += length * (to - from);
            self.last = Some(*step);
            at = to;
        }
        if at < 1.0 {
            self.end();
        }
    }

    fn end(&mut self) {
        self.found.extend(self.last.take().map(|step| (self.length, step)));
        self.length = 0.0;
    }

    /// Those that are long, or nearly all of the line, which is `all` mm long.
    pub(crate) fn ends(mut self, all: f64) -> Vec<(f64, Step)> {
        self.end();
        let least = LEAST_TWICE.min((WHOLE * all).max(LEAST_WHOLE));
        self.found.retain(|(length, _)| *length >= least);
        self.found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_that_touch_become_one() {
        let mut ways = vec![[0.5, 0.6], [0.02, 0.1], [0.1, 0.3], [0.62, 0.99]];
        united(&mut ways, 0.03);
        assert_eq!(ways, [[0.0, 0.3], [0.5, 1.0]]);
    }

    #[test]
    fn runs_go_on_from_line_to_line() {
        let mut runs = Runs::default();
        runs.add(0, 10.0, &[[0.25, 1.0]]);
        runs.add(1, 4.0, &[[0.0, 0.5]]);
        runs.add(2, 1.0, &[]);
        runs.add(3, 2.0, &[[0.0, 1.0]]);
        let lengths: Vec<(bool, f64)> =
            runs.all.iter().map(|run| (run.carried, run.length)).collect();
        assert_eq!(lengths, [(false, 2.5), (true, 9.5), (false, 3.0), (true, 2.0)]);
        assert_eq!((runs.all[2].from, runs.all[2].to), ((1, 0.5), (2, 1.0)));
        assert_eq!((runs.longest(), runs.hanging()), ((2.5, 3.0), 5.5));
    }
}
