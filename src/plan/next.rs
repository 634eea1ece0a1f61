//! Groups of places -> Next: the group with the place nearest to the nozzle, again and again until all are taken.
//!
//! Islands, walls and lines are sorted for printing by going to the nearest one each time. Of equally
//! near ones the first in the list wins. Few groups are asked one after the other; many are kept in a
//! tree, which gives the same answers.

use crate::geom::Point;
use crate::geom::nearest::Nearest;

/// So many groups are asked one after the other. A trade-off: a tree takes longer to build than to
/// ask a few, and asking all takes time with the square of their number.
const FEW: usize = 64;

/// Groups of places that are not taken yet.
pub(super) struct Next {
    /// Where the places of each group begin, and where the last end.
    starts: Vec<usize>,
    places: Vec<Point>,
    /// The group of each place, if a tree is asked.
    owners: Vec<usize>,
    tree: Option<Nearest>,
    /// The groups that are not taken, in the order of the list.
    left: Vec<usize>,
    /// Where each group stands in that list.
    ranks: Vec<usize>,
}

impl Next {
    /// Groups of at least one place each.
    pub(super) fn new<P: IntoIterator<Item = Point>>(groups: impl Iterator<Item = P>) -> Self {
        let (mut starts, mut places) = (vec![0], Vec::new());
        for group in groups {
            places.extend(group);
            starts.push(places.len());
        }
        let count = starts.len() - 1;
        let (mut owners, mut tree) = (Vec::new(), None);
        if count > FEW {
            owners.extend((0..count).flat_map(|k| (starts[k]..starts[k + 1]).map(move |_| k)));
            tree = Some(Nearest::new(places.clone()));
        }
        Self {
            starts,
            places,
            owners,
            tree,
            left: (0..count).collect(),
            ranks: (0..count).collect(),
        }
    }

    /// Takes the group nearest to `at`: which it is, and which of its places is nearest. The others
    /// keep their order.
    pub(super) fn take(&mut self, at: Point) -> Option<(usize, usize)> {
        let found = self.nearest(at)?;
        self.drop_places(found.0);
        if self.tree.is_none() {
            // The list stays in order.
            self.left.remove(self.left.partition_point(|&k| k < found.0));
        }
        Some(found)
    }

    /// As [`Self::take`], but the last of the list takes the place of what is taken.
    pub(super) fn swap_take(&mut self, at: Point) -> Option<(usize, usize)> {
        let found = self.nearest(at)?;
        self.drop_places(found.0);
        let rank = self.ranks[found.0];
        self.left.swap_remove(rank);
        if let Some(moved) = self.left.get(rank) {
            self.ranks[*moved] = rank;
        }
        Some(found)
    }

    fn nearest(&self, at: Point) -> Option<(usize, usize)> {
        if let Some(tree) = &self.tree {
            let place = tree.nearest(at, |k| (self.ranks[self.owners[k]], k))?;
            let group = self.owners[place];
            return Some((group, place - self.starts[group]));
        }
        let place = |group: usize| {
            let places = &self.places[self.starts[group]..self.starts[group + 1]];
            let far = places.iter().map(|p| p.distance2(at)).enumerate();
            far.min_by_key(|&(k, far)| (far, k)).map(|(k, far)| (far, group, k))
        };
        let found = self.left.iter().filter_map(|&group| place(group));
        // Of equal ones the first in the list.
        found.min_by_key(|(far, ..)| *far).map(|(_, group, k)| (group, k))
    }

    fn drop_places(&mut self, group: usize) {
        if let Some(tree) = &mut self.tree {
            (self.starts[group]..self.starts[group + 1]).for_each(|k| tree.take(k));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn next(groups: &[Vec<(i32, i32)>]) -> Next {
        Next::new(groups.iter().map(|group| group.iter().map(|&(x, y)| Point { x, y })))
    }

    proptest! {
        /// Asked one after the other and by a tree, groups come in the same order, which is that of
        /// a list from which the nearest is taken.
        #[test]
        fn many_come_in_the_order_of_few(
            groups in prop::collection::vec(prop::collection::vec((0..40, 0..40), 1..5), 65..110),
            swaps in any::<bool>(),
        ) {
            let mut tree = next(&groups);
            prop_assert!(tree.tree.is_some());
            let mut one_by_one = next(&groups);
            one_by_one.tree = None;
            let mut list: Vec<usize> = (0..groups.len()).collect();
            let mut at = Point { x: 0, y: 0 };
            while !list.is_empty() {
                let far = |&k: &usize| {
                    let far = groups[k].iter().map(|&(x, y)| Point { x, y }.distance2(at));
                    far.enumerate().min_by_key(|&(k, far)| (far, k)).unwrap()
                };
                let (rank, (place, _)) = list.iter().map(far).enumerate()
                    .min_by_key(|&(k, (_, far))| (far, k)).unwrap();
                let expected = (list[rank], place);
                let take = if swaps { Next::swap_take } else { Next::take };
                prop_assert_eq!(take(&mut tree, at), Some(expected));
                prop_assert_eq!(take(&mut one_by_one, at), Some(expected));
                if swaps {
                    list.swap_remove(rank);
                } else {
                    list.remove(rank);
                }
                let (x, y) = groups[expected.0][place];
                at = Point { x: x + 3, y };
            }
            prop_assert_eq!(tree.take(at), None);
        }
    }
}
