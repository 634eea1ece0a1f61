//! `--threads` and the environment -> the threads of this process.

use std::num::NonZero;
use std::thread;

/// The most threads that are started: as many as `--threads` takes. More only cost memory.
const MOST: usize = 1024;

/// Set to a number above 0, as many threads as that are started, where `--threads` says nothing.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Starts as many threads as are asked for, or one for each core. A system that gives none, such as one
/// with `ulimit -u`, gets its work done by this thread alone: what is made is the same.
pub(super) fn start(asked: Option<u16>) {
    let cores = || thread::available_parallelism().map_or(1, NonZero::get);
    let count = asked.map(usize::from).or_else(said).unwrap_or_else(cores).min(MOST);
    let builder = || rayon::ThreadPoolBuilder::new();
    if builder().num_threads(count).build_global().is_err() {
        // It fails only if there are threads already.
        let _ = builder().num_threads(1).use_current_thread().build_global();
    }
}

fn said() -> Option<usize> {
    let number: usize = std::env::var(VARIABLE).ok()?.parse().ok()?;
    (number > 0).then_some(number)
}
