//! `[head]`: what hangs around the nozzle's tip.

use crate::profile::choices::HeadName;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[head]`: what hangs around the nozzle's tip, seen from the tip: what is printed already must not touch
/// it where skins follow the surface. A named head, and what differs from it; a name replaces what profiles
/// before it say of the head. [`Settings::head`](super::Settings::head()) puts them together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeadKeys {
    /// The head that holds where no other key of this table says more.
    #[schemars(extend("default" = "cautious"))]
    pub name: HeadName,
    /// Diameter of the level face round the nozzle's hole; unset means the named head's, as for all below.
    #[schemars(range(min = 0, max = 20), extend("unit" = "mm"))]
    pub flat: Option<f64>,
    /// Slope of the nozzle's flank above the horizontal.
    #[schemars(range(min = 1, max = 89), extend("unit" = "degrees"))]
    pub cone: Option<f64>,
    /// Height of the flank; above it the nozzle is no wider.
    #[schemars(range(min = 0, max = 100), extend("unit" = "mm"))]
    pub cone_length: Option<f64>,
    /// Radius and height above the tip of round parts about the nozzle's axis, such as its hexagon.
    #[schemars(length(max = MOST_ROWS), inner(inner(range(min = 0, max = 500))), extend("unit" = "mm"))]
    pub discs: Option<Vec<[f64; 2]>>,
    /// Parts that hang beside it, such as the heater block, ducts, a probe: x and y of one corner, x and y of
    /// the other, and height above the tip. x is to the right of the nozzle, y behind it.
    #[schemars(length(max = MOST_ROWS), inner(inner(range(min = -500, max = 500))), extend("unit" = "mm"))]
    pub boxes: Option<Vec<[f64; 5]>>,
}

/// Discs or boxes, at most: so that the settings' line stays below GPX's limit.
const MOST_ROWS: usize = 12;
