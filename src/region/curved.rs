//! Tops that something else lays, along the surface: what layers leave out for them, and keep thin below.
//!
//! Such a top stands on the layers below it as it would on a bed: they are solid for as many layers as any
//! top, and none of their lines is printed for several layers near it. A thick line that ends there would
//! lie lower or higher than what the top was reckoned on.

use super::Sparse;
use super::classify::Areas;
use super::divide::LayerAreas;
use super::dual::groups::{Block, Grouping};
use super::dual::plain;
use super::scan::Scan;
use crate::geom::Contour;
use crate::geom::spans::Rows;
use crate::pattern::Turns;
use crate::slice::{Heights, Layer};
use crate::units::Coord;
use std::fmt::Debug;
use std::ops::Range;
use std::sync::OnceLock;

/// Tops that are laid along the surface.
pub trait CurvedTops: Sync + Debug {
    /// `layer` without what these tops take the place of.
    fn cut(&self, layer: Layer) -> Layer;

    /// Where the underside of one lies at `from` or higher, and lower than `below`, in plan; both above
    /// the bed, grid units.
    fn over(&self, from: Coord, below: Coord) -> Vec<Contour>;
}

/// The curved tops above the layers of a print, if there are any.
#[derive(Debug, Default)]
pub(super) struct Above<'a> {
    tops: Option<&'a dyn CurvedTops>,
    /// Whether one lies near above each layer, once that was asked for.
    near: Vec<OnceLock<bool>>,
}

impl<'a> Above<'a> {
    /// Above so many layers.
    pub(super) fn new(tops: Option<&'a dyn CurvedTops>, layers: usize) -> Self {
        let layers = if tops.is_some() { layers } else { 0 };
        Self { tops, near: vec![OnceLock::new(); layers] }
    }

    /// The tops.
    pub(super) fn tops(&self) -> Option<&'a dyn CurvedTops> {
        self.tops
    }

    /// Where none of these layers may print a line for several, below `skins` layers of skin.
    pub(super) fn near(
        &self,
        heights: &Heights,
        layers: Range<usize>,
        skins: usize,
    ) -> Vec<Contour> {
        // Shares of skin ask for layers above the last one, too.
        let known = !layers.is_empty() && layers.end <= self.near.len();
        let Some(tops) = self.tops.filter(|_| known) else { return Vec::new() };
        let last = layers.end - 1;
        let near = (skins + 1) as Coord * heights.height(last);
        tops.over(heights.top(layers.start), heights.top(last).saturating_add(near))
    }

    /// Whether one lies near above layer `k`.
    pub(super) fn is_near(&self, heights: &Heights, k: usize, skins: usize) -> bool {
        let ask = || !self.near(heights, k..k + 1, skins).is_empty();
        self.near.get(k).is_some_and(|known| *known.get_or_init(ask))
    }
}

/// These areas without the infill within `places`, and with no other infill than that.
#[must_use]
pub fn divide(areas: &LayerAreas, places: &[Contour]) -> [LayerAreas; 2] {
    let inside = areas.clone().map_on(|raster, its| {
        let rows = Scan::new(places, raster);
        let within = |of: &Rows| of.and(rows.inside());
        Areas { infill: within(&its.infill), dense: within(&its.dense), ..its }
    });
    let outside = areas.clone().map_on(|raster, its| match inside.on(raster) {
        Some(inside) => Areas {
            infill: its.infill.minus(&inside.infill),
            dense: its.dense.minus(&inside.dense),
            ..its
        },
        None => its,
    });
    [outside, inside]
}

/// The infill of each layer of a block that is printed layer by layer whatever the others do.
#[must_use]
pub fn thin_infill(
    block: &Block,
    layers: &[LayerAreas],
    grouping: &Grouping,
    turns: &Turns,
    line_width: Coord,
) -> Vec<Vec<Sparse>> {
    let of = |(k, areas): (usize, &LayerAreas)| {
        let turn = if grouping.shorter { k } else { block.turn };
        let patterns: Vec<_> = turns.of(turn).iter().chain(turns.dense(turn)).cloned().collect();
        plain(&patterns, areas, line_width)
    };
    block.layers.clone().zip(layers).map(of).collect()
}
