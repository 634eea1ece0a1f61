//! G-code of any slicer -> a stream of steps.
//!
//! Words used here: a *line* is a straight move between two places, in fractions of steps; the *plan* is
//! when each part of it is reached.
//!
//! 1. The reader's moves are summed up as whole picometres: what is summed is never rounded.
//! 2. Each end is turned into places, and the feed is lowered to what the motors can follow.
//! 3. A [`Clock`] plans the moves as the printer's firmware would, or each keeps its speed
//!    ([`Steps::ramps`](crate::profile::Steps::ramps)). Lines wait until their plan is final.
//! 4. Their steps get times in whole µs ([`Pace`]) and are written.
//!
//! All of it is done move by move, on one thread: memory does not grow with the file, and the bytes are
//! the same on every run. What a motor cannot do is left out, and counted: heaters, fans, pauses.
//!
//! An axis that is homed goes to where its end stop is, by steps like any other move: the file says that
//! it is there afterwards, and the count of steps stays right. Where only the printer knows its end stops
//! (G161, G162, M132) the axis goes to the first place that the file names.

use super::axis::{AXES, LETTERS, PM, nearest, picometres};
use super::encode::Encoder;
use super::error::{Cause, Error, MOST_SECONDS};
use super::format::{Form, Header, Totals};
use super::line::Line;
use super::machine::Machine;
use super::pace::Pace;
use super::ramp::Ramp;
use crate::estimate::apply;
use crate::motion::{Clock, Limits, Move};
use crate::profile::{ProfileError, Settings};
use crate::reader::{self, Event, Motion, Reading, Wait};
use crate::units::MmPerS;
use std::collections::VecDeque;
use std::io::{self, BufRead, Write};
use std::ops::ControlFlow;

/// No feed is slower, mm/s, whatever a file says: a move of any length ends.
const SLOWEST: f64 = 1e-3;

/// How a stream is made, besides the settings.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// By whose rules the G-code is read.
    pub reading: Reading,
    /// What the stream holds.
    pub form: Form,
    /// Where the nozzle stands at the beginning, mm; `None` is where the settings say.
    pub start: Option<[f64; 3]>,
}

/// What was made.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Made {
    /// Where the axes stand at the beginning, mm.
    pub start: [f64; AXES],
    /// Where they stand at the end, mm.
    pub end: [f64; AXES],
    /// What the steps add up to.
    pub totals: Totals,
    /// Blocks, the last one among them.
    pub blocks: u32,
    /// Moves that were read.
    pub moves: u64,
    /// Of the time what the plan does not have: axes that would turn round or step too soon, s.
    pub waits: f64,
    /// Moves that are slower than the file asks for, since an axis cannot step so fast.
    pub slowed: u64,
    /// Line of the first of them, from 1.
    pub first_slowed: u64,
    /// For each axis, where it goes beyond its ends first (line of the file), and how far at most, mm.
    pub beyond: [Option<(u64, f64)>; AXES],
    /// Waits for heat, which a stream does not have.
    pub heating: u64,
    /// Homings, which are moves here.
    pub homing: u64,
    /// Pauses and changes of filament, which a stream does not have.
    pub pauses: u64,
}

/// Why no stream is made.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Settings that make no steps.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// The G-code cannot be read, or has no move.
    #[error(transparent)]
    Reader(#[from] reader::Error),
    /// No steps can be made of it.
    #[error(transparent)]
    Steps(#[from] Error),
    /// The stream cannot be written.
    #[error(transparent)]
    Write(io::Error),
}

/// Makes a stream of the G-code in `source`, called `file` in messages, for the machine of `settings`.
///
/// # Errors
/// See [`Failure`]. What was written until then is no stream.
pub fn make(
    source: &mut dyn BufRead,
    file: &str,
    settings: &Settings,
    options: Options,
    out: &mut dyn Write,
) -> Result<Made, Failure> {
    let machine = Machine::new(settings, options.start)?;
    let steps = &settings.steps;
    let start = options.start.unwrap_or([steps.home_x, steps.home_y, steps.home_z]);
    let header = Header { form: options.form, machine };
    let mut maker = Maker::new(header, settings, start, out).map_err(Failure::Write)?;
    let read = reader::read_from(source, options.reading, start, &mut |line, event| {
        if maker.failed.is_none() {
            maker.event(line, event);
        }
    });
    read.map_err(|error| reader::Cause::Unreadable(error).of(file))?;
    if let Some(clock) = &mut maker.clock {
        clock.finish();
    }
    maker.settle();
    match maker.failed {
        Some(Failed::Write(error)) => return Err(Failure::Write(error)),
        Some(Failed::Refused(cause)) => return Err(cause.of(file).into()),
        None if maker.made.moves == 0 => return Err(reader::Cause::NoMove.of(file).into()),
        None => {}
    }
    maker.finish().map_err(Failure::Write)
}

/// What waits for its plan.
enum Waiting {
    /// With its way, mm, and its feed, mm/s.
    Line(Line, f64, f64),
    /// A dwell.
    Rest,
}

/// Why some commands are refused.
const OWN_RETRACTION: &str = "pulls filament back by a length that only a printer's firmware knows; make the file with E moves";
const CURVE: &str = "is a curve; make the file with straight moves or arcs";
const OTHER_TOOL: &str = "is a tool that the machine does not have; make the file for one extruder";

enum Failed {
    Write(io::Error),
    Refused(Cause),
}

/// Makes steps of events.
struct Maker<'a> {
    machine: Machine,
    /// `None` without ramps.
    clock: Option<Clock<()>>,
    waiting: VecDeque<Waiting>,
    pace: Pace,
    encoder: Encoder<&'a mut dyn Write>,
    /// Feed of moves that the file does not have, mm/s.
    travel: f64,
    /// The machine's own tool.
    tool: u32,
    /// Where the path so far ends: picometres, and places.
    at: [i64; AXES],
    place: [i64; AXES],
    /// What the filament's picometres leave of what was pushed.
    rest: f64,
    /// Where the machine's own zero lies in the file's numbers after G92, pm.
    shift: [i64; 3],
    /// Axes that are at an end stop that only the printer knows.
    lost: [bool; 3],
    made: Made,
    failed: Option<Failed>,
}

