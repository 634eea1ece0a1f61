//! `[support]`, `[bridge]`: what carries overhangs, and skin over nothing.

use crate::profile::choices::SupportBase;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[support]`: support under overhangs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Whether support is printed.
    #[schemars(extend("default" = false))]
    pub enabled: bool,
    /// Overhangs flatter than this, measured from the bed, are supported; 90 supports all. It is the angle of the surface, known to a degree from a millimetre above the bed on; a single step gets support if it reaches out by 0.03 mm and a fifth of a layer more than that allows.
    #[schemars(range(min = 0, max = 90), extend("unit" = "degrees", "default" = 45))]
    pub threshold_angle: f64,
    /// Distance between support lines.
    #[schemars(range(min = 0.1, max = 50), extend("unit" = "mm", "default" = 3))]
    pub spacing: f64,
    /// How far support reaches beyond the overhang.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm", "default" = 0.8))]
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
    /// Longer bridges get support: strips that leave no more than this free.
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
