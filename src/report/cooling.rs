//! Slowed layers + times -> CoolingReport: what was slowed down, and what is too quick all the same.

use super::{CoolingReport, QuickLayerReport, SlowedReport};
use crate::gcode::cooling::Cooled;
use crate::gcode::times::Times;
use crate::profile::Settings;
use crate::units::to_mm;

/// Quick layers that a report lists: a tower may have thousands.
const MOST_LISTED: usize = 100;

/// The kinds of lines that cooling tells apart, in the order of [`Cooled::kinds`].
const KINDS: [&str; 3] =
    ["infill, skin, support", "inner walls", "outer walls, overhangs, bridges"];

/// What the least time of a layer changed; none without one.
pub(super) fn cooling(
    cooled: &Cooled,
    times: &Times,
    settings: &Settings,
) -> Option<CoolingReport> {
    let least = settings.cooling.min_layer_time;
    let layers = times.layers.iter().enumerate();
    let quick: Vec<QuickLayerReport> = layers
        .filter(|(_, layer)| layer.seconds > 0.0 && layer.seconds < least)
        .map(|(k, layer)| QuickLayerReport {
            layer: k + 1,
            z_mm: to_mm(layer.z),
            time_s: layer.seconds,
        })
        .collect();
    let kinds = KINDS.into_iter().zip(&cooled.kinds).map(|(kind, slowed)| SlowedReport {
        kind: kind.to_owned(),
        layers: slowed.layers,
        lowest_factor: slowed.lowest,
    });
    (least > 0.0).then(|| CoolingReport {
        min_layer_time_s: least,
        min_speed_mm_s: settings.cooling.min_speed,
        slowed_layers: cooled.layers,
        evened_layers: cooled.evened,
        lowest_factor: cooled.kinds.iter().map(|kind| kind.lowest).fold(1.0, f64::min),
        kinds: kinds.collect(),
        waits: cooled.waits,
        waited_s: times.waiting,
        quick_layers: quick.len(),
        quick: quick.into_iter().take(MOST_LISTED).collect(),
    })
}
