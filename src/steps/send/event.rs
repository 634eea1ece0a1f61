//! What happens to a sender, and what it does.

use super::super::axis::AXES;
use super::error::Cause;
use super::frame::{Answer, Job, Order, State, Status};

/// Milliseconds.
pub type Ms = u64;

/// How much longer than its steps a block may take.
const SLACK: Ms = 30_000;

/// How long a board may heat.
const HEATING: Ms = 1_800_000;

/// What is to be sent; the frame's tag stands beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "as in Request")]
pub enum Want {
    Ask,
    Begin { boot: u32 },
    Join { boot: u32 },
    Block(u32),
    Order { number: u32, order: Order },
}

/// What happens to the sender.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Time passes.
    Pass,
    /// The board says something.
    Heard(Answer),
    /// The board shall stand still.
    Pause,
    /// It shall go on.
    Go,
    /// Motors and heater off.
    Stop,
}

/// What the sender does.
#[derive(Debug)]
pub enum Action {
    /// Sends a frame with this tag.
    Send(u32, Want),
    /// It is over.
    End(Result<Ended, Cause>),
}

/// How a run ends well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// All blocks were executed.
    Done,
    /// It was stopped, as was wished.
    Stopped,
}

/// Whether a board says that a job of so many blocks, which it has, is over.
///
/// # Errors
/// If it ended badly.
pub(super) fn over(status: &Status, blocks: u32) -> Result<Option<Ended>, Cause> {
    let axis = Some(usize::from(status.axis)).filter(|axis| *axis < AXES);
    let (reason, done) = (status.reason, status.done);
    match status.state {
        State::Done if done == blocks => Ok(Some(Ended::Done)),
        State::Done | State::Idle => Err(Cause::Nonsense(done)),
        State::Stopped => Err(Cause::StoppedThere { done }),
        State::Refused => Err(Cause::Refused { reason, axis }),
        State::Failed => Err(Cause::Failed { reason, axis, done }),
        State::Preparing | State::Running | State::Paused => Ok(None),
    }
}

/// How a job ended at a board that is at nothing any more, for who wants to go on with it.
///
/// # Errors
/// [`Cause::NothingHeld`] if it had another, or none; else if it ended badly.
pub(super) fn left(status: &Status, job: Job) -> Result<Option<Ended>, Cause> {
    if status.job != job.sum || status.state == State::Idle {
        return Err(Cause::NothingHeld);
    }
    over(status, job.blocks)
}

/// How long a board may execute nothing, if it should; `longest` is how long the longest block takes.
pub(super) fn may_take(status: &Status, longest: Ms) -> Option<Ms> {
    match status.state {
        State::Running if status.done < status.next => Some(longest.saturating_add(SLACK)),
        State::Preparing => Some(HEATING),
        _ => None,
    }
}
