//! Run -> Progress: layers (of a stream: blocks) done so far, and the wish to stop, shared between threads.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The run was asked to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the run was cancelled")]
pub struct Cancelled;

/// A handle on a run: how many layers are done, and whether the run is to stop. Cheap to share
/// between threads. The library itself never prints.
#[derive(Debug, Default)]
pub struct Progress {
    done: AtomicUsize,
    total: AtomicUsize,
    is_cancelled: AtomicBool,
}

impl Progress {
    /// Sets the number of layers in all.
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

    /// Asks the run to stop. It ends with [`Cancelled`] after the batch of layers that it is at, or
    /// after the model that it reads or mends. A run that is already done stays done.
    pub fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// Ends a run that was asked to stop; called between pieces of work.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn go_on(&self) -> Result<(), Cancelled> {
        if self.is_cancelled.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }
}
