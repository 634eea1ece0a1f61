//! Answers of a board, wishes and time -> what to send to it: the sender's side of the protocol.
//!
//! It is a state machine without clock, port and file: the time is passed in, in ms from any beginning, and
//! what is to be done is given out. Words: a *run* is this sender, a *job* is a file at a board, a *boot* is a
//! life of the board between two restarts; a block is *in flight* while it is sent and not acknowledged.
//!
//! | state | sends | leaves it when | for |
//! |---|---|---|---|
//! | `Asking` | ask | any answer; a job that is not over is refused, or joined with `--resume` | `Beginning`, `Joining` |
//! | `Beginning` | begin | the board has the run | `Sending` |
//! | | | another boot: nothing was begun | `Asking` |
//! | `Joining` | join | the board has the run | `Sending` |
//! | `Sending` | blocks below the board's limit, at most [`FLIGHT`] in flight; orders; ask, if quiet | done | the end |
//! | | | another boot: the board has lost its place | the end, an error |
//! | | | stop is wished, or nothing moves | `Stopping` |
//! | `Stopping` | stop | the board says that it is over | the end |
//!
//! In every state:
//! - What is sent is answered at once. Without an answer for [`TIMEOUT`] it is sent again, [`REPEATS`] times.
//! - An answer to a frame that was sent later than one that did not arrive tells that this is lost: it is
//!   sent again without waiting. Blocks are then sent again from the first that is not acknowledged.
//! - What does not arrive after [`REPEATS`] repeats, though the board answers, ends the run.

use super::error::Cause;
use super::event::{Action, Ended, Event, Ms, Want, left, may_take, over};
use super::frame::{Answer, Job, Order, State, Status, VERSION};
use std::collections::VecDeque;

/// How long an answer may take.
pub const TIMEOUT: Ms = 2000;

/// How often something is sent again.
pub const REPEATS: u32 = 5;

/// Blocks that are sent and not acknowledged at most: enough for a line's delay, few to send again.
pub const FLIGHT: usize = 4;

/// How often a quiet board is asked how it is.
const POLL: Ms = 500;

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Phase {
    #[default]
    Asking,
    Beginning,
    Joining,
    Sending,
    Stopping,
    Ended,
}

/// Something that is sent until it has arrived: the tag of its last frame, and how often it was repeated.
#[derive(Debug, Clone, Copy, Default)]
struct Sent {
    tag: u32,
    repeats: u32,
}

/// See the head of this file.
#[derive(Debug, Default)]
pub struct Sender {
    job: Job,
    run: u32,
    is_resume: bool,
    /// How long the longest block takes, ms.
    longest: Ms,
    phase: Phase,
    boot: Option<u32>,
    /// Other boots before anything was begun.
    boots: u32,
    /// Of the last frame.
    tag: u32,
    /// When it was sent.
    sent_at: Ms,
    /// Since when something has not been answered.
    waits_since: Option<Ms>,
    /// Timeouts since the board was heard.
    timeouts: u32,
    /// What the phase is about: ask, begin, join; in the end the first stop.
    greeting: Sent,
    /// The board may have the run, or hold the job.
    has_begun: bool,
    /// What the board says, each number the highest.
    board: Status,
    /// Of the answer that told its state.
    state_tag: u32,
    /// When anything was executed last, or need not be.
    moved_at: Ms,
    /// Tags of the blocks in flight; the first is `board.next`.
    flight: VecDeque<u32>,
    /// Repeats of the first of them.
    repeats: u32,
    /// The first block that was never sent.
    unsent: u32,
    /// The board shall stand still.
    hold: bool,
    /// It was told so.
    told: bool,
    /// The last order.
    number: u32,
    order: Option<(Order, Sent)>,
    /// Stop as soon as the board is ours.
    is_stop_wished: bool,
    /// Why it is stopped, if nobody wished it.
    why: Option<Cause>,
    /// Frames that were sent again.
    repeated: u64,
}

impl Sender {
    /// A sender of a job. `run` is a number that no sender before had, and not 0; `longest` is how long
    /// the longest block takes, ms. With `is_resume` it goes on with what the board has.
    #[must_use]
    pub fn new(job: Job, run: u32, longest: Ms, is_resume: bool) -> Self {
        Self { job, run, is_resume, longest, ..Self::default() }
    }

    /// The first block that the board does not have.
    #[must_use]
    pub fn next(&self) -> u32 {
        self.board.next
    }

