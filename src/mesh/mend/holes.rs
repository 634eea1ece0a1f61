//! Open edges -> rims -> filled holes: closes every opening whose shape leaves no doubt.

use super::bridge::{band, pairs};
use super::fill::{Filled, fill};
use super::links::Links;
use super::{Work, shells};
use crate::mesh::edges::{Adjacency, NONE, adjacency, parts};
use crate::mesh::faults::{Fault, Mending};
use crate::mesh::geometry::bounds::Bounds;
use crate::mesh::geometry::crossings::{crossings, depth};
use crate::mesh::geometry::tree::Tree;
use crate::units::UNITS_PER_MM;
use hashbrown::HashMap;

/// Holes up to this across are closed whatever their shape, mm.
pub const SMALL_MM: f64 = 2.0;

/// A larger hole whose rim leaves a plane by more than this share of its extent is bent ...
const BENT: f64 = 0.05;

/// ... and is left open if what would close it is more than this share of the surface:
/// then the mesh is rather a sheet than a body.
const MOST_BENT: f64 = 0.2;

/// Crossings up to this deep do not tell against what closes a hole, mm.
const MOST_CROSSING_MM: f64 = 0.05;

/// The rim of a hole.
pub(super) struct Rim {
    /// Its corners, as the triangles that fill the hole have to run along them.
    pub(super) way: Vec<u32>,
    /// The diagonal of the box around it, grid units.
    pub(super) size: f64,
    /// A triangle beside it.
    beside: u32,
    /// Whether it runs round a triangle that is there, as that of a fin does.
    pub(super) is_fin: bool,
}

/// What may close a hole, or the gap between two.
struct Closing {
    triangles: Vec<[u32; 3]>,
    /// The patch that it must not pass through; none if that does not matter.
    patch: Option<u32>,
}

/// Fills holes with triangles over the corners of their rims, and gaps between two rims.
pub(super) fn fill_holes(work: &mut Work) {
    let neighbours = adjacency(work.vertices, &work.triangles);
    if neighbours.unpaired == 0 {
        return;
    }
    let mut links = shells::links(&neighbours);
    let surface: f64 = work.triangles.iter().map(|&t| work.area(t)).sum();
    let mut rims = rims(work, &neighbours);
    mark_fins(work, &mut rims);
    let patches: Vec<u32> = rims.iter().map(|rim| links.root(rim.beside)).collect();
    let pairs = pairs(work.vertices, &rims);
    let mut is_joined = vec![false; rims.len()];
    // First those of the rims, then those of the pairs.
    let mut closings: Vec<Closing> = Vec::new();
    for (rim, &patch) in rims.iter().zip(&patches) {
        let filled = fill(work.vertices, &rim.way);
        let is_sure = is_sure(work, &filled, rim.size, surface);
        let triangles = if is_sure { filled.triangles } else { Vec::new() };
        let is_large = !rim.is_fin && rim.size > SMALL_MM * UNITS_PER_MM;
        closings.push(Closing { triangles, patch: is_large.then_some(patch) });
    }
    for pair in &pairs {
        let [a, b] = pair.rims;
        let triangles = band(work.vertices, &rims[a].way, &rims[b].way);
        let is_same = patches[a] == patches[b];
        closings.push(Closing { triangles, patch: is_same.then_some(patches[a]) });
    }
    let is_bad = crossing(work, &mut links, &closings);
    for (k, pair) in pairs.iter().enumerate() {
        let ([a, b], own) = (pair.rims, rims.len() + k);
        let is_same = closings[own].patch.is_some();
        if !is_same || (!is_bad[own] && (is_bad[a] || is_bad[b])) {
            is_joined[a] = true;
            is_joined[b] = true;
            work.found.sized(Fault::Gap, rims[a].way[0], pair.apart);
            work.done.sized(Mending::Bridged, rims[a].way[0], pair.apart);
            work.triangles.extend(&closings[own].triangles);
        }
    }
    for (k, rim) in rims.iter().enumerate().filter(|(k, _)| !is_joined[*k]) {
        work.found.sized(Fault::Hole, rim.way[0], rim.size);
        if !is_bad[k] && !closings[k].triangles.is_empty() {
            work.done.sized(Mending::FilledHole, rim.way[0], rim.size);
            work.triangles.extend(&closings[k].triangles);
        }
    }
}

/// Marks the rims that run round a triangle of the mesh: what fills them is its copy.
fn mark_fins(work: &Work, rims: &mut [Rim]) {
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

/// Which closings pass through the patch whose hole they close.
fn crossing(work: &Work, links: &mut Links, closings: &[Closing]) -> Vec<bool> {
    let mut is_bad = vec![false; closings.len()];
    if closings.iter().all(|closing| closing.patch.is_none()) {
        return is_bad;
    }
    let first = work.triangles.len();
    let mut triangles = work.triangles.clone();
    let mut owners = Vec::new();
    for (k, closing) in closings.iter().enumerate().filter(|(_, one)| one.patch.is_some()) {
        triangles.extend(&closing.triangles);
        owners.resize(triangles.len() - first, k);
    }
    let tree = Tree::new(work.vertices, &triangles);
    for pair in crossings(&tree).pairs {
        let [own, new] = pair.map(|t| t as usize);
        if own < first && new >= first {
            let k = owners[new - first];
            let is_own = closings[k].patch == Some(links.root(pair[0]));
            is_bad[k] |= is_own && depth(&tree, pair) > MOST_CROSSING_MM;
        }
    }
    is_bad
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
fn rims(work: &Work, neighbours: &Adjacency) -> Vec<Rim> {
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
