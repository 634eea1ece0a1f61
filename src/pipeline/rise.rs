//! Mesh + islands of the first layer -> Rise: how high what stands on each of them rises, alone and in all.
//!
//! The surface of the mesh is flooded from below. What lies below the first layer's plane and hangs
//! together belongs to one island, the one on whose contour it crosses the plane. As the flood rises,
//! pieces of the surface meet; where those of two islands do, neither stands alone any more. In the
//! end each piece is a body. Bodies that only lie in each other, as shells that overlap, never meet
//! above the plane: they are one body if they have an island in common.

use crate::fill::adhesion::loose::Rise;
use crate::geom::boxes::Boxes;
use crate::geom::nest::extent;
use crate::geom::segment::distance2;
use crate::geom::sets::Sets;
use crate::geom::{Contour, Point, edges};
use crate::mesh::Mesh;
use crate::units::{Coord, between};

/// How high what stands on each of `contours` rises. They are those of the layer whose plane is at
/// height `plane`; those of holes count for the outer contour in which they lie, by `islands`.
pub(super) fn rise(
    mesh: &Mesh,
    plane: Coord,
    contours: &[Contour],
    islands: &[usize],
) -> Vec<Rise> {
    let z = |v: u32| mesh.vertices[v as usize][2];
    let mut flood = Flood::new(mesh.vertices.len(), contours.len());
    for triangle in &mesh.triangles {
        for (a, b) in sides(triangle) {
            if z(a) < plane && z(b) < plane {
                flood.sets.join(a as usize, b as usize);
            }
        }
    }
    let nearest = Nearest::new(contours);
    // Where each piece crosses the plane: once is enough.
    for (a, b) in mesh.triangles.iter().flat_map(sides) {
        let (low, high) = if z(a) < z(b) { (a, b) } else { (b, a) };
        if z(low) < plane && z(high) >= plane {
            let root = flood.sets.root(low as usize);
            if flood.island[root].is_none() {
                let place = crossing(mesh, (low, high), plane);
                flood.island[root] = nearest.to(place).map(|k| islands[k]);
            }
        }
    }
    flood.unite_islands();
    // A triangle joins its two lower corners at the height of the second, and all at the third's.
    let mut events: Vec<(Coord, u32, u32)> = Vec::with_capacity(2 * mesh.triangles.len());
    for &[a, b, c] in &mesh.triangles {
        let mut corners = [a, b, c];
        corners.sort_unstable_by_key(|&v| (z(v), v));
        let [low, middle, high] = corners;
        events.extend([(z(middle), low, middle), (z(high), middle, high)]);
    }
    events.retain(|event| event.0 >= plane);
    events.sort_unstable();
    for (height, a, b) in events {
        flood.join(height, a as usize, b as usize);
    }
    flood.rises(mesh, contours.len())
}

/// Pieces of the surface as they meet.
struct Flood {
    sets: Sets,
    /// For each root the island of the piece; one of them, if it has several.
    island: Vec<Option<usize>>,
    /// A vertex of each island.
    vertex: Vec<Option<usize>>,
    /// Where each island meets another one first.
    met: Vec<Option<Coord>>,
}

impl Flood {
    fn new(vertices: usize, islands: usize) -> Self {
        Self {
            sets: Sets::new(vertices),
            island: vec![None; vertices],
            vertex: vec![None; islands],
            met: vec![None; islands],
        }
    }

    /// Makes one piece of all pieces of an island.
    fn unite_islands(&mut self) {
        for k in 0..self.island.len() {
            if let Some(island) = self.island[k] {
                match self.vertex[island] {
                    Some(vertex) => _ = self.sets.join(vertex, k),
                    None => self.vertex[island] = Some(k),
                }
            }
        }
        for (island, vertex) in self.vertex.iter().enumerate() {
            if let Some(vertex) = vertex {
                let root = self.sets.root(*vertex);
                self.island[root] = Some(island);
            }
        }
    }

    /// Two vertices hang together from this height on.
    fn join(&mut self, height: Coord, a: usize, b: usize) {
        let roots = [a, b].map(|v| self.sets.root(v));
        let Some((root, joined)) = self.sets.join(a, b) else { return };
        let [one, other] = roots.map(|root| self.island[root]);
        if let (Some(one), Some(other)) = (one, other) {
            for island in [one, other] {
                self.met[island].get_or_insert(height);
            }
        }
        self.island[root] = self.island[root].or(self.island[joined]);
    }

    fn rises(mut self, mesh: &Mesh, count: usize) -> Vec<Rise> {
        let mut tops = vec![0; self.island.len()];
        for (v, vertex) in mesh.vertices.iter().enumerate() {
            let root = self.sets.root(v);
            tops[root] = tops[root].max(vertex[2]);
        }
        let rise = |island: usize| {
            let Some(vertex) = self.vertex[island] else {
                return Rise { alone: 0, whole: 0, body: usize::MAX };
            };
            let body = self.sets.root(vertex);
            let whole = tops[body];
            Rise { alone: self.met[island].unwrap_or(whole), whole, body }
        };
        (0..count).map(rise).collect()
    }
}

/// The sides of a triangle.
fn sides(&[a, b, c]: &[u32; 3]) -> [(u32, u32); 3] {
    [(a, b), (b, c), (c, a)]
}

/// Where an edge crosses the plane.
fn crossing(mesh: &Mesh, (low, high): (u32, u32), plane: Coord) -> Point {
    let [from, to] = [low, high].map(|v| mesh.vertices[v as usize]);
    let at = |axis: usize| between(from[axis], to[axis], (plane, from[2], to[2]));
    Point { x: at(0), y: at(1) }
}

/// How far from its contour a place of the surface is looked for first, grid units (1 mm): contours are
/// simplified and moved by less. It affects speed only.
const REACH: Coord = 10_000;

/// Contours, to find that nearest to a place.
struct Nearest<'a> {
    contours: &'a [Contour],
    boxes: Boxes,
}

impl<'a> Nearest<'a> {
    fn new(contours: &'a [Contour]) -> Self {
        let grown = |contour: &Contour| {
            let (low, high) = extent(contour).unwrap_or_default();
            let by = |p: Point, by: Coord| Point { x: p.x + by, y: p.y + by };
            (by(low, -REACH), by(high, REACH))
        };
        Self { contours, boxes: Boxes::new(contours.iter().map(grown).collect()) }
    }

    /// The contour nearest to a place, of equal ones the first.
    fn to(&self, place: Point) -> Option<usize> {
        let floats = |p: Point| [f64::from(p.x), f64::from(p.y)];
        let far = |k: usize| {
            let all = edges(&self.contours[k])
                .map(|(a, b)| distance2(floats(place), [floats(a), floats(b)]));
            (all.fold(f64::INFINITY, f64::min), k)
        };
        let order = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        // Whatever is nearer than the reach has its grown box around the place.
        let near = self.boxes.around(place).map(far).min_by(order);
        let is_sure = near.is_some_and(|(far2, _)| far2 < f64::from(REACH) * f64::from(REACH));
        let all = || (0..self.contours.len()).map(far).min_by(order);
        if is_sure { near } else { all() }.map(|(_, k)| k)
    }
}
