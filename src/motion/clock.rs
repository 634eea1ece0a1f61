//! Moves, one after the other -> the time of each, in the same order.
//!
//! Words used here: a *block* is a move with the limits that hold for it; *entry* and *exit* are its
//! speeds at its two ends; a *corner* is where two moves meet; a block is *settled* when its entry
//! and exit are final and its time is known.
//!
//! A move that comes in gets the highest speed of the corner before it ([`super::junction`]). It
//! waits in a queue until a pass back over the queue ([`plan`]) gives it an entry from which
//! everything after it can still slow down in time. Then it is settled:
//! - with a look-ahead of n moves, as Marlin and Sailfish have, the oldest is settled when n are
//!   there, with the youngest ending at rest;
//! - for a whole file the pass runs once a batch, and settles all blocks that no later move can
//!   slow down any more. The batch grows with what is left over, so that each block is planned a
//!   few times at most and the work stays linear.
//!
//! Speeds are kept squared: at constant acceleration the square changes evenly along the path.

use super::block::{Block, Course, Reach};
use super::limits::Rates;
use super::plan::{self, Top};
use super::queue::Queue;
use super::{Junction, Limits, Move, junction};
use crate::units::Bounded as _;
use std::vec::Drain;

/// Blocks that are planned at once where the planner knows the whole file: enough
/// for the pass back to be rare, few enough to stay in the cache. It changes no time.
const BATCH: usize = 256;

/// How long a move takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timed<T> {
    /// Its time, s.
    pub seconds: f64,
    /// Highest speed that it reaches, mm/s; 0 for a dwell.
    pub peak: f64,
    /// Speed at which it begins, mm/s.
    pub entry: f64,
    /// Speed at which it ends, mm/s.
    pub exit: f64,
    /// How hard it speeds up and slows down, mm/s²; 0 for what takes no way.
    pub acceleration: f64,
    /// The tag that the move was pushed with.
    pub tag: T,
}

/// Times moves. Memory does not grow with the number of moves as long as
/// [`Clock::drain`] is called now and then.
///
/// ```
/// use slicer::motion::{Clock, Junction, Limits, Move};
/// use slicer::units::MmPerS;
/// let limits = Limits {
///     feed: [300.0; 4],
///     acceleration: [1000.0; 4],
///     print_acceleration: 1000.0,
///     travel_acceleration: 1000.0,
///     retract_acceleration: 1000.0,
///     junction: Junction::Jerk([0.0; 4]),
///     look_ahead: None,
///     minimum_speed: 0.0,
/// };
/// let mut clock = Clock::new(limits);
/// clock.push(Move { delta: [100.0, 0.0, 0.0, 0.0], feed: MmPerS(100.0), tag: "there" });
/// clock.finish();
/// let seconds: f64 = clock.drain().map(|timed| timed.seconds).sum();
/// // A tenth of a second longer than at full speed all the way.
/// assert!((seconds - 1.1).abs() < 1e-9);
/// ```
#[derive(Debug, Clone)]
pub struct Clock<T> {
    rates: Rates,
    /// The last move that has a length, if the printer has not stood still since.
    before: Option<Course>,
    pending: Queue<Block<T>>,
    /// How many pending blocks make planning worth while.
    batch: usize,
    done: Vec<Timed<T>>,
}

