//! Open edges -> rims -> filled holes: closes every opening whose shape leaves no doubt.

use super::Work;
use super::fill::{Filled, fill};
use super::notes::extent;
use crate::mesh::edges::{Adjacency, NONE, adjacency, parts};
use crate::mesh::faults::{Fault, Mending};
use crate::units::UNITS_PER_MM;
use hashbrown::HashMap;

/// Holes up to this across are closed whatever their shape, mm.
pub const SMALL_MM: f64 = 2.0;

/// A larger hole whose rim leaves a plane by more than this share of its extent is bent ...
const BENT: f64 = 0.05;

/// ... and is left open if what would close it is more than this share of the surface:
/// then the mesh is rather a sheet than a body.
const MOST_BENT: f64 = 0.2;

/// Fills holes with triangles over the corners of their rims.
pub(super) fn fill_holes(work: &mut Work) {
    let neighbours = adjacency(work.vertices, &work.triangles);
    if neighbours.unpaired == 0 {
        return;
    }
    let surface: f64 = work.triangles.iter().map(|&t| work.area(t)).sum();
    for rim in rims(work, &neighbours) {
        let size = extent(rim.iter().map(|&v| work.vertices[v as usize]));
        work.found.sized(Fault::Hole, rim[0], size);
        let filled = fill(work.vertices, &rim);
        if is_sure(work, &filled, size, surface) {
            work.done.sized(Mending::FilledHole, rim[0], size);
            work.triangles.extend(filled.triangles);
        }
    }
}

/// Whether a hole is closed as its rim says.
fn is_sure(work: &Work, filled: &Filled, size: f64, surface: f64) -> bool {
    if size <= SMALL_MM * UNITS_PER_MM {
        return true;
    }
    let is_bent = filled.depth > BENT * size;
    let closing: f64 = filled.triangles.iter().map(|&t| work.area(t)).sum();
    !filled.is_crooked && (!is_bent || closing <= MOST_BENT * surface)
}

/// The rims of the holes, as the triangles that fill them have to run along them.
///
/// An open half-edge is followed by the one that is met first when turning about its end
/// within the surface. So each has one successor and one predecessor, and rims are closed.
fn rims(work: &Work, neighbours: &Adjacency) -> Vec<Vec<u32>> {
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
            rims.extend(simple.map(|rim| from_least(work, rim)));
        }
    }
    rims
}

/// A rim that passes some corners more than once, as rims that do not: two holes that touch,
/// or a hole and what stands in it, are closed each by itself.
fn without_repeats(rim: Vec<u32>) -> Vec<Vec<u32>> {
    let mut simple = Vec::new();
    let mut way: Vec<u32> = Vec::new();
    // Where on the way a vertex is.
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

/// A rim from its least corner on, so that the order of the triangles does not show.
fn from_least(work: &Work, mut rim: Vec<u32>) -> Vec<u32> {
    let start = (0..rim.len()).min_by_key(|&k| work.vertices[rim[k] as usize]);
    rim.rotate_left(start.unwrap_or(0));
    rim
}
