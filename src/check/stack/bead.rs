//! A line as it is laid -> Bead: which part of it lies near another, and how high.
//!
//! Words used here: a *bead* is a line as it is laid: all places within half of its width of the way of the
//! nozzle; a *way* is the part of a line, from 0 at its beginning to 1 at its end, that lies within some
//! distance of a bead: one stretch, since such a place has no dents.
//!
//! A line is looked at as the other sees it: how far along that, and how far to its side. Beside the other it
//! lies between two straight lines, around the other's ends in circles; the way is what all of them hold
//! together. Most lines are off to one side, which is asked first.

use crate::geom::segment;
use crate::reader::Role;
use crate::reader::print::Step;
use crate::units::Bounded as _;

/// Gap that may be between support and part, mm: it must come off. Two layers of 0.2 mm, and rounding.
pub(crate) const SUPPORT_GAP: f64 = 0.45;

/// A line with round ends, from above.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bead {
    pub(crate) from: [f64; 2],
    /// From its beginning to its end, of length 1.
    pub(crate) along: [f64; 2],
    /// mm.
    pub(crate) length: f64,
    /// Half of its width, mm.
    pub(crate) radius: f64,
    /// Height of the nozzle at its beginning and its end, mm.
    pub(crate) heights: [f64; 2],
    /// Its chain, from 0 in its layer.
    pub(crate) chain: u32,
    /// Its line, by the moves of its layer.
    pub(crate) step: u32,
    /// Length of its chain up to its end, mm.
    pub(crate) reach: f64,
    /// Whether it is of support.
    pub(crate) is_support: bool,
}

impl Bead {
    pub(crate) fn of(step: &Step) -> Self {
        let flat = |at: [f32; 3]| [f64::from(at[0]), f64::from(at[1])];
        Self {
            radius: f64::from(step.width) / 2.0,
            heights: [step.from[2], step.to[2]].map(f64::from),
            is_support: step.role == Role::Support,
            ..Self::between(flat(step.from), flat(step.to))
        }
    }

    /// A line without a width, from above.
    pub(crate) fn between(from: [f64; 2], to: [f64; 2]) -> Self {
        let way = segment::way(from, to);
        let length = segment::dot(way, way).sqrt();
        let scale = 1.0 / length.max(f64::MIN_POSITIVE);
        Self {
            from,
            along: [way[0] * scale, way[1] * scale],
            length,
            radius: 0.0,
            heights: [0.0; 2],
            chain: 0,
            step: 0,
            reach: 0.0,
            is_support: false,
        }
    }

    /// Height of the nozzle at its higher end, mm.
    pub(crate) fn highest(&self) -> f64 {
        self.heights[0].at_least(self.heights[1])
    }

    /// How high what it carries may lie, mm: on support, with the gap by which that comes off.
    pub(crate) fn top(&self) -> f64 {
        self.highest() + if self.is_support { SUPPORT_GAP } else { 0.0 }
    }

    /// Height of the nozzle at a part of it, from 0 to 1, mm.
    pub(crate) fn height(&self, part: f64) -> f64 {
        self.heights[0] + part * (self.heights[1] - self.heights[0])
    }

    /// Height of the nozzle where it is nearest to a place, mm.
    pub(crate) fn height_at(&self, at: [f64; 2]) -> f64 {
        if self.is_level() {
            return self.heights[0];
        }
        let along = segment::dot(segment::way(self.from, at), self.along);
        self.height((along / self.length).clamp(0.0, 1.0))
    }

    /// Height of the nozzle at a place beside it, mm, if it went on beyond its ends as it goes between them. A line
    /// that is shorter than wide is as high as its middle.
    pub(crate) fn height_along(&self, at: [f64; 2]) -> f64 {
        if self.is_level() || self.length < self.radius {
            return self.middle();
        }
        let along = segment::dot(segment::way(self.from, at), self.along);
        self.height(along / self.length)
    }

    /// Whether all of it lies at one height.
    pub(crate) fn is_level(&self) -> bool {
        self.heights[0] == self.heights[1]
    }

    /// How far it lies above another line at a part of it, from 0 to 1, mm.
    pub(crate) fn above(&self, other: &Self, part: f64) -> f64 {
        self.height(part) - other.height_at(self.place(part))
    }

    /// Height in its middle, mm.
    pub(crate) fn middle(&self) -> f64 {
        0.5 * (self.heights[0] + self.heights[1])
    }

    /// The same line, as much to its left, mm; below 0 to its right.
    pub(crate) fn aside(&self, mm: f64) -> Self {
        let [x, y] = self.along;
        Self { from: segment::along(self.from, mm, [-y, x]), ..*self }
    }

    /// A place of it, from 0 to 1.
    pub(crate) fn place(&self, part: f64) -> [f64; 2] {
        segment::along(self.from, part * self.length, self.along)
    }

