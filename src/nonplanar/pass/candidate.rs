//! Surface -> Pieces: what of it may become skin, as far as that can be told from the surface alone.
//!
//! 1. Too near to the bed for a base, or too near to the ceiling for a travel: cut off at a height.
//! 2. Steeper than the flat may press, or under support: refused.
//! 3. What is left is divided into pieces. On each the head is tried over the whole of it, as if all of
//!    it stood: what the surface itself is in the way of is refused.
//! 4. What is left is divided again. Each piece has a home of its own. What no tread crosses stays flat: a
//!    rim that rises by a tenth of a layer gains nothing.
//!
//! The *home* of a piece is the last layer whose middle lies a skin height below the piece's highest
//! place. There the base is whole, however many skins lie where; all that stands is lower than the
//! piece's top; and the level lines that come later beside the skins are at most half a layer lower
//! than these.

use super::glance::{Glance, Under};
use super::marks::Marks;
use super::shrink::{Refused, refuse, shrink};
use super::touch::mm;
use crate::geom::Contour;
use crate::geom::boxes::extent;
use crate::geom::spans::Rows;
use crate::head::pile::Pile;
use crate::nonplanar::field::Field;
use crate::nonplanar::grid::{self, CELL, STEP, Spot, cell_of};
use crate::nonplanar::scene::Scene;
use crate::nonplanar::surface::Surface;
use crate::nonplanar::tally::Reason;
use crate::region::scan::around;
use crate::units::{Coord, to_mm};
use rayon::prelude::*;
use std::sync::Arc;

/// Heights differ by no more than this from those of cells, mm.
const SLACK: f64 = 0.1;

/// A surface, and what is known of its places.
pub(super) struct Ground {
    pub field: Field,
    pub marks: Marks,
}

/// A piece of a surface that may become a patch.
#[derive(Clone)]
pub(super) struct Piece {
    /// Its surface, by number.
    pub surface: usize,
    /// Where it lies in plan.
    pub area: Vec<Contour>,
    /// Its lowest and highest z, grid units.
    pub bounds: [f64; 2],
    /// The layer that it is printed after.
    pub home: usize,
    /// Its skins as they stand when all are laid.
    pub own: Arc<Pile>,
    /// Where these skins are not in the way of the head, at a glance.
    pub glance: Arc<Option<Glance>>,
}

/// The pieces of surface `number`.
pub(super) fn pieces(scene: &Scene<'_>, number: usize, surface: &Surface) -> (Ground, Vec<Piece>) {
    let field = Field::new(surface);
    let mut marks = Marks::new(&field, surface);
    let area = between(scene, surface, &field, &mut marks);
    let refused = refused(scene, &field, &marks);
    // A part that is drawn in carries no skin along its upright sides.
    let drawn_in = -scene.params.outline;
    let area =
        if drawn_in > 0 { grid::without(&area, &surface.near_upright(drawn_in)) } else { area };
    let area = shrink(area, &refused, &mut marks, scene.params);
    let mut out = Vec::new();
    for whole in grid::pieces(&area) {
        let (own, glance) = standing(scene, &field, &whole);
        let (own, glance) = (Arc::new(own), Arc::new(glance));
        let refused = in_its_own_way(scene, &field, (&own, &glance), &whole);
        let left = shrink(whole, &refused, &mut marks, scene.params);
        for area in grid::pieces(&left) {
            let Some(bounds) = surface.over(&area) else { continue };
            match home(scene, bounds[1]) {
                Some(_) if !has_treads(scene, bounds) => marks.mark_level(&places(&area)),
                Some(home) => {
                    let (own, glance) = (Arc::clone(&own), Arc::clone(&glance));
                    out.push(Piece { surface: number, area, bounds, home, own, glance });
                }
                None => marks.mark_all(&places(&area), |_| Reason::Overhang),
            }
        }
    }
    (Ground { field, marks }, out)
}

/// Whether what lies between two heights would be printed with a tread: the middle of a layer lies there.
/// Without one it is as smooth printed flat, and no skin is worth its lines.
pub(super) fn has_treads(scene: &Scene<'_>, bounds: [f64; 2]) -> bool {
    let heights = scene.slicer.heights();
    let [below, all] = bounds.map(|z| heights.planes_up_to(z.floor() as Coord));
    below < all
}

/// The places of an area.
pub(super) fn places(area: &[Contour]) -> Rows {
    crate::region::scan::Scan::new(area, grid::raster(STEP)).inside().clone()
}

/// The last layer whose middle lies a skin height below `high`.
pub(super) fn home(scene: &Scene<'_>, high: f64) -> Option<usize> {
    let below = high - f64::from(scene.params.height);
    scene.slicer.heights().planes_up_to(below.ceil() as Coord - 1).checked_sub(1)
}

/// The part of a surface that has room for a base below it and for travels above.
fn between(scene: &Scene<'_>, surface: &Surface, field: &Field, marks: &mut Marks) -> Vec<Contour> {
    let heights = scene.slicer.heights();
    if heights.count() == 0 {
        return Vec::new();
    }
    let low = heights.plane(0).saturating_add(scene.depth());
    let high = scene.ceiling.saturating_sub(scene.params.clearance);
    let [lowest, highest] = surface.bounds();
    if low <= lowest && highest < high {
        return surface.outline().to_vec();
    }
    let told: Vec<(Spot, Reason)> = marks
        .places()
        .filter_map(|place| {
            let z = field.at(cell_of(place))?;
            let reason = if z < f64::from(low) { Reason::Overhang } else { Reason::ZLimit };
            (z < f64::from(low) || z >= f64::from(high)).then_some((place, reason))
        })
        .collect();
    told.into_iter().for_each(|(place, reason)| marks.mark(place, reason));
    surface.between(low, high)
}

