//! Connected surfaces -> shells that face outward: drops those that enclose nothing, turns those that are inside out.
//!
//! A shell is a connected surface: a body, or a cavity in one. It faces outward if its volume is
//! positive. A shell is flat if it encloses nothing.
//!
//! 1. Join the triangles across their sides; sum the volume of each shell.
//! 2. Drop flat shells.
//! 3. A shell that faces inward and lies in no other is inverted, and so is everything in it: such
//!    files come from mirroring. Turn them. A shell that faces inward within another is a cavity.
//!
//! What a shell lies in is found from six places on it: another shell encloses it if it winds
//! around four of them. A ray up from each place counts the windings (see
//! [`Tree::above`]); the tree holds only the triangles that can lie above a place.
//!
//! Volumes are integers, and places do not depend on the order of the triangles: neither does the
//! result.

use super::Work;
use super::columns::Columns;
use super::links::Links;
use super::probes::{MOST_INSIDE, Probes};
use crate::mesh::edges::{Adjacency, NONE, parts};
use crate::mesh::faults::{Fault, Mending};
use crate::mesh::geometry::bounds::Bounds;
use crate::mesh::geometry::measure::{corners_of, determinant, determinants};
use crate::mesh::geometry::tree::Tree;
use crate::mesh::geometry::vector::Corner;
use rayon::prelude::*;

/// The shells of a mesh.
pub(in crate::mesh) struct Shells {
    /// The shell of each triangle.
    pub(in crate::mesh) of: Vec<u32>,
    /// All shells.
    pub(in crate::mesh) each: Vec<Shell>,
}

/// A connected surface.
pub(in crate::mesh) struct Shell {
    /// The first of its triangles.
    pub(in crate::mesh) first: u32,
    /// Whether none of its edges is open.
    pub(in crate::mesh) is_closed: bool,
    /// Six times its volume; negative if it faces inward.
    pub(in crate::mesh) volume: i128,
}

/// Drops flat shells and turns inverted ones. Returns the number of shells that are left, and
/// whether anything was changed.
pub(super) fn settle(work: &mut Work, adjacency: &Adjacency, is_mended: bool) -> (usize, bool) {
    let shells = shells(work.vertices, &work.triangles, adjacency);
    let flat = flat(work, &shells, is_mended);
    let is_inverted = inverted(work, &shells, &flat);
    if !flat.contains(&true) && !is_inverted.contains(&true) {
        return (shells.each.len(), false);
    }
    for (shell, _) in shells.each.iter().zip(&is_inverted).filter(|(_, inverted)| **inverted) {
        let at = work.triangles[shell.first as usize][0];
        work.found.add(Fault::InvertedShell, at);
        work.done.add(Mending::TurnedShell, at);
    }
    let mut drop = vec![false; work.triangles.len()];
    for (t, &shell) in shells.of.iter().enumerate() {
        if is_inverted[shell as usize] {
            work.triangles[t].swap(1, 2);
        }
        if flat[shell as usize] {
            drop[t] = true;
            work.found.add(Fault::Sheet, work.triangles[t][0]);
            work.drop_sheet(work.triangles[t]);
        }
    }
    work.sheets = flat.iter().filter(|flat| **flat).count();
    work.drop_marked(&drop);
    (flat.len() - work.sheets, true)
}

/// The number of connected surfaces.
pub(super) fn count(adjacency: &Adjacency) -> usize {
    links(adjacency).sets()
}

/// The triangles, joined across their sides.
pub(super) fn links(adjacency: &Adjacency) -> Links {
    // One of the two triangles at an edge is enough.
    Links::of(adjacency.neighbour.len(), |t| {
        let sides = adjacency.neighbour[t as usize].into_iter().filter(|side| *side != NONE);
        sides.map(|side| parts(side).0 as u32).filter(move |other| *other < t)
    })
}

/// The shells of a mesh, in the order of their first triangles.
pub(in crate::mesh) fn shells(
    vertices: &[Corner],
    triangles: &[[u32; 3]],
    adjacency: &Adjacency,
) -> Shells {
    let mut links = links(adjacency);
    if links.sets() == 1 {
        let volume = determinants(vertices, triangles);
        let shell = Shell { first: 0, is_closed: adjacency.unpaired == 0, volume };
        return Shells { of: vec![0; triangles.len()], each: vec![shell] };
    }
    let mut shells = Shells { of: Vec::with_capacity(triangles.len()), each: Vec::new() };
    for (t, sides) in (0_u32..).zip(&adjacency.neighbour) {
        let root = links.root(t);
        // The root is the least triangle of a set, so that its shell is known.
        let k = if root == t { shells.each.len() as u32 } else { shells.of[root as usize] };
        if root == t {
            shells.each.push(Shell { first: t, is_closed: true, volume: 0 });
        }
        shells.of.push(k);
        let shell = &mut shells.each[k as usize];
        shell.volume += determinant(corners_of(vertices, triangles[t as usize]));
        shell.is_closed &= !sides.contains(&NONE);
    }
    shells
}

