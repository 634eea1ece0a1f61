//! Sender and file on one side, a line on the other -> a run: what the sender wants is put on the line.
//!
//! Time is counted by what passes between two looks, and never more than [`LEAP`] at once: a process that
//! was stopped for an hour has missed no answer.

use super::error::{Cause, Error};
use super::feed::Feed;
use super::frame::{Hearing, Request};
use super::sender::{Action, Ended, Event, Ms, Sender, Want};
use std::io::{self, Read, Seek};
use std::time::{Duration, Instant};

/// The longest time between two looks that counts, ms.
const LEAP: Ms = 1000;

/// How long the line is waited for at once, ms: wishes are asked for as often.
const LOOK: Ms = 50;

/// Bytes to a board and from it.
pub trait Line {
    /// Writes of `out` what can be written, takes that away, and appends to `heard` what has come. Waits
    /// for at most so long until something can be done.
    ///
    /// # Errors
    /// If the line is gone.
    fn exchange(&mut self, out: &mut Vec<u8>, heard: &mut Vec<u8>, wait: Duration)
    -> io::Result<()>;
}

/// What a run did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sent {
    /// How it ended.
    pub ended: Ended,
    /// Blocks that the board has executed.
    pub done: u32,
    /// The first block that was sent.
    pub from: u32,
    /// Frames that were sent again.
    pub repeated: u64,
}

/// Sends a stream over a line to a board. `wish` is told of the sender, and asked for a wish, some twenty
/// times a second; `port` is the line's name, `run` as for [`Sender::new`].
///
/// # Errors
/// Every [`Cause`] but those of opening.
pub fn send<R: Read + Seek>(
    feed: &mut Feed<R>,
    line: &mut dyn Line,
    port: &str,
    (run, is_resume): (u32, bool),
    mut wish: impl FnMut(&Sender) -> Option<Event>,
) -> Result<Sent, Error> {
    let mut sender = Sender::new(feed.job(), run, feed.longest(), is_resume);
    let (mut hearing, mut out, mut heard) = (Hearing::default(), Vec::new(), Vec::new());
    let (mut now, mut looked) = (0, Instant::now());
    let (mut from, mut failed) = (None, None);
    loop {
        let passed = looked.elapsed().min(Duration::from_millis(LEAP));
        looked = Instant::now();
        // Parts of a ms count, too.
        now += passed.as_micros() as u64;
        let at = now / 1000;
        let mut actions = Vec::new();
        hearing.hear(&heard, |answer| sender.take(Event::Heard(answer), at, &mut actions));
        heard.clear();
        sender.take(wish(&sender).unwrap_or(Event::Pass), at, &mut actions);
        sender.take(Event::Pass, at, &mut actions);
        while let Some(action) = (!actions.is_empty()).then(|| actions.remove(0)) {
            match action {
                Action::Send(tag, want) => {
                    if let Want::Block(block) = want {
                        from.get_or_insert(block);
                    }
                    let request = request(feed, &sender, want);
                    match request {
                        Ok(request) => out.extend(request.frame(run, tag)),
                        // What is in flight is right, and nothing more is to come.
                        Err(cause) if failed.is_none() => {
                            failed = Some(cause);
                            sender.take(Event::Stop, at, &mut actions);
                        }
                        Err(_) => {}
                    }
                }
                Action::End(ended) => {
                    let ended = failed.map_or(ended, Err).map_err(|cause| cause.at(port))?;
                    let (done, repeated) = (sender.done(), sender.repeated());
                    return Ok(Sent { ended, done, from: from.unwrap_or_default(), repeated });
                }
            }
        }
        let wait = sender.wakes_at().saturating_sub(at).min(LOOK);
        let done = line.exchange(&mut out, &mut heard, Duration::from_millis(wait));
        done.map_err(|error| Cause::Gone(error).at(port))?;
    }
}

/// What is wanted, with what the file has.
fn request<'a, R: Read + Seek>(
    feed: &'a mut Feed<R>,
    sender: &Sender,
    want: Want,
) -> Result<Request<'a>, Cause> {
    let job = feed.job();
    Ok(match want {
        Want::Ask => Request::Ask,
        Want::Begin { boot } => Request::Begin { boot, job, header: feed.header() },
        Want::Join { boot } => Request::Join { boot, job },
        Want::Block(number) => Request::Block(feed.block(number, sender.next())?),
        Want::Order { number, order } => Request::Order { number, order },
    })
}
