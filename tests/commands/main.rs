//! The built program -> exit codes, streams and files: one module for each command, as a user or a script sees it.

#[path = "../common/mod.rs"]
mod common;

mod arguments;
mod check;
mod diff;
mod estimate;
mod failures;
mod help;
mod hosts;
mod logs;
mod mesh;
mod names;
mod plates;
mod preview;
mod profiles;
mod reading;
mod roughness;
mod run;
mod schema;
#[cfg(unix)]
mod send;
mod skins;
mod steps;
mod verdicts;
mod viewer;
mod ways;
