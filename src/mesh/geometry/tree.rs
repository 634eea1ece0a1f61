//! Triangles -> Tree: a tree of boxes that finds the triangles above a point, and pairs whose boxes touch
//! (bounding volume hierarchy).
//!
//! The triangles are sorted by the Morton code of the middles of their boxes (Morton, 1966: the
//! bits of x, y and z in turn), so that triangles close to each other in space are close in the order. Four
//! triangles in a row are a leaf, and two nodes in a row have a parent on the next level: the
//! tree needs no pointers, only a box for each node. Building it takes n log n time.
//!
//! A query from above walks down from the root through all boxes that the ray can hit. A query for pairs
//! walks two nodes at a time, one from a group of leaves and one from the root down, and
//! splits the larger one while their boxes touch. Groups are independent, so that threads can
//! share them; steps are counted, so that a hostile mesh cannot take quadratic time.
//!
//! All predicates are exact integers. A ray never hits an edge or a corner: the point counts as
//! moved by an infinitesimal (Edelsbrunner and Mücke, 1990: simulation of simplicity).

use super::bounds::Bounds;
use super::measure::corners_of;
use super::vector::{dot, minus, normal};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::ops::ControlFlow;

/// Triangles of a leaf. Two make the tree twice as large; eight test more boxes of triangles in
/// vain.
const LEAF: usize = 4;

/// The level of the nodes that are the groups of [`Tree::pairs`]: 16 leaves, 64 triangles. Smaller
/// groups walk the upper levels more often; larger ones give threads less to share.
const GROUP_LEVEL: usize = 4;

/// Bits of each coordinate in a Morton code: three times 21 fit a `u64`.
const BITS: u32 = 21;

/// One node: number `index` of those of `level`, the leaves being level 0.
#[derive(Debug, Clone, Copy)]
struct Node {
    level: usize,
    index: usize,
}

impl Node {
    /// The first leaf under it.
    fn start(self) -> usize {
        self.index << self.level
    }

    /// One past the last leaf that can be under it.
    fn end(self) -> usize {
        (self.index + 1) << self.level
    }

    /// Its children; the second may be missing.
    fn children(self) -> [Self; 2] {
        let child = |k: usize| Self { level: self.level - 1, index: 2 * self.index + k };
        [child(0), child(1)]
    }
}

/// A tree of boxes over the triangles of a mesh. It takes about 16 bytes for each triangle, and 16
/// more while it is built.
#[derive(Debug, Clone)]
pub struct Tree<'a> {
    vertices: &'a [[i32; 3]],
    triangles: &'a [[u32; 3]],
    /// The triangles in the order of the leaves.
    order: Vec<u32>,
    /// The boxes of each level, leaves first; the last level has one. Empty without triangles.
    levels: Vec<Vec<Bounds>>,
}

impl<'a> Tree<'a> {
    /// The tree over fewer than 2³⁰ `triangles`, whose corners are indices into `vertices`.
    /// Coordinates are grid units, within ±10⁸.
    ///
    /// # Panics
    /// If a triangle names a vertex that is not there.
    #[must_use]
    pub fn new(vertices: &'a [[i32; 3]], triangles: &'a [[u32; 3]]) -> Self {
        let mut tree = Self { vertices, triangles, order: Vec::new(), levels: Vec::new() };
        if triangles.is_empty() {
            return tree;
        }
        tree.order = tree.sorted();
        let leaves = tree.order.par_chunks(LEAF);
        let mut level: Vec<Bounds> = leaves
            .map(|leaf| leaf.iter().fold(Bounds::NONE, |all, &t| all.join(tree.bounds(t))))
            .collect();
        while level.len() > 1 {
            let pairs = level.par_chunks(2);
            let next = pairs.map(|pair| pair.iter().fold(Bounds::NONE, |all, &b| all.join(b)));
            let next = next.collect();
            tree.levels.push(std::mem::replace(&mut level, next));
        }
        tree.levels.push(level);
        tree
    }

