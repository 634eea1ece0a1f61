//! Neighbouring layers' rows -> Areas: which stretch of each raster line is skin, which sparse infill.
//!
//! With `n` skin layers a place is sparse infill where all of the `n` layers below and above
//! cover it, else skin. A neighbour covers with its walls, nearly up to its contour; skin and
//! infill begin inside this layer's walls. So a steep slope, which the walls already close, gets
//! no thin ring of skin. Skin reaches a little under or over what covers it, to hold on.

use super::params::{NOISE, SkinParams};
use super::prepare::LayerRows;
use crate::geom::raster::Raster;
use crate::geom::spans::{Rows, Span, intersect, subtract};
use crate::units::Coord;
use std::sync::Arc;

/// Skin and sparse infill of one layer on one raster. They are disjoint. Together they are the
/// layer's fill rows without what wall beads take, on the rasters of skins; on others infill also keeps
/// off the skin lines that are printed.
#[derive(Debug, Clone, Default)]
pub struct Areas {
    /// Solid lines.
    pub skin: Arc<Rows>,
    /// Sparse lines.
    pub infill: Rows,
    /// Solid infill in rooms too narrow for sparse lines.
    pub dense: Rows,
    /// All together: the fill rows without what wall beads take.
    pub fill: Arc<Rows>,
}

/// Where a neighbour of layer `k` leaves it exposed, on `raster`. `layers(k)` is `None` outside
/// the part.
#[must_use]
pub fn exposed<'a>(
    k: usize,
    raster: Raster,
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    params: &SkinParams,
) -> Rows {
    let Some(rows) = layers(k).and_then(|rows| rows.on(raster)) else { return Rows::default() };
    let cover = |rows: &'a LayerRows| rows.on(raster).map(|rows| &rows.cover);
    let neighbours: Option<Vec<&Rows>> =
        neighbours(k, layers, params).and_then(|all| all.into_iter().map(cover).collect());
    let mut out = Rows::with_room(rows.fill.range().start, rows.fill.range().len(), 0);
    let (mut covered, mut left) = (Covered::default(), Vec::new());
    for (j, row) in rows.fill.iter() {
        left.clear();
        match &neighbours {
            Some(neighbours) => {
                covered.subtract(row, neighbours.iter().map(|c| c.row(j)), &mut left)
            }
            None => left.extend_from_slice(row),
        }
        let kept = left.iter().filter(|span| span.len() >= NOISE);
        out.push_row(|spans| spans.extend(kept));
    }
    out
}

/// Divides the `fill` rows of a layer into skin and infill. `pitch` is the distance of the rows;
/// `solid` is where rooms are too narrow for sparse lines.
#[must_use]
pub fn areas(
    fill: &Arc<Rows>,
    exposed: &Rows,
    solid: Option<&Rows>,
    pitch: Coord,
    params: &SkinParams,
) -> Areas {
    let skin = fill.and(&exposed.dilate(params.reach, pitch));
    let infill = fill.minus(&skin);
    let areas = bridge_gaps(fill, skin, infill, 2 * params.line_width);
    match solid {
        Some(solid) => areas.with_dense(solid),
        None => areas,
    }
}

/// Divides what wall beads leave of a layer. `taken` is their area, in which no line may end.
#[must_use]
pub fn areas_beside(
    taken: &Rows,
    fill: &Rows,
    exposed: &Rows,
    solid: Option<&Rows>,
    pitch: Coord,
    params: &SkinParams,
) -> Areas {
    let fill = Arc::new(fill.minus(taken));
    let left = exposed.minus(taken).filter(|_, span| span.len() >= NOISE);
    areas(&fill, &left, solid, pitch, params)
}

impl Areas {
    /// These areas with the part of the infill in `solid` dense.
    fn with_dense(self, solid: &Rows) -> Self {
        let dense = self.infill.and(solid);
        if dense.is_empty() {
            return self;
        }
        Self { infill: self.infill.minus(&dense), dense, ..self }
    }

    /// These areas without the infill in `taken`.
    #[must_use]
    pub fn beside(self, taken: &Rows) -> Self {
        Self { infill: self.infill.minus(taken), ..self }
    }

    /// These areas with this part of what is dense skin.
    #[must_use]
    pub fn with_skin_of(self, dense: &Rows) -> Self {
        let skin = Arc::new(self.skin.or(dense));
        Self { skin, dense: self.dense.minus(dense), ..self }
    }

    /// These areas with the part of the infill in `strips` skin.
    #[must_use]
    pub fn with_skin(self, strips: &Rows) -> Self {
        let skin = Arc::new(self.skin.or(&self.infill.and(strips)));
        Self { skin, infill: self.infill.minus(strips), ..self }
    }
}

/// The layers that have to cover a place of layer `k` so that it is no skin. `None` if one of them is
/// outside the part, or if all is skin: then nothing is covered.
pub(super) fn neighbours<'a>(
    k: usize,
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    params: &SkinParams,
) -> Option<Vec<&'a LayerRows>> {
    if params.everywhere {
        return None;
    }
    let below = (1..=params.bottom).map(|n| k.checked_sub(n).and_then(layers));
    let above = (1..=params.top).map(|n| layers(k + n));
    below.chain(above).collect()
}

/// What all neighbours cover of a row; the lists are used again for each row.
#[derive(Default)]
struct Covered {
    now: Vec<Span>,
    next: Vec<Span>,
}

impl Covered {
    /// Appends to `left` what one of the `covers` leaves of a `row`.
    fn subtract<'a>(
        &mut self,
        row: &[Span],
        covers: impl Iterator<Item = &'a [Span]>,
        left: &mut Vec<Span>,
    ) {
        let ([first, .., last] | [first @ last]) = row else { return };
        // Mostly one span covers all there is.
        let is_whole =
            |cover: &[Span]| matches!(cover, [c] if c.start <= first.start && last.end <= c.end);
        let mut partial = covers.filter(|cover| !is_whole(cover)).peekable();
        if partial.peek().is_none() {
            return;
        }
        self.now.clear();
        self.now.extend_from_slice(row);
        for cover in partial {
            self.next.clear();
            intersect(&self.now, cover, &mut self.next);
            std::mem::swap(&mut self.now, &mut self.next);
        }
        subtract(row, &self.now, left);
    }
}

/// Turns infill shorter than `least` between two pieces of skin into skin. Such a hole would
/// cost more time in turns than it saves material.
fn bridge_gaps(fill: &Arc<Rows>, skin: Rows, infill: Rows, least: Coord) -> Areas {
    let is_gap = |j: i32, span: Span| {
        span.len() < i64::from(least)
            && skin.span_at(j, span.start).is_some_and(|s| s.end == span.start)
            && skin.span_at(j, span.end).is_some_and(|s| s.start == span.end)
    };
    if !infill.iter().any(|(j, row)| row.iter().any(|&s| is_gap(j, s))) {
        return Areas { skin: Arc::new(skin), infill, fill: fill.clone(), ..Areas::default() };
    }
    let infill = infill.filter(|j, span| !is_gap(j, span));
    let skin = Arc::new(fill.minus(&infill));
    Areas { skin, infill, fill: fill.clone(), ..Areas::default() }
}
