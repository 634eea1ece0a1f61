//! `[ironing]`: the hot nozzle goes over tops a second time.

use crate::profile::choices::IroningPlace;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[ironing]`: the nozzle goes once more over what is seen from above, to smooth it. How fast says
/// `speed.ironing`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ironing {
    /// What is ironed: nothing, all tops, or only the highest layer of each model.
    #[serde(rename = "where")]
    #[schemars(extend("default" = "off"))]
    pub place: IroningPlace,
    /// Plastic of its lines, of what a layer of their spacing takes: it fills the grooves.
    #[schemars(range(min = 5, max = 50), extend("unit" = "%", "default" = 15))]
    pub flow: f64,
    /// Distance between its lines.
    #[schemars(range(min = 0.05, max = 1), extend("unit" = "mm", "default" = 0.1))]
    pub spacing: f64,
    /// How far the middle of the nozzle keeps from the part's outline, and from that of what stands
    /// on the layer; half a line's width where nobody sets it.
    #[schemars(range(min = 0.05, max = 20), extend("unit" = "mm", "default" = 0.2, "follows" = "line_width", "times" = 0.5))]
    pub inset: f64,
}
