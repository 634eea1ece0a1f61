//! Things that belong together -> groups: sets of numbers that are joined two by two.

/// Disjoint sets of the numbers below some count.
#[derive(Debug, Clone)]
pub(crate) struct Links {
    /// A number of the same set for each, itself for the least.
    to: Vec<u32>,
    sets: usize,
}

impl Links {
    /// Every number by itself.
    pub(crate) fn new(count: usize) -> Self {
        Self { to: (0..u32::try_from(count).unwrap_or(u32::MAX)).collect(), sets: count }
    }

    /// The number of sets.
    pub(crate) fn sets(&self) -> usize {
        self.sets
    }

    /// The least number of the set that `k` is in.
    pub(crate) fn root(&mut self, mut k: u32) -> u32 {
        while self.to[k as usize] != k {
            // Shortens the way for the next.
            self.to[k as usize] = self.to[self.to[k as usize] as usize];
            k = self.to[k as usize];
        }
        k
    }

    /// Makes one set of those of `a` and `b`.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.to[a.max(b) as usize] = a.min(b);
        self.sets -= usize::from(a != b);
    }

    /// The sets, by their least numbers; each in increasing order.
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