    /// Blocks that the board has executed.
    #[must_use]
    pub fn done(&self) -> u32 {
        self.board.done
    }

    /// Frames that were sent again.
    #[must_use]
    pub fn repeated(&self) -> u64 {
        self.repeated
    }

    /// Whether the board stands still, as was wished, or will as soon as it is hot.
    #[must_use]
    pub fn is_paused(&self) -> bool {
        let stands = matches!(self.board.state, State::Paused | State::Preparing);
        self.told && self.order.is_none() && stands
    }

    /// When time alone makes a difference, ms.
    #[must_use]
    pub fn wakes_at(&self) -> Ms {
        self.waits_since.map_or(self.sent_at + POLL, |since| since + TIMEOUT)
    }

    /// Takes what happens, and gives what to do. The first event should be [`Event::Pass`].
    pub fn take(&mut self, event: Event, now: Ms, out: &mut Vec<Action>) {
        if self.phase == Phase::Ended {
            return;
        }
        let judged = match event {
            Event::Pass => self.pass(now, out),
            Event::Heard(answer) if answer.run == self.run && answer.tag <= self.tag => {
                self.heard(&answer, now, out)
            }
            Event::Heard(_) => Ok(None),
            Event::Pause | Event::Go => {
                self.hold = event == Event::Pause;
                self.fill(now, out).map(|()| None)
            }
            Event::Stop => self.stop(now, out),
        };
        let end = match judged {
            Ok(None) => return,
            Ok(Some(ended)) => self.why.take().map_or(Ok(ended), Err),
            Err(cause) => Err(cause),
        };
        self.phase = Phase::Ended;
        out.push(Action::End(end));
    }

    fn send(&mut self, want: Want, now: Ms, out: &mut Vec<Action>) -> u32 {
        self.tag += 1;
        self.sent_at = now;
        self.waits_since.get_or_insert(now);
        out.push(Action::Send(self.tag, want));
        self.tag
    }

    /// Sends what the phase is about, for the first time or again.
    fn greet(&mut self, now: Ms, out: &mut Vec<Action>) -> Result<(), Cause> {
        let boot = self.boot.unwrap_or_default();
        let (want, what) = match self.phase {
            Phase::Beginning => (Want::Begin { boot }, "the beginning"),
            Phase::Joining => (Want::Join { boot }, "a word"),
            _ => (Want::Ask, "a word"),
        };
        self.has_begun |= self.phase != Phase::Asking;
        if self.greeting.tag > 0 {
            self.greeting.repeats += 1;
            self.repeated += 1;
        }
        if self.greeting.repeats > REPEATS {
            return Err(Cause::NotTaken { what, begun: self.has_begun });
        }
        self.greeting.tag = self.send(want, now, out);
        Ok(())
    }

    fn enter(&mut self, phase: Phase, now: Ms, out: &mut Vec<Action>) -> Result<(), Cause> {
        (self.phase, self.greeting) = (phase, Sent::default());
        self.greet(now, out)
    }

    /// What time alone makes.
    fn pass(&mut self, now: Ms, out: &mut Vec<Action>) -> Result<Option<Ended>, Cause> {
        if self.tag == 0 {
            self.greet(now, out)?;
            return Ok(None);
        }
        if self.phase == Phase::Sending
            && let Some(seconds) = self.is_stuck(now)
        {
            self.why = Some(Cause::Stuck { seconds, state: self.board.state });
            return self.stop(now, out);
        }
        match self.waits_since {
            Some(since) if since + TIMEOUT <= now => self.again(now, out)?,
            None if self.sent_at + POLL <= now => {
                self.send(Want::Ask, now, out);
            }
            _ => {}
        }
        Ok(None)
    }

    /// How long nothing moved where something should, s.
    fn is_stuck(&mut self, now: Ms) -> Option<u64> {
        let Some(most) = may_take(&self.board, self.longest) else {
            self.moved_at = now;
            return None;
        };
        let still = now.saturating_sub(self.moved_at);
        (still > most).then_some(still / 1000)
    }

    /// Nothing was heard in time.
    fn again(&mut self, now: Ms, out: &mut Vec<Action>) -> Result<(), Cause> {
        self.timeouts += 1;
        self.waits_since = None;
        if self.timeouts > REPEATS {
            let is_stopping = self.phase == Phase::Stopping;
            let begun = self.has_begun;
            return Err(if is_stopping { Cause::Unstopped } else { Cause::NoAnswer { begun } });
        }
        match self.phase {
            Phase::Asking | Phase::Beginning | Phase::Joining => self.greet(now, out),
            _ if self.order.is_some() => self.give(now, out),
            Phase::Sending if !self.flight.is_empty() => self.go_back(now, out),
            _ => {
                self.repeated += 1;
                self.send(Want::Ask, now, out);
                Ok(())
            }
        }
    }

