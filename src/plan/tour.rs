//! Ordered paths -> ordered paths: runs of infill, skin or support in an order that takes less time.
//!
//! Going to the nearest leaves behind what must be fetched later from far away. Here
//! stretches of a run are turned round (Croes 1958) and short ones moved elsewhere
//! (Or 1976) while that makes the travels quicker. Where a run comes from and where
//! it leads stays, so that layers remain independent of each other.

use crate::fill::{Path, Place};
use crate::geom::Point;
use std::cell::LazyCell;
use std::ops::Range;

/// Stretches longer than this many paths are not turned, and paths moved no further:
/// what is far apart in the order seldom is near in place, and time must not grow with the square.
const REACH: usize = 30;

/// Paths moved at once, at most.
const LONGEST_MOVED: usize = 3;

/// Rounds over a run, at most.
const MOST_ROUNDS: usize = 2;

/// A change must save this much to be made, s: less is rounding.
const LEAST_GAIN: f64 = 1e-6;

/// What travels cost.
pub trait Cost {
    /// Time of the travel, at least, s. Quickly said.
    fn least(&self, from: Point, to: Point) -> f64;
    /// Time of the travel with what may come on top, s.
    fn whole(&self, from: Point, to: Point) -> f64;
    /// How far a travel of `time` s leads at most, grid units.
    fn reach(&self, time: f64) -> f64;
}

/// Improves the order of `paths`, which begins at `from`. The last path stays the last.
#[must_use]
pub fn improve(paths: Vec<Path>, from: Option<Point>, cost: &impl Cost) -> Vec<Path> {
    let runs = runs(&paths);
    let mut paths: Vec<Option<Path>> = paths.into_iter().map(Some).collect();
    for run in runs {
        let end = |p: &Option<Path>| p.as_ref().map(Path::end);
        let before = run.start.checked_sub(1).map_or(from, |k| end(&paths[k]));
        let after = paths.get(run.end).and_then(Option::as_ref).map(Path::start);
        let (Some(before), Some(after)) = (before, after) else { continue };
        let stop = |(index, p): (usize, &Path)| Stop {
            index,
            turned: false,
            start: p.start(),
            end: p.end(),
        };
        let stops = paths[run.clone()].iter().flatten().enumerate().map(stop).collect();
        let mut tour = Tour { stops, before, after, legs: Vec::new(), cost };
        tour.improve();
        let mut old: Vec<Option<Path>> = paths[run.clone()].iter_mut().map(Option::take).collect();
        for (slot, stop) in paths[run].iter_mut().zip(&tour.stops) {
            *slot = old[stop.index].take();
            if let Some(path) = slot.as_mut().filter(|_| stop.turned) {
                path.reverse();
            }
        }
    }
    paths.into_iter().flatten().collect()
}

/// Which paths may change places with `path`: those of the same kind; none with walls.
pub(super) fn free(path: &Path) -> Option<bool> {
    match path.role.facts().place {
        Place::Walls => None,
        Place::Inside => Some(false),
        Place::Helper => Some(true),
    }
}

/// Runs of paths whose order is free, of two and more, without the layer's last path.
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

/// A path in a tour.
#[derive(Debug, Clone, Copy)]
struct Stop {
    /// Its place in the order before.
    index: usize,
    /// Printed the other way round.
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

/// A travel: where it begins and ends.
type Leg = (Point, Point);

/// The paths of a run, from `before` to `after`.
struct Tour<'a, C> {
    stops: Vec<Stop>,
    before: Point,
    after: Point,
    /// Times of the travels to each stop, and of the last one.
    legs: Vec<f64>,
    cost: &'a C,
}

impl<C: Cost> Tour<'_, C> {
    /// Where the travel to stop `k` begins.
    fn from(&self, k: usize) -> Point {
        k.checked_sub(1).map_or(self.before, |k| self.stops[k].end)
    }

    /// Where the travel to stop `k` ends.
    fn to(&self, k: usize) -> Point {
        self.stops.get(k).map_or(self.after, |s| s.start)
    }

    /// Whether two new travels take less than `old` s, and less than that with what may
    /// come on top of them and of a third, whose least is in `old` already: `third` says what
    /// comes on top of that.
    ///
    /// Nearly all changes are refused by the first line: one of the new travels alone takes longer.
    #[inline]
    fn pays(&self, old: f64, new: [Leg; 2], third: impl Fn() -> f64) -> bool {
        let reach = self.cost.reach(old);
        let is_far = |(a, b): Leg| a.distance2(b) as f64 >= reach * reach;
        !is_far(new[0]) && !is_far(new[1]) && self.saves(old, new, third)
    }

    fn saves(&self, old: f64, new: [Leg; 2], third: impl Fn() -> f64) -> bool {
        let least = new.map(|leg| self.cost.least(leg.0, leg.1)).iter().sum::<f64>();
        // From what is quickly said to what is not.
        old - least > LEAST_GAIN
            && old - third() - least > LEAST_GAIN
            && old - third() - new.map(|leg| self.cost.whole(leg.0, leg.1)).iter().sum::<f64>()
                > LEAST_GAIN
    }

    fn measure(&mut self, legs: Range<usize>) {
        for k in legs {
            self.legs[k] = self.cost.whole(self.from(k), self.to(k));
        }
    }

    fn improve(&mut self) {
        let n = self.stops.len();
        self.legs = vec![0.0; n + 1];
        self.measure(0..n + 1);
        for _ in 0..MOST_ROUNDS {
            let mut better = false;
            for a in 0..n {
                for b in a..n.min(a + REACH) {
                    better |= self.turn(a, b);
                }
                for length in 1..=LONGEST_MOVED.min(n - a) {
                    better |= self.shift(a, a + length);
                }
            }
            if !better {
                break;
            }
        }
    }

    /// Turns round the stops from `a` to `b` if that pays.
    fn turn(&mut self, a: usize, b: usize) -> bool {
        let old = self.legs[a] + self.legs[b + 1];
        let new = [(self.from(a), self.stops[b].end), (self.stops[a].start, self.to(b + 1))];
        if !self.pays(old, new, || 0.0) {
            return false;
        }
        self.stops[a..=b].reverse();
        self.stops[a..=b].iter_mut().for_each(Stop::turn);
        self.measure(a..b + 2);
        true
    }

    /// Moves the stops from `a` up to `b` to where that pays, turned round or not.
    fn shift(&mut self, a: usize, b: usize) -> bool {
        let (first, last) = (self.stops[a].start, self.stops[b - 1].end);
        let gap = (self.from(a), self.to(b));
        // What it saves at most.
        let out = self.legs[a] + self.legs[b] - self.cost.least(gap.0, gap.1);
        if out <= LEAST_GAIN {
            return false;
        }
        let third = LazyCell::new(|| self.cost.whole(gap.0, gap.1) - self.cost.least(gap.0, gap.1));
        let near = a.saturating_sub(REACH)..(b + REACH).min(self.stops.len()) + 1;
        for k in near.filter(|k| !(a..=b).contains(k)) {
            let old = out + self.legs[k];
            let (from, to) = (self.from(k), self.to(k));
            let pays = |first, last| self.pays(old, [(from, first), (last, to)], || *third);
            let is_better = pays(first, last);
            if is_better || pays(last, first) {
                self.lift(a..b, k, !is_better);
                return true;
            }
        }
        false
    }

    /// Puts the stops of `range` before stop `k`, which is not one of them.
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
