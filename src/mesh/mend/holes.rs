//! Rims -> filled holes: closes every opening whose shape leaves no doubt.

use super::bridge::{band, pairs};
use super::fill::{Filled, fill};
use super::links::Links;
use super::rim::{mark_fins, rims};
use super::{Work, shells};
use crate::mesh::edges::adjacency;
use crate::mesh::faults::{Fault, Mending};
use crate::mesh::geometry::crossings::{crossings, depth};
use crate::mesh::geometry::tree::Tree;
use crate::units::UNITS_PER_MM;

/// Holes up to this diameter are filled whatever their shape, mm: a print shows little of them. A
/// larger value fills openings of thin sheets.
pub const SMALL_MM: f64 = 2.0;

/// A larger hole is bent if its rim leaves a plane by more than this share of its diameter.
const BENT: f64 = 0.05;

/// A bent hole stays open if its filling were more than this share of the surface: then the mesh is
/// a sheet rather than a body. With a larger value bowls and shields without a back are filled;
/// with a smaller one scans with an open bottom stay open.
const MOST_BENT: f64 = 0.2;

/// A filling may pass through its own patch by this depth, mm: that is the noise of a scan's rim. A
/// larger value lets fillings cut off parts of the body.
const MOST_CROSSING_MM: f64 = 0.05;

/// What would close a hole, or the gap between two.
struct Closing {
    triangles: Vec<[u32; 3]>,
    /// The patch that it must not pass through; `None` if that does not matter.
    patch: Option<u32>,
}

/// Fills holes with triangles over the corners of their rims, and bridges gaps between two rims.
///
/// Two rims of different patches that face each other are bridged. Two rims of one patch are
/// bridged only if filling one of them would pass through the patch, and bridging would not.
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
    // Those of the rims, then those of the pairs.
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

/// Which closings pass through their own patch.
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

/// Whether the shape of a rim leaves no doubt about its filling.
fn is_sure(work: &Work, filled: &Filled, size: f64, surface: f64) -> bool {
    if size <= SMALL_MM * UNITS_PER_MM {
        return true;
    }
    let is_bent = filled.depth > BENT * size;
    let closing: f64 = filled.triangles.iter().map(|&t| work.area(t)).sum();
    !filled.is_crooked && (!is_bent || closing <= MOST_BENT * surface)
}
