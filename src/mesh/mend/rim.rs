//! Open edges -> rims: walks along the open edges around each hole.

use super::Work;
use crate::mesh::edges::{Adjacency, NONE, parts};
use crate::mesh::geometry::bounds::Bounds;
use hashbrown::HashMap;

/// The rim of a hole.
pub(super) struct Rim {
    /// Its corners, in the direction of the triangles that fill the hole.
    pub(super) way: Vec<u32>,
    /// Its diameter: the diagonal of the box around it, grid units.
    pub(super) size: f64,
    /// A triangle at it.
    pub(super) beside: u32,
    /// Whether it runs around a triangle that exists, as that of a fin does.
    pub(super) is_fin: bool,
}

/// The rims of all holes.
///
/// The next open half-edge is the first that is met when turning around the end of the last one,
/// within the surface. So each has one successor and one predecessor, and rims are closed.
pub(super) fn rims(work: &Work, neighbours: &Adjacency) -> Vec<Rim> {
    let mut seen = vec![[false; 3]; work.triangles.len()];
    let mut rims = Vec::new();
    for first in 0..work.triangles.len() {
        for side in 0..3 {
            let (mut t, mut e) = (first, side);
            let mut rim = Vec::new();
            while neighbours.neighbour[t][e] == NONE && !seen[t][e] {
                seen[t][e] = true;
                rim.push(work.triangles[t][e]);
                e = (e + 1) % 3;
                while neighbours.neighbour[t][e] != NONE {
                    let (u, other) = parts(neighbours.neighbour[t][e]);
                    (t, e) = (u, (other + 1) % 3);
                }
            }
            rim.reverse();
            let simple = without_repeats(rim).into_iter().filter(|rim| rim.len() >= 3);
            rims.extend(simple.map(|rim| {
                let way = from_least(work, rim);
                let size = Bounds::of(way.iter().map(|&v| work.vertices[v as usize])).diagonal();
                Rim { way, size, beside: first as u32, is_fin: false }
            }));
        }
    }
    rims
}

/// Splits a rim that passes some corners more than once into rims that do not: two holes that
/// touch are filled separately.
fn without_repeats(rim: Vec<u32>) -> Vec<Vec<u32>> {
    let mut simple = Vec::new();
    let mut way: Vec<u32> = Vec::new();
    // The place of each vertex on the way.
    let mut place = HashMap::new();
    for vertex in rim {
        if let Some(&at) = place.get(&vertex) {
            let own = way.split_off(at);
            own.iter().for_each(|vertex| {
                place.remove(vertex);
            });
            simple.push(own);
        }
        place.insert(vertex, way.len());
        way.push(vertex);
    }
    simple.push(way);
    simple
}

/// A rim that begins at its least corner, so that the order of the triangles does not matter.
fn from_least(work: &Work, mut rim: Vec<u32>) -> Vec<u32> {
    let start = (0..rim.len()).min_by_key(|&k| work.vertices[rim[k] as usize]);
    rim.rotate_left(start.unwrap_or(0));
    rim
}

/// Marks the rims that run around a triangle of the mesh: their filling is its copy.
pub(super) fn mark_fins(work: &Work, rims: &mut [Rim]) {
    let key = |way: &[u32]| {
        let mut corners = [way[0], way[1], way[2]];
        corners.sort_unstable();
        corners
    };
    let small = rims.iter_mut().filter(|rim| rim.way.len() == 3);
    let mut of: HashMap<[u32; 3], Vec<&mut Rim>> = HashMap::new();
    small.for_each(|rim| of.entry(key(&rim.way)).or_default().push(rim));
    for triangle in &work.triangles {
        for rim in of.get_mut(&key(triangle)).into_iter().flatten() {
            rim.is_fin = true;
        }
    }
}
