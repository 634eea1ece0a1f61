//! What is told of a part of the surface: its area, how much of it is covered, and its roughness.

use schemars::JsonSchema;
use serde::Serialize;

/// A part of the surface and how the plastic lies on it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Means {
    /// Area on the surface, mm².
    pub area_mm2: f64,
    /// Share of it over which the plastic's top is within 0.8 layers, straight up or down, part of 1.
    pub coverage: f64,
    /// Mean deviation at right angles to the surface, more plastic above 0, µm. This and all below is of
    /// what has plastic near; `None` without any.
    pub mean_um: Option<f64>,
    /// Of deviations as they are, less their mean.
    pub unfiltered: Values,
    /// Of deviations less the Gaussian mean line or plane.
    pub filtered: Values,
}

/// Values of roughness, µm; `None` if there is nothing to measure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Values {
    /// Mean of the absolute deviations over profiles along the steepest slope.
    pub ra_um: Option<f64>,
    /// Root of the mean square over them.
    pub rq_um: Option<f64>,
    /// Mean height from the lowest to the highest place in pieces of them as long as the cut-off.
    pub rz_um: Option<f64>,
    /// Mean of the absolute deviations over the area.
    pub sa_um: Option<f64>,
    /// Root of the mean square over it.
    pub sq_um: Option<f64>,
}
