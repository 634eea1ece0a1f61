//! Patches of lines, layer by layer -> findings of bodies that begin in the air.
//!
//! Words used here: a *patch* is all lines of a layer that touch; a *body* is all patches that stand on
//! one another or touch; a patch *begins* a body where nothing carries it; a body *stands* if some
//! patch of it lies on the bed.
//!
//! Whether a patch that begins in the air is a weak place or a failure is known only at the end: an
//! island that grows together with what stands is held by it from then on, while a body that never
//! does falls over. How bad that is is [`Floating`]'s rule, the same when slicing: a body of
//! [`least_body`](Floating::least_body) of lines or more is an error, and so is a print that stands
//! nowhere; a speck is a weak place.

use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::geom::sets::Sets;
use crate::profile::Floating;
use crate::reader::Role;

/// An island with shorter lines in all is ignored as a blob where it grows together with the rest,
/// mm: seams and wipes leave lines of 1 mm and more.
const LEAST_ISLAND: f64 = 2.0;

/// A body with shorter lines in all is ignored if it never stands, mm.
const LEAST_BODY: f64 = 4.0;

/// Where a patch begins in the air.
pub(crate) struct Start {
    pub(crate) place: Place,
    pub(crate) role: Role,
    /// Length of its lines, mm.
    pub(crate) length: f64,
    /// Height of the patch's lower side, mm: of what hangs how far above the bed.
    pub(crate) bottom: f64,
}

/// A body as far as it is known.
#[derive(Clone, Copy)]
struct Body {
    stands: bool,
    /// Whether some of it is more than support.
    is_part: bool,
    /// mm.
    length: f64,
}

/// All bodies so far.
#[derive(Default)]
pub(crate) struct Bodies {
    sets: Sets,
    bodies: Vec<Body>,
    /// The body of each chain, counted over all layers from 0.
    of_chain: Vec<usize>,
    starts: Vec<(usize, Start)>,
}

impl Bodies {
    fn join(&mut self, a: usize, b: usize) {
        if let Some((old, young)) = self.sets.join(a, b) {
            let part = self.bodies[young];
            let whole = &mut self.bodies[old];
            whole.stands |= part.stands;
            whole.is_part |= part.is_part;
            whole.length += part.length;
        }
    }

    /// Adds a patch, `length` mm long, that stands on these chains, counted from 1; 0 is the bed.
    /// Returns its body.
    pub(crate) fn add(
        &mut self,
        (length, is_part): (f64, bool),
        carriers: impl Iterator<Item = u32>,
    ) -> usize {
        let body = self.sets.add();
        self.bodies.push(Body { stands: false, is_part, length });
        for carrier in carriers {
            match (carrier as usize).checked_sub(1) {
                Some(chain) => self.join(body, self.of_chain[chain]),
                None => {
                    let root = self.sets.root(body);
                    self.bodies[root].stands = true;
                }
            }
        }
        self.sets.root(body)
    }

    /// The next chain, in the file's order, is of this body.
    pub(crate) fn chain(&mut self, body: usize) {
        self.of_chain.push(body);
    }

    /// A body begins in the air.
    pub(crate) fn begin(&mut self, body: usize, start: Start) {
        self.starts.push((body, start));
    }

    /// Reports what began in the air, now that all is laid.
    pub(crate) fn report(mut self, found: &mut Findings) {
        let mut fallen: Vec<usize> = Vec::new();
        let stands_nowhere = !self.bodies.iter().any(|body| body.stands && body.is_part);
        let roots = (0..self.bodies.len()).filter(|&body| self.sets.root(body) == body);
        let all: f64 = roots.map(|body| self.bodies[body].length).sum();
        for (body, start) in std::mem::take(&mut self.starts) {
            let root = self.sets.root(body);
            let whole = self.bodies[root];
            let length = short(start.length);
            let what = start.role.name();
            if whole.stands {
                if start.length >= LEAST_ISLAND {
                    let text = format!("{length} mm of {what} begin with nothing under them");
                    let finding = Finding::warning(Code::Floating, start.length, "mm", text);
                    found.add(finding.at(start.place));
                }
            } else if whole.length >= LEAST_BODY && !fallen.contains(&root) {
                // The lowest of its beginnings comes first.
                fallen.push(root);
                let text = format!(
                    "a body of {} mm of lines stands on nothing: it begins with {length} mm of \
                     {what}, {} mm above the bed",
                    short(whole.length),
                    short(start.bottom),
                );
                // Support that falls over costs a surface, not the print.
                let fails = stands_nowhere || whole.length >= Floating::least_body(all);
                let of = if whole.is_part && fails { Finding::of } else { Finding::warning };
                found.add(of(Code::Floating, whole.length, "mm", text).at(start.place));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::finding::Severity;

    fn start(length: f64) -> Start {
        Start { place: Place::default(), role: Role::OuterWall, length, bottom: 1.0 }
    }

    /// Lays patches of one chain each, given by their lengths and what carries them, and reports.
    fn judged(patches: &[(f64, &[u32])]) -> Vec<(Severity, f64)> {
        let mut bodies = Bodies::default();
        for (length, carriers) in patches {
            let body = bodies.add((*length, true), carriers.iter().copied());
            bodies.chain(body);
            if carriers.is_empty() {
                bodies.begin(body, start(*length));
            }
        }
        let mut found = Findings::default();
        bodies.report(&mut found);
        found.into_iter().map(|one| (one.severity, one.measure)).collect()
    }

    #[test]
    fn a_body_that_joins_one_that_stands_is_a_weak_place() {
        assert_eq!(judged(&[(9.0, &[0]), (5.0, &[]), (9.0, &[1, 2])]), [(Severity::Warning, 5.0)]);
        assert_eq!(judged(&[(9.0, &[0]), (1.0, &[]), (9.0, &[1, 2])]), []);
    }

    #[test]
    fn a_body_that_never_stands_fails_once_and_as_a_whole() {
        let table: &[(f64, &[u32])] = &[(9.0, &[0]), (100.0, &[]), (100.0, &[]), (700.0, &[2, 3])];
        assert_eq!(judged(table), [(Severity::Error, 900.0)]);
    }

    #[test]
    fn a_speck_that_never_stands_is_a_weak_place_unless_nothing_stands() {
        assert_eq!(judged(&[(2e6, &[0]), (499.0, &[])]), [(Severity::Warning, 499.0)]);
        assert_eq!(judged(&[(2e6, &[0]), (500.0, &[])]), [(Severity::Error, 500.0)]);
        assert_eq!(judged(&[(20_000.0, &[0]), (9.0, &[])]), [(Severity::Warning, 9.0)]);
        assert_eq!(judged(&[(20_000.0, &[0]), (11.0, &[])]), [(Severity::Error, 11.0)]);
        assert_eq!(judged(&[(9.0, &[0]), (3.0, &[])]), []);
        assert_eq!(judged(&[(9.0, &[])]), [(Severity::Error, 9.0)]);
    }
}
