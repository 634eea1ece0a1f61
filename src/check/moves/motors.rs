//! Move + motors -> finding: feeds at which a motor would have to step faster than it can.

use crate::check::finding::{Code, Finding};
use crate::check::terms::Machine;
use crate::reader::print::Step;

/// Shorter moves are not judged, mm: their speed and flow are mostly rounding.
pub(crate) const LEAST_LENGTH: f64 = 0.2;

/// Factor by which speeds may exceed the limit: they are rounded, too.
pub(crate) const SPEED_SLACK: f64 = 1.01;

/// What a move asks too much of a motor. A planner holds each axis to its speed; a board that takes steps is
/// sent fewer of them.
pub(crate) fn too_many_steps(step: &Step, machine: Option<&Machine>) -> Option<Finding> {
    let machine = machine.filter(|machine| machine.steps != [None; 4])?;
    let way = |axis: usize| (f64::from(step.to[axis]) - f64::from(step.from[axis])).abs();
    let ways = [way(0), way(1), way(2), f64::from(step.filament).abs()];
    let length = if step.length() > 0.0 { step.length() } else { ways[3] };
    if length < LEAST_LENGTH {
        return None;
    }
    let feed = ways.iter().zip(machine.speed).fold(f64::from(step.feed), |feed, (way, most)| {
        if *way > 0.0 { feed.min(most * length / way) } else { feed }
    });
    machine.steps.into_iter().enumerate().find_map(|(axis, motor)| {
        let [per_mm, most] = motor?;
        let rate = ways[axis] / length * feed * per_mm;
        let axis = ["x", "y", "z", "e"][axis];
        let text = format!("{rate:.0} steps/s of {axis}, where its motor makes {most:.0}");
        let finding = Finding::warning(Code::TooManySteps, rate, "steps/s", text);
        (rate > most * SPEED_SLACK).then_some(finding)
    })
}
