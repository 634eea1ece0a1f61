//! Orders to a board and what it answers, as bytes on a line; PROTOCOL.md beside this file has them in words.
//!
//! - A *frame* is kind, run, tag and payload with a CRC-32, stuffed (COBS) so that it holds no zero, between
//!   zeros: whatever is damaged or lost, the next zero begins anew.
//! - The *run* is a number that a sender takes for itself; the *tag* counts its frames. An answer has
//!   both of the frame that it answers, so that nothing of an earlier sender is taken for this one's.
//!
//! All numbers are little-endian.

use super::super::format::{BLOCK, Fields, HEADER, SUM, seal};

/// Version of the protocol.
pub const VERSION: u16 = 1;

/// Kinds of frames.
const ASK: u8 = 1;
const BEGIN: u8 = 2;
const JOIN: u8 = 3;
const SEND: u8 = 4;
const ORDER: u8 = 5;
const STATUS: u8 = 128;

/// Bytes of a frame before its payload.
const FRAME_HEAD: usize = 9;

/// Stuffed bytes of a frame at most: what is longer is noise.
const LONGEST: usize = FRAME_HEAD + BLOCK + HEADER + 8;

/// The longest run of bytes without a zero that one code of COBS tells.
const COBS_RUN: usize = 254;

/// Which stream is sent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Job {
    /// CRC-32 of the whole file.
    pub sum: u32,
    /// Blocks, the last one among them.
    pub blocks: u32,
}

/// What a board is told to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Go on.
    Go,
    /// Stand still, and hold what you have.
    Pause,
    /// Motors and heater off; the job is over.
    Stop,
}

/// What goes to a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Request<'a> {
    /// How are you?
    Ask,
    /// Begin a job.
    Begin {
        /// The board's life, as it told it.
        boot: u32,
        /// Which.
        job: Job,
        /// The header of the stream.
        header: &'a [u8],
    },
    /// Go on with a job that the board has, for another sender.
    Join {
        /// The board's life, as it told it.
        boot: u32,
        /// Which.
        job: Job,
    },
    /// A block of the stream, as it is.
    Block(&'a [u8]),
    /// See [`Order`].
    Order {
        /// Counts the orders of a run, from 1.
        number: u32,
        /// Which.
        order: Order,
    },
}

/// What a board is at.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum State {
    /// Nothing was begun since it started.
    #[default]
    Idle,
    /// It heats, or makes ready otherwise; blocks are taken, and wait.
    Preparing,
    /// It executes blocks as they come.
    Running,
    /// It stands still, and holds its place.
    Paused,
    /// All blocks were executed; motors and heater are off.
    Done,
    /// It was told to stop; motors and heater are off.
    Stopped,
    /// It does not do this job.
    Refused,
    /// It could not go on; motors and heater are off.
    Failed,
}

impl State {
    const ALL: [Self; 8] = [
        Self::Idle,
        Self::Preparing,
        Self::Running,
        Self::Paused,
        Self::Done,
        Self::Stopped,
        Self::Refused,
        Self::Failed,
    ];

    /// Whether it has a job that is not over.
    #[must_use]
    pub fn is_active(self) -> bool {
        matches!(self, Self::Preparing | Self::Running | Self::Paused)
    }
}

/// What a board says of itself.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Status {
    /// Version of the protocol that it speaks.
    pub version: u16,
    /// Its life: another number each time it started.
    pub boot: u32,
    /// What it is at.
    pub state: State,
    /// Why it refused or failed; 0 for no reason.
    pub reason: u8,
    /// Of which axis; 255 for none.
    pub axis: u8,
    /// The run whose job it has.
    pub owner: u32,
    /// The job's [`Job::sum`].
    pub job: u32,
    /// Number of the last order of that run that it obeyed.
    pub order: u32,
    /// The first block that it does not have.
    pub next: u32,
    /// Blocks that it has executed.
    pub done: u32,
    /// The first block for which it has no room.
    pub limit: u32,
}

/// A status with the frame that it answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Answer {
    /// Of the frame that is answered; the owner's where none is.
    pub run: u32,
    /// Of the frame that is answered; 0 where none is.
    pub tag: u32,
    /// What the board says.
    pub status: Status,
}

impl Request<'_> {
    /// The bytes on the line.
    #[must_use]
    pub fn frame(&self, run: u32, tag: u32) -> Vec<u8> {
        let mut bytes = vec![match self {
            Self::Ask => ASK,
            Self::Begin { .. } => BEGIN,
            Self::Join { .. } => JOIN,
            Self::Block(_) => SEND,
            Self::Order { .. } => ORDER,
        }];
        bytes.extend(run.to_le_bytes());
        bytes.extend(tag.to_le_bytes());
        let of_job = |boot: u32, job: Job| [boot, job.sum, job.blocks].map(u32::to_le_bytes);
        match *self {
            Self::Ask => bytes.extend(VERSION.to_le_bytes()),
            Self::Begin { boot, job, header } => {
                bytes.extend(of_job(boot, job).as_flattened());
                bytes.extend(header);
            }
            Self::Join { boot, job } => bytes.extend(of_job(boot, job).as_flattened()),
            Self::Block(block) => bytes.extend(block),
            Self::Order { number, order } => {
                bytes.extend(number.to_le_bytes());
                bytes.push(match order {
                    Order::Go => 0,
                    Order::Pause => 1,
                    Order::Stop => 2,
                });
            }
        }
        seal(&mut bytes);
        stuffed(&bytes)
    }
}

