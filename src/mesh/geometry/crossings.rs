//! Tree -> Crossings: finds the pairs of triangles that pass through each other.
//!
//! Two triangles cross if each passes through the other along a line of some length. Triangles
//! that share a side, that only touch in a point or along a line, that lie in one plane, or that
//! have no area do not cross. Only coordinates count, so that it does not matter whether equal
//! corners are one vertex.
//!
//! The tree of boxes gives the pairs whose boxes touch. The test of a pair takes exact signs of
//! determinants (after Guigue and Devillers, 2003): each triangle must have corners on both sides
//! of the other's plane; then each covers an interval of the line in which the planes meet, and the
//! triangles cross if the intervals overlap.
//!
//! Groups of triangles are walked by all threads, some at a time. Between these batches the pairs
//! and steps are counted, so that a mesh of random triangles ends early, with the same result on
//! any number of threads.

use super::tree::Tree;
use super::vector::{dot, length, minus, normal};
use crate::units::UNITS_PER_MM;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::ops::ControlFlow;

/// Most pairs that [`crossings`] returns. A report needs far fewer; without a limit, random triangles fill
/// the memory.
pub const MOST_PAIRS: usize = 1 << 20;

/// Steps of [`Tree::pairs`] that a mesh of any size may take: less than a second.
const STEPS: u64 = 1 << 26;

/// Steps more for each group of about 64 triangles. Real meshes take 2000 to 3000; a value below
/// would leave crossings of large sound meshes unreported.
const STEPS_OF_GROUP: u64 = 1 << 13;

/// Groups that are walked in parallel before pairs and steps are counted again. Each may take
/// 1/32 of the limits, so that these are exceeded twofold at worst.
const BATCH: usize = 32;

/// The pairs of triangles that cross.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Crossings {
    /// The numbers of the two triangles, the lower first. Pairs are ordered by the z, y and x of
    /// their [`place`], then by the numbers. At most [`MOST_PAIRS`].
    pub pairs: Vec<[u32; 2]>,
    /// Whether these are all. If not, there may be more anywhere.
    pub complete: bool,
}

/// Finds the triangles that pass through each other, exactly, in n log n time for a usual mesh.
///
/// It ends early with more than [`MOST_PAIRS`] crossings, with 1/32 of that within one group, or after a
/// number of steps that no real mesh takes. The result does not depend on the number of threads.
/// If it is complete it does not depend on the order of the triangles, except for their numbers.
#[must_use]
pub fn crossings(tree: &Tree) -> Crossings {
    crossings_within(tree, STEPS + STEPS_OF_GROUP * tree.groups() as u64)
}

/// As [`crossings`], in about `most_steps` of [`Tree::pairs`].
fn crossings_within(tree: &Tree, most_steps: u64) -> Crossings {
    let groups = tree.groups();
    let (mut done, mut steps) = (0, 0);
    let mut all = Crossings { pairs: Vec::new(), complete: true };
    while done < groups && steps < most_steps && all.pairs.len() <= MOST_PAIRS {
        let end = groups.min(done + BATCH);
        let walk = |group| of_group(tree, group, most_steps / BATCH as u64);
        let batch: Vec<(Crossings, u64)> = (done..end).into_par_iter().map(walk).collect();
        for (found, taken) in batch {
            all.pairs.extend(found.pairs);
            all.complete &= found.complete;
            steps += taken;
        }
        done = end;
    }
    all.complete &= done == groups && all.pairs.len() <= MOST_PAIRS;
    let key = |&pair: &[u32; 2]| {
        let [x, y, z] = place(tree, pair);
        ([z, y, x], pair)
    };
    all.pairs.par_sort_by_cached_key(key);
    all.pairs.truncate(MOST_PAIRS);
    all
}

/// Where two triangles of a tree cross: the middle of the box that their boxes have in common,
/// grid units.
#[must_use]
pub fn place(tree: &Tree, pair: [u32; 2]) -> [i32; 3] {
    let [a, b] = pair.map(|triangle| tree.bounds(triangle));
    let common = a.common(b);
    std::array::from_fn(|axis| common.low[axis].midpoint(common.high[axis]))
}

