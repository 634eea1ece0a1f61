//! Words -> modes, units, counters and feeds as a firmware keeps them, and what happens between moves.
//!
//! The state of a printer after the lines so far, and the events that the next line makes of it. What
//! depends on the firmware stands in the table of [`firmware`](super::firmware):
//! - positions are absolute (G90) or relative (G91), the filament's too (M82, M83), in mm (G21) or inches
//!   (G20); G92 gives them other numbers without a move (see [`places`](super::places));
//! - F holds until the next F, times M220's factor; E is times M221's;
//! - Sailfish counts the filament of its two tools apart, as A and B; there E is the current tool's.
//!   Elsewhere all tools share one counter;
//! - E counts mm of filament, or mm³ of plastic after M200 and in an Ultimaker 2's files;
//! - G10 and G11 are moves of the filament where it is known how far they go;
//! - role, width and height hold from one comment to the next.
//!
//! The moves themselves are in [`drive`](super::drive).
//!
//! A command that changes none of these and waits for nothing is *harmless*; any other that is not
//! listed here is unknown, which is counted and reported, and no error.

use super::firmware::{Ab, Dwell, G10, Modes, Rules};
use super::heat;
use super::known::{is_harmless, klipper};
use super::marks::{Mark, mark};
use super::missing::missing;
use super::pieces::Pieces;
use super::places::Places;
use super::retraction::Retraction;
use super::words::{self, Code, Words};
use super::{Change, Event, Firmware, OwnFilament, Reading, Role, Summary, Wait};
use crate::units::MmPerS;
use std::f64::consts::PI;

/// Feed before the file names one: Marlin's.
const FIRST_FEED: MmPerS = MmPerS(25.0);

/// Diameter of the filament where E is a volume and nobody says by which, mm: the most usual one.
const SOME_DIAMETER: f64 = 1.75;

/// Millimetres in an inch.
const INCH: f64 = 25.4;

/// Words that make G10 set a tool up in RepRapFirmware.
const OF_TOOL: &[u8] = b"PRSXYZUVW";

#[derive(Debug, Clone)]
pub(super) struct State {
    firmware: Firmware,
    pub(super) rules: &'static Rules,
    pub(super) places: Places,
    /// Where the filament is, mm: of the first tool or of all, and of the second.
    pub(super) filament: [f64; 2],
    /// The current tool, 0 or 1.
    tool: usize,
    /// Whether A and B count apart.
    counts_apart: bool,
    /// Cross-section of the filament where E is a volume, mm²; else 0.
    pub(super) area: f64,
    diameter: f64,
    pub(super) feed: MmPerS,
    /// M220, as a factor, and what M220 B has kept of it.
    pub(super) feed_factor: f64,
    kept_factor: f64,
    /// M221 of each tool, as a factor.
    flow: [f64; 2],
    /// Millimetres in a unit of the file.
    pub(super) unit: f64,
    pub(super) relative: bool,
    relative_filament: bool,
    pub(super) retraction: Retraction,
    pub(super) pieces: Pieces,
    pub(super) role: Role,
    /// Whether lines are those of a patch of skin, whatever their role is called.
    pub(super) is_in_patch: bool,
    pub(super) width: Option<f64>,
    pub(super) height: Option<f64>,
    /// A word of this line that needs a number and has none.
    pub(super) numberless: Option<u8>,
    pub(super) summary: Summary,
}

impl State {
    pub(super) fn new(reading: Reading) -> Self {
        let rules = reading.firmware.rules();
        let told = reading.volumes.filter(|diameter| *diameter > 0.0);
        let diameter = told.unwrap_or(SOME_DIAMETER);
        Self {
            firmware: reading.firmware,
            rules,
            places: Places::default(),
            filament: [0.0; 2],
            tool: 0,
            counts_apart: rules.ab == Ab::Filaments,
            area: if reading.volumes.is_some() { circle(diameter) } else { 0.0 },
            diameter,
            feed: FIRST_FEED,
            feed_factor: 1.0,
            kept_factor: 1.0,
            flow: [1.0; 2],
            unit: 1.0,
            relative: false,
            relative_filament: false,
            retraction: Retraction::default(),
            pieces: Pieces::default(),
            role: Role::Other,
            is_in_patch: false,
            width: None,
            height: None,
            numberless: None,
            summary: Summary { firmware: reading.firmware, ..Summary::default() },
        }
    }

