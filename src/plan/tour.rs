//! Ordered paths -> ordered paths: reorders runs of infill, skin or support to shorten their travels.
//!
//! The nearest-first order leaves paths behind, and reaches them later by long travels.
//!
//! - A *run* is a row of paths whose order is free: skin and infill, or support. Walls stay.
//! - A *stop* is a path in a run, with its direction.
//! - A *leg* is the travel between two stops. Its cost is its time.
//!
//! Local search, for each run:
//! 1. Reverse a stretch of the run if that saves time (2-opt, Croes 1958).
//! 2. Move up to three stops elsewhere, reversed or not, if that saves time (Or-opt, Or 1976).
//! 3. Repeat over the whole run until nothing improves, or for two rounds.
//!
//! Nearly all changes are rejected by a bound that needs no square root. Only the few others compute
//! whether their legs retract. Where a run begins and ends stays, so that layers remain independent.

use crate::fill::{Order, Path, Role, Shape};
use crate::geom::Point;
use std::cell::LazyCell;
use std::ops::Range;

/// Longest stretch that is reversed, and greatest distance in the order by which stops are moved.
/// Paths far apart in the order are seldom near in place. A trade-off: time grows in proportion
/// to it, and without a limit with the square of the run; lower values miss improvements.
const REACH: usize = 30;

/// Most stops moved at once. Three is usual for Or-opt. More cost time for each place tried; fewer
/// leave small groups of paths behind.
const LONGEST_MOVED: usize = 3;

/// Most rounds over a run. A trade-off: each round costs the same time, and later ones have less to
/// improve.
const MOST_ROUNDS: usize = 2;

/// The least time that a change must save, s: far above the rounding of summed times and far below
/// any real travel. At 0, rounding could make two changes undo each other.
const LEAST_GAIN: f64 = 1e-6;

/// The cost of travels.
pub trait Cost {
    /// A lower bound for the time of a travel, s. Cheap to compute.
    fn least(&self, from: Point, to: Point) -> f64;
    /// Time of a travel with its retraction, if it has one, s.
    fn whole(&self, from: Point, to: Point) -> f64;
    /// An upper bound for the length of a travel that takes `time` s, grid units.
    fn reach(&self, time: f64) -> f64;
}

/// Improves the order of `paths`, starting from `from`. The last path stays the last.
#[must_use]
pub fn improve(paths: Vec<Path>, from: Option<Point>, cost: &impl Cost) -> Vec<Path> {
    let runs = runs(&paths);
    let mut paths: Vec<Option<Path>> = paths.into_iter().map(Some).collect();
    for run in runs {
        let end = |p: &Option<Path>| p.as_ref().map(Path::end);
        let before = run.start.checked_sub(1).map_or(from, |k| end(&paths[k]));
        let after = paths.get(run.end).and_then(Option::as_ref).map(Path::start);
        let (Some(before), Some(after)) = (before, after) else { continue };
        let place = |index, start, end| Stop { index, turned: false, start, end };
        let stop = |(index, p): (usize, &Path)| place(index, p.start(), p.end());
        let mut stops = vec![place(0, before, before)];
        stops.extend(paths[run.clone()].iter().flatten().enumerate().map(stop));
        stops.push(place(0, after, after));
        let mut tour = Tour { stops, legs: Vec::new(), cost };
        tour.improve();
        let mut old: Vec<Option<Path>> = paths[run.clone()].iter_mut().map(Option::take).collect();
        for (slot, stop) in paths[run].iter_mut().zip(&tour.stops[1..]) {
            *slot = old[stop.index].take();
            if let Some(path) = slot.as_mut().filter(|_| stop.turned) {
                path.reverse();
            }
        }
    }
    paths.into_iter().flatten().collect()
}

/// Paths that may change places with each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Group {
    /// Skin and infill, whose order shows nowhere.
    Inside,
    /// What is seen from above: the nozzle goes over it no more when it is laid last.
    Top,
    /// Support.
    Helpers,
}

/// The group within which `path` may change places; `None` for what stays: walls, and what has its turn.
pub(super) fn free(path: &Path) -> Option<Group> {
    if matches!(path.shape, Shape::InTurn { .. }) {
        return None;
    }
    match path.role.facts().order {
        Order::Walls | Order::First | Order::Last => None,
        Order::Inside if path.role == Role::TopSkin => Some(Group::Top),
        Order::Inside => Some(Group::Inside),
        Order::Helper => Some(Group::Helpers),
    }
}

/// Runs of at least two paths whose order is free. The layer's last path is in none.
fn runs(paths: &[Path]) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut start = 0;
    for run in paths.chunk_by(|a, b| free(a) == free(b)) {
        let end = (start + run.len()).min(paths.len().saturating_sub(1));
        if run.first().is_some_and(|p| free(p).is_some()) && end >= start + 2 {
            runs.push(start..end);
        }
        start += run.len();
    }
    runs
}

/// A path of a run.
#[derive(Debug, Clone, Copy)]
struct Stop {
    /// Its index in the order before.
    index: usize,
    /// It is printed in reverse.
    turned: bool,
    start: Point,
    end: Point,
}

