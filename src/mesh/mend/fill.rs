//! Rim -> triangles: fills a hole by cutting off ears (ear clipping).
//!
//! The rim is projected along the axis that is nearest to its normal (Newell's method). An ear is a
//! corner with a convex angle whose triangle contains no other corner of the rim; a simple polygon
//! has at least two (Meisters, 1975). Its cut is the side of that triangle that is not on the rim.
//!
//! 1. Put all corners into a queue, the shortest cut first: that gives well-shaped triangles.
//! 2. Take the first that is an ear, and cut it off. Its two neighbours have new cuts, and enter
//!    the queue again; older entries of theirs are skipped. What is no ear since a corner lies in it
//!    waits until that corner is cut off.
//! 3. If no corner is an ear the rim crosses itself in the projection. Cut off the first corner, and
//!    mark the filling as crooked.
//!
//! Every corner is used, and each side of the rim once. So the filled mesh is closed even where
//! corners lie on one line or a rim touches itself.
//!
//! Only hollow corners, those that were not convex at first, can lie in an ear. They are kept in a
//! tree, so that a test looks at few of them.

use crate::geom::Point;
use crate::geom::nearest::Nearest;
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
    /// The hollow corners that are not cut off; and where each corner stands there, if it does.
    hollow: Vec<usize>,
    tree: Nearest,
    places: Vec<usize>,
    /// What waits for each hollow corner to be cut off.
    waiting: Vec<Vec<Candidate>>,
    /// Candidates that were no ears when they were tried, the shortest cut first.
    refused: BinaryHeap<Reverse<Candidate>>,
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
        let hollow: Vec<usize> =
            (0..count).filter(|&k| turn(flat[before[k]], flat[k], flat[after[k]]) <= 0).collect();
        let mut places = vec![usize::MAX; count];
        hollow.iter().enumerate().for_each(|(place, &k)| places[k] = place);
        let tree = Nearest::new(hollow.iter().map(|&k| place_of(flat[k])).collect());
        let mut ears = Self {
            corners,
            flat,
            before,
            after,
            is_cut: vec![false; count],
            waiting: vec![Vec::new(); hollow.len()],
            hollow,
            tree,
            places,
            refused: BinaryHeap::new(),
            queue: BinaryHeap::with_capacity(count),
            left: count,
        };
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
        let mut found = None;
        while let Some(Reverse(candidate)) = self.queue.pop() {
            let k = candidate.2[0];
            if !self.is_current(&candidate) {
                continue;
            }
            let blocking = if self.left == 3 { None } else { self.blocking(k) };
            let Some(blocking) = blocking else {
                found = Some(k);
                break;
            };
            if let Blocking::Corner(hollow) = blocking {
                self.waiting[hollow].push(candidate);
            }
            self.refused.push(Reverse(candidate));
        }
        // The last triangle of a rim that crosses itself may be turned over.
        let is_last = self.left == 3;
        let is_crooked = found.is_none_or(|k| is_last && self.turn_at(k) < 0);
        let k = found.or_else(|| self.first_refused())?;
        let (a, b) = (self.before[k], self.after[k]);
        self.is_cut[k] = true;
        self.left -= 1;
        (self.after[a], self.before[b]) = (b, a);
        if let Some(waiting) = self.waiting.get_mut(self.places[k]) {
            self.queue.extend(std::mem::take(waiting).into_iter().map(Reverse));
            self.tree.take(self.places[k]);
        }
        self.offer(a);
        self.offer(b);
        Some(([a, k, b], is_crooked))
    }

    fn turn_at(&self, k: usize) -> i64 {
        turn(self.flat[self.before[k]], self.flat[k], self.flat[self.after[k]])
    }

    /// Whether a candidate's corner is there, between the same neighbours.
    fn is_current(&self, &(.., [k, a, b]): &Candidate) -> bool {
        !self.is_cut[k] && self.before[k] == a && self.after[k] == b
    }

    /// The corner with the shortest cut among those that are no ears.
    fn first_refused(&mut self) -> Option<usize> {
        while let Some(Reverse(candidate)) = self.refused.pop() {
            if self.is_current(&candidate) {
                return Some(candidate.2[0]);
            }
        }
        None
    }

    /// Why corner `k` is no ear; `None` if it is one.
    fn blocking(&self, k: usize) -> Option<Blocking> {
        let ear = [self.flat[self.before[k]], self.flat[k], self.flat[self.after[k]]];
        if self.turn_at(k) < 0 {
            return Some(Blocking::Turn);
        }
        let beside = |p: [i64; 2]| (0..3).any(|side| turn(ear[side], ear[(side + 1) % 3], p) < 0);
        let wide = [0, 1, 2].map(|k| ear[k][0]);
        let (from, to) = (wide[0].min(wide[1]).min(wide[2]), wide[0].max(wide[1]).max(wide[2]));
        let meets = |(first, last): (Point, Point)| {
            let ([left, low], [right, top]) = (coordinates(first), coordinates(last));
            let corners = [[left, low], [right, low], [right, top], [left, top]];
            let is_beyond =
                |side: usize| corners.iter().all(|&p| turn(ear[side], ear[(side + 1) % 3], p) < 0);
            left <= to && right >= from && !(0..3).any(is_beyond)
        };
        let is_in = |place: usize| {
            let p = self.flat[self.hollow[place]];
            // A corner at one of the ear's corners is the rim touching itself.
            (from..=to).contains(&p[0]) && !ear.contains(&p) && !beside(p)
        };
        self.tree.find(meets, is_in).map(Blocking::Corner)
    }
}

/// Why a corner is no ear.
enum Blocking {
    /// It is not convex.
    Turn,
    /// A hollow corner lies in it.
    Corner(usize),
}

/// A corner of the projection, which has the coordinates of a corner of the mesh.
fn place_of([x, y]: [i64; 2]) -> Point {
    let side = |side: i64| i32::try_from(side).unwrap_or(0);
    Point { x: side(x), y: side(y) }
}

fn coordinates(p: Point) -> [i64; 2] {
    [i64::from(p.x), i64::from(p.y)]
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
    fn a_long_spiral_is_filled_soon() {
        // 20 turns of a strip, 6000 corners: nearly every corner has others near its cut.
        let at = |k: i32, out: f64| {
            let (sin, cos) = crate::units::sin_cos(f64::from(k) * 2.4);
            let radius = 20_000.0 + 100.0 * f64::from(k) + out;
            [(cos * radius) as i32, (sin * radius) as i32, 0]
        };
        let mut corners: Vec<Corner> = (0..3000).map(|k| at(k, 6000.0)).collect();
        corners.extend((0..3000).rev().map(|k| at(k, 0.0)));
        assert!(!filled(&corners).is_crooked);
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