impl<T: Copy> Clock<T> {
    /// A clock for a machine that stands still.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        let rates = Rates::new(limits);
        Self { rates, before: None, pending: Queue::default(), batch: BATCH, done: Vec::new() }
    }

    /// The limits in force.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.rates.limits
    }

    /// Changes the limits for all moves from now on; the machine does not stop for it.
    pub fn set_limits(&mut self, limits: Limits) {
        self.rates = Rates::new(limits);
    }

    /// As [`Self::set_limits`], of limits that are ready. The rule for corners is that of before.
    pub fn switch(&mut self, rates: &Rates) {
        self.rates.clone_from(rates);
    }

    /// The next move. One whose length is 0 or not finite takes no time.
    pub fn push(&mut self, given: Move<T>) {
        let Some(mut course) = Course::new(&given, &self.rates) else {
            return self.push_empty(given.tag);
        };
        let corner = self.corner(&mut course);
        let before = self.reach().unwrap_or(Reach { full: corner, smooth: corner });
        let block = Block::new(&course, corner, before, self.rates.sprint, given.tag);
        self.before = Some(course);
        self.pending.push(block);
        self.plan();
    }

    /// The printer stands still for this long, once the moves so far have ended.
    pub fn dwell(&mut self, seconds: f64, tag: T) {
        self.stop();
        self.done.push(standing(seconds, tag));
    }

    /// The printer comes to rest before anything else happens.
    pub fn stop(&mut self) {
        self.before = None;
        match self.rates.limits.junction {
            Junction::SquareCorner { .. } => {
                plan::back_smoothly(&mut self.pending);
                self.settle_smoothly(self.pending.len());
            }
            _ => {
                plan::back(&mut self.pending);
                self.settle(self.pending.len());
            }
        }
    }

    /// The file is at its end: all moves are settled.
    pub fn finish(&mut self) {
        self.stop();
    }

    /// The moves settled since the last call, in their order.
    pub fn drain(&mut self) -> Drain<'_, Timed<T>> {
        self.done.drain(..)
    }

    fn push_empty(&mut self, tag: T) {
        match self.reach() {
            // It waits for the moves before it, so that the order is kept.
            Some(reach) => self.pending.push(Block::empty(reach, tag)),
            None => self.done.push(standing(0.0, tag)),
        }
    }

    /// How fast the pending moves may end; `None` if there are none.
    fn reach(&self) -> Option<Reach> {
        self.pending.last().map(Block::reach)
    }

    /// How fast the corner before `course` may be taken, squared.
    fn corner(&self, course: &mut Course) -> f64 {
        let Some(before) = &self.before else { return course.rest * course.rest };
        let limits = &self.rates.limits;
        let corner = match &limits.junction {
            Junction::Jerk(_) => {
                let speed = junction::jerk(before, course, &self.rates.jerk_inverse);
                speed * speed
            }
            Junction::VectorJerk(_) => {
                let speed = junction::vector_jerk(before, course, &self.rates.jerk_inverse);
                speed * speed
            }
            Junction::SpeedChange(most) => {
                course.slowed = junction::speed_change(before, course, most);
                let speed = course.cruise * course.slowed;
                speed * speed
            }
            Junction::Deviation(_) => junction::deviation(before, course, &limits.acceleration),
            Junction::SquareCorner { extruder_corner_velocity, .. } => {
                junction::square_corner(before, course, *extruder_corner_velocity)
            }
        };
        let cruise = before.cruise.at_most(course.cruise);
        let least = limits.minimum_speed;
        // `max` replaces a NaN, which limits that are not finite can make.
        corner.max(least * least).at_most(cruise * cruise)
    }

    /// Plans the pending blocks and settles those whose plan is final.
    fn plan(&mut self) {
        let smooth = matches!(self.rates.limits.junction, Junction::SquareCorner { .. });
        if let (Some(most), false) = (self.rates.limits.look_ahead, smooth) {
            let least = self.rates.limits.minimum_speed;
            plan::back_from_last(&mut self.pending, least * least);
            while self.pending.len() >= most.max(2) {
                self.settle(1);
                plan::settle_first(&mut self.pending);
            }
            return;
        }
        if self.pending.len() < self.batch {
            return;
        }
        if smooth {
            let count = plan::back_smoothly(&mut self.pending);
            self.settle_smoothly(count);
        } else {
            let count = plan::back(&mut self.pending);
            self.settle(count);
        }
        // Half of a batch at least is new each time, so that no block is planned often.
        self.batch = BATCH.max(2 * self.pending.len());
    }

    /// The first `count` blocks are done, as planned.
    fn settle(&mut self, count: usize) {
        let mut entry_speed = self.pending.first().map_or(0.0, |first| first.entry.sqrt());
        for _ in 0..count {
            let Some(block) = self.pending.take_first() else { return };
            let most = (block.entry + block.change).at_most(block.cruise);
            let exit = self.pending.first().map_or(block.rest, |next| next.entry).at_most(most);
            let cruise = block.cruise.at_most(0.5 * (block.entry + exit + block.change));
            let exit_speed = exit.sqrt();
            let top = Top { entry: block.entry, cruise, exit };
            self.done.push(timed(block, top, [entry_speed, exit_speed]));
            entry_speed = exit_speed;
        }
    }

    /// The first `count` blocks are done, by Klipper's plan.
    fn settle_smoothly(&mut self, count: usize) {
        let ends = self.pending.get(count).map_or((0.0, 0.0), |next| (next.entry, next.smooth));
        let tops = plan::tops(&self.pending, count, ends);
        for top in tops {
            let Some(block) = self.pending.take_first() else { return };
            self.done.push(timed(block, top, [top.entry.sqrt(), top.exit.sqrt()]));
        }
    }
}

/// The time of a block that begins and ends at these speeds, mm/s.
fn timed<T>(block: Block<T>, top: Top, [entry, exit]: [f64; 2]) -> Timed<T> {
    if block.distance <= 0.0 {
        return standing(0.0, block.tag);
    }
    let peak = top.cruise.sqrt();
    let ramps = (2.0 * top.cruise - top.entry - top.exit) / (2.0 * block.acceleration);
    let cruising = (block.distance - ramps).at_least(0.0);
    let seconds = (2.0 * peak - entry - exit) / block.acceleration + cruising / peak;
    Timed { seconds, peak, entry, exit, acceleration: block.acceleration, tag: block.tag }
}

/// So long without a way.
fn standing<T>(seconds: f64, tag: T) -> Timed<T> {
    Timed { seconds, peak: 0.0, entry: 0.0, exit: 0.0, acceleration: 0.0, tag }
}
