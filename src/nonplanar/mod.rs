//! Mesh and layers -> Patches: tops of gentle slopes whose skin follows the surface.
//!
//! [`surface`] makes surfaces of the mesh; [`pass`] decides which places of them become skin, and has the
//! [`skin`]s laid; [`base`] takes their room from the layers. Where none can go, [`contour`] bends the lines
//! of the layers.

pub mod base;
pub mod contour;
pub mod params;
pub mod pass;
pub mod patch;
pub mod scene;
pub mod skin;
pub mod surface;
pub mod tally;

mod field;
mod grid;

#[cfg(test)]
mod laws;
#[cfg(test)]
mod tests;

pub use field::Fields;
pub use pass::patches_and_fields;
pub use patch::{Patch, Patches, Stroke};
pub use scene::{Props, Scene, Skirt, support_lines};
pub use tally::{Areas, Reason};
