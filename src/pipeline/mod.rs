//! Job + placed models -> stages: what the flow in `lib.rs` is put together from.
//!
//! Here is all code that names several stages at once: reading and placing ([`place`]), planning
//! in batches ([`batches`]), where raster lines lie ([`phase`]), what begins in
//! the air ([`footing`]), skirt, brim and raft
//! ([`sticking`]), skins that follow the surface ([`curved`]), how far a raft lifts all the rest ([`lift`]), the thumbnails ([`mod@thumbnails`]), what is refused ([`refuse`], [`prime`]), and outputs that
//! cannot seek ([`spool`]).

pub mod batches;
pub mod curved;
pub mod footing;
pub mod footprint;
pub mod lift;
pub mod phase;
pub mod place;
pub mod prime;
pub mod refuse;
mod rise;
pub mod spool;
pub mod sticking;
pub mod thumbnails;

use crate::error::Refusal;
use crate::mesh::Mesh;
use crate::mesh::place::Placed;
use crate::profile::{Angle, Settings};
use crate::region::angle;
use crate::slice::{Compensation, Heights};
use crate::units::to_units;

/// The settings with all that depends on the model decided.
#[must_use]
pub fn settle(settings: &Settings, mesh: &Mesh) -> Settings {
    let angle = match settings.angle {
        Angle::Auto(_) => Angle::Degrees(angle::least_turns(mesh)),
        given => given,
    };
    Settings { angle, ..settings.clone() }
}

/// How far contours are moved.
#[must_use]
pub fn compensation(settings: &Settings) -> Compensation {
    Compensation {
        outline: to_units(settings.xy_compensation),
        hole: to_units(settings.hole_compensation),
        foot: to_units(settings.foot_drawn_in()),
    }
}

/// The layers that the models are cut into, at least one.
///
/// # Errors
/// [`Refusal::TooSmall`], [`Refusal::TooLow`], [`Refusal::TooTall`].
pub fn heights(settings: &Settings, placed: &Placed) -> Result<Heights, Refusal> {
    refuse::small(settings, placed)?;
    let (first, other) = (to_units(settings.first_layer_height), to_units(settings.layer_height));
    let heights = Heights::even(first, other, placed.mesh.top());
    if heights.count() == 0 {
        return Err(Refusal::TooLow { height_mm: placed.size_mm[2] });
    }
    refuse::tall(settings, &heights, &lift::Lift::new(settings))?;
    Ok(heights)
}