    /// Reads the next line of the file.
    pub(super) fn line(&mut self, line: &[u8], sink: &mut dyn FnMut(Event)) {
        self.summary.lines += 1;
        self.pieces.read(line.len() + 1);
        let (code, comment) = words::split(line);
        if !code.is_empty() {
            self.code(code, sink);
            if let Some(letter) = self.numberless.take() {
                self.summary.numberless += 1;
                sink(Event::NoNumber { letter, code: code.to_vec() });
            }
        }
        let Some(comment) = comment else { return };
        match mark(comment) {
            Some(Mark::Role(role)) => self.role = role,
            Some(Mark::Width(width)) => self.width = Some(width),
            Some(Mark::Height(height)) => self.height = Some(height),
            Some(Mark::Layer) => sink(Event::Layer { marked: true, z: None }),
            Some(Mark::Patch(number)) => {
                self.is_in_patch = number.is_some();
                sink(Event::Patch(number));
            }
            Some(Mark::Volumes) => self.ultimaker(),
            None => sink(Event::Comment(comment.to_vec())),
        }
    }

    fn code(&mut self, code: &[u8], sink: &mut dyn FnMut(Event)) {
        if code[0] == b'(' || code[0] == b'%' {
            return;
        }
        let command = words::command(code);
        if let Some((Code { letter, number, .. }, _)) = command
            && !(letter == b'G' && number <= 3)
        {
            sink(Event::Command { letter, number, code: code.to_vec() });
        }
        if let Some((command, words)) = command {
            self.numberless = missing(command, words, self.computes());
        }
        if let Some(heating) = heat::heating(code, self.firmware) {
            sink(Event::Heating(heating));
            // Sailfish's M6 changes the tool before it waits.
            if let Some((Code { letter: b'M', number: 6, .. }, words)) = command {
                self.change_tool(words);
            }
            if heating.waits {
                sink(Event::Wait(Wait::Heating));
            }
            return;
        }
        if let Some((command, words)) = command {
            let known = !command.has_part && self.command(command, words, sink);
            // Parts of a family, such as M862.1, are all of one kind.
            if known || (command.has_part && is_harmless(command)) {
                return;
            }
        } else if let Some(words) = klipper(code, b"SET_VELOCITY_LIMIT") {
            return sink(Event::Change(Change::of_klipper(words)));
        } else if let Some(words) = klipper(code, b"SET_RETRACTION") {
            return self.retraction.klipper(words);
        } else if klipper(code, b"SET_PRESSURE_ADVANCE").is_some() {
            return;
        }
        sink(Event::Unknown(code.to_vec()));
        self.summary.unknown += 1;
        if self.summary.first_unknown == 0 {
            self.summary.first_unknown = self.summary.lines;
        }
    }

    /// Whether what stands in braces is computed by the firmware.
    pub(super) fn computes(&self) -> bool {
        matches!(self.firmware, Firmware::RepRap)
    }

    /// Returns whether the command is known.
    fn command(&mut self, code: Code, words: Words<'_>, sink: &mut dyn FnMut(Event)) -> bool {
        match (code.letter, code.number) {
            (b'G', 0 | 1) => self.straight(words, sink),
            (b'G', 2 | 3) => self.arc(words, code.number == 2, sink),
            (b'G', 4) => sink(Event::Dwell(dwell(self.rules.dwell, words))),
            (b'G', 10) => self.g10(words, sink),
            (b'G', 11) if self.rules.g10 != G10::Offsets => self.retract(false, sink),
            (b'G', 20) => self.unit = INCH,
            (b'G', 21) => self.unit = 1.0,
            (b'G', 28) => self.home(words, Some(0.0), sink),
            (b'G', 161 | 162) => self.home(words, None, sink),
            (b'G', 90 | 91) => {
                self.relative = code.number == 91;
                if self.rules.modes == Modes::Last {
                    self.relative_filament = self.relative;
                }
            }
            (b'G', 92) => self.set_position(words),
            (b'G', 29 | 34 | 80) => sink(Event::Wait(Wait::Homing)),
            (b'G', number @ 54..=59) if self.rules.places => {
                self.places.choose(number as usize - 54);
            }
            (b'G', 17 | 54..=59 | 130) => {}
            (b'T', tool) => self.tool = (tool as usize).min(1),
            (b'M', 82) => self.relative_filament = false,
            (b'M', 83) => self.relative_filament = true,
            (b'M', 108 | 135) => self.change_tool(words),
            // Only the printer knows where its end stops are.
            (b'M', 132) => self.recall(words),
            (b'M', 191 | 303) => sink(Event::Wait(Wait::Heating)),
            // There M0 and M1 end the job.
            (b'M', 0 | 1) if matches!(self.firmware, Firmware::RepRap) => {
                sink(Event::Wait(Wait::Moves));
            }
            (b'M', 0 | 1 | 25 | 226 | 600 | 601) => sink(Event::Wait(Wait::User)),
            (b'M', 400) => sink(Event::Wait(Wait::Moves)),
            (b'M', 201 | 203 | 204 | 205 | 566) => {
                if let Some(change) = Change::of_code(code.number, words) {
                    sink(Event::Change(change));
                }
            }
            (b'M', 200) if self.rules.m200 => self.set_volumes(words),
            (b'M', 207) => {
                let change = self.retraction.m207(self.rules.m207, words, self.unit);
                change.map(Event::Change).into_iter().for_each(sink);
            }
            (b'M', 208) => self.retraction.m208(self.rules.m207, words, self.unit),
            (b'M', 220) => self.set_factor(words),
            (b'M', 221) => self.set_flow(words),
            _ => return is_harmless(code),
        }
        true
    }

