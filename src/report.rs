//! Report: what a run found and made, as versioned JSON (`--report`) and as a three-line summary.

use crate::mesh::MeshReport;
use crate::warning::Warning;
use serde::Serialize;

/// Version of the JSON schema; raised when a field changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// What one run found and made.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Name and version of this program.
    pub slicer: String,
    /// Profile asked for, by name or file.
    pub profile: String,
    /// Each model read, in the order given.
    pub models: Vec<MeshReport>,
    /// Size of the whole layout x, y, z, mm.
    pub size_mm: [f64; 3],
    /// The layers.
    pub layers: LayersReport,
    /// Length and material by role, in the order of printing.
    pub roles: Vec<RoleReport>,
    /// Moves without extrusion.
    pub travel: TravelReport,
    /// Material in all, without the start block's purge.
    pub filament: FilamentReport,
    /// Dual injection; absent where it is off.
    pub dual: Option<DualReport>,
    /// Findings.
    pub warnings: Vec<Warning>,
}

/// The layers of a print.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct LayersReport {
    /// How many.
    pub count: usize,
    /// Height of the first, mm.
    pub first_height_mm: f64,
    /// Height of the others, mm.
    pub height_mm: f64,
    /// Top of the last, mm.
    pub top_mm: f64,
}

/// What was extruded in one role.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct RoleReport {
    /// `outer wall`, `inner wall`, `skin`, `infill`, `thick infill` or `support`.
    pub role: &'static str,
    /// Length of path, mm.
    pub length_mm: f64,
    /// Filament, mm.
    pub filament_mm: f64,
    /// Volume, mm³.
    pub volume_mm3: f64,
}

/// Moves without extrusion.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TravelReport {
    /// How many.
    pub count: usize,
    /// Length in all, mm.
    pub length_mm: f64,
    /// How many of them retract.
    pub retractions: usize,
}

/// Material in all.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FilamentReport {
    /// Length, mm.
    pub length_mm: f64,
    /// Volume, cm³.
    pub volume_cm3: f64,
    /// Weight, g.
    pub weight_g: f64,
}

/// What dual injection did.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct DualReport {
    /// Pairs of layers that have infill.
    pub pairs: usize,
    /// Of these, pairs with thick lines.
    pub thick_pairs: usize,
    /// Length of thick lines, mm (turns of the zig-zag not counted).
    pub thick_length_mm: f64,
    /// Length of thin lines left beside them, mm (likewise).
    pub thin_length_mm: f64,
    /// Volume of the pairs' lines over that of the same lines printed thin on both layers.
    pub volume_ratio: f64,
}
