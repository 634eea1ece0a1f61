//! Moves of all layers, in order -> Times: times each role and layer, and schedules each path.
//!
//! - The [`Clock`] simulates the printer's planner. It holds moves back until later moves can no
//!   longer change their speed, so that times arrive after a delay.
//! - A *mark* says that a layer or a path begins with the move of a given number.
//! - The *ledger* matches the clock's times with the marks.
//!
//! 1. Each move goes to the clock, tagged with what its time counts for; before it the limits of its
//!    drive, where that changes.
//! 2. A segment too short to be written is skipped. Its filament goes with the next one, as in the
//!    text.
//! 3. For each time that the clock returns, the ledger first passes all marks before that move and
//!    then adds the time.
//! 4. A layer is ready once the next one begins or the file ends.

use super::drive::Drives;
use super::moves::{Kind, Move, Moves};
use crate::fill::{Both, Role, RoleTable};
use crate::motion::{self, Clock, Limits, Timed};
use crate::units::{Coord, MmPerMin, Thousandths, to_mm};
use std::collections::VecDeque;

/// How long a print takes, without its start and end blocks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Times {
    /// Beads by role, s.
    pub roles: RoleTable<Both<f64>>,
    /// Travels and moves in z, s.
    pub travel: f64,
    /// Retractions and restored filament, s.
    pub retraction: f64,
    /// Standing still, s.
    pub waiting: f64,
    /// The layers, in order.
    pub layers: Vec<LayerTime>,
}

impl Times {
    /// Total time, s.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.layers.iter().map(|layer| layer.seconds).sum()
    }
}

/// The time of one layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerTime {
    /// Its top above the bed, grid units.
    pub z: Coord,
    /// Its time, s.
    pub seconds: f64,
}

/// When a layer and its paths are printed, in seconds from the beginning of the first layer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Schedule {
    /// When it begins.
    pub start: f64,
    /// When the approach of each of its paths begins, and when the moves [within](Moves::within) it.
    pub paths: Vec<f64>,
    /// When it ends.
    pub end: f64,
}

/// What the time of a move counts for.
#[derive(Debug, Clone, Copy)]
enum Part {
    Bead(Role, bool),
    Travel,
    Retraction,
    Waiting,
}

/// A layer or a path that begins with the move of this number.
#[derive(Debug, Clone, Copy)]
struct Mark {
    at: usize,
    what: Begins,
}

#[derive(Debug, Clone, Copy)]
enum Begins {
    /// The layer with its top here.
    Layer(Coord),
    Path,
}

/// Runs the clock over the moves of a file.
pub struct Timer {
    clock: Clock<Part>,
    drives: Option<Drives>,
    /// The number of the drive in force.
    driven: Option<usize>,
    ledger: Ledger,
    nozzle: Nozzle,
    /// Number of moves given to the clock.
    given: usize,
}

impl Timer {
    /// A timer for a machine at rest at an unknown position.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        let clock = Clock::new(limits);
        let (ledger, nozzle) = (Ledger::default(), Nozzle::default());
        Self { clock, drives: None, driven: None, ledger, nozzle, given: 0 }
    }

    /// With acceleration and jerk that go by what is printed.
    #[must_use]
    pub fn driven(self, drives: Option<Drives>) -> Self {
        Self { drives, ..self }
    }

    /// Times the next layer.
    pub fn layer(&mut self, layer: &Moves) {
        self.mark(Begins::Layer(layer.z));
        let with = |(path, &first)| std::iter::once(first).chain(layer.within(path));
        let mut paths = layer.paths.iter().enumerate().flat_map(with).peekable();
        for (index, step) in layer.moves.iter().enumerate() {
            while paths.next_if(|&first| first == index).is_some() {
                self.mark(Begins::Path);
            }
            self.drive(layer.layer, &step.kind);
            self.step(step);
        }
        paths.for_each(|_| self.mark(Begins::Path));
        self.ledger.read(self.clock.drain());
    }

    /// The schedule of the next layer whose times are all known, if any. Returns each once.
    pub fn next_ready(&mut self) -> Option<Schedule> {
        self.ledger.ready.pop_front()
    }

    /// Ends the file. All layers are ready after this.
    pub fn finish(&mut self) {
        self.clock.finish();
        self.ledger.read(self.clock.drain());
        self.ledger.pass(usize::MAX);
        self.ledger.close();
    }

    /// The times so far.
    #[must_use]
    pub fn times(&self) -> &Times {
        &self.ledger.times
    }

    fn mark(&mut self, what: Begins) {
        self.ledger.marks.push_back(Mark { at: self.given, what });
    }

    /// Changes the clock's limits to those of the drive that a move of this layer asks for.
    fn drive(&mut self, layer: usize, kind: &Kind) {
        if let Some(drives) = &self.drives {
            change(&mut self.clock, drives, drives.of(layer, kind), &mut self.driven);
        }
    }

    fn step(&mut self, step: &Move) {
        if let Kind::Wait(ms) = step.kind {
            self.given += 1;
            self.clock.dwell(f64::from(ms) / 1000.0, Part::Waiting);
        } else if let Some(next) = self.nozzle.go(step) {
            self.given += 1;
            self.clock.push(next);
        }
    }
}

