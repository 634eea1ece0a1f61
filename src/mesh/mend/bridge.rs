//! Rims -> pairs and bands: joins two rims that run along each other across a gap.
//!
//! Where a strip of the surface is missing all around, its two rims face each other closely. A
//! band of triangles between them restores it; a filling of each would cut the body in two.
//!
//! Two rims are a pair if
//! - no corner of one is further from the other than a quarter of the smaller diameter,
//! - each lies in front of the other's filling: the two faces of a thin plate are close as well,
//!   but back to back,
//! - each is the nearest of the other.
//!
//! The distance of two rims is the largest from a corner of one to the other one. Rims are sorted
//! by their lowest x, so that only near ones are compared, and comparisons are counted.
//!
//! A band begins at the closest two corners and always takes the shorter of the next two
//! diagonals.

use super::fill::newell;
use super::rim::Rim;
use crate::mesh::geometry::bounds::Bounds;
use crate::mesh::geometry::vector::{Corner, distance2};
use nalgebra::Vector3;
use std::ops::Range;

/// The largest distance of two rims of a pair, as a share of the smaller diameter. A larger value
/// joins neighbouring holes of a body, a smaller one leaves wide gaps to be filled on both sides.
const MOST_APART: f64 = 0.25;

/// How far the middle of a rim may lie behind the plane of the other, as a share of the smaller
/// diameter: above zero for rims in one plane, as those of the end face of a tube.
const MOST_BEHIND: f64 = 0.01;

/// Comparisons of two rims, or of a corner with a side, for all together: about a second. Pairs after that
/// are not found, and their holes filled instead.
const MOST_LOOKS: u64 = 1 << 28;

/// Two rims that face each other.
pub(super) struct Pair {
    /// The numbers of the rims, that with the lesser first corner first.
    pub(super) rims: [usize; 2],
    /// Their distance, grid units.
    pub(super) apart: f64,
}

/// The pairs of rims that face each other and are each other's nearest.
pub(super) fn pairs(vertices: &[Corner], rims: &[Rim]) -> Vec<Pair> {
    let measured: Vec<Measured> = rims.iter().map(|rim| Measured::new(vertices, rim)).collect();
    let mut order: Vec<usize> = (0..rims.len()).filter(|&k| !rims[k].is_fin).collect();
    order.sort_by_key(|&k| (measured[k].bounds.low, measured[k].corners[0]));
    // The nearest rim of each, and its distance.
    let mut nearest: Vec<Option<(f64, usize)>> = vec![None; rims.len()];
    let mut looks = MOST_LOOKS;
    for (place, &a) in order.iter().enumerate() {
        for &b in &order[place + 1..] {
            let most = MOST_APART * measured[a].size.min(measured[b].size);
            if f64::from(measured[b].bounds.low[0]) - f64::from(measured[a].bounds.low[0])
                > MOST_APART * measured[a].size
            {
                break;
            }
            looks = looks.saturating_sub(1);
            if looks == 0 {
                break;
            }
            let Some(apart) = measured[a].apart(&measured[b], most, &mut looks) else { continue };
            for (one, other) in [(a, b), (b, a)] {
                if nearest[one].is_none_or(|(known, _)| apart < known) {
                    nearest[one] = Some((apart, other));
                }
            }
        }
    }
    let mutual = |&a: &usize| {
        let (apart, b) = nearest[a]?;
        let is_first = measured[a].corners[0] < measured[b].corners[0];
        let is_mutual = nearest[b].is_some_and(|(_, back)| back == a);
        (is_first && is_mutual).then_some(Pair { rims: [a, b], apart })
    };
    order.iter().filter_map(mutual).collect()
}

/// A rim with the measures by which rims are compared.
struct Measured {
    corners: Vec<Corner>,
    blocks: Blocks,
    bounds: Bounds,
    /// The mean of its corners.
    middle: Vector3<f64>,
    /// The direction in which its filling would face, of length 1 or 0.
    normal: Vector3<f64>,
    size: f64,
}

impl Measured {
    fn new(vertices: &[Corner], rim: &Rim) -> Self {
        let corners: Vec<Corner> = rim.way.iter().map(|&v| vertices[v as usize]).collect();
        let bounds = Bounds::of(corners.iter().copied());
        let middle = corners.iter().map(|&corner| point(corner)).sum::<Vector3<f64>>();
        let middle = middle / corners.len() as f64;
        let normal = newell(&corners);
        let normal = normal / normal.norm().max(1.0);
        let blocks = Blocks::new(&corners);
        Self { bounds, blocks, middle, normal, size: rim.size, corners }
    }

