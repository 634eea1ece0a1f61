//! Pieces and what passed of them -> Pieces of lower homes, where that may give more.
//!
//! A piece is tried at the home of its highest place, when all up to there stands. Where that place can never
//! pass, the rest was tried too late: walls beside it had grown by then. So such places are cut off, and what
//! is left is tried again. Where it falls apart, each part has a home of its own. Never are places that
//! - are *hidden*: the part goes on right above them, as where two shells overlap;
//! - have no room for a line, or support on them: that does not change with the home.
//!
//! What is cut off keeps its reason. A piece is only divided if something was in its way that stands later
//! than the new home. Homes only get lower.

use super::Run;
use super::candidate::{Ground, Piece, home, places};
use super::marks::Marks;
use super::stack::Stack;
use crate::geom::Contour;
use crate::nonplanar::grid::{self, STEP, Spot};
use crate::nonplanar::scene::Scene;
use crate::nonplanar::surface::Surface;
use crate::nonplanar::tally::Reason;
use crate::units::{Coord, to_mm};
use std::collections::BTreeSet;

/// Less than this share of the least area of a patch is not worth another run.
const WORTH: f64 = 0.5;

/// The pieces of the next run; `None` if it would give no more. What is cut off is told to `grounds`.
pub(super) fn lower(scene: &Scene<'_>, grounds: &mut [Ground], run: &Run) -> Option<Vec<Piece>> {
    let mut out = Vec::new();
    let mut any = false;
    for (ground, before) in grounds.iter_mut().zip(&run.before) {
        ground.marks = before.clone();
    }
    for piece in &run.pieces {
        let surface = scene.surfaces.surfaces.get(piece.surface)?;
        let (ground, marks) = (&mut grounds[piece.surface], &run.marks[piece.surface]);
        let Some(parts) = divided(scene, (surface, piece), ground, marks) else {
            out.push(piece.clone());
            continue;
        };
        any = true;
        told((marks, &mut ground.marks), &piece.area, &parts);
        out.extend(parts);
    }
    any.then_some(out)
}

/// The parts of a piece that are to be tried instead of it.
fn divided(
    scene: &Scene<'_>,
    (surface, piece): (&Surface, &Piece),
    ground: &Ground,
    marks: &Marks,
) -> Option<Vec<Piece>> {
    let all = grid::spots(&places(&piece.area), STEP);
    let is_late =
        |p: &&Spot| matches!(marks.reason(**p), Some(Reason::Obstacle | Reason::Neighbour));
    let late = all.iter().filter(is_late).count() as f64 * to_mm(STEP).powi(2);
    let params = scene.params;
    if late < WORTH * params.min_area {
        return None;
    }
    let area = left(scene, ground, piece, (marks, &all));
    let opened = grid::opened(&area, params.line_width);
    let part = |area: Vec<Contour>| {
        let bounds = surface.over(&area).filter(|_| grid::area_mm2(&area) >= params.min_area)?;
        let home = home(scene, bounds[1])?;
        Some(Piece { area, bounds, home, ..piece.clone() })
    };
    let parts: Vec<Piece> = grid::pieces(&opened).into_iter().filter_map(part).collect();
    parts.iter().any(|part| part.home < piece.home).then_some(parts)
}

/// What of a piece is not for ever refused.
fn left(
    scene: &Scene<'_>,
    ground: &Ground,
    piece: &Piece,
    (marks, all): (&Marks, &[Spot]),
) -> Vec<Contour> {
    let first = scene.slicer.heights().planes_up_to(piece.bounds[0] as Coord);
    // For its sections alone.
    let mut stack = Stack::new(scene, first, (0..1, 0..1));
    let hidden = stack.beneath(&ground.field, &piece.area, piece.bounds[1]);
    let never = |p: &&Spot| matches!(marks.reason(**p), Some(Reason::Overhang | Reason::Support));
    let refused: BTreeSet<Spot> = hidden
        .into_iter()
        .map(|cell| cell.map(|v| v.div_euclid(2)))
        .chain(all.iter().filter(never).copied())
        .collect();
    grid::without(&piece.area, &grid::around(&refused, scene.params.line_width))
}

/// Places of a piece that are in none of its parts keep the reason of the last run.
fn told((of, to): (&Marks, &mut Marks), piece: &[Contour], parts: &[Piece]) {
    let kept: Vec<Contour> = parts.iter().flat_map(|part| part.area.iter().cloned()).collect();
    let left = places(piece).minus(&places(&kept));
    to.mark_all(&left, |place| of.reason(place).unwrap_or(Reason::Obstacle));
}
