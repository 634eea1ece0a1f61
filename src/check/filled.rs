//! Window -> Filled: the lines that fill each layer: its own, and thick ones that reach down into it.

use super::survey::Survey;
use super::window::Window;
use crate::reader::print::Step;

/// Heights that differ by less are the same, mm.
const SAME_HEIGHT: f64 = 1e-3;

/// Some layers of a print by what fills them.
pub(super) struct Filled<'a> {
    pub(super) window: &'a Window<'a>,
    pub(super) survey: &'a Survey,
}

impl<'a> Filled<'a> {
    /// How high a layer's lines are, mm.
    pub(super) fn height(&self, layer: usize) -> f64 {
        self.survey.heights[layer]
    }

    /// Height of a layer's top, mm.
    pub(super) fn top(&self, layer: usize) -> f64 {
        self.window.facts.layers[layer].z
    }

    /// The lines of a layer, each with the share of its height that lies in the layer.
    pub(super) fn lines(&self, layer: usize) -> impl Iterator<Item = (&'a Step, f64)> {
        let (window, floors) = (self.window, &self.survey.floors);
        let top = self.top(layer);
        let bottom = top - self.height(layer);
        let above =
            (layer + 1..window.end()).take_while(move |&above| floors[above] < top - SAME_HEIGHT);
        let layers = std::iter::once(layer).chain(above);
        let steps = layers.flat_map(move |one| window.moves(one));
        steps.filter(|step| step.is_line()).filter_map(move |step| {
            let height = f64::from(step.height);
            let z = 0.5 * f64::from(step.from[2] + step.to[2]);
            let within = top.min(z) - bottom.max(z - height);
            (within > SAME_HEIGHT).then_some((step, (within / height).min(1.0)))
        })
    }
}
