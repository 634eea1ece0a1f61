//! Mesh -> Layers: buckets triangles by the planes they cross, and chains segments by mesh edge.
//!
//! - A *segment* is where a plane cuts one triangle; a *chain* is a row of connected segments.
//! - An *open chain* starts and ends at a gap in the mesh.
//! - A *block* is some layers whose triangles are looked up together.
//!
//! 1. Sort all triangles into buckets, first by block and then by layer.
//! 2. A triangle gives at most one segment for each plane. It runs from the edge where the triangle's
//!    boundary goes down through the plane to the edge where it goes up. That is the direction
//!    z x normal, so solid is on the left.
//! 3. The chain continues in the triangle across that edge. So chaining walks over the mesh's
//!    adjacency and never compares distances.
//! 4. Close open chains by straight lines, shortest gap first. Report the longest gap.
//! 5. Simplify the contours, unite them, and move them by what the printer gets wrong.
//!
//! Bucketing follows Minetto, Volpato, Stolfi, Gregori and da Silva, "An optimal algorithm for 3D
//! triangle mesh slicing", Computer-Aided Design 92 (2017): linear in triangles and segments.

use super::simplify::{canonical, simplify};
use super::{Compensation, Heights, Layer};
use crate::geom::cells::Cells;
use crate::geom::ranks::Ranks;
use crate::geom::{Contour, Point, polygon};
use crate::mesh::Mesh;
use crate::mesh::edges::{Adjacency, NONE, parts};
use crate::units::{Coord, between};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;

/// Layers of a block for each thread. A block passes over its triangles once, and memory grows with
/// its layers. Measured: blocks of 64 layers took twice the memory of 16 and no less time. Fewer
/// layers than threads would leave threads without work.
const LAYERS: usize = 8;

/// A mesh with its triangles in buckets; its blocks can be cut in any order.
#[derive(Debug)]
pub struct Slicer<'a> {
    mesh: &'a Mesh,
    adjacency: &'a Adjacency,
    heights: Heights,
    tolerance: Coord,
    compensation: Compensation,
    /// Contours keep the order in which triangles begin them.
    as_listed: bool,
    /// Layers in each block but the last.
    block: usize,
    /// Triangles by block; a triangle is in each block whose planes it crosses.
    cells: Cells<u32>,
    /// The number of planes at or below each vertex.
    below: Vec<u32>,
    /// Marks that no thread is using. They are used again, since marks for every triangle are too
    /// expensive to make for each layer.
    free: Mutex<Vec<Marks>>,
}

/// The triangles that the walk along one plane has passed.
#[derive(Debug)]
struct Marks {
    /// The number of the walk that marked each triangle last.
    of: Vec<u32>,
    walk: u32,
}

impl Marks {
    fn is_set(&self, t: u32) -> bool {
        self.of[t as usize] == self.walk
    }

    fn set(&mut self, t: u32) {
        self.of[t as usize] = self.walk;
    }
}

impl<'a> Slicer<'a> {
    /// Sorts the triangles of `mesh` into blocks. Contours will be simplified within `tolerance`
    /// grid units.
    #[must_use]
    pub fn new(
        mesh: &'a Mesh,
        adjacency: &'a Adjacency,
        heights: Heights,
        tolerance: Coord,
    ) -> Self {
        let block = LAYERS * rayon::current_num_threads().max(2);
        let blocks = heights.count().div_ceil(block);
        let below = |v: &[Coord; 3]| u32::try_from(heights.planes_up_to(v[2])).unwrap_or(u32::MAX);
        let below: Vec<u32> = mesh.vertices.par_iter().map(below).collect();
        let reach = |t: &[u32; 3]| -> Range<usize> {
            let layers = crossed(&below, t);
            if layers.is_empty() {
                0..0
            } else {
                layers.start / block..(layers.end - 1) / block + 1
            }
        };
        let triangles = || (0_u32..).take(mesh.triangles.len());
        let cells = Cells::new(blocks, triangles, |t| reach(&mesh.triangles[t as usize]));
        let free = Mutex::default();
        let compensation = Compensation::default();
        let as_listed = false;
        Self {
            mesh,
            adjacency,
            heights,
            tolerance,
            compensation,
            as_listed,
            block,
            cells,
            below,
            free,
        }
    }

