//! What a user asks for -> Placement: unit, scale, turn, place, copies, and the bed that all must fit.

use super::shelves::GAP_MM;
use crate::mesh::read::DEFAULT_MAX_TRIANGLES;
use crate::units::MAX_COORDINATE_MM;

/// How models are placed on the bed.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// The unit of the files' numbers.
    pub unit: Unit,
    /// Factor on every length.
    pub scale: f64,
    /// Factors on x, y and z once it is turned, by which it is printed larger since it shrinks.
    pub stretch: [f64; 3],
    /// Turns about x, then y, then z, degrees, counter-clockwise seen against the axis.
    pub rotate: [f64; 3],
    /// How much is cut off the bottom of each model, mm.
    pub sink: f64,
    /// Where the middle of the layout goes, in the machine's coordinates, mm; the bed's middle if `None`.
    pub at: Option<[f64; 2]>,
    /// Distance between the bounding boxes of neighbouring models, mm.
    pub gap: f64,
    /// Where several models must not lie, as far as there is room elsewhere: boxes, lowest and highest corner, in
    /// the machine's coordinates, mm.
    pub taken: Vec<[[f64; 2]; 2]>,
    /// How many times each model is printed.
    pub copies: u32,
    /// Most triangles of a file, and of all models and copies together.
    pub max_triangles: usize,
    /// What to do about a mesh with faults.
    pub policy: Policy,
}

impl Default for Placement {
    /// Each model once, as it is, in the middle of the bed.
    fn default() -> Self {
        Self {
            unit: Unit::Mm,
            scale: 1.0,
            stretch: [1.0; 3],
            rotate: [0.0; 3],
            sink: 0.0,
            at: None,
            gap: GAP_MM,
            taken: Vec::new(),
            copies: 1,
            max_triangles: DEFAULT_MAX_TRIANGLES,
            policy: Policy::Repair,
        }
    }
}

/// What to do about a mesh with faults.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Policy {
    /// Mend it. A mesh that cannot be mended is refused.
    #[default]
    Repair,
    /// Slice it as it is, by the winding rule; close gaps in contours by straight lines.
    Warn,
    /// Refuse it.
    Strict,
}

/// The unit of a file's numbers; STL has none of its own.
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

impl Unit {
    /// Its length, mm.
    #[must_use]
    pub fn mm(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Cm => 10.0,
            Self::M => 1000.0,
            Self::Inch => 25.4,
        }
    }
}

/// The space that a printer has, mm.
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
    /// A bed that every model fits, for when the machine is not known.
    pub const ANY: Self = Self {
        min: [-MAX_COORDINATE_MM / 2.0; 2],
        max: [MAX_COORDINATE_MM / 2.0; 2],
        height: MAX_COORDINATE_MM,
    };

    /// Width and depth.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }
}
