//! Mesh and layers -> Patches: tops of gentle slopes whose skin follows the surface.

pub mod params;
pub mod skin;
pub mod surface;
