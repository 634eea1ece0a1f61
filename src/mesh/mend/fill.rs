//! Rim -> triangles: fills a hole by cutting off ears.
//!
//! The rim is projected along the axis that is nearest to its normal (Newell's method). An ear is a
//! corner with a convex angle whose triangle contains no other corner of the rim; a simple polygon
//! has at least two (Meisters, 1975). Its cut is the side of that triangle that is not on the rim.
//!
//! 1. Put all corners into a queue, the shortest cut first: that gives well-shaped triangles.
//! 2. Take the first that is an ear, and cut it off. Its two neighbours have new cuts, and enter
//!    the queue again; older entries of theirs are skipped.
//! 3. If no corner is an ear the rim crosses itself in the projection. Cut off the first corner, and
//!    mark the filling as crooked.
//!
//! Every corner is used, and each side of the rim once. So the filled mesh is closed even where
//! corners lie on one line or a rim touches itself.
//!
//! Only hollow corners, those that were not convex at first, can lie in an ear. They are sorted by
//! x, so that a test looks at few of them.

use crate::mesh::geometry::vector::{Corner, cross, distance2, minus};
use nalgebra::Vector3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The filling of a hole.
pub(super) struct Filled {
    /// Triangles that run along the rim's direction.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Whether the rim crosses itself in the projection, so that some triangles overlap.
    pub(super) is_crooked: bool,
    /// How thick the rim is along its normal, grid units.
    pub(super) depth: f64,
}

/// Fills the hole with the rim of these vertices, at least three.
pub(super) fn fill(vertices: &[Corner], rim: &[u32]) -> Filled {
    let corners: Vec<Corner> = rim.iter().map(|&v| vertices[v as usize]).collect();
    let normal = newell(&corners);
    let flat = flattened(&corners, normal);
    let mut ears = Ears::new(&corners, &flat);
    let mut filled =
        Filled { triangles: Vec::new(), is_crooked: false, depth: depth(&corners, normal) };
    while let Some((ear, is_crooked)) = ears.cut() {
        filled.triangles.push(ear.map(|k| rim[k]));
        filled.is_crooked |= is_crooked;
    }
    filled
}

/// The normal of a closed line of corners. Its length is twice the area of the projection along
/// it.
pub(super) fn newell(corners: &[Corner]) -> Vector3<f64> {
    let mut sum = [0_i128; 3];
    for k in 1..corners.len().saturating_sub(1) {
        let part = cross(minus(corners[k], corners[0]), minus(corners[k + 1], corners[0]));
        (0..3).for_each(|axis| sum[axis] += i128::from(part[axis]));
    }
    Vector3::from(sum.map(|side| side as f64))
}

/// How far the corners reach along the `normal`.
fn depth(corners: &[Corner], normal: Vector3<f64>) -> f64 {
    let long = normal.norm();
    if long == 0.0 {
        return 0.0;
    }
    let heights = corners.iter().map(|&corner| {
        let from_first = Vector3::from(minus(corner, corners[0]).map(|side| side as f64));
        normal.dot(&from_first) / long
    });
    let (low, high) = heights.fold((0.0_f64, 0.0_f64), |(l, h), at| (l.min(at), h.max(at)));
    high - low
}

/// The corners projected along the axis that is nearest to the normal, counter-clockwise. Without
/// one coordinate they stay exact.
fn flattened(corners: &[Corner], normal: Vector3<f64>) -> Vec<[i64; 2]> {
    let size = normal.map(f64::abs);
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(2);
    let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
    let (x, y) = if normal[axis] < 0.0 { (y, x) } else { (x, y) };
    corners.iter().map(|corner| [i64::from(corner[x]), i64::from(corner[y])]).collect()
}

/// The rest of a polygon while ears are cut off.
struct Ears<'a> {
    corners: &'a [Corner],
    flat: &'a [[i64; 2]],
    before: Vec<usize>,
    after: Vec<usize>,
    is_cut: Vec<bool>,
    /// The hollow corners, by x.
    hollow: Vec<usize>,
    /// Candidates, the shortest cut first; some are out of date.
    queue: BinaryHeap<Reverse<Candidate>>,
    left: usize,
}

/// Length² of the cut and its ends, then the corner and its neighbours.
type Candidate = (i64, [Corner; 2], [usize; 3]);

impl<'a> Ears<'a> {
    fn new(corners: &'a [Corner], flat: &'a [[i64; 2]]) -> Self {
        let count = corners.len();
        let before: Vec<usize> = (0..count).map(|k| (k + count - 1) % count).collect();
        let after: Vec<usize> = (0..count).map(|k| (k + 1) % count).collect();
        let mut hollow: Vec<usize> =
            (0..count).filter(|&k| turn(flat[before[k]], flat[k], flat[after[k]]) <= 0).collect();
        hollow.sort_unstable_by_key(|&k| (flat[k], k));
        let queue = BinaryHeap::with_capacity(count);
        let is_cut = vec![false; count];
        let mut ears = Self { corners, flat, before, after, is_cut, hollow, queue, left: count };
        (0..count).for_each(|k| ears.offer(k));
        ears
    }