    /// The corners of a triangle, grid units.
    #[must_use]
    pub fn corners(&self, triangle: u32) -> [[i32; 3]; 3] {
        corners_of(self.vertices, self.triangles[triangle as usize])
    }

    /// The box of a triangle.
    pub(crate) fn bounds(&self, triangle: u32) -> Bounds {
        Bounds::of(self.corners(triangle))
    }

    /// The triangles in the order of their Morton codes; equal ones in the order of their numbers.
    #[expect(clippy::cast_possible_truncation, reason = "fewer than 2^30 triangles, see new")]
    fn sorted(&self) -> Vec<u32> {
        let numbers = || (0..self.triangles.len() as u32).into_par_iter();
        let all = numbers().map(|t| self.bounds(t)).reduce(|| Bounds::NONE, Bounds::join);
        let side = |axis: usize| i64::from(all.high[axis]) - i64::from(all.low[axis]);
        let longest = side(0).max(side(1)).max(side(2)).max(1);
        // Middles are doubled, so that they are integers; after the shift they are below 2^BITS.
        let used = u64::BITS - (2 * longest).unsigned_abs().leading_zeros();
        let shift = used.saturating_sub(BITS);
        let code = |t: u32| {
            let Bounds { low, high } = self.bounds(t);
            let bits = |axis: usize| {
                let middle = i64::from(low[axis]) + i64::from(high[axis]);
                spread((middle - 2 * i64::from(all.low[axis])).unsigned_abs() >> shift)
            };
            bits(0) | bits(1) << 1 | bits(2) << 2
        };
        let mut keys: Vec<(u64, u32)> = numbers().map(|t| (code(t), t)).collect();
        keys.par_sort_unstable();
        keys.into_par_iter().map(|(_, t)| t).collect()
    }

    /// Calls `hit` with every triangle that the ray from `point` straight up passes through. The
    /// sign is 1 if the triangle's normal points up, where the ray leaves a body, and -1 if down.
    /// The signs of a closed shell add up to its winding number around the point.
    ///
    /// Exact, and without special cases: the point counts as moved by (e, e², e³), where e is
    /// smaller than any number. So a ray through an edge or a vertex of a closed mesh passes
    /// through one triangle of each fan. Vertical triangles and those without area are never hit.
    /// A point on a triangle is below or above it after the move: on a side of a box it is inside
    /// if the box lies towards larger x, on a top it is outside, and on a bottom inside.
    ///
    /// In a usual mesh it takes the time of the hits, and of the logarithm of the number of
    /// triangles.
    pub fn above(&self, point: [i32; 3], mut hit: impl FnMut(u32, i32)) {
        let Some(level) = self.levels.len().checked_sub(1) else { return };
        self.above_in(Node { level, index: 0 }, point, &mut hit);
    }

    fn above_in(&self, node: Node, point: [i32; 3], hit: &mut impl FnMut(u32, i32)) {
        if !self.levels[node.level].get(node.index).is_some_and(|bounds| bounds.is_over(point)) {
            return;
        }
        if node.level > 0 {
            for child in node.children() {
                self.above_in(child, point, hit);
            }
            return;
        }
        for &triangle in self.leaf(node.index) {
            if let Some(sign) = passes(point, self.corners(triangle)) {
                hit(triangle, sign);
            }
        }
    }

    /// The triangles of a leaf.
    fn leaf(&self, index: usize) -> &[u32] {
        let start = index * LEAF;
        &self.order[start..self.order.len().min(start + LEAF)]
    }

    /// The number of groups of about 64 triangles, see [`Tree::pairs`].
    #[must_use]
    pub fn groups(&self) -> usize {
        self.levels.get(self.group_level()).map_or(0, Vec::len)
    }

    fn group_level(&self) -> usize {
        GROUP_LEVEL.min(self.levels.len().saturating_sub(1))
    }

