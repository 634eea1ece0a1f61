//! Mesh and layers -> Patches: tops of gentle slopes whose skin follows the surface.

pub mod base;
pub mod find;
pub mod params;
pub mod skin;
pub mod surface;

mod facets;
mod index;
mod rim;
mod sheets;
