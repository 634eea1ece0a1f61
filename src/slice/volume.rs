//! Mesh -> mm³: the volume of the solid, measured by the areas of layers through it.

use super::{Heights, Slicer};
use crate::mesh::Mesh;
use crate::mesh::edges::Adjacency;

/// The volume that a mesh encloses, mm³; where parts of it overlap, they count once. As exact as
/// a few hundred layers are.
#[must_use]
pub fn solid_mm3(mesh: &Mesh, adjacency: &Adjacency) -> f64 {
    /// More layers take longer and hardly change the result.
    const LAYERS: i32 = 400;
    let top = mesh.top();
    let height = (top / LAYERS).max(1);
    let slicer = Slicer::new(mesh, adjacency, Heights::even(height, height, top), 1);
    let blocks = (0..slicer.blocks()).flat_map(|block| slicer.block(block));
    let volume: f64 = blocks.map(|layer| layer.volume_mm3()).sum();
    // The top cuts off the last layer, or the last layer does not reach it.
    volume * f64::from(top) / f64::from(height) / slicer.heights().count().max(1) as f64
}