    /// The part of this line that lies within `mm` of the middle of another.
    pub(crate) fn way(&self, other: &Self, mm: f64) -> Option<[f64; 2]> {
        // As the other sees it: along itself, and to its side. Most lines are off to a side.
        let [u, v] = segment::way(other.from, self.from);
        let [x, y] = other.along;
        let [dx, dy] = [self.along[0] * self.length, self.along[1] * self.length];
        let is_off = |from: f64, to: f64, low: f64, high: f64| {
            (from < low && to < low) || (from > high && to > high)
        };
        let (off, aside) = (x * v - y * u, x * dy - y * dx);
        if is_off(off, off + aside, -mm, mm) {
            return None;
        }
        let (at, by) = ([x * u + y * v, off], [x * dx + y * dy, aside]);
        if is_off(at[0], at[0] + by[0], -mm, other.length + mm) {
            return None;
        }
        let beside = within(at[1], by[1], [-mm, mm]).and_then(|beside| {
            let between = within(at[0], by[0], [0.0, other.length])?;
            both(beside, between)
        });
        // Its straight sides hold all of it, unless it leaves by an end.
        let mut way = beside;
        let ends = [0.0, other.length];
        let leaves = |part: f64| !(ends[0]..=ends[1]).contains(&(at[0] + part * by[0]));
        let is_whole = |[from, to]: [f64; 2]| {
            let (before, after) = (from - 1e-9, to + 1e-9);
            (from == 0.0 || !leaves(before)) && (to == 1.0 || !leaves(after))
        };
        if beside.is_some_and(is_whole) {
            return beside;
        }
        for end in ends {
            let round = in_circle([at[0] - end, at[1]], by, mm);
            way = match (way, round) {
                (Some(a), Some(b)) => Some([a[0].at_most(b[0]), a[1].at_least(b[1])]),
                (a, b) => a.or(b),
            };
        }
        way
    }

    /// Whether a place lies within `mm` of its middle.
    pub(crate) fn is_near(&self, at: [f64; 2], mm: f64) -> bool {
        let arm = segment::way(self.from, at);
        let along = segment::dot(arm, self.along).clamp(0.0, self.length);
        let off = segment::along(arm, -along, self.along);
        segment::dot(off, off) <= mm * mm
    }
}

/// The part from 0 to 1 over which `at + part · by` lies between two bounds.
pub(crate) fn within(at: f64, by: f64, [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    if by == 0.0 {
        return (low <= at && at <= high).then_some([0.0, 1.0]);
    }
    let (a, b) = ((low - at) / by, (high - at) / by);
    let (from, to) = (a.at_most(b).at_least(0.0), a.at_least(b).at_most(1.0));
    (from <= to).then_some([from, to])
}

/// What two stretches have in common.
pub(crate) fn both(a: [f64; 2], b: [f64; 2]) -> Option<[f64; 2]> {
    let (from, to) = (a[0].at_least(b[0]), a[1].at_most(b[1]));
    (from <= to).then_some([from, to])
}

/// The part from 0 to 1 over which `at + part · by` lies in a circle around 0.
fn in_circle(at: [f64; 2], by: [f64; 2], radius: f64) -> Option<[f64; 2]> {
    let (square, half) = (segment::dot(by, by), segment::dot(at, by));
    let rest = segment::dot(at, at) - radius * radius;
    if square == 0.0 {
        return (rest <= 0.0).then_some([0.0, 1.0]);
    }
    let root = half * half - square * rest;
    if root < 0.0 {
        return None;
    }
    let root = root.sqrt();
    both([(-half - root) / square, (-half + root) / square], [0.0, 1.0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn step(from: [f64; 2], to: [f64; 2], width: f64) -> Step {
        let at = |[x, y]: [f64; 2]| [x as f32, y as f32, 0.2];
        let (filament, feed, height) = (1.0, 1.0, 0.2);
        let width = width as f32;
        Step {
            from: at(from),
            to: at(to),
            filament,
            feed,
            width,
            height,
            role: Role::Skin,
            line: 1,
        }
    }

    proptest! {
        #[test]
        fn a_way_is_what_lies_within_the_distance(
            lines in prop::array::uniform4([0.0..9.0_f64, 0.0..9.0_f64]),
            mm in 0.1..2.0_f64,
        ) {
            let [a, b, c, d] = lines;
            let (line, other) = (Bead::of(&step(a, b, 0.4)), Bead::of(&step(c, d, 0.4)));
            let way = line.way(&other, mm);
            for k in 0..=200 {
                let part = f64::from(k) / 200.0;
                let distance = segment::distance2(line.place(part), [other.from, other.place(1.0)]).sqrt();
                if (distance - mm).abs() > 1e-3 {
                    let is_in = way.is_some_and(|[from, to]| from <= part && part <= to);
                    prop_assert_eq!(is_in, distance < mm, "{} {:?}", part, way);
                }
            }
        }
    }
}
