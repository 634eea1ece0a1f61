//! Slices STL models into G-code for FDM printers, with dual injection: walls
//! and skins at the fine layer height, sparse infill on one layer of each pair
//! with twice the material.

pub mod error;
pub mod geom;
pub mod mesh;
pub mod profile;
pub mod units;
pub mod warning;
