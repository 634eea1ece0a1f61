//! A stream -> a board that executes it, block by block, each acknowledged.
//!
//! | file | what it knows |
//! |---|---|
//! | `frame` | the bytes on the line |
//! | `event` | what happens to a sender, and what it does |
//! | `sender` | what to send when: a state machine without clock and port |
//! | `feed` | the blocks of a file that is right |
//! | `line` | puts what is wanted on a line |
//! | `port` | a serial port as a line |
//!
#![doc = include_str!("PROTOCOL.md")]

mod error;
pub mod event;
mod feed;
pub mod frame;
mod line;
#[cfg(unix)]
mod port;
pub mod sender;

pub use error::{Cause, Error};
pub use event::{Ended, Event};
pub use feed::Feed;
pub use line::{Line, Sent, send};
#[cfg(unix)]
pub use port::Port;
pub use sender::Sender;