    /// The distance of this rim and another, if they face each other and it is at most `most`.
    fn apart(&self, other: &Self, most: f64, looks: &mut u64) -> Option<f64> {
        let is_near = |a: Corner, b: Corner| {
            (0..3).all(|axis| (f64::from(a[axis]) - f64::from(b[axis])).abs() <= most)
        };
        let (own, its) = (&self.bounds, &other.bounds);
        let may_be = is_near(own.low, its.low) && is_near(own.high, its.high);
        if !may_be || !self.faces(other) || !other.faces(self) {
            return None;
        }
        let one = self.reach(other, most, looks)?;
        Some(one.max(other.reach(self, most, looks)?))
    }

    /// Whether the other rim is not behind the filling of this one.
    fn faces(&self, other: &Self) -> bool {
        let ahead = self.normal.dot(&(other.middle - self.middle));
        ahead >= -MOST_BEHIND * self.size.min(other.size)
    }

    /// The largest distance from a corner of this rim to the other, if it is at most `most`.
    fn reach(&self, other: &Self, most: f64, looks: &mut u64) -> Option<f64> {
        let count = other.corners.len();
        let mut largest = 0.0_f64;
        let mut last = 0;
        for &corner in &self.corners {
            let to = |k: usize| to_side(corner, other.corners[k], other.corners[(k + 1) % count]);
            // The block that had the nearest side of the corner before mostly has this one's.
            let first = other.blocks.ends(last, count);
            let mut least = first.clone().map(to).fold(f64::INFINITY, f64::min);
            let mut seen = first.len() + other.blocks.bounds.len();
            for (block, bounds) in other.blocks.bounds.iter().enumerate() {
                // Rounding must not leave out what is as near.
                if block != last && far2(corner, *bounds) as f64 <= least * (1.0 + 1e-9) + 1.0 {
                    let sides = other.blocks.ends(block, count);
                    seen += sides.len();
                    let found = sides.map(to).fold(f64::INFINITY, f64::min);
                    if found < least {
                        (least, last) = (found, block);
                    }
                }
            }
            *looks = looks.checked_sub(seen as u64)?;
            largest = largest.max(least);
            if largest > most * most {
                return None;
            }
        }
        Some(largest.sqrt())
    }
}

/// Corners of a rim in a row that have a box. It affects speed only.
const BLOCK: usize = 32;

/// The boxes around every few sides of a rim.
struct Blocks {
    bounds: Vec<Bounds>,
}

impl Blocks {
    fn new(corners: &[Corner]) -> Self {
        let count = corners.len();
        let around = |first: usize| {
            // With the end of the last side.
            let ends = (first..=count.min(first + BLOCK)).map(|k| corners[k % count]);
            Bounds::of(ends)
        };
        Self { bounds: (0..count).step_by(BLOCK).map(around).collect() }
    }

    /// The first corners of the sides of a block, of so many corners of the rim.
    fn ends(&self, block: usize, count: usize) -> Range<usize> {
        block * BLOCK..count.min((block + 1) * BLOCK)
    }
}

/// The squared distance from a corner to a box.
fn far2(corner: Corner, bounds: Bounds) -> i64 {
    let inside =
        std::array::from_fn(|axis| corner[axis].clamp(bounds.low[axis], bounds.high[axis]));
    distance2(corner, inside)
}

/// A corner as a vector of floats.
fn point(corner: Corner) -> Vector3<f64> {
    Vector3::from(corner.map(f64::from))
}

/// The square of the distance from a corner to the line from `a` to `b`.
fn to_side(corner: Corner, a: Corner, b: Corner) -> f64 {
    let (way, out) = (point(b) - point(a), point(corner) - point(a));
    let share = (way.dot(&out) / way.norm_squared().max(1.0)).clamp(0.0, 1.0);
    (out - way * share).norm_squared()
}

/// The triangles between two rims that run in opposite directions: one on each side of both.
pub(super) fn band(vertices: &[Corner], one: &[u32], other: &[u32]) -> Vec<[u32; 3]> {
    let at = |vertex: u32| vertices[vertex as usize];
    let start = closest(vertices, one, other);
    let a = |k: usize| one[(start[0] + k) % one.len()];
    // Backwards.
    let b = |k: usize| other[(start[1] + other.len() - k % other.len()) % other.len()];
    let (mut i, mut j) = (0, 0);
    let mut band = Vec::with_capacity(one.len() + other.len());
    while i < one.len() || j < other.len() {
        let on_one = distance2(at(a(i + 1)), at(b(j)));
        let on_other = distance2(at(a(i)), at(b(j + 1)));
        if j == other.len() || (i < one.len() && on_one <= on_other) {
            band.push([a(i), a(i + 1), b(j)]);
            i += 1;
        } else {
            band.push([b(j + 1), b(j), a(i)]);
            j += 1;
        }
    }
    band
}