/// Places that are too steep, or that support stands on.
fn refused(scene: &Scene<'_>, field: &Field, marks: &Marks) -> Refused {
    let params = scene.params;
    // The uphill edge of the flat presses no deeper than a layer.
    let most = to_mm(params.height) / (params.head.flat / 2.0).max(1e-9) * (1.0 + 1e-6);
    let places: Vec<Spot> = marks.places().collect();
    let steep = |place: &Spot| {
        let [x, y] = field.rise(cell_of(*place));
        (x.hypot(y) > most).then_some((*place, Reason::Press))
    };
    let steep: Vec<(Spot, Reason)> = places.par_iter().filter_map(steep).collect();
    let mut out: Refused = steep.into_iter().collect();
    under_support(scene, field, &places, &mut out);
    out
}

/// Places that support stands on, or within a line of it.
fn under_support(scene: &Scene<'_>, field: &Field, places: &[Spot], out: &mut Refused) {
    let Some(props) = scene.support else { return };
    let params = scene.params;
    let zs = || places.iter().filter_map(|&place| field.at(cell_of(place)));
    let (low, high) = zs().fold((f64::MAX, f64::MIN), |(l, h), z| (l.min(z), h.max(z)));
    let heights = scene.slicer.heights();
    let above = f64::from(props.gap.saturating_add(2 * params.height));
    let first = heights.planes_up_to((low - f64::from(params.height)) as Coord);
    let last = heights.planes_up_to((high + above) as Coord);
    let stands = |k: usize| {
        let lines = (props.lines)(k).into_iter();
        let lines: Vec<_> =
            lines.map(|[a, b]| (a, b, props.width / 2 + params.line_width)).collect();
        (f64::from(heights.plane(k)), around(&lines, grid::raster(STEP)))
    };
    let layers: Vec<(f64, Rows)> = (first..last).into_par_iter().map(stands).collect();
    for &place in places {
        let Some(z) = field.at(cell_of(place)) else { continue };
        let over = |(plane, rows): &(f64, Rows)| {
            let x = place[0] * STEP;
            (z - f64::from(params.height)..z + above).contains(plane)
                && rows.row(place[1]).iter().any(|span| span.start <= x && x < span.end)
        };
        if layers.iter().any(over) {
            refuse(out, place, Reason::Support);
        }
    }
}

/// The surface over an area as it stands when all skins are laid.
fn standing(scene: &Scene<'_>, field: &Field, area: &[Contour]) -> (Pile, Option<Glance>) {
    let (low, high) = extent(area.iter().flatten()).unwrap_or_default();
    let floor = |v: Coord| v.div_euclid(CELL) - 1;
    let low = [floor(low.x), floor(low.y)];
    let high = [floor(high.x) + 3, floor(high.y) + 3];
    let corner = |cell: Spot| grid::middle(cell).map(|v| v - to_mm(CELL) / 2.0);
    let mut pile = Pile::new(corner(low), corner(high), to_mm(CELL));
    let [columns, rows] = pile.size();
    let mut heights = vec![f32::NEG_INFINITY; columns * rows];
    for (j, row) in grid::cells(area).iter() {
        for &span in row {
            let over = grid::columns(span, CELL);
            let at = [over.start - low[0], j - low[1]].map(|v| usize::try_from(v).unwrap_or(0));
            let z = |column: i32| field.at([column, j]).map_or(f64::NAN, mm);
            pile.raise_cells(at, over.clone().map(z));
            let line = &mut heights[at[1] * columns + at[0]..];
            for (height, z) in line.iter_mut().zip(over.map(z)).filter(|(_, z)| !z.is_nan()) {
                *height = z as f32;
            }
        }
    }
    let known = || heights.iter().copied().filter(|z| z.is_finite()).map(f64::from);
    let most = known().fold(f64::MIN, f64::max) - known().fold(f64::MAX, f64::min);
    let layer = scene.params.press_layer_at_places();
    let under = Under::pressing(&scene.params.head, layer, most + SLACK, None);
    (pile, under.map(|under| Glance::new(low, columns, heights, under)))
}

/// Places where the head would touch the surface itself.
fn in_its_own_way(
    scene: &Scene<'_>,
    field: &Field,
    (own, glance): (&Pile, &Option<Glance>),
    area: &[Contour],
) -> Refused {
    let (params, layer) = (scene.params, scene.params.press_layer_at_places());
    let tried = |place: &Spot| {
        let cell = cell_of(*place);
        let is_clear = |z: f64| glance.as_ref().is_some_and(|glance| glance.is_clear(cell, mm(z)));
        let z = field.at(cell).filter(|z| !is_clear(*z))?;
        let [x, y] = grid::middle(cell);
        let hit = own.hit_printing(&params.head, [x, y, mm(z)], layer);
        hit.map(|_| (*place, Reason::Cone))
    };
    let places = grid::places(area, params.line_width / 2);
    places.par_iter().filter_map(tried).collect::<Vec<_>>().into_iter().collect()
}
