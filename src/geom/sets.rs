//! Pairs that belong together -> Sets: which numbers hang together through any of the pairs (union-find).
//!
//! Each number points to another of its set; following the pointers ends at the *root*, which points
//! to itself. The least number of a set is its root, so that nothing depends on the order of pairs.

/// Numbers from 0 on, divided into sets.
#[derive(Debug, Default)]
pub struct Sets(Vec<usize>);

impl Sets {
    /// Numbers below `count`, each a set of its own.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// The number of numbers.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is no number.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds the next number as a set of its own, and returns it.
    pub fn add(&mut self) -> usize {
        self.0.push(self.0.len());
        self.0.len() - 1
    }

    /// The least number of the set of `k`.
    pub fn root(&mut self, mut k: usize) -> usize {
        while self.0[k] != k {
            // Halves the way for the next look-up.
            self.0[k] = self.0[self.0[k]];
            k = self.0[k];
        }
        k
    }

    /// Makes one set of those of `a` and `b`. Returns the root that is left and the one that is none any
    /// more; `None` if they were one set.
    pub fn join(&mut self, a: usize, b: usize) -> Option<(usize, usize)> {
        let (a, b) = (self.root(a), self.root(b));
        let (root, joined) = (a.min(b), a.max(b));
        self.0[joined] = root;
        (root != joined).then_some((root, joined))
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
                prop_assert_eq!(sets.join(a, b), (x != y).then_some((old, young)));
            }
            let roots: Vec<usize> = (0..30).map(|one| sets.root(one)).collect();
            prop_assert_eq!(roots, colours);
        }
    }

    #[test]
    fn what_hangs_together_has_its_least_number_as_root() {
        let mut sets = Sets::new(4);
        assert_eq!(sets.add(), 4);
        assert_eq!(sets.join(4, 2), Some((2, 4)));
        assert_eq!(sets.join(2, 1), Some((1, 2)));
        assert_eq!(sets.join(4, 1), None);
        assert_eq!((0..sets.len()).map(|k| sets.root(k)).collect::<Vec<_>>(), [0, 1, 1, 3, 1]);
    }
}
