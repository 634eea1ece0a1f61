//! Mesh -> mm³: measures the volume of the solid from the areas of layers through it.

use super::{Heights, Slicer};
use crate::mesh::Mesh;
use crate::mesh::edges::Adjacency;

/// The volume that a mesh encloses, mm³. Where shells overlap they count once, unlike in a sum over
/// triangles. The error is that of a few hundred layers.
#[must_use]
pub fn solid_mm3(mesh: &Mesh, adjacency: &Adjacency) -> f64 {
    /// A trade-off: more layers take longer, fewer make the volume of slopes less exact.
    const LAYERS: i32 = 400;
    let top = mesh.top();
    let height = (top / LAYERS).max(1);
    let slicer = Slicer::new(mesh, adjacency, Heights::even(height, height, top), 1);
    let blocks = (0..slicer.blocks()).flat_map(|block| slicer.block(block));
    let volume: f64 = blocks.map(|layer| layer.volume_mm3()).sum();
    // The layers may end a little below or above the top: scale to the exact height.
    volume * f64::from(top) / f64::from(height) / slicer.heights().count().max(1) as f64
}
