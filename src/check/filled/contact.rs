//! Filled -> how much of the innermost walls sparse infill touches.
//!
//! Infill that does not touch the walls holds nothing. A place of a wall's edge is touched if the edge
//! of a bead of infill lies within [`GAP`]. Both are as wide as boxes of their plastic: what files
//! say of widths differs from slicer to slicer. Thick beads count on all layers that they fill.

use super::Filled;
use crate::check::beads::place;
use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::stack::bead::Bead;
use crate::check::stack::laid::{Laid, Seen};
use crate::check::stack::runs::united;
use crate::check::terms::Terms;
use crate::reader::Role;
use crate::reader::print::Step;

/// Edges this near touch, mm: an eighth of a line.
const GAP: f64 = 0.05;

/// Least share of the innermost walls that infill touches: other slicers reach 0.25 to 0.5.
const LEAST: f64 = 0.25;

/// Length of walls beside infill from which on that is judged, mm.
const ENOUGH: f64 = 200.0;

/// No bead is wider than this, mm: what is, is priming.
const WIDEST: f64 = 0.8;

/// What was measured on a layer.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Contact {
    /// Length of the innermost walls, and what of it is touched, mm.
    length: f64,
    touched: f64,
    /// The longest stretch that is not, mm, its wall and its end.
    longest: f64,
    at: Option<(Step, [f64; 2])>,
}

/// What was measured on all layers so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct Contacts {
    sums: Contact,
    /// The layer with most of the walls without infill.
    worst: Option<(usize, Contact)>,
}

impl Contacts {
    /// The next layer.
    pub(crate) fn layer(&mut self, layer: usize, contact: Contact) {
        self.sums.length += contact.length;
        self.sums.touched += contact.touched;
        let loose = |one: &Contact| one.length - one.touched;
        if self.worst.as_ref().is_none_or(|(_, worst)| loose(&contact) >= loose(worst)) {
            self.worst = Some((layer, contact));
        }
    }

    /// Judges the whole print: directions of infill change from layer to layer, and so does what they
    /// touch. The place is that of the longest wall without infill on the layer with most of them.
    pub(crate) fn finish(self, found: &mut Findings) {
        let Contact { length, touched, .. } = self.sums;
        let Some((layer, worst)) = self.worst else { return };
        if length < ENOUGH || touched >= LEAST * length {
            return;
        }
        let percent = short(100.0 * touched / length);
        let text = format!("the sparse infill touches {percent} % of the innermost walls");
        let finding = Finding::warning(Code::LooseInfill, percent, "%", text);
        let place = worst.at.map_or(Place::default(), |(step, at)| Place {
            at_mm: Some(at.map(short)),
            ..place(layer, &step)
        });
        found.add(finding.at(place));
    }
}

/// Measures a layer.
pub(crate) fn layer(filled: &Filled<'_>, terms: &Terms, layer: usize) -> Contact {
    let wide = |step: &Step| terms.width_by_plastic(step).min(WIDEST);
    let sparse = filled.lines(layer).filter(|(step, _)| step.role == Role::Infill);
    let beads = sparse.map(|(step, _)| Bead { radius: wide(step) / 2.0 + GAP, ..Bead::of(step) });
    let sparse = Laid::of(beads.collect());
    let mut contact = Contact::default();
    if sparse.beads.is_empty() {
        return contact;
    }
    let steps = || filled.window.moves(layer).iter().filter(|step| step.is_line());
    let has_inner = steps().any(|step| step.role == Role::InnerWall);
    let innermost = if has_inner { Role::InnerWall } else { Role::OuterWall };
    let (mut seen, mut touched, mut run) = (Seen::default(), Vec::new(), 0.0);
    for step in steps().filter(|step| step.role == innermost) {
        let side = wide(step) / 2.0;
        let wall = Bead { radius: side, ..Bead::of(step) };
        let edges = [side, -side].map(|side| wall.aside(side));
        touched.clear();
        sparse.near(&wall, 0.0, &mut seen, |_, bead| {
            touched.extend(edges.iter().filter_map(|edge| edge.way(bead, bead.radius)));
        });
        united(&mut touched, 0.0);
        contact.length += wall.length;
        let mut at = 0.0;
        for [from, to] in touched.drain(..).chain([[1.0, 1.0]]) {
            run += (from - at) * wall.length;
            if run > contact.longest {
                contact.longest = run;
                contact.at = Some((*step, wall.place(from)));
            }
            contact.touched += (to - from) * wall.length;
            run = if to > from { 0.0 } else { run };
            at = to;
        }
    }
    contact
}