/// Where the nozzle is.
#[derive(Debug, Clone, Default)]
struct Nozzle {
    /// Its position, thousandths of a mm, if known.
    at: Option<[Thousandths; 2]>,
    /// Its z, grid units, if known.
    z: Option<Coord>,
    /// Filament of segments too short to be written, mm. It goes with the next move.
    held: f64,
}

impl Nozzle {
    /// The move of the axes, if one moves.
    fn go(&mut self, step: &Move) -> Option<motion::Move<Part>> {
        // The first travel starts where the start block ends, which is unknown here: it counts
        // as part of that block.
        let at = self.at.unwrap_or(step.to);
        let [x, y] = [0, 1].map(|k| f64::from(step.to[k].0 - at[k].0) / 1000.0);
        let (delta, tag) = match step.kind {
            Kind::Travel => {
                self.at = Some(step.to);
                ([x, y, 0.0, 0.0], Part::Travel)
            }
            Kind::Z => ([0.0, 0.0, self.rise_to(step.z), 0.0], Part::Travel),
            Kind::Retract | Kind::Restore => ([0.0, 0.0, 0.0, step.filament], Part::Retraction),
            Kind::Wait(_) => return None,
            Kind::Extrude(bead) => {
                self.at = Some(step.to);
                self.held += step.filament;
                // As it is written: on short lines a thousandth more or less is a corner.
                let rise = match self.z.replace(step.z) {
                    Some(z) if z != step.z => to_mm(10 * (thousandths(step.z) - thousandths(z))),
                    _ => 0.0,
                };
                if step.to == at && rise == 0.0 {
                    return None;
                }
                let e = std::mem::take(&mut self.held);
                ([x, y, rise, e], Part::Bead(bead.role, bead.thick))
            }
        };
        let feed = MmPerMin(f64::from(step.feed)).into();
        (delta != [0.0; 4]).then_some(motion::Move { delta, feed, tag })
    }

    /// Moves to `z`. Returns by how much it rises, mm; 0 if its height was unknown.
    fn rise_to(&mut self, z: Coord) -> f64 {
        self.z.replace(z).map_or(0.0, |from| to_mm(z - from))
    }
}

/// `z` in thousandths of a mm.
fn thousandths(z: Coord) -> Coord {
    (z + 5).div_euclid(10)
}

/// Assigns the times that the clock reports to layers, paths and roles.
#[derive(Debug, Default)]
struct Ledger {
    /// Marks of moves that are still in the clock.
    marks: VecDeque<Mark>,
    /// Number of moves whose times are known.
    done: usize,
    /// Their total time, s.
    now: f64,
    times: Times,
    /// The layer that is being timed.
    current: Option<Schedule>,
    /// Layers whose times are known and that [`Timer::next_ready`] has not returned yet.
    ready: VecDeque<Schedule>,
}

impl Ledger {
    fn read(&mut self, moves: impl Iterator<Item = Timed<Part>>) {
        for timed in moves {
            self.pass(self.done);
            self.done += 1;
            self.now += timed.seconds;
            *match timed.tag {
                Part::Bead(role, thick) => self.times.roles[role].of_mut(thick),
                Part::Travel => &mut self.times.travel,
                Part::Retraction => &mut self.times.retraction,
                Part::Waiting => &mut self.times.waiting,
            } += timed.seconds;
        }
    }

