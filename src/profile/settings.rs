//! Settings: every key of a profile as a typed value, after all layers of origin are merged.
//!
//! The same names stand in the TOML files, after `--set` and in the block of
//! settings at the end of a G-code file. Units and meanings are said here once;
//! the limits are in [`super::keys`].

use super::sizes::PictureSize;
use serde::{Deserialize, Serialize};

/// All effective settings. Lengths in mm, speeds in mm/s, angles in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// One line that says what the profile is for.
    pub description: String,

    /// Height of a layer, mm.
    pub layer_height: f64,
    /// Height of the first layer, mm.
    pub first_layer_height: f64,
    /// Width of a line and distance between neighbouring solid lines, mm.
    pub line_width: f64,
    /// How far contours may be simplified, mm.
    pub tolerance: f64,

    /// Number of walls.
    pub walls: u32,
    /// Distance of the outer wall's middle from the contour, in line widths:
    /// 0.5 makes parts measure right, 0 puts the wall on the contour.
    pub outer_wall_inset: f64,
    /// Which wall is printed first.
    pub wall_order: WallOrder,
    /// Where a wall begins.
    pub seam: Seam,

    /// Solid layers at the top and at the bottom.
    pub skin_layers: u32,
    /// Solid layers at the top, where they differ from `skin_layers`.
    pub top_layers: Option<u32>,
    /// Solid layers at the bottom, where they differ from `skin_layers`.
    pub bottom_layers: Option<u32>,
    /// How far a skin reaches sideways under or over the infill to hold on, mm.
    pub skin_reach: f64,

    /// Density of the sparse infill, %.
    pub infill: f64,
    /// Pattern of the sparse infill.
    pub pattern: Pattern,
    /// Direction of the raster lines of even layers, degrees from the x axis; odd layers are turned by 90.
    pub angle: Angle,
    /// How far skin and infill lines reach into the innermost wall, in line widths.
    pub infill_overlap: f64,
    /// Radius that the turns of infill, support and skin lines are rounded with where there is
    /// room, mm; 0 leaves them sharp.
    pub corner_radius: f64,

    /// Dual injection: infill on one layer of each pair, twice as thick.
    pub dual: Dual,
    /// Support under overhangs.
    pub support: Support,
    /// Speeds.
    pub speed: Speed,
    /// How much filament a line takes.
    pub extrusion: Extrusion,
    /// Retraction around travels.
    pub retraction: Retraction,
    /// The material.
    pub filament: Filament,
    /// The printer.
    pub machine: Machine,
    /// How fast the printer can move, for estimates of time.
    pub limits: MotionLimits,
}

/// See [`Settings::wall_order`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WallOrder {
    /// From the outer wall inwards.
    OuterFirst,
    /// From the innermost wall outwards.
    InnerFirst,
}

/// See [`Settings::seam`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Seam {
    /// At the vertex nearest to the nozzle.
    Nearest,
    /// At the vertex furthest back (largest y).
    Rear,
}

/// Pattern of the sparse infill.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pattern {
    /// Parallel lines, turned by 90° from layer to layer (from pair to pair with dual).
    Rectilinear,
    /// Parallel lines, always in the same direction.
    Aligned,
    /// Lines at 0° and 90° on every layer, each at half the density.
    Grid,
    /// Lines at 0°, 60° and 120° on every layer, each at a third of the density.
    Triangles,
}

/// See [`Settings::angle`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Angle {
    /// So many degrees.
    Degrees(f64),
    /// The one that has least turns, which depends on the model.
    Auto(Auto),
}

impl Angle {
    /// Degrees; half a right angle where no model has decided yet.
    #[must_use]
    pub fn degrees(self) -> f64 {
        match self {
            Self::Degrees(degrees) => degrees,
            Self::Auto(_) => 45.0,
        }
    }
}

/// `[dual]`: dual injection. A group is a number of layers one on the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dual {
    /// Whether lines are printed thick, and on which layers.
    pub mode: DualMode,
    /// How many layers make a group, whose lines are printed at once.
    pub ratio: DualRatio,
    /// Thick lines are never taller than this, % of the nozzle's diameter.
    pub max_bead_height: f64,
    /// What is printed thick.
    pub parts: Vec<DualPart>,
    /// Which direction a group's thick lines take.
    pub direction: DualDirection,
    /// What happens to infill that a layer of a group lacks.
    pub remainder: DualRemainder,
}

