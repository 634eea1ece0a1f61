//! Bytes -> the property `steps` of `tests/hostile/properties.rs`.

#![no_main]
#![allow(dead_code, reason = "each target uses one property")]

#[path = "../../hostile/properties.rs"]
mod properties;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| properties::steps(bytes));
