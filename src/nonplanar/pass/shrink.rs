//! Areas of skins and places that are refused -> smaller areas, and why each place was lost.

use super::marks::Marks;
use super::smooth::smooth;
use crate::geom::spans::Rows;
use crate::geom::{Contour, polygon};
use crate::nonplanar::grid::{self, STEP, Spot};
use crate::nonplanar::params::NonPlanarParams;
use crate::nonplanar::tally::Reason;
use crate::region::scan::Scan;
use std::collections::BTreeMap;

/// Places that are refused, each with its reason.
pub(super) type Refused = BTreeMap<Spot, Reason>;

/// Adds a place, or a reason that is told before the one that is known.
pub(super) fn refuse(refused: &mut Refused, place: Spot, reason: Reason) {
    let known = refused.entry(place).or_insert(reason);
    *known = reason.min(*known);
}

/// Refused places with all those within so many places around them.
pub(super) fn widened(refused: &Refused, by: i32) -> Refused {
    let near = |[x, y]: &Spot| x * x + y * y <= by * by;
    let disc: Vec<Spot> =
        (-by..=by).flat_map(|x| (-by..=by).map(move |y| [x, y])).filter(near).collect();
    let mut out = refused.clone();
    for ([x, y], reason) in refused {
        for [dx, dy] in &disc {
            refuse(&mut out, [x + dx, y + dy], *reason);
        }
    }
    out
}

/// Cuts refused places out of an area, then steps too small for lines, then what is narrower than three lines,
/// then what is too small.
/// The same area if nothing is lost.
pub(super) fn shrink(
    area: Vec<Contour>,
    refused: &Refused,
    marks: &mut Marks,
    params: &NonPlanarParams,
) -> Vec<Contour> {
    let before = rows(&area);
    let cut = if refused.is_empty() {
        area
    } else {
        let around = grid::around(&refused.keys().copied().collect(), params.line_width);
        let cut = grid::without(&area, &around);
        let after = rows(&cut);
        let most = most(refused);
        marks.mark_all(&before.minus(&after), |place| nearest(refused, place).unwrap_or(most));
        cut
    };
    let before = rows(&cut);
    let open = grid::opened(&smooth(cut, marks, params.line_width), params.line_width);
    marks.mark_all(&before.minus(&rows(&open)), |_| Reason::Thin);
    let all = grid::pieces(&open);
    let is_large = |piece: &Vec<Contour>| grid::area_mm2(piece) >= params.min_area;
    if all.iter().all(is_large) {
        return open;
    }
    let (large, small): (Vec<_>, Vec<_>) = all.into_iter().partition(is_large);
    marks.mark_all(&rows(&small.concat()), |_| Reason::Area);
    polygon::union(&large.concat())
}

/// Cuts refused places out of each skin's area, from the last one down, so that each stays within the next.
/// `refused` has those of each skin; those of the last one are refused to all.
pub(super) fn shrink_all(
    areas: &[Vec<Contour>],
    refused: &[Refused],
    marks: &mut Marks,
    params: &NonPlanarParams,
) -> Vec<Vec<Contour>> {
    let mut out: Vec<Vec<Contour>> = Vec::with_capacity(areas.len());
    for (i, (area, own)) in areas.iter().zip(refused).enumerate().rev() {
        let shrunk = match out.last() {
            None => shrink(area.clone(), own, marks, params),
            // Nothing changed above, nor here.
            Some(above) if own.is_empty() && areas.get(i + 1) == Some(above) => area.clone(),
            Some(above) => {
                let around = grid::around(&own.keys().copied().collect(), params.line_width);
                let within = if area == &areas[i + 1] {
                    above.clone()
                } else {
                    polygon::intersection(area, above)
                };
                let cut = smooth(grid::without(&within, &around), marks, params.line_width);
                grid::opened(&cut, params.line_width)
            }
        };
        out.push(shrunk);
    }
    out.reverse();
    out
}

/// The places inside of an area.
fn rows(area: &[Contour]) -> Rows {
    Scan::new(area, grid::raster(STEP)).inside().clone()
}

/// The reason of a refused place near another.
pub(super) fn nearest(refused: &Refused, [x, y]: Spot) -> Option<Reason> {
    let near = |by: i32| {
        let ring = (-by..=by).flat_map(move |dx| (-by..=by).map(move |dy| [x + dx, y + dy]));
        ring.filter_map(|place| refused.get(&place)).min().copied()
    };
    (0..4).find_map(near)
}

/// The most frequent reason.
pub(super) fn most(refused: &Refused) -> Reason {
    let count = |reason: &Reason| refused.values().filter(|one| *one == reason).count();
    Reason::ALL.into_iter().rev().max_by_key(count).unwrap_or(Reason::Thin)
}
