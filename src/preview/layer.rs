//! Layer of a print -> Drawing: its lines from above, in their true widths.
//!
//! A patch of non-planar skin that is printed after a layer would hide it: it has a picture of its own
//! ([`patch`](super::patch)), and the layer's says that it comes. Of layers below, patches are drawn.
//!
//! Lines that go on where the last of the same look ended are one stroke. Layers below are drawn
//! first, pale; travels, as dashes, last. All layers of a print have one frame, so that one can leaf
//! through their pictures.

use super::colours::{Colour, PAPER, is_thick};
use super::drawing::{Drawing, Frame, Kind, Look, Stroke};
use super::page::Page;
use super::stages::{own, patches_in};
use super::{Keys, MARGIN, measured};
use crate::reader::print::{Layer, Step};
use crate::reader::{Print, Role};
use std::ops::Range;

/// How pale the layers below are, 0 to 1.
const PALE: f64 = 0.75;

/// Width of a travel, pixels.
const TRAVEL: f64 = 1.5;

/// Dashes and gaps of a travel, in its widths.
const DASH: u8 = 4;

/// What to draw besides the lines of a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Pixels of the picture's longer side.
    pub size: u32,
    /// So many layers below are drawn pale.
    pub below: usize,
    /// Whether travels are drawn.
    pub travels: bool,
    /// What is shown, mm on the bed.
    pub frame: Frame,
}

/// The box around all lines of these layers, mm on the bed, with a margin around it.
/// Empty without a line.
#[must_use]
pub fn frame(print: &Print, layers: &[Layer]) -> Frame {
    frame_of(layers.iter().flat_map(|layer| print.moves_of(layer)))
}

/// The same around the lines of one layer, without its patches. Empty where there is none.
#[must_use]
pub fn own_frame(print: &Print, index: usize) -> Frame {
    let layer = print.layers.get(index);
    frame_of(layer.into_iter().flat_map(|layer| own(print, layer)).flatten())
}

/// The same around any lines.
pub(super) fn frame_of<'a>(steps: impl Iterator<Item = &'a Step>) -> Frame {
    let mut frame = Frame::EMPTY;
    for step in steps.filter(|step| measured(step)) {
        for at in [step.from, step.to] {
            frame.include(flat(at), f64::from(step.width) / 2.0);
        }
    }
    let size = frame.size();
    frame.padded(MARGIN * size[0].max(size[1]))
}

/// The layer in the middle, or that above it if more goes into that: of two layers
/// whose infill is printed at once, the one that shows it. Counted from 0.
#[must_use]
pub fn middle(print: &Print) -> usize {
    let layers = &print.layers;
    let filament = |index: usize| -> f64 {
        let steps = layers.get(index).into_iter().flat_map(|layer| own(print, layer)).flatten();
        steps.filter(|step| measured(step)).map(|step| f64::from(step.filament)).sum()
    };
    let middle = layers.len().saturating_sub(1) / 2;
    if filament(middle + 1) > filament(middle) { middle + 1 } else { middle }
}

/// Draws a layer, `index` counted from 0. A layer that is not there has no lines.
#[must_use]
pub fn drawing(print: &Print, index: usize, options: &Options) -> Drawing {
    let below = index.saturating_sub(options.below)..index;
    let layers = &print.layers;
    let shown = layers.get(index);
    let mut scene = Scene { options, strokes: Vec::new(), travels: Vec::new() };
    scene.below(print, below.clone());
    let mut keys = Keys::default();
    if let Some(layer) = shown {
        own(print, layer).into_iter().for_each(|run| scene.run(run, layer, 0.0));
        keys.layer(print, layer);
    }
    let mut keys = keys.list();
    keys.extend(other_keys(options, below.len()));
    let (z, height) = shown.map_or((0.0, 0.0), |layer| (layer.z, layer.height));
    let mut heading = vec![
        format!("layer {} of {}", index + 1, layers.len()),
        format!("z {} mm", super::millimetres(z)),
        format!("height {} mm", super::millimetres(height)),
    ];
    heading.extend(shown.and_then(|layer| patches_after(&patches_in(print, layer))));
    let (size, frame) = (options.size, options.frame);
    let mut drawing = Page { size, frame, axes: ["x", "y"], heading, keys }.lay_out();
    drawing.scene = scene.strokes;
    let pixel = 1.0 / drawing.view.scale;
    drawing.scene.extend(drawn_travels(scene.travels, pixel));
    drawing
}

