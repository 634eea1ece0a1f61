//! Port, board -> Error: why a stream could not be sent, and what to do.

use super::super::axis::LETTERS;
use super::super::error as stream;
use super::frame::State;
use std::io;

/// A stream that could not be sent, or not to its end.
#[derive(Debug, thiserror::Error)]
#[error("{port}: {source}")]
pub struct Error {
    /// The port as the user named it.
    pub port: String,
    /// What went wrong.
    pub source: Cause,
}

/// See [`Error`]. After those that say so, the board still holds the job and its place, and waits; in all
/// others its motors and its heater are off.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Cause {
    /// The port cannot be opened or set.
    #[error("cannot open: {}; check --port", opening(.0))]
    Open(#[source] io::Error),
    /// It is a file of another kind.
    #[error("it is no serial port; check --port")]
    NotPort,
    /// This system has no ports that are known.
    #[error("sending needs a Unix system; write the file with another program")]
    NoPorts,
    /// The port went away. The board holds the job.
    #[error("the port is gone: {0}; plug it in, and go on with --resume")]
    Gone(#[source] io::Error),
    /// Nothing was heard. The board, if it was begun, holds the job.
    #[error("the board does not answer; check cable, power and --baud{}", resume(*.begun))]
    NoAnswer {
        /// It may have begun the job.
        begun: bool,
    },
    /// It answers, but what is sent does not get through. The board holds the job.
    #[error(
        "{what} does not get through: answers come too late or not at all; check cable and --baud{}",
        resume(*.begun)
    )]
    NotTaken {
        /// What was sent.
        what: &'static str,
        /// It may have begun the job.
        begun: bool,
    },
    /// It was told to stop, and did not say that it did.
    #[error("the board does not say that it stopped; motors and heater may be on: switch it off")]
    Unstopped,
    /// It speaks another version.
    #[error(
        "the board speaks version {0} of the protocol, and this program version {known}; update one",
        known = super::frame::VERSION
    )]
    Protocol(u16),
    /// It has a job that is not over. It holds that.
    #[error(
        "the board is in the middle of a job, at block {0}; go on with it by --resume, or restart the board"
    )]
    Busy(u32),
    /// There is nothing to resume.
    #[error("the board holds no part of this file; home its axes, and send without --resume")]
    NothingHeld,
    /// It refuses the stream.
    #[error("the board refuses the stream: {}", why(*.reason, *.axis))]
    Refused {
        /// Its number of the protocol.
        reason: u8,
        /// The axis it is about, if any.
        axis: Option<usize>,
    },
    /// It could not go on.
    #[error("the board failed after {}: {}", blocks(*.done), why(*.reason, *.axis))]
    Failed {
        /// Its number of the protocol.
        reason: u8,
        /// The axis it is about, if any.
        axis: Option<usize>,
        /// Blocks that it had executed.
        done: u32,
    },
    /// It restarted.
    #[error(
        "the board restarted after {}: it does not know where its axes stand; take off the part, home \
         them, and begin anew",
        blocks(*.done)
    )]
    Restarted {
        /// Blocks that it had executed when it was last heard.
        done: u32,
    },
    /// Somebody stopped it.
    #[error("the job was stopped at the board after {}; home its axes, and begin anew", blocks(*.done))]
    StoppedThere {
        /// Blocks that it had executed.
        done: u32,
    },
    /// It answers, and does nothing.
    #[error("the board {}: nothing happened for {seconds} s; it was stopped", idle(*.state))]
    Stuck {
        /// How long, s.
        seconds: u64,
        /// What it was at.
        state: State,
    },
    /// Its answers contradict themselves.
    #[error("the board says what cannot be: block {0}; mend its program")]
    Nonsense(u32),
    /// The file is another than it was.
    #[error("{0}")]
    File(#[from] stream::Error),
}

impl Cause {
    /// The error at a port with this name.
    #[must_use]
    pub fn at(self, port: &str) -> Error {
        Error { port: port.to_owned(), source: self }
    }
}

impl Error {
    /// The documented exit code: 3 if another stream is needed, else 4.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self.source {
            Cause::Refused { .. } | Cause::File(_) => 3,
            _ => 4,
        }
    }
}

fn resume(begun: bool) -> &'static str {
    if begun { ", and go on with --resume" } else { "" }
}

fn opening(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::ResourceBusy => "another program has it open".to_owned(),
        _ => error.to_string(),
    }
}

fn blocks(count: u32) -> String {
    if count == 1 { "1 block".to_owned() } else { format!("{count} blocks") }
}

fn idle(state: State) -> &'static str {
    match state {
        State::Preparing => "does not get ready",
        _ => "runs but executes nothing",
    }
}

/// What the numbers of the protocol mean.
fn why(reason: u8, axis: Option<usize>) -> String {
    let text = match reason {
        1 => "it knows no such stream; make it with or without --coils, or update the board",
        2 => "it makes another number of steps a mm; make it for this machine",
        3 => "its motors are not so fast; make it for this machine",
        4 => "its axes do not stand where the stream begins; home them",
        5 => "it goes beyond the machine's ends; make it for this machine",
        16 => "a switch was hit; find out why, home the axes, and begin anew",
        17 => "the heater; mend it, home the axes, and begin anew",
        18 => "a motor or its driver; mend it, home the axes, and begin anew",
        19 => "it could not do a block; make the file anew",
        _ => return format!("reason {reason}; its maker's papers say what that is"),
    };
    match axis {
        Some(axis) => format!("{}: {text}", LETTERS[axis]),
        None => text.to_owned(),
    }
}
