//! Bytes -> Mesh: what a model is once it is read and placed.

pub mod edges;
pub mod faults;
pub mod geometry;
pub mod inspect;
pub mod mend;
pub mod place;
pub mod read;
pub mod write;

mod notes;

use crate::units::{Coord, MAX_COORDINATE_MM};
use faults::{Counted, Fault, Mending};
use serde::Serialize;

/// The triangles of one file as read: vertices welded where they are bit-equal,
/// triangles with two equal corners dropped. Every vertex is used by a triangle.
/// Coordinates are the file's own numbers, in the file's unit.
///
/// Triangles with three different corners on one line stay: they have no area,
/// but taking them out would open the mesh.
#[derive(Debug, Clone, Default)]
pub struct RawMesh {
    /// Vertices, in the order of their first use.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles as indices into `vertices`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles with two equal corners that were dropped.
    pub degenerate: usize,
    /// Triangles whose stored normal is more than 90° off the one that their winding gives. The
    /// winding counts.
    pub wrong_normals: usize,
    /// What reading met.
    pub report: MeshReport,
}

/// The models as they lie on the bed, on the integer grid: x and y relative to
/// the middle of the layout, z from the bed upwards. Triangles of all models
/// and copies in one list.
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
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct MeshReport {
    /// The file as the user named it.
    pub file: String,
    /// `binary` or `ascii`.
    pub format: &'static str,
    /// Triangles, as they are sliced.
    pub triangles: usize,
    /// Distinct vertices of the file.
    pub vertices: usize,
    /// Surfaces that hang together: bodies and cavities.
    pub shells: usize,
    /// Bytes after the last triangle.
    pub trailing_bytes: u64,
    /// Size x, y, z as placed (scaled and turned), mm.
    pub size_mm: [f64; 3],
    /// Volume as placed, mm³ (signed sum over the triangles; what overlaps counts twice).
    pub volume_mm3: f64,
    /// Faults of the file.
    pub found: Vec<Counted<Fault>>,
    /// What was done about them, in this order.
    pub mended: Vec<Counted<Mending>>,
    /// Faults of the mesh that is sliced.
    pub left: Vec<Counted<Fault>>,
}

/// What becomes of a mesh with faults.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Policy {
    /// It is mended; what cannot be mended is refused when it is sliced.
    #[default]
    Repair,
    /// It is sliced as it is, by the winding rule; gaps are closed by straight lines.
    Warn,
    /// It is refused.
    Strict,
}

/// How models are laid on the bed.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// The unit of the files' numbers.
    pub unit: Unit,
    /// Factor on every length.
    pub scale: f64,
    /// Turns about x, then y, then z, degrees, counter-clockwise seen against the axis.
    pub rotate: [f64; 3],
    /// Where the middle of the layout goes, in the machine's coordinates, mm; the bed's middle if `None`.
    pub at: Option<[f64; 2]>,
    /// How many times each model is printed.
    pub copies: u32,
    /// Most triangles of a file, and of all models and copies together.
    pub max_triangles: usize,
    /// What becomes of faults.
    pub policy: Policy,
}

impl Default for Placement {
    /// Each model once, as it is, in the middle of the bed.
    fn default() -> Self {
        Self {
            unit: Unit::Mm,
            scale: 1.0,
            rotate: [0.0; 3],
            at: None,
            copies: 1,
            max_triangles: read::DEFAULT_MAX_TRIANGLES,
            policy: Policy::Repair,
        }
    }
}

/// The unit of an STL file's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
    /// Inches of 25.4 mm.
    Inch,
}

/// The space a printer has, as placement needs it, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bed {
    /// Lowest x and y, in the machine's coordinates.
    pub min: [f64; 2],
    /// Highest x and y.
    pub max: [f64; 2],
    /// Highest z.
    pub height: f64,
}

impl Bed {
    /// One that every model fits, where the machine is not known.
    pub const ANY: Self = Self {
        min: [-MAX_COORDINATE_MM / 2.0; 2],
        max: [MAX_COORDINATE_MM / 2.0; 2],
        height: MAX_COORDINATE_MM,
    };
}
