//! Progress: a shared counter that the pipeline raises and only the command line draws.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Layers done and in all. Cheap to share between threads; the library never prints.
#[derive(Debug, Default)]
pub struct Progress {
    done: AtomicUsize,
    total: AtomicUsize,
}

impl Progress {
    /// Says how many layers there will be.
    pub fn set_total(&self, layers: usize) {
        self.total.store(layers, Ordering::Relaxed);
    }

    /// Adds finished layers.
    pub fn add(&self, layers: usize) {
        self.done.fetch_add(layers, Ordering::Relaxed);
    }

    /// Layers finished and layers in all (0 while unknown).
    pub fn get(&self) -> (usize, usize) {
        (self.done.load(Ordering::Relaxed), self.total.load(Ordering::Relaxed))
    }
}
