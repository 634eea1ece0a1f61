//! Middle beads -> middle beads: their ends run on straight into the room where walls meet.
//!
//! Where walls cross or turn, there is more room than a middle bead is for, and still no core. One of
//! the beads that end there crosses it, and the others end beside that one.

use super::Layout;
use super::arcs::{Arc, is_ring};
use crate::geom::segment::{along, dot, way};
use crate::region::near::{Area, Edge, Near};
use crate::region::taper::distance;

/// How far from its end the direction of a bead is measured, in line widths: its last place may lie
/// beside the corner of a wall, which pushes it aside.
const BACK: f64 = 2.0;

/// How near its end comes to the middle of another bead, in widths of its own. At 0.5 it lies on that
/// bead with its round end; at 1 the corners beside the end stay open.
const BESIDE: f64 = 0.75;

/// How near it comes to loops, as a part of its width: as [`BESIDE`], less what the other half takes.
const CLEAR: f64 = 0.25;

/// Steps along the way, in line widths. A smaller value costs time.
const STEP: f64 = 0.125;

/// The longest way, in rooms. A crossing is as wide as the walls that meet there.
const LONGEST: f64 = 2.0;

/// Lets the ends of `arcs` run on.
pub(super) fn run_on(arcs: &mut [Arc], layout: &Layout<'_>) {
    let around = |arc: &Arc| Area::around(arc.iter().map(|s| s.place.at), 0.0).corners();
    let mut boxes: Vec<Edge> = arcs.iter().map(around).collect();
    for k in 0..arcs.len() {
        for _ in 0..2 {
            if let Some(at) = end(&arcs[k], (arcs, &boxes), k, layout)
                && let Some(last) = arcs[k].last().copied()
            {
                let mut further = last;
                further.place.at = at;
                arcs[k].push(further);
                boxes[k] = around(&arcs[k]);
            }
            arcs[k].reverse();
        }
    }
}

/// Where arc `k` of `all` ends when it runs on from its last place. `None` if there is no room. Each has a
/// box around it.
fn end(
    arc: &Arc,
    (all, boxes): (&[Arc], &[Edge]),
    k: usize,
    layout: &Layout<'_>,
) -> Option<[f64; 2]> {
    let last = arc.last().filter(|_| !is_ring(arc))?;
    let (w, width) = (layout.line_width, last.place.width);
    let before = arc.iter().rev().find(|s| distance(s.place.at, last.place.at) >= BACK * w)?;
    let back = way(before.place.at, last.place.at);
    let ahead = back.map(|x| x / dot(back, back).sqrt());
    let to_outline = f64::from(last.loops) * w + CLEAR * width - layout.params.outside();
    let inside = |at: [f64; 2]| {
        layout.outline.is_free(at, to_outline) && layout.is_clear(at, last.loops, width)
    };
    let at = |step: usize| along(last.place.at, step as f64 * STEP * w, ahead);
    if !inside(at(2)) {
        return None;
    }
    let most = LONGEST * f64::from(2 * last.loops + 1) * width / (STEP * w);
    let reached = Area::around([at(0), at(most as usize)].into_iter(), BESIDE * width);
    let is_other = |j: &usize| *j != k && reached.meets(&boxes[*j]);
    let others = (0..all.len()).filter(is_other).flat_map(|j| all[j].windows(2));
    let others = Near::of_edges(others.map(|s| [s[0].place.at, s[1].place.at]).collect(), 2.0 * w);
    let free = |&step: &usize| inside(at(step)) && others.is_free([at(step)], BESIDE * width);
    (1..most as usize).take_while(free).last().map(at)
}
