//! Triangles -> triangles wound alike: turns those that are wound against their neighbours.

use super::Work;
use super::probes::{MOST_INSIDE, Probes};
use crate::mesh::edges::{NONE, each_edge, parts, starts_at};
use crate::mesh::faults::{Fault, Mending};
use crate::mesh::geometry::measure::corners_of;
use crate::mesh::geometry::tree::Tree;
use crate::mesh::geometry::vector::Corner;

/// If more than this share of a patch would have to be turned, the majority does not decide which
/// way it faces; what it lies in does. Files with some wrong triangles have a few per cent of
/// them, files with random ones half: a quarter is the middle between them.
const MOST_TURNED: f64 = 0.25;

/// Winds the triangles of each patch alike, as the majority of them is wound. Where there is no
/// clear majority, the patch faces outward, or inward if it lies in an odd number of others.
pub(super) fn orient(work: &mut Work) {
    let neighbours = neighbours(work);
    let mut turned = vec![false; work.triangles.len()];
    let mut patch_of = vec![u32::MAX; work.triangles.len()];
    let (mut count, mut unclear) = (0, Vec::new());
    for seed in 0..work.triangles.len() {
        if patch_of[seed] != u32::MAX {
            continue;
        }
        let patch = reach(work, &neighbours, (seed, count), &mut patch_of, &mut turned);
        let against = patch.iter().filter(|&&t| turned[t]).count();
        if 2 * against > patch.len() {
            patch.iter().for_each(|&t| turned[t] = !turned[t]);
        }
        if against.min(patch.len() - against) as f64 > MOST_TURNED * patch.len() as f64 {
            unclear.push(patch);
        }
        count += 1;
    }
    as_they_lie(work, &patch_of, &unclear, &mut turned);
    for (triangle, _) in work.triangles.iter_mut().zip(&turned).filter(|(_, turned)| **turned) {
        work.done.add(Mending::Turned, triangle[0]);
        triangle.swap(1, 2);
    }
}

/// The triangles of the patch of `seed`. Marks them with the `number` of the patch, and those that
/// are wound against `seed` as to be turned.
fn reach(
    work: &Work,
    neighbours: &[[u32; 3]],
    (seed, number): (usize, u32),
    patch_of: &mut [u32],
    turned: &mut [bool],
) -> Vec<usize> {
    let mut patch = vec![seed];
    patch_of[seed] = number;
    let mut at = 0;
    while let Some(&t) = patch.get(at) {
        at += 1;
        for (side, &other) in neighbours[t].iter().enumerate().filter(|(_, o)| **o != NONE) {
            let (u, side_of_other) = parts(other);
            if patch_of[u] != u32::MAX {
                continue;
            }
            let alike = work.triangles[t][side] != work.triangles[u][side_of_other];
            turned[u] = turned[t] ^ !alike;
            patch_of[u] = number;
            patch.push(u);
        }
    }
    patch
}

/// Winds patches without a clear majority by what they lie in.
fn as_they_lie(work: &Work, patch_of: &[u32], unclear: &[Vec<usize>], turned: &mut [bool]) {
    if unclear.is_empty() {
        return;
    }
    let tree = Tree::new(work.vertices, &work.triangles);
    for patch in unclear {
        let own = patch_of[patch[0]];
        let mut probes = Probes::default();
        for &t in patch {
            probes.add(corners_of(work.vertices, work.triangles[t]));
        }
        let is_inside = |place: &Corner| {
            let mut crossed = 0;
            tree.above(*place, |t, _| crossed += u32::from(patch_of[t as usize] != own));
            crossed % 2 == 1
        };
        let is_cavity = probes.places().iter().filter(|p| is_inside(p)).count() >= MOST_INSIDE;
        let wound = patch.iter().map(|&t| {
            let [a, b, c] = work.triangles[t];
            if turned[t] { [a, c, b] } else { [a, b, c] }
        });
        let volume = work.volume(wound);
        if volume != 0 && (volume < 0) != is_cavity {
            patch.iter().for_each(|&t| turned[t] = !turned[t]);
        }
    }
}

/// For each side of each triangle the other half-edge of an edge of exactly two triangles, in
/// either direction.
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