    /// `;FLAVOR:UltiGCode`: an Ultimaker 2 takes E for volumes from here on. Other firmwares do not read
    /// comments.
    fn ultimaker(&mut self) {
        let own = match self.firmware {
            Firmware::Ultimaker(own) => own,
            Firmware::Other => OwnFilament::UNTOLD,
            _ => return,
        };
        self.area = circle(own.diameter);
        self.summary.volumes_by = self.area;
        self.retraction.own(own);
    }

    /// M200: E is a volume (D, S1) or not (D0, S0).
    fn set_volumes(&mut self, words: Words<'_>) {
        let (mut on, mut says) = (self.area > 0.0, None);
        for (letter, value) in words {
            match (letter, value) {
                (b'D', Some(diameter)) => {
                    on = diameter > 0.0;
                    self.diameter = if on { diameter * self.unit } else { self.diameter };
                }
                (b'S', Some(value)) => says = Some(value > 0.0),
                _ => {}
            }
        }
        self.area = if says.unwrap_or(on) { circle(self.diameter) } else { 0.0 };
    }

    /// G10 pulls filament back, or sets up a tool or a zero point.
    fn g10(&mut self, words: Words<'_>, sink: &mut dyn FnMut(Event)) {
        let (mut place, mut first_of_tool, mut of_tool) = (None, None, 0);
        for (letter, value) in words {
            if letter == b'L' {
                place = Some(value.unwrap_or_default());
            } else if OF_TOOL.contains(&letter) {
                first_of_tool = first_of_tool.or(Some((letter, value)));
                of_tool += 1;
            }
        }
        // Marlin's S says how far to pull back.
        let is_length = |(letter, value): (u8, Option<f64>)| {
            letter == b'S' && value.is_some_and(|value| (0.0..=1.0).contains(&value))
        };
        let retracts = match self.rules.g10 {
            G10::Offsets => return,
            G10::Retracts => true,
            G10::RetractsBare => of_tool == 0,
            G10::Guess => of_tool == 0 || of_tool == 1 && first_of_tool.is_some_and(is_length),
        };
        match place {
            None if retracts => self.retract(true, sink),
            Some(2.0 | 20.0) if self.rules.places => self.set_zero(words, place == Some(20.0)),
            _ => {
                if let Some(heating) = heat::of_tool(words) {
                    sink(Event::Heating(heating));
                }
            }
        }
    }

    fn set_zero(&mut self, words: Words<'_>, here: bool) {
        let (mut which, mut numbers) = (0, [None; 3]);
        for (letter, value) in words {
            match (letter, axis(letter)) {
                (b'P', _) => which = value.unwrap_or_default().max(0.0) as usize,
                (_, Some(axis)) => numbers[axis] = value.map(|value| value * self.unit),
                _ => {}
            }
        }
        self.places.set_zero(which, numbers, here);
    }

    /// How far the filament is to move, mm.
    pub(super) fn push_filament(&mut self, to: Option<(u8, f64)>) -> f64 {
        let by = self.push_e(to);
        if self.area > 0.0 { by / self.area } else { by }
    }

    /// How far E is to move.
    fn push_e(&mut self, to: Option<(u8, f64)>) -> f64 {
        let Some((letter, value)) = to else { return 0.0 };
        let counter = self.counter(letter);
        let by_axes = self.relative && self.rules.modes == Modes::Either;
        if by_axes || self.relative_filament {
            self.filament[counter] += value;
            return value;
        }
        value - std::mem::replace(&mut self.filament[counter], value)
    }