impl<'a> Maker<'a> {
    fn new(
        header: Header,
        settings: &Settings,
        start: [f64; 3],
        out: &'a mut dyn Write,
    ) -> io::Result<Self> {
        let encoder = Encoder::new(out, &header)?;
        let machine = header.machine;
        let [x, y, z] = start.map(|mm| picometres(mm).unwrap_or(0));
        let at = [x, y, z, 0];
        let clock = settings.steps.ramps.then(|| Clock::new(Limits::new(settings)));
        Ok(Self {
            clock,
            waiting: VecDeque::new(),
            pace: Pace::new(&machine),
            encoder,
            travel: settings.speed.travel,
            tool: settings.machine.tool,
            place: std::array::from_fn(|axis| machine.scale[axis].place(at[axis]).unwrap_or(0)),
            at,
            rest: 0.0,
            shift: [0; 3],
            lost: [false; 3],
            made: Made { start: machine.mm(machine.start), ..Made::default() },
            failed: None,
            machine,
        })
    }

    fn event(&mut self, line: u64, event: Event) {
        match event {
            Event::Move(motion) => self.motion(line, &motion),
            Event::Dwell(seconds) => self.dwell(seconds),
            Event::Wait(wait) => {
                if let Some(clock) = &mut self.clock {
                    clock.stop();
                }
                match wait {
                    Wait::Heating => self.made.heating += 1,
                    Wait::Homing => self.made.homing += 1,
                    Wait::User => self.made.pauses += 1,
                    Wait::Moves => {}
                }
            }
            Event::Change(change) => {
                if let Some(clock) = &mut self.clock {
                    let mut limits = clock.limits().clone();
                    apply(&change, &mut limits);
                    clock.set_limits(limits);
                }
            }
            Event::FirmwareRetraction { .. } => self.refuse(line, "G10 or G11", OWN_RETRACTION),
            Event::Command { letter: b'G', number: 5, .. } => self.refuse(line, "G5", CURVE),
            Event::Command { letter: b'T', number, .. } if number > 0 && number != self.tool => {
                self.refuse(line, &format!("T{number}"), OTHER_TOOL);
            }
            Event::Command { letter, number, code } => self.command(line, letter, number, &code),
            _ => {}
        }
        self.settle();
    }

    fn dwell(&mut self, seconds: f64) {
        match &mut self.clock {
            Some(clock) => {
                clock.dwell(seconds, ());
                self.waiting.push_back(Waiting::Rest);
            }
            None => self.pass(seconds),
        }
    }

    /// Nothing moves for so long, s.
    fn pass(&mut self, seconds: f64) {
        self.pace.pass(seconds * 1e6);
        self.look_at_time();
    }

    /// What takes too long is refused before the steps after it are written.
    fn look_at_time(&mut self) {
        if self.pace.end() as f64 > MOST_SECONDS * 1e6 && self.failed.is_none() {
            self.failed = Some(Failed::Refused(Cause::TooLong));
        }
    }

    /// Homing: the axes named, or all, go to their end stops.
    fn command(&mut self, line: u64, letter: u8, number: u32, code: &[u8]) {
        let known = match (letter, number) {
            (b'G', 28) => true,
            (b'G', 161 | 162) | (b'M', 132) => false,
            _ => return,
        };
        let named = |axis: usize| code.iter().any(|c| c.to_ascii_uppercase() == b"XYZ"[axis]);
        let all = !(0..3).any(named);
        let mut to = self.at;
        for axis in (0..3).filter(|axis| all || named(*axis)) {
            self.shift[axis] = 0;
            self.lost[axis] = !known;
            to[axis] = if known { 0 } else { to[axis] };
        }
        self.go(line, to, self.travel);
    }

