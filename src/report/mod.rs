//! Report: what a run found and made, as versioned JSON (`--report`) and as a three-line summary.

use crate::check::Verdict;
use crate::error::{Error, Result};
use crate::fill::Role;
use crate::gcode::Sums;
use crate::gcode::flow::Flows;
use crate::gcode::times::{LayerTime, Times};
use crate::gcode::usage::Material;
use crate::job::{self, Job};
use crate::mesh::place::Placed;
use crate::mesh::{MeshReport, Policy};
use crate::profile::{DualMode, DualPart, Settings};
use crate::region::Region;
use crate::region::dual::audit::{Apart, Audit};
use crate::slice::Heights;
use crate::units::{Coord, sum_mm, to_mm, to_units};
use crate::warning::{Warning, plural};
use serde::Serialize;

/// Version of the JSON schema; raised when a field changes its meaning or goes away.
pub const SCHEMA: u32 = 3;

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
    /// What the layers enclose, mm³: the volume of the solid that is printed, where what
    /// overlaps in the models counts once.
    pub solid_mm3: f64,
    /// The layers.
    pub layers: LayersReport,
    /// Length and material by role, in the order of printing.
    pub roles: Vec<RoleReport>,
    /// Moves without extrusion.
    pub travel: TravelReport,
    /// Material in all, without the start block's purge.
    pub filament: FilamentReport,
    /// How long the print takes, by `limits` of the profile.
    pub time: TimeReport,
    /// How fast filament is molten.
    pub flow: FlowReport,
    /// Dual injection; absent where it is off.
    pub dual: Option<DualReport>,
    /// Findings.
    pub warnings: Vec<Warning>,
    /// What `--check` says of the G-code; absent without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub check: Option<Verdict>,
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
    /// Time, s.
    pub time_s: f64,
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
    /// Time of the moves, in z too, s.
    pub time_s: f64,
    /// Time of pulling filament back and pushing it forward, s.
    pub retraction_time_s: f64,
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
    /// Price, in the money of `filament.cost`; absent where that is 0.
    pub cost: Option<f64>,
}

/// How long the print takes, without homing, heating and the rest of the start and end blocks.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TimeReport {
    /// In all, s.
    pub total_s: f64,
    /// The layer that takes longest, s.
    pub longest_layer_s: f64,
    /// The layer that takes shortest, s.
    pub shortest_layer_s: f64,
    /// How much the layers' times differ: standard deviation over mean.
    pub layer_spread: f64,
    /// Each layer, in order.
    pub layers: Vec<LayerTimeReport>,
}

/// How long a layer takes.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct LayerTimeReport {
    /// Its top above the bed, mm.
    pub z_mm: f64,
    /// Time, s.
    pub time_s: f64,
}

/// How fast filament is molten.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FlowReport {
    /// The largest flow of the print, mm³/s.
    pub largest_mm3_s: f64,
    /// The most that the hot end melts, mm³/s.
    pub limit_mm3_s: f64,
}

/// What dual injection did. Lengths are those of lines, without the turns between them;
/// lines shorter than they are wide are not printed and not counted.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct DualReport {
    /// Layers of a group.
    pub ratio: u32,
    /// Blocks of layers with sparse infill.
    pub blocks: usize,
    /// Of these, blocks with thick lines.
    pub thick_blocks: usize,
    /// Length of thick lines, mm.
    pub thick_length_mm: f64,
    /// Length of thin lines left beside them, mm.
    pub thin_length_mm: f64,
    /// Material of these lines over that of the same lines printed thin on every layer.
    pub volume_ratio: f64,
    /// Each block of layers, infill and support apart.
    pub audit: Vec<BlockReport>,
}

/// What became of the infill or the support of one block of layers: those that are filled
/// in one direction, which is one group, or several where lines are interlaced.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BlockReport {
    /// `infill` or `support`.
    pub part: DualPart,
    /// First layer of the block, counted from 1.
    pub first_layer: usize,
    /// Number of its layers.
    pub layers: usize,
    /// Length of thick lines, mm.
    pub thick_length_mm: f64,
    /// Length of thin lines, mm.
    pub thin_length_mm: f64,
    /// As in [`DualReport::volume_ratio`].
    pub volume_ratio: f64,
    /// What is not printed for a whole group, and why.
    pub kept_apart: ApartReport,
}