/// How deep two crossing triangles of a tree are in each other, mm: each reaches past the plane of
/// the other by at least that, on both sides.
///
/// Rounding to the grid alone makes crossings of up to two grid units, where corners lie on sides
/// or surfaces lie on each other. The result is rounded, but the same on every machine.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "a length to be reported and compared, not a sign")]
pub fn depth(tree: &Tree, pair: [u32; 2]) -> f64 {
    let [a, b] = pair.map(|triangle| tree.corners(triangle).map(|corner| corner.map(i64::from)));
    let past = |plane: [[i64; 3]; 3], corners: [[i64; 3]; 3]| {
        let normal = normal(plane);
        let heights = corners.map(|corner| dot(normal, minus(corner, plane[0])) as f64);
        let upper = heights.into_iter().fold(0.0, f64::max);
        let lower = heights.into_iter().fold(0.0, f64::min);
        upper.min(-lower) / length(normal).max(1.0)
    };
    past(a, b).min(past(b, a)) / UNITS_PER_MM
}

/// The crossings of the triangles of a group with each other and with later ones, and the steps
/// that it took, at most `most`.
fn of_group(tree: &Tree, group: usize, most: u64) -> (Crossings, u64) {
    let (mut pairs, mut left) = (Vec::new(), most);
    let flow = tree.pairs(group, &mut left, |a, b| {
        if do_cross(tree.corners(a), tree.corners(b)) {
            pairs.push([a.min(b), a.max(b)]);
        }
        match pairs.len() > MOST_PAIRS / BATCH {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    (Crossings { pairs, complete: flow.is_continue() }, most - left)
}

/// Whether two triangles cross.
///
/// After Guigue and Devillers, "Fast and robust triangle-triangle overlap test using orientation
/// predicates", 2003, with strict signs. Each triangle has corners on both sides of the other's
/// plane, so that it covers an interval of the line in which the planes meet. The intervals
/// overlap if each begins before the other ends; a determinant's sign says which comes first.
fn do_cross(a: [[i32; 3]; 3], b: [[i32; 3]; 3]) -> bool {
    let [a, b] = [a, b].map(|corners| corners.map(|corner| corner.map(i64::from)));
    let Some((a, a_side)) = alone_first(a, b) else { return false };
    let Some((b, b_side)) = alone_first(b, a) else { return false };
    // Turned so that each first corner is on the upper side of the other triangle.
    let turn = |[first, second, third]: [[i64; 3]; 3], side: Ordering| match side {
        Ordering::Greater => [first, second, third],
        _ => [first, third, second],
    };
    let (a, b) = (turn(a, b_side), turn(b, a_side));
    side([a[0], a[1], b[0]], b[1]) == Ordering::Less
        && side([a[0], a[2], b[2]], b[0]) == Ordering::Less
}

/// The corners in the same sense, beginning with one that is alone on its side of the plane of
/// `other`, and that side. `None` if the corners are not on both sides.
fn alone_first(corners: [[i64; 3]; 3], other: [[i64; 3]; 3]) -> Option<([[i64; 3]; 3], Ordering)> {
    let sides = corners.map(|corner| side(other, corner));
    if !sides.contains(&Ordering::Less) || !sides.contains(&Ordering::Greater) {
        return None;
    }
    let alone = |&k: &usize| {
        sides[k] != Ordering::Equal && (1..3).all(|next| sides[(k + next) % 3] != sides[k])
    };
    let first = (0..3).find(alone)?;
    Some((std::array::from_fn(|k| corners[(first + k) % 3]), sides[first]))
}

/// The side of the plane through three points on which a point lies; greater is where the normal
/// points.
fn side([a, b, c]: [[i64; 3]; 3], point: [i64; 3]) -> Ordering {
    dot(normal([a, b, c]), minus(point, a)).cmp(&0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::vector::cross;
    use proptest::prelude::*;

    type Triangle = [[i32; 3]; 3];

    fn mesh_of(soup: &[Triangle]) -> (Vec<[i32; 3]>, Vec<[u32; 3]>) {
        let numbers = (0..soup.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        (soup.concat(), numbers.collect())
    }

    fn crossings_of(soup: &[Triangle]) -> Crossings {
        let (vertices, triangles) = mesh_of(soup);
        crossings(&Tree::new(&vertices, &triangles))
    }

    /// Whether each of the ways to name the corners of both gives the same, and which.
    fn cross_always(a: Triangle, b: Triangle) -> bool {
        let first = do_cross(a, b);
        for [i, j, k] in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0], [1, 0, 2], [0, 2, 1]] {
            let turned = [a[i], a[j], a[k]];
            assert_eq!(do_cross(turned, b), first, "{turned:?} {b:?}");
            assert_eq!(do_cross(b, turned), first, "{b:?} {turned:?}");
        }
        first
    }

    const FLAT: Triangle = [[0, 0, 0], [8, 0, 0], [0, 8, 0]];

    #[test]
    fn what_crosses_and_what_only_touches() {
        for (what, other, expected) in [
            ("through the middle", [[2, 2, -1], [2, 2, 1], [9, 9, 1]], true),
            ("through a side", [[-1, 2, -1], [2, 2, 1], [-1, 2, 1]], true),
            ("through a corner that it shares", [[0, 0, 0], [4, 4, 2], [4, 4, -2]], true),
            ("a corner that it shares", [[0, 0, 0], [4, 4, 2], [4, 4, 1]], false),
            ("a side that it shares", [[0, 0, 0], [8, 0, 0], [3, 3, 1]], false),
            ("a part of a side", [[2, 0, 0], [20, 0, 0], [3, -3, 1]], false),
            ("it stands on it", [[1, 1, 0], [3, 1, 0], [2, 1, 5]], false),
            ("a corner on it", [[1, 1, 0], [3, 1, 4], [2, 1, 5]], false),
            ("a corner in its plane within", [[1, 1, 0], [3, 1, 4], [4, 2, -4]], true),
            ("a corner in its plane beside", [[-9, 1, 0], [-3, 1, 4], [-4, 2, -4]], false),
            ("side against side", [[-1, 4, 1], [-1, 4, -1], [0, 4, 0]], false),
            ("side across side", [[4, -1, 1], [4, 1, -1], [4, -9, -9]], false),
            ("side across side and in", [[4, -1, 1], [4, 1, -1], [4, 9, 9]], true),
            ("beside", [[9, 9, -1], [9, 9, 1], [20, 9, 1]], false),
            ("above", [[2, 2, 1], [2, 2, 2], [9, 9, 2]], false),
            ("in one plane", [[1, 1, 0], [9, 1, 0], [1, 9, 0]], false),
            ("the same", FLAT, false),
            ("without area", [[2, 2, -1], [2, 2, 0], [2, 2, 1]], false),
        ] {
            assert_eq!(cross_always(FLAT, other), expected, "{what}");
            let huge = |t: Triangle| t.map(|v| v.map(|n| n * 5_000_000));
            assert_eq!(cross_always(huge(FLAT), huge(other)), expected, "{what}, huge");
        }
        // A hair's breadth beside and within, at the largest numbers.
        let far = 100_000_000;
        let flat = [[-far, -far, far], [far, far, -far], [far, -far, 0]];
        assert!(!cross_always(flat, [[0, 0, -9], [0, 0, 9], [-far, far, 0]]));
        assert!(cross_always(flat, [[1, 0, -9], [1, 0, 9], [-far, far, 0]]));
    }

    #[test]
    fn pairs_come_from_the_bed_upwards() {
        let post = |x: i32, z: i32| [[x, 1, z - 2], [x + 1, 1, z + 2], [x, 2, z + 2]];
        let plate = |z: i32| [[0, 0, z], [90, 0, z], [0, 90, z]];
        let found = crossings_of(&[plate(50), post(40, 50), post(20, 50), plate(20), post(1, 20)]);
        assert_eq!(found, Crossings { pairs: vec![[3, 4], [0, 2], [0, 1]], complete: true });
        assert_eq!(crossings_of(&[]), Crossings { pairs: vec![], complete: true });
    }

    #[test]
    fn depth_is_what_the_shallower_reaches_to_the_shallower_side() {
        let plate = [[0, 0, 0], [90_000, 0, 0], [0, 90_000, 0]];
        let post = [[10_000, 10_000, -3000], [20_000, 10_000, 50_000], [10_000, 20_000, 50_000]];
        let (vertices, triangles) = mesh_of(&[plate, post]);
        let found = depth(&Tree::new(&vertices, &triangles), [0, 1]);
        assert!((found - 0.3).abs() < 1e-9, "{found}");
    }

    /// Upright triangles through the z axis, each across all others; those of each `floor` above those of the last.
    fn fans(floors: i32, of: i32) -> Vec<Triangle> {
        let blade = |floor: i32, k: i32| {
            let (x, y, z) = (10_000 - k, 10_000 + k, floor * 10_000);
            [[-x, -y, z], [x, y, z], [x / 2, y / 2, z + 9 + k]]
        };
        (0..floors).flat_map(|floor| (0..of).map(move |k| blade(floor, k))).collect()
    }

    #[test]
    fn what_crosses_all_over_is_left_early() {
        let of = |floors, of| {
            let found = crossings_of(&fans(floors, of));
            (found.pairs.len(), found.complete)
        };
        assert_eq!(of(1, 200), (200 * 199 / 2, true));
        assert_eq!(of(50, 200), (50 * 200 * 199 / 2, true));
        assert_eq!(of(60, 200), (MOST_PAIRS, false));
        assert_eq!(of(1, 3000), (MOST_PAIRS, false));
    }

    #[test]
    fn what_has_too_many_touching_boxes_is_left_early() {
        // All in one place, then in many: of these no group takes more than its part.
        for (soup, steps) in [(fans(1, 200), 10_000), (fans(50, 100), 200_000)] {
            let (vertices, triangles) = mesh_of(&soup);
            let tree = Tree::new(&vertices, &triangles);
            let all = crossings_within(&tree, u64::MAX / 2);
            let some = crossings_within(&tree, steps);
            assert!(all.complete && !some.complete);
            assert!(all.pairs.len() > some.pairs.len() && !some.pairs.is_empty());
        }
    }

    /// Whether triangles cross, by the ends of their stretches of the common line as fractions.
    fn cross_by_fractions(a: Triangle, b: Triangle) -> bool {
        let [a, b] = [a, b].map(|t| t.map(|v| v.map(i64::from)));
        let normal = |t: [[i64; 3]; 3]| cross(minus(t[1], t[0]), minus(t[2], t[0]));
        let line = cross(normal(a), normal(b));
        let dot = |u: [i64; 3], v: [i64; 3]| {
            (0..3).map(|k| i128::from(u[k]) * i128::from(v[k])).sum::<i128>()
        };
        let stretch = |t: [[i64; 3]; 3], other: [[i64; 3]; 3]| {
            let height = t.map(|v| dot(normal(other), minus(v, other[0])));
            let mut ends = Vec::new();
            for (i, j) in [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)] {
                if height[i] > 0 && height[j] < 0 {
                    let (h, run) = (height[i], height[i] - height[j]);
                    ends.push((dot(line, t[i]) * run + dot(line, minus(t[j], t[i])) * h, run));
                }
                if height[i] == 0 {
                    ends.push((dot(line, t[i]), 1));
                }
            }
            let both = height.iter().any(|&h| h > 0) && height.iter().any(|&h| h < 0);
            ends.sort_by(|p, q| (p.0 * q.1).cmp(&(q.0 * p.1)));
            both.then(|| (ends[0], ends[ends.len() - 1]))
        };
        let before = |p: (i128, i128), q: (i128, i128)| p.0 * q.1 < q.0 * p.1;
        let stretches = stretch(a, b).zip(stretch(b, a));
        stretches.is_some_and(|(one, other)| before(one.0, other.1) && before(other.0, one.1))
    }

    fn triangle(side: i32) -> impl Strategy<Value = Triangle> {
        prop::array::uniform3(prop::array::uniform3(-side..=side))
    }

    fn tetrahedron(side: i32) -> impl Strategy<Value = Vec<Triangle>> {
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        prop::array::uniform4(prop::array::uniform3(-side..=side))
            .prop_map(move |v| faces.map(|face| face.map(|k: usize| v[k])).to_vec())
    }

    /// The corners of the triangles of all pairs, in an order of their own.
    fn by_corners(soup: &[Triangle], found: &Crossings) -> Vec<[Triangle; 2]> {
        let corners = |pair: &[u32; 2]| {
            let mut two = pair.map(|t| soup[t as usize]);
            two.sort_unstable();
            two
        };
        let mut all: Vec<_> = found.pairs.iter().map(corners).collect();
        all.sort_unstable();
        all
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn signs_say_the_same_as_fractions(a in triangle(3), b in triangle(3), c in triangle(50)) {
            prop_assert_eq!(cross_always(a, b), cross_by_fractions(a, b));
            prop_assert_eq!(cross_always(a, c), cross_by_fractions(a, c));
        }
    }

    proptest! {
        #[test]
        fn bodies_cross_where_their_faces_do_in_whatever_order(
            bodies in prop::collection::vec(prop_oneof![tetrahedron(5), tetrahedron(30)], 1..20),
            start in 0_usize..80,
        ) {
            let soup = bodies.concat();
            let found = crossings_of(&soup);
            let numbers = 0..soup.len() as u32;
            let pairs = numbers.clone().flat_map(|a| (a + 1..soup.len() as u32).map(move |b| [a, b]));
            let mut expected: Vec<_> = pairs
                .filter(|pair| cross_by_fractions(soup[pair[0] as usize], soup[pair[1] as usize]))
                .collect();
            let mut sorted = found.pairs.clone();
            sorted.sort_unstable();
            expected.sort_unstable();
            prop_assert_eq!(sorted, expected);
            let mut other = soup.clone();
            other.rotate_left(start % soup.len());
            other.swap(0, soup.len() / 2);
            prop_assert_eq!(by_corners(&soup, &found), by_corners(&other, &crossings_of(&other)));
        }
    }
}
