//! Settings: every key of a profile as a typed value. **The one declaration of each key.**
//!
//! A field here is a key. Its place in the struct is its place in a profile (`speed.wall`), its
//! doc comment the key's meaning, its attributes the limits, the unit and the default:
//!
//! ```text
//! /// Speed of walls.
//! #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 27))]
//! pub wall: f64,
//! ```
//!
//! Everything else is derived from it: the table of keys that values are checked by
//! ([`super::keys`]), `profile show`, the settings in a G-code file, the list in
//! `profiles/README.md` and the JSON Schema for editors ([`super::schema`]).
//! To add a key, add a field, and use it. Words:
//!
//! - **range**: lowest and highest value, both allowed.
//! - **unit**: for people and editors; values are always in this unit.
//! - **default**: the value where no profile has one. A key without a default must be set by
//!   a profile, unless its type is an `Option`: then it may stay unset.
//! - **choices**: keys that hold a word are enums, in [`super::choices`].

use super::choices::{
    Angle, DialectName, DualDirection, DualMode, DualPart, DualRatio, DualRemainder,
    ExtrusionModel, Floating, JunctionRule, Origin, Pattern, RetractWhen, Seam, SupportBase,
    WallOrder,
};
use super::sizes::{self, PictureSize};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Longest text on one line, in characters. Keeps every settings line of a G-code
/// file below GPX's limit of 1023 bytes, even if each character is four bytes.
pub const MAX_TEXT: usize = 200;

/// All effective settings. Lengths are in mm, speeds in mm/s, angles in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// What the profile is for, in one line.
    #[schemars(length(max = MAX_TEXT))]
    pub description: String,

    /// Height of a layer.
    #[schemars(range(min = 0.02, max = 2), extend("unit" = "mm", "default" = 0.2))]
    pub layer_height: f64,
    /// Height of the first layer.
    #[schemars(range(min = 0.02, max = 2), extend("unit" = "mm", "default" = 0.2))]
    pub first_layer_height: f64,
    /// Width of a line, and distance between neighbouring solid lines.
    #[schemars(range(min = 0.05, max = 4), extend("unit" = "mm", "default" = 0.4))]
    pub line_width: f64,
    /// How far a simplified contour may lie from the model's.
    #[schemars(range(min = 0, max = 0.5), extend("unit" = "mm", "default" = 0.01))]
    pub tolerance: f64,

    /// Number of walls.
    #[schemars(range(min = 0, max = 100), extend("unit" = "walls", "default" = 2))]
    pub walls: u32,
    /// Distance from the contour to the middle of the outer wall: 0.5 gives parts of the right
    /// size, 0 puts the wall's middle on the contour.
    #[schemars(range(min = 0, max = 1), extend("unit" = "line widths", "default" = 0.5))]
    pub outer_wall_inset: f64,
    /// Thinner parts are not printed; thicker ones get one bead where two walls do not fit.
    #[schemars(range(min = 0.01, max = 10), extend("unit" = "mm", "default" = 0.1))]
    pub min_feature: f64,
    /// Minimum width of a bead; parts thinner than that get a bead this wide.
    #[schemars(range(min = 25, max = 200), extend("unit" = "% of the nozzle", "default" = 85))]
    pub min_bead_width: f64,
    /// Maximum width of a single bead; where it would be wider, two share the room.
    #[schemars(range(min = 100, max = 200), extend("unit" = "% of the line width", "default" = 175))]
    pub max_bead_width: f64,
    /// Which wall is printed first.
    #[schemars(extend("default" = "inner-first"))]
    pub wall_order: WallOrder,
    /// Where a wall begins.
    #[schemars(extend("default" = "rear"))]
    pub seam: Seam,

    /// A print that begins in the air is refused if a body hangs, refused anywhere, or warned of.
    #[schemars(extend("default" = "refuse"))]
    pub floating: Floating,

    /// Solid layers at the top and at the bottom.
    #[schemars(range(min = 0, max = 10_000), extend("unit" = "layers", "default" = 3))]
    pub skin_layers: u32,
    /// Solid layers at the top; unset means skin_layers.
    #[schemars(range(min = 0, max = 10_000), extend("unit" = "layers"))]
    pub top_layers: Option<u32>,
    /// Solid layers at the bottom; unset means skin_layers.
    #[schemars(range(min = 0, max = 10_000), extend("unit" = "layers"))]
    pub bottom_layers: Option<u32>,
    /// How far a skin reaches sideways into the infill, to hold on.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 1.2))]
    pub skin_reach: f64,

    /// Density of the sparse infill.
    #[schemars(range(min = 0, max = 100), extend("unit" = "%", "default" = 20))]
    pub infill: f64,
    /// Rooms inside the walls narrower than this are filled solid.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm", "default" = 2))]
    pub narrow_room: f64,
    /// Pattern of the sparse infill.
    #[schemars(extend("default" = "rectilinear"))]
    pub pattern: Pattern,
    /// Direction of the lines on even layers, from the x axis; odd layers are turned by 90.
    /// auto takes the direction with the fewest turns.
    #[schemars(extend("unit" = "degrees", "default" = "auto"))]
    pub angle: Angle,
    /// Whether the first skin above sparse infill runs across the lines below it and ends on one of
    /// them, whatever its layer; off, the direction alternates with the layer alone.
    #[schemars(extend("default" = true))]
    pub skin_across_infill: bool,
    /// How far skin and infill lines reach into the innermost wall.
    #[schemars(range(min = 0, max = 1), extend("unit" = "line widths", "default" = 0.4))]
    pub infill_overlap: f64,
    /// How far an end of an infill line that leads to no other runs along the wall, at most; 0 also
    /// keeps turns from running along walls.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm", "default" = 20))]
    pub infill_anchor: f64,
    /// Radius of the turns of infill, support and skin lines, where there is room; 0 leaves
    /// them sharp.
    #[schemars(range(min = 0, max = 10), extend("unit" = "mm", "default" = 0.2))]
    pub corner_radius: f64,

    /// Dual injection: lines that are printed once for several layers.
    pub dual: Dual,
    /// Support under overhangs.
    pub support: Support,
    /// Skin that spans places where nothing is printed below.
    pub bridge: Bridge,
    /// How fast the nozzle moves.
    pub speed: Speed,
    /// How much filament a line takes.
    pub extrusion: Extrusion,
    /// Which way the nozzle goes without printing.
    pub travel: Travel,
    /// What happens to the filament around a travel.
    pub retraction: Retraction,
    /// The material.
    pub filament: Filament,
    /// The fan on what needs more of it.
    pub cooling: Cooling,
    /// The printer.
    pub machine: Machine,
    /// What the printer's planner holds itself to. It changes no move, only estimates of time.
    pub limits: MotionLimits,
}

