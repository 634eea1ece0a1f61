//! Layer + the layer below -> Overhang: what hangs, so that support must carry it.
//!
//! Words: the *lean* is how far a layer may reach out over what is printed below. A place *sags* if it
//! exceeds the lean by more than a sliver. An *island* overlaps nothing of the layer below: it begins
//! in the air.
//!
//! A slope is judged over some layers, about a millimetre: so its angle is known well. A single step
//! is judged by itself, and may be larger.
//!
//! Both layers are grown by a pitch before they are compared. So a tip, a blade or a ledge between
//! two rows is seen by both rows beside it, and an edge hangs as far as it did before.

use super::bridges::without_bridges;
use super::params::SupportParams;
use super::pieces::Pieces;
use super::printed::printed;
use crate::geom::spans::Rows;
use crate::region::per_raster::skin_turn;
use crate::region::scan::Scan;
use crate::slice::Layer;
use crate::units::{Coord, to_mm, to_units};

/// Contours are known to 10 µm, so that a straight slope has steps. A layer that leans out by less than
/// this below the lean may still be part of a slope that is too flat.
const ROUGH: Coord = 100;

/// What leans out beyond the lean over some layers, by more than this (20 µm), is too flat: the roughness
/// of two contours. Over 1 mm it shifts a threshold of 45° by half a degree.
const SLACK: Coord = 200;

/// A single layer sags that leans out beyond the lean by more than this (30 µm) and [`SAG`], whatever is
/// below: less puts specks under small steps. If there are more of them, it is a slope.
const STEP: Coord = 300;

/// See [`STEP`]; a part of a layer's height.
const SAG: f64 = 0.2;

/// Pieces of which less than a line's width squared, divided by this, sags get no support: that is
/// less than half of a dot. With more, ends of bridges and tips of edges would get a post each.
const LEAST_SAG: i64 = 2;

/// How far from a place that sags the others near it get support as well, in line widths.
const NEAR_SAG: Coord = 2;

/// Maximum lean of a layer, mm. At a threshold angle near zero nothing is an overhang, and the lean
/// grows without limit.
const MOST_LEAN_MM: f64 = 1000.0;

/// What support needs of one layer. Only what is printed counts.
pub(super) struct LayerView {
    pub(super) index: usize,
    pub(super) inside: Rows,
    /// What is printed.
    scan: Scan,
    /// The layer grown by the clearance.
    pub(super) near: Rows,
    /// The layer grown by a pitch.
    grown: Rows,
    /// The layer grown by a pitch and nearly the lean: what the layer above reaches without support.
    carries: Rows,
    /// The height at which the layer is cut.
    plane: Coord,
    /// How far the layer above reaches without sagging, and a pitch.
    firm: Coord,
}

impl LayerView {
    /// `above` is the height of the layer above.
    pub(super) fn new(layer: &Layer, above: Coord, params: &SupportParams) -> Self {
        let lean = lean(i64::from(above + layer.height) / 2, params);
        let (raster, pitch) = (params.raster(), params.raster().pitch);
        let scan = Scan::new(&printed(&layer.contours, params.printed), raster);
        Self {
            index: layer.index,
            inside: scan.inside().clone(),
            near: scan.outset(params.clearance),
            grown: scan.outset(pitch),
            plane: layer.z - layer.height / 2,
            carries: scan.outset(lean.saturating_add(pitch) - ROUGH),
            firm: lean.saturating_add(pitch + STEP + (f64::from(above) * SAG) as Coord),
            scan,
        }
    }

    /// What the layer above may reach without sagging.
    fn holds_up(&self) -> Rows {
        self.scan.outset(self.firm)
    }

    /// What a slope may reach that goes on up to `layer`, and a pitch.
    fn carries_slope(&self, layer: &Self, params: &SupportParams) -> Rows {
        let lean = lean(i64::from(layer.plane - self.plane), params);
        self.scan.outset(lean.saturating_add(params.raster().pitch + SLACK))
    }
}

/// How far a slope may lean out over a height, grid units.
fn lean(height: i64, params: &SupportParams) -> Coord {
    to_units((to_mm(height as Coord) * params.lean).min(MOST_LEAN_MM))
}

/// Where support is wanted under a layer.
#[derive(Default)]
pub(super) struct Overhang {
    /// The layer that hangs.
    pub(super) layer: usize,
    /// What hangs of it.
    pub(super) hangs: Rows,
    /// The same, grown by the outset.
    pub(super) all: Rows,
    /// The part of it that hangs on nothing at all, if that was asked for.
    pub(super) islands: Rows,
}

/// What of `layer` hangs over the one `below`. A slope is judged from `far`, some layers further down, if there is
/// such a layer.
pub(super) fn overhang(
    layer: &LayerView,
    (below, far): (&LayerView, Option<&LayerView>),
    params: &SupportParams,
) -> Overhang {
    let pitch = params.raster().pitch;
    let hanging = sagging(layer, (below, far), params);
    let turn = skin_turn(layer.index).0;
    let hanging = without_bridges(&hanging, [&layer.inside, &below.inside], turn, params);
    if hanging.is_empty() {
        return Overhang { layer: layer.index, ..Overhang::default() };
    }
    // The pitch is in the area already.
    let wide = |rows: &Rows| rows.dilate(params.outset - pitch, pitch);
    // Only those that begin within the gap above the bed get support in another way.
    let islands = if layer.index <= params.gap { islands(layer, below) } else { Rows::default() };
    let (all, islands) = (wide(&hanging), wide(&islands));
    Overhang { layer: layer.index, hangs: hanging, all, islands }
}

/// What of `layer` sags, and what is near that.
fn sagging(
    layer: &LayerView,
    (below, far): (&LayerView, Option<&LayerView>),
    params: &SupportParams,
) -> Rows {
    let hanging = layer.grown.minus(&below.carries);
    if hanging.is_empty() {
        return hanging;
    }
    let mut sags = hanging.minus(&below.holds_up());
    if let Some(far) = far {
        sags = sags.or(&hanging.minus(&far.carries_slope(layer, params)));
    }
    let pitch = params.raster().pitch;
    let hanging = hanging.and(&sags.dilate(NEAR_SAG * params.least, pitch));
    // Along an edge oblique to the rows, what hangs on one row may end before it begins on the next.
    let joined = hanging.dilate(pitch, pitch);
    let pieces = Pieces::new(&joined);
    let mut sums = vec![0; pieces.count()];
    pieces.shared(&joined, &sags, &mut sums);
    let least = i64::from(params.least).pow(2) / LEAST_SAG;
    hanging.and(&pieces.keep(&joined, |piece| sums[piece] * i64::from(pitch) >= least))
}

/// The pieces of `layer` that overlap nothing of `below`.
fn islands(layer: &LayerView, below: &LayerView) -> Rows {
    let pieces = Pieces::new(&layer.grown);
    let mut carried = vec![false; pieces.count()];
    pieces.meeting(&layer.grown, &below.carries, |piece, _| carried[piece] = true);
    pieces.keep(&layer.grown, |piece| !carried[piece])
}
