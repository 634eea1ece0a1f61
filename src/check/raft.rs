use super::survey::Survey;
use crate::mesh::Mesh;
use crate::units::to_mm;

/// Share of a raft's height by which the print must be higher than the part. What of the part's tip is too
/// thin to be printed makes it lower than the raft lifts it.
const LEAST: f64 = 0.5;

/// From the bed to the part's bottom, mm; 0 without a raft.
pub(super) fn lift(survey: &Survey, mesh: &Mesh) -> f64 {
    let first = survey.bottoms.iter().position(|bottom| bottom.is_finite());
    let Some(first) = first.filter(|first| *first > 0) else { return 0.0 };
    let bottom = survey.bottoms[first];
    let more = survey.top - to_mm(mesh.top());
    if bottom > 0.0 && more > LEAST * bottom { bottom } else { 0.0 }
}