    /// Calls `pair` with all pairs of different triangles whose boxes touch, one of them in `group`
    /// and the other in it or in a later group. Over all groups each pair comes once. Groups are
    /// independent, so that they can be walked in parallel.
    ///
    /// `steps` is counted down by one for each pair of nodes and each pair of triangles; at 0 the
    /// walk ends.
    ///
    /// # Errors
    /// [`ControlFlow::Break`] if `pair` returned it, or if the steps are used up.
    pub fn pairs(
        &self,
        group: usize,
        steps: &mut u64,
        mut pair: impl FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Some(top) = self.levels.len().checked_sub(1) else { return ControlFlow::Continue(()) };
        let group = Node { level: self.group_level(), index: group };
        let mut stack = vec![[group, Node { level: top, index: 0 }]];
        while let Some([a, b]) = stack.pop() {
            count_down(steps)?;
            if b.end() <= a.start() || !self.nodes_touch(a, b) {
                continue;
            }
            if a.level + b.level == 0 {
                self.pairs_of_leaves(a.index, b.index, steps, &mut pair)?;
            } else if b.level >= a.level {
                stack.extend(b.children().map(|b| [a, b]));
            } else {
                stack.extend(a.children().map(|a| [a, b]));
            }
        }
        ControlFlow::Continue(())
    }

    fn nodes_touch(&self, a: Node, b: Node) -> bool {
        let bounds = |node: Node| self.levels[node.level].get(node.index);
        bounds(a).zip(bounds(b)).is_some_and(|(a, b)| a.touches(b))
    }

