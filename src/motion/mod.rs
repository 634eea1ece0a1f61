//! Moves + machine limits -> seconds of each move, as the printer's own planner would drive it.
//!
//! A planner looks at each pair of successive moves and decides how fast the
//! corner between them may be taken ([`Junction`]). It then makes sure that
//! every move can slow down in time for what follows, and speeds up and slows
//! down at constant acceleration in between: a trapezoid of speed over time.
//! [`Clock`] does the same and returns how long each move takes.
//!
//! Only sums, products, quotients and square roots are used, in a fixed order:
//! the same moves take the same time on every platform.

mod block;
mod clock;
mod joint;
mod junction;
mod limits;
mod plan;
mod queue;

pub use clock::{Clock, Timed};
pub use joint::joint;
pub use limits::{Junction, Limits, Rates};

use crate::units::MmPerS;

/// A straight move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move<T> {
    /// How far x, y, z and the filament go, mm.
    pub delta: [f64; 4],
    /// Feed asked for: along the path, or of the filament where only that moves.
    pub feed: MmPerS,
    /// Comes out again with the move's time.
    pub tag: T,
}