impl Answer {
    /// Of the bytes between two zeros; `None` for anything but a whole answer.
    fn read(stuffed: &[u8]) -> Option<Self> {
        let bytes = unstuffed(stuffed)?;
        let (rest, sum) = bytes.split_at_checked(bytes.len().checked_sub(SUM)?)?;
        if crc32fast::hash(rest).to_le_bytes() != *sum {
            return None;
        }
        let mut fields = Fields(rest);
        let [kind] = fields.take()?;
        let run = u32::from_le_bytes(fields.take()?);
        let tag = u32::from_le_bytes(fields.take()?);
        let version = u16::from_le_bytes(fields.take()?);
        if kind != STATUS {
            return None;
        }
        if version != VERSION {
            return Some(Self { run, tag, status: Status { version, ..Status::default() } });
        }
        let boot = u32::from_le_bytes(fields.take()?);
        let [state, reason, axis] = fields.take()?;
        let state = *State::ALL.get(usize::from(state))?;
        let mut number = || fields.take().map(u32::from_le_bytes);
        let (owner, job, order) = (number()?, number()?, number()?);
        let (next, done, limit) = (number()?, number()?, number()?);
        let status =
            Status { version, boot, state, reason, axis, owner, job, order, next, done, limit };
        fields.0.is_empty().then_some(Self { run, tag, status })
    }
}

/// Bytes as they come -> answers. Noise is dropped.
#[derive(Debug, Default)]
pub struct Hearing {
    bytes: Vec<u8>,
    /// What came since the last zero is too long for a frame.
    is_noise: bool,
}

impl Hearing {
    /// Takes what came, and gives the answers in it to `each`.
    pub fn hear(&mut self, bytes: &[u8], mut each: impl FnMut(Answer)) {
        for &byte in bytes {
            if byte != 0 {
                self.is_noise |= self.bytes.len() == LONGEST;
                if !self.is_noise {
                    self.bytes.push(byte);
                }
                continue;
            }
            if !self.is_noise
                && let Some(answer) = Answer::read(&self.bytes)
            {
                each(answer);
            }
            self.bytes.clear();
            self.is_noise = false;
        }
    }
}

/// Between two zeros and without any: each zero, and each end of 254 bytes, becomes the distance to the next.
fn stuffed(bytes: &[u8]) -> Vec<u8> {
    let mut out = vec![0];
    let mut parts = bytes.split(|byte| *byte == 0).peekable();
    while let Some(mut part) = parts.next() {
        while part.len() >= COBS_RUN {
            let (whole, rest) = part.split_at(COBS_RUN);
            out.push(255);
            out.extend(whole);
            // Where the frame ends with it, nothing follows.
            if rest.is_empty() && parts.peek().is_none() {
                out.push(0);
                return out;
            }
            part = rest;
        }
        out.push(part.len() as u8 + 1);
        out.extend(part);
    }
    out.push(0);
    out
}

/// The other way; `None` for what was cut.
fn unstuffed(bytes: &[u8]) -> Option<Vec<u8>> {
    let (mut out, mut rest) = (Vec::with_capacity(bytes.len()), bytes);
    while let Some((&code, after)) = rest.split_first() {
        let (part, next) = after.split_at_checked(usize::from(code).checked_sub(1)?)?;
        out.extend(part);
        if code < 255 && !next.is_empty() {
            out.push(0);
        }
        rest = next;
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_stuffed_has_no_zero_and_comes_back() {
        let lengths = [0, 1, 253, 254, 255, 508, 509, 700];
        let fills: [fn(usize) -> u8; 4] = [|_| 0, |_| 1, |k| k as u8, |k| (k % 254 != 0) as u8];
        for length in lengths {
            for fill in fills {
                let bytes: Vec<u8> = (0..length).map(fill).collect();
                let line = stuffed(&bytes);
                let (first, rest) = line.split_first().unwrap();
                let (last, inner) = rest.split_last().unwrap();
                assert!((*first, *last) == (0, 0) && !inner.contains(&0));
                assert!(inner.len() <= length + length / COBS_RUN + 1);
                assert_eq!(unstuffed(inner), Some(bytes), "{length}");
            }
        }
        assert_eq!(unstuffed(&[5, 1]), None);
    }
}
