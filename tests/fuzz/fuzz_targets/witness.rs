//! Bytes -> an edit of a sound file, which `check` or `diff` has to see: `tests/hostile/witness.rs`.

#![no_main]
#![allow(dead_code, unused_imports, reason = "the target uses one function of each")]

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../hostile/edits.rs"]
mod edits;
#[path = "../../hostile/slopes.rs"]
mod slopes;
#[path = "../../hostile/sound.rs"]
mod sound;
#[path = "../../hostile/witness.rs"]
mod witness;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| witness::is_seen(bytes));
