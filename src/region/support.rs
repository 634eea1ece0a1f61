//! Layers, from the top down -> Rows: where support stands under overhangs.
//!
//! Words: an *overhang* is what a layer reaches further out over the layer below than the
//! threshold angle allows. The *lean* is how far it may reach for each unit of its height. The
//! *gap* is the number of layers left open between part and support, above and below. The
//! *clearance* is the sideways distance from the part to the middle of a support line.
//!
//! Algorithm, from the top down, with the overhang `O(k)` of layer `k` grown by the outset, the
//! contours `L(k)`, and the support `S(k)`:
//! `S(k) = (O(k+1+gap) ∪ S(k+1)) − outset(L(k), clearance)`, less the layers within the gap.
//! So support goes down until it reaches the bed or the part. All of this happens on the rows
//! of one raster. A window keeps only the layers within the gap; layers are sliced block by block.
//!
//! In the end, support that stands on the part is removed if the settings allow only the bed, and
//! everything beyond the bed and shorter than a line width is dropped.

use super::scan::Scan;
use crate::geom::Point;
use crate::geom::raster::Raster;
use crate::geom::spans::{Rows, Span, subtract};
use crate::pattern::{Lines, Pattern};
use crate::profile::{Settings, SupportBase};
use crate::slice::{Layer, Slicer};
use crate::units::{Coord, to_mm, to_units};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::sync::Arc;

/// Shorter overhangs on a row are dropped as noise of the contours (50 µm). A smaller value lets
/// specks grow by the outset to columns of support; a larger one misses thin ledges.
const LEAST_OVERHANG: Coord = 500;

/// Maximum lean of a layer, mm. At a threshold angle near zero nothing is an overhang, and the lean
/// grows without limit.
const MOST_LEAN_MM: f64 = 1000.0;

/// The numbers of support, in grid units.
#[derive(Debug, Clone, Copy)]
pub struct SupportParams {
    /// The lines, on rows fine enough to find every overhang.
    lines: Lines,
    /// How far a layer may reach out without support, for each unit of its height.
    lean: f64,
    outset: Coord,
    /// Distance from the part to the middle of a support line, sideways.
    clearance: Coord,
    /// Layers left open above and below support.
    gap: usize,
    bed_only: bool,
    least: Coord,
}

impl SupportParams {
    /// The pattern that fills support.
    #[must_use]
    pub fn pattern(&self) -> Pattern {
        Arc::new(self.lines)
    }

    /// The raster on whose rows support is computed.
    fn raster(&self) -> Raster {
        self.lines.raster
    }

    /// Derives the numbers from `settings`; `None` if support is off.
    #[must_use]
    pub fn new(settings: &Settings) -> Option<Self> {
        let support = &settings.support;
        let (w, spacing) = (to_units(settings.line_width), to_units(support.spacing));
        let lines = Lines::new(settings.angle.degrees(), spacing, w);
        let angle = support.threshold_angle.to_radians();
        let lean =
            if support.threshold_angle >= 90.0 { 0.0 } else { libm::cos(angle) / libm::sin(angle) };
        support.enabled.then(|| Self {
            lines,
            lean,
            outset: to_units(support.expansion),
            clearance: to_units(support.xy_distance) + w / 2,
            gap: (support.z_distance / settings.layer_height).round() as usize,
            bed_only: support.stands_on == SupportBase::Bed,
            least: w,
        })
    }
}

/// What support needs of one layer.
struct LayerView {
    index: usize,
    inside: Rows,
    /// The part grown by the clearance.
    near: Rows,
    /// The part grown by the lean: what the layer above may reach without support.
    carries: Rows,
}

impl LayerView {
    /// `above` is the height of the layer above.
    fn new(layer: &Layer, above: Coord, params: &SupportParams) -> Self {
        let lean = to_units((to_mm(above) * params.lean).min(MOST_LEAN_MM));
        let scan = Scan::new(&layer.contours, params.raster());
        Self {
            index: layer.index,
            inside: scan.inside().clone(),
            near: scan.outset(params.clearance),
            carries: scan.outset(lean),
        }
    }
}

