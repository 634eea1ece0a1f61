//! Surfaces that hang together -> shells wound outward: drops those that enclose nothing, turns those that are inside out.

use super::Work;
use super::columns::Columns;
use super::links::Links;
use super::probes::{MOST_INSIDE, Probes};
use crate::mesh::Mesh;
use crate::mesh::edges::{Adjacency, NONE, parts};
use crate::mesh::faults::{Fault, Mending};
use crate::mesh::geometry::bounds::Bounds;
use crate::mesh::geometry::measure::{corners_of, determinant, determinants};
use crate::mesh::geometry::tree::Tree;
use crate::mesh::geometry::vector::Corner;
use crate::mesh::notes::Notes;
use rayon::prelude::*;

/// The shells of a mesh.
struct Shells {
    /// The shell of each triangle.
    of: Vec<u32>,
    each: Vec<Shell>,
}

/// A surface that hangs together.
struct Shell {
    first: u32,
    is_closed: bool,
    /// Six times its volume, negative if it is wound inward.
    volume: i128,
}

/// Drops closed shells without volume (of a mesh that was mended: with next to none) and turns
/// inverted ones. Returns the number of shells, and whether anything was changed.
///
/// A shell that is wound inward and lies in no other is inverted, and with it all that lies
/// within it: such files come from mirroring. A shell wound inward within another is a cavity.
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

/// The bodies of a mended mesh that lie within others; `tree` is that over its triangles.
pub(in crate::mesh) fn nested(mesh: &Mesh, adjacency: &Adjacency, tree: &Tree) -> Notes<Fault> {
    let mut notes = Notes::default();
    let shells = shells(&mesh.vertices, &mesh.triangles, adjacency);
    // Of a single shell there is nothing to find.
    if shells.each.len() == 1 {
        return notes;
    }
    let flat = vec![false; shells.each.len()];
    let is_body = |k: &usize| shells.each[*k].is_closed && shells.each[*k].volume > 0;
    let bodies: Vec<usize> = (0..shells.each.len()).filter(is_body).collect();
    for (k, probes) in shells.probes(&bodies, &mesh.vertices, &mesh.triangles) {
        let outer = around(tree, &shells.of, &flat, (k, &probes));
        let within = outer.iter().filter(|&&o| shells.each[o as usize].volume > 0).count();
        // As many cavities as bodies around it: it stands free in a cavity.
        if 2 * within > outer.len() {
            notes.add(Fault::NestedShell, mesh.triangles[shells.each[k].first as usize][0]);
        }
    }
    notes
}

/// The number of surfaces that hang together.
pub(super) fn count(adjacency: &Adjacency) -> usize {
    links(adjacency).sets()
}

/// The triangles, joined across their sides.
pub(super) fn links(adjacency: &Adjacency) -> Links {
    // From one of the two is enough.
    Links::of(adjacency.neighbour.len(), |t| {
        let sides = adjacency.neighbour[t as usize].into_iter().filter(|side| *side != NONE);
        sides.map(|side| parts(side).0 as u32).filter(move |other| *other < t)
    })
}

fn shells(vertices: &[Corner], triangles: &[[u32; 3]], adjacency: &Adjacency) -> Shells {
    let mut links = links(adjacency);
    if links.sets() == 1 {
        let volume = determinants(vertices, triangles);
        let shell = Shell { first: 0, is_closed: adjacency.unpaired == 0, volume };
        return Shells { of: vec![0; triangles.len()], each: vec![shell] };
    }
    let mut shells = Shells { of: Vec::with_capacity(triangles.len()), each: Vec::new() };
    for (t, sides) in (0_u32..).zip(&adjacency.neighbour) {
        let root = links.root(t);
        // A set's root is its least number, so that it was met before.
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
    /// The places by which is told what each of `some` shells lies in.
    fn probes(
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

/// Which closed shells enclose nothing, or next to nothing if they were `mended`: the tiny
/// bodies of a sound scan stay.
fn flat(work: &Work, shells: &Shells, is_mended: bool) -> Vec<bool> {
    let mut triangles = vec![Vec::new(); shells.each.len()];
    // Of a single shell there is nothing to drop.
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
    // A tree over all triangles would take longer to grow than to be asked.
    let columns = Columns::of(&places);
    let bounds = |t: &[u32; 3]| Bounds::of(corners_of(work.vertices, *t));
    let all = work.triangles.par_iter().zip(&shells.of).map(|(t, shell)| (*t, *shell));
    let near = all.filter(|(t, _)| columns.meet(bounds(t)));
    let (triangles, of): (Vec<[u32; 3]>, Vec<u32>) = near.unzip();
    let tree = Tree::new(work.vertices, &triangles);
    let around = |(k, probes): &(usize, Probes)| (*k, around(&tree, &of, flat, (*k, probes)));
    probes.par_iter().map(around).collect()
}

/// The shells that shell `k` lies in, going by its `probes`; flat ones are none. `of` says which
/// shell each triangle of the tree belongs to.
fn around(tree: &Tree, of: &[u32], flat: &[bool], (k, probes): (usize, &Probes)) -> Vec<u32> {
    // Each shell that winds around one of the places, once for each.
    let mut outer: Vec<u32> = Vec::new();
    for place in probes.places() {
        let mut windings: Vec<(u32, i32)> = Vec::new();
        tree.above(place, |t, sign| {
            let shell = of[t as usize];
            if shell as usize == k || flat[shell as usize] {
                return;
            }
            match windings.iter_mut().find(|(known, _)| *known == shell) {
                Some((_, winding)) => *winding += sign,
                None => windings.push((shell, sign)),
            }
        });
        outer.extend(windings.iter().filter(|(_, winding)| *winding != 0).map(|(shell, _)| shell));
    }
    outer.sort_unstable();
    let most = outer.chunk_by(|a, b| a == b).filter(|same| same.len() >= MOST_INSIDE);
    most.map(|same| same[0]).collect()
}
