//! Patch of non-planar skin -> Drawing: its lines from above, coloured by height, with a scale.
//!
//! A line that rises has a colour from place to place: it is cut where its height passes from one
//! *band* of the scale to the next. A *run* is a path without a break. Its edges are drawn first, as
//! one line, and its pieces over them, so that no edge lies across it. Later runs cover earlier ones:
//! of several skins one sees the last.
//!
//! The scale goes from the lowest to the highest place of the nozzle on the patch; the legend names six
//! heights of it.

use super::colours::Colour;
use super::drawing::{Drawing, Frame, Kind, Look, Stroke};
use super::layer::{self, Options, Scene, flat};
use super::measured;
use super::page::Page;
use crate::reader::print::Step;
use crate::reader::{Print, Role};

/// Bands of the scale.
const BANDS: usize = 24;

/// Colours that the legend names.
const NAMED: usize = 6;

/// The edge of lines: grey that is darker than all but the lowest band.
const EDGE: Colour = Colour([70, 70, 70]);

/// The numbers of all patches that have a line, each once, rising.
#[must_use]
pub fn numbers(print: &Print) -> Vec<u32> {
    let with_lines =
        print.patches.iter().filter(|patch| print.moves[patch.moves.clone()].iter().any(measured));
    let mut numbers: Vec<u32> = with_lines.map(|patch| patch.number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// The layer that a patch is printed after, counted from 0; none if it has no move in a layer.
#[must_use]
pub fn home(print: &Print, number: u32) -> Option<usize> {
    let patch = print.patches.iter().find(|patch| patch.number == number)?;
    let at = print.layers.partition_point(|layer| layer.moves.end <= patch.moves.start);
    (at < print.layers.len()).then_some(at)
}

/// The box around the lines of a patch, mm on the bed, with a margin around it.
#[must_use]
pub fn frame(print: &Print, number: u32) -> Frame {
    layer::frame_of(steps(print, number))
}

/// Draws a patch, over so many layers below as the options say: its own is the first. A patch that is
/// not there has no lines.
#[must_use]
pub fn drawing(print: &Print, number: u32, options: &Options) -> Drawing {
    let home = home(print, number);
    let next = home.map_or(0, |home| home + 1);
    let below = next.saturating_sub(options.below)..next;
    let scale = Scale::of(steps(print, number));
    let mut scene = Scene { options, strokes: Vec::new(), travels: Vec::new() };
    scene.bare_below(print, below.clone());
    let mut last: Option<&Step> = None;
    let mut run = Run::default();
    for step in steps(print, number) {
        if measured(step) {
            if last.is_none_or(|last| last.to != step.from) {
                run.paint(&mut scene.strokes);
            }
            run.add(step, &scale, &options.frame);
            last = Some(step);
        } else if options.travels && step.role == Role::Travel {
            scene.travel(step);
        }
    }
    run.paint(&mut scene.strokes);
    let mut keys = scale.keys();
    keys.extend(layer::other_keys(options, below.len()));
    let heading = heading(number, home, &scale);
    let (size, frame) = (options.size, options.frame);
    let mut drawing = Page { size, frame, axes: ["x", "y"], heading, keys }.lay_out();
    drawing.scene = scene.strokes;
    let pixel = 1.0 / drawing.view.scale;
    drawing.scene.extend(layer::drawn_travels(scene.travels, pixel));
    drawing
}

/// Short enough for the panel up to a height of 1 m.
fn heading(number: u32, home: Option<usize>, scale: &Scale) -> Vec<String> {
    let mut heading = vec![format!("skin {number}")];
    heading.extend(home.map(|home| format!("after layer {}", home + 1)));
    let [low, high] = [scale.low, scale.high].map(|z| (z * 100.0).round() / 100.0);
    heading.push(if low == high { format!("z {low} mm") } else { format!("z {low} to {high} mm") });
    heading
}

/// All moves of a patch.
fn steps(print: &Print, number: u32) -> impl Iterator<Item = &Step> {
    let pieces = print.patches.iter().filter(move |patch| patch.number == number);
    pieces.flat_map(|patch| &print.moves[patch.moves.clone()])
}

/// From the lowest to the highest place of the nozzle, mm.
struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    fn of<'a>(steps: impl Iterator<Item = &'a Step>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for [from, to] in steps.filter(|step| measured(step)).map(Step::heights) {
            (low, high) = (low.min(from), high.max(to));
        }
        if low > high { Self { low: 0.0, high: 0.0 } } else { Self { low, high } }
    }

    /// The band of a height.
    fn band(&self, z: f64) -> usize {
        let part = (z - self.low) / (self.high - self.low);
        // NaN of a level patch becomes 0.
        ((part * BANDS as f64) as usize).min(BANDS - 1)
    }

    /// Where a band ends upwards, mm.
    fn end_of(&self, band: usize) -> f64 {
        self.low + (self.high - self.low) * (band + 1) as f64 / BANDS as f64
    }

    fn colour(band: usize) -> Colour {
        Colour::on_scale(band as f64 / (BANDS - 1) as f64)
    }

    /// Some heights and their colours, the highest first.
    fn keys(&self) -> Vec<(Colour, String)> {
        let named = if self.low == self.high { 1 } else { NAMED };
        let key = |k: usize| {
            let part = k as f64 / (NAMED - 1) as f64;
            let z = self.low + (self.high - self.low) * part;
            (Scale::colour(self.band(z)), format!("z {z:.2} mm"))
        };
        (0..named).rev().map(key).collect()
    }
}