/// `[dual]`: dual injection. A group is a number of layers, one on the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dual {
    /// Which layers thick lines lie on: none, the top layer of each group, or all layers of a
    /// group in turn.
    #[schemars(extend("default" = "off"))]
    pub mode: DualMode,
    /// Layers in a group, whose lines are printed at once; auto takes as many as pay.
    #[schemars(extend("unit" = "layers", "default" = 2))]
    pub ratio: DualRatio,
    /// Height of thick lines, at most.
    #[schemars(range(min = 10, max = 200), extend("unit" = "% of the nozzle", "default" = 100))]
    pub max_bead_height: f64,
    /// What is printed thick.
    #[schemars(extend("default" = ["infill", "support"]))]
    pub parts: Vec<DualPart>,
    /// Direction of a group's thick lines: crossing those of the group before, or the one with
    /// less length.
    #[schemars(extend("default" = "cross"))]
    pub direction: DualDirection,
    /// What happens to infill that only one layer of a group has: printed thin, or left out.
    #[schemars(extend("default" = "thin"))]
    pub remainder: DualRemainder,
}

/// `[support]`: support under overhangs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Whether support is printed.
    #[schemars(extend("default" = false))]
    pub enabled: bool,
    /// Overhangs flatter than this, measured from the bed, are supported; 90 supports all.
    #[schemars(range(min = 0, max = 90), extend("unit" = "degrees", "default" = 45))]
    pub threshold_angle: f64,
    /// Distance between support lines.
    #[schemars(range(min = 0.1, max = 50), extend("unit" = "mm", "default" = 3))]
    pub spacing: f64,
    /// How far support reaches beyond the overhang.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 1.5))]
    pub expansion: f64,
    /// Distance to the part, sideways.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 0.6))]
    pub xy_distance: f64,
    /// Distance to the part above and below, rounded to whole layers.
    #[schemars(range(min = 0, max = 5), extend("unit" = "mm", "default" = 0.2))]
    pub z_distance: f64,
    /// Dense layers at the top of support, and at the bottom where it stands on the part.
    #[schemars(range(min = 0, max = 100), extend("unit" = "layers", "default" = 2))]
    pub interface_layers: u32,
    /// Gap between the lines of dense layers.
    #[schemars(range(min = 0, max = 10), extend("unit" = "mm", "default" = 0.2))]
    pub interface_spacing: f64,
    /// Least width of support: half of its height if it is low, a fifth if it is high; 0 leaves it.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm", "default" = 4))]
    pub min_width: f64,
    /// Whether bridges get support, however short.
    #[schemars(extend("default" = false))]
    pub bridges: bool,
    /// Longer bridges get support in any case.
    #[schemars(range(min = 0, max = 500), extend("unit" = "mm", "default" = 20))]
    pub max_bridge: f64,
    /// Whether a line runs around the lines of support where they would stand alone.
    #[schemars(extend("default" = true))]
    pub outline: bool,
    /// How far the lowest layer of support reaches further out, to hold on to the bed.
    #[schemars(range(min = 0, max = 50), extend("unit" = "mm", "default" = 2))]
    pub brim: f64,
    /// Where support may stand.
    #[schemars(extend("default" = "everywhere"))]
    pub stands_on: SupportBase,
}

