//! Points -> Nearest: finds the nearest of the points that are left, while some are taken away.
//!
//! A k-d tree (Bentley 1975): half of the points of a node lie in each of its two children, divided
//! across the longer side of the box around them. Children stand at twice the number of their node,
//! and one more: the tree needs no pointers.
//!
//! A node knows the box around those of its points that are left. So a question passes by what has
//! been taken: it is as quick on a plate from which all of one side is gone as it was in the
//! beginning. Building takes n log n time; a question, or taking a point away, mostly takes log n.
//!
//! Of equally near points the caller says which is found: the result depends on nothing else.

use super::Point;
use super::nest::extent;
use std::cmp::Ordering;
use std::ops::Range;

/// Most points of a node without children. It affects speed only.
const LEAF: usize = 8;

/// Points, some of which may be taken away.
#[derive(Debug)]
pub struct Nearest {
    points: Vec<Point>,
    /// The numbers of the points, those of each node together; and where each stands.
    order: Vec<usize>,
    places: Vec<usize>,
    is_left: Vec<bool>,
    /// The box around what is left of each node; the children of node k are 2 k + 1 and 2 k + 2.
    nodes: Vec<Option<(Point, Point)>>,
}

impl Nearest {
    /// The tree of `points`.
    #[must_use]
    pub fn new(points: Vec<Point>) -> Self {
        let count = points.len();
        let mut tree = Self {
            order: (0..count).collect(),
            places: vec![0; count],
            is_left: vec![true; count],
            nodes: Vec::new(),
            points,
        };
        tree.build(0, 0..count);
        (0..count).for_each(|place| tree.places[tree.order[place]] = place);
        tree
    }

    fn build(&mut self, node: usize, range: Range<usize>) {
        let around = extent(self.order[range.clone()].iter().map(|&k| &self.points[k]));
        if self.nodes.len() <= node {
            self.nodes.resize(node + 1, None);
        }
        self.nodes[node] = around;
        let (Some([lower, upper]), Some((low, high))) = (halves(&range), around) else { return };
        let points = &self.points;
        let is_wide = high.x - low.x >= high.y - low.y;
        let key = |&k: &usize| if is_wide { (points[k].x, k) } else { (points[k].y, k) };
        let middle = lower.len();
        self.order[range].select_nth_unstable_by_key(middle, key);
        self.build(2 * node + 1, lower);
        self.build(2 * node + 2, upper);
    }

    /// Takes point `k` away.
    pub fn take(&mut self, k: usize) {
        self.is_left[k] = false;
        self.shrink(0, 0..self.points.len(), self.places[k]);
    }

    /// Measures the nodes around a place of the order anew, of which the point was taken. What lies on no side of a
    /// box leaves it as it is.
    fn shrink(&mut self, node: usize, range: Range<usize>, place: usize) {
        let Point { x, y } = self.points[self.order[place]];
        let is_within =
            |(low, high): (Point, Point)| low.x < x && x < high.x && low.y < y && y < high.y;
        let keeps = self.nodes[node].is_some_and(is_within);
        if let Some([lower, upper]) = halves(&range) {
            let [one, other] = [2 * node + 1, 2 * node + 2];
            if lower.contains(&place) {
                self.shrink(one, lower, place);
            } else {
                self.shrink(other, upper, place);
            }
            if !keeps {
                let both = [self.nodes[one], self.nodes[other]];
                self.nodes[node] =
                    extent(both.iter().flatten().flat_map(|(low, high)| [low, high]));
            }
        } else if !keeps {
            let left = self.order[range].iter().filter(|&&k| self.is_left[k]);
            self.nodes[node] = extent(left.map(|&k| &self.points[k]));
        }
    }

    /// The number of the point that is nearest to `at` among those that are left; of equally near
    /// ones that with the least `rank`, which no two of them share.
    pub fn nearest<R: Ord>(&self, at: Point, rank: impl Fn(usize) -> R) -> Option<usize> {
        let mut best = None;
        self.search((0, 0..self.points.len()), at, &rank, &mut best);
        best.map(|(.., k)| k)
    }

    fn search<R: Ord>(
        &self,
        (node, range): (usize, Range<usize>),
        at: Point,
        rank: &impl Fn(usize) -> R,
        best: &mut Option<(i64, R, usize)>,
    ) {
        let far = self.far2(node, at);
        if far.is_none_or(|far| best.as_ref().is_some_and(|best| far > best.0)) {
            return;
        }
        if let Some([lower, upper]) = halves(&range) {
            let mut both = [(2 * node + 1, lower), (2 * node + 2, upper)];
            // Whichever may be nearer first; without a box nothing is left there.
            let far = |node| self.far2(node, at).unwrap_or(i64::MAX);
            if far(both[1].0) < far(both[0].0) {
                both.reverse();
            }
            both.into_iter().for_each(|child| self.search(child, at, rank, best));
            return;
        }
        for &k in self.order[range].iter().filter(|&&k| self.is_left[k]) {
            let far = self.points[k].distance2(at);
            let order = best.as_ref().map_or(Ordering::Less, |best| far.cmp(&best.0));
            let is_better = match order {
                Ordering::Equal => best.as_ref().is_some_and(|best| rank(k) < best.1),
                order => order.is_lt(),
            };
            if is_better {
                *best = Some((far, rank(k), k));
            }
        }
    }