    /// Puts corner `k` into the queue.
    fn offer(&mut self, k: usize) {
        let (a, b) = (self.before[k], self.after[k]);
        let ends = [self.corners[a], self.corners[b]];
        let ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        self.queue.push(Reverse((distance2(ends[0], ends[1]), ends, [k, a, b])));
    }

    /// Cuts off the next ear. Returns `true` with it if the polygon crosses itself.
    fn cut(&mut self) -> Option<([usize; 3], bool)> {
        if self.left < 3 {
            return None;
        }
        // Corners that are no ears now.
        let mut refused = Vec::new();
        let mut found = None;
        while let Some(Reverse(candidate)) = self.queue.pop() {
            let [k, a, b] = candidate.2;
            if self.is_cut[k] || self.before[k] != a || self.after[k] != b {
                continue;
            }
            if self.left == 3 || self.is_ear(k) {
                found = Some(k);
                break;
            }
            refused.push(candidate);
        }
        // The last triangle of a rim that crosses itself may be turned over.
        let is_last = self.left == 3;
        let is_crooked = found.is_none_or(|k| is_last && self.turn_at(k) < 0);
        let k = found.or_else(|| refused.first().map(|candidate| candidate.2[0]))?;
        self.queue.extend(refused.into_iter().map(Reverse));
        let (a, b) = (self.before[k], self.after[k]);
        self.is_cut[k] = true;
        self.left -= 1;
        (self.after[a], self.before[b]) = (b, a);
        self.offer(a);
        self.offer(b);
        Some(([a, k, b], is_crooked))
    }

    fn turn_at(&self, k: usize) -> i64 {
        turn(self.flat[self.before[k]], self.flat[k], self.flat[self.after[k]])
    }

    fn is_ear(&self, k: usize) -> bool {
        let ear = [self.flat[self.before[k]], self.flat[k], self.flat[self.after[k]]];
        if self.turn_at(k) < 0 {
            return false;
        }
        let low = ear[0][0].min(ear[1][0]).min(ear[2][0]);
        let high = ear[0][0].max(ear[1][0]).max(ear[2][0]);
        let from = self.hollow.partition_point(|&h| self.flat[h][0] < low);
        let within = self.hollow[from..].iter().take_while(|&&h| self.flat[h][0] <= high);
        within.copied().filter(|&h| !self.is_cut[h]).all(|h| {
            let p = self.flat[h];
            // A corner at one of the ear's corners is the rim touching itself.
            ear.contains(&p) || (0..3).any(|side| turn(ear[side], ear[(side + 1) % 3], p) < 0)
        })
    }
}

/// Twice the signed area of a triangle: positive if it turns left.
fn turn(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::vector::length;

    fn filled(corners: &[Corner]) -> Filled {
        let rim: Vec<u32> = (0..u32::try_from(corners.len()).unwrap()).collect();
        let filled = fill(corners, &rim);
        assert_eq!(filled.triangles.len(), corners.len() - 2);
        filled
    }

    fn area(corners: &[Corner], filled: &Filled) -> f64 {
        let of =
            |t: &[u32; 3]| crate::mesh::geometry::vector::normal(t.map(|k| corners[k as usize]));
        filled.triangles.iter().map(|t| length(of(t)) / 2.0).sum()
    }

    #[test]
    fn a_comb_is_filled_without_overlap() {
        // Teeth of 1 by 9 on a bar of 19 by 1, in a plane that leans.
        let mut outline: Vec<[i32; 2]> = vec![[0, 0], [190, 0], [190, 10]];
        for tooth in (0..10).rev() {
            let x = tooth * 20;
            outline.extend([[x + 10, 10], [x + 10, 100], [x, 100], [x, 10]]);
        }
        let corners: Vec<Corner> = outline.iter().map(|&[x, y]| [x, y, x + 2 * y]).collect();
        let filled = filled(&corners);
        assert!(!filled.is_crooked && filled.depth < 1.0);
        let expected = f64::from(190 * 10 + 10 * 10 * 90) * 6.0_f64.sqrt();
        assert!((area(&corners, &filled) - expected).abs() < 1.0);
    }

    #[test]
    fn corners_on_a_line_are_all_used() {
        let mut corners: Vec<Corner> = (0..9).map(|k| [10 * k, 0, 0]).collect();
        corners.extend([[80, 50, 0], [0, 50, 0]]);
        let filled = filled(&corners);
        assert!(!filled.is_crooked);
        assert!((area(&corners, &filled) - 4000.0).abs() < 1e-6);
    }

    #[test]
    fn a_rim_that_crosses_itself_is_told() {
        let bow = [[0, 0, 0], [200, 100, 0], [200, 0, 0], [0, 40, 0]];
        assert!(filled(&bow).is_crooked);
    }

    #[test]
    fn a_large_rim_is_filled_soon() {
        // A star of 20 000 corners.
        let corners: Vec<Corner> = (0..20_000)
            .map(|k| {
                let (sin, cos) = crate::units::sin_cos(f64::from(k) * 0.018);
                let radius = if k % 2 == 0 { 1e6 } else { 9e5 };
                [(cos * radius) as i32, (sin * radius) as i32, 0]
            })
            .collect();
        assert!(!filled(&corners).is_crooked);
    }
}
