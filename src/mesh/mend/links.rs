//! Pairs of numbers -> groups: disjoint sets of numbers that are joined two by two.

use rayon::prelude::*;

/// Disjoint sets of the numbers below some count (union-find with path halving).
#[derive(Debug, Clone)]
pub(crate) struct Links {
    /// For each number one of the same set that is not greater; the least has itself.
    to: Vec<u32>,
    sets: usize,
}

impl Links {
    /// Every number in a set of its own.
    pub(crate) fn new(count: usize) -> Self {
        Self { to: (0..u32::try_from(count).unwrap_or(u32::MAX)).collect(), sets: count }
    }

    /// The sets of the numbers below `count`, each joined with the lower numbers that `lower` gives
    /// for it. Each thread joins those of a range; joins between ranges come last.
    pub(crate) fn of<L: Iterator<Item = u32>>(
        count: usize,
        lower: impl Fn(u32) -> L + Sync,
    ) -> Self {
        let mut links = Self::new(count);
        let share = count.div_ceil(rayon::current_num_threads()).max(1);
        let ranges = links.to.par_chunks_mut(share).map(|to| {
            let (mut joined, mut across) = (0, Vec::new());
            let numbers = to.first().copied().unwrap_or_default()..;
            let first = numbers.start;
            for a in numbers.take(to.len()) {
                for b in lower(a) {
                    if b < first {
                        across.push((a, b));
                    } else {
                        joined += usize::from(join(to, first, a, b));
                    }
                }
            }
            (joined, across)
        });
        for (joined, across) in ranges.collect::<Vec<_>>() {
            links.sets -= joined;
            across.into_iter().for_each(|(a, b)| links.join(a, b));
        }
        links
    }

    /// The number of sets.
    pub(crate) fn sets(&self) -> usize {
        self.sets
    }

    /// The least number of the set that `k` is in.
    pub(crate) fn root(&mut self, k: u32) -> u32 {
        root(&mut self.to, 0, k)
    }

    /// Makes one set of those of `a` and `b`.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        self.sets -= usize::from(join(&mut self.to, 0, a, b));
    }

    /// The sets in the order of their least numbers, each in increasing order.
    pub(crate) fn groups(&mut self) -> Vec<Vec<u32>> {
        let mut place = vec![usize::MAX; self.to.len()];
        let mut groups: Vec<Vec<u32>> = Vec::new();
        for k in 0..u32::try_from(self.to.len()).unwrap_or(u32::MAX) {
            let root = self.root(k) as usize;
            if place[root] == usize::MAX {
                place[root] = groups.len();
                groups.push(Vec::new());
            }
            groups[place[root]].push(k);
        }
        groups
    }
}

/// The least number of the set that `k` is in; `to` holds the numbers from `first` on.
fn root(to: &mut [u32], first: u32, mut k: u32) -> u32 {
    let at = |k: u32| (k - first) as usize;
    while to[at(k)] != k {
        // Halves the path for the next look-up.
        to[at(k)] = to[at(to[at(k)])];
        k = to[at(k)];
    }
    k
}

/// Makes one set of those of `a` and `b`. Returns whether they were two.
fn join(to: &mut [u32], first: u32, a: u32, b: u32) -> bool {
    let (a, b) = (root(to, first, a), root(to, first, b));
    to[(a.max(b) - first) as usize] = a.min(b);
    a != b
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn threads_make_the_sets_that_one_makes(
            pairs in prop::collection::vec((0..60_u32, 0..60_u32), 0..70), threads in 1..5_usize,
        ) {
            let lower = |a: u32| pairs.iter().filter(move |p| p.0.max(p.1) == a).map(|p| p.0.min(p.1));
            let mut one = Links::new(60);
            pairs.iter().for_each(|&(a, b)| one.join(a, b));
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut all = pool.install(|| Links::of(60, lower));
            prop_assert_eq!(all.sets(), one.sets());
            prop_assert_eq!(all.groups(), one.groups());
        }
    }
}