/// Length of the layers' lines that are not printed for a whole group, mm, by cause.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ApartReport {
    /// Another layer of the group has none there: it is at or beyond its walls.
    pub bounds_mm: f64,
    /// Another layer of the group has skin there.
    pub skin_mm: f64,
    /// What the layers share is shorter than a line is wide.
    pub short_mm: f64,
    /// The group has fewer layers than the ratio: at the bed, at the top, or where the direction turns.
    pub ends_mm: f64,
}

/// Thin places of a layer below this are rounding and tips of corners, not shape, mm².
const LEAST_THIN_MM2: f64 = 1.0;

/// A contour that is open by more than this, mm, is refused unless the mesh is to be sliced as
/// it is: a straight line across would be a guess that can be seen.
pub const MOST_GAP_MM: f64 = 2.0;

/// What the layers of a print add up to, beside what is extruded.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tally {
    open_layers: usize,
    longest_gap: Coord,
    thin_layers: usize,
    thin_mm2: f64,
    /// The first layer with the longest gap, counted from 1.
    gap_layer: usize,
    solid_mm3: f64,
}

impl Tally {
    /// Counts one layer in.
    pub fn layer(&mut self, region: &Region) {
        if region.layer.closed_gap > 0 {
            self.open_layers += 1;
            if region.layer.closed_gap > self.longest_gap {
                self.longest_gap = region.layer.closed_gap;
                self.gap_layer = region.layer.index + 1;
            }
        }
        self.solid_mm3 += region.layer.volume_mm3();
        if region.thin_mm2 > LEAST_THIN_MM2 {
            self.thin_layers += 1;
            self.thin_mm2 += region.thin_mm2;
        }
    }