/// See [`Dual::mode`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DualMode {
    /// Every line on every layer.
    Off,
    /// Thick lines on the uppermost layer of each group, with the material of all its layers.
    Pair,
    /// Thick lines shared out among the layers: each layer has its turn with some of them.
    Interlaced,
}

/// See [`Dual::ratio`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum DualRatio {
    /// So many.
    Layers(u32),
    /// As many as height and flow allow.
    Auto(Auto),
}

/// The word `auto`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Auto {
    /// The word.
    Auto,
}

/// See [`Dual::parts`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DualPart {
    /// Sparse infill.
    Infill,
    /// Support.
    Support,
    /// All walls but the outermost.
    InnerWalls,
    /// All skin but the layer that is seen.
    InnerSkin,
}

/// See [`Dual::direction`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DualDirection {
    /// Directions alternate, so that the lines of successive pairs cross.
    Cross,
    /// The direction whose lines are shorter in all (the thesis's rule).
    Shorter,
}

/// See [`Dual::remainder`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DualRemainder {
    /// Only infill that layers share is printed thick; the rest thin on its own layer.
    Thin,
    /// One layer's infill is printed thick as a whole, the others' left out (the thesis's rule).
    Drop,
}

/// `[support]`: support under overhangs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Whether support is printed.
    pub enabled: bool,
    /// Overhangs flatter than this are supported, degrees from the bed.
    pub threshold_angle: f64,
    /// Distance between support lines, mm.
    pub spacing: f64,
    /// How far support reaches beyond the overhang, mm.
    pub expansion: f64,
    /// Distance to the part, sideways, mm.
    pub xy_distance: f64,
    /// Distance to the part above and below, mm; rounded to whole layers.
    pub z_distance: f64,
    /// Where support may stand.
    pub stands_on: SupportBase,
}

/// See [`Support::stands_on`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SupportBase {
    /// On the bed and on the part.
    Everywhere,
    /// Only on the bed.
    Bed,
}

/// `[speed]`: how fast the nozzle moves, mm/s.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Speed {
    /// Outer and inner walls.
    pub wall: f64,
    /// Skins.
    pub skin: f64,
    /// Sparse infill of one layer's height.
    pub infill: f64,
    /// Sparse infill of a pair's height.
    pub thick_infill: f64,
    /// Support.
    pub support: f64,
    /// Moves in x and y without extrusion.
    pub travel: f64,
    /// Moves in z.
    pub z: f64,
    /// First layer, % of the speeds above (travel and z excepted).
    pub first_layer: f64,
}

/// `[extrusion]`: how much filament a line takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Extrusion {
    /// How the amount is found.
    pub model: ExtrusionModel,
    /// Factor on every amount.
    pub multiplier: f64,
    /// `factor` only: layer height at which the factors below hold, mm. Other heights scale them.
    pub factor_height: f64,
    /// `factor` only: line width at which the factors below hold, mm. Other widths scale them.
    pub factor_width: f64,
    /// `factor` only: walls, mm of filament per mm of path.
    pub wall_factor: f64,
    /// `factor` only: skins, mm of filament per mm of path.
    pub skin_factor: f64,
    /// `factor` only: sparse infill of one layer's height, mm of filament per mm of path; thick infill takes twice that.
    pub infill_factor: f64,
    /// `factor` only: support, mm of filament per mm of path.
    pub support_factor: f64,
}

/// See [`Extrusion::model`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExtrusionModel {
    /// Line width × layer height, which is a bead with rounded ends that is `h·(1 − π/4)` wider than its spacing.
    Area,
    /// Factors measured on the machine.
    Factor,
}

/// `[retraction]`: what happens around a travel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Retraction {
    /// Filament pulled back, mm; 0 turns retraction off.
    pub length: f64,
    /// Speed of the filament, back and forth, mm/s.
    pub speed: f64,
    /// Which travels retract.
    pub when: RetractWhen,
    /// Travels shorter than this never retract, mm.
    pub min_travel: f64,
    /// How far the nozzle is lifted while retracted, mm.
    pub z_hop: f64,
}

/// See [`Retraction::when`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RetractWhen {
    /// All but those shorter than `min_travel`.
    Always,
    /// Those that cross an outer wall or leave the part.
    Crossing,
}

