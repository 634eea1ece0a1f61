//! Corners on the grid -> where triangles lie: exact vectors, boxes, volumes, a tree of boxes, and what crosses.

pub mod crossings;
pub mod tree;

pub(super) mod bounds;
pub(crate) mod measure;
pub(crate) mod vector;
