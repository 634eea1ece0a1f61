//! Frame of a scene, heading and legend -> Drawing: the page around a scene, with axes and a scale bar.
//!
//! From left to right: numbers of the upright axis, the scene in a frame, and a panel with heading,
//! legend and scale bar; below the scene numbers of the other axis. The longer side of the picture is
//! given, and the scene gets as large as the rest leaves room for; the shorter side follows.
//!
//! Everything around the scene is measured in letters and heights of text, whose size follows from
//! the picture's: a picture of 400 pixels and one of 8000 look alike. Steps of axes and the scale bar
//! are round lengths: 1, 2 or 5 times a power of ten.
//!
//! The scene may reach beyond its frame: white margins are painted over it, before the rest of the
//! page, so that neither format needs to clip.

use super::colours::{Colour, INK, PAPER};
use super::drawing::{Anchor, Drawing, Frame, Mark, View};
use super::text::TextSize;

/// Letters that the panel beside the scene has room for.
const PANEL_LETTERS: f64 = 21.0;

/// Letters of a number at the left axis.
const AXIS_LETTERS: f64 = 6.0;

/// A tick of an axis, pixels.
const TICK: f64 = 6.0;

/// Length of the scale bar at most, in heights of text.
const BAR: f64 = 7.0;

/// The frame.
const FRAME: Colour = Colour([150, 150, 150]);

/// What is around a scene.
#[derive(Debug, Clone)]
pub(super) struct Page<'a> {
    /// Pixels of the longer side.
    pub(super) size: u32,
    /// What of the scene is shown, mm.
    pub(super) frame: Frame,
    /// Names of the axes, the second being upwards.
    pub(super) axes: [&'a str; 2],
    /// A line each.
    pub(super) heading: Vec<String>,
    /// Colours and what they mean.
    pub(super) keys: Vec<(Colour, String)>,
}

/// Where things are, pixels.
struct Places {
    /// The scene's left, upper, right and lower side.
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
    /// The page.
    width: f64,
    height: f64,
    view: View,
}

impl Page<'_> {
    /// A drawing with an empty scene.
    pub(super) fn lay_out(&self) -> Drawing {
        let text = TextSize::suiting(self.size);
        let places = self.places(text);
        let mut page = margins(&places);
        outline(&places, &mut page);
        for axis in 0..2 {
            self.axis(axis, &places, text, &mut page);
        }
        self.panel(&places, text, &mut page);
        scale_bar(&places, text, &mut page);
        Drawing {
            title: self.heading.join(", "),
            size: [places.width, places.height].map(|side| side.ceil() as u32),
            view: places.view,
            scene: Vec::new(),
            page,
            text,
        }
    }

    fn places(&self, text: TextSize) -> Places {
        let (line, letter) = (text.height(), text.advance());
        let [left, top] = [(AXIS_LETTERS * letter).ceil() + 2.0 * TICK, 2.0 * line];
        let (panel, below) = (line + (PANEL_LETTERS * letter).ceil(), 3.3 * line);
        let longest = f64::from(self.size);
        let frame = self.frame.size();
        let room = [longest - left - panel, longest - top - below];
        let scale = (room[0] / frame[0]).min(room[1] / frame[1]);
        // Three decimals, so that a picture of text has the very same scale.
        let scale = if scale > 1.0 { (scale * 1000.0).floor() / 1000.0 } else { scale };
        let [width, height] = frame.map(|side| (side * scale).ceil());
        let panel_lines = 2.0 + self.heading.len() as f64 + self.keys.len() as f64 + 4.0;
        Places {
            left,
            top,
            right: left + width,
            bottom: top + height,
            width: left + width + panel,
            height: (top + height + below).max(panel_lines * 1.35 * line),
            view: View {
                scale,
                origin: [
                    left - self.frame.min[0] * scale,
                    top + height + self.frame.min[1] * scale,
                ],
            },
        }
    }

    /// Ticks and their numbers, and the axis's name at its end.
    fn axis(&self, axis: usize, places: &Places, text: TextSize, page: &mut Vec<Mark>) {
        let line = text.height();
        let (low, high) = (self.frame.min[axis], self.frame.max[axis]);
        let apart = [text.advance() * (AXIS_LETTERS - 1.0), 2.2 * line][axis];
        let (step, decimals) = round_step(apart / places.view.scale);
        // Numbers below the picture stand side by side: the longest decides, which may have decimals.
        let letters = [low, high].map(|end| format!("{end:.decimals$}").len());
        let room = [text.advance() * (1 + letters[0].max(letters[1])) as f64, apart][axis];
        let (step, decimals) = if step * places.view.scale < room - 1e-6 {
            round_step(room / places.view.scale)
        } else {
            (step, decimals)
        };
        let first = (low / step).ceil();
        let count = ((high / step).floor() - first).max(-1.0) + 1.0;
        for k in 0..count as usize {
            let value = (first + k as f64) * step;
            let number = format!("{value:.decimals$}");
            let pixel = places.view.pixel([value; 2])[axis];
            let (from, to, at, anchor) = if axis == 0 {
                let below = places.bottom + TICK + 0.7 * line;
                let tick = [[pixel, places.bottom], [pixel, places.bottom + TICK]];
                (tick[0], tick[1], [pixel, below], Anchor::Middle)
            } else {
                let beside = places.left - 1.5 * TICK;
                let tick = [[places.left - TICK, pixel], [places.left, pixel]];
                (tick[0], tick[1], [beside, pixel], Anchor::End)
            };
            page.push(Mark::Line { from, to, width: 1.0, colour: FRAME });
            page.push(Mark::Text { at, anchor, text: number });
        }
        let (at, anchor) = if axis == 0 {
            ([places.right, places.bottom + TICK + 1.8 * line], Anchor::End)
        } else {
            ([places.left - 1.5 * TICK, places.top - line], Anchor::End)
        };
        page.push(Mark::Text { at, anchor, text: format!("{} mm", self.axes[axis]) });
    }

    /// Heading and legend.
    fn panel(&self, places: &Places, text: TextSize, page: &mut Vec<Mark>) {
        let line = text.height();
        let (left, step) = (places.right + 0.8 * line, 1.35 * line);
        let mut y = places.top + 0.5 * line;
        for words in &self.heading {
            page.push(Mark::Text { at: [left, y], anchor: Anchor::Start, text: words.clone() });
            y += step;
        }
        y += 0.6 * step;
        for (colour, words) in &self.keys {
            let side = 0.8 * line;
            let at = [left, y - side / 2.0];
            page.push(Mark::Rectangle { at, size: [side; 2], colour: *colour });
            let at = [left + 1.3 * line, y];
            page.push(Mark::Text { at, anchor: Anchor::Start, text: words.clone() });
            y += step;
        }
    }
}