    /// The same with contours moved.
    #[must_use]
    pub fn moved(self, compensation: Compensation) -> Self {
        Self { compensation, ..self }
    }

    /// The same with the contours of each layer in the order in which the triangles of the mesh begin
    /// them, if `as_listed`, and else in one that does not depend on that.
    #[must_use]
    pub fn listed(self, as_listed: bool) -> Self {
        Self { as_listed, ..self }
    }

    /// The same for its lowest `count` layers.
    #[must_use]
    pub fn lowest(self, count: usize) -> Self {
        Self { heights: self.heights.lowest(count), ..self }
    }

    /// The layers' heights.
    #[must_use]
    pub fn heights(&self) -> &Heights {
        &self.heights
    }

    /// The number of blocks.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.heights.count().div_ceil(self.block)
    }

    /// The block of layer `k`.
    #[must_use]
    pub fn block_of(&self, k: usize) -> usize {
        k / self.block
    }

    /// The layers of block `b`, from the lowest to the highest.
    #[must_use]
    pub fn block(&self, b: usize) -> Vec<Layer> {
        self.each(b, |k, triangles, marks| self.layer(k, triangles, marks))
    }

    /// The layers of block `b` by their index, each with the longest gap in its contours, grid
    /// units, as in [`Layer::closed_gap`]. Takes less time than cutting the layers.
    #[must_use]
    pub fn gaps(&self, b: usize) -> Vec<(usize, Coord)> {
        self.each(b, |k, triangles, marks| {
            let open = self.walk(k).open_chains(triangles, marks);
            (k, close(open, &mut Vec::new()))
        })
    }

    /// What `make` gives for each layer of block `b`, from the triangles that cross its plane.
    fn each<T: Send>(
        &self,
        b: usize,
        make: impl Fn(usize, &[u32], &mut Marks) -> T + Sync,
    ) -> Vec<T> {
        let layers = b * self.block..((b + 1) * self.block).min(self.heights.count());
        let mut buckets = vec![Vec::new(); layers.len()];
        for &t in self.cells.of(b..b + 1) {
            let crossed = crossed(&self.below, &self.mesh.triangles[t as usize]);
            for k in crossed.start.max(layers.start)..crossed.end.min(layers.end) {
                buckets[k - layers.start].push(t);
            }
        }
        layers
            .into_par_iter()
            .zip(buckets)
            .map(|(k, triangles)| {
                let mut marks = self.marks();
                let made = make(k, &triangles, &mut marks);
                if let Ok(mut free) = self.free.lock() {
                    free.push(marks);
                }
                made
            })
            .collect()
    }

    /// The walk along the plane of layer `k`.
    fn walk(&self, k: usize) -> Walk<'_> {
        Walk { mesh: self.mesh, adjacency: self.adjacency, plane: self.heights.plane(k) }
    }

    /// Marks with none set.
    fn marks(&self) -> Marks {
        let free = self.free.lock().ok().and_then(|mut free| free.pop());
        // Not filled with zeros: the system maps zeroed pages twice, first for reading and then for
        // writing. That takes longer than filling them.
        let new = || Marks { of: vec![u32::MAX; self.mesh.triangles.len()], walk: 0 };
        let marks = free.unwrap_or_else(new);
        Marks { walk: marks.walk + 1, ..marks }
    }

    /// Layer `k`, cut from the triangles that cross its plane.
    fn layer(&self, k: usize, triangles: &[u32], marks: &mut Marks) -> Layer {
        let (mut contours, open) = self.walk(k).chains(triangles, marks);
        let closed_gap = close(open, &mut contours);
        let mut contours: Vec<Contour> = contours
            .into_iter()
            .map(|c| simplify(&canonical(c), self.tolerance))
            .filter(|c| c.len() >= 3)
            .collect();
        let found = if self.as_listed { contours.clone() } else { Vec::new() };
        // Sorted, so that the union does not depend on the order of the triangles.
        contours.sort_unstable();
        let contours = polygon::union(&contours);
        let mut contours = self.compensation.apply(contours, k, &self.heights);
        if self.as_listed {
            let ranks = Ranks::new(&found);
            contours.sort_by_cached_key(|contour| ranks.of(contour.iter().copied()));
        }
        Layer {
            index: k,
            z: self.heights.top(k),
            height: self.heights.height(k),
            contours,
            closed_gap,
        }
    }
}

