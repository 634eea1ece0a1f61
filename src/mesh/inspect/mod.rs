//! Mesh -> Faults that its edges do not tell: surfaces that pass through each other, bodies within others, spikes.

pub mod spikes;

use super::edges::Adjacency;
use super::faults::{Counted, Fault};
use super::geometry::crossings::{crossings, depth};
use super::geometry::tree::Tree;
use super::mend::{self, told};
use super::notes::Notes;
use super::place::part::Part;
use super::{Mesh, RawMesh};
use crate::units::UNITS_PER_MM;
use spikes::spikes;

/// Triangles that pass through each other by less are rounding of the file's numbers, mm.
pub const LEAST_DEPTH_MM: f64 = 0.01;

/// As [`part()`](super::place::part::part) with [`Policy::Strict`](super::Policy::Strict) tells of a
/// part and the model it was made of.
#[must_use]
pub fn seen(part: &Part, model: &RawMesh) -> Vec<Counted<Fault>> {
    told(inspect(&part.mesh, &part.adjacency), &model.vertices)
}

/// What is seen in a mesh by looking at all its triangles. Linear but for a sort; bounded in
/// time and memory for soups, where not all crossings are counted.
pub(super) fn inspect(mesh: &Mesh, adjacency: &Adjacency) -> Notes<Fault> {
    let tree = Tree::new(&mesh.vertices, &mesh.triangles);
    let mut notes = mend::nested(mesh, adjacency, &tree);
    let crossings = crossings(&tree);
    for &pair in &crossings.pairs {
        let depth = depth(&tree, pair);
        if depth >= LEAST_DEPTH_MM {
            let at = mesh.triangles[pair[0] as usize][0];
            notes.sized(Fault::Crossing, at, depth * UNITS_PER_MM);
        }
    }
    for spike in spikes(&mesh.vertices, &mesh.triangles) {
        notes.sized(Fault::Spike, spike.vertex, spike.length_mm * UNITS_PER_MM);
    }
    notes
}