    /// The counter that E, A or B is.
    fn counter(&mut self, letter: u8) -> usize {
        self.counts_apart |= letter != b'E';
        match letter {
            b'A' => 0,
            b'B' => 1,
            _ if self.counts_apart => self.tool,
            _ => 0,
        }
    }

    /// M221 of the current tool.
    pub(super) fn flow(&self) -> f64 {
        self.flow[self.tool]
    }

    fn change_tool(&mut self, words: Words<'_>) {
        if let Some(tool) = tool(words) {
            self.tool = tool;
        }
    }

    fn home(&mut self, words: Words<'_>, at: Option<f64>, sink: &mut dyn FnMut(Event)) {
        self.forget(words, at);
        sink(Event::Wait(Wait::Homing));
    }

    /// M132: the axes named, or all, are where the printer remembers; the filament begins at 0.
    fn recall(&mut self, words: Words<'_>) {
        self.forget(words, None);
        for (letter, _) in words.filter(|(letter, _)| b"AB".contains(letter)) {
            self.filament[usize::from(letter == b'B')] = 0.0;
        }
    }

    /// The axes named, or all, are now at `at`.
    fn forget(&mut self, words: Words<'_>, at: Option<f64>) {
        let named = words.filter_map(|(letter, _)| axis(letter));
        if named.map(|axis| self.places.home(axis, at)).count() == 0 {
            (0..3).for_each(|axis| self.places.home(axis, at));
        }
    }

    fn set_position(&mut self, words: Words<'_>) {
        let mut any = false;
        for (letter, value) in words {
            let value = value.unwrap_or(0.0) * self.unit;
            match (letter, axis(letter)) {
                (_, Some(axis)) => self.places.rename(axis, value),
                (b'E' | b'A' | b'B', _) => {
                    let counter = self.counter(letter);
                    self.filament[counter] = value;
                }
                _ => continue,
            }
            any = true;
        }
        if !any {
            (0..3).for_each(|axis| self.places.rename(axis, 0.0));
            self.filament = [0.0; 2];
        }
    }

    /// M220: S sets the factor, B keeps it, R takes it back.
    fn set_factor(&mut self, words: Words<'_>) {
        for (letter, value) in words {
            match (letter, value.filter(|percent| *percent > 0.0)) {
                (b'S', Some(percent)) => self.feed_factor = percent / 100.0,
                (b'B', _) => self.kept_factor = self.feed_factor,
                (b'R', _) => self.feed_factor = self.kept_factor,
                _ => {}
            }
        }
    }

    /// M221 of a tool (T, or D in RepRapFirmware), or of the current one.
    fn set_flow(&mut self, words: Words<'_>) {
        let mut drives = words.filter_map(|(letter, value)| value.filter(|_| letter == b'D'));
        let drive = drives.next().map(|drive| usize::from(drive >= 1.0));
        let tool = tool(words).or(drive).unwrap_or(self.tool);
        let mut percents = words.filter_map(|(letter, value)| value.filter(|_| letter == b'S'));
        if let Some(percent) = percents.next().filter(|percent| *percent >= 0.0) {
            self.flow[tool] = percent / 100.0;
        }
    }
}

/// The tool that T names, 0 or 1.
fn tool(words: Words<'_>) -> Option<usize> {
    let mut tools = words.filter_map(|(letter, value)| value.filter(|_| letter == b'T'));
    tools.next().map(|tool| usize::from(tool >= 1.0))
}

fn axis(letter: u8) -> Option<usize> {
    b"XYZ".iter().position(|&axis| axis == letter)
}

/// Area of a circle, mm².
fn circle(diameter: f64) -> f64 {
    PI * diameter * diameter / 4.0
}

/// Seconds that G4 waits: P in milliseconds, S in seconds.
fn dwell(rule: Dwell, words: Words<'_>) -> f64 {
    let (mut p, mut s) = (None, None);
    for (letter, value) in words {
        match letter {
            b'P' => p = value.map(|milliseconds| milliseconds / 1000.0),
            b'S' => s = value,
            _ => {}
        }
    }
    let seconds = match rule {
        Dwell::Seconds => s.or(p),
        Dwell::Milliseconds => p,
        Dwell::Sum => Some(s.unwrap_or(0.0) + p.unwrap_or(0.0)),
    };
    seconds.unwrap_or(0.0).max(0.0)
}
