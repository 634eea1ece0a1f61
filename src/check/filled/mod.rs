//! Window -> Filled: the lines that fill each layer: its own, and thick ones that reach down into it.

mod cell;
pub(crate) mod contact;
pub(crate) mod fills;
pub(crate) mod posts;

use crate::check::survey::Survey;
use crate::check::window::Window;
use crate::reader::print::Step;

/// Heights that differ by less are the same, mm.
const SAME_HEIGHT: f64 = 1e-3;

/// How far a line of a layer above reaches down into another at least, mm: told heights of bent lines are rounded
/// to 0.02 mm.
const LEAST_WITHIN: f64 = 0.021;

/// Some layers of a print by what fills them.
pub(crate) struct Filled<'a> {
    pub(crate) window: &'a Window<'a>,
    pub(crate) survey: &'a Survey,
}

impl<'a> Filled<'a> {
    /// How high a layer's lines are, mm.
    pub(crate) fn height(&self, layer: usize) -> f64 {
        self.survey.heights[layer]
    }

    /// Height of a layer's top, mm.
    pub(crate) fn top(&self, layer: usize) -> f64 {
        self.window.facts.layers[layer].z
    }

    /// The lines of a layer, each with the share of its height that lies in the layer.
    pub(crate) fn lines(&self, layer: usize) -> impl Iterator<Item = (&'a Step, f64)> {
        let (window, floors) = (self.window, &self.survey.floors);
        let top = self.top(layer);
        let bottom = top - self.height(layer);
        let above =
            (layer + 1..window.end()).take_while(move |&above| floors[above] < top - SAME_HEIGHT);
        let layers = std::iter::once(layer).chain(above);
        let steps =
            layers.flat_map(move |one| window.moves(one).iter().map(move |step| (one, step)));
        steps.filter(|(_, step)| step.is_line()).filter_map(move |(one, step)| {
            let least = if one == layer { SAME_HEIGHT } else { LEAST_WITHIN };
            let height = f64::from(step.height);
            let z = 0.5 * f64::from(step.from[2] + step.to[2]);
            let within = top.min(z) - bottom.max(z - height);
            (within > least).then_some((step, (within / height).min(1.0)))
        })
    }
}
