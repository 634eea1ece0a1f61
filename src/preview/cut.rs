//! Print and an upright plane -> Drawing: the beads that the plane cuts, each as its cross-section.
//!
//! Words used here: *across* is the axis that the plane stands on, *along* the other one; a *section*
//! is the cross-section of a bead: a rectangle with round ends, as wide as the plane's way through
//! the bead.
//!
//! From above a line is a stripe with round ends, and the plane a line through it: the section reaches
//! from the stripe's one side to the other. Where the plane only grazes a bead's round side the
//! section is lower than the bead. Its height above the bed is that of the nozzle where the plane
//! crosses the line, so that lines that rise are cut right.
//!
//! A path of many short lines would show a section for each. Those of successive lines that touch,
//! and are as high or hardly stick out, are drawn as one.

use super::colours::{Colour, is_thick};
use super::drawing::{Drawing, Frame, Kind, Look, Stroke};
use super::page::Page;
use super::{Keys, MARGIN, measured, millimetres};
use crate::reader::Print;
use crate::reader::print::Step;

/// The axis that a plane stands across.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// The plane has the same x everywhere; y is to the right.
    X,
    /// The plane has the same y everywhere; x is to the right.
    Y,
}

/// An upright plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Across it.
    pub axis: Axis,
    /// Where it is on this axis, mm on the bed.
    pub at: f64,
}

/// The cross-section of a bead: a rectangle with round ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// From here along the plane,
    pub low: f64,
    /// to here, mm.
    pub high: f64,
    /// Its lower side above the bed, mm.
    pub bottom: f64,
    /// Its height, mm.
    pub height: f64,
    /// Its colour.
    pub colour: Colour,
}

/// What a plane cuts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cut {
    /// The cross-sections, in the order in which they are printed.
    pub sections: Vec<Section>,
    /// What they mean.
    keys: Keys,
}

impl Axis {
    /// Its letter.
    #[must_use]
    pub fn name(self) -> &'static str {
        if self == Self::X { "x" } else { "y" }
    }

    /// The axis along the plane.
    fn along(self) -> Self {
        if self == Self::X { Self::Y } else { Self::X }
    }
}

impl Cut {
    /// Cuts through a print.
    #[must_use]
    pub fn new(print: &Print, plane: Plane) -> Self {
        let mut cut = Self::default();
        for layer in &print.layers {
            let mut last: Option<&Step> = None;
            for step in print.moves_of(layer).iter().filter(|step| measured(step)) {
                let thick = is_thick(step, layer);
                let Some(section) = section(step, plane, Colour::of(step.role, thick)) else {
                    continue;
                };
                cut.keys.step(step, layer);
                let goes_on = last.is_some_and(|last| last.to == step.from);
                match cut.sections.last_mut() {
                    Some(before) if goes_on && before.meets(&section) => before.take_in(&section),
                    _ => cut.sections.push(section),
                }
                last = Some(step);
            }
        }
        cut
    }

    /// What holds all cross-sections and the bed's surface, mm along the plane and above the
    /// bed, with a margin around it; empty if nothing is cut.
    #[must_use]
    pub fn frame(&self) -> Frame {
        let mut frame = Frame::EMPTY;
        for section in &self.sections {
            frame.include([section.low, section.bottom.min(0.0)], 0.0);
            frame.include([section.high, section.bottom + section.height], 0.0);
        }
        let size = frame.size();
        frame.padded(MARGIN * size[0].max(size[1]))
    }

    /// Draws what is within `frame`; `size` is the longer side in pixels.
    #[must_use]
    pub fn drawing(&self, plane: Plane, frame: Frame, size: u32) -> Drawing {
        let name = plane.axis.name();
        let heading = vec![format!("cut at {name} = {} mm", millimetres(plane.at))];
        let axes = [plane.axis.along().name(), "z"];
        let mut drawing = Page { size, frame, axes, heading, keys: self.keys.list() }.lay_out();
        let strokes = self.sections.iter().map(Section::stroke);
        drawing.scene = strokes
            .filter(|stroke| {
                let (first, last) = (stroke.points[0], stroke.points[stroke.points.len() - 1]);
                frame.touches(first, last, stroke.look.width / 2.0)
            })
            .collect();
        drawing
    }
}

impl Section {
    /// Whether another one of the same path is drawn as one with this: they touch, and are as
    /// high, or the lower one hardly sticks out.
    fn meets(&self, other: &Self) -> bool {
        let (low, high) = if self.height < other.height { (self, other) } else { (other, self) };
        let beyond = (high.low - low.low).max(low.high - high.high);
        self.colour == other.colour
            && self.low <= other.high
            && other.low <= self.high
            && (low.height == high.height && low.bottom == high.bottom
                || beyond <= high.height / 2.0)
    }

    fn take_in(&mut self, other: &Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        if other.height > self.height {
            (self.bottom, self.height) = (other.bottom, other.height);
        }
    }

