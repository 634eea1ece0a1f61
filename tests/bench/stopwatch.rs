//! A closure -> seconds a call: the middle one of ten samples, with the least and the most.
//!
//! So small a clock does: regressions are found by `counts.sh`, which counts instructions. A
//! framework would take longer to build than all of these tests.

#![allow(clippy::print_stdout, reason = "the result of a bench is what it prints")]

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Samples of each bench.
const SAMPLES: usize = 10;

/// A sample calls so often that it takes at least this long: a call of 10 µs is told to 0.1 %.
const SAMPLE: Duration = Duration::from_millis(50);

/// All benches of a run; some are left out if words of the command line ask for others.
pub(crate) struct Bench {
    words: Vec<String>,
}

impl Bench {
    /// What the command line asks for. Cargo adds `--bench`, which is no word.
    pub(crate) fn from_arguments() -> Self {
        let is_word = |argument: &String| !argument.starts_with('-');
        Self { words: std::env::args().skip(1).filter(is_word).collect() }
    }

    /// Benches of one stage on one model.
    pub(crate) fn group<'a>(&'a self, stage: &'a str, model: &'a str) -> Group<'a> {
        Group { bench: self, stage, model }
    }
}

/// Benches of one stage on one model.
pub(crate) struct Group<'a> {
    bench: &'a Bench,
    stage: &'a str,
    model: &'a str,
}

impl Group<'_> {
    /// Times `call`; gives the middle of its seconds if it was asked for.
    pub(crate) fn time<T>(&self, name: &str, mut call: impl FnMut() -> T) -> Option<f64> {
        self.time_with(name, || (), |()| call())
    }

    /// Times `call` on what `make` makes; making is not timed.
    pub(crate) fn time_with<I, T>(
        &self,
        name: &str,
        mut make: impl FnMut() -> I,
        mut call: impl FnMut(I) -> T,
    ) -> Option<f64> {
        let id = format!("{}/{name}/{}", self.stage, self.model);
        if !self.bench.words.is_empty() && !self.bench.words.iter().any(|word| id.contains(word)) {
            return None;
        }
        let mut sample = |calls: u32| {
            let inputs: Vec<I> = (0..calls).map(|_| make()).collect();
            let start = Instant::now();
            // What the calls return is dropped within the time, as it is in the program.
            inputs.into_iter().for_each(|input| drop(black_box(call(black_box(input)))));
            start.elapsed()
        };
        // The first call warms the caches; the second tells how many fill a sample.
        sample(1);
        let once = sample(1).max(Duration::from_nanos(100));
        let calls = (SAMPLE.as_secs_f64() / once.as_secs_f64()).ceil().clamp(1.0, 1e6) as u32;
        let seconds = |_| sample(calls).as_secs_f64() / f64::from(calls);
        let mut times: Vec<f64> = (0..SAMPLES).map(seconds).collect();
        times.sort_by(f64::total_cmp);
        let (least, most) = (times[0], times[SAMPLES - 1]);
        let middle = (times[SAMPLES / 2 - 1] + times[SAMPLES / 2]) / 2.0;
        println!("{id:<44} {}  ({} to {})", told(middle), told(least), told(most));
        Some(middle)
    }
}

/// Seconds in the unit that fits them.
fn told(seconds: f64) -> String {
    let (factor, unit) = match seconds {
        s if s < 1e-3 => (1e6, "µs"),
        s if s < 1.0 => (1e3, "ms"),
        _ => (1.0, "s "),
    };
    format!("{:8.3} {unit}", seconds * factor)
}