/// The support of every layer, by index, on all rows of its raster. `within` is the bed, as two
/// opposite corners of a rectangle around the origin.
#[must_use]
pub fn supports(slicer: &Slicer<'_>, params: &SupportParams, within: (Point, Point)) -> Vec<Rows> {
    let heights = slicer.heights();
    let mut columns = vec![Rows::default(); heights.count()];
    let mut window = Window::default();
    let view = |layer: &Layer| {
        let above = (layer.index + 1).min(heights.count() - 1);
        LayerView::new(layer, heights.height(above), params)
    };
    for block in (0..slicer.blocks()).rev() {
        let mut views: Vec<LayerView> = slicer.block(block).par_iter().map(view).collect();
        while let Some(layer) = views.pop() {
            window.push(layer, params, &mut columns);
        }
    }
    window.flush(params, &mut columns);
    if params.bed_only {
        keep_to_bed(slicer, params, &mut columns);
    }
    let (low, high) = within;
    let corners = vec![low, Point { x: high.x, y: low.y }, high, Point { x: low.x, y: high.y }];
    let bed = Scan::new(&[corners], params.raster());
    let long = |_, span: Span| span.len() >= i64::from(params.least);
    columns.par_iter().map(|rows| rows.and(bed.inside()).filter(long)).collect()
}

/// The layers around the one whose support is computed, from the top down.
#[derive(Default)]
struct Window {
    /// Highest first.
    layers: VecDeque<LayerView>,
    /// Grown overhangs that wait for the layer where their support begins, highest first.
    overhangs: VecDeque<Rows>,
    /// Support of the layer above.
    above: Rows,
    /// Number of layers in the window that are done.
    done: usize,
}

impl Window {
    /// Takes the next layer down and computes the support of the one `gap` layers above it.
    fn push(&mut self, layer: LayerView, params: &SupportParams, out: &mut [Rows]) {
        if let Some(over) = self.layers.back() {
            let hanging = over
                .inside
                .minus(&layer.carries)
                .filter(|_, s| s.len() >= i64::from(LEAST_OVERHANG));
            self.overhangs.push_back(hanging.dilate(params.outset, params.raster().pitch));
        }
        self.layers.push_back(layer);
        if self.layers.len() > params.gap {
            let at = self.layers.len() - 1 - params.gap;
            self.support(at, params, out);
        }
        // A layer is needed until the one `gap` below it is done.
        if self.layers.len() > 2 * params.gap + 1 {
            self.layers.pop_front();
            self.done -= 1;
        }
    }

    /// Computes the support of the lowest layers, which have fewer than `gap` below them.
    fn flush(&mut self, params: &SupportParams, out: &mut [Rows]) {
        while self.done < self.layers.len() {
            self.support(self.done, params, out);
        }
    }

    /// Computes the support of the layer at index `at` of the window.
    fn support(&mut self, at: usize, params: &SupportParams, out: &mut [Rows]) {
        let layer = &self.layers[at];
        // Support of the overhang of layer k + 1 + gap begins at layer k.
        let begins = out.len() > layer.index + 1 + params.gap;
        let new =
            if begins { self.overhangs.pop_front().unwrap_or_default() } else { Rows::default() };
        let mut rows = join_gaps(&self.above.or(&new).minus(&layer.near), layer, params.least);
        let around = at.saturating_sub(params.gap)..(at + params.gap + 1).min(self.layers.len());
        for other in around.filter(|&n| n != at) {
            rows = rows.minus(&self.layers[other].inside);
        }
        out[layer.index] = rows.clone();
        self.above = rows;
        self.done = at + 1;
    }
}

/// Joins support on both sides of a gap that is at most two lines wide and free of the part. Such
/// a gap is left over from something above and only costs travels.
fn join_gaps(rows: &Rows, layer: &LayerView, line_width: Coord) -> Rows {
    let mut out = Rows::starting_at(rows.range().start);
    let mut free = Vec::new();
    for (j, row) in rows.iter() {
        out.push_row(|spans| {
            let base = spans.len();
            for &span in row {
                let gap = spans[base..].last().and_then(|last| Span::new(last.end, span.start));
                free.clear();
                subtract(gap.as_slice(), layer.near.row(j), &mut free);
                let narrow = gap.is_none_or(|gap| gap.len() <= 2 * i64::from(line_width));
                match spans[base..].last_mut() {
                    Some(last) if narrow && free == gap.as_slice() => last.end = span.end,
                    _ => spans.push(span),
                }
            }
        });
    }
    out
}

/// Removes support that stands on the part: everything above any layer below it.
fn keep_to_bed(slicer: &Slicer<'_>, params: &SupportParams, columns: &mut [Rows]) {
    let mut shadow = Rows::default();
    for block in 0..slicer.blocks() {
        let layers = slicer.block(block);
        let near: Vec<Rows> = layers
            .par_iter()
            .map(|l| Scan::new(&l.contours, params.raster()).outset(params.clearance))
            .collect();
        for (layer, near) in layers.iter().zip(&near) {
            columns[layer.index] = columns[layer.index].minus(&shadow);
            shadow = shadow.or(near);
        }
    }
}
