//! Two halves -> TravelsOfPair: where the nozzle goes without a line, how high, and what is pulled back.
//!
//! Words used here: a *travel* is a move that lays no line but goes somewhere, up and down as well; a
//! *way* is all travels of a half one after the other; *pulled* is filament that goes back, *pushed*
//! what comes again without a line.
//!
//! A travel can hit what stands in its way, so that its places count like those of lines, in all three
//! axes. What is compared is first the way in its order; mostly it is the same, and nothing else is
//! to do. Otherwise the places count, whatever their order: what of a travel is farther than the
//! tolerance from all travels of the other file is far. If nothing is, only the order differs.
//!
//! A print that moved as a whole does not take along the places that its start and end blocks go to.
//! So each coordinate may be either where it was or where it moved to.

use super::apart::{Apart, SLACK, apart};
use super::half::{Half, is_travel};
use super::line::{Line, Point};
use super::place::{Place, farthest};
use super::sums::{Both, Sum};
use super::way::parting;
use super::{LEAST_FILAMENT, Tolerances};
use crate::reader::print::Step;
use schemars::JsonSchema;
use serde::Serialize;

/// What the nozzle does between the lines of both files.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TravelsOfPair {
    /// Length of the ways, mm.
    pub length_mm: Both<f64>,
    /// Lowest and highest z of the nozzle, mm; `None` without a travel.
    pub z_mm: Both<Option<[f64; 2]>>,
    /// Length of each file's travels that is farther than the tolerance from all travels of the
    /// other file there, mm.
    pub far_mm: Both<f64>,
    /// The place that is farthest from the other file's travels; `None` if none is too far.
    pub farthest: Option<Place>,
    /// The file's lines from which on the travels are no longer the same in the same order.
    pub other_from: Option<Both<u32>>,
    /// If the lines are the same, but in another order: the file's lines from which on.
    pub lines_other_from: Option<Both<u32>>,
    /// Filament that is pulled back, mm.
    pub pulled_mm: Sum,
    /// Filament that is pushed out without a line, mm.
    pub pushed_mm: Sum,
    /// Whether the farthest place lies before the first layer in both files.
    #[serde(skip)]
    pub(super) is_before_layers: bool,
    /// Whether the lines of the layer are the same, in any order.
    #[serde(skip)]
    pub(super) has_same_lines: bool,
}

impl TravelsOfPair {
    /// Whether the nozzle goes where it does in the other file.
    pub(super) fn is_far(&self) -> bool {
        self.far_mm.a + self.far_mm.b > 0.0
    }

    /// Whether the travels of the files reach as low and as high. `z` is the height of both layers.
    pub(super) fn is_as_high(&self, z: Both<f64>, tolerance: f64) -> bool {
        let Both { a: Some(a), b: Some(b) } = self.z_mm else { return self.z_mm.a == self.z_mm.b };
        let apart = |k: usize| ((a[k] - z.a) - (b[k] - z.b)).abs();
        apart(0).max(apart(1)) <= tolerance + SLACK
    }
}

/// Compares the travels of two halves. `slack`, mm, is how far layers lie apart in z here and
/// before; `moved` is how far the second print moved as a whole.
pub(super) fn compare(
    halves: Both<&Half<'_>>,
    tolerances: &Tolerances,
    slack: f64,
    moved: Option<Point>,
) -> TravelsOfPair {
    let reach = tolerances.place + slack;
    let travels = halves.map(Half::travels);
    let length = |lines: &[Line]| lines.iter().fold(0.0, |sum, line| sum + line.length);
    let mut other_from = other_from(travels.as_ref().map(Vec::as_slice), reach);
    if moved.is_some_and(|by| stays_or_moves(halves, by, reach)) {
        other_from = None;
    }
    let mut found = [Apart::default(); 2];
    if other_from.is_some() {
        // Both begin somewhere, so that the first travel of one alone has a place to be far from.
        let with_begin = |half: &Half<'_>, travels: &[Line]| {
            half.begin().into_iter().chain(travels.iter().copied()).collect::<Vec<Line>>()
        };
        let all = Both { a: with_begin(halves.a, &travels.a), b: with_begin(halves.b, &travels.b) };
        found = [
            apart(&travels.a, &all.b, reach, tolerances.share),
            apart(&travels.b, &all.a, reach, tolerances.share),
        ];
    }
    let [one, other] = found;
    let filament = halves.map(|half| amounts(half.steps));
    let sum = |k: usize| Sum::new(filament.a[k], filament.b[k], tolerances.share, LEAST_FILAMENT);
    let farthest = farthest(&one, &other, halves);
    let is_before =
        |place: &Place| place.line.a < halves.a.first_line && place.line.b < halves.b.first_line;
    TravelsOfPair {
        is_before_layers: farthest.as_ref().is_some_and(is_before),
        length_mm: travels.as_ref().map(|travels| length(travels)),
        z_mm: halves.map(Half::travel_heights),
        far_mm: Both { a: one.far, b: other.far },
        farthest,
        other_from,
        lines_other_from: None,
        has_same_lines: true,
        pulled_mm: sum(0),
        pushed_mm: sum(1),
    }
}

/// The file's lines from which on two lists of lines are no longer one way.
pub(super) fn other_from(lines: Both<&[Line]>, reach: f64) -> Option<Both<u32>> {
    let (a, b) = parting(lines.a, lines.b, reach + SLACK)?;
    let number = |lines: &[Line], at: usize| {
        lines.get(at).or(lines.last()).map_or(0, |line: &Line| line.number)
    };
    Some(Both { a: number(lines.a, a), b: number(lines.b, b) })
}

/// Whether all travels end where they did, or moved along with the print.
fn stays_or_moves(halves: Both<&Half<'_>>, by: Point, reach: f64) -> bool {
    let travels = halves.map(|half| half.steps.iter().filter(|step| is_travel(step)));
    let reach = reach + SLACK;
    let same = |a: &Step, b: &Step| {
        (0..3).all(|axis| {
            let apart = f64::from(b.to[axis]) - f64::from(a.to[axis]);
            apart.abs() <= reach || (apart - by[axis]).abs() <= reach
        })
    };
    travels.a.clone().count() == travels.b.clone().count()
        && travels.a.zip(travels.b).all(|(a, b)| same(a, b))
}

/// Filament that goes back, and that comes without a line, mm.
fn amounts(steps: &[Step]) -> [f64; 2] {
    let mut amounts = [0.0; 2];
    for step in steps.iter().filter(|step| !step.is_line()) {
        amounts[usize::from(step.filament > 0.0)] += f64::from(step.filament.abs());
    }
    amounts
}