/// A path without a break.
#[derive(Default)]
struct Run {
    pieces: Vec<Piece>,
}

/// A part of a run with one look.
struct Piece {
    band: usize,
    /// mm.
    width: f64,
    points: Vec<[f64; 2]>,
}

impl Run {
    fn add(&mut self, step: &Step, scale: &Scale, frame: &Frame) {
        let width = (f64::from(step.width) * 100.0).round() / 100.0;
        let (from, to) = (flat(step.from), flat(step.to));
        if !frame.touches(from, to, width / 2.0) {
            return;
        }
        let [z, z_to] = [step.from[2], step.to[2]].map(f64::from);
        let place = |part: f64| std::array::from_fn(|k| from[k] + (to[k] - from[k]) * part);
        let (mut band, last) = (scale.band(z), scale.band(z_to));
        let mut at = from;
        while band != last {
            let up = band < last;
            let border = scale.end_of(if up { band } else { band - 1 });
            let next = place(((border - z) / (z_to - z)).clamp(0.0, 1.0));
            self.piece(band, width, [at, next]);
            at = next;
            band = if up { band + 1 } else { band - 1 };
        }
        self.piece(band, width, [at, to]);
    }

    fn piece(&mut self, band: usize, width: f64, [from, to]: [[f64; 2]; 2]) {
        match self.pieces.last_mut() {
            Some(last)
                if (last.band, last.width) == (band, width)
                    && last.points.last() == Some(&from) =>
            {
                last.points.push(to);
            }
            _ => self.pieces.push(Piece { band, width, points: vec![from, to] }),
        }
    }

    /// Draws it, and is empty again.
    fn paint(&mut self, strokes: &mut Vec<Stroke>) {
        let Self { mut pieces } = std::mem::take(self);
        let mut edges: Vec<Stroke> = Vec::new();
        for Piece { width, points, .. } in &pieces {
            let look = Look { width: *width, colour: EDGE, kind: Kind::Plain };
            match edges.last_mut() {
                Some(last) if last.look == look && last.points.last() == points.first() => {
                    last.points.extend(&points[1..]);
                }
                _ => edges.push(Stroke { points: points.clone(), look }),
            }
        }
        // Pieces of one run hardly cover each other: those of a band are painted at once.
        pieces.sort_by_key(|piece| piece.band);
        strokes.append(&mut edges);
        strokes.extend(pieces.into_iter().map(|Piece { band, width, points }| {
            let colour = Scale::colour(band);
            let bead = Look { width, colour, kind: Kind::Plain };
            let width = (bead.within_edges() * 1000.0).round() / 1000.0;
            Stroke { points, look: Look { width, ..bead } }
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAMP: &str = ";LAYER_CHANGE\nG1 Z0.2\nG1 X10 E1\n;NONPLANAR_START 7\n;WIDTH:0.5\nG1 X0 Y5 Z1\n\
                        G1 X24 Z3 E2\nG1 Y5.5 E2.1\n;NONPLANAR_END\n;LAYER_CHANGE\nG1 Z0.4\nG1 X10 E3\n";

    fn options(frame: Frame) -> Options {
        Options { size: 800, below: 0, travels: false, frame }
    }

    #[test]
    fn a_line_is_coloured_by_its_height_from_place_to_place() {
        let print = Print::read(&mut RAMP.as_bytes(), 1.75).unwrap();
        assert_eq!((numbers(&print), home(&print, 7)), (vec![7], Some(0)));
        let drawing = drawing(&print, 7, &options(frame(&print, 7)));
        assert_eq!(drawing.title, "skin 7, after layer 1, z 1 to 3 mm");
        let (edges, pieces) = drawing.scene.split_at(1);
        assert_eq!((edges[0].look.width, edges[0].points.len()), (0.5, BANDS + 2));
        assert_eq!(pieces.len(), BANDS);
        for (band, piece) in pieces.iter().enumerate() {
            let (first, last) = (piece.points[0], piece.points[1]);
            assert_eq!(piece.look.colour, Scale::colour(band));
            assert!((first[0] - band as f64).abs() < 1e-4, "{piece:?}");
            assert!((last[0] - band as f64 - 1.0).abs() < 1e-4, "{piece:?}");
        }
    }

    #[test]
    fn a_patch_that_is_not_there_or_level_is_drawn_without_harm() {
        let print = Print::read(&mut RAMP.as_bytes(), 1.75).unwrap();
        let whole = layer::frame(&print, &print.layers);
        assert!(drawing(&print, 3, &options(whole)).scene.is_empty());
        let text = RAMP.replace("Z3", "");
        let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
        let level = drawing(&print, 7, &options(frame(&print, 7)));
        assert_eq!((level.scene.len(), level.title.as_str()), (2, "skin 7, after layer 1, z 1 mm"));
    }
}
