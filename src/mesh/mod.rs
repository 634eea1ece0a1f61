//! Bytes -> Mesh: reads models, mends them and places them on the bed.
//!
//! The way of a model, and the room of each step:
//! - [`read`]: bytes -> [`RawMesh`]. Triangles with welded vertices, in the file's own numbers.
//! - [`place::part`]: [`RawMesh`] -> [`Part`](place::part::Part). Scaled, turned, set down and rounded to the grid.
//! - [`mend`], called by it: closes the surface and turns it outward.
//! - [`place`]: parts -> [`Mesh`]. Laid out side by side on the bed.
//!
//! Beside the way: [`inspect`] looks for faults that edges do not show, [`write`](mod@write) writes binary STL,
//! [`geometry`] has exact vectors, boxes and a tree of boxes, [`edges`] pairs the half-edges,
//! [`faults`] names what is wrong with a mesh and what was done about it.
//!
//! What this stage guarantees to the next: finite coordinates on the grid within the accepted
//! size; a surface that is closed, or whose report says where it is open; normals that point out.
//! Shells may overlap and cross each other: the winding rule of slicing makes one solid of them.

pub mod edges;
pub mod error;
pub mod faults;
pub mod geometry;
pub mod inspect;
pub mod mend;
pub mod place;
pub mod read;
pub mod write;

mod notes;

use crate::units::Coord;
use faults::{Counted, Fault, Mending};
use schemars::JsonSchema;
use serde::Serialize;

pub use error::{Error, Result};
pub use place::placement::{Bed, Placement, Policy, Unit};

/// The triangles of one file as read: equal corners are one vertex, and triangles with two equal
/// corners are dropped. Every vertex is used by a triangle. Coordinates are the file's own
/// numbers, in the file's unit.
///
/// Triangles with three different corners on one line stay. They have no area, but without them
/// the mesh would be open.
#[derive(Debug, Clone, Default)]
pub struct RawMesh {
    /// Vertices, in the order of their first use.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles as indices into `vertices`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles with two equal corners that were dropped.
    pub degenerate: usize,
    /// Triangles whose stored normal is more than 90° off the normal by the order of their
    /// corners. The order counts.
    pub wrong_normals: usize,
    /// What was read.
    pub report: MeshReport,
}

/// The models as they lie on the bed, on the integer grid: x and y from the middle of the layout,
/// z from the bed upwards. The triangles of all models and copies are in one list.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Vertices in grid units.
    pub vertices: Vec<[i32; 3]>,
    /// Triangles as indices into `vertices`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Height of the highest vertex above the bed, grid units; 0 without vertices.
    #[must_use]
    pub fn top(&self) -> Coord {
        self.vertices.iter().map(|vertex| vertex[2]).max().unwrap_or(0)
    }
}

/// What a model file held and what was found in it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct MeshReport {
    /// The file as the user named it.
    pub file: String,
    /// `binary` or `ascii`.
    pub format: &'static str,
    /// Triangles, as they are sliced.
    pub triangles: usize,
    /// Distinct vertices of the file.
    pub vertices: usize,
    /// Connected surfaces: bodies and cavities.
    pub shells: usize,
    /// Bytes after the last triangle.
    pub trailing_bytes: u64,
    /// Size x, y, z as placed (scaled and turned), mm.
    pub size_mm: [f64; 3],
    /// Volume as placed, mm³: a signed sum over the triangles, so that overlaps count twice.
    pub volume_mm3: f64,
    /// Faults of the file.
    pub found: Vec<Counted<Fault>>,
    /// What was done about them, in the order of the steps.
    pub mended: Vec<Counted<Mending>>,
    /// Faults of the mesh that is sliced.
    pub left: Vec<Counted<Fault>>,
    /// Where it and its copies lie, in the machine's coordinates; absent where it was not laid on a bed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyReport>,
}

/// The box around a model or one of its copies, in the machine's coordinates.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct BodyReport {
    /// Lowest x, y and z, mm.
    pub min_mm: [f64; 3],
    /// Highest x, y and z, mm.
    pub max_mm: [f64; 3],
}

impl BodyReport {
    /// How far a place on the bed lies beside it, mm; 0 within.
    #[must_use]
    pub fn distance(&self, at_mm: [f64; 2]) -> f64 {
        let beside = |axis: usize| {
            let at: f64 = at_mm[axis];
            (self.min_mm[axis] - at).max(at - self.max_mm[axis]).max(0.0)
        };
        beside(0).hypot(beside(1))
    }
}

/// The model whose box holds a place on the bed, or comes nearest to it: boxes do not overlap.
#[must_use]
pub fn model_at(reports: &[MeshReport], at_mm: [f64; 2]) -> Option<&MeshReport> {
    let boxes = |model: &'_ MeshReport| {
        model.bodies.iter().map(|body| body.distance(at_mm)).reduce(f64::min)
    };
    let models = reports.iter().filter_map(|model| Some((boxes(model)?, model)));
    models.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, model)| model)
}