    /// The squared distance from `at` to what is left of a node; `None` if that is nothing.
    fn far2(&self, node: usize, at: Point) -> Option<i64> {
        let (low, high) = self.nodes[node]?;
        let inside = Point { x: at.x.clamp(low.x, high.x), y: at.y.clamp(low.y, high.y) };
        Some(inside.distance2(at))
    }

    /// Some point that is left and that `holds`. Boxes of which it holds none are those that do not
    /// `meet` what is looked for.
    pub fn find(
        &self,
        meets: impl Fn((Point, Point)) -> bool,
        holds: impl Fn(usize) -> bool,
    ) -> Option<usize> {
        let mut open = vec![(0, 0..self.points.len())];
        while let Some((node, range)) = open.pop() {
            if !self.nodes[node].is_some_and(&meets) {
                continue;
            }
            match halves(&range) {
                Some([lower, upper]) => open.extend([(2 * node + 1, lower), (2 * node + 2, upper)]),
                None => {
                    let mut left = self.order[range].iter().filter(|&&k| self.is_left[k]);
                    if let Some(found) = left.find(|&&k| holds(k)) {
                        return Some(*found);
                    }
                }
            }
        }
        None
    }

    /// The numbers of the points that are left in a box of lowest and highest x and y, in their order.
    #[must_use]
    pub fn within(&self, area: (Point, Point)) -> Vec<usize> {
        let mut found = Vec::new();
        let mut open = vec![(0, 0..self.points.len())];
        let is_in = |p: Point| super::nest::meet(area, (p, p));
        while let Some((node, range)) = open.pop() {
            if !self.nodes[node].is_some_and(|own| super::nest::meet(own, area)) {
                continue;
            }
            match halves(&range) {
                Some([lower, upper]) => open.extend([(2 * node + 1, lower), (2 * node + 2, upper)]),
                None => {
                    let left = self.order[range].iter().filter(|&&k| self.is_left[k]);
                    found.extend(left.filter(|&&k| is_in(self.points[k])));
                }
            }
        }
        found.sort_unstable();
        found
    }
}

/// What of a node's points each of its children has, if it has any.
fn halves(range: &Range<usize>) -> Option<[Range<usize>; 2]> {
    let middle = range.start.midpoint(range.end);
    (range.len() > LEAF).then_some([range.start..middle, middle..range.end])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_nearest_of_those_left_is_found_until_none_is_left(
            points in prop::collection::vec((-20..20, -20..20), 1..90),
            places in prop::collection::vec((-30..30, -30..30), 90),
        ) {
            let points: Vec<Point> = points.into_iter().map(|(x, y)| Point { x, y }).collect();
            let mut tree = Nearest::new(points.clone());
            let mut left: Vec<usize> = (0..points.len()).collect();
            // Ranks that run against the numbers.
            let rank = |k: usize| points.len() - k;
            for (x, y) in places {
                let at = Point { x, y };
                let expected = left.iter().copied().min_by_key(|&k| (points[k].distance2(at), rank(k)));
                prop_assert_eq!(tree.nearest(at, rank), expected);
                let area = (at, Point { x: x + 9, y: y + 5 });
                let is_in = |k: &usize| super::super::nest::meet(area, (points[*k], points[*k]));
                let inside: Vec<usize> = left.iter().copied().filter(is_in).collect();
                prop_assert_eq!(tree.within(area), inside);
                let Some(k) = expected else { break };
                tree.take(k);
                left.retain(|&other| other != k);
            }
        }
    }

    #[test]
    fn a_field_is_emptied_in_n_log_n_questions() {
        use std::cell::Cell;
        // How many points are looked at while the nearest is taken again and again.
        let looked = |side: i32| {
            let points = (0..side * side).map(|k| Point { x: k % side * 997, y: k / side * 1009 });
            let mut tree = Nearest::new(points.collect());
            let (mut at, looks) = (Point { x: 0, y: 0 }, Cell::new(0_u64));
            let rank = |k: usize| {
                looks.set(looks.get() + 1);
                k
            };
            while let Some(k) = tree.nearest(at, rank) {
                at = tree.points[k];
                tree.take(k);
            }
            looks.get()
        };
        let (few, many) = (looked(20), looked(80));
        assert!(many < 20 * few, "{few} for 400 points, {many} for 6400");
    }
}
