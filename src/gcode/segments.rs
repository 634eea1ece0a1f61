//! Moves of a layer -> Moves that the printer can be fed: joins lines that are too short, then slows down
//! what is left.
//!
//! A printer reads, plans and drives so many moves a second. If lines are so short that more are asked
//! for, the planner runs dry, and the nozzle stutters. Words: *lines* are moves with a bead that move the
//! nozzle; a *stretch* is lines with no other move between them; the *window* is as many lines as the
//! planner knows at a time.
//!
//! The law, for every window of every stretch: its lines take as long at full speed as the printer
//! needs to be fed with as many. The planner may fill while long lines are driven, so that short
//! ones are fine among them.
//!
//! 1. Lines of windows that break the law are joined with the next, where they are as good as straight:
//!    no point that goes lies further than [`TOLERANCE`] from the line that stays. A line is joined
//!    until it takes its share of the window's time, no further.
//! 2. Where windows break it still, their lines get a cap on their feed, as high as the law allows. The
//!    pieces of an arc keep one feed, since it is written once.
//!
//! Nothing is joined across the ends of a path, an arc, or a change of what is laid. Filament is kept.

use super::moves::{Kind, Move, Moves};
use crate::profile::Settings;
use crate::units::to_mm;
use std::ops::Range;

/// How far a point that goes may lie from the line, mm: what the reader and others allow.
const TOLERANCE: f64 = 0.0125;

/// By how much joined lines may be shorter than before: their bead is wider by as much.
const SHORTER: f64 = 0.01;

/// Windows that are too quick by a smaller part are not: floats are rounded.
const SLACK: f64 = 1e-9;

/// Joins and slows down short lines.
#[derive(Debug, Clone)]
pub(super) struct Segments {
    /// What a line has to take, on average over a window, s.
    share: f64,
    /// Lines of a window.
    window: usize,
    /// Cross-section of the filament, mm².
    area: f64,
}

impl Segments {
    /// None where the printer can be fed any number of moves.
    pub(super) fn new(settings: &Settings) -> Option<Self> {
        let rate = settings.limits.max_segment_rate;
        // A planner that knows the whole file still has to be fed: by what it takes in a second.
        let window = match settings.limits.look_ahead {
            0 => rate.ceil() as usize,
            known => known as usize,
        };
        let area = settings.filament_area();
        (rate > 0.0).then(|| Self { share: 1.0 / rate, window: window.max(2), area })
    }

    /// Joins and slows down what is too short on a layer.
    pub(super) fn limit(&self, layer: &mut Moves) {
        let dense = self.dense(&layer.moves);
        if dense.is_empty() {
            return;
        }
        self.join(layer, &dense);
        self.slow(layer);
        if layer.short.slowed > 0 {
            layer.slowed(self.area);
        }
    }

    /// Windows of one stretch that are too quick, as parts of its lines; `seconds` is what each line takes.
    fn quick<'a>(&'a self, seconds: &'a [f64]) -> impl Iterator<Item = Range<usize>> + 'a {
        let least = self.share * self.window as f64 * (1.0 - SLACK);
        let windows = seconds.windows(self.window).enumerate();
        windows
            .filter(move |(_, window)| window.iter().sum::<f64>() < least)
            .map(|(first, window)| first..first + window.len())
    }

    /// The moves from the first to the last of windows that are too quick, joined where they overlap.
    fn dense(&self, moves: &[Move]) -> Vec<Range<usize>> {
        let mut dense: Vec<Range<usize>> = Vec::new();
        for lines in stretches(moves) {
            let seconds: Vec<f64> = lines.iter().map(|&k| full_speed(moves, k)).collect();
            for window in self.quick(&seconds) {
                let (first, end) = (lines[window.start], lines[window.end - 1] + 1);
                match dense.last_mut().filter(|last| last.end > first) {
                    Some(last) => last.end = end,
                    None => dense.push(first..end),
                }
            }
        }
        dense
    }

    /// Joins lines of these moves with the next.
    fn join(&self, layer: &mut Moves, dense: &[Range<usize>]) {
        let old = std::mem::take(&mut layer.moves);
        // Where each move goes, for what points to moves.
        let mut places = vec![0; old.len() + 1];
        let mut fixed = vec![false; old.len() + 1];
        layer.paths.iter().for_each(|&first| fixed[first] = true);
        for arc in &layer.arcs {
            fixed[arc.pieces.start..=arc.pieces.end].fill(true);
        }
        let mut dense = dense.iter().peekable();
        let mut k = 0;
        while k < old.len() {
            while dense.next_if(|range| range.end <= k).is_some() {}
            let end = dense.peek().filter(|range| range.contains(&k)).map_or(k, |range| range.end);
            let count = self.joinable(&old, k, end, &fixed);
            places[k..k + count].fill(layer.moves.len());
            layer.moves.push(joined(&old[k..k + count], k.checked_sub(1).map(|k| &old[k])));
            layer.short.joined += count - 1;
            k += count;
        }
        places[old.len()] = layer.moves.len();
        layer.paths.iter_mut().for_each(|first| *first = places[*first]);
        for arc in &mut layer.arcs {
            arc.pieces = places[arc.pieces.start]..places[arc.pieces.end];
        }
    }

