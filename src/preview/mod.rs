//! Print -> pictures: what a G-code file of any slicer prints, drawn without a window.

pub mod colours;
pub mod facts;
pub mod html;
pub mod packed;
