//! Items -> Cells: items sorted by counting into the cells that they reach into.

use std::ops::Range;

/// Items by cell, all in one list; an item is in each cell that it reaches into.
#[derive(Debug)]
pub struct Cells<T> {
    /// Where each cell begins in `items`, and where the last one ends.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Cells<T> {
    /// Sorts `items` into `count` cells; `reach` gives the numbers of those that an item is in.
    /// Items of a cell keep their order.
    #[must_use]
    pub fn new<I: Iterator<Item = T>, R: Iterator<Item = usize>>(
        count: usize,
        items: impl Fn() -> I,
        reach: impl Fn(T) -> R,
    ) -> Self {
        // Where a cell begins stands one place further on, until its items have moved it to
        // where the next one begins.
        let mut starts = vec![0; count + 2];
        items().for_each(|item| reach(item).for_each(|cell| starts[cell + 2] += 1));
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut sorted = vec![T::default(); sum as usize];
        for item in items() {
            for cell in reach(item) {
                sorted[starts[cell + 1] as usize] = item;
                starts[cell + 1] += 1;
            }
        }
        starts.pop();
        Self { starts, items: sorted }
    }

    /// The number of cells.
    #[must_use]
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The items of a cell, to be sorted.
    #[must_use]
    pub fn of_mut(&mut self, cell: usize) -> &mut [T] {
        &mut self.items[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// The items of some cells beside each other, one cell after the other.
    #[must_use]
    pub fn of(&self, cells: Range<usize>) -> &[T] {
        &self.items[self.starts[cells.start] as usize..self.starts[cells.end] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_in_all_cells_that_they_reach_into() {
        let cells = Cells::new(
            4,
            || [2..4, 0..1, 3..4].into_iter().map(|r| (r.start, r.end)),
            |(a, b)| a..b,
        );
        assert_eq!(cells.count(), 4);
        assert_eq!(cells.of(0..1), [(0, 1)]);
        assert!(cells.of(1..2).is_empty());
        assert_eq!(cells.of(2..4), [(2, 4), (2, 4), (3, 4)]);
        let none = Cells::<u8>::new(1, std::iter::empty, |_| 0..1);
        assert!(none.of(0..1).is_empty());
    }
}
