//! Print -> Filled: the lines that fill each layer: its own, and thick ones that reach down into it.

use super::stack::gap_below;
use crate::reader::Print;
use crate::reader::print::Step;

/// Heights that differ by less are the same, mm.
const SAME_HEIGHT: f64 = 1e-3;

/// A print by what fills its layers.
pub(super) struct Filled<'a> {
    pub(super) print: &'a Print,
    /// How high each layer's lines are, mm.
    pub(super) heights: Vec<f64>,
    /// For each layer where it and all above it reach down to, mm.
    pub(super) floors: Vec<f64>,
}

impl<'a> Filled<'a> {
    pub(super) fn new(print: &'a Print) -> Self {
        let layers = print.layers.iter().enumerate();
        let heights = layers.map(|(k, one)| one.height - gap_below(print, k)).collect();
        Self { print, heights, floors: floors(print) }
    }

    /// The lines of a layer, each with the share of its height that lies in the layer.
    pub(super) fn lines(&self, layer: usize) -> impl Iterator<Item = (&'a Step, f64)> {
        let (print, floors) = (self.print, &self.floors);
        let top = print.layers[layer].z;
        let bottom = top - self.heights[layer];
        let above = (layer + 1..print.layers.len())
            .take_while(move |&above| floors[above] < top - SAME_HEIGHT);
        let layers = std::iter::once(layer).chain(above);
        let steps = layers.flat_map(move |one| print.moves_of(&print.layers[one]));
        steps.filter(|step| step.is_line()).filter_map(move |step| {
            let height = f64::from(step.height);
            let z = 0.5 * f64::from(step.from[2] + step.to[2]);
            let within = top.min(z) - bottom.max(z - height);
            (within > SAME_HEIGHT).then_some((step, (within / height).min(1.0)))
        })
    }
}

/// For each layer where the lines of it and all above it reach down to, mm.
pub(super) fn floors(print: &Print) -> Vec<f64> {
    let mut floor = f64::INFINITY;
    let mut floors: Vec<f64> = Vec::with_capacity(print.layers.len());
    for layer in print.layers.iter().rev() {
        let lines = print.moves_of(layer).iter().filter(|step| step.is_line());
        let lows = lines.map(|step| step.heights()[0] - f64::from(step.height));
        floor = lows.fold(floor, f64::min);
        floors.push(floor);
    }
    floors.reverse();
    floors
}