    fn motion(&mut self, line: u64, motion: &Motion) {
        self.made.moves += 1;
        let [from, to] = [motion.from, motion.to].map(|at| at.map(picometres));
        let (mut begin, mut end) = (self.at, self.at);
        for axis in 0..3 {
            let (Some(from), Some(to)) = (from[axis], to[axis]) else {
                return self.too_far(line, axis);
            };
            if self.lost[axis] {
                self.lost[axis] = false;
                begin[axis] = from;
            } else if from.saturating_add(self.shift[axis]) != self.at[axis] {
                // Its number has become another, and it has not moved.
                self.shift[axis] = self.at[axis].saturating_sub(from);
            }
            end[axis] = to.saturating_add(self.shift[axis]);
        }
        if begin != self.at {
            self.go(line, begin, self.travel);
        }
        let pushed = motion.filament * PM as f64 + self.rest;
        let Some(whole) = picometres(pushed / PM as f64) else { return self.too_far(line, 3) };
        self.rest = pushed - whole as f64;
        end[3] = self.at[3].saturating_add(whole);
        self.go(line, end, motion.feed.0);
    }

    /// A straight move to these picometres.
    fn go(&mut self, line: u64, to: [i64; AXES], feed: f64) {
        let delta: [f64; AXES] = std::array::from_fn(|axis| {
            (to[axis] as i128 - self.at[axis] as i128) as f64 / PM as f64
        });
        let [x, y, z, e] = delta;
        let nozzle = (x * x + y * y + z * z).sqrt();
        let way = if nozzle > 0.0 { nozzle } else { e.abs() };
        if way == 0.0 {
            return;
        }
        let mut place = self.place;
        for axis in 0..AXES {
            if to[axis] == self.at[axis] {
                continue;
            }
            let Some(there) = self.machine.scale[axis].place(to[axis]) else {
                return self.too_far(line, axis);
            };
            place[axis] = there;
            self.look(line, axis, there);
        }
        let steps = Line { from: self.place, to: place };
        let most = self.machine.most_speed(steps.lengths(), way);
        if most < feed * (1.0 - 1e-9) {
            self.made.slowed += 1;
            self.made.first_slowed =
                if self.made.slowed == 1 { line } else { self.made.first_slowed };
        }
        (self.at, self.place) = (to, place);
        let feed = feed.max(SLOWEST).min(most);
        match &mut self.clock {
            Some(clock) => {
                clock.push(Move { delta, feed: MmPerS(feed), tag: () });
                self.waiting.push_back(Waiting::Line(steps, way, feed));
            }
            None => self.emit(&steps, way, feed, &Ramp::even(way, feed)),
        }
    }

    /// Refuses a command that would move something else than steps do.
    fn refuse(&mut self, line: u64, code: &str, why: &'static str) {
        self.failed = Some(Failed::Refused(Cause::NotMade { line, code: code.to_owned(), why }));
    }

    fn too_far(&mut self, line: u64, axis: usize) {
        self.failed = Some(Failed::Refused(Cause::TooFar { line, axis: LETTERS[axis] }));
    }

    /// Notes what lies beyond the ends of an axis.
    fn look(&mut self, line: u64, axis: usize, place: i64) {
        if let Some(mm) = self.machine.beyond(axis, nearest(place)) {
            let (_, most) = self.made.beyond[axis].get_or_insert((line, mm));
            *most = most.max(mm);
        }
    }

    /// Writes the lines whose plan is final.
    fn settle(&mut self) {
        let Some(clock) = &mut self.clock else { return };
        let planned: Vec<_> = clock.drain().collect();
        for timed in planned {
            if self.failed.is_some() {
                return;
            }
            match self.waiting.pop_front() {
                Some(Waiting::Line(line, way, feed)) => {
                    self.emit(&line, way, feed, &Ramp::new(way, &timed));
                }
                Some(Waiting::Rest) | None => self.pass(timed.seconds),
            }
        }
    }

    /// Writes the steps of a line.
    fn emit(&mut self, line: &Line, way: f64, feed: f64, ramp: &Ramp) {
        let (encoder, pace) = (&mut self.encoder, &mut self.pace);
        let backwards = line.backwards();
        let mut failed = None;
        line.steps(|share, mask| {
            let at = pace.step(ramp.at(share * way), mask, backwards);
            match encoder.step(at, mask, backwards) {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    failed = Some(error);
                    ControlFlow::Break(())
                }
            }
        });
        pace.pass(ramp.time());
        // One without a step has an end as well: the path back has it.
        if failed.is_none() {
            failed = encoder.mark(line.to, feed).err();
        }
        self.look_at_time();
        if let Some(error) = failed {
            self.failed = Some(Failed::Write(error));
        }
    }

    fn finish(self) -> io::Result<Made> {
        let (totals, blocks, _) = self.encoder.finish(self.pace.end())?;
        let waits = self.pace.waits() as f64 / 1e6;
        let end = self.machine.mm(totals.end);
        Ok(Made { end, totals, blocks, waits, ..self.made })
    }
}