/// `[filament]`: the material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Filament {
    /// Its name, such as `PLA`.
    pub name: String,
    /// Diameter, mm.
    pub diameter: f64,
    /// Density, g/cm³.
    pub density: f64,
    /// Nozzle temperature, °C.
    pub temperature: f64,
    /// Bed temperature, °C; 0 leaves the bed cold.
    pub bed_temperature: f64,
    /// Part cooling fan, %.
    pub fan: f64,
    /// First layer (counted from 1) printed with the fan on.
    pub fan_from_layer: u32,
    /// Price, money per kg; 0 where it is not known.
    pub cost: f64,
}

/// `[machine]`: the printer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Its name.
    pub name: String,
    /// The G-code it understands.
    pub dialect: DialectName,
    /// Size of the print volume in x, mm.
    pub bed_width: f64,
    /// Size of the print volume in y, mm.
    pub bed_depth: f64,
    /// Size of the print volume in z, mm.
    pub bed_height: f64,
    /// Where x = 0, y = 0 is.
    pub origin: Origin,
    /// Nozzle diameter, mm.
    pub nozzle_diameter: f64,
    /// Tool that prints: 0 or 1.
    pub tool: u32,
    /// Acceleration asked for by the start block, mm/s².
    pub acceleration: f64,
    /// E counts from the last move instead of from the start.
    pub relative_e: bool,
    /// Plastic that the hot end can melt, mm³/s.
    pub max_volumetric_speed: f64,
    /// Sizes of the pictures of the models at the head of the file.
    pub thumbnails: Vec<PictureSize>,
    /// G-code before the print, with `{placeholders}`.
    pub start_gcode: String,
    /// G-code after the print, with `{placeholders}`.
    pub end_gcode: String,
}

/// See [`Machine::dialect`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DialectName {
    /// Sailfish and MakerBot firmware, through GPX.
    Makerbot,
    /// Marlin.
    Marlin,
    /// Klipper.
    Klipper,
}

/// See [`Machine::origin`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// In the middle of the bed.
    Centre,
    /// At the bed's front left corner.
    FrontLeft,
}

/// `[limits]`: what the printer's planner holds itself to. It changes no move, only
/// estimates of time. `machine.acceleration` is the acceleration of moves that extrude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionLimits {
    /// Highest speed in x, mm/s.
    pub speed_x: f64,
    /// Highest speed in y, mm/s.
    pub speed_y: f64,
    /// Highest speed in z, mm/s.
    pub speed_z: f64,
    /// Highest speed of the filament, mm/s.
    pub speed_e: f64,
    /// Highest acceleration in x, mm/s².
    pub acceleration_x: f64,
    /// Highest acceleration in y, mm/s².
    pub acceleration_y: f64,
    /// Highest acceleration in z, mm/s².
    pub acceleration_z: f64,
    /// Highest acceleration of the filament, mm/s².
    pub acceleration_e: f64,
    /// Acceleration of moves without extrusion, mm/s².
    pub travel_acceleration: f64,
    /// Acceleration of the filament alone, mm/s².
    pub retract_acceleration: f64,
    /// Which rule says how fast a corner may be taken.
    pub junction: JunctionRule,
    /// The jerks and `speed-change`: sudden change of speed in x, mm/s.
    pub jerk_x: f64,
    /// The jerks and `speed-change`: sudden change of speed in y, mm/s.
    pub jerk_y: f64,
    /// The jerks and `speed-change`: sudden change of speed in z, mm/s.
    pub jerk_z: f64,
    /// The jerks and `speed-change`: sudden change of the filament's speed, mm/s.
    pub jerk_e: f64,
    /// `deviation`: how far an arc would pass from the corner, mm.
    pub junction_deviation: f64,
    /// `square-corner`: speed through a corner of 90°, mm/s.
    pub square_corner_velocity: f64,
    /// `square-corner`: part of a move, 0 to 0.99, that is left for cruising.
    pub minimum_cruise_ratio: f64,
    /// `square-corner`: sudden change of the filament's speed, mm/s.
    pub extruder_corner_velocity: f64,
    /// Moves that the planner knows of at a time; 0 is the whole file.
    pub look_ahead: u32,
    /// No corner need be slower than this, mm/s.
    pub minimum_speed: f64,
}

/// See [`MotionLimits::junction`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JunctionRule {
    /// Marlin's classic jerk.
    Jerk,
    /// Jerk in x and y as one vector: Marlin's before 1.1.
    VectorJerk,
    /// Sailfish's "maximum speed change".
    SpeedChange,
    /// Marlin's junction deviation.
    Deviation,
    /// Klipper's square corner velocity.
    SquareCorner,
}
