//! Toolpaths -> G-code text.

pub mod template;
