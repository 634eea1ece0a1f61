//! Run -> Report: what a run found and made, as versioned JSON.
//!
//! Here are the carriers, the structs of the JSON. [`make`] fills them in, [`tally`] adds up what
//! the layers hold. Whether a job is refused is decided elsewhere, before anything is written:
//! see [`pipeline::refuse`](crate::pipeline::refuse).
//!
//! Words: a *role* is what a bead is printed for, *thick* one that is printed for several layers.
//! The *audit* of dual injection follows the lines of each block of layers: how long they are,
//! thick and thin, and why some are not thick. Units stand at the end of each name; the
//! meaning of a field never changes without a new [`SCHEMA`] number.

mod cooling;
pub mod doubtful;
pub mod failure;
pub mod make;
pub mod motion;
pub mod nonplanar;
mod reshaped;
pub mod steps;
pub mod tally;
mod unused;

use crate::check::Verdict;
use crate::mesh::MeshReport;
use crate::profile::DualPart;
use crate::warning::Warning;
use failure::Failure;
use nonplanar::NonPlanarReport;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::Serialize;
use steps::StepsReport;

/// Version of the JSON schema; raised when a field changes its meaning or goes away.
pub const SCHEMA: u32 = 5;

/// What is written as a report.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[allow(dead_code, reason = "its schema is all that is asked of it")]
enum Written {
    /// The run is done.
    Done(Box<Report>),
    /// The run failed; what was made before is as it was.
    Failed(Box<Failure>),
}

/// The JSON Schema of a report: that of a run that is done, or of one that failed.
#[must_use]
pub fn schema() -> serde_json::Value {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.into_generator().into_root_schema_for::<Written>().to_value()
}

/// What one run found and made.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Name and version of this program.
    pub slicer: String,
    /// Exit code of the run: 0, or 1 where it is done with findings.
    pub exit_code: u8,
    /// The file with the G-code as it was named, `-` for standard output; null if none was written, as of a run
    /// whose `--check` has findings.
    pub output: Option<String>,
    /// The printer's profile, by name or file: the last one asked for that is a printer or inherits one.
    pub profile: String,
    /// Whether somebody chose the printer; otherwise it is the default one.
    pub is_profile_chosen: bool,
    /// The profiles that had a say, defaults included, the most general first.
    pub profiles: Vec<ProfileReport>,
    /// Each model read, in the order given, and where it and its copies lie.
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
    /// How fast the hot end melts filament.
    pub flow: FlowReport,
    /// What a least time of a layer changed; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cooling: Option<CoolingReport>,
    /// Accelerations, jerks and pressure advance that the file sets; absent where it sets none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionReport>,
    /// Lines that are written as arcs; absent without `arcs`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arcs: Option<ArcsReport>,
    /// Lines shorter than the printer can be fed; absent without `limits.max_segment_rate`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segments: Option<SegmentsReport>,
    /// Dual injection; absent where it is off.
    pub dual: Option<DualReport>,
    /// The brim that was printed although nobody asked for it; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub brim: Option<BrimReport>,
    /// The raft; absent without one. What it takes of time and filament stands in `roles`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub raft: Option<RaftReport>,
    /// Skins that follow the surface; absent without `nonplanar.enabled`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nonplanar: Option<NonPlanarReport>,
    /// How fast motors have to step; absent where the profile has no `[steps]`, and where nobody reads it:
    /// with `-q` and no report.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<StepsReport>,
    /// Findings.
    pub warnings: Vec<Warning>,
    /// The verdict of `--check`; absent without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub check: Option<Verdict>,
}

/// A profile that had a say.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ProfileReport {
    /// Its name, of a file without its folder.
    pub name: String,
    /// `printer`, `material` or `print`; absent for a file that may hold anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<&'static str>,
    /// The file as it was named or found; absent for a profile that comes with the program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
}

/// A brim where `brim.where` is `auto`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct BrimReport {
    /// Width asked for, mm.
    pub width_mm: f64,
    /// Islands of the first layer that have one.
    pub islands: usize,
    /// All islands of the first layer.
    pub of: usize,
    /// What would make them come loose, in words.
    pub why: Vec<String>,
}

/// A raft.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct RaftReport {
    /// Its layers, the lowest of the print's.
    pub layers: usize,
    /// From the bed to its top, mm.
    pub height_mm: f64,
    /// From its top to the bottom of the part, mm.
    pub gap_mm: f64,
    /// Pieces that do not touch.
    pub plates: usize,
}

