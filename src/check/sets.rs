//! Pairs that touch -> Sets: which patches, chains and bodies hang together.
//!
//! A witness's own: what slices has another.

/// Numbers from 0 on, in sets that grow together. Each points to an older one of its set, the first
/// of all, the *root*, to itself: so the order is that in which they came.
#[derive(Default)]
pub(super) struct Sets {
    parents: Vec<usize>,
}

impl Sets {
    /// Adds the next number, a set of its own.
    pub(super) fn add(&mut self) -> usize {
        let one = self.parents.len();
        self.parents.push(one);
        one
    }

    /// The first of a number's set.
    pub(super) fn root(&mut self, mut one: usize) -> usize {
        while self.parents[one] != one {
            let above = self.parents[self.parents[one]];
            self.parents[one] = above;
            one = above;
        }
        one
    }

    /// Makes two sets one. Returns its root, and that of the other which it took in; `None` if they
    /// were one.
    pub(super) fn join(&mut self, a: usize, b: usize) -> Option<[usize; 2]> {
        let (a, b) = (self.root(a), self.root(b));
        let (old, young) = (a.min(b), a.max(b));
        self.parents[young] = old;
        (old != young).then_some([old, young])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against the plain way: every pair paints one set in the other's colour.
        #[test]
        fn numbers_hang_together_through_any_pairs(
            pairs in prop::collection::vec((0..30_usize, 0..30_usize), 0..40)
        ) {
            let mut sets = Sets::default();
            let mut colours: Vec<usize> = (0..30).map(|_| sets.add()).collect();
            for (a, b) in pairs {
                let (x, y) = (colours[a], colours[b]);
                let (old, young) = (x.min(y), x.max(y));
                colours.iter_mut().filter(|one| **one == young).for_each(|one| *one = old);
                prop_assert_eq!(sets.join(a, b), (x != y).then_some([old, young]));
            }
            let roots: Vec<usize> = (0..30).map(|one| sets.root(one)).collect();
            prop_assert_eq!(roots, colours);
        }
    }
}
