//! Layer + the layer below -> Overhang: what hangs, so that support must carry it.
//!
//! Words: the *lean* is how far a layer may reach out over what is printed below. An *island*
//! overlaps nothing of the layer below: it begins in the air.
//!
//! Both layers are grown by a pitch before they are compared. So a tip, a blade or a ledge between
//! two rows is seen by both rows beside it, and an edge hangs as far as it did before.

use super::bridges::without_bridges;
use super::params::SupportParams;
use super::pieces::Pieces;
use super::printed::printed;
use crate::geom::spans::Rows;
use crate::region::scan::Scan;
use crate::slice::Layer;
use crate::units::{Coord, to_mm, to_units};

/// A layer may lean out further by this (30 µm): contours are only known to a tolerance, so that a
/// straight slope has steps. Less gives specks of support under slopes at the threshold itself; more
/// shifts the threshold, by 5° with layers of 0.2 mm.
const SLACK: Coord = 300;

/// Maximum lean of a layer, mm. At a threshold angle near zero nothing is an overhang, and the lean
/// grows without limit.
const MOST_LEAN_MM: f64 = 1000.0;

/// What support needs of one layer. Only what is printed counts.
pub(super) struct LayerView {
    pub(super) index: usize,
    pub(super) inside: Rows,
    /// The layer grown by the clearance.
    pub(super) near: Rows,
    /// The layer grown by a pitch.
    grown: Rows,
    /// The layer grown by a pitch and the lean: what the layer above may reach without support.
    carries: Rows,
}

impl LayerView {
    /// `above` is the height of the layer above.
    pub(super) fn new(layer: &Layer, above: Coord, params: &SupportParams) -> Self {
        let lean = to_units((to_mm(above) * params.lean).min(MOST_LEAN_MM)) + SLACK;
        let (raster, pitch) = (params.raster(), params.raster().pitch);
        let scan = Scan::new(&printed(&layer.contours, params.printed), raster);
        Self {
            index: layer.index,
            inside: scan.inside().clone(),
            near: scan.outset(params.clearance),
            grown: scan.outset(pitch),
            carries: scan.outset(lean.saturating_add(pitch)),
        }
    }
}

/// Where support is wanted under a layer.
#[derive(Default)]
pub(super) struct Overhang {
    /// The layer that hangs.
    pub(super) layer: usize,
    /// What hangs of it, grown by the outset.
    pub(super) all: Rows,
    /// The part of it that hangs on nothing at all, if that was asked for.
    pub(super) islands: Rows,
}

/// What of `layer` hangs over `below`.
pub(super) fn overhang(layer: &LayerView, below: &LayerView, params: &SupportParams) -> Overhang {
    let pitch = params.raster().pitch;
    let hanging = layer.grown.minus(&below.carries);
    let hanging = without_bridges(&hanging, [&layer.inside, &below.inside], params);
    if hanging.is_empty() {
        return Overhang { layer: layer.index, ..Overhang::default() };
    }
    // The pitch is in the area already.
    let wide = |rows: &Rows| rows.dilate(params.outset - pitch, pitch);
    // Only those that begin within the gap above the bed get support in another way.
    let islands = if layer.index <= params.gap { islands(layer, below) } else { Rows::default() };
    Overhang { layer: layer.index, all: wide(&hanging), islands: wide(&islands) }
}

/// The pieces of `layer` that overlap nothing of `below`.
fn islands(layer: &LayerView, below: &LayerView) -> Rows {
    let pieces = Pieces::new(&layer.grown);
    let mut carried = vec![false; pieces.count()];
    pieces.meeting(&layer.grown, &below.carries, |piece, _| carried[piece] = true);
    pieces.keep(&layer.grown, |piece| !carried[piece])
}
