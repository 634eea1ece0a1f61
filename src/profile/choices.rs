//! Words of a profile -> enums: the settings that take one of a few words, or a number or `auto`.
//!
//! A variant is a word, written with dashes in a profile (`OuterFirst` is `outer-first`); its
//! doc comment is the word's meaning. To add a word, add a variant, and use it.
//!
//! - An enum here is the type of one key, and named after it; the key's own meaning stands in
//!   [`super::settings`].
//! - *Words* are what a profile or a flag may say; anything else is refused with the list of them.
//! - Some keys take a number or `auto`: their enums have a variant for either, and are read and
//!   written by hand below.

use crate::head::{Head, named};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// See [`Settings::wall_order`](super::Settings::wall_order).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WallOrder {
    /// From the outer wall inwards.
    OuterFirst,
    /// From the innermost wall outwards.
    InnerFirst,
}

/// See [`Settings::seam`](super::Settings::seam).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Seam {
    /// At the vertex nearest to the nozzle.
    Nearest,
    /// At the vertex furthest back (largest y).
    Rear,
    /// In one line up the part: at a corner that hides it, the sharpest concave one before the
    /// sharpest convex one.
    Aligned,
    /// Anywhere, the same on every run.
    Random,
}

/// See [`Settings::seam_inner`](super::Settings::seam_inner).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SeamInner {
    /// Beside the outer wall's seam.
    Aligned,
    /// Every other wall moved sideways, so that no two seams lie side by side.
    Staggered,
}

/// See [`Output::stamp`](super::Output::stamp).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Stamp {
    /// The program's name and version.
    Version,
    /// Its name alone.
    None,
}

/// See [`Brim::place`](super::Brim::place).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BrimPlace {
    /// Outside, of what would come loose without.
    Auto,
    /// No brim.
    Off,
    /// Around parts.
    Outside,
    /// In their holes.
    Inside,
    /// Around them and in their holes.
    Both,
}

/// See [`Ironing::place`](super::Ironing::place).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum IroningPlace {
    /// Nowhere.
    Off,
    /// All that is seen from above.
    Top,
    /// The highest layer of each model alone.
    Topmost,
}

/// Pattern of the sparse infill.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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

/// See [`Settings::angle`](super::Settings::angle).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Angle {
    /// So many degrees.
    Degrees(#[schemars(range(min = -360, max = 360))] f64),
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

/// See [`NonPlanar::directions`](super::NonPlanar::directions).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Directions {
    /// So many degrees each.
    Degrees(#[schemars(length(min = 1, max = 10), inner(range(min = -360, max = 360)))] Vec<f64>),
    /// By the slope of each place.
    Auto(Auto),
}

/// See [`HeadKeys::name`](super::HeadKeys::name).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HeadName {
    /// [`crate::head::named::cautious`]: of a head that nobody measured; slopes of 4.3 degrees at most.
    Cautious,
    /// [`crate::head::named::v6`]: an E3D V6 with its heater block.
    V6,
    /// [`crate::head::named::long`]: a long nozzle, made for skins.
    #[serde(rename = "long-0.6")]
    Long,
}

impl HeadName {
    /// The head of this name.
    #[must_use]
    pub fn head(self) -> Head {
        match self {
            Self::Cautious => named::cautious(),
            Self::V6 => named::v6(),
            Self::Long => named::long(),
        }
    }
}

/// See [`Dual::mode`](super::Dual::mode).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DualMode {
    /// Every line on every layer.
    Off,
    /// Thick lines on the uppermost layer of each group, with the material of all its layers.
    Pair,
    /// Thick lines shared out among the layers: each layer has its turn with some of them.
    Interlaced,
}

/// See [`Dual::ratio`](super::Dual::ratio).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum DualRatio {
    /// So many.
    Layers(#[schemars(range(min = 2, max = 50))] u32),
    /// As many as height and flow allow.
    Auto(Auto),
}

/// The word `auto`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Auto {
    /// The word.
    Auto,
}

/// See [`Dual::parts`](super::Dual::parts).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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

/// See [`Dual::direction`](super::Dual::direction).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DualDirection {
    /// Directions alternate, so that the lines of successive pairs cross.
    Cross,
    /// The direction whose lines are shorter in all (the thesis's rule).
    Shorter,
}

/// See [`Dual::remainder`](super::Dual::remainder).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DualRemainder {
    /// Only infill that layers share is printed thick; the rest thin on its own layer.
    Thin,
    /// One layer's infill is printed thick as a whole, the others' left out (the thesis's rule).
    Drop,
}

/// See [`Settings::floating`](super::Settings::floating).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Floating {
    /// Empty layers and bodies that stand on nothing are refused, other places warned of.
    Refuse,
    /// Every place that begins in the air is refused.
    RefuseAll,
    /// All of it is only warned of.
    Warn,
}

impl Floating {
    /// A body with less than this many mm of lines, of `all` those of the print, is a speck, and only
    /// warned of: a scan has specks beside it that nobody misses, and that fail alone. It is a 2000th
    /// of the print, but at least a cube of 1 mm and at most one of 3 mm. The rule of the slicer and
    /// of `check`; a print that stands nowhere is never a speck.
    #[must_use]
    pub fn least_body(all: f64) -> f64 {
        (all / 2000.0).clamp(8.0, 500.0)
    }
}

/// See [`Support::stands_on`](super::Support::stands_on).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SupportBase {
    /// On the bed and on the part.
    Everywhere,
    /// Only on the bed.
    Bed,
}

/// See [`Extrusion::model`](super::Extrusion::model).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ExtrusionModel {
    /// Line width × layer height, which is a bead with rounded ends that is `h·(1 − π/4)` wider than its spacing.
    Area,
    /// Line width × layer height × π/4, an ellipse as wide and as high as the line: a round strand where both
    /// are the same.
    Round,
    /// Factors measured on the machine.
    Factor,
}

/// See [`Travel::order`](super::Travel::order).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TravelOrder {
    /// Island by island, the nearest path each time, then reordered where that saves time.
    Nearest,
    /// All walls of a layer in the order in which the file's triangles begin their contours, each from
    /// its first corner unless a seam is asked for; then skin and infill as they are scanned. No line is
    /// turned round.
    File,
}

/// See [`Retraction::when`](super::Retraction::when).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RetractWhen {
    /// All but those shorter than `min_travel`.
    Always,
    /// Those that cross an outer wall or leave the part.
    Crossing,
}

/// See [`Machine::dialect`](super::Machine::dialect).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DialectName {
    /// Sailfish and MakerBot firmware, through GPX.
    Makerbot,
    /// Marlin.
    Marlin,
    /// Klipper.
    Klipper,
    /// RepRapFirmware, of Duet boards.
    Reprapfirmware,
    /// The Ultimaker 2's firmware, which heats and retracts by itself; E is plastic in mm³.
    Ultigcode,
}

/// See [`Machine::origin`](super::Machine::origin).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// In the middle of the bed.
    Centre,
    /// At the bed's front left corner.
    FrontLeft,
}

/// See [`MotionLimits::junction`](super::MotionLimits::junction).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