/// `[bridge]`: skin that spans places where nothing is printed below.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bridge {
    /// Whether skin over nothing is laid in the direction in which its lines hold best.
    #[schemars(extend("default" = true))]
    pub enabled: bool,
    /// How far its lines reach into what carries them.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 2))]
    pub anchor: f64,
    /// Distance between its lines.
    #[schemars(range(min = 1, max = 2), extend("unit" = "line widths", "default" = 1.125))]
    pub spacing: f64,
    /// Plastic of its lines; 100 is as much as fills their distance.
    #[schemars(range(min = 20, max = 200), extend("unit" = "%", "default" = 100))]
    pub flow: f64,
}

/// `[speed]`: how fast the nozzle moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Speed {
    /// Speed of walls.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 27))]
    pub wall: f64,
    /// Speed of skins.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 50))]
    pub skin: f64,
    /// Speed of walls that hang over nothing with their whole width. From half the width on they
    /// slow down towards it; 0 prints them as any wall.
    #[schemars(range(min = 0, max = 999), extend("unit" = "mm/s", "default" = 15))]
    pub overhang: f64,
    /// Speed of bridges.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 25))]
    pub bridge: f64,
    /// Speed of sparse infill that is one layer high.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 60))]
    pub infill: f64,
    /// Speed of sparse infill that is several layers high.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 60))]
    pub thick_infill: f64,
    /// Speed of support.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 50))]
    pub support: f64,
    /// Speed in x and y of moves that print nothing.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s", "default" = 90))]
    pub travel: f64,
    /// Speed of moves in z.
    #[schemars(range(min = 0.1, max = 100), extend("unit" = "mm/s", "default" = 10))]
    pub z: f64,
    /// Speed on the first layer, of the speeds above but for travel and z.
    #[schemars(range(min = 1, max = 200), extend("unit" = "%", "default" = 100))]
    pub first_layer: f64,
}

/// `[extrusion]`: how much filament a line takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Extrusion {
    /// How the amount is found: line width times layer height, or the factors below.
    #[schemars(extend("default" = "area"))]
    pub model: ExtrusionModel,
    /// Factor on every amount of filament.
    #[schemars(range(min = 0.05, max = 5), extend("unit" = "times", "default" = 1))]
    pub multiplier: f64,
    /// Layer height at which the factors hold; other heights scale them.
    #[schemars(range(min = 0.02, max = 2), extend("unit" = "mm", "default" = 0.2))]
    pub factor_height: f64,
    /// Line width at which the factors hold; other widths scale them.
    #[schemars(range(min = 0.05, max = 4), extend("unit" = "mm", "default" = 0.4))]
    pub factor_width: f64,
    /// Filament for each mm of wall.
    #[schemars(range(min = 0, max = 2), extend("unit" = "mm/mm", "default" = 0.05))]
    pub wall_factor: f64,
    /// Filament for each mm of skin.
    #[schemars(range(min = 0, max = 2), extend("unit" = "mm/mm", "default" = 0.04))]
    pub skin_factor: f64,
    /// Filament for each mm of sparse infill that is one layer high; two layers take twice that.
    #[schemars(range(min = 0, max = 2), extend("unit" = "mm/mm", "default" = 0.04))]
    pub infill_factor: f64,
    /// Filament for each mm of support.
    #[schemars(range(min = 0, max = 2), extend("unit" = "mm/mm", "default" = 0.04))]
    pub support_factor: f64,
}

