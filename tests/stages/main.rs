//! The library's stages -> laws: calls each stage with values made in code, and tests what it returns.

#[path = "../common/mod.rs"]
mod common;

mod bent;
mod blocks;
mod check;
mod dual;
mod firmware;
mod harm;
mod laws;
mod mend;
mod motion;
mod reader;
mod rounding;
mod send;
mod slope;
mod slopes;
mod sound;
mod steps;
mod stl;
mod tour;
mod weak;
