//! Sender and file on one side, a line on the other -> a run: what the sender wants is put on the line.
//!
//! Time is counted by what passes between two looks, and never more than [`LEAP`] at once: a process that
//! was stopped for an hour has missed no answer.

use super::error::{Cause, Error};
use super::event::{Action, Ended, Event, Ms, Want};
use super::feed::Feed;
use super::frame::{Hearing, Request};
use super::sender::Sender;
use std::io::{self, Read, Seek};
use std::time::{Duration, Instant};

/// The longest time between two looks that counts, ms.
const LEAP: Ms = 1000;

/// How long the line is waited for at once, ms: wishes are asked for as often.
const LOOK: Ms = 50;

/// Microseconds in a millisecond.
const MS: u64 = 1000;

/// Bytes to a board and from it.
pub trait Line {
    /// Writes of `out` what can be written, takes that away, and appends to `heard` what has come. Waits
    /// for at most so long until something can be done.
    ///
    /// # Errors
    /// If the line is gone.
    fn exchange(
        &mut self,
        out: &mut Vec<u8>,
        heard: &mut Vec<u8>,
        wait: Duration,
    ) -> io::Result<()>;
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
        // Parts of a ms count, too.
        now += looked.elapsed().as_micros().min(u128::from(LEAP * MS)) as u64;
        looked = Instant::now();
        let at = now / MS;
        let mut events = Vec::new();
        hearing.hear(&heard, |answer| events.push(Event::Heard(answer)));
        heard.clear();
        // If the file is another than it was, the board is stopped, and the run ends with that.
        events.extend(wish(&sender).or(failed.as_ref().map(|_| Event::Stop)));
        events.push(Event::Pass);
        // What an event asks for is done before the next: that may tell that a block has arrived.
        for event in events {
            let mut actions = Vec::new();
            sender.take(event, at, &mut actions);
            for action in actions {
                let (tag, want) = match action {
                    Action::Send(tag, want) => (tag, want),
                    Action::End(ended) => {
                        let ended = ended.and_then(|ended| failed.map_or(Ok(ended), Err));
                        let ended = ended.map_err(|cause| cause.at(port))?;
                        let (done, repeated) = (sender.done(), sender.repeated());
                        return Ok(Sent { ended, done, from: from.unwrap_or(done), repeated });
                    }
                };
                match request(feed, &sender, want) {
                    Ok(request) => out.extend(request.frame(run, tag)),
                    Err(cause) => failed = failed.or(Some(cause)),
                }
                if let Want::Block(block) = want {
                    from.get_or_insert(block);
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
