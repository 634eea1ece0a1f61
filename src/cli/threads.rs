//! `--threads` and the environment -> the threads of this process.

use std::num::NonZero;
use std::thread;

/// The most threads that are started: as many as `--threads` takes. More only cost memory.
const MOST: usize = 1024;

/// Set to a number above 0, as many threads as that are started, where `--threads` says nothing.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Does `work` with as many threads as are asked for, or one for each core. A system that gives none,
/// such as one with `ulimit -u`, gets it done by this thread alone: what is made is the same.
pub(super) fn with<T: Send>(asked: Option<u16>, work: impl FnOnce() -> T + Send) -> T {
    let cores = || thread::available_parallelism().map_or(1, NonZero::get);
    let count = asked.map(usize::from).or_else(said).unwrap_or_else(cores).min(MOST);
    match rayon::ThreadPoolBuilder::new().num_threads(count).build() {
        Ok(pool) => pool.install(work),
        Err(_) => {
            // It fails only if this thread is in a pool already, which is as good.
            let alone = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
            let done = work();
            drop(alone);
            done
        }
    }
}

fn said() -> Option<usize> {
    let number: usize = std::env::var(VARIABLE).ok()?.parse().ok()?;
    (number > 0).then_some(number)
}