/// `[travel]`: which way the nozzle goes without printing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Travel {
    /// Whether travels go round holes and corners of the part where that saves a retraction.
    #[schemars(extend("default" = true))]
    pub avoid_crossing: bool,
    /// How much longer than the straight way that may be.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm", "default" = 6))]
    pub max_detour: f64,
}

/// `[retraction]`: what happens to the filament around a travel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Retraction {
    /// Filament that is pulled back; 0 turns retraction off.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 1))]
    pub length: f64,
    /// Speed of the filament, back and forth.
    #[schemars(range(min = 0.1, max = 200), extend("unit" = "mm/s", "default" = 20))]
    pub speed: f64,
    /// Which travels retract: all, or those that cross an outer wall or leave the part.
    #[schemars(extend("default" = "crossing"))]
    pub when: RetractWhen,
    /// Travels shorter than this never retract.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm", "default" = 1))]
    pub min_travel: f64,
    /// Longer travels retract even inside the part; 0 sets no limit.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm", "default" = 12))]
    pub max_travel: f64,
    /// How far the nozzle goes back over the last line after a retraction; 0 leaves at once.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 0))]
    pub wipe: f64,
    /// How far the nozzle is lifted while retracted.
    #[schemars(range(min = 0, max = 10), extend("unit" = "mm", "default" = 0))]
    pub z_hop: f64,
}

/// `[filament]`: the material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Filament {
    /// Name of the material, such as PLA.
    #[schemars(length(max = MAX_TEXT), extend("default" = "PLA"))]
    pub name: String,
    /// Diameter of the filament.
    #[schemars(range(min = 0.5, max = 5), extend("unit" = "mm", "default" = 1.75))]
    pub diameter: f64,
    /// Density of the material.
    #[schemars(range(min = 0.1, max = 20), extend("unit" = "g/cm³", "default" = 1.24))]
    pub density: f64,
    /// Temperature of the nozzle.
    #[schemars(range(min = 0, max = 500), extend("unit" = "°C"))]
    pub temperature: f64,
    /// Temperature of the bed; 0 leaves it cold.
    #[schemars(range(min = 0, max = 200), extend("unit" = "°C", "default" = 0))]
    pub bed_temperature: f64,
    /// Power of the part cooling fan.
    #[schemars(range(min = 0, max = 100), extend("unit" = "%", "default" = 100))]
    pub fan: f64,
    /// First layer, counted from 1, that is printed with the fan on.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "layer", "default" = 2))]
    pub fan_from_layer: u32,
    /// Price of the material; 0 means unknown.
    #[schemars(range(min = 0, max = 1_000_000), extend("unit" = "money/kg", "default" = 0))]
    pub cost: f64,
}

/// `[cooling]`: the fan on what needs more of it than `filament.fan`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cooling {
    /// Power of the fan on bridges and overhanging walls, from filament.fan_from_layer on.
    #[schemars(range(min = 0, max = 100), extend("unit" = "%", "default" = 100))]
    pub bridge_fan: f64,
}