    fn heard(
        &mut self,
        answer: &Answer,
        now: Ms,
        out: &mut Vec<Action>,
    ) -> Result<Option<Ended>, Cause> {
        let status = &answer.status;
        if status.version != VERSION {
            return Err(Cause::Protocol(status.version));
        }
        if answer.tag > 0 {
            self.timeouts = 0;
            let is_last = answer.tag == self.tag;
            self.waits_since = self.waits_since.filter(|_| !is_last).map(|_| now);
        }
        let is_ours = status.owner == self.run;
        // An answer to what was sent before the greeting knows nothing of it.
        let knows = answer.tag >= self.greeting.tag;
        let boot = *self.boot.get_or_insert(status.boot);
        if boot != status.boot && self.phase != Phase::Stopping {
            // What does not know the greeting is of a life before.
            return if knows { self.restarted(status.boot, now, out) } else { Ok(None) };
        }
        match self.phase {
            // A begin that seemed lost had arrived.
            Phase::Asking if knows && is_ours && status.state.is_active() => {
                self.begun(answer, now, out)
            }
            Phase::Asking if knows => self.found(status, now, out),
            Phase::Beginning | Phase::Joining if is_ours => self.begun(answer, now, out),
            Phase::Beginning if knows && status.state.is_active() => Err(Cause::Busy(status.next)),
            Phase::Joining if knows && !status.state.is_active() => self.found(status, now, out),
            Phase::Beginning | Phase::Joining if knows => self.greet(now, out).map(|()| None),
            Phase::Sending if is_ours => self.sending(answer, now, out),
            Phase::Sending if knows => Err(Cause::Busy(status.next)),
            Phase::Stopping
                if is_ours && (knows || answer.tag == 0) && !status.state.is_active() =>
            {
                self.board.done = self.board.done.max(status.done);
                Ok(Some(Ended::Stopped))
            }
            Phase::Stopping if self.order.is_some_and(|(_, sent)| answer.tag >= sent.tag) => {
                self.give(now, out).map(|()| None)
            }
            _ => Ok(None),
        }
    }

    /// The board has lost all it knew, and its motors and heater are off.
    fn restarted(
        &mut self,
        boot: u32,
        now: Ms,
        out: &mut Vec<Action>,
    ) -> Result<Option<Ended>, Cause> {
        match self.phase {
            Phase::Joining => Err(Cause::NothingHeld),
            Phase::Sending => Err(Cause::Restarted { done: self.board.done }),
            _ => {
                // No block was sent: nothing moved.
                self.boots += 1;
                if self.boots > REPEATS {
                    return Err(Cause::Restarted { done: 0 });
                }
                self.boot = Some(boot);
                self.enter(Phase::Asking, now, out).map(|()| None)
            }
        }
    }

    /// The first answer: is it free, or has it what is to be resumed?
    fn found(
        &mut self,
        status: &Status,
        now: Ms,
        out: &mut Vec<Action>,
    ) -> Result<Option<Ended>, Cause> {
        let phase = match (status.state.is_active(), self.is_resume) {
            (false, false) => Phase::Beginning,
            (true, true) if status.job == self.job.sum => Phase::Joining,
            (true, false) => return Err(Cause::Busy(status.next)),
            (true, true) => return Err(Cause::NothingHeld),
            (false, true) => {
                self.board.done = status.done;
                return left(status, self.job);
            }
        };
        self.enter(phase, now, out).map(|()| None)
    }

    /// The board has the run.
    fn begun(
        &mut self,
        answer: &Answer,
        now: Ms,
        out: &mut Vec<Action>,
    ) -> Result<Option<Ended>, Cause> {
        self.board = answer.status;
        self.state_tag = answer.tag;
        self.unsent = if self.is_resume { self.board.next.min(self.job.blocks) } else { 0 };
        self.moved_at = now;
        self.told = self.board.state == State::Paused;
        self.phase = Phase::Sending;
        if self.is_stop_wished {
            return self.stop(now, out);
        }
        self.sending(answer, now, out)
    }

