//! Triangles -> triangles wound alike: turns those that are wound against their neighbours.

use super::Work;
use crate::mesh::edges::{NONE, each_edge, parts, starts_at};
use crate::mesh::faults::{Fault, Mending};

/// A patch may have so many of its triangles turned before its winding counts as unknown:
/// then it is wound so that it encloses a positive volume.
const MOST_TURNED: f64 = 0.25;

/// Winds the triangles of every patch alike. A patch is what hangs together by edges of two
/// triangles; the winding that more of its triangles have is right.
pub(super) fn orient(work: &mut Work) {
    let neighbours = neighbours(work);
    // Whether a triangle is to be turned, and whether it was reached yet.
    let (mut turned, mut reached) =
        (vec![false; work.triangles.len()], vec![false; work.triangles.len()]);
    let mut patch = Vec::new();
    for seed in 0..work.triangles.len() {
        if reached[seed] {
            continue;
        }
        patch.clear();
        patch.push(seed);
        reached[seed] = true;
        let mut at = 0;
        while let Some(&t) = patch.get(at) {
            at += 1;
            for side in 0..3 {
                let other = neighbours[t][side];
                if other == NONE {
                    continue;
                }
                let (u, side_of_other) = parts(other);
                if reached[u] {
                    continue;
                }
                reached[u] = true;
                let alike = work.triangles[t][side] != work.triangles[u][side_of_other];
                turned[u] = if alike { turned[t] } else { !turned[t] };
                patch.push(u);
            }
        }
        settle(work, &patch, &mut turned);
    }
    for (triangle, _) in work.triangles.iter_mut().zip(&turned).filter(|(_, turned)| **turned) {
        work.done.add(Mending::Turned, triangle[0]);
        triangle.swap(1, 2);
    }
}

/// Chooses between the two windings of a patch.
fn settle(work: &Work, patch: &[usize], turned: &mut [bool]) {
    let count = patch.iter().filter(|&&t| turned[t]).count();
    let share = count.min(patch.len() - count) as f64 / patch.len() as f64;
    let other = if share <= MOST_TURNED {
        2 * count > patch.len()
    } else {
        let as_turned = patch.iter().map(|&t| {
            let [a, b, c] = work.triangles[t];
            if turned[t] { [a, c, b] } else { [a, b, c] }
        });
        work.volume(as_turned) < 0
    };
    if other {
        patch.iter().for_each(|&t| turned[t] = !turned[t]);
    }
}

/// For each side of each triangle the half-edge on the other side of an edge of exactly two
/// triangles, in whatever direction it runs.
fn neighbours(work: &mut Work) -> Vec<[u32; 3]> {
    let mut neighbours = vec![[NONE; 3]; work.triangles.len()];
    let (triangles, found) = (&work.triangles, &mut work.found);
    each_edge(work.vertices.len(), triangles, |(low, _), sides| {
        if let &[a, b] = sides {
            for (from, to) in [(a, b), (b, a)] {
                let (t, side) = parts(from);
                neighbours[t][side] = to;
            }
            if starts_at(low, a, triangles) == starts_at(low, b, triangles) {
                found.add(Fault::FlippedEdge, low);
            }
        }
    });
    neighbours
}
