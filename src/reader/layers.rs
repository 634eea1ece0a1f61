//! Events -> events with layers: where layers begin in files without comments that mark them.
//!
//! Words used here: a *line* is a move that goes sideways and extrudes; a *run* is lines one after
//! the other without a break; a run's *height* is that of most of its level lines, if they are more
//! than half of it; a layer's *range* is all heights that its lines cover.
//!
//! The first layer begins with the first run that has a level line. Another begins with a run whose
//! height lies above the range of the layer before, or with one that returns to the bed: the next
//! of several parts. All other runs belong to the layer that is there already, however their height
//! varies: a skin that follows a surface goes up and down within its layer's range or widens it,
//! but most of it is never at one new height. A run that rises round after round is a spiral, and each
//! of its rounds is a layer (see `spiral`).
//!
//! Skins that were laid over a slope after the body under them, without marks, go far below their
//! layer's height and far above it, and lines across the slope are level, each at a height of its own.
//! Once a line lies lower than the layer before, only a run with two level lines at one height that turn
//! begins a layer, and it need only lie above the last one that began: walls do, lines across a slope do
//! not. Between marks of a patch no layer begins.
//!
//! What a run's height is shows only at its end, so that a run which leaves the range is held back
//! until then. Runs within the range, which all are in flat layers but the first of each, are
//! handed on at once. After the first mark in the file everything is.

use super::height::Heights;
use super::spiral::Spiral;
use super::{Event, Motion, Role};
use nalgebra::Vector3;

/// Heights that differ by less are the same, mm. Positions in files have at least three decimals;
/// a larger step would join layers of the finest prints with ramps in them.
const SAME_HEIGHT: f64 = 1e-4;

/// Share of a run that must be level at one height. A run across a bent skin has a tenth of its
/// pieces at its turning points, a seam that begins with a ramp is level for nine tenths.
const LEAST_LEVEL: f64 = 0.5;

/// Square of the sine from which on level lines turn, 10 degrees.
const TURN: f64 = 0.03;

/// Events that are held back, at most; by then a run is judged by what it was so far. It bounds
/// the memory; walls have fewer pieces than this before most of them is level.
const MOST_HELD: usize = 10_000;

/// Where the lines of a layer lie, mm.
#[derive(Debug, Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

/// Finds layers.
#[derive(Debug, Default)]
pub(super) struct Layers {
    /// Whether comments mark where layers begin.
    marked: bool,
    /// Of the layer that is there; `None` before the first.
    layer: Option<Range>,
    /// Height of the lowest layer so far, mm.
    lowest: f64,
    /// Heights of the last two layers that began with level lines, mm: the last, and the one before.
    levels: [f64; 2],
    /// Whether the layer has a skin over a slope.
    has_skin: bool,
    /// The run that goes on.
    run: Option<Run>,
    /// Its events from where it left the layer's range.
    held: Vec<(u64, Event)>,
}

/// A run of lines.
#[derive(Debug)]
struct Run {
    range: Range,
    heights: Heights,
    /// Its last line if that was level: its height and its way, mm.
    level: Option<[f64; 3]>,
    /// Whether two level lines at one height turn.
    turns: bool,
    spiral: Spiral,
    /// Whether it is known to be a spiral.
    is_spiral: bool,
    /// Where in what is held back its second round begins.
    second: Option<usize>,
    /// Whether it may begin a layer, and is held back.
    is_open: bool,
}

/// Receives events with the line each is from.
type Sink<'a> = &'a mut dyn FnMut(u64, Event);

impl Layers {
    /// Takes the next event of the file.
    pub(super) fn event(&mut self, line: u64, event: Event, sink: Sink<'_>) {
        if self.marked {
            return sink(line, event);
        }
        match &event {
            Event::Layer { .. } => {
                self.end_run(sink);
                self.marked = true;
            }
            Event::Move(motion) if motion.role == Role::NonPlanar => self.end_run(sink),
            Event::Move(motion) if is_line(motion) => self.line(line, motion, sink),
            Event::Move(_) => self.end_run(sink),
            _ => {}
        }
        if self.run.as_ref().is_some_and(|run| run.is_open) {
            self.held.push((line, event));
            if self.held.len() >= MOST_HELD {
                self.judge(sink);
            }
        } else {
            sink(line, event);
        }
    }

    /// Ends the file.
    pub(super) fn finish(&mut self, sink: Sink<'_>) {
        self.end_run(sink);
    }