/// The places on two rims of the two corners that are closest to each other.
fn closest(vertices: &[Corner], one: &[u32], other: &[u32]) -> [usize; 2] {
    let at = |vertex: u32| vertices[vertex as usize];
    let blocks = Blocks::new(&other.iter().map(|&vertex| at(vertex)).collect::<Vec<_>>());
    let key = |[i, j]: [usize; 2]| (distance2(at(one[i]), at(other[j])), at(one[i]), at(other[j]));
    let mut best = [0, 0];
    for (i, &corner) in one.iter().enumerate() {
        for (block, bounds) in blocks.bounds.iter().enumerate() {
            if far2(at(corner), *bounds) <= key(best).0 {
                let all = blocks.ends(block, other.len()).map(|j| [i, j]).chain([best]);
                best = all.min_by_key(|&pair| (key(pair), pair)).unwrap_or(best);
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use crate::mesh::Mesh;
    use crate::mesh::faults::Mending;
    use crate::mesh::geometry::measure::{corners_of, determinant};
    use crate::mesh::geometry::vector::Corner;
    use crate::mesh::mend::mend;

    const MM: i32 = 10_000;

    /// Corners of squares of `half` the side at some heights, mm, four each.
    fn squares(of: &[[i32; 2]]) -> Vec<Corner> {
        let at = |&[half, z]: &[i32; 2]| {
            [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]]
        };
        of.iter().flat_map(at).map(|corner| corner.map(|side| side * MM)).collect()
    }

    /// The strip from square `a` to square `b`: outward if `a` is below `b`.
    fn strip(a: u32, b: u32) -> Vec<[u32; 3]> {
        let (a, b) = (4 * a, 4 * b);
        let side = |k: u32| {
            let next = (k + 1) % 4;
            [[a + k, a + next, b + next], [a + k, b + next, b + k]]
        };
        (0..4).flat_map(side).collect()
    }

    /// Volume of what was mended, mm³, and what was done how often.
    fn mended(squares_of: &[[i32; 2]], strips: &[[u32; 2]]) -> (i128, usize, usize) {
        let vertices = squares(squares_of);
        let triangles: Vec<[u32; 3]> = strips.iter().flat_map(|&[a, b]| strip(a, b)).collect();
        let mut mesh = Mesh { vertices, triangles };
        let mended = mend(&mut mesh);
        assert_eq!(mended.left.0.len(), 0, "{:?}", mended.left);
        let of = |&t: &[u32; 3]| determinant(corners_of(&mesh.vertices, t));
        let volume = mesh.triangles.iter().map(of).sum::<i128>() / 6 / i128::from(MM).pow(3);
        let count = |kind: Mending| {
            mended.done.0.iter().find(|note| note.kind == kind).map_or(0, |note| note.count)
        };
        (volume, count(Mending::Bridged), count(Mending::FilledHole))
    }

    #[test]
    fn a_missing_ring_is_joined() {
        // A tube of 20 mm with a bore of 12 mm; its outside is missing between 14 and 17 mm.
        let of = [[10, 0], [10, 14], [10, 17], [10, 30], [6, 0], [6, 30]];
        let strips = [[0, 1], [2, 3], [3, 5], [5, 4], [4, 0]];
        assert_eq!(mended(&of, &strips), ((400 - 144) * 30, 1, 0));
    }

    #[test]
    fn end_faces_of_a_tube_are_joined() {
        let of = [[10, 0], [10, 30], [8, 0], [8, 30]];
        assert_eq!(mended(&of, &[[0, 1], [3, 2]]), ((400 - 256) * 30, 2, 0));
    }

    #[test]
    fn a_body_in_two_halves_is_joined() {
        let of = [[10, 0], [10, 14], [10, 15], [10, 30]];
        assert_eq!(mended(&of, &[[0, 1], [2, 3]]), (400 * 30, 1, 2));
    }

    #[test]
    fn a_thin_plate_is_filled_on_both_sides() {
        assert_eq!(mended(&[[10, 0], [10, 1]], &[[0, 1]]), (400, 0, 2));
    }
}
