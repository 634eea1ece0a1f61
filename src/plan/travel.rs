//! Ordered paths -> print moves: improves the order, and decides for each travel how it goes.
//!
//! Plastic that oozes inside the part stays hidden. A travel that crosses an outer wall draws a
//! string on the outside. So travels retract if they cross a contour of the layer. Strings from one
//! piece of support to another do no harm. What oozes on a long way is missing where the next line begins, so that long travels
//! retract as well.
//!
//! A travel that would cross a contour goes round it instead, if that way is short enough to need no
//! retraction; see `detour`. Else it goes straight, after wiping the nozzle on the last line.
//!
//! The order is improved with the cost of straight travels. Detours would seldom change it, and each
//! costs many times as much to find as a crossing.

use super::crossings::Crossings;
use super::detour::detour;
use super::tour::{self, Cost};
use super::wipe::wipe;
use super::{Nozzle, PlanParams, PrintMove, Toolpath};
use crate::fill::{Path, Shape};
use crate::geom::{Contour, Point};
use crate::slice::Layer;
use crate::units::Coord;

/// The travels of one layer.
struct Travels<'a> {
    contours: &'a [Contour],
    crossings: Crossings,
    params: &'a PlanParams,
}

impl Travels<'_> {
    /// Whether a straight travel retracts.
    fn retracts(&self, from: Point, to: Point) -> bool {
        let square = from.distance2(to);
        let least = i64::from(self.params.min_travel).pow(2);
        let most = self.params.max_travel.map(|most| i64::from(most).pow(2));
        self.params.retracts
            && from != to
            && square >= least
            && (self.params.retract_always
                || most.is_some_and(|most| square > most)
                || self.crossings.leaves(from, to))
    }

    /// The way round, if that saves the retraction of a travel.
    fn detour(&self, from: Point, to: Point) -> Option<Vec<Point>> {
        let params = self.params.detour.as_ref()?;
        detour((from, to), self.contours, &self.crossings, params)
    }

    /// The travel to `path` from where the nozzle is; `last` is the path before it.
    fn to(&self, path: Path, at: Option<Point>, last: Option<&Path>) -> PrintMove {
        let Some(from) = at else {
            return PrintMove { retract: self.params.retracts, ..PrintMove::to(path) };
        };
        // Past its seam an outer wall hides what still comes out of the nozzle.
        let closed = last.filter(|last| last.shape == Shape::Loop { depth: 0 });
        let past = closed.map(|last| wipe(last, self.params.seam_wipe)).unwrap_or_default();
        let from = past.last().copied().unwrap_or(from);
        if !self.retracts(from, path.start()) {
            return PrintMove { via: past, ..PrintMove::to(path) };
        }
        if let Some(way) = self.detour(from, path.start()) {
            return PrintMove { via: [past, way].concat(), ..PrintMove::to(path) };
        }
        let most = self.params.wipe.max(if closed.is_some() { self.params.seam_wipe } else { 0 });
        let wipe = last.map(|last| wipe(last, most)).unwrap_or_default();
        PrintMove { retract: true, wipe, ..PrintMove::to(path) }
    }
}

impl Cost for Travels<'_> {
    fn least(&self, from: Point, to: Point) -> f64 {
        self.params.times.travel(from.distance(to))
    }

    fn whole(&self, from: Point, to: Point) -> f64 {
        let pull = if self.retracts(from, to) { self.params.times.retraction } else { 0.0 };
        self.least(from, to) + pull
    }

    fn reach(&self, time: f64) -> f64 {
        self.params.times.reach(time)
    }
}

/// The toolpath of a layer whose paths are sorted; `from` is where the nozzle is before it.
#[must_use]
pub fn toolpath(layer: &Layer, paths: Vec<Path>, from: Nozzle, params: &PlanParams) -> Toolpath {
    let moves = moves(paths, &layer.contours, from.at, params);
    Toolpath { layer: layer.index, z: layer.z, height: layer.height, from, moves }
}

/// Adds the paths of a patch of non-planar skin to the toolpath of the layer that they are printed on, in
/// their order. Each comes with the height over which the travel to it goes, as [`PrintMove::over`].
///
/// What oozes on a skin is seen, so that all travels retract that are long enough. The nozzle is not
/// wiped: the way back would run into the slope.
pub fn add_patch(
    toolpath: &mut Toolpath,
    patch: u32,
    paths: impl IntoIterator<Item = (Path, Coord)>,
    params: &PlanParams,
) {
    let mut at = toolpath.moves.last().map(|last| last.path.end()).or(toolpath.from.at);
    let least = i64::from(params.min_travel).pow(2);
    for (path, over) in paths {
        let far = |at: Point| at != path.start() && at.distance2(path.start()) >= least;
        let retract = params.retracts && at.is_none_or(far);
        at = Some(path.end());
        toolpath.moves.push(PrintMove { retract, over, patch: Some(patch), ..PrintMove::to(path) });
    }
}

/// Improves the order of the paths, starting from `at`, and decides for each how the travel to it
/// goes.
fn moves(
    paths: Vec<Path>,
    contours: &[Contour],
    at: Option<Point>,
    params: &PlanParams,
) -> Vec<PrintMove> {
    let travels = Travels { contours, crossings: Crossings::new(contours), params };
    let mut moves: Vec<PrintMove> = Vec::with_capacity(paths.len());
    let paths = if params.as_listed { paths } else { tour::improve(paths, at, &travels) };
    for path in paths {
        let last = moves.last().map(|last| &last.path);
        let next = travels.to(path, last.map(Path::end).or(at), last);
        moves.push(next);
    }
    moves
}
