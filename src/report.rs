//! Report: what a run found and made, as versioned JSON (`--report`) and as a three-line summary.

use crate::error::{Error, Result};
use crate::gcode::usage::{Material, Usage, Used, filament_area};
use crate::job::{self, Job};
use crate::mesh::MeshReport;
use crate::mesh::transform::Placed;
use crate::plan::Role;
use crate::profile::{DualMode, Settings};
use crate::region::Region;
use crate::region::dual::PairStats;
use crate::slice::Heights;
use crate::units::{Coord, sum_mm, to_mm};
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
    /// `outer wall`, `inner wall`, `skin`, `infill` or `support`; `thick ` before it where
    /// it is printed for several layers at once.
    pub role: String,
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

/// Thin places of a layer below this are rounding and tips of corners, not shape, mm².
const LEAST_THIN_MM2: f64 = 1.0;

/// What the layers of a print add up to, beside what is extruded.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tally {
    open_layers: usize,
    longest_gap: Coord,
    thin_layers: usize,
    thin_mm2: f64,
}

impl Tally {
    /// Counts one layer in.
    pub fn layer(&mut self, region: &Region) {
        if region.layer.closed_gap > 0 {
            self.open_layers += 1;
            self.longest_gap = self.longest_gap.max(region.layer.closed_gap);
        }
        if region.thin_mm2 > LEAST_THIN_MM2 {
            self.thin_layers += 1;
            self.thin_mm2 += region.thin_mm2;
        }
    }

    fn warnings(self) -> impl Iterator<Item = Warning> {
        let open = (self.open_layers > 0).then(|| Warning::OpenContours {
            layers: self.open_layers,
            longest_gap_mm: to_mm(self.longest_gap),
        });
        let thin = (self.thin_layers > 0)
            .then_some(Warning::ThinPlaces { layers: self.thin_layers, area_mm2: self.thin_mm2 });
        open.into_iter().chain(thin)
    }
}

/// The report of a run.
///
/// # Errors
/// [`Error::Unprintable`] if nothing is extruded at all.
pub fn report(
    job: &Job,
    placed: &Placed,
    heights: Heights,
    usage: &Usage,
    pairs: PairStats,
    tally: &Tally,
) -> Result<Report> {
    let settings = &job.settings;
    let filament_mm = usage.filament();
    if filament_mm <= 0.0 {
        return Err(Error::Unprintable(format!(
            "nothing to print: everything is thinner than a line of {} mm; use a smaller \
             --line-width, a larger --scale or another --unit",
            settings.line_width
        )));
    }
    let Material { mm, cm3, grams } = Material::new(filament_mm, settings);
    Ok(Report {
        schema: SCHEMA,
        slicer: job::NAME.to_owned(),
        profile: job.profile.clone(),
        models: placed.reports.clone(),
        size_mm: placed.size_mm,
        layers: LayersReport {
            count: heights.count,
            first_height_mm: to_mm(heights.first),
            height_mm: to_mm(heights.other),
            top_mm: to_mm(heights.top(heights.count - 1)),
        },
        roles: roles(usage, settings),
        travel: TravelReport {
            count: usage.travels,
            length_mm: usage.travel_length,
            retractions: usage.retractions,
        },
        filament: FilamentReport { length_mm: mm, volume_cm3: cm3, weight_g: grams },
        dual: (settings.dual.mode != DualMode::Off).then(|| dual(pairs)),
        warnings: placed.warnings.iter().cloned().chain(tally.warnings()).collect(),
    })
}

fn roles(usage: &Usage, settings: &Settings) -> Vec<RoleReport> {
    let area = filament_area(settings);
    let told = |role: String, used: Used| RoleReport {
        role,
        length_mm: used.length,
        filament_mm: used.filament,
        volume_mm3: used.filament * area,
    };
    let mut roles = Vec::new();
    for (role, [thin, thick]) in Role::ALL.iter().zip(usage.roles) {
        roles.push(told(role.name().to_owned(), thin));
        // An outer wall is never thick.
        if *role != Role::OuterWall {
            roles.push(told(format!("thick {}", role.name()), thick));
        }
    }
    roles
}

fn dual(pairs: PairStats) -> DualReport {
    DualReport {
        pairs: pairs.pairs,
        thick_pairs: pairs.thick_pairs,
        thick_length_mm: sum_mm(pairs.thick),
        thin_length_mm: sum_mm(pairs.thin),
        volume_ratio: if pairs.plain == 0 {
            1.0
        } else {
            sum_mm(2 * pairs.thick + pairs.thin) / sum_mm(pairs.plain)
        },
    }
}