    /// Passes all marks up to the move of this number: what they mark begins now.
    fn pass(&mut self, number: usize) {
        while let Some(&Mark { at, what }) = self.marks.front() {
            if at > number {
                return;
            }
            self.marks.pop_front();
            match what {
                Begins::Path => {
                    self.current.iter_mut().for_each(|layer| layer.paths.push(self.now));
                }
                Begins::Layer(z) => {
                    self.close();
                    self.times.layers.push(LayerTime { z, seconds: 0.0 });
                    self.current = Some(Schedule { start: self.now, ..Schedule::default() });
                }
            }
        }
    }

    /// Ends the layer that is being timed.
    fn close(&mut self) {
        let Some(mut layer) = self.current.take() else { return };
        layer.end = self.now;
        if let Some(last) = self.times.layers.last_mut() {
            last.seconds = layer.end - layer.start;
        }
        self.ready.push_back(layer);
    }
}

/// Changes the clock's limits to those of the drive of this number, if it is another one than `driven`.
fn change<T: Copy>(
    clock: &mut Clock<T>,
    drives: &Drives,
    number: Option<usize>,
    driven: &mut Option<usize>,
) {
    let next = number.filter(|_| number != *driven).and_then(|number| drives.get(number));
    if let Some(drive) = next {
        clock.switch(&drive.rates);
        *driven = number;
    }
}

/// How much longer than in the layer its last move is before it, and its first move after it, for
/// [`between_its_likes`]: long enough for any speed.
const RUN_UP: f64 = 1e6;

/// How long a layer takes between layers that end and begin as it does, s: the corners at its two
/// ends are about as sharp as in the print, whatever the layers beside it are.
#[must_use]
pub fn between_its_likes(layer: &Moves, limits: &Limits, drives: Option<&Drives>) -> f64 {
    let below = layer.from.map(|_| layer.z - layer.height);
    let mut nozzle = Nozzle { at: layer.from, z: below, held: 0.0 };
    let mut clock = Clock::new(limits.clone());
    let step = |delta, feed, tag| motion::Move { delta, feed, tag };
    let goes = |step: &Move| nozzle.go(step).map(|next| (next.delta, next.feed));
    let moves: Vec<_> = layer.moves.iter().map(goes).collect();
    let far = |(delta, feed): ([f64; 4], _)| step(delta.map(|mm| RUN_UP * mm), feed, false);
    let mut all = moves.iter().copied().flatten();
    let first = all.next();
    let last = all.next_back().or(first);
    let drive = |step: &Move| drives.and_then(|drives| drives.of(layer.layer, &step.kind));
    let mut driven = None;
    let mut turn = |clock: &mut Clock<bool>, number| {
        drives.into_iter().for_each(|drives| change(clock, drives, number, &mut driven));
    };
    turn(&mut clock, layer.moves.iter().rev().find_map(drive));
    last.map(far).into_iter().for_each(|before| clock.push(before));
    for (given, next) in layer.moves.iter().zip(moves) {
        turn(&mut clock, drive(given));
        if let Kind::Wait(ms) = given.kind {
            clock.dwell(f64::from(ms) / 1000.0, true);
        } else if let Some((delta, feed)) = next {
            clock.push(step(delta, feed, true));
        }
    }
    turn(&mut clock, layer.moves.iter().find_map(drive));
    first.map(far).into_iter().for_each(|after| clock.push(after));
    clock.finish();
    clock.drain().filter(|timed| timed.tag).map(|timed| timed.seconds).sum()
}

/// Formats a time as hosts read it, such as `1d 2h 3m 4s`.
#[must_use]
pub fn in_words(seconds: f64) -> String {
    let seconds = seconds.round().max(0.0) as u64;
    let (days, hours) = (seconds / 86_400, seconds / 3600 % 24);
    let (minutes, seconds) = (seconds / 60 % 60, seconds % 60);
    match (days, hours, minutes) {
        (0, 0, 0) => format!("{seconds}s"),
        (0, 0, _) => format!("{minutes}m {seconds}s"),
        (0, _, _) => format!("{hours}h {minutes}m {seconds}s"),
        _ => format!("{days}d {hours}h {minutes}m {seconds}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_the_form_that_hosts_read() {
        let expected =
            [(0.4, "0s"), (59.5, "1m 0s"), (3_723.0, "1h 2m 3s"), (93_784.0, "1d 2h 3m 4s")];
        for (seconds, words) in expected {
            assert_eq!(in_words(seconds), words);
        }
    }
}
