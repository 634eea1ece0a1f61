//! Print + Mesh -> how far a raft lifts the part off the bed.
//!
//! Files call the lines of a raft support. So a raft is layers at the bottom without a line of the part,
//! but support alone can also lie below a part that is too thin there to be printed. The two differ in
//! height: on a raft all of the part lies higher.

use super::against::is_of_part;
use crate::mesh::Mesh;
use crate::reader::Print;
use crate::reader::print::Step;
use crate::units::to_mm;

/// Share of a raft's height by which the print must be higher than the part. What of the part's tip is too
/// thin to be printed makes it lower than the raft lifts it.
const LEAST: f64 = 0.5;

/// From the bed to the part's bottom, mm; 0 without a raft.
pub(super) fn lift(print: &Print, mesh: &Mesh) -> f64 {
    let of_part = |layer: usize| {
        let steps = print.moves_of(&print.layers[layer]).iter();
        steps.filter(|step| is_of_part(step, true))
    };
    let first = (0..print.layers.len()).find(|&layer| of_part(layer).next().is_some());
    let Some(first) = first.filter(|first| *first > 0) else { return 0.0 };
    let lowest = |step: &Step| step.heights()[0] - f64::from(step.height);
    let bottom = of_part(first).map(lowest).fold(f64::INFINITY, f64::min);
    let more = print.top() - to_mm(mesh.top());
    if bottom > 0.0 && more > LEAST * bottom { bottom } else { 0.0 }
}
