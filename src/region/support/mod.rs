//! Layers, from the top down -> SupportLayer: where support stands under overhangs, and how it is laid.
//!
//! Words: an *overhang* is what a layer reaches further out over the layer below than the
//! threshold angle allows. The *lean* is how far it may reach for each unit of its height. The
//! *gap* is the number of layers left open between part and support, above and below. The
//! *clearance* is the sideways distance from the part to the middle of a support line. The
//! *interface* is dense support next to the part, a *post* a piece of support that goes down.
//!
//! 1. `overhangs`: what hangs, on each layer. Only what is printed counts (`printed`); what
//!    bridges needs no support (`bridges`).
//! 2. `columns`: from there support goes down, layer by layer; thin posts grow on the way, and those
//!    whose load has landed end (`posts`).
//! 3. Support that stands on the part is removed if the settings allow only the bed. On the bed it
//!    gets a brim. Specks are dropped, what stands on nothing (`stand`), and what has lost all that it
//!    carried (`idle`).
//! 4. `interface`: which places are dense. The others are the `body`, which gets a zigzag, or
//!    lines and an `outline`; places far from any line are grown to one (`held`), or get lines
//!    across if they are narrow (`strips`). An outline that would have nothing below it
//!    gets one there.
//!
//! All of this happens on the rows of one raster, at most half a line apart. Layers are sliced block
//! by block.

mod body;
mod bridges;
mod columns;
mod held;
mod idle;
mod interface;
mod outline;
mod overhangs;
mod params;
mod pieces;
mod posts;
mod printed;
mod stand;
mod strips;

pub use params::{BODIES, SupportLayer, SupportParams, SupportPatterns};

use super::scan::Scan;
use crate::geom::Point;
use crate::geom::spans::Rows;
use crate::slice::{Layer, Slicer};
use columns::{Column, Window};
use interface::Divided;
use overhangs::LayerView;
use printed::printed;
use rayon::prelude::*;

/// The support of every layer, by index, on all rows of its rasters. `within` is the bed, as two
/// opposite corners of a rectangle around the origin.
#[must_use]
pub fn supports(
    slicer: &Slicer<'_>,
    params: &SupportParams,
    within: (Point, Point),
) -> Vec<SupportLayer> {
    let heights = slicer.heights();
    let mut columns = vec![Column::default(); heights.count()];
    let mut window = Window::new(params, heights);
    let view = |layer: &Layer| {
        let above = (layer.index + 1).min(heights.count() - 1);
        LayerView::new(layer, heights.height(above), params)
    };
    for block in (0..slicer.blocks()).rev() {
        let mut views: Vec<LayerView> = slicer.block(block).par_iter().map(view).collect();
        while let Some(layer) = views.pop() {
            window.push(layer, &mut columns);
        }
    }
    window.flush(&mut columns);
    if params.bed_only {
        keep_to_bed(slicer, params, &mut columns);
    }
    let (low, high) = within;
    let corners = vec![low, Point { x: high.x, y: low.y }, high, Point { x: low.x, y: high.y }];
    let bed = Scan::new(&[corners], params.raster());
    columns.par_iter_mut().for_each(|column| {
        column.all = column.all.and(bed.inside());
        column.reach = column.reach.and(bed.inside());
        column.beside = column.beside.and(bed.inside());
    });
    stand::stand(&mut columns, params);
    while idle::drop_idle(&mut columns, params) {
        stand::stand(&mut columns, params);
    }
    add_brim(slicer, params, &bed, &mut columns);
    let laid = |(k, layer): (usize, Divided)| layer.lay(k, params);
    interface::divided(columns, params).into_par_iter().enumerate().map(laid).collect()
}

/// Grows the lowest layer, to hold on to the bed.
fn add_brim(slicer: &Slicer<'_>, params: &SupportParams, bed: &Scan, columns: &mut [Column]) {
    let Some(lowest) = columns.first_mut().filter(|lowest| !lowest.all.is_empty()) else { return };
    let layers = slicer.block(0);
    let near = |layer: &Layer| scan(layer, params).outset(params.clearance);
    if let Some(near) = layers.first().map(near) {
        let grown = lowest.all.dilate(params.brim, params.raster().pitch);
        lowest.all = lowest.all.or(&grown.minus(&near).and(bed.inside()));
    }
}

/// Removes support that stands on the part: everything above any layer below it.
fn keep_to_bed(slicer: &Slicer<'_>, params: &SupportParams, columns: &mut [Column]) {
    let mut shadow = Rows::default();
    for block in 0..slicer.blocks() {
        let layers = slicer.block(block);
        let near: Vec<Rows> =
            layers.par_iter().map(|layer| scan(layer, params).outset(params.clearance)).collect();
        for (layer, near) in layers.iter().zip(&near) {
            let column = &mut columns[layer.index];
            column.all = column.all.minus(&shadow);
            column.reach = column.reach.minus(&shadow);
            shadow = shadow.or(near);
        }
    }
}

/// What is printed of a layer, on the rows of support.
fn scan(layer: &Layer, params: &SupportParams) -> Scan {
    Scan::new(&printed(&layer.contours, params.printed), params.raster())
}