/// What is said of patches that are printed after a layer, if any.
fn patches_after(numbers: &[u32]) -> Option<String> {
    match numbers {
        [] => None,
        [number] => Some(format!("then skin {number}")),
        [first, second] => Some(format!("then skins {first}, {second}")),
        more => Some(format!("then {} skins", more.len())),
    }
}

/// What the legend says of layers below, so many, and of travels.
pub(super) fn other_keys(options: &Options, below: usize) -> Vec<(Colour, String)> {
    let mut keys = Vec::new();
    if below > 0 {
        let words = if below == 1 { "layer below" } else { "layers below" };
        keys.push((Colour::of(Role::OuterWall, false).mixed(PAPER, PALE), words.to_owned()));
    }
    if options.travels {
        keys.push((Colour::of(Role::Travel, false), Role::Travel.name().to_owned()));
    }
    keys
}

/// Travels with their width; `pixel` in mm.
pub(super) fn drawn_travels(mut travels: Vec<Stroke>, pixel: f64) -> Vec<Stroke> {
    for travel in &mut travels {
        travel.look.width = TRAVEL * pixel;
    }
    travels
}

/// Collects strokes.
pub(super) struct Scene<'a> {
    pub(super) options: &'a Options,
    pub(super) strokes: Vec<Stroke>,
    pub(super) travels: Vec<Stroke>,
}

impl Scene<'_> {
    /// Layers with all that is printed after them, pale.
    pub(super) fn below(&mut self, print: &Print, layers: Range<usize>) {
        for layer in print.layers.get(layers).unwrap_or_default() {
            self.run(print.moves_of(layer), layer, PALE);
        }
    }

    /// The same without patches, the last of which is drawn itself.
    pub(super) fn bare_below(&mut self, print: &Print, layers: Range<usize>) {
        let last = layers.end;
        for (index, layer) in print.layers.iter().enumerate().take(last).skip(layers.start) {
            if index + 1 < last {
                self.run(print.moves_of(layer), layer, PALE);
            } else {
                own(print, layer).into_iter().for_each(|run| self.run(run, layer, PALE));
            }
        }
    }

    fn run(&mut self, steps: &[Step], layer: &Layer, pale: f64) {
        let kind = if pale > 0.0 { Kind::PaleBead } else { Kind::Bead };
        let mut last: Option<&Step> = None;
        for step in steps {
            if measured(step) {
                let colour = Colour::of(step.role, is_thick(step, layer)).mixed(PAPER, pale);
                // To hundredths of a mm, which nobody can see, so that more neighbours look alike.
                let width = (f64::from(step.width) * 100.0).round() / 100.0;
                let goes_on = last.is_some_and(|last| last.to == step.from);
                self.add(step, Look { width, colour, kind }, goes_on);
                last = Some(step);
            } else if step.role == Role::Travel && self.options.travels && pale == 0.0 {
                self.travel(step);
            }
        }
    }

    /// A line; one that goes on where the last of its kind ends is one with it.
    fn add(&mut self, step: &Step, look: Look, goes_on: bool) {
        let (from, to) = (flat(step.from), flat(step.to));
        if !self.options.frame.touches(from, to, look.width / 2.0) {
            return;
        }
        if let Some(last) = self.strokes.last_mut()
            && goes_on
            && last.look == look
            && last.points.last() == Some(&from)
        {
            return last.points.push(to);
        }
        self.strokes.push(Stroke { points: vec![from, to], look });
    }

    pub(super) fn travel(&mut self, step: &Step) {
        let (from, to) = (flat(step.from), flat(step.to));
        if from == to || !self.options.frame.touches(from, to, 0.0) {
            return;
        }
        let kind = Kind::Dashed(DASH);
        let look = Look { width: 0.0, colour: Colour::of(Role::Travel, false), kind };
        match self.travels.last_mut() {
            Some(last) if last.points.last() == Some(&from) => last.points.push(to),
            _ => self.travels.push(Stroke { points: vec![from, to], look }),
        }
    }
}

/// From above.
pub(super) fn flat(at: [f32; 3]) -> [f64; 2] {
    [f64::from(at[0]), f64::from(at[1])]
}
