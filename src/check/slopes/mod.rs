//! Moves of a file with lines over slopes -> findings of the head, and of skins.
//!
//! Both need to know what stands at each moment ([`relief`]), which costs time and memory:
//! files without such lines have none of it. Skins are told by the file's marks, else they are all lines of a
//! layer from the first to the last that strays from its height.

mod joints;
pub(crate) mod plies;
pub(crate) mod relief;
pub(crate) mod skins;
pub(crate) mod sweep;
#[cfg(test)]
mod tests;

use crate::check::belongs::is_stray;
use crate::check::finding::Findings;
use crate::check::terms::Terms;
use crate::reader::Facts;
use crate::reader::print::Step;
use joints::joint;
use relief::Relief;
use skins::{Name, Skins};
use sweep::Sweep;

/// Height of a layer where nobody tells one, mm.
const SOME_HEIGHT: f64 = 0.2;

/// What stands, and what judges by it.
pub(crate) struct Slopes<'a> {
    facts: &'a Facts,
    terms: &'a Terms,
    relief: Relief,
    sweep: Option<Sweep<'a>>,
    skins: Skins,
    /// The layer whose lines are those of a skin without marks.
    skin_of: Option<usize>,
    /// The line before. It is laid when it is known where the nozzle goes from its end.
    last: Option<Last>,
}

/// A line, whether it is of a skin, and where it begins if it goes on as the one before.
struct Last {
    step: Step,
    is_skin: bool,
    came_on: Option<[f64; 2]>,
}

impl<'a> Slopes<'a> {
    pub(crate) fn new(facts: &'a Facts, terms: &'a Terms) -> Self {
        Self {
            facts,
            terms,
            relief: Relief::default(),
            sweep: terms.head.as_ref().map(Sweep::new),
            skins: Skins::default(),
            skin_of: None,
            last: None,
        }
    }

    /// The nozzle is sent to where only the printer knows.
    pub(crate) fn lose(&mut self) {
        self.sweep.iter_mut().for_each(Sweep::lose);
    }

    /// The next move of the file, in a layer from 0; `is_of_layer` tells lines of layers from others.
    pub(crate) fn step(
        &mut self,
        step: &Step,
        (layer, is_of_layer): (Option<usize>, bool),
        found: &mut Findings,
    ) {
        let own = layer.and_then(|layer| self.facts.layers.get(layer));
        let height = own.map(|own| own.height).filter(|height| *height > 0.0);
        let came_on = self.lay_last(Some(step));
        if let Some(sweep) = &mut self.sweep {
            sweep.step(step, &self.relief, height.unwrap_or(SOME_HEIGHT), found);
        }
        if !step.is_line() {
            return;
        }
        let strays = own.is_some_and(|own| is_stray(step, own));
        let name = if self.facts.patches.is_empty() {
            if strays {
                self.skin_of = layer;
            }
            layer.filter(|_| layer == self.skin_of).map(Name::Layer)
        } else {
            let patch = self.facts.patch_at(u64::from(step.line));
            patch.map(|patch| Name::Patch(patch.number))
        };
        let name = name.filter(|_| is_of_layer);
        if let Some(name) = name {
            let counts = strays || matches!(name, Name::Patch(_));
            self.skins.line(name, step, (layer, counts));
        }
        self.last = Some(Last { step: *step, is_skin: name.is_some(), came_on });
    }

    /// Lays the line before; the joint of both, if the `next` move is a line that goes on as that one.
    fn lay_last(&mut self, next: Option<&Step>) -> Option<[f64; 2]> {
        let Last { step, is_skin, came_on } = self.last.take()?;
        let on = next.filter(|next| next.is_line()).and_then(|next| joint(&step, next));
        self.relief.lay(&step, is_skin, [came_on, on]);
        on
    }

    /// Ends the file.
    pub(crate) fn finish(mut self, found: &mut Findings) {
        self.lay_last(None);
        self.skins.finish(&self.relief, self.terms, found);
    }
}
