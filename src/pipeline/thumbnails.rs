//! Placed models -> thumbnails: the pictures in the head of the G-code.

use crate::gcode::hosts::Thumbnail;
use crate::mesh::place::Placed;
use crate::profile::{PictureSize, Settings};
use crate::render;
use rayon::prelude::*;

/// Draws the models in each size that the host asks for.
///
/// # Errors
/// A picture that cannot be packed as PNG.
pub fn thumbnails(settings: &Settings, placed: &Placed) -> std::io::Result<Vec<Thumbnail>> {
    let draw = |&PictureSize { width, height }| {
        let size = [width, height];
        let (faces, ground) = (render::Faces::of(placed.is_sound), render::Ground::Transparent);
        let png = render::draw(&placed.mesh, faces, size, ground).png()?;
        Ok(Thumbnail { width, height, png })
    };
    settings.machine.thumbnails.par_iter().map(draw).collect()
}
