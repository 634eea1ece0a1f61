//! STL file -> PNG: a picture of the model itself, for `slicer preview`.

use super::failure::{Input, usage};
use anyhow::{Context as _, Result};
use slicer::Model;
use slicer::mesh::{Bed, Placement, read};
use slicer::progress::Progress;
use slicer::render::{self, Faces, Ground};
use slicer::text;
use slicer::warning::Warning;
use std::ffi::OsStr;
use std::fs::File;
use std::io::Read as _;

/// Pixels of the longer side, at most: its pixels and colours take over 100 MB.
const MOST: u32 = 3000;

/// A picture of a model.
pub(super) struct Drawn {
    /// The bytes of a PNG file.
    pub(super) png: Vec<u8>,
    /// The name, triangles and size of the model.
    pub(super) title: String,
    /// What was found in the mesh.
    pub(super) warnings: Vec<Warning>,
}

/// Whether a file is a model: by the ending of its name, or else by how it begins. Standard input
/// counts as none, since it cannot be read twice.
pub(super) fn is_model(file: &OsStr) -> bool {
    if file == "-" {
        return false;
    }
    if file.to_string_lossy().to_lowercase().ends_with(".stl") {
        return true;
    }
    let Ok(source) = File::open(file) else { return false };
    // Only a regular file can be read twice.
    let length = source.metadata().ok().filter(std::fs::Metadata::is_file).map(|data| data.len());
    let mut head = Vec::new();
    length.is_some_and(|length| {
        source.take(read::HEADER as u64).read_to_end(&mut head).is_ok()
            && read::looks_like_stl(&head, length)
    })
}

/// Draws the model as it stands in the file, `size` pixels along the longer side, on white.
///
/// # Errors
/// A file that is no usable STL, or a picture that is too large.
pub(super) fn draw(file: &OsStr, size: u32, max_triangles: usize) -> Result<Drawn> {
    if size > MOST {
        let why = format!("--size {size}: a model is drawn with at most {MOST} pixels; use fewer");
        return Err(usage(why));
    }
    let placement = Placement { max_triangles, ..Placement::default() };
    let placed = slicer::place(&[Model::path(file)], &placement, &Bed::ANY, &Progress::default())?;
    let (faces, size) = (Faces::of(placed.is_sound), render::fitting(&placed.mesh, size));
    let picture = render::draw(&placed.mesh, faces, size, Ground::White);
    let png = picture.png().with_context(|| Input(text::name(file)))?;
    let [x, y, z] = placed.size_mm;
    let count = placed.mesh.triangles.len();
    let file = text::name(file);
    let title = format!("{file}: {count} triangles, {x:.1} x {y:.1} x {z:.1} mm");
    Ok(Drawn { png, title, warnings: placed.warnings })
}
