//! A line -> Samples: its short pieces, one after the other.

use crate::geom::segment;
use crate::reader::print::Step;

/// A short piece of a line.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Its middle.
    pub(super) at: [f64; 2],
    /// Height of the nozzle, mm.
    pub(super) z: f64,
    /// Across the line, of length 1.
    pub(super) across: [f64; 2],
    /// mm.
    pub(super) length: f64,
}

/// The pieces of a line.
pub(super) struct Samples {
    from: [f64; 3],
    way: [f64; 3],
    length: f64,
    count: usize,
    next: usize,
}

impl Samples {
    /// Of about `pitch` mm each.
    pub(super) fn of(step: &Step, pitch: f64) -> Self {
        let from = step.from.map(f64::from);
        let way = segment::way(from, step.to.map(f64::from));
        let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
        let count = (length / pitch).ceil().max(1.0) as usize;
        Self { from, way, length, count, next: 0 }
    }

    /// Length of each, mm.
    pub(super) fn length_of_each(&self) -> f64 {
        self.length / self.count as f64
    }

    /// The middles of all, so far to the left of the line, mm: the first, how far each lies from the one before,
    /// and how many there are.
    pub(super) fn row(&self, aside: f64) -> ([f64; 2], [f64; 2], usize) {
        let (count, [x, y, _], [dx, dy, _]) = (self.count as f64, self.from, self.way);
        let across = [-dy / self.length, dx / self.length];
        let by = [dx / count, dy / count];
        let first = segment::along([x, y], 0.5, by);
        (segment::along(first, aside, across), by, self.count)
    }

    /// Those whose middles lie between two places, from 0 to 1.
    pub(super) fn between(self, from: f64, to: f64) -> impl Iterator<Item = Sample> {
        let count = self.count as f64;
        let is_in = move |k: usize| (from..=to).contains(&((k as f64 + 0.5) / count));
        self.enumerate().filter(move |(k, _)| is_in(*k)).map(|(_, sample)| sample)
    }
}

impl Iterator for Samples {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        if self.next == self.count {
            return None;
        }
        let part = (self.next as f64 + 0.5) / self.count as f64;
        self.next += 1;
        let [x, y, z] = segment::along(self.from, part, self.way);
        Some(Sample {
            at: [x, y],
            z,
            across: [-self.way[1] / self.length, self.way[0] / self.length],
            length: self.length / self.count as f64,
        })
    }
}

/// Length of some pieces, mm.
pub(super) fn length_of(samples: &[Sample]) -> f64 {
    samples.iter().map(|sample| sample.length).sum()
}
