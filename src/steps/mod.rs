//! Moves -> times at which each motor steps: for machines that take no G-code.
//!
//! A *step* is what a motor does on one pulse: a full step, half a step or a microstep, as the settings
//! count them. A *stream* is a file of steps with their times.
//!
//! | file | what it knows |
//! |---|---|
//! | `axis` | millimetres as steps, exactly |
//! | `line` | which axis steps where on a straight line: the law |
//! | `ramp` | when a move is where |
//! | `pace` | times in whole µs that the motors can keep |
//! | `machine` | the settings as the others take them |
//! | `make` | G-code -> stream |
//! | `format`, `encode`, `decode`, `coils` | the bytes of a stream |
//! | `play` | a stream -> totals, and what its machine would not do |
//! | `path` | a stream -> moves of G-code |
//! | `rates` | G-code -> how fast motors would have to step |
//! | `send` | a stream -> a board that executes it |
//!
#![doc = include_str!("FORMAT.md")]

pub mod axis;
mod coils;
mod decode;
mod encode;
mod error;
mod format;
pub mod line;
mod machine;
mod make;
mod pace;
mod path;
mod play;
mod ramp;
mod rates;
pub mod send;

pub use decode::{Decoder, Item};
pub use encode::Encoder;
pub use error::{Cause, Damage, Error};
pub use format::{BLOCK, Form, Header, Totals};
pub use machine::{Machine, most_rates};
pub use make::{Failure, Made, Options, make};
pub use path::Path;
pub use play::{Finding, Played, play};
pub use rates::highest_rates;
