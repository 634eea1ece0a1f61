//! Line that rises along a plane -> Course: its top and its height from place to place, and its outline.
//!
//! Words used here: *along* is the way along the plane, mm; the *foot* of a place is the point of the
//! line nearest to it, seen from above. A bead is as high above the bed as its foot says, and its ends
//! are level: beyond the line's end the foot stays there.
//!
//! Heights are upright: a bead has the same room above the one below whatever its slope.

/// A line that runs along the plane by less than this part of its way is across it.
const ALONG: f64 = 0.05;

/// Less rise than this within a section is none, mm.
const LEAST_RISE: f64 = 0.002;

/// Corners of a round end.
const CORNERS: u32 = 6;

/// A place of a bead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Where it is along the plane, mm.
    pub at: f64,
    /// Its upper side above the bed, mm.
    pub top: f64,
    /// Its height, mm.
    pub height: f64,
}

/// A line as the plane sees it: across and along it, then up, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// Where it begins.
    pub(super) from: [f64; 3],
    /// Where it ends.
    pub(super) to: [f64; 3],
    /// Whether it may be part of a line that rises: then it has a course even where it is level.
    pub(super) is_skin: bool,
}

impl Line {
    /// Its course between two places along the plane, `height` high and `sunk` mm lower than the
    /// nozzle; empty if it does not rise there.
    pub(super) fn course(&self, [low, high]: [f64; 2], height: f64, sunk: f64) -> Vec<Spot> {
        let way: [f64; 3] = std::array::from_fn(|axis| self.to[axis] - self.from[axis]);
        let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
        let unit = [way[0] / length, way[1] / length];
        let spot = |at: f64| {
            let foot = (at - self.from[1]) * unit[1] - self.from[0] * unit[0];
            let top = self.from[2] + way[2] * (foot / length).clamp(0.0, 1.0) - sunk;
            Spot { at, top: super::millimetres(top), height }
        };
        // NaN too, of a line without length.
        if unit[1].is_nan() || unit[1].abs() < ALONG {
            return Vec::new();
        }
        let begin = self.from[1] + self.from[0] * unit[0] / unit[1];
        let ends = [begin, begin + length / unit[1]].map(|at| spot(at.clamp(low, high)));
        let rises = (ends[1].top - ends[0].top).abs() > LEAST_RISE;
        // Half-way between along and across.
        let goes_along = self.is_skin && unit[1].abs() > 0.7;
        if ends[0].at == ends[1].at || !(rises || goes_along) {
            return Vec::new();
        }
        ends.to_vec()
    }
}

/// Whether a course goes on where another ends, the same way.
pub(super) fn goes_on(before: &[Spot], after: &[Spot]) -> bool {
    let way = |course: &[Spot]| Some((course.last()?.at - course.first()?.at).signum());
    !before.is_empty() && way(before) == way(after)
}

/// The outline of a bead with this course that reaches from `low` to `high`, `inset` mm within it.
pub(super) fn outline(course: &[Spot], [low, high]: [f64; 2], inset: f64) -> Vec<[f64; 2]> {
    let mut course = course.to_vec();
    let (Some(first), Some(last)) = (course.first(), course.last()) else { return Vec::new() };
    if first.at > last.at {
        course.reverse();
    }
    let (first, last) = (course[0], course[course.len() - 1]);
    let most = (high - low) / 2.0;
    let (left, right) = ((first.height / 2.0).min(most), (last.height / 2.0).min(most));
    let within = (low + left, high - right);
    course.retain(|spot| spot.at > within.0 && spot.at < within.1);
    let end = |at: f64, own: Spot, next: Spot| {
        // Between the end of the line and the next place of it the bead rises.
        let part = if next.at == own.at { 1.0 } else { (at - own.at) / (next.at - own.at) };
        let top = own.top + (next.top - own.top) * part.clamp(0.0, 1.0);
        Spot { at, top, height: own.height }
    };
    let begin = end(within.0, first, course.first().copied().unwrap_or(last));
    let stop = end(within.1, last, course.last().copied().unwrap_or(first));
    let inner = |spot: &Spot| (spot.at, spot.top - inset, spot.top - spot.height + inset);
    let mut outline = Vec::with_capacity(2 * course.len() + 4 * CORNERS as usize);
    let spots = || std::iter::once(&begin).chain(&course).chain(std::iter::once(&stop));
    outline.extend(spots().map(inner).map(|(at, top, _)| [at, top]));
    round_end(&stop, right, inset, &mut outline);
    outline.extend(spots().rev().map(inner).map(|(at, _, bottom)| [at, bottom]));
    round_end(&begin, -left, inset, &mut outline);
    outline
}

/// The corners between the upper and the lower side at an end (for `radius` below 0 the lower and the
/// upper one).
fn round_end(spot: &Spot, radius: f64, inset: f64, outline: &mut Vec<[f64; 2]>) {
    let middle = spot.top - spot.height / 2.0;
    let (wide, high) = (radius - inset * radius.signum(), spot.height / 2.0 - inset);
    for corner in 1..CORNERS {
        let angle = std::f64::consts::PI * f64::from(corner) / f64::from(CORNERS);
        let (sin, cos) = libm::sincos(angle);
        outline.push([spot.at + wide * sin, middle + high * cos * radius.signum()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_along_the_plane_rises_within_its_section_and_its_ends_are_level() {
        let line = Line { from: [0.0, 1.0, 2.0], to: [0.0, 5.0, 3.0], is_skin: false };
        let course = line.course([0.8, 5.2], 0.2, 0.0);
        let spots: Vec<_> = course.iter().map(|spot| (spot.at, spot.top)).collect();
        assert_eq!(spots, [(1.0, 2.0), (5.0, 3.0)]);
        let outline = outline(&course, [0.8, 5.2], 0.0);
        let most = |axis: usize, way: f64| {
            outline.iter().map(|at| at[axis] * way).fold(f64::NEG_INFINITY, f64::max) * way
        };
        let all = [most(0, -1.0), most(0, 1.0), most(1, -1.0), most(1, 1.0)];
        for (found, wanted) in all.into_iter().zip([0.8, 5.2, 1.8, 3.0]) {
            assert!((found - wanted).abs() < 1e-9, "{all:?}");
        }
    }

    #[test]
    fn a_line_across_has_no_course_and_a_slanting_one_a_tilted_section() {
        let across = Line { from: [-3.0, 1.0, 2.0], to: [3.0, 1.0, 4.0], is_skin: true };
        assert!(across.course([0.8, 1.2], 0.2, 0.0).is_empty());
        let slanting = Line { from: [-2.0, -2.0, 1.0], to: [2.0, 2.0, 3.0], is_skin: false };
        let course = slanting.course([-0.3, 0.3], 0.2, 0.0);
        // At 0.3 along the plane the foot is 0.15 from the middle in both ways.
        assert!((course[1].top - 2.075).abs() < 1e-9, "{course:?}");
    }
}
