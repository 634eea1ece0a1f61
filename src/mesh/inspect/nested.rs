//! Shells -> nested bodies: finds bodies that lie wholly within others, and vanish in them.

use crate::mesh::Mesh;
use crate::mesh::edges::Adjacency;
use crate::mesh::faults::Fault;
use crate::mesh::geometry::tree::Tree;
use crate::mesh::mend::shells::{around, shells};
use crate::mesh::notes::Notes;

/// The bodies of a mended mesh that lie within others; `tree` is the one over its triangles.
pub(super) fn nested(mesh: &Mesh, adjacency: &Adjacency, tree: &Tree) -> Notes<Fault> {
    let mut notes = Notes::default();
    let shells = shells(&mesh.vertices, &mesh.triangles, adjacency);
    // A single shell lies in no other.
    if shells.each.len() == 1 {
        return notes;
    }
    let flat = vec![false; shells.each.len()];
    let is_body = |k: &usize| shells.each[*k].is_closed && shells.each[*k].volume > 0;
    let bodies: Vec<usize> = (0..shells.each.len()).filter(is_body).collect();
    for (k, probes) in shells.probes(&bodies, &mesh.vertices, &mesh.triangles) {
        let outer = around(tree, &shells.of, &flat, (k, &probes));
        let within = outer.iter().filter(|&&o| shells.each[o as usize].volume > 0).count();
        // With as many cavities as bodies around it, it stands free in a cavity.
        if 2 * within > outer.len() {
            notes.add(Fault::NestedShell, mesh.triangles[shells.each[k].first as usize][0]);
        }
    }
    notes
}
