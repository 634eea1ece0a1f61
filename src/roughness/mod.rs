//! G-code + Mesh -> Roughness: how far the tops that a file prints lie off the true surface of the part.
//!
//! Words used here: a *bead* is the plastic of one line; a *sample* is the true surface over the middle of
//! a cell of the bed; its *deviation* is how much higher the plastic's top lies there, at right angles to
//! the surface; a *patch* is a piece of the surface whose facets are joined by edges of less than 30°; a
//! *profile* is the deviations along a straight way over a patch.
//!
//! 1. `surface`: facets that face up by 45° or less, in patches, become samples.
//! 2. `lie`: where on the bed the part was printed, how high a raft lifts it, and how high layers are.
//! 3. `map`: each bead is drawn on the samples. What counts is the highest plastic that is no more than
//!    [`WINDOW`] layers above the surface, so that a roof does not hide the floor below it.
//! 4. `profile` and `gauss`: means over profiles along the steepest slope and over the area, as they are
//!    and less what a Gaussian filter lets through.
//!
//! The beads are those of a model: the top is level across the full width and as high as the nozzle was,
//! straight from end to end of a line, with round ends. So a staircase of layers of height h on a slope θ
//! has Ra = h·cos θ / 4, and lines s apart across a slope have Ra = s·sin θ / 4. Real plastic rounds the
//! steps off and adds its own faults.
//!
//! It is a witness: it reads the text, and shares nothing with what slices, plans and writes.

mod bead;
mod gauss;
mod lie;
mod map;
mod means;
mod profile;
mod report;
mod sums;
mod surface;
#[cfg(test)]
mod tests;

use crate::mesh::Mesh;
use crate::mesh::edges::Adjacency;
use crate::reader::Stream;
use map::Map;
pub use means::{Means, Values};
pub use report::{OfPatch, OfSlope, Roughness, SCHEMA, schema};
use std::io;
use surface::Surface;

/// Layers above the surface up to which plastic counts, and below it down to which it is plastic of the
/// surface.
pub const WINDOW: f64 = 2.0;

/// A place is covered if the plastic's top is nearer to the surface, straight up or down, than this share
/// of a layer's height. Steps of a staircase are half a layer off, a lacking line is a whole one.
pub const COVERED: f64 = 0.8;

/// Share of the surface that must be covered; with less it is another part.
const LEAST_FIT: f64 = 1.0 / 3.0;

/// What was printed.
#[derive(Debug, Clone, Copy)]
pub struct Model<'a> {
    /// As it lies on the bed, but for `offset`.
    pub mesh: &'a Mesh,
    /// Its edges.
    pub adjacency: &'a Adjacency,
    /// Where its middle is expected, in the machine's coordinates, mm. A file may have it elsewhere.
    pub offset: [f64; 2],
    /// How far a raft lifts it, mm; `None` if only the file can tell.
    pub lift: Option<f64>,
}

/// How roughness is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Cut-off of the Gaussian filters, mm.
    pub cutoff: f64,
}

/// Why no roughness can be told.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file cannot be read.
    #[error("cannot read: {0}; check the path")]
    Unreadable(#[from] io::Error),
    /// Nothing of the model faces up.
    #[error(
        "no face of the model slopes by 45° or less and faces up; turn it as it was printed, with --rotate"
    )]
    NoSurface,
    /// No plastic lies near the model's surface.
    #[error(
        "no plastic lies near the model's tops; give the model, --scale and --rotate of this print"
    )]
    NoPlastic,
    /// Plastic lies along some of it alone.
    #[error(
        "the model does not fit the file: plastic lies along only {percent:.0} % of its tops; give the \
         model, --scale and --rotate of this print"
    )]
    OtherPart {
        /// Share of the surface that is covered, %.
        percent: f64,
    },
}

/// Measures the tops that a file prints against those of the model.
///
/// # Errors
/// See [`Error`].
pub fn roughness(stream: &Stream, model: Model<'_>, options: &Options) -> Result<Roughness, Error> {
    let surface = Surface::new(model.mesh, model.adjacency).ok_or(Error::NoSurface)?;
    let lie = lie::find(stream, &model, &surface)?;
    let mut map = Map::new(&surface, surface.cell(), lie.layer);
    map.draw(stream, lie.origin, lie.lift)?;
    let [near, fit] = map.fit();
    if near <= 0.0 {
        return Err(Error::NoPlastic);
    }
    if fit < LEAST_FIT {
        return Err(Error::OtherPart { percent: 100.0 * fit });
    }
    Ok(report::make(&surface, &map, &lie, options))
}
