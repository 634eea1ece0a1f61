//! Points -> Beside: a k-d tree of points, to find those near a line.
//!
//! Half of the points of a node lie in each of its two children, divided along the longest side of
//! the box around them (Bentley 1975). A line is followed only into boxes near which it passes, so
//! that it meets few points however many lie close together elsewhere.

use crate::mesh::geometry::bounds::Bounds;
use crate::mesh::geometry::vector::Corner;
use std::ops::Range;

/// Most points of a node without children. It affects speed only.
const LEAF: usize = 8;

/// Points, sorted into boxes.
pub(super) struct Beside<'a> {
    vertices: &'a [Corner],
    /// The points of each node together.
    points: Vec<u32>,
    /// The box of each node; the children of node k are 2 k + 1 and 2 k + 2.
    nodes: Vec<Bounds>,
}

impl<'a> Beside<'a> {
    /// Sorts `points`, indices into `vertices`, in n log n time.
    pub(super) fn new(vertices: &'a [Corner], points: Vec<u32>) -> Self {
        let count = points.len();
        let mut tree = Self { vertices, points, nodes: Vec::new() };
        tree.build(0, 0..count);
        tree
    }

    fn build(&mut self, node: usize, range: Range<usize>) {
        let vertices = self.vertices;
        let corner = |&p: &u32| vertices[p as usize];
        let own = self.points[range.clone()].iter().map(corner);
        let bounds = own.fold(Bounds::NONE, |all, at| all.join(Bounds { low: at, high: at }));
        if self.nodes.len() <= node {
            self.nodes.resize(node + 1, Bounds::NONE);
        }
        self.nodes[node] = bounds;
        let Some([lower, upper]) = halves(&range) else { return };
        let side = |axis: usize| i64::from(bounds.high[axis]) - i64::from(bounds.low[axis]);
        let axis = (0..3).max_by_key(|&axis| side(axis)).unwrap_or(0);
        let middle = lower.len();
        self.points[range].select_nth_unstable_by_key(middle, |p| (corner(p)[axis], *p));
        self.build(2 * node + 1, lower);
        self.build(2 * node + 2, upper);
    }

    /// Calls `visit` with all points within `reach` of the line from `a` to `b`, and with some others.
    pub(super) fn along(&self, a: Corner, b: Corner, reach: i32, mut visit: impl FnMut(u32)) {
        let mut open = vec![(0, 0..self.points.len())];
        while let Some((node, range)) = open.pop() {
            if range.is_empty() || !passes(a, b, self.nodes[node], f64::from(reach)) {
                continue;
            }
            match halves(&range) {
                Some([lower, upper]) => open.extend([(2 * node + 1, lower), (2 * node + 2, upper)]),
                None => self.points[range].iter().for_each(|&point| visit(point)),
            }
        }
    }
}

/// What of a node's points each of its children has, if it has any.
fn halves(range: &Range<usize>) -> Option<[Range<usize>; 2]> {
    let middle = range.start.midpoint(range.end);
    (range.len() > LEAF).then_some([range.start..middle, middle..range.end])
}

/// Whether the line from `a` to `b` may pass a box within `reach`.
fn passes(a: Corner, b: Corner, bounds: Bounds, reach: f64) -> bool {
    // A grid unit more for rounding.
    let grown = reach + 1.0;
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        let [start, end] = [a, b].map(|corner| f64::from(corner[axis]));
        let low = f64::from(bounds.low[axis]) - grown;
        let high = f64::from(bounds.high[axis]) + grown;
        let run = end - start;
        if run == 0.0 {
            if start < low || start > high {
                return false;
            }
            continue;
        }
        let (enters, leaves) = ((low - start) / run, (high - start) / run);
        from = from.max(enters.min(leaves));
        to = to.min(enters.max(leaves));
    }
    from <= to
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::vector::{dot, minus};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_point_near_a_line_is_missed(
            points in prop::collection::vec([-40..40_i32, -40..40, -40..40], 0..80),
            a in [-50..50_i32, -50..50, -50..50], b in [-50..50_i32, -50..50, -50..50],
            reach in 0..9_i32,
        ) {
            let tree = Beside::new(&points, (0..points.len() as u32).collect());
            let mut found = Vec::new();
            tree.along(a, b, reach, |point| found.push(point));
            let is_near = |at: &Corner| {
                let (line, side) = (minus(b, a), minus(*at, a));
                let share = (dot(line, side) as f64 / (dot(line, line) as f64).max(1.0)).clamp(0.0, 1.0);
                let off = (0..3).map(|k| side[k] as f64 - share * line[k] as f64);
                off.map(|x| x * x).sum::<f64>().sqrt() <= f64::from(reach)
            };
            for (k, _) in points.iter().enumerate().filter(|(_, at)| is_near(at)) {
                prop_assert!(found.contains(&(k as u32)));
            }
        }
    }

    #[test]
    fn lines_from_one_point_to_many_meet_few() {
        let met = |count: i32| {
            let mut points: Vec<Corner> = vec![[0, 0, 0]];
            points.extend((0..count).map(|k| {
                let (sin, cos) = crate::units::sin_cos(f64::from(k) * 360.0 / f64::from(count));
                [(cos * 1e6) as i32, (sin * 1e6) as i32, 500]
            }));
            let tree = Beside::new(&points, (0..points.len() as u32).collect());
            let mut met = 0;
            points.iter().for_each(|&to| tree.along(points[0], to, 200, |_| met += 1));
            met
        };
        let (few, many) = (met(500), met(4000));
        assert!(many < 10 * few, "{few} for 500 lines, {many} for 4000");
    }
}