    /// Refuses layers that are open too far.
    fn refuse_gaps(&self, job: &Job) -> Result<()> {
        let gap_mm = to_mm(self.longest_gap);
        if job.placement.policy == Policy::Warn || gap_mm <= MOST_GAP_MM {
            return Ok(());
        }
        Err(Error::input(
            &job.models.join(", "),
            format!(
                "the mesh cannot be mended: contours are open on {}, most on layer {} by {gap_mm:.1} mm; \
                 mend the model, or slice it as it is with --mesh warn",
                plural(self.open_layers as u64, "layer"),
                self.gap_layer,
            ),
        ))
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
    heights: &Heights,
    sums: &Sums,
    audits: &[Audit],
    tally: &Tally,
) -> Result<Report> {
    let settings = &job.settings;
    tally.refuse_gaps(job)?;
    let Sums { usage, times } = sums;
    let filament_mm = usage.filament();
    if filament_mm <= 0.0 {
        return Err(Error::Unprintable(format!(
            "nothing to print: everything is thinner than a line of {} mm; use a smaller \
             --line-width, a larger --scale or another --unit",
            settings.line_width
        )));
    }
    let Material { mm, cm3, grams, cost } = Material::new(filament_mm, settings);
    Ok(Report {
        schema: SCHEMA,
        slicer: job::NAME.to_owned(),
        profile: job.profile.clone(),
        models: placed.reports.clone(),
        size_mm: placed.size_mm,
        solid_mm3: tally.solid_mm3,
        layers: LayersReport {
            count: heights.count(),
            first_height_mm: to_mm(heights.height(0)),
            height_mm: to_mm(to_units(settings.layer_height)),
            top_mm: to_mm(heights.top(heights.count() - 1)),
        },
        roles: roles(sums, settings),
        travel: TravelReport {
            count: usage.travels,
            length_mm: usage.travel_length,
            retractions: usage.retractions,
            time_s: times.travel,
            retraction_time_s: times.retraction,
        },
        filament: FilamentReport { length_mm: mm, volume_cm3: cm3, weight_g: grams, cost },
        time: time(times),
        flow: FlowReport {
            largest_mm3_s: usage.flows.largest,
            limit_mm3_s: settings.machine.max_volumetric_flow,
        },
        dual: (settings.dual.mode != DualMode::Off).then(|| dual(settings, audits)),
        warnings: (placed.warnings.iter().cloned())
            .chain(tally.warnings())
            .chain(slowed_down(&usage.flows, settings))
            .collect(),
        check: None,
    })
}

fn roles(sums: &Sums, settings: &Settings) -> Vec<RoleReport> {
    let area = settings.filament_area();
    let mut roles = Vec::new();
    for (role, used) in sums.usage.roles.iter() {
        for (thick, used) in used.iter().filter(|(thick, _)| !thick || role.facts().may_be_thick) {
            roles.push(RoleReport {
                role: role_name(role, thick),
                length_mm: used.length,
                filament_mm: used.filament,
                volume_mm3: used.filament * area,
                time_s: *sums.times.roles[role].of(thick),
            });
        }
    }
    roles
}

fn role_name(role: Role, thick: bool) -> String {
    let name = role.facts().name;
    if thick { format!("thick {name}") } else { name.to_owned() }
}

fn time(times: &Times) -> TimeReport {
    let seconds = || times.layers.iter().map(|layer| layer.seconds);
    let count = times.layers.len().max(1) as f64;
    let mean = times.total() / count;
    let variance = seconds().map(|s| (s - mean) * (s - mean)).sum::<f64>() / count;
    let told = |layer: &LayerTime| LayerTimeReport { z_mm: to_mm(layer.z), time_s: layer.seconds };
    TimeReport {
        total_s: times.total(),
        longest_layer_s: seconds().fold(0.0, f64::max),
        shortest_layer_s: seconds().reduce(f64::min).unwrap_or_default(),
        layer_spread: if mean > 0.0 { variance.sqrt() / mean } else { 0.0 },
        layers: times.layers.iter().map(told).collect(),
    }
}

/// Where the hot end cannot follow.
fn slowed_down(flows: &Flows, settings: &Settings) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for (role, lowered) in flows.lowered.iter() {
        for (thick, lowered) in lowered.iter() {
            warnings.extend(lowered.map(|lowered| Warning::FlowLimited {
                role: role_name(role, thick),
                setting: (*role.facts().speed_keys.of(thick)).to_owned(),
                asked_mm_min: lowered.asked,
                lowest_mm_min: lowered.given,
                limit_mm3_s: settings.machine.max_volumetric_flow,
            }));
        }
    }
    warnings
}

fn dual(settings: &Settings, audits: &[Audit]) -> DualReport {
    let seen = || audits.iter().filter(|a| a.plain > 0);
    let infill = || seen().filter(|a| a.part == DualPart::Infill);
    let sum = |of: fn(&Audit) -> i64| seen().map(of).sum::<i64>();
    DualReport {
        ratio: settings.dual_ratio(),
        blocks: infill().count(),
        thick_blocks: infill().filter(|a| a.thick > 0).count(),
        thick_length_mm: sum_mm(sum(|a| a.thick)),
        thin_length_mm: sum_mm(sum(|a| a.thin)),
        volume_ratio: ratio(sum(|a| a.material), sum(|a| a.plain)),
        audit: seen().map(block).collect(),
    }
}

fn block(audit: &Audit) -> BlockReport {
    let Apart { bounds, skin, short, ends } = audit.kept_apart;
    BlockReport {
        part: audit.part,
        first_layer: audit.first + 1,
        layers: audit.layers,
        thick_length_mm: sum_mm(audit.thick),
        thin_length_mm: sum_mm(audit.thin),
        volume_ratio: ratio(audit.material, audit.plain),
        kept_apart: ApartReport {
            bounds_mm: sum_mm(bounds),
            skin_mm: sum_mm(skin),
            short_mm: sum_mm(short),
            ends_mm: sum_mm(ends),
        },
    }
}

/// `part` of `whole`; 1 if there is nothing.
fn ratio(part: i64, whole: i64) -> f64 {
    if whole == 0 { 1.0 } else { part as f64 / whole as f64 }
}
