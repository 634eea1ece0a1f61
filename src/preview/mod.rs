//! Print -> pictures: what a G-code file of any slicer prints, drawn without a window.

pub mod colours;
