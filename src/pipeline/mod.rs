//! Job + placed models -> stages: what the flow in `lib.rs` is put together from.
//!
//! Here is all code that names several stages at once: reading and placing ([`place`]), planning
//! in batches ([`batches`]), where raster lines lie ([`phase`]), what begins in the air ([`footing`])
//! or hangs there ([`droop`]), skirt, brim and raft ([`sticking`]), what a raft lifts ([`mod@raise`]), skins that follow the surface
//! ([`curved`]), the thumbnails ([`mod@thumbnails`]), what is refused ([`refuse`], [`prime`]), and outputs
//! that cannot seek ([`spool`]).

pub mod batches;
mod carried;
pub mod curved;
pub mod droop;
pub mod footing;
pub mod footprint;
pub mod phase;
pub mod place;
pub mod prime;
pub mod raise;
pub mod refuse;
mod rise;
pub mod spool;
pub mod sticking;
pub mod thumbnails;

use crate::error::Refusal;
use crate::fill::adhesion::lift::Lift;
use crate::mesh::Mesh;
use crate::mesh::place::Placed;
use crate::profile::{Angle, Settings, TravelOrder};
use crate::region::angle;
use crate::slice::{Compensation, Heights, Slicer};
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

/// The models, to be cut into layers at these heights.
#[must_use]
pub fn slicer<'a>(settings: &Settings, placed: &'a Placed, heights: Heights) -> Slicer<'a> {
    let tolerance = to_units(settings.tolerance);
    Slicer::new(&placed.mesh, &placed.adjacency, heights, tolerance)
        .moved(compensation(settings))
        .listed(settings.travel.order == TravelOrder::File)
}

/// How far contours are moved.
fn compensation(settings: &Settings) -> Compensation {
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
    refuse::tall(settings, &heights, &Lift::new(settings))?;
    Ok(heights)
}
