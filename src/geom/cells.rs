//! Items -> Cells: the buckets of a grid; sorts items into all cells that they reach into (counting sort).

use std::ops::Range;

/// Items by cell in one list. An item is in each cell that it reaches into.
#[derive(Debug)]
pub struct Cells<T> {
    /// Where each cell begins in `items`, and where the last cell ends.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Cells<T> {
    /// Sorts `items` into `count` cells. `reach` returns the cells that an item reaches into. The
    /// items of a cell keep their order.
    #[must_use]
    pub fn new<I: Iterator<Item = T>, R: Iterator<Item = usize>>(
        count: usize,
        items: impl Fn() -> I,
        reach: impl Fn(T) -> R,
    ) -> Self {
        // `starts[cell + 1]` first holds where a cell begins. Each item placed in the cell moves it
        // on, until it holds where the next cell begins.
        let mut starts = vec![0; count + 2];
        items().for_each(|item| reach(item).for_each(|cell| starts[cell + 2] += 1));
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut sorted = vec![T::default(); sum as usize];
        for item in items() {
            reach(item).for_each(|cell| {
                sorted[starts[cell + 1] as usize] = item;
                starts[cell + 1] += 1;
            });
        }
        starts.pop();
        Self { starts, items: sorted }
    }

    /// The number of cells.
    #[must_use]
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The items of a cell, for sorting them.
    #[must_use]
    pub fn of_mut(&mut self, cell: usize) -> &mut [T] {
        &mut self.items[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// The items of adjacent cells, one cell after the other.
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