impl Stop {
    fn turn(&mut self) {
        self.turned = !self.turned;
        std::mem::swap(&mut self.start, &mut self.end);
    }
}

/// Start and end of a travel.
type Leg = (Point, Point);

/// The paths of a run.
struct Tour<'a, C> {
    /// The paths, between two places as stops that stay: where the run begins, and where it leads to. So
    /// every travel has a stop before it and one after it.
    stops: Vec<Stop>,
    /// Time of the travel to each stop. None leads to the first.
    legs: Vec<f64>,
    cost: &'a C,
}

impl<C: Cost> Tour<'_, C> {
    /// The travel to stop `k`.
    fn leg(&self, k: usize) -> Leg {
        (self.stops[k - 1].end, self.stops[k].start)
    }

    /// The squared distance from which on one new travel alone takes longer than `old` s.
    #[inline]
    fn reach2(&self, old: f64) -> f64 {
        let reach = self.cost.reach(old);
        reach * reach
    }

    /// Whether a change saves time: it removes travels of `old` s and adds the two travels `new`.
    /// A move of stops adds a third one. Its lower bound is subtracted from `old` already, and
    /// `third` returns its retraction. `reach2` is that of `old`.
    ///
    /// The first lines reject nearly all changes: one new travel alone takes longer than `old`.
    #[inline]
    fn pays(&self, (old, reach2): (f64, f64), new: [Leg; 2], third: impl Fn() -> f64) -> bool {
        let is_far = |(a, b): Leg| a.distance2(b) as f64 >= reach2;
        !is_far(new[0]) && !is_far(new[1]) && self.saves(old, new, third)
    }

    fn saves(&self, old: f64, new: [Leg; 2], third: impl Fn() -> f64) -> bool {
        let least = new.map(|leg| self.cost.least(leg.0, leg.1)).iter().sum::<f64>();
        // From the cheap bounds to the exact costs.
        old - least > LEAST_GAIN
            && old - third() - least > LEAST_GAIN
            && old - third() - new.map(|leg| self.cost.whole(leg.0, leg.1)).iter().sum::<f64>()
                > LEAST_GAIN
    }

    fn measure(&mut self, legs: Range<usize>) {
        for k in legs {
            let (from, to) = self.leg(k);
            self.legs[k] = self.cost.whole(from, to);
        }
    }

    fn improve(&mut self) {
        let last = self.stops.len() - 1;
        self.legs = vec![0.0; last + 1];
        self.measure(1..last + 1);
        for _ in 0..MOST_ROUNDS {
            let mut better = false;
            for a in 1..last {
                for b in a..last.min(a + REACH) {
                    better |= self.turn(a, b);
                }
                for length in 1..=LONGEST_MOVED.min(last - a) {
                    better |= self.shift(a, a + length);
                }
            }
            if !better {
                break;
            }
        }
    }

    /// Reverses the stops from `a` to `b` if that saves time.
    fn turn(&mut self, a: usize, b: usize) -> bool {
        let old = self.legs[a] + self.legs[b + 1];
        let ((from, first), (last, to)) = (self.leg(a), self.leg(b + 1));
        if !self.pays((old, self.reach2(old)), [(from, last), (first, to)], || 0.0) {
            return false;
        }
        self.stops[a..=b].reverse();
        self.stops[a..=b].iter_mut().for_each(Stop::turn);
        self.measure(a..b + 2);
        true
    }

    /// Moves the stops `a..b` to the first place that saves time, reversed or not.
    fn shift(&mut self, a: usize, b: usize) -> bool {
        let (first, last) = (self.stops[a].start, self.stops[b - 1].end);
        let gap = (self.stops[a - 1].end, self.stops[b].start);
        // An upper bound for the time saved by taking them out.
        let out = self.legs[a] + self.legs[b] - self.cost.least(gap.0, gap.1);
        if out <= LEAST_GAIN {
            return false;
        }
        let third = LazyCell::new(|| self.cost.whole(gap.0, gap.1) - self.cost.least(gap.0, gap.1));
        let saves = |k: usize| {
            let old = out + self.legs[k];
            let (old, (from, to)) = ((old, self.reach2(old)), self.leg(k));
            let pays = |first, last| self.pays(old, [(from, first), (last, to)], || *third);
            if pays(first, last) {
                Some((k, false))
            } else {
                pays(last, first).then_some((k, true))
            }
        };
        let (low, high) = (a.saturating_sub(REACH).max(1), (b + REACH).min(self.stops.len() - 1));
        let found = (low..a).find_map(saves).or_else(|| (b + 1..high + 1).find_map(saves));
        let Some((k, turned)) = found else { return false };
        self.lift(a..b, k, turned);
        true
    }

    /// Moves the stops of `range` before stop `k`, which is not one of them.
    fn lift(&mut self, range: Range<usize>, k: usize, turned: bool) {
        if turned {
            self.stops[range.clone()].reverse();
            self.stops[range.clone()].iter_mut().for_each(Stop::turn);
        }
        let span = range.start.min(k)..range.end.max(k);
        if k < range.start {
            self.stops[span.clone()].rotate_right(range.len());
        } else {
            self.stops[span.clone()].rotate_left(range.len());
        }
        self.measure(span.start..span.end + 1);
    }
}
