//! A file's moves -> Half: what of one file is compared with a part of the other.
//!
//! Words used here: a *half* is what one file has of a pair of layers, of the start or of the end; the
//! *start* is all up to the last line that is drawn before the first layer, the *end* all after the last
//! line of the last layer.
//!
//! A half ends with its layer's last line, and begins where the one before ended: so the way to a
//! layer belongs to that layer, whether the file marks where layers begin or not.
//!
//! Places are seen from an *origin*. It lies at the layer's height, so that a file whose layers all
//! lie higher differs once and not in every line; and in a print that moved as a whole it has moved
//! along.

use super::line::{Line, Point, seen};
use super::sums;
use crate::reader::print::Step;
use crate::reader::{Patch, Role};

/// One file's part of a pair.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Half<'a> {
    pub(super) steps: &'a [Step],
    /// Counted from 1, the start being 0; `None` where the file has no such layer, and at the end.
    pub(super) number: Option<usize>,
    /// Height of the layer and how far it lies above the one before, mm.
    pub(super) level: Option<[f64; 2]>,
    /// Time, s.
    pub(super) seconds: f64,
    /// Where places are seen from, mm.
    pub(super) origin: Point,
    /// The file's patches of non-planar skin.
    pub(super) patches: &'a [Patch],
    /// The file's line with which the first layer begins, from 1.
    pub(super) first_line: u32,
}

impl Half<'_> {
    /// Its lines of this role.
    pub(super) fn lines(&self, role: Role, by_role: bool) -> Vec<Line> {
        let lines = self.steps.iter().filter(|step| step.is_line());
        let lines = lines.filter(|step| sums::role(step.role, by_role) == role);
        lines.map(|step| Line::new(step, self.origin)).collect()
    }

    /// All its lines, in their order.
    pub(super) fn all_lines(&self) -> Vec<Line> {
        let lines = self.steps.iter().filter(|step| step.is_line());
        lines.map(|step| Line::new(step, self.origin)).collect()
    }

    /// Its ways without a line, in their order.
    pub(super) fn travels(&self) -> Vec<Line> {
        let travels = self.steps.iter().filter(|step| is_travel(step));
        travels.map(|step| Line::way(step, self.origin)).collect()
    }

    /// Where the nozzle is before its first move.
    pub(super) fn begin(&self) -> Option<Line> {
        let first = self.steps.first()?;
        Some(Line::dot(seen(first.from, self.origin), first.line))
    }

    /// Lowest and highest z of its travels, mm.
    pub(super) fn travel_heights(&self) -> Option<[f64; 2]> {
        let heights = self.steps.iter().filter(|step| is_travel(step)).map(Step::heights);
        heights.reduce(|all, one| [all[0].min(one[0]), all[1].max(one[1])])
    }
}

/// Whether the nozzle moves without laying a line.
pub(super) fn is_travel(step: &Step) -> bool {
    !step.is_line() && step.from != step.to
}