/// The layers whose planes a triangle crosses: above its lowest corner, and at or below its
/// highest.
fn crossed(below: &[u32], triangle: &[u32; 3]) -> Range<usize> {
    let [a, b, c] = triangle.map(|v| below[v as usize] as usize);
    a.min(b).min(c)..a.max(b).max(c)
}

/// The walk along one plane, from triangle to triangle.
struct Walk<'a> {
    mesh: &'a Mesh,
    adjacency: &'a Adjacency,
    plane: Coord,
}

impl Walk<'_> {
    /// The closed contours, and the open chains between gaps in the mesh.
    fn chains(&self, triangles: &[u32], marks: &mut Marks) -> (Vec<Contour>, Vec<Contour>) {
        // Chains that start at a gap come first: a walk from their middle would cut them in two.
        let open = self.open_chains(triangles, marks);
        let mut closed = Vec::new();
        for &t in triangles {
            if !marks.is_set(t) {
                let mut chain = Vec::new();
                self.follow(t, marks, &mut chain);
                closed.push(chain);
            }
        }
        (closed, open)
    }

    /// The open chains.
    fn open_chains(&self, triangles: &[u32], marks: &mut Marks) -> Vec<Contour> {
        let mut open = Vec::new();
        for &t in triangles {
            let entry = self.edge(t, false);
            if self.adjacency.neighbour[t as usize][entry] == NONE && !marks.is_set(t) {
                let mut chain = vec![self.crossing(t, entry)];
                self.follow(t, marks, &mut chain);
                open.push(chain);
            }
        }
        open
    }

    /// Appends crossings from triangle `t` on, until the chain closes or ends at a gap.
    fn follow(&self, mut t: u32, marks: &mut Marks, chain: &mut Contour) {
        while !marks.is_set(t) {
            marks.set(t);
            let exit = self.edge(t, true);
            chain.push(self.crossing(t, exit));
            match self.adjacency.neighbour[t as usize][exit] {
                NONE => return,
                half => t = parts(half).0 as u32,
            }
        }
    }

    /// The edge of `t` that goes up (or down) through the plane.
    fn edge(&self, t: u32, up: bool) -> usize {
        let above = self.mesh.triangles[t as usize].map(|v| self.height(v) >= self.plane);
        (0..3).find(|&e| above[(e + 1) % 3] == up && above[e] != up).unwrap_or(0)
    }

    fn height(&self, vertex: u32) -> Coord {
        self.mesh.vertices[vertex as usize][2]
    }

    /// Where edge `e` of `t` meets the plane, rounded to the nearest unit. Both triangles of an edge
    /// get the same point.
    fn crossing(&self, t: u32, e: usize) -> Point {
        let corners = self.mesh.triangles[t as usize];
        let a = self.mesh.vertices[corners[e] as usize];
        let b = self.mesh.vertices[corners[(e + 1) % 3] as usize];
        let (low, high) = if a[2] < b[2] { (a, b) } else { (b, a) };
        let along = |axis: usize| between(low[axis], high[axis], (self.plane, low[2], high[2]));
        Point { x: along(0), y: along(1) }
    }
}

/// Most open chains of a layer that are joined to each other; if there are more, each is closed on
/// itself. A trade-off: time and memory grow with its square, up to 262 144 pairs for each layer. A
/// layer with more gaps is a triangle soup, where no way to join them is right.
const MOST_OPEN: usize = 512;

