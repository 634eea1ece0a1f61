//! Ordered paths -> print moves: improves the order, and decides which travels retract.
//!
//! Plastic that oozes inside the part stays hidden. A travel that crosses an outer wall draws a
//! string on the outside. So travels retract if they cross a contour of the layer or lie outside
//! all of them.
//!
//! The edges of a layer are sorted into bands of y. A travel is tested only against the edges of the
//! bands that it passes through.

use super::tour::{self, Cost};
use super::{Head, PlanParams, PrintMove, Toolpath};
use crate::fill::Path;
use crate::geom::cells::Cells;
use crate::geom::{Contour, Point, edges, encloses, side};
use crate::slice::Layer;
use crate::units::Coord;

/// Most bands of a layer. A trade-off: with more bands a travel is tested against fewer edges, but a
/// steep edge is stored in each band that it reaches into. The result does not depend on it.
const MOST_BANDS: usize = 256;

/// The travels of one layer.
struct Travels<'a> {
    crossings: Crossings,
    params: &'a PlanParams,
}

impl Travels<'_> {
    /// Whether a travel retracts.
    fn retracts(&self, from: Point, to: Point) -> bool {
        let least = i64::from(self.params.min_travel).pow(2);
        self.params.retracts
            && from != to
            && from.distance2(to) >= least
            && (self.params.retract_always || self.crossings.leaves(from, to))
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

/// The toolpath of a layer whose paths are sorted; `from` is the head before it.
#[must_use]
pub fn toolpath(layer: &Layer, paths: Vec<Path>, from: Head, params: &PlanParams) -> Toolpath {
    let moves = moves(paths, &layer.contours, from.at, params);
    Toolpath { layer: layer.index, z: layer.z, height: layer.height, from, moves }
}

/// Improves the order of the paths, starting from `at`, and decides for each whether the travel to
/// it retracts.
fn moves(
    paths: Vec<Path>,
    contours: &[Contour],
    mut at: Option<Point>,
    params: &PlanParams,
) -> Vec<PrintMove> {
    let travels = Travels { crossings: Crossings::new(contours), params };
    tour::improve(paths, at, &travels)
        .into_iter()
        .map(|path| {
            let to = path.start();
            let retract = match at {
                Some(from) => travels.retracts(from, to),
                None => params.retracts,
            };
            at = Some(path.end());
            PrintMove { retract, path }
        })
        .collect()
}

/// A layer's edges in bands of y: finds those that a travel may cross.
struct Crossings {
    low: Coord,
    /// Each band is 2 to the power of `shift` high.
    shift: u32,
    bands: Cells<(Point, Point)>,
}

impl Crossings {
    fn new(contours: &[Contour]) -> Self {
        let points = || contours.iter().flatten();
        let low = points().map(|p| p.y).min().unwrap_or(0);
        let high = points().map(|p| p.y).max().unwrap_or(0);
        let wished = points().count().div_ceil(4).clamp(1, MOST_BANDS);
        let shift = (0..Coord::BITS).find(|&shift| ((high - low) >> shift) < wished as Coord);
        let shift = shift.unwrap_or_default();
        let band = |y: Coord| ((y - low) >> shift) as usize;
        let edges = || contours.iter().flat_map(|c| edges(c));
        let reach = |(a, b): (Point, Point)| band(a.y.min(b.y))..band(a.y.max(b.y)) + 1;
        Self { low, shift, bands: Cells::new(band(high) + 1, edges, reach) }
    }

    /// Whether the travel from `a` to `b` crosses an edge or lies outside the contours.
    fn leaves(&self, a: Point, b: Point) -> bool {
        let last = self.bands.count() - 1;
        let band = |y: Coord| (((y - self.low).max(0) >> self.shift) as usize).min(last);
        let touched = self.bands.of(band(a.y.min(b.y))..band(a.y.max(b.y)) + 1);
        touched.iter().any(|&(p, q)| meet(a, b, p, q)) || !self.holds(a)
    }

    /// Whether `p` is inside the contours, which do not overlap.
    fn holds(&self, p: Point) -> bool {
        let Ok(k) = usize::try_from((p.y - self.low) >> self.shift) else { return false };
        k < self.bands.count() && encloses(self.bands.of(k..k + 1).iter().copied(), p)
    }
}

/// Whether segments a–b and p–q share a point.
fn meet(a: Point, b: Point, p: Point, q: Point) -> bool {
    let (x1, x2) = (a.x.min(b.x), a.x.max(b.x));
    if p.x.max(q.x) < x1 || p.x.min(q.x) > x2 {
        return false;
    }
    let (y1, y2) = (a.y.min(b.y), a.y.max(b.y));
    if p.y.max(q.y) < y1 || p.y.min(q.y) > y2 {
        return false;
    }
    let (p_side, q_side) = (side(a, b, p).signum(), side(a, b, q).signum());
    let (a_side, b_side) = (side(p, q, a).signum(), side(p, q, b).signum());
    p_side * q_side <= 0 && a_side * b_side <= 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: Coord, high: Coord, hole: bool) -> Contour {
        let p = |x, y| Point { x, y };
        let mut square = vec![p(low, low), p(high, low), p(high, high), p(low, high)];
        if hole {
            square.reverse();
        }
        square
    }

    #[test]
    fn travels_leave_if_they_cross_a_contour_or_lie_outside() {
        let crossings = Crossings::new(&[square(0, 1000, false), square(400, 600, true)]);
        let p = |x, y| Point { x, y };
        for (a, b, leaves) in [
            (p(100, 100), p(900, 100), false),
            (p(100, 100), p(100, 900), false),
            (p(100, 500), p(900, 500), true),
            (p(100, 100), p(1100, 100), true),
            (p(-200, 500), p(-100, 500), true),
            (p(450, 450), p(550, 550), true),
            (p(-500, -500), p(5000, -400), true),
        ] {
            assert_eq!(crossings.leaves(a, b), leaves, "{a:?} to {b:?}");
            assert_eq!(crossings.leaves(b, a), leaves, "{b:?} to {a:?}");
        }
    }

    #[test]
    fn without_contours_every_travel_lies_outside() {
        let crossings = Crossings::new(&[]);
        assert!(crossings.leaves(Point { x: 1, y: 2 }, Point { x: 3, y: -4 }));
    }
}