/// The layers of a print, those of a raft included.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
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
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
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
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
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
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct FilamentReport {
    /// Length, mm.
    pub length_mm: f64,
    /// Volume, cm³.
    pub volume_cm3: f64,
    /// Weight, g.
    pub weight_g: f64,
    /// Price in the currency of `filament.cost`; absent if that is 0.
    pub cost: Option<f64>,
}

/// How long the print takes, without homing, heating and the rest of the start and end blocks.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
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
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct LayerTimeReport {
    /// Its top above the bed, mm.
    pub z_mm: f64,
    /// Time, s.
    pub time_s: f64,
}

/// How fast the hot end melts filament.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct FlowReport {
    /// The largest flow of the print, mm³/s.
    pub largest_mm3_s: f64,
    /// The most that the hot end can melt, mm³/s.
    pub limit_mm3_s: f64,
    /// Roles whose usual lines melt at the speed asked for, and some wider ones do not: those are slower.
    pub slowed: Vec<SlowedFlowReport>,
}

/// Lines that are slower where they are wider than usual.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct SlowedFlowReport {
    /// What they are for, as in `roles`.
    pub role: String,
    /// Highest speed asked for, mm/s.
    pub asked_mm_s: f64,
    /// Lowest speed given, mm/s.
    pub lowest_mm_s: f64,
}

/// What `cooling.min_layer_time` changed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct CoolingReport {
    /// The least time of a layer, s.
    pub min_layer_time_s: f64,
    /// No line is slowed down below this, mm/s.
    pub min_speed_mm_s: f64,
    /// Layers with slower lines.
    pub slowed_layers: usize,
    /// Of these, layers that would take long enough: only their outer walls are slower, to be like
    /// those of the layers beside them.
    pub evened_layers: usize,
    /// The lowest share of its speed that any line was left; 1 if none is slower.
    pub lowest_factor: f64,
    /// The kinds of lines, in the order in which they are slowed down.
    pub kinds: Vec<SlowedReport>,
    /// Times that the nozzle waits beside the part.
    pub waits: usize,
    /// How long it waits in all, s.
    pub waited_s: f64,
    /// Layers that take less than the least time all the same.
    pub quick_layers: usize,
    /// The first of them, 100 at most.
    pub quick: Vec<QuickLayerReport>,
}

/// What arcs stand for.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct ArcsReport {
    /// How many arcs.
    pub count: usize,
    /// Lines that they stand for.
    pub lines: usize,
}

/// What `limits.max_segment_rate` changed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct SegmentsReport {
    /// Moves that the printer can be fed, 1/s.
    pub max_rate_per_s: f64,
    /// Lines that were joined with the next.
    pub joined: usize,
    /// Lines that are slower.
    pub slowed: usize,
    /// What they take longer by at full speed, s.
    pub lost_s: f64,
}

/// How one kind of lines was slowed down.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct SlowedReport {
    /// `infill, skin, support`, `inner walls`, or `outer walls, overhangs, bridges`.
    pub kind: String,
    /// Layers on which some of them are slower.
    pub layers: usize,
    /// The lowest share of its speed that one was left; 1 if none is slower.
    pub lowest_factor: f64,
}

/// A layer that stays too quick.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct QuickLayerReport {
    /// Its number, counted from 1.
    pub layer: usize,
    /// Its top above the bed, mm.
    pub z_mm: f64,
    /// Its time, s.
    pub time_s: f64,
}

/// What the file tells the printer of accelerations.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct MotionReport {
    /// The first layer if it has its own, each role that is printed, and travels.
    pub drives: Vec<DriveReport>,
    /// Pressure advance, s; absent where it stays as the printer has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_advance_s: Option<f64>,
}

/// Acceleration and jerk of one kind of move.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct DriveReport {
    /// `first layer`, a role, or `travel`.
    pub of: String,
    /// Its acceleration, mm/s²; absent where the file sets none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub acceleration_mm_s2: Option<f64>,
    /// Its jerk or square corner velocity, mm/s; absent where it is the printer's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jerk_mm_s: Option<f64>,
}

/// What dual injection did. Lengths are those of lines, without the turns between them;
/// lines shorter than they are wide are not printed and not counted.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
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

/// How the infill or the support of one block of layers is printed. A block are the layers that are
/// filled in one direction: one group, or several if lines are interlaced.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
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
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct ApartReport {
    /// Another layer of the group has no infill there: the place is at or beyond its walls.
    pub bounds_mm: f64,
    /// Another layer of the group has skin there.
    pub skin_mm: f64,
    /// What the layers share is shorter than a line is wide.
    pub short_mm: f64,
    /// The group has fewer layers than the ratio: at the bed, at the top, or where the direction turns.
    pub ends_mm: f64,
}
