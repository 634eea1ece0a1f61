//! Moves of a layer -> its chains, and where a line runs on another.

use super::bead::Bead;
use crate::reader::Role;
use crate::reader::print::Step;
use std::ops::Range;

/// A line runs on another where their cores meet, which are this part of their widths: neighbours
/// overlap by less, turns of a zigzag by more.
pub(crate) const CORE: f64 = 0.4;

/// Heights of lines that differ by less are the same, mm: positions are rounded to this or less.
pub(crate) const SAME_HEIGHT: f64 = 0.01;

/// The chains of a layer's moves.
pub(crate) fn chains_of(moves: &[Step]) -> impl Iterator<Item = Range<usize>> {
    let mut next = 0;
    let chains = moves.chunk_by(|a, b| {
        a.is_line() && b.is_line() && a.to == b.from && is_ironing(a) == is_ironing(b)
    });
    let chains = chains.map(move |chain| {
        let first = next;
        next += chain.len();
        first..next
    });
    chains.filter(|chain| moves[chain.start].is_line())
}

/// Whether a line lies on purpose on others of its layer.
pub(crate) fn is_ironing(step: &Step) -> bool {
    step.role == Role::Ironing
}

/// What of a line runs on another, at its height.
pub(crate) fn runs_on(bead: &Bead, other: &Bead) -> Option<[f64; 2]> {
    if bead.is_level() && other.is_level() {
        let is_as_high = (other.middle() - bead.middle()).abs() < SAME_HEIGHT;
        return if is_as_high { bead.way(other, CORE * other.radius) } else { None };
    }
    let [from, to] = bead.way(other, CORE * other.radius)?;
    (bead.above(other, 0.5 * (from + to)).abs() < SAME_HEIGHT).then_some([from, to])
}
