//! Rows of two crossing rasters -> Crossed: an area seen along its lines and across them.

use crate::geom::spans::Rows;

/// An area of a layer, on the raster that is printed and on the one across it.
#[derive(Debug, Clone, Copy)]
pub struct Crossed<'a> {
    /// The area on the raster that is printed.
    pub skin: &'a Rows,
    /// Where lines may run, on the same raster.
    pub fill: &'a Rows,
    /// The area on the raster across.
    pub columns: &'a Rows,
    /// Where lines may run, on the raster across.
    pub fill_columns: &'a Rows,
    /// The raster across is turned by +90° (else by −90°).
    pub left_turn: bool,
}