    /// How many of the moves from `first` on are joined; `fixed` ones begin anew.
    fn joinable(&self, moves: &[Move], first: usize, end: usize, fixed: &[bool]) -> usize {
        let step = &moves[first];
        let (Kind::Extrude(bead), Some(before)) = (step.kind, first.checked_sub(1)) else {
            return 1;
        };
        let start = place(&moves[before]);
        let flat = |other: &Move| other.z == moves[before].z && other.feed == step.feed;
        let like = |other: &Move| matches!(other.kind, Kind::Extrude(it) if it.is_like(&bead));
        let mut count = 1;
        while first + count < end && !fixed[first + count] && flat(step) {
            let next = &moves[first + count];
            let long = distance(start, place(&moves[first + count - 1]));
            let enough = seconds(long, step.feed) >= self.share;
            let points = &moves[first..=first + count];
            if enough || !(like(next) && flat(next)) || !are_straight(start, points) {
                break;
            }
            count += 1;
        }
        count
    }

    /// Lowers feeds until no window is too quick.
    fn slow(&self, layer: &mut Moves) {
        let asked: Vec<u32> = layer.moves.iter().map(|step| step.feed).collect();
        for lines in stretches(&layer.moves) {
            let lengths: Vec<f64> = lines.iter().map(|&k| length(&layer.moves, k)).collect();
            let mut feeds: Vec<u32> = lines.iter().map(|&k| layer.moves[k].feed).collect();
            let mut first = 0;
            while first + self.window <= lines.len() {
                let window = first..first + self.window;
                self.cap(&lengths[window.clone()], &mut feeds[window]);
                first += 1;
            }
            lines.iter().zip(feeds).for_each(|(&k, feed)| layer.moves[k].feed = feed);
        }
        for arc in &layer.arcs {
            let pieces = &mut layer.moves[arc.pieces.clone()];
            let slowest = pieces.iter().map(|piece| piece.feed).min().unwrap_or_default();
            pieces.iter_mut().for_each(|piece| piece.feed = slowest);
        }
        for (k, &asked) in asked.iter().enumerate() {
            if layer.moves[k].feed < asked {
                let long = length(&layer.moves, k);
                layer.short.slowed += 1;
                layer.short.lost += seconds(long, layer.moves[k].feed) - seconds(long, asked);
            }
        }
    }

    /// Caps the feeds of a window, if it is too quick.
    fn cap(&self, lengths: &[f64], feeds: &mut [u32]) {
        let least = self.share * self.window as f64 * (1.0 - SLACK);
        let takes = |cap: u32| -> f64 {
            let lines = lengths.iter().zip(feeds.iter());
            lines.map(|(&long, &feed)| seconds(long, feed.min(cap))).sum()
        };
        let (mut low, mut high) = (1, feeds.iter().copied().max().unwrap_or(1));
        if takes(high) >= least {
            return;
        }
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if takes(middle) >= least {
                low = middle;
            } else {
                high = middle;
            }
        }
        feeds.iter_mut().for_each(|feed| *feed = low.min(*feed));
    }
}

/// The lines of each stretch, by their numbers.
fn stretches(moves: &[Move]) -> Vec<Vec<usize>> {
    let mut all = Vec::new();
    let mut lines = Vec::new();
    for k in 1..moves.len() {
        if !matches!(moves[k].kind, Kind::Extrude(_)) {
            all.extend(Some(std::mem::take(&mut lines)).filter(|lines| !lines.is_empty()));
        } else if place(&moves[k]) != place(&moves[k - 1]) {
            lines.push(k);
        }
    }
    all.push(lines);
    all
}

/// Whether the line from `start` to the last of these moves' ends may stand for all of them: it passes by
/// the others in their order, and is hardly shorter.
fn are_straight(start: [f64; 3], moves: &[Move]) -> bool {
    let Some(end) = moves.last().map(place) else { return false };
    let chord = [end[0] - start[0], end[1] - start[1]];
    let long = distance(start, end);
    let (mut before, mut so_far, mut way) = (start, 0.0, 0.0);
    for step in moves {
        let at = place(step);
        let arm = [at[0] - start[0], at[1] - start[1]];
        let along = arm[0] * chord[0] + arm[1] * chord[1];
        let aside = (arm[0] * chord[1] - arm[1] * chord[0]).abs();
        if aside > TOLERANCE * long || along < so_far {
            return false;
        }
        way += distance(before, at);
        (before, so_far) = (at, along);
    }
    long > 0.0 && long >= (1.0 - SHORTER) * way
}

/// One move for those that are joined. `before` is the one before them.
fn joined(moves: &[Move], before: Option<&Move>) -> Move {
    let first = moves[0];
    let Some((last, before)) = moves.last().zip(before).filter(|_| moves.len() > 1) else {
        return first;
    };
    Move {
        to: last.to,
        length: distance(place(before), place(last)),
        filament: moves.iter().map(|step| step.filament).sum(),
        ..first
    }
}

/// What line `k` takes at full speed, s.
fn full_speed(moves: &[Move], k: usize) -> f64 {
    seconds(length(moves, k), moves[k].feed)
}

fn seconds(length: f64, feed: u32) -> f64 {
    60.0 * length / f64::from(feed)
}

/// The length of move `k` as it is written, mm.
fn length(moves: &[Move], k: usize) -> f64 {
    k.checked_sub(1).map_or(0.0, |before| distance(place(&moves[before]), place(&moves[k])))
}

/// Where a move ends, mm.
fn place(step: &Move) -> [f64; 3] {
    let [x, y] = step.to.map(|at| f64::from(at.0) / 1000.0);
    [x, y, to_mm(step.z)]
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [x, y, z] = std::array::from_fn(|axis| b[axis] - a[axis]);
    (x * x + y * y + z * z).sqrt()
}