impl Shells {
    /// The probes of `some` of the shells, which show what each lies in.
    pub(in crate::mesh) fn probes(
        &self,
        some: &[usize],
        vertices: &[Corner],
        triangles: &[[u32; 3]],
    ) -> Vec<(usize, Probes)> {
        let mut probes: Vec<Option<Probes>> = vec![None; self.each.len()];
        some.iter().for_each(|&k| probes[k] = Some(Probes::default()));
        for (&shell, &triangle) in self.of.iter().zip(triangles) {
            if let Some(probes) = &mut probes[shell as usize] {
                probes.add(corners_of(vertices, triangle));
            }
        }
        let known = probes.into_iter().enumerate();
        known.filter_map(|(k, probes)| probes.map(|probes| (k, probes))).collect()
    }
}

/// Which closed shells enclose nothing; next to nothing, if the mesh was mended. The tiny bodies of
/// a sound scan stay.
fn flat(work: &Work, shells: &Shells, is_mended: bool) -> Vec<bool> {
    let mut triangles = vec![Vec::new(); shells.each.len()];
    // A single shell is never dropped.
    if shells.each.len() > 1 {
        for (t, &shell) in shells.of.iter().enumerate() {
            let of = &shells.each[shell as usize];
            if of.is_closed && (is_mended || of.volume == 0) {
                triangles[shell as usize].push(work.triangles[t]);
            }
        }
    }
    triangles.iter().map(|own| !own.is_empty() && work.is_flat(own.iter().copied())).collect()
}

/// Which shells are to be turned.
fn inverted(work: &Work, shells: &Shells, flat: &[bool]) -> Vec<bool> {
    let is_inward = |k: usize| {
        let shell = &shells.each[k];
        shell.is_closed && shell.volume < 0 && !flat[k]
    };
    let mut is_inverted = vec![false; shells.each.len()];
    if !(0..shells.each.len()).any(is_inward) {
        return is_inverted;
    }
    if let [_] = &shells.each[..] {
        return vec![true];
    }
    let all = 0..shells.each.len();
    for (k, outer) in surroundings(work, shells, flat, all.clone().filter(|&k| is_inward(k))) {
        is_inverted[k] = outer.is_empty();
    }
    if !is_inverted.contains(&true) {
        return is_inverted;
    }
    let roots = is_inverted.clone();
    let others = all.filter(|&k| !roots[k] && !flat[k]);
    for (k, outer) in surroundings(work, shells, flat, others) {
        is_inverted[k] = outer.iter().any(|&outer| roots[outer as usize]);
    }
    is_inverted
}

/// The shells that each of some lies in.
fn surroundings(
    work: &Work,
    shells: &Shells,
    flat: &[bool],
    some: impl Iterator<Item = usize>,
) -> Vec<(usize, Vec<u32>)> {
    let some: Vec<usize> = some.collect();
    let probes = shells.probes(&some, work.vertices, &work.triangles);
    let places: Vec<Corner> = probes.iter().flat_map(|(_, probes)| probes.places()).collect();
    // Building a tree over all triangles would take longer than all queries.
    let columns = Columns::of(&places);
    let bounds = |t: &[u32; 3]| Bounds::of(corners_of(work.vertices, *t));
    let all = work.triangles.par_iter().zip(&shells.of).map(|(t, shell)| (*t, *shell));
    let near = all.filter(|(t, _)| columns.meet(bounds(t)));
    let (triangles, of): (Vec<[u32; 3]>, Vec<u32>) = near.unzip();
    let tree = Tree::new(work.vertices, &triangles);
    let around = |(k, probes): &(usize, Probes)| (*k, around(&tree, &of, flat, (*k, probes)));
    probes.par_iter().map(around).collect()
}

/// The shells that shell `k` lies in, by its `probes`; flat ones do not count. `of` has the shell of
/// each triangle of the tree.
pub(in crate::mesh) fn around(
    tree: &Tree,
    of: &[u32],
    flat: &[bool],
    (k, probes): (usize, &Probes),
) -> Vec<u32> {
    // The shells that wind around a place, once for each place.
    let mut outer: Vec<u32> = Vec::new();
    for place in probes.places() {
        let mut crossed: Vec<(u32, i32)> = Vec::new();
        tree.above(place, |t, sign| {
            let shell = of[t as usize];
            if shell as usize != k && !flat[shell as usize] {
                crossed.push((shell, sign));
            }
        });
        // A place may lie in very many shells: none is looked for among the others.
        crossed.sort_unstable_by_key(|(shell, _)| *shell);
        let own = crossed.chunk_by(|a, b| a.0 == b.0);
        let around = own.filter(|own| own.iter().map(|(_, sign)| sign).sum::<i32>() != 0);
        outer.extend(around.map(|own| own[0].0));
    }
    outer.sort_unstable();
    let most = outer.chunk_by(|a, b| a == b).filter(|same| same.len() >= MOST_INSIDE);
    most.map(|same| same[0]).collect()
}
