//! Copies of triangles -> one or none: keeps one where it closes the surface, and none where it is an inner wall or a sheet.

use super::Work;
use super::links::Links;
use crate::mesh::edges::{each_edge, parts};
use crate::mesh::faults::{Fault, Mending};
use rayon::prelude::*;

/// Drops copies of triangles: those over the same three corners, in either direction.
///
/// Of an odd number one stays. An even number can be a surface that was written twice, the common
/// wall of two bodies, or a sheet with a front and a back. Adjacent doubled triangles share their
/// fate; the edges where they end decide it. If one other triangle continues there, one copy is
/// needed to close the surface; if two or none continue, it is not. A closed surface of doubled
/// triangles has no such edges, and one copy stays.
pub(super) fn drop_duplicates(work: &mut Work) {
    let mut keyed: Vec<([u32; 3], u32)> =
        work.triangles.par_iter().zip(0_u32..work.count()).map(|(t, k)| (sorted(*t), k)).collect();
    keyed.par_sort_unstable();
    let mut drop = vec![false; work.triangles.len()];
    let mut doubled = Vec::new();
    for group in keyed.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
        let kept = kept_of(work, group);
        for &(_, t) in group.iter().filter(|(_, t)| *t != kept) {
            drop[t as usize] = true;
            work.found.add(Fault::Duplicate, group[0].0[0]);
            work.done.add(Mending::DroppedDuplicate, group[0].0[0]);
        }
        if group.len().is_multiple_of(2) {
            doubled.push(kept);
        }
    }
    if !drop.contains(&true) {
        return;
    }
    for t in needless(work, &drop, &doubled) {
        drop[t as usize] = true;
        work.drop_sheet(work.triangles[t as usize]);
    }
    work.drop_marked(&drop);
}

fn sorted(mut triangle: [u32; 3]) -> [u32; 3] {
    triangle.sort_unstable();
    triangle
}

/// The copy that stays: one in the more frequent direction.
fn kept_of(work: &Work, group: &[([u32; 3], u32)]) -> u32 {
    let is_even = |t: u32| {
        // By coordinates before numbers, so that the order of the triangles does not matter.
        let [a, b, c] = work.triangles[t as usize].map(|v| (work.vertices[v as usize], v));
        (a < b) ^ (b < c) ^ (c < a)
    };
    let even = group.iter().filter(|(_, t)| is_even(*t)).count();
    let wanted = 2 * even >= group.len();
    group.iter().find(|(_, t)| is_even(*t) == wanted).map_or(group[0].1, |(_, t)| *t)
}

/// Which of the `doubled` triangles are not needed to close a surface.
fn needless(work: &Work, drop: &[bool], doubled: &[u32]) -> Vec<u32> {
    let mut place = vec![u32::MAX; work.triangles.len()];
    for (k, &t) in (0_u32..).zip(doubled) {
        place[t as usize] = k;
    }
    let mut links = Links::new(doubled.len());
    // For each edge with an odd number of doubled triangles: one of these, and the number of
    // other triangles.
    let mut ends: Vec<(u32, usize)> = Vec::new();
    each_edge(work.vertices.len(), &work.triangles, |_, sides| {
        let kept = sides.iter().map(|&half| parts(half).0).filter(|&t| !drop[t]);
        let (of_two, others): (Vec<usize>, Vec<usize>) = kept.partition(|&t| place[t] != u32::MAX);
        for pair in of_two.windows(2) {
            links.join(place[pair[0]], place[pair[1]]);
        }
        if of_two.len() % 2 == 1 {
            ends.push((place[of_two[0]], others.len()));
        }
    });
    // Votes for keeping minus votes for dropping, under the first triangle of each patch.
    let mut votes = vec![0_i64; doubled.len()];
    let is_flat = flat_patches(work, doubled, &mut links);
    for (k, others) in ends {
        let patch = links.root(k) as usize;
        votes[patch] += match others {
            // Nothing continues: the rim of a sheet, or of a hole in a doubled surface.
            0 => -i64::from(is_flat[patch]),
            _ if others % 2 == 1 => 1,
            _ => -1,
        };
    }
    let mut is_needless = |k: u32| votes[links.root(k) as usize] < 0;
    (0_u32..).zip(doubled).filter(|(k, _)| is_needless(*k)).map(|(_, &t)| t).collect()
}

/// Whether each patch encloses next to nothing, under its first triangle.
fn flat_patches(work: &Work, doubled: &[u32], links: &mut Links) -> Vec<bool> {
    let groups = links.groups();
    let mut is_flat = vec![false; doubled.len()];
    for group in groups {
        let triangles = group.iter().map(|&k| work.triangles[doubled[k as usize] as usize]);
        is_flat[links.root(group[0]) as usize] = work.is_flat(triangles);
    }
    is_flat
}
