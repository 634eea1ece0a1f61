//! Values -> slice: those that wait, in one piece of memory, the first ones taken away.

use std::ops::{Deref, DerefMut};

/// So many values are taken from the front before the others are moved there.
const MOST_TAKEN: usize = 256;

/// Values in the order in which they came. A [`std::collections::VecDeque`] has them in two
/// pieces, and every step along it asks which.
#[derive(Debug, Clone)]
pub(super) struct Queue<T> {
    values: Vec<T>,
    /// How many of them were taken.
    taken: usize,
}

impl<T> Default for Queue<T> {
    fn default() -> Self {
        Self { values: Vec::new(), taken: 0 }
    }
}

impl<T: Copy> Queue<T> {
    /// Adds one to the end.
    pub(super) fn push(&mut self, value: T) {
        self.values.push(value);
    }

    /// Takes the first one.
    pub(super) fn take_first(&mut self) -> Option<T> {
        let first = self.first().copied()?;
        self.taken += 1;
        if self.taken >= MOST_TAKEN.max(self.values.len() / 2) {
            self.values.drain(..self.taken);
            self.taken = 0;
        }
        Some(first)
    }
}

impl<T> Deref for Queue<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.values[self.taken..]
    }
}

impl<T> DerefMut for Queue<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.values[self.taken..]
    }
}
