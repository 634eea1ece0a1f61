//! Moves of a layer -> Moves that z can follow: slows down lines that rise and fall.
//!
//! Words: the *sine* of a line is how far it rises for each mm that the nozzle goes; a *joint* is where
//! one line of a path follows another; its *change* is that of the sine. A line's feed is the least of
//! 1. the one that it has, by its role and by what the hot end melts;
//! 2. the speed of z: speed · sine is no more than the highest speed of that axis, also as the file tells z,
//!    in thousandths of a mm;
//! 3. the acceleration of z: speed² · change / (mean length of both lines) is no more than that of the
//!    axis. Where a surface bends, lines follow it in many short steps, and this is the curvature;
//! 4. what the joint allows, by the machine's own rule for corners ([`motion::joint`]).
//!
//! A planner would slow down for the last one by itself. But some know less of z than they should, and
//! lines of one speed are laid evenly. A long line is not slow for the sake of its end: the last
//! [`PIECE`] of it is a move of its own, if at least [`WORTH`] is left.
//!
//! All this is about paths that rise. Layers without one are left as they are.

use super::drive::Drives;
use super::flow::FlowLimit;
use super::moves::{Kind, Move, Moves};
use super::number::thousandths;
use super::reshaped::Bound;
use crate::motion::{self, Limits, Rates};
use crate::profile::Settings;
use crate::units::{Bounded as _, MmPerS, Thousandths, nearest, to_mm};

/// What is slow of a long line beside a joint, mm: short enough to take no time, long enough for the
/// rounding of coordinates not to change its slope.
const PIECE: f64 = 0.2;

/// What is left of a line between such pieces, mm, or it is slow as a whole: lines that follow a bend
/// are shorter, and would go by fits and starts.
const WORTH: f64 = 1.0;

/// What such a piece takes at least, s: what the slowest printers need to be fed with a move.
const FEEDING: f64 = 0.02;

/// No line is slowed down below this, mm/s: a joint that bears less stops the nozzle in any case.
const SLOWEST: f64 = 0.5;

/// A smaller change of the sine is none: that of lines in one plane, by the rounding of their ends.
const SAME: f64 = 1e-4;

/// Slows down lines that rise and fall.
#[derive(Debug, Clone)]
pub(super) struct Slopes {
    /// Highest speed of z, mm/s.
    speed: f64,
    /// Highest acceleration of z, mm/s².
    acceleration: f64,
    /// What the machine's planner holds itself to, where the role asks for nothing else.
    rates: Rates,
    drives: Option<Drives>,
    flow: FlowLimit,
    /// Cross-section of the filament, mm².
    area: f64,
}

/// A line of a path.
#[derive(Debug, Clone, Copy)]
struct Line {
    step: Move,
    /// Where it begins.
    from: Place,
    /// How far it goes in plan, and how far it rises, mm.
    way: [f64; 2],
    bound: Bound,
    /// The highest feeds beside the joints at its two ends, mm/min.
    ends: [u32; 2],
}

/// A place of the nozzle: x and y, thousandths of a mm, and z, grid units.
type Place = ([Thousandths; 2], i32);

impl Line {
    fn sine(&self) -> f64 {
        self.way[1] / self.step.length
    }

    /// The sine as it is told: a short line is steeper or gentler by the rounding of its ends.
    fn told_sine(&self) -> f64 {
        let [begin, end] = [self.from.1, self.step.z].map(|z| thousandths(to_mm(z)));
        let rise = (end - begin) as f64 / 1000.0;
        rise / self.way[0].hypot(rise).at_least(f64::MIN_POSITIVE)
    }

    /// No faster than this, mm/s.
    fn cap(&mut self, speed: f64, bound: Bound) {
        let feed = whole(speed);
        if feed < self.step.feed {
            (self.step.feed, self.bound) = (feed, bound);
        }
    }

    /// The part of it between two shares of its length.
    fn part(&self, [begin, end]: [f64; 2], feed: u32) -> Move {
        let between = |a: i32, b: i32| a + nearest(f64::from(b - a) * end) as i32;
        let (from, z) = self.from;
        let share = end - begin;
        Move {
            to: [0, 1].map(|k| Thousandths(between(from[k].0, self.step.to[k].0))),
            z: between(z, self.step.z),
            feed,
            length: share * self.step.length,
            filament: share * self.step.filament,
            kind: self.step.kind,
        }
    }
}

impl Slopes {
    pub(super) fn new(settings: &Settings) -> Self {
        let limits = Limits::new(settings);
        Self {
            speed: settings.limits.speed_z,
            acceleration: settings.limits.acceleration_z,
            rates: Rates::new(limits),
            drives: Drives::new(settings),
            flow: FlowLimit::new(settings),
            area: settings.filament_area(),
        }
    }

    /// Slows down what rises on a layer, and says what holds it.
    pub(super) fn limit(&self, layer: &mut Moves) {
        if layer.risen.is_empty() {
            return;
        }
        let old = std::mem::take(&mut layer.moves);
        let starts = std::mem::take(&mut layer.paths);
        let risen = layer.risen.clone();
        let ends = starts.iter().copied().skip(1).chain(Some(old.len()));
        layer.moves.extend_from_slice(&old[..starts.first().copied().unwrap_or(old.len())]);
        for (path, (&first, end)) in starts.iter().zip(ends).enumerate() {
            layer.paths.push(layer.moves.len());
            let moves = &old[first..end];
            let is_bead = |step: &Move| matches!(step.kind, Kind::Extrude(_));
            let approach = match risen.binary_search(&path) {
                Ok(_) => moves.iter().take_while(|step| !is_bead(step)).count(),
                Err(_) => moves.len(),
            };
            layer.moves.extend_from_slice(&moves[..approach]);
            self.path(&moves[approach..], layer);
        }
        layer.slowed(self.area);
    }

