//! The library's stages -> laws: each is handed values in code, and what it returns is held against what must be true.

#[path = "../common/mod.rs"]
mod common;

mod bent;
mod check;
mod dual;
mod laws;
mod mend;
mod motion;
mod reader;
mod rounding;
mod stl;
mod tour;
