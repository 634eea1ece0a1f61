//! A line -> whether it is of the part, and of its layer.

use crate::reader::Role;
use crate::reader::print::{Layer, Step};

/// Width of a line where no wall gives one, mm.
pub(super) const SOME_WIDTH: f64 = 0.4;

/// Heights that differ by less are the same, mm.
pub(super) const SAME_HEIGHT: f64 = 1e-3;

/// Whether a line is of the part itself: no support, skirt or start line.
pub(super) fn is_of_part(step: &Step, has_roles: bool) -> bool {
    let roles = [Role::OuterWall, Role::InnerWall, Role::Skin, Role::NonPlanar, Role::Infill];
    step.is_line() && (!has_roles || roles.contains(&step.role))
}

/// Whether a line lies so far from its layer's height that it is judged with another layer.
pub(super) fn is_stray(step: &Step, layer: &Layer) -> bool {
    let [low, high] = step.heights();
    (0.5 * (low + high) - layer.z).abs() > layer.height + SAME_HEIGHT
}