    /// Adds the lines of a path that begins where the last move has ended.
    fn path(&self, beads: &[Move], layer: &mut Moves) {
        let Some(&start) = layer.moves.last().filter(|_| !beads.is_empty()) else {
            return layer.moves.extend_from_slice(beads);
        };
        let mut lines = self.lines(&start, beads);
        // What has no length has no slope: the lines beside it follow each other.
        let real: Vec<usize> = (0..lines.len()).filter(|&k| lines[k].step.length > 0.0).collect();
        for &k in &real {
            let sine = lines[k].sine().abs().at_least(lines[k].told_sine().abs());
            if sine > SAME {
                lines[k].cap(self.speed / sine, Bound::ZSpeed);
            }
        }
        for joint in real.windows(2) {
            let (a, b) = (lines[joint[0]], lines[joint[1]]);
            let change = (b.sine() - a.sine()).abs();
            if change > SAME {
                let mean = 0.5 * (a.step.length + b.step.length);
                let speed = (self.acceleration * mean / change).sqrt();
                joint.iter().for_each(|&k| lines[k].cap(speed, Bound::ZAcceleration));
            }
        }
        for joint in real.windows(2) {
            let most = self.joint(layer.layer, lines[joint[0]], lines[joint[1]]);
            (lines[joint[0]].ends[1], lines[joint[1]].ends[0]) = (most, most);
        }
        lines.iter().for_each(|line| add(line, layer));
    }

    /// The lines of a path, each no faster than its role and the hot end allow.
    fn lines(&self, start: &Move, beads: &[Move]) -> Vec<Line> {
        let mut from = (start.to, start.z);
        let line = |&step: &Move| {
            let begin = std::mem::replace(&mut from, (step.to, step.z));
            let rise = to_mm(step.z - begin.1);
            let plan = (step.length * step.length - rise * rise).at_least(0.0).sqrt();
            let melts = self.flow.holds(step.filament / step.length.at_least(1e-9), step.feed);
            let bound = if melts { Bound::Flow } else { Bound::Speed };
            Line { step, from: begin, way: [plan, rise], bound, ends: [u32::MAX; 2] }
        };
        beads.iter().map(line).collect()
    }

    /// The highest feed with which line `b` may follow line `a` of a layer, mm/min.
    fn joint(&self, layer: usize, a: Line, b: Line) -> u32 {
        let change = (b.sine() - a.sine()).abs();
        if change <= SAME {
            return u32::MAX;
        }
        let drive = self.drives.as_ref().and_then(|drives| {
            drives.get(drives.of(layer, &b.step.kind)?).map(|drive| &drive.rates)
        });
        let feed = MmPerS(f64::from(a.step.feed.min(b.step.feed)) / 60.0);
        let speed = motion::joint(drive.unwrap_or(&self.rates), [a.way, b.way], feed);
        if whole(speed) >= a.step.feed.min(b.step.feed) {
            return u32::MAX;
        }
        // The pieces beside it are lines as well.
        whole(speed.at_most((self.acceleration * PIECE / change).sqrt()))
    }
}

/// Adds a line, with a piece of its own beside each joint that asks for less than its feed.
fn add(line: &Line, layer: &mut Moves) {
    let (step, long) = (line.step, line.step.length);
    let slow = line.ends.map(|feed| feed < step.feed);
    let [begin, end] = [0, 1].map(|k| {
        let piece = PIECE.at_least(FEEDING * f64::from(line.ends[k]) / 60.0);
        if slow[k] { piece } else { 0.0 }
    });
    if slow == [false; 2] {
        layer.slopes.note(line.bound, long);
        return layer.moves.push(step);
    }
    if begin + end + WORTH > long {
        layer.slopes.note(Bound::ZJerk, long);
        let feed = step.feed.min(line.ends[0]).min(line.ends[1]);
        return layer.moves.push(Move { feed, ..step });
    }
    let [first, last] = [begin / long, 1.0 - end / long];
    if slow[0] {
        layer.moves.push(line.part([0.0, first], line.ends[0]));
    }
    layer.moves.push(line.part([first, last], step.feed));
    if slow[1] {
        layer.moves.push(Move { to: step.to, z: step.z, ..line.part([last, 1.0], line.ends[1]) });
    }
    layer.slopes.note(Bound::ZJerk, begin + end);
    layer.slopes.note(line.bound, long - begin - end);
}

/// A speed, mm/s, as a feed of whole mm/min that is no faster; nothing is slower than [`SLOWEST`].
fn whole(speed: f64) -> u32 {
    (60.0 * speed.at_least(SLOWEST)).at_most(f64::from(u32::MAX)).floor() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_line_is_as_steep_as_the_file_tells_it() {
        // From 0.3004 to 0.3695 mm: 69.1 µm, and 70 in the file.
        let step = Move {
            to: [Thousandths(100), Thousandths(0)],
            z: 3_695,
            feed: 1_200,
            length: 0.1_f64.hypot(0.0691),
            filament: 0.01,
            kind: Kind::Travel,
        };
        let from = ([Thousandths(0); 2], 3_004);
        let line =
            Line { step, from, way: [0.1, 0.0691], bound: Bound::Speed, ends: [u32::MAX; 2] };
        let told = 0.07 / 0.1_f64.hypot(0.07);
        assert!(line.sine() < 0.992 * told && (line.told_sine() - told).abs() < 1e-6);
    }
}
