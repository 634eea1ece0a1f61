//! Profile names, files and overrides -> Settings, each value with its origin.

mod settings;

pub use settings::*;