    fn pairs_of_leaves(
        &self,
        a: usize,
        b: usize,
        steps: &mut u64,
        pair: &mut impl FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let others = self.leaf(b);
        let mut boxes = [Bounds::NONE; LEAF];
        for (slot, &other) in boxes.iter_mut().zip(others) {
            *slot = self.bounds(other);
        }
        for (k, &one) in self.leaf(a).iter().enumerate() {
            let bounds = self.bounds(one);
            let first = if a == b { k + 1 } else { 0 };
            for (&other, others) in others.iter().zip(&boxes).skip(first) {
                if bounds.touches(others) {
                    count_down(steps)?;
                    pair(one, other)?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// Takes one step, if there is one left.
fn count_down(steps: &mut u64) -> ControlFlow<()> {
    match steps.checked_sub(1) {
        Some(left) => *steps = left,
        None => return ControlFlow::Break(()),
    }
    ControlFlow::Continue(())
}

/// The lower [`BITS`] bits with two zeros between each and the next.
fn spread(bits: u64) -> u64 {
    let mut bits = bits & ((1 << BITS) - 1);
    for (shift, mask) in [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}

/// Whether the ray up from the moved point passes through the triangle: 1 if its normal points up,
/// -1 if it points down.
fn passes(point: [i32; 3], corners: [[i32; 3]; 3]) -> Option<i32> {
    let p = point.map(i64::from);
    let [a, b, c] = corners.map(|corner| corner.map(i64::from));
    let normal = normal([a, b, c]);
    let facing = normal[2].cmp(&0);
    let inside = facing != Ordering::Equal
        && [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| side(from, to, p) == facing);
    if !inside {
        return None;
    }
    let height = dot(normal, minus(p, a));
    // The moved point is off the plane by e·normal.x + e²·normal.y + e³·normal.z.
    let out =
        height.cmp(&0).then(normal[0].cmp(&0)).then(normal[1].cmp(&0)).then(normal[2].cmp(&0));
    match (out == facing, facing) {
        (true, _) => None,
        (false, Ordering::Greater) => Some(1),
        (false, _) => Some(-1),
    }
}

/// The side of the line through two points on which the moved point lies, seen from above: greater
/// is left. Equal only if the line has no length in x and y.
fn side(from: [i64; 3], to: [i64; 3], point: [i64; 3]) -> Ordering {
    let (along, towards) = (minus(to, from), minus(point, from));
    // The moved point's product is larger by e²·along.x - e·along.y.
    let product = along[0] * towards[1] - along[1] * towards[0];
    product.cmp(&0).then(0.cmp(&along[1])).then(along[0].cmp(&0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::vector::cross;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    /// The corners of a box, x in the lowest bit, and its faces wound outward.
    fn cuboid(low: i32, high: i32) -> (Vec<[i32; 3]>, Vec<[u32; 3]>) {
        let corner = |k: u32| [1, 2, 4].map(|bit| if k & bit == 0 { low } else { high });
        let faces =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let split = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        ((0..8).map(corner).collect(), faces.into_iter().flat_map(split).collect())
    }

    fn winding(tree: &Tree, point: [i32; 3]) -> i32 {
        let mut sum = 0;
        tree.above(point, |_, sign| sum += sign);
        sum
    }

    #[test]
    fn a_point_on_the_skin_of_a_box_is_inside_on_the_low_sides() {
        for (low, high) in [(0, 2), (-100_000_000, 100_000_000)] {
            let (vertices, mut triangles) = cuboid(low, high);
            for sign in [1, -1] {
                let tree = Tree::new(&vertices, &triangles);
                let values = [low - 1, low, low + 1, (low + high) / 2, high - 1, high, high + 1];
                for (x, y, z) in triples(&values) {
                    let inside = [x, y, z].iter().all(|&v| low <= v && v < high);
                    let expected = if inside { sign } else { 0 };
                    assert_eq!(winding(&tree, [x, y, z]), expected, "{x} {y} {z}");
                }
                triangles.iter_mut().for_each(|corners| corners.reverse());
            }
        }
    }

    fn triples(values: &[i32]) -> impl Iterator<Item = (i32, i32, i32)> {
        let pairs = values.iter().flat_map(move |&x| values.iter().map(move |&y| (x, y)));
        pairs.flat_map(move |(x, y)| values.iter().map(move |&z| (x, y, z)))
    }

    #[test]
    fn a_hit_names_its_triangle_and_the_way_it_faces() {
        let (vertices, triangles) = cuboid(0, 10);
        let tree = Tree::new(&vertices, &triangles);
        let mut hits = Vec::new();
        tree.above([3, 2, -5], |triangle, sign| hits.push((triangle, sign)));
        hits.sort_unstable();
        assert_eq!(hits, [(1, -1), (2, 1)]);
    }

    #[test]
    fn nothing_has_no_triangles_above_and_no_pairs() {
        let tree = Tree::new(&[], &[]);
        assert_eq!((winding(&tree, [0; 3]), tree.groups()), (0, 0));
        assert!(tree.pairs(0, &mut 9, |_, _| ControlFlow::Break(())).is_continue());
        let tree = Tree::new(&[[5; 3]], &[[0; 3]]);
        assert_eq!((winding(&tree, [5; 3]), tree.groups()), (0, 1));
    }

    #[test]
    fn a_walk_ends_when_its_steps_are_used_up_or_it_is_told_to() {
        let triangles = vec![[0, 1, 2]; 64];
        let tree = Tree::new(&[[0, 0, 0], [9, 0, 0], [0, 9, 0]], &triangles);
        let walk = |mut steps: u64, most: usize| {
            let mut seen = 0;
            let flow = tree.pairs(0, &mut steps, |_, _| {
                seen += 1;
                if seen < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            });
            (seen, flow.is_continue())
        };
        assert_eq!(walk(u64::MAX, usize::MAX), (64 * 63 / 2, true));
        assert_eq!(walk(u64::MAX, 7), (7, false));
        let (seen, ended) = walk(200, usize::MAX);
        assert!((100..200).contains(&seen) && !ended, "{seen}");
    }

    /// The winding number of a tetrahedron about a point moved by 10⁻⁶, 10⁻¹² and 10⁻¹⁸.
    fn expected_winding(corners: [[i32; 3]; 4], point: [i32; 3]) -> i32 {
        let unit = 1_000_000_i128.pow(3);
        let shift = [1_000_000_000_000, 1_000_000, 1];
        let moved: [i128; 3] =
            std::array::from_fn(|axis| i128::from(point[axis]) * unit + shift[axis]);
        let sides = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|face: [usize; 3]| {
            let [a, b, c] = face.map(|k| corners[k].map(i64::from));
            let normal = cross(minus(b, a), minus(c, a));
            (0..3)
                .map(|axis| i128::from(normal[axis]) * (moved[axis] - i128::from(a[axis]) * unit))
                .sum::<i128>()
                .signum()
        });
        match sides {
            [-1, -1, -1, -1] => 1,
            [1, 1, 1, 1] => -1,
            _ => 0,
        }
    }

    fn soup(side: i32, most: usize) -> impl Strategy<Value = Vec<[[i32; 3]; 3]>> {
        prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-side..=side)), 0..most)
    }

    fn mesh_of(soup: &[[[i32; 3]; 3]]) -> (Vec<[i32; 3]>, Vec<[u32; 3]>) {
        let numbers = (0..soup.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        (soup.concat(), numbers.collect())
    }

    proptest! {
        #[test]
        fn windings_about_a_tetrahedron_are_those_of_its_faces(
            corners in prop::array::uniform4(prop::array::uniform3(-4..=4)),
            points in prop::collection::vec(prop::array::uniform3(-4..=4), 40),
        ) {
            let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
            let tree = Tree::new(&corners, &triangles);
            for point in points.into_iter().chain(corners) {
                prop_assert_eq!(winding(&tree, point), expected_winding(corners, point));
            }
        }

        #[test]
        fn the_tree_misses_no_hit(soup in soup(9, 300), points in soup(9, 9)) {
            let (vertices, triangles) = mesh_of(&soup);
            let tree = Tree::new(&vertices, &triangles);
            for point in points.concat() {
                let mut found = Vec::new();
                tree.above(point, |triangle, sign| found.push((triangle, sign)));
                found.sort_unstable();
                let all = (0..triangles.len() as u32)
                    .filter_map(|t| Some((t, passes(point, tree.corners(t))?)));
                prop_assert_eq!(found, all.collect::<Vec<_>>());
            }
        }

        #[test]
        fn every_pair_of_touching_boxes_comes_once(
            soup in prop_oneof![soup(1000, 300), soup(100_000_000, 200), soup(2, 100)],
            size in 1..1000,
        ) {
            // Smaller triangles at the same places, so that not all boxes touch.
            let about = |[a, b, c]: [[i32; 3]; 3]| {
                let near = |v: [i32; 3]| -> [i32; 3] {
                    std::array::from_fn(|axis| a[axis] + (v[axis] - a[axis]) / size)
                };
                [a, near(b), near(c)]
            };
            let soup: Vec<_> = soup.into_iter().map(about).collect();
            let (vertices, triangles) = mesh_of(&soup);
            let tree = Tree::new(&vertices, &triangles);
            let (mut found, mut steps) = (Vec::new(), u64::MAX);
            for group in 0..tree.groups() {
                let flow = tree.pairs(group, &mut steps, |a, b| {
                    found.push([a.min(b), a.max(b)]);
                    ControlFlow::Continue(())
                });
                prop_assert!(flow.is_continue());
            }
            let numbers = 0..triangles.len() as u32;
            let all = numbers.clone().flat_map(|a| numbers.clone().skip(a as usize + 1).map(move |b| [a, b]));
            let touching = all.filter(|&[a, b]| tree.bounds(a).touches(&tree.bounds(b)));
            prop_assert_eq!(found.len(), found.iter().collect::<BTreeSet<_>>().len());
            found.sort_unstable();
            prop_assert_eq!(found, touching.collect::<Vec<_>>());
        }
    }
}