    /// While blocks are sent.
    fn sending(
        &mut self,
        answer: &Answer,
        now: Ms,
        out: &mut Vec<Action>,
    ) -> Result<Option<Ended>, Cause> {
        let status = &answer.status;
        if status.done > self.board.done {
            (self.board.done, self.moved_at) = (status.done, now);
        }
        if let Some(ended) = over(status, self.job.blocks)? {
            return Ok(Some(ended));
        }
        if status.next > self.unsent || status.done > status.next {
            self.why = Some(Cause::Nonsense(status.next.max(status.done)));
            return self.stop(now, out);
        }
        self.learn(answer, now);
        let is_lost = |sent: u32| answer.tag >= sent;
        if let Some((_, sent)) = self.order {
            if status.order >= self.number {
                self.order = None;
            } else if is_lost(sent.tag) {
                self.give(now, out)?;
            }
        }
        if status.next == self.board.next && self.flight.front().is_some_and(|tag| is_lost(*tag)) {
            self.go_back(now, out)?;
        }
        self.fill(now, out)?;
        Ok(None)
    }

    /// Takes over what is newer than what is known.
    fn learn(&mut self, answer: &Answer, now: Ms) {
        let (status, board) = (&answer.status, &mut self.board);
        let arrived = status.next.saturating_sub(board.next) as usize;
        if arrived > 0 {
            self.flight.drain(..arrived.min(self.flight.len()));
            self.repeats = 0;
        }
        if answer.tag == 0 || answer.tag >= self.state_tag {
            if board.state != status.state {
                self.moved_at = now;
            }
            board.state = status.state;
            self.state_tag = self.state_tag.max(answer.tag);
        }
        board.next = board.next.max(status.next);
        board.limit = board.limit.max(status.limit);
    }

    /// Sends orders and blocks that there is room for.
    fn fill(&mut self, now: Ms, out: &mut Vec<Action>) -> Result<(), Cause> {
        if self.phase != Phase::Sending {
            return Ok(());
        }
        if self.hold != self.told {
            self.told = self.hold;
            self.new_order(if self.hold { Order::Pause } else { Order::Go }, now, out)?;
        }
        let end = self.board.limit.min(self.job.blocks);
        while self.flight.len() < FLIGHT {
            let block = self.board.next + self.flight.len() as u32;
            if block >= end {
                break;
            }
            let tag = self.send(Want::Block(block), now, out);
            self.flight.push_back(tag);
            self.unsent = self.unsent.max(block + 1);
        }
        Ok(())
    }

    /// Sends blocks again from the first that is not acknowledged.
    fn go_back(&mut self, now: Ms, out: &mut Vec<Action>) -> Result<(), Cause> {
        self.repeats += 1;
        self.repeated += self.flight.len() as u64;
        if self.repeats > REPEATS {
            return Err(Cause::NotTaken { what: "a block", begun: true });
        }
        self.flight.clear();
        self.fill(now, out)
    }

    fn new_order(&mut self, order: Order, now: Ms, out: &mut Vec<Action>) -> Result<(), Cause> {
        self.number += 1;
        self.order = Some((order, Sent::default()));
        self.give(now, out)
    }

    /// Sends the order, for the first time or again.
    fn give(&mut self, now: Ms, out: &mut Vec<Action>) -> Result<(), Cause> {
        let Some((order, mut sent)) = self.order else { return Ok(()) };
        if sent.tag > 0 {
            sent.repeats += 1;
            self.repeated += 1;
        }
        if sent.repeats > REPEATS {
            let what = "an order";
            let is_stop = order == Order::Stop;
            return Err(if is_stop {
                Cause::Unstopped
            } else {
                Cause::NotTaken { what, begun: true }
            });
        }
        sent.tag = self.send(Want::Order { number: self.number, order }, now, out);
        self.order = Some((order, sent));
        Ok(())
    }

    /// Stops the board, unless it has nothing of this run.
    fn stop(&mut self, now: Ms, out: &mut Vec<Action>) -> Result<Option<Ended>, Cause> {
        match self.phase {
            Phase::Asking if !self.has_begun => return Ok(Some(Ended::Stopped)),
            Phase::Joining => self.is_stop_wished = true,
            Phase::Asking | Phase::Beginning | Phase::Sending => {
                self.phase = Phase::Stopping;
                self.new_order(Order::Stop, now, out)?;
                self.greeting.tag = self.tag;
            }
            Phase::Stopping | Phase::Ended => {}
        }
        Ok(None)
    }
}