/// `[machine]`: the printer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Name of the printer.
    #[schemars(length(max = MAX_TEXT))]
    pub name: String,
    /// The G-code that its firmware understands.
    pub dialect: DialectName,
    /// Size of the print volume in x.
    #[schemars(range(min = 1, max = 5_000), extend("unit" = "mm"))]
    pub bed_width: f64,
    /// Size of the print volume in y.
    #[schemars(range(min = 1, max = 5_000), extend("unit" = "mm"))]
    pub bed_depth: f64,
    /// Size of the print volume in z.
    #[schemars(range(min = 1, max = 5_000), extend("unit" = "mm"))]
    pub bed_height: f64,
    /// Where on the bed x and y are 0.
    #[schemars(extend("default" = "front-left"))]
    pub origin: Origin,
    /// Diameter of the nozzle.
    #[schemars(range(min = 0.05, max = 2), extend("unit" = "mm", "default" = 0.4))]
    pub nozzle_diameter: f64,
    /// Number of the tool that prints.
    #[schemars(range(min = 0, max = 1), extend("default" = 0))]
    pub tool: u32,
    /// Acceleration of moves that print, which {acceleration} in the start block stands for.
    #[schemars(range(min = 1, max = 100_000), extend("unit" = "mm/s²"))]
    pub acceleration: f64,
    /// Whether E counts from the last move instead of from the start.
    #[schemars(extend("default" = false))]
    pub relative_e: bool,
    /// Plastic that the hot end can melt; lines that need more are printed slower.
    #[schemars(range(min = 0.1, max = 1_000), extend("unit" = "mm³/s"))]
    pub max_volumetric_speed: f64,
    /// Sizes of the pictures of the models at the head of the file, for hosts.
    #[schemars(length(max = sizes::MOST), extend("unit" = "pixels", "default" = []))]
    pub thumbnails: Vec<PictureSize>,
    /// G-code before the print, with {placeholders}.
    pub start_gcode: String,
    /// G-code after the print, with {placeholders}.
    pub end_gcode: String,
}

/// `[limits]`: what the printer's planner holds itself to. It changes no move, only
/// estimates of time. `machine.acceleration` is the acceleration of moves that extrude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionLimits {
    /// Highest speed in x.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s"))]
    pub speed_x: f64,
    /// Highest speed in y.
    #[schemars(range(min = 0.1, max = 999), extend("unit" = "mm/s"))]
    pub speed_y: f64,
    /// Highest speed in z.
    #[schemars(range(min = 0.1, max = 100), extend("unit" = "mm/s"))]
    pub speed_z: f64,
    /// Highest speed of the filament.
    #[schemars(range(min = 0.1, max = 200), extend("unit" = "mm/s"))]
    pub speed_e: f64,
    /// Highest acceleration in x.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub acceleration_x: f64,
    /// Highest acceleration in y.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub acceleration_y: f64,
    /// Highest acceleration in z.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub acceleration_z: f64,
    /// Highest acceleration of the filament.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub acceleration_e: f64,
    /// Acceleration of moves that print nothing.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub travel_acceleration: f64,
    /// Acceleration of the filament when it moves alone.
    #[schemars(range(min = 1, max = 1_000_000), extend("unit" = "mm/s²"))]
    pub retract_acceleration: f64,
    /// Rule for the speed at corners: Marlin's jerk, Marlin's jerk before 1.1, Sailfish's
    /// speed change, Marlin's junction deviation, Klipper's square corner velocity.
    pub junction: JunctionRule,
    /// Sudden change of speed in x, for jerk, vector-jerk and speed-change.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 10))]
    pub jerk_x: f64,
    /// Sudden change of speed in y, for jerk, vector-jerk and speed-change.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 10))]
    pub jerk_y: f64,
    /// Sudden change of speed in z, for jerk, vector-jerk and speed-change.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 0.4))]
    pub jerk_z: f64,
    /// Sudden change of the filament's speed, for jerk, vector-jerk and speed-change.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 5))]
    pub jerk_e: f64,
    /// How far an arc would pass from the corner, for deviation.
    #[schemars(range(min = 0, max = 10), extend("unit" = "mm", "default" = 0.013))]
    pub junction_deviation: f64,
    /// Speed through a corner of 90 degrees, for square-corner.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 5))]
    pub square_corner_velocity: f64,
    /// Part of a move that is left for cruising, for square-corner.
    #[schemars(range(min = 0, max = 0.99), extend("unit" = "times", "default" = 0.5))]
    pub minimum_cruise_ratio: f64,
    /// Sudden change of the filament's speed, for square-corner.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 1))]
    pub extruder_corner_velocity: f64,
    /// Moves that the planner knows of at a time; 0 is the whole file.
    #[schemars(range(min = 0, max = 100_000), extend("unit" = "blocks", "default" = 16))]
    pub look_ahead: u32,
    /// No corner need be slower than this.
    #[schemars(range(min = 0, max = 1_000), extend("unit" = "mm/s", "default" = 0.05))]
    pub minimum_speed: f64,
}