    fn line(&mut self, number: u64, motion: &Motion, sink: Sink<'_>) {
        let ends = [motion.from[2], motion.to[2]];
        let own = Range { low: ends[0].min(ends[1]), high: ends[0].max(ends[1]) };
        let is_deep = self.layer.is_some() && own.low < self.levels[1] - SAME_HEIGHT;
        self.has_skin |= is_deep && !self.is_on_the_bed(own.low);
        let leaves = self.leaves(own);
        let run = self.run.get_or_insert_with(|| Run {
            range: own,
            heights: Heights::default(),
            level: None,
            turns: false,
            spiral: Spiral::default(),
            is_spiral: false,
            second: None,
            is_open: false,
        });
        run.range = run.range.and(own);
        run.is_open |= leaves && self.held.is_empty() && !run.is_spiral;
        let begins = run.spiral.line([motion.from, motion.to]);
        if run.is_spiral {
            self.layer = Some(run.range);
            if begins {
                sink(number, Event::Layer { marked: false, z: None });
            }
            return;
        }
        if begins && run.is_open && run.second.is_none() {
            run.second = Some(self.held.len());
        }
        let way = Vector3::from(motion.to) - Vector3::from(motion.from);
        run.heights.add(ends, way.norm());
        if self.has_skin {
            run.turn(motion);
        }
        if run.is_open && run.second.is_some() && run.spiral.is_one() {
            self.begin_spiral(sink);
        }
    }

    /// The run is a spiral: hands on what was held back of it, as its first rounds.
    fn begin_spiral(&mut self, sink: Sink<'_>) {
        let Some(run) = &mut self.run else { return };
        (run.is_open, run.is_spiral) = (false, true);
        self.lowest = self.layer.map_or(run.range.low, |_| self.lowest.min(run.range.low));
        (self.layer, self.has_skin) = (Some(run.range), false);
        self.levels = [run.range.low; 2];
        for (k, (line, event)) in self.held.drain(..).enumerate() {
            if k == 0 || run.second == Some(k) {
                sink(line, Event::Layer { marked: false, z: None });
            }
            sink(line, event);
        }
    }

    /// Whether a line at these heights may belong to a new layer.
    fn leaves(&self, line: Range) -> bool {
        let Some(layer) = self.layer else { return true };
        if self.has_skin && line.high > self.levels[0] + SAME_HEIGHT {
            return true;
        }
        line.high > layer.high + SAME_HEIGHT || self.is_on_the_bed(line.low)
    }

    /// Whether a line at this height begins another part.
    fn is_on_the_bed(&self, z: f64) -> bool {
        let is_below = |layer: Range| z < layer.low - SAME_HEIGHT;
        self.layer.is_some_and(is_below) && z <= self.lowest + SAME_HEIGHT
    }

    fn end_run(&mut self, sink: Sink<'_>) {
        self.judge(sink);
        self.run = None;
    }

    /// Decides whether the run begins a layer, and hands on what was held back of it.
    fn judge(&mut self, sink: Sink<'_>) {
        let Some(run) = &mut self.run else { return };
        let (range, level) = (run.range, run.heights.level().filter(|_| run.is_open));
        let turns = run.turns;
        run.is_open = false;
        let begins = level.filter(|&(z, share)| match self.layer {
            Some(layer) => {
                let top = if self.has_skin { self.levels[0] } else { layer.high };
                let is_new = z > top + SAME_HEIGHT || self.is_on_the_bed(z);
                is_new && share > LEAST_LEVEL && (turns || !self.has_skin)
            }
            None => true,
        });
        if let Some((z, share)) = begins {
            self.lowest = if self.layer.is_some() { self.lowest.min(z) } else { z };
            // A spiral that begins at once is no range within which other runs lie.
            let is_level = share > LEAST_LEVEL;
            self.layer = Some(if is_level { range } else { Range { low: z, high: z } });
            self.levels = [z, self.levels[0].min(z)];
            self.has_skin = false;
            if let Some(&(line, _)) = self.held.first() {
                let z = is_level.then_some(z);
                sink(line, Event::Layer { marked: false, z });
            }
        } else if let Some(layer) = &mut self.layer {
            *layer = layer.and(range);
        }
        self.held.drain(..).for_each(|(line, event)| sink(line, event));
    }
}

impl Run {
    /// Notes whether a line and the one before it are level, at one height, and turn.
    fn turn(&mut self, motion: &Motion) {
        let [from, to] = [motion.from, motion.to];
        let before = self.level.take();
        if from[2] != to[2] {
            return;
        }
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        if let Some([z, u, v]) = before
            && (z - to[2]).abs() < SAME_HEIGHT
        {
            let (aside, along) = (x * v - y * u, x * u + y * v);
            let square = (x * x + y * y) * (u * u + v * v);
            self.turns |= along < 0.0 || aside * aside > TURN * square;
        }
        self.level = Some([to[2], x, y]);
    }
}

impl Range {
    fn and(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

fn is_line(motion: &Motion) -> bool {
    let [from, to] = [motion.from, motion.to];
    motion.filament > 0.0 && (from[0] != to[0] || from[1] != to[1])
}