/// Closes open chains: joins each end to the nearest start by a straight line. Returns the length of
/// the longest such line.
///
/// Gaps are closed from the shortest on, and of equal ones by coordinates. So the result does not
/// depend on the order of the triangles.
fn close(mut open: Vec<Contour>, closed: &mut Vec<Contour>) -> Coord {
    open.sort_unstable();
    let ends: Vec<(Point, Point)> =
        open.iter().filter_map(|c| Some((*c.first()?, *c.last()?))).collect();
    let mut gaps: Vec<(i64, usize, usize)> = Vec::new();
    for (i, (_, end)) in ends.iter().enumerate() {
        let own = i..i + 1;
        let partners = if ends.len() <= MOST_OPEN { 0..ends.len() } else { own };
        gaps.extend(partners.map(|j| (end.distance2(ends[j].0), i, j)));
    }
    gaps.sort_unstable();
    let mut next = vec![None; open.len()];
    let mut taken = vec![false; open.len()];
    let mut longest = 0;
    for (gap2, i, j) in gaps {
        if next[i].is_none() && !taken[j] {
            next[i] = Some(j);
            taken[j] = true;
            longest = longest.max(gap2);
        }
    }
    for first in 0..open.len() {
        let mut contour = Vec::new();
        let mut at = first;
        while let Some(following) = next[at].take() {
            contour.append(&mut open[at]);
            at = following;
        }
        if !contour.is_empty() {
            closed.push(contour);
        }
    }
    (longest as f64).sqrt() as Coord
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::edges::adjacency;

    /// A box of 10 × 10 × 10 mm, without the triangles that `left_out` names.
    fn layers(left_out: &[usize]) -> Vec<Layer> {
        of_box(left_out, &|slicer, b| slicer.block(b))
    }

    fn of_box<T>(left_out: &[usize], make: &dyn Fn(&Slicer<'_>, usize) -> Vec<T>) -> Vec<T> {
        let corner = |k: i32| [(k & 1) * 100_000, (k >> 1 & 1) * 100_000, (k >> 2) * 100_000];
        let vertices: Vec<[i32; 3]> = (0..8).map(corner).collect();
        let faces: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
        let all = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let kept = all.enumerate().filter(|(k, _)| !left_out.contains(k));
        let mesh = Mesh { vertices, triangles: kept.map(|(_, t)| t).collect() };
        let adjacency = adjacency(&mesh.vertices, &mesh.triangles);
        let heights = Heights::even(2_000, 2_000, 100_000);
        let slicer = Slicer::new(&mesh, &adjacency, heights, 100);
        (0..slicer.blocks()).flat_map(|b| make(&slicer, b)).collect()
    }

    #[test]
    fn every_layer_of_a_box_is_its_square() {
        let layers = layers(&[]);
        assert_eq!(layers.len(), 50);
        for layer in layers {
            assert_eq!(layer.closed_gap, 0);
            assert_eq!(layer.contours.len(), 1);
            assert_eq!(crate::geom::double_area(&layer.contours[0]), 2 * 100_000_i128.pow(2));
        }
    }

    #[test]
    fn a_missing_side_is_closed_by_a_straight_line_and_reported() {
        for layer in layers(&[6, 7]) {
            assert_eq!(layer.closed_gap, 100_000);
            assert_eq!(crate::geom::double_area(&layer.contours[0]), 2 * 100_000_i128.pow(2));
        }
    }

    #[test]
    fn gaps_are_known_without_the_layers() {
        for left_out in [&[][..], &[6, 7], &[0, 3], &[5, 8]] {
            let layers = layers(left_out);
            let expected: Vec<_> = layers.iter().map(|l| (l.index, l.closed_gap)).collect();
            let gaps: Vec<(usize, Coord)> = of_box(left_out, &|slicer, b| slicer.gaps(b));
            assert_eq!(gaps, expected);
        }
    }
}
