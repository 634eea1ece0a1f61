//! Bytes, Print and Estimate of a file -> Side: a file as it is compared, and its halves of pairs.

use super::align::Level;
use super::codes::{self, Code};
use super::half::{Half, ends};
use super::moved::Floor;
use super::sums::{self, Measure};
use crate::estimate::Estimate;
use crate::reader::print::{Layer, Step};
use crate::reader::{Print, Role};

/// A file as it is compared.
#[derive(Debug)]
pub struct Side {
    pub(super) print: Print,
    pub(super) estimate: Estimate,
    /// Its layers, from the bed up.
    pub(super) floors: Vec<Floor>,
    /// Whether the file gives roles of lines.
    pub(super) has_roles: bool,
    /// What comes before the first line, in each layer, and after the last line.
    codes: Vec<Vec<Code>>,
    /// Where the halves of the start and of each layer end in the moves.
    ends: Vec<usize>,
}

impl Side {
    /// A file of these bytes, read as `print` and timed as `estimate`. Both files are to be
    /// timed with the same limits.
    #[must_use]
    pub fn new(bytes: &[u8], print: Print, estimate: Estimate) -> Self {
        let codes = codes::by_layer(bytes, &print);
        let ranges = print.layers.iter().map(|layer| &layer.moves);
        let ends = ends(&print.moves, ranges, &print.start);
        let floor = |layer: &Layer| {
            let Layer { z, height, .. } = *layer;
            let extent = Measure::new(print.moves_of(layer), true).extent;
            Floor { level: Level { z, height }, extent }
        };
        let floors = print.layers.iter().map(floor).collect();
        let mut moves = print.moves.iter();
        let has_roles = moves
            .any(|step| !matches!(step.role, Role::Other | Role::Travel | Role::Retraction));
        Self { codes, ends, floors, has_roles, print, estimate }
    }

    /// Time of a role in the whole file, s.
    pub(super) fn seconds(&self, role: Role, by_role: bool) -> f64 {
        let roles = self.estimate.roles.iter();
        let own = roles.filter(|one| sums::role(one.role, by_role) == role);
        own.fold(0.0, |sum, one| sum + one.seconds)
    }

    /// What comes before the first layer.
    pub(super) fn start(&self) -> Half<'_> {
        Half {
            steps: self.steps(0),
            number: Some(0),
            seconds: self.estimate.start_seconds,
            first_line: self.first_line(),
            ..Half::default()
        }
    }

    /// A layer, counted from 0. The print as a whole has moved by `by`, mm.
    pub(super) fn layer(&self, index: Option<usize>, by: [f64; 2]) -> Half<'_> {
        let layer = index.and_then(|index| Some((index, self.floors.get(index)?)));
        let Some((index, floor)) = layer else { return Half::default() };
        let time = self.estimate.layers.get(index);
        Half {
            steps: self.steps(index + 1),
            number: Some(index + 1),
            level: Some([floor.level.z, floor.level.height]),
            seconds: time.map_or(0.0, |time| time.seconds),
            origin: [by[0], by[1], floor.level.z],
            first_line: self.first_line(),
        }
    }

    /// What comes after the last line.
    pub(super) fn end(&self) -> Half<'_> {
        let first = self.ends.last().copied().unwrap_or_default();
        let steps = self.print.moves.get(first..).unwrap_or_default();
        Half { steps, first_line: self.first_line(), ..Half::default() }
    }

    /// Commands before the first line, or of a layer counted from 1.
    pub(super) fn codes(&self, number: Option<usize>) -> &[Code] {
        number.and_then(|number| self.codes.get(number)).map_or(&[], Vec::as_slice)
    }

    /// Commands after the last line.
    pub(super) fn last_codes(&self) -> &[Code] {
        self.codes.last().map_or(&[], Vec::as_slice)
    }

    fn steps(&self, half: usize) -> &[Step] {
        let from = half.checked_sub(1).and_then(|before| self.ends.get(before));
        let range = from.copied().unwrap_or(0)..self.ends.get(half).copied().unwrap_or(0);
        self.print.moves.get(range).unwrap_or_default()
    }

    /// The file's line with which the first layer begins, from 1.
    fn first_line(&self) -> u32 {
        self.print.moves.get(self.print.start.end).map_or(u32::MAX, |step| step.line)
    }
}
