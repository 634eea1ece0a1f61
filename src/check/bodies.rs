//! Patches of lines, layer by layer -> findings of bodies that begin in the air.
//!
//! Words used here: a *patch* is all lines of a layer that touch; a *body* is all patches that stand on
//! one another or touch; a patch *begins* a body where nothing carries it; a body *stands* if some
//! patch of it lies on the bed.
//!
//! Whether a patch that begins in the air is a weak place or a failure is known only at the end: an
//! island that grows together with what stands is held by it from then on, while a body that never
//! does falls over. Bodies are joined as in any union of sets: each has a parent, the first of all
//! is the root.

use super::finding::{Code, Finding, Findings, Place, short};
use crate::reader::Role;

/// An island with shorter lines in all is ignored as a blob where it grows together with the rest,
/// mm: seams and wipes leave lines of 1 mm and more.
const LEAST_ISLAND: f64 = 2.0;

/// A body with shorter lines in all is ignored if it never stands, mm.
const LEAST_BODY: f64 = 4.0;

/// Where a patch begins in the air.
pub(super) struct Start {
    pub(super) place: Place,
    pub(super) role: Role,
    /// Length of its lines, mm.
    pub(super) length: f64,
    /// Height of the patch's lower side, mm: of what hangs how far above the bed.
    pub(super) bottom: f64,
}

/// A body as far as it is known.
#[derive(Clone, Copy)]
struct Body {
    parent: u32,
    stands: bool,
    /// Whether some of it is more than support.
    is_part: bool,
    /// mm.
    length: f64,
}

/// All bodies so far.
#[derive(Default)]
pub(super) struct Bodies {
    bodies: Vec<Body>,
    /// The body of each chain, counted over all layers from 0.
    of_chain: Vec<u32>,
    starts: Vec<(u32, Start)>,
}

impl Bodies {
    fn root(&mut self, mut one: u32) -> u32 {
        while self.bodies[one as usize].parent != one {
            let above = self.bodies[self.bodies[one as usize].parent as usize].parent;
            self.bodies[one as usize].parent = above;
            one = above;
        }
        one
    }

    fn join(&mut self, a: u32, b: u32) -> u32 {
        let (a, b) = (self.root(a), self.root(b));
        let (old, young) = (a.min(b), a.max(b));
        if old != young {
            let part = self.bodies[young as usize];
            self.bodies[young as usize].parent = old;
            let whole = &mut self.bodies[old as usize];
            whole.stands |= part.stands;
            whole.is_part |= part.is_part;
            whole.length += part.length;
        }
        old
    }

    /// Adds a patch, `length` mm long, that stands on these chains, counted from 1; 0 is the bed.
    /// Returns its body.
    pub(super) fn add(
        &mut self,
        (length, is_part): (f64, bool),
        carriers: impl Iterator<Item = u32>,
    ) -> u32 {
        let mut body = self.bodies.len() as u32;
        self.bodies.push(Body { parent: body, stands: false, is_part, length });
        for carrier in carriers {
            match (carrier as usize).checked_sub(1) {
                Some(chain) => body = self.join(body, self.of_chain[chain]),
                None => self.bodies[body as usize].stands = true,
            }
        }
        body
    }

    /// The next chain, in the file's order, is of this body.
    pub(super) fn chain(&mut self, body: u32) {
        self.of_chain.push(body);
    }

    /// A body begins in the air.
    pub(super) fn begin(&mut self, body: u32, start: Start) {
        self.starts.push((body, start));
    }

    /// Reports what began in the air, now that all is laid.
    pub(super) fn report(mut self, found: &mut Findings) {
        let mut fallen: Vec<u32> = Vec::new();
        for (body, start) in std::mem::take(&mut self.starts) {
            let root = self.root(body);
            let whole = self.bodies[root as usize];
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
                let of = if whole.is_part { Finding::of } else { Finding::warning };
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
        let table: &[(f64, &[u32])] = &[(9.0, &[0]), (1.0, &[]), (1.0, &[]), (7.0, &[2, 3])];
        assert_eq!(judged(table), [(Severity::Error, 9.0)]);
        assert_eq!(judged(&[(9.0, &[0]), (3.0, &[])]), []);
    }
}
