//! Print + Mesh -> how far a raft lifts the part off the bed.
//!
//! Files call the lines of a raft support. So a raft is layers at the bottom without a line of the part,
//! but support alone can also lie below a part that is too thin there to be printed. The two differ in
//! height: on a raft all of the part lies higher. A file that does not tell what its lines are for has a raft if
//! it is higher than the part, and so much of it at the bottom is wider.

use super::part::Part;
use crate::check::survey::{Extent, Survey};
use crate::mesh::Mesh;
use crate::reader::{Facts, Role};
use crate::units::to_mm;

/// Share of a raft's height by which the print must be higher than the part. What of the part's tip is too
/// thin to be printed makes it lower than the raft lifts it.
const LEAST: f64 = 0.5;

/// No raft is higher, mm; and how far it reaches beyond the part at least.
const HIGHEST: f64 = 5.0;
const WIDER: f64 = 0.8;

/// Keys under which slicers write that there is support, or of how many layers a raft is.
pub(crate) const SUPPORT: &str = "support_material";
pub(crate) const RAFT: &str = "raft_layers";

/// Whether a file has something by one of its settings, and does not tell which lines it is.
pub(crate) fn is_untold(facts: &Facts, key: &str) -> bool {
    let is_set = facts.value(key).is_some_and(|value| !matches!(value, "" | "0"));
    is_set && !facts.has(Role::OuterWall)
}

/// From the bed to the part's bottom, mm; 0 without a raft.
pub(crate) fn lift((facts, survey): (&Facts, &Survey), mesh: &Mesh) -> f64 {
    let first = survey.bottoms.iter().position(|bottom| bottom.is_finite());
    let Some(first) = first.filter(|first| *first > 0) else { return 0.0 };
    let mut bottom = survey.bottoms[first];
    // The first layer may be squeezed into the gap, and all others lie as much lower.
    let second = (first + 1..survey.bottoms.len()).find(|&k| survey.bottoms[k].is_finite());
    if let Some(second) = second {
        let height = facts.layers[first].z - bottom;
        bottom = bottom.min(survey.bottoms[second] - height);
    }
    let more = survey.top - to_mm(mesh.top());
    if bottom > 0.0 && more > LEAST * bottom { bottom } else { 0.0 }
}

/// The lift in a file that does not tell what lines are for: the print is so much higher than the part,
/// and what lies that low is wider than the part on all sides. 0 without a raft.
pub(crate) fn untold_lift((facts, survey): (&Facts, &Survey), part: &Part) -> f64 {
    let more = survey.top - part.height();
    let Some((low, high)) = part.extent().filter(|_| (0.0..HIGHEST).contains(&more)) else {
        return 0.0;
    };
    // The part may lie elsewhere on the bed.
    let is_wider = |outline: &Extent| {
        outline.is_some_and(|(from, to)| {
            (0..2).all(|axis| to[axis] - from[axis] > high[axis] - low[axis] + 2.0 * WIDER)
        })
    };
    let below = facts.layers.iter().zip(&survey.outlines);
    let below = below.take_while(|(layer, _)| layer.z < more - layer.height / 2.0);
    let raft: Vec<bool> = below.map(|(_, outline)| is_wider(outline)).collect();
    if raft.len() > 1 && raft.iter().all(|wider| *wider) { more } else { 0.0 }
}