/// Hides what of the scene is outside its frame.
fn margins(places: &Places) -> Vec<Mark> {
    let Places { left, top, right, bottom, width, height, .. } = *places;
    let white = |at: [f64; 2], to: [f64; 2]| Mark::Rectangle {
        at,
        size: [to[0] - at[0], to[1] - at[1]],
        colour: PAPER,
    };
    vec![
        white([0.0, 0.0], [width + 1.0, top]),
        white([0.0, bottom], [width + 1.0, height + 1.0]),
        white([0.0, top], [left, bottom]),
        white([right, top], [width + 1.0, bottom]),
    ]
}

fn outline(places: &Places, page: &mut Vec<Mark>) {
    let Places { left, top, right, bottom, .. } = *places;
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]];
    for side in corners.windows(2) {
        page.push(Mark::Line { from: side[0], to: side[1], width: 1.0, colour: FRAME });
    }
}

/// A round length with its name above, at the panel's lower end.
fn scale_bar(places: &Places, text: TextSize, page: &mut Vec<Mark>) {
    let line = text.height();
    let (left, y) = (places.right + 0.8 * line, places.height - 3.3 * line);
    // The next smaller round length.
    let (length, decimals) = round_step(BAR * line / places.view.scale / 2.5);
    let end = left + length * places.view.scale;
    let mut bar = |from, to| page.push(Mark::Line { from, to, width: 2.0, colour: INK });
    bar([left, y], [end, y]);
    bar([left, y - TICK], [left, y + TICK]);
    bar([end, y - TICK], [end, y + TICK]);
    let at = [(left + end) / 2.0, y - line];
    let text = format!("{length:.decimals$} mm");
    page.push(Mark::Text { at, anchor: Anchor::Middle, text });
}

/// The least of 1, 2, 5, 10, 20 and so on that is not below `least`, and the decimals that show it.
fn round_step(least: f64) -> (f64, usize) {
    let mut decade = 0.001;
    for decimals in [3, 2, 1, 0, 0, 0, 0, 0] {
        for (k, factor) in [1.0, 2.0, 5.0].into_iter().enumerate() {
            let step: f64 = decade * factor;
            // 0.001 times a power of ten is not exact, and neither is what is printed.
            if step >= least * (1.0 - 1e-9) || (decade >= 1e4 && k == 2) {
                return (step, decimals);
            }
        }
        decade *= 10.0;
    }
    (decade, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        let near = |least, expected: f64, decimals| {
            let (step, found) = round_step(least);
            assert!((step - expected).abs() < 1e-9 && found == decimals, "{least}: {step}");
        };
        near(0.15, 0.2, 1);
        near(0.03, 0.05, 2);
        near(2.0, 2.0, 0);
        near(6.0, 10.0, 0);
        near(1e9, 50_000.0, 0);
    }

    #[test]
    fn numbers_below_the_picture_do_not_run_together() {
        for (size, low, side) in
            [(1000, 106.0, 7.0), (900, 108.4, 3.2), (400, -12.0, 1.5), (2000, 0.0, 0.4)]
        {
            let frame = Frame { min: [low, 10.0], max: [low + side, 10.0 + side] };
            let (heading, keys) = (Vec::new(), Vec::new());
            let page = Page { size, frame, axes: ["x", "y"], heading, keys };
            let drawing = page.lay_out();
            let letter = drawing.text.advance();
            let below = drawing.page.iter().filter_map(|mark| match mark {
                Mark::Text { at, anchor: Anchor::Middle, text } if !text.ends_with("mm") => {
                    let half = text.len() as f64 * letter / 2.0;
                    Some([at[0] - half, at[0] + half])
                }
                _ => None,
            });
            let below: Vec<[f64; 2]> = below.collect();
            assert!(below.len() > 1, "{size}: {below:?}");
            let apart = |pair: &[[f64; 2]]| pair[1][0] - pair[0][1] > 0.9 * letter;
            assert!(below.windows(2).all(apart), "{size}: {below:?}");
        }
    }
}
