//! Job + placed models -> stages: what the flow in `lib.rs` is put together from.
//!
//! Here is all code that names several stages at once: reading and placing ([`place`]), planning
//! in batches ([`batches`]), the thumbnails ([`mod@thumbnails`]), what is refused
//! ([`refuse`]), and outputs that cannot seek ([`spool`]).

pub mod batches;
pub mod place;
pub mod refuse;
pub mod spool;
pub mod thumbnails;

use crate::mesh::Mesh;
use crate::profile::{Angle, Settings};
use crate::region::angle;

/// The settings with all that depends on the model decided.
#[must_use]
pub fn settle(settings: &Settings, mesh: &Mesh) -> Settings {
    let angle = match settings.angle {
        Angle::Auto(_) => Angle::Degrees(angle::least_turns(mesh)),
        given => given,
    };
    Settings { angle, ..settings.clone() }
}
