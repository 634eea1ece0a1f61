//! Print and an upright plane -> Drawing: the beads that the plane cuts, each as its cross-section.
//!
//! Words used here: *across* is the axis that the plane stands on, *along* the other one; a *section*
//! is the cross-section of a bead: a rectangle with round ends, as wide as the plane's way through
//! the bead.
//!
//! From above a line is a stripe with round ends, and the plane a line through it: the section reaches
//! from the stripe's one side to the other. Where the plane only grazes a bead's round side the
//! section is lower than the bead. Its height above the bed is that of the nozzle where the plane
//! crosses the line. A line that runs along the plane and rises has a height from place to place: its
//! *course* ([`course`]).
//!
//! A path of many short lines would show a section for each. Those of successive lines that touch,
//! and are as high or hardly stick out, are drawn as one; courses that go on are one in any case.
//!
//! [`course`]: super::course

use super::colours::{Colour, is_thick};
use super::course::{self, Line, Spot};
use super::drawing::{Drawing, Frame, Kind, Look, OUTLINE, Stroke};
use super::page::Page;
use super::{Keys, MARGIN, measured, millimetres};
use crate::reader::print::Step;
use crate::reader::{Print, Role};

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

/// The cross-section of a bead: a rectangle with round ends, or a strip with such that rises.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// From here along the plane,
    pub low: f64,
    /// to here, mm.
    pub high: f64,
    /// Its lower side above the bed, of a course the lowest, mm.
    pub bottom: f64,
    /// Its height, of a course the greatest, mm.
    pub height: f64,
    /// Its colour.
    pub colour: Colour,
    /// How it rises along the plane, from where its line begins; empty if it is level.
    pub course: Vec<Spot>,
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
                    Some(before) if goes_on && before.is_end_of(&section) => *before = section,
                    Some(before) if goes_on && section.is_end_of(before) => {}
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
            frame.include([section.high, section.top()], 0.0);
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
        drawing.scene = strokes.filter(|stroke| is_shown(stroke, &frame)).collect();
        drawing
    }
}

impl Section {
    /// Its upper side above the bed, of a course the highest, mm.
    #[must_use]
    pub fn top(&self) -> f64 {
        let highest = self.course.iter().map(|spot| spot.top).reduce(f64::max);
        highest.unwrap_or(self.bottom + self.height)
    }

    /// Whether another one of the same path is drawn as one with this: they touch, and are as
    /// high, or the lower one hardly sticks out; or a course goes on.
    fn meets(&self, other: &Self) -> bool {
        if !self.course.is_empty() || !other.course.is_empty() {
            return self.colour == other.colour && course::goes_on(&self.course, &other.course);
        }
        let (low, high) = if self.height < other.height { (self, other) } else { (other, self) };
        let beyond = (high.low - low.low).max(low.high - high.high);
        self.colour == other.colour
            && self.low <= other.high
            && other.low <= self.high
            && (low.height == high.height && low.bottom == high.bottom
                || beyond <= high.height / 2.0)
    }

    /// Whether it is but the end of the same path that another one shows with its course.
    fn is_end_of(&self, other: &Self) -> bool {
        let within = other.low <= self.low && self.high <= other.high;
        self.course.is_empty() && !other.course.is_empty() && within && self.colour == other.colour
    }

    fn take_in(&mut self, other: &Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        if !other.course.is_empty() {
            let mut course = other.course.as_slice();
            if self.course.last() == course.first() {
                course = &course[1..];
            }
            self.course.extend_from_slice(course);
            self.bottom = self.bottom.min(other.bottom);
            self.height = self.height.max(other.height);
        } else if other.height > self.height {
            (self.bottom, self.height) = (other.bottom, other.height);
        }
    }

    fn stroke(&self) -> Stroke {
        if !self.course.is_empty() {
            let points = course::outline(&self.course, [self.low, self.high], OUTLINE / 2.0);
            let look = Look { width: OUTLINE, colour: self.colour, kind: Kind::Outline };
            return Stroke { points, look };
        }
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

/// Whether some of a stroke may be within the frame.
fn is_shown(stroke: &Stroke, frame: &Frame) -> bool {
    if stroke.look.kind == Kind::Outline {
        let mut around = Frame::EMPTY;
        stroke.points.iter().for_each(|at| around.include(*at, 0.0));
        return frame.touches(around.min, around.max, 0.0);
    }
    let (first, last) = (stroke.points[0], stroke.points[stroke.points.len() - 1]);
    frame.touches(first, last, stroke.look.width / 2.0)
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
    let height_here = millimetres(cut_height);
    let line = Line {
        from: [from[0], from[1], z],
        to: [to[0], to[1], z_to],
        is_skin: step.role == Role::NonPlanar,
    };
    let course = line.course([low, high], height_here, (height - cut_height) / 2.0);
    let lowest = course.iter().map(|spot| millimetres(spot.top - spot.height));
    let bottom = lowest.reduce(f64::min).unwrap_or(bottom);
    Some(Section { low, high, bottom, height: height_here, colour, course })
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
    fn lines_that_rise_along_the_plane_are_one_strip_with_their_own_heights() {
        let text = ";LAYER_CHANGE\nG1 X40 Y0 Z0.2\nG1 X50 E0.5\nG1 X4 Z1\n;NONPLANAR_START 1\n;WIDTH:0.4\n;HEIGHT:0.2\n\
                    G1 Y10 Z2 E1\n;HEIGHT:0.3\nG1 Y20 Z1 E2\n;HEIGHT:0.2\nG1 X4.4 E2.1\n\
                    G1 Y10 Z2 E3\n;NONPLANAR_END\n";
        let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
        let plane = Plane { axis: Axis::X, at: 4.0 };
        let cut = Cut::new(&print, plane);
        let [strip] = cut.sections.as_slice() else { panic!("{:?}", cut.sections) };
        let spots: Vec<_> = strip.course.iter().map(|s| (s.at, s.top, s.height)).collect();
        let wanted = [(0.0, 1.0, 0.2), (10.0, 2.0, 0.2), (10.0, 2.0, 0.3), (20.0, 1.0, 0.3)];
        assert_eq!(spots, wanted);
        assert!((strip.low + 0.2).abs() < 1e-6 && (strip.high - 20.2).abs() < 1e-6, "{strip:?}");
        assert_eq!((strip.bottom, strip.top()), (0.7, 2.0));
        // What is drawn keeps to the strip: at half its way up the slope it is 0.2 mm high at 1.5 mm.
        let stroke = strip.stroke();
        assert_eq!(stroke.look.kind, Kind::Outline);
        assert!(stroke.points.iter().all(|at| at[1] > 0.69 && at[1] < 2.0), "{stroke:?}");
        // Across the plane each line is cut at its own height.
        let across = Cut::new(&print, Plane { axis: Axis::Y, at: 5.0 });
        let tops: Vec<_> = across.sections.iter().map(|section| section.top()).collect();
        assert_eq!((tops.len(), tops[0]), (1, 1.5), "{across:?}");
        let across = Cut::new(&print, Plane { axis: Axis::Y, at: 15.0 });
        let tops: Vec<_> = across.sections.iter().map(|section| section.top()).collect();
        assert_eq!(tops, [1.5, 1.5]);
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
