//! Values of successive layers -> Queue: a window over them that moves upwards.

use std::collections::VecDeque;

/// Values of successive layers. Old ones are taken out or dropped at the front.
#[derive(Debug)]
pub(super) struct Queue<T> {
    first: usize,
    values: VecDeque<T>,
}

impl<T> Default for Queue<T> {
    fn default() -> Self {
        Self { first: 0, values: VecDeque::new() }
    }
}

impl<T> Queue<T> {
    /// The first layer in the queue.
    pub(super) fn start(&self) -> usize {
        self.first
    }

    /// One past the last layer.
    pub(super) fn end(&self) -> usize {
        self.first + self.values.len()
    }

    /// The value of layer `k`; `None` if it is not in the queue.
    pub(super) fn get(&self, k: usize) -> Option<&T> {
        k.checked_sub(self.first).and_then(|k| self.values.get(k))
    }

    /// Removes and returns the first value.
    pub(super) fn take(&mut self) -> Option<T> {
        let value = self.values.pop_front()?;
        self.first += 1;
        Some(value)
    }

    /// Drops the layers before `k`.
    pub(super) fn forget(&mut self, k: usize) {
        while self.first < k && self.take().is_some() {}
    }
}

impl<T> Extend<T> for Queue<T> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, values: I) {
        self.values.extend(values);
    }
}
