//! Mesh -> Faults that its edges do not show: surfaces that pass through each other, bodies within others, spikes.

mod nested;
pub mod spikes;

use super::Mesh;
use super::edges::Adjacency;
use super::faults::{Counted, Fault};
use super::geometry::crossings::{crossings, depth};
use super::geometry::tree::Tree;
use super::notes::Notes;
use crate::units::UNITS_PER_MM;
use spikes::spikes;

/// Triangles that pass through each other by less than this are not reported, mm. Files round
/// their numbers to some micrometres, and a printer cannot show as much. A smaller value reports
/// thousands of such crossings in models that were joined from several bodies.
pub const LEAST_DEPTH_MM: f64 = 0.01;

/// The faults of a mended mesh, as [`Policy::Strict`](super::Policy::Strict) reports them;
/// `vertices` are those of the [`RawMesh`](super::RawMesh), in the file's own numbers.
#[must_use]
pub fn faults(mesh: &Mesh, adjacency: &Adjacency, vertices: &[[f32; 3]]) -> Vec<Counted<Fault>> {
    inspect(mesh, adjacency).counted(vertices)
}

/// Looks at all triangles of a mended mesh. Linear but for a sort; bounded in time and memory for
/// random triangles, where not all crossings are counted.
pub(super) fn inspect(mesh: &Mesh, adjacency: &Adjacency) -> Notes<Fault> {
    let tree = Tree::new(&mesh.vertices, &mesh.triangles);
    let mut notes = nested::nested(mesh, adjacency, &tree);
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
