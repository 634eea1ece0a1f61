//! Bytes -> the property `stl` of `tests/common/hostile.rs`.

#![no_main]
#![allow(dead_code, reason = "each target uses one property")]

#[path = "../../common/hostile.rs"]
mod hostile;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| hostile::stl(bytes));