    fn stroke(&self) -> Stroke {
        let wide = self.high - self.low;
        let (from, to, width) = if wide >= self.height {
            let (round, y) = (self.height / 2.0, self.bottom + self.height / 2.0);
            ([self.low + round, y], [self.high - round, y], self.height)
        } else {
            let (round, x) = (wide / 2.0, (self.low + self.high) / 2.0);
            ([x, self.bottom + round], [x, self.bottom + self.height - round], wide)
        };
        Stroke {
            points: vec![from, to],
            look: Look { width: millimetres(width), colour: self.colour, kind: Kind::Bead },
        }
    }
}

/// Where the plane cuts a line: from above, the line is a stripe with round ends.
fn section(step: &Step, plane: Plane, colour: Colour) -> Option<Section> {
    let across = usize::from(plane.axis == Axis::Y);
    // Seen from above, with the plane through the origin: across it and along it.
    let point = |at: [f32; 3]| [f64::from(at[across]) - plane.at, f64::from(at[1 - across])];
    let (from, to) = (point(step.from), point(step.to));
    let (radius, height) = (f64::from(step.width) / 2.0, f64::from(step.height));
    let away = if from[0] * to[0] <= 0.0 { 0.0 } else { from[0].abs().min(to[0].abs()) };
    if away >= radius {
        return None;
    }
    let (low, high) = stripe(from, to, radius);
    // A bead's own ends are round: where the plane only grazes it, it is lower.
    let round = (height / 2.0).min(radius);
    let outside = (away - (radius - round)).max(0.0) / round;
    let cut_height = height * (1.0 - outside * outside).max(0.0).sqrt();
    let part = if from[0] == to[0] { 0.0 } else { (from[0] / (from[0] - to[0])).clamp(0.0, 1.0) };
    let (z, z_to) = (f64::from(step.from[2]), f64::from(step.to[2]));
    let middle = z + (z_to - z) * part - height / 2.0;
    let bottom = millimetres(middle - cut_height / 2.0);
    Some(Section { low, high, bottom, height: millimetres(cut_height), colour })
}

/// The stretch of the line x = 0 that is within `radius` of the way between two points,
/// one of which is.
fn stripe(from: [f64; 2], to: [f64; 2], radius: f64) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut meet = |y: f64| {
        low = low.min(y);
        high = high.max(y);
    };
    for end in [from, to] {
        let half = (radius * radius - end[0] * end[0]).max(0.0).sqrt();
        if end[0].abs() <= radius {
            meet(end[1] - half);
            meet(end[1] + half);
        }
    }
    let way = [to[0] - from[0], to[1] - from[1]];
    let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
    for side in [-radius, radius] {
        // The stripe's sides, a radius beside the way.
        let shift = [-way[1] / length * side, way[0] / length * side];
        let (a, b) = (from[0] + shift[0], to[0] + shift[0]);
        if a * b <= 0.0 && a != b {
            meet(from[1] + shift[1] + way[1] * a / (a - b));
        }
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reader::Role;

    fn line(from: [f32; 2], to: [f32; 2]) -> Step {
        Step {
            from: [from[0], from[1], 1.0],
            to: [to[0], to[1], 1.0],
            filament: 1.0,
            feed: 10.0,
            width: 0.5,
            height: 0.25,
            role: Role::Skin,
            line: 1,
        }
    }

    fn cut(step: &Step, at: f64) -> Option<Section> {
        section(step, Plane { axis: Axis::X, at }, Colour([0; 3]))
    }

    #[test]
    fn a_line_across_the_plane_is_as_wide_as_it_is() {
        let found = cut(&line([0.0, 3.0], [10.0, 3.0]), 4.0).unwrap();
        assert_eq!((found.low, found.high), (2.75, 3.25));
        assert_eq!((found.bottom, found.height), (0.75, 0.25));
    }

    #[test]
    fn a_slanting_line_is_cut_wider_and_a_line_along_the_plane_as_long_as_it_is() {
        let found = cut(&line([0.0, 0.0], [10.0, 10.0]), 4.0).unwrap();
        assert!((found.high - found.low - 0.5 * 2_f64.sqrt()).abs() < 1e-9, "{found:?}");
        let found = cut(&line([4.0, 1.0], [4.0, 9.0]), 4.0).unwrap();
        assert_eq!((found.low, found.high, found.height), (0.75, 9.25, 0.25));
    }

    #[test]
    fn a_plane_that_grazes_a_line_cuts_its_round_side() {
        let along = line([4.0, 1.0], [4.0, 9.0]);
        assert!(cut(&along, 4.26).is_none());
        let found = cut(&along, 4.2).unwrap();
        // 0.075 mm out from where the side of 0.125 mm radius begins.
        assert!((found.height - 0.2).abs() < 1e-3, "{found:?}");
    }
}
