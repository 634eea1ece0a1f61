//! Random stars -> Stack: layers for property tests, prepared as the pipeline does it.

use super::solid::{Outline, star};
use proptest::prelude::*;
use slicer::geom::{Contour, Point, polygon};
use slicer::region::RegionParams;
use slicer::region::prepare::{LayerRows, Own, prepare};
use slicer::slice::Layer;
use slicer::units::{Coord, to_units};

/// A star of 3 to 12 points around a middle, mm.
pub(crate) fn stars() -> impl Strategy<Value = Outline> {
    let radii = prop::collection::vec(1.0..9.0_f64, 3..12);
    (radii, -6.0..6.0_f64, -6.0..6.0_f64)
        .prop_map(|(radii, x, y)| star(&radii).iter().map(|p| [p[0] + x, p[1] + y]).collect())
}

pub(crate) fn contour(outline: &Outline) -> Contour {
    outline.iter().map(|p| Point { x: to_units(p[0]), y: to_units(p[1]) }).collect()
}

pub(crate) fn contours(outlines: &[Outline]) -> Vec<Contour> {
    outlines.iter().map(contour).collect()
}

/// Layers, prepared as the pipeline does it.
pub(crate) struct Stack {
    pub(crate) own: Vec<Own>,
    pub(crate) rows: Vec<LayerRows>,
}

/// A stack of layers of random stars.
pub(crate) fn stack(params: &RegionParams, outlines: &[Vec<Outline>]) -> Stack {
    let prepared = |(index, outlines): (usize, &Vec<Outline>)| {
        let layer = Layer {
            index,
            z: 2000 * (index as Coord + 1),
            height: 2000,
            contours: polygon::union(&contours(outlines)),
            closed_gap: 0,
        };
        prepare(layer, params)
    };
    let (own, rows) = outlines.iter().enumerate().map(prepared).unzip();
    Stack { own, rows }
}

pub(crate) fn stacks() -> impl Strategy<Value = Vec<Vec<Outline>>> {
    prop::collection::vec(prop::collection::vec(stars(), 1..3), 1..9)
}
