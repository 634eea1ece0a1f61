//! Filled -> how much of the innermost walls sparse infill touches.
//!
//! Infill that does not touch the walls holds nothing. A place of a wall's edge is touched if the edge
//! of a bead of infill lies within [`GAP`]. Both are as wide as boxes of their plastic: what files
//! say of widths differs from slicer to slicer. Thick beads count on all layers that they fill.

use super::beads::place;
use super::capsule::Capsule;
use super::filled::Filled;
use super::finding::{Code, Finding, Findings, Place, short};
use super::part::extent_of;
use super::rows::Lattice;
use super::samples::Samples;
use super::terms::Terms;
use crate::geom::segment;
use crate::reader::Role;
use crate::reader::print::Step;
use rayon::prelude::*;

/// Edges this near touch, mm: an eighth of a line.
const GAP: f64 = 0.05;

/// Least share of the innermost walls that infill touches: other slicers reach 0.25 to 0.5.
const LEAST: f64 = 0.25;

/// Length of walls beside infill from which on that is judged, mm.
const ENOUGH: f64 = 200.0;

/// No bead is wider than this, mm: what is, is priming.
const WIDEST: f64 = 0.8;

/// Distance of rows, mm, and rows of a layer at most.
const PITCH: f64 = 0.05;
const MOST_ROWS: f64 = 6000.0;

/// Length of the pieces in which walls are looked at, mm: half a line.
const PIECE: f64 = 0.2;

/// What was measured on a layer.
#[derive(Clone, Copy, Default)]
struct Contact<'a> {
    /// Length of the innermost walls, and what of it is touched, mm.
    length: f64,
    touched: f64,
    /// The longest stretch that is not, mm, its wall and its end.
    longest: f64,
    at: Option<(&'a Step, [f64; 2])>,
}

/// Judges the whole print: directions of infill change from layer to layer, and so does what they
/// touch. The place is that of the longest wall without infill on the layer with most of them.
pub(super) fn check(filled: &Filled<'_>, terms: &Terms, found: &mut Findings) {
    let print = filled.print;
    let ends = print
        .lines()
        .flat_map(|step| [step.from, step.to].map(|at| [f64::from(at[0]), f64::from(at[1])]));
    let Some((low, high)) = extent_of(ends) else { return };
    let lattice = Lattice::new(PITCH, high[1] - low[1], MOST_ROWS);
    let layers = (0..print.layers.len()).into_par_iter();
    let judged: Vec<Contact<'_>> =
        layers.map(|layer| contact((filled, terms), lattice, layer)).collect();
    let sum = |of: fn(&Contact<'_>) -> f64| judged.iter().map(of).sum::<f64>();
    let (length, touched) = (sum(|one| one.length), sum(|one| one.touched));
    if length < ENOUGH || touched >= LEAST * length {
        return;
    }
    let loose = |layer: usize| judged[layer].length - judged[layer].touched;
    let Some(worst) = (0..judged.len()).max_by(|&a, &b| loose(a).total_cmp(&loose(b))) else {
        return;
    };
    let percent = short(100.0 * touched / length);
    let text = format!("the sparse infill touches {percent} % of the innermost walls");
    let finding = Finding::warning(Code::LooseInfill, percent, "%", text);
    let place = judged[worst].at.map_or(Place::default(), |(step, at)| Place {
        at_mm: Some(at.map(short)),
        ..place(worst, step)
    });
    found.add(finding.at(place));
}

fn contact<'a>(
    (filled, terms): (&Filled<'a>, &Terms),
    lattice: Lattice,
    layer: usize,
) -> Contact<'a> {
    let wide = |step: &Step| terms.box_width(step).min(WIDEST);
    let sparse = filled.lines(layer).filter(|(step, _)| step.role == Role::Infill);
    let capsules = sparse
        .map(|(step, _)| Capsule { radius: wide(step) / 2.0 + GAP, ..Capsule::of(step, 1.0) });
    let sparse = lattice.draw(capsules);
    let mut contact = Contact::default();
    if sparse.is_empty() {
        return contact;
    }
    let print = filled.print;
    let steps = || print.moves_of(&print.layers[layer]).iter().filter(|step| step.is_line());
    let has_inner = steps().any(|step| step.role == Role::InnerWall);
    let innermost = if has_inner { Role::InnerWall } else { Role::OuterWall };
    let mut run = 0.0;
    for step in steps().filter(|step| step.role == innermost) {
        let side = wide(step) / 2.0;
        for piece in Samples::of(step, PIECE) {
            let edge = |side: f64| segment::along(piece.at, side, piece.across);
            contact.length += piece.length;
            if [-side, side].into_iter().any(|side| lattice.has(&sparse, edge(side))) {
                contact.touched += piece.length;
                run = 0.0;
                continue;
            }
            run += piece.length;
            if run > contact.longest {
                contact.longest = run;
                contact.at = Some((step, piece.at));
            }
        }
    }
    contact
}
