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
//! `profiles/README.md` and the JSON Schema for editors ([`mod@super::schema`]).
//! To add a key, add a field, and use it. Words:
//!
//! - **range**: lowest and highest value, both allowed.
//! - **unit**: for people and editors; values are always in this unit.
//! - **default**: the value where no profile has one. A key without a default must be set by
//!   a profile, unless its type is an `Option`: then it may stay unset.
//! - **follows**: the key that gives the value, so many times its own, where no profile has one
//!   but has that key.
//! - **choices**: keys that hold a word are enums, in [`super::choices`].

mod acceleration;
mod adhesion;
mod cooling;
mod dual;
mod extrusion;
mod head;
mod ironing;
mod jerk;
mod limits;
mod machine;
mod material;
mod nonplanar;
mod output;
mod speed;
mod steps;
mod support;
mod travel;

use super::choices::{Angle, Floating, Pattern, Seam, SeamInner, WallOrder};
pub use acceleration::Acceleration;
pub use adhesion::{Brim, Raft, Skirt};
pub use cooling::Cooling;
pub use dual::Dual;
pub use extrusion::Extrusion;
pub use head::HeadKeys;
pub use ironing::Ironing;
pub use jerk::Jerk;
pub use limits::MotionLimits;
pub use machine::{Machine, Reach};
pub use material::Filament;
pub use nonplanar::NonPlanar;
pub use output::Output;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
pub use speed::Speed;
pub use steps::Steps;
pub use support::{Bridge, Support};
pub use travel::{Retraction, Travel};

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

    /// Height of a layer; half the nozzle's diameter where nobody sets it.
    #[schemars(range(min = 0.02, max = 2), extend("unit" = "mm", "default" = 0.2, "follows" = "machine.nozzle_diameter", "times" = 0.5))]
    pub layer_height: f64,
    /// Height of the first layer; half the nozzle's diameter where nobody sets it.
    #[schemars(range(min = 0.02, max = 2), extend("unit" = "mm", "default" = 0.2, "follows" = "machine.nozzle_diameter", "times" = 0.5))]
    pub first_layer_height: f64,
    /// Width of a line, and distance between neighbouring solid lines; the nozzle's diameter where
    /// nobody sets it.
    #[schemars(range(min = 0.05, max = 4), extend("unit" = "mm", "default" = 0.4, "follows" = "machine.nozzle_diameter", "times" = 1))]
    pub line_width: f64,
    /// Width of lines on the first layer, which holds better where they are wide; unset means
    /// line_width.
    #[schemars(range(min = 0.05, max = 4), extend("unit" = "mm"))]
    pub first_layer_width: Option<f64>,
    /// How far a simplified contour may lie from the model's.
    #[schemars(range(min = 0, max = 0.5), extend("unit" = "mm", "default" = 0.01))]
    pub tolerance: f64,

    /// How far outlines are moved outwards, inwards if negative; holes stay.
    #[schemars(range(min = -2, max = 2), extend("unit" = "mm", "default" = 0))]
    pub xy_compensation: f64,
    /// How far holes are widened, narrowed if negative.
    #[schemars(range(min = -2, max = 2), extend("unit" = "mm", "default" = 0))]
    pub hole_compensation: f64,
    /// How far the first layer is drawn in, since it is pressed wide; layers above it by as much less
    /// as they lie higher.
    #[schemars(range(min = 0, max = 2), extend("unit" = "mm", "default" = 0))]
    pub elephant_foot: f64,

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
    /// Where inner walls begin: beside the outer wall's seam, or moved sideways by turns.
    #[schemars(extend("default" = "aligned"))]
    pub seam_inner: SeamInner,
    /// How far a closed wall ends before its beginning, so that the seam bulges less.
    #[schemars(range(min = 0, max = 2), extend("unit" = "mm", "default" = 0))]
    pub seam_gap: f64,
    /// How far the nozzle goes on over an outer wall's beginning once it is closed, without filament.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 0))]
    pub seam_wipe: f64,

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
    /// Thickness of the skin at the top: as many layers as it or their number asks for, whichever
    /// are more. A number given by a flag or `--set` holds alone.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm", "default" = 0.8))]
    pub top_thickness: f64,
    /// Thickness of the skin at the bottom, as that at the top.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm", "default" = 0.8))]
    pub bottom_thickness: f64,
    /// Whether the lines of a top that is seen are printed one beside the other in one direction, so
    /// that light falls alike on all of them.
    #[schemars(extend("default" = true))]
    pub top_monotonic: bool,
    /// Whether tops that are seen have the outer wall alone, so that skin fills all the rest. What is
    /// narrower than a few lines, such as the steps of a slope, keeps its walls.
    #[schemars(extend("default" = false))]
    pub top_one_wall: bool,
    /// How far a skin reaches sideways into the infill, to hold on.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 1.2))]
    pub skin_reach: f64,

    /// Density of the sparse infill; at 100 it is laid as skin is, unless it is printed thick.
    #[schemars(range(min = 0, max = 100), extend("unit" = "%", "default" = 20))]
    pub infill: f64,
    /// Rooms inside the walls that are no wider than this, and 0.05 mm, are filled solid.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm", "default" = 2))]
    pub narrow_room: f64,
    /// Pattern of the sparse infill. From 90 % on grid and triangles are rectilinear: lines that cross on a
    /// layer cannot be so dense.
    #[schemars(extend("default" = "rectilinear"))]
    pub pattern: Pattern,
    /// Direction of the lines on even layers, from the x axis; odd layers are turned by 90.
    /// auto takes the direction with the fewest turns.
    #[schemars(extend("unit" = "degrees", "default" = "auto"))]
    pub angle: Angle,
    /// Where an infill line lies: so far from the lowest coordinate of all parts, across the lines. All others,
    /// those of skins too, follow it to both sides. Unset, they follow one through the parts' middle.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm"))]
    pub infill_start: Option<f64>,
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
    /// Whether lines that lie on a circle are written as arcs (G2, G3), where machine.arcs says that the
    /// firmware knows them: files are smaller, and the printer has less to read.
    #[schemars(extend("default" = false))]
    pub arcs: bool,
    /// How far an arc may lie from the lines that it stands for: a little more than tolerance, for lines
    /// on a circle stand off it by that. The straight pieces that the firmware makes of the arc may lie
    /// twice as far from the lines.
    #[schemars(range(min = 0.001, max = 0.5), extend("unit" = "mm", "default" = 0.0125))]
    pub arc_tolerance: f64,

    /// Dual injection: lines that are printed once for several layers.
    pub dual: Dual,
    /// Support under overhangs.
    pub support: Support,
    /// Skin that spans places where nothing is printed below.
    pub bridge: Bridge,
    /// The hot nozzle goes over tops a second time.
    pub ironing: Ironing,
    /// Top skins that follow the surface.
    pub nonplanar: NonPlanar,
    /// Loops around everything.
    pub skirt: Skirt,
    /// Lines beside the first layer.
    pub brim: Brim,
    /// A plate under the print.
    pub raft: Raft,
    /// How fast the nozzle moves.
    pub speed: Speed,
    /// How hard it speeds up and slows down.
    pub acceleration: Acceleration,
    /// How fast it takes corners.
    pub jerk: Jerk,
    /// How much filament a line takes.
    pub extrusion: Extrusion,
    /// Which way the nozzle goes without printing.
    pub travel: Travel,
    /// What happens to the filament around a travel.
    pub retraction: Retraction,
    /// The material.
    pub filament: Filament,
    /// How a layer gets the time and the air that it needs to set.
    pub cooling: Cooling,
    /// What the file says of itself.
    pub output: Output,
    /// The printer.
    pub machine: Machine,
    /// What hangs around the nozzle's tip.
    pub head: HeadKeys,
    /// What the printer's planner holds itself to. It changes estimates of time; only max_segment_rate,
    /// and what may be asked for by `[acceleration]`, change the file.
    pub limits: MotionLimits,
    /// The motors of a machine that takes steps.
    pub steps: Steps,
}
