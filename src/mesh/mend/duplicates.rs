//! Copies of triangles -> one or none: keeps one of each where it closes the surface, none where it is an inner wall or a sheet.

use super::Work;
use super::links::Links;
use crate::mesh::edges::{each_edge, parts};
use crate::mesh::faults::{Fault, Mending};
use rayon::prelude::*;

/// Drops copies of triangles over the same three corners, in either direction.
///
/// Of an odd number one stays. An even number may be a surface that was written twice, or
/// two bodies' common wall, or a sheet with a front and a back. Neighbouring doubled
/// triangles are judged together, by the edges where they end: if a single other triangle
/// goes on there, one copy is needed to close the surface; if two do, or none, it is not.
/// A closed surface of doubled triangles has no such edges, and stays once.
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

/// The one of some copies that stays: one of the more frequent direction.
fn kept_of(work: &Work, group: &[([u32; 3], u32)]) -> u32 {
    let is_even = |t: u32| {
        // By place, not by number: the order of the triangles must not show.
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
    // Doubled triangle at an edge where an odd number of them meet, number of other triangles there.
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
    // Votes for keeping less votes for dropping, by the patch's first triangle.
    let mut votes = vec![0_i64; doubled.len()];
    let is_flat = flat_patches(work, doubled, &mut links);
    for (k, others) in ends {
        let patch = links.root(k) as usize;
        votes[patch] += match others {
            // Where nothing goes on: the rim of a sheet, or of a hole in a doubled surface.
            0 => -i64::from(is_flat[patch]),
            _ if others % 2 == 1 => 1,
            _ => -1,
        };
    }
    let mut is_needless = |k: u32| votes[links.root(k) as usize] < 0;
    (0_u32..).zip(doubled).filter(|(k, _)| is_needless(*k)).map(|(_, &t)| t).collect()
}

/// Whether each patch encloses next to nothing, by the patch's first triangle.
fn flat_patches(work: &Work, doubled: &[u32], links: &mut Links) -> Vec<bool> {
    let groups = links.groups();
    let mut is_flat = vec![false; doubled.len()];
    for group in groups {
        let triangles = group.iter().map(|&k| work.triangles[doubled[k as usize] as usize]);
        is_flat[links.root(group[0]) as usize] = work.is_flat(triangles);
    }
    is_flat
}
