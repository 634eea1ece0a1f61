//! Print -> pictures: what a G-code file of any slicer prints, drawn without a window.
//!
//! [`layer`], [`patch`], [`cut`] and, of two files, [`both`] make a [`drawing::Drawing`]; [`svg`] and [`png`] write it.
//! [`html`] writes a page to look through all layers.

pub mod both;
pub mod colours;
pub mod course;
pub mod cut;
pub mod drawing;
pub mod facts;
pub mod html;
pub mod layer;
pub mod packed;
mod page;
pub mod patch;
pub mod png;
pub mod stages;
pub mod svg;
pub mod text;

use crate::reader::print::{Layer, Step};
use crate::reader::{Print, Role};
use colours::{Colour, is_thick};

/// Free space around what is printed, parts of its longer side.
const MARGIN: f64 = 0.02;

/// A file's numbers further from the origin than this are no place on any bed, mm.
const FARTHEST: f32 = 10_000.0;

/// Whether a step is a line that can be drawn.
fn measured(step: &Step) -> bool {
    let near = |at: &f32| at.abs() <= FARTHEST;
    step.is_line() && step.from.iter().chain(&step.to).all(near) && step.width <= FARTHEST
}

/// The kinds of lines that occur in a picture.
#[derive(Debug, Clone, PartialEq, Default)]
struct Keys([[bool; 2]; Role::ALL.len()]);

impl Keys {
    /// Adds those of a layer, but for its patches.
    fn layer(&mut self, print: &Print, layer: &Layer) {
        let own = stages::own(print, layer).into_iter().flatten();
        own.filter(|s| measured(s)).for_each(|s| self.step(s, layer));
    }

    fn step(&mut self, step: &Step, layer: &Layer) {
        self.0[step.role as usize][usize::from(is_thick(step, layer))] = true;
    }

    /// Their colours and names.
    fn list(&self) -> Vec<(Colour, String)> {
        let mut list = Vec::new();
        for role in Role::ALL {
            for thick in [false, true] {
                if self.0[role as usize][usize::from(thick)] {
                    let more = if thick { ", thick" } else { "" };
                    list.push((Colour::of(role, thick), format!("{}{more}", role.name())));
                }
            }
        }
        list
    }
}

/// Micrometres are enough, without zeros at the end.
fn millimetres(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}
