//! Words -> where the nozzle goes: modes, units, positions and feeds as a firmware keeps them.
//!
//! The state of a printer after the lines so far, and the events that the next line makes of it:
//! - positions are absolute (G90) or relative (G91), the filament's too (M82, M83; see [`Firmware`]),
//!   in mm (G21) or inches (G20); G92 sets them without a move;
//! - an axis that was sent to an end stop whose place only the printer knows is unknown (`None`)
//!   until the file names one; the move there counts as one of no length;
//! - F holds until the next F, times M220's factor;
//! - Sailfish counts the filament of its two tools apart, as A and B; there E is the current tool's.
//!   Elsewhere all tools share one counter;
//! - E counts mm of filament, or mm³ of plastic in an Ultimaker 2's files, whose G10 and G11 are
//!   moves of the filament where it is known how far they go;
//! - role, width and height hold from one comment to the next;
//! - arcs (G2, G3) become straight pieces.
//!
//! A command that changes none of these and waits for nothing is *harmless*; any other that is not
//! listed here is unknown, which is counted and reported, and no error.

use super::heat;
use super::marks::{Mark, mark};
use super::words::{self, Code, Words};
use super::{Change, Event, Firmware, Motion, OwnFilament, Role, Summary, Wait};
use crate::geom::arc::Arc;
use crate::units::{MmPerMin, MmPerS};
use std::f64::consts::PI;

/// Feed before the file names one: Marlin's.
const FIRST_FEED: MmPerS = MmPerS(25.0);

/// Diameter of an Ultimaker 2's filament where nobody says it, mm: the only one that is sold for it.
const ULTIMAKER_DIAMETER: f64 = 2.85;

/// Millimetres in an inch.
const INCH: f64 = 25.4;

/// M-codes that neither move anything nor wait: of Marlin, Klipper, Sailfish and Prusa's and Bambu's
/// firmwares. One that is missing here makes files look as if they had unknown lines.
const HARMLESS: &[u32] = &[
    17, 18, 20, 21, 27, 31, 42, 70, 72, 73, 75, 76, 77, 82, 83, 84, 85, 92, 105, 106, 107, 108,
    110, 111, 113, 114, 115, 117, 118, 119, 120, 121, 126, 127, 130, 132, 136, 137, 141, 142, 150,
    155, 200, 207, 208, 209, 211, 217, 218, 221, 240, 250, 280, 290, 300, 301, 302, 304, 350, 351,
    355, 412, 413, 420, 422, 425, 486, 500, 501, 502, 503, 555, 572, 592, 593, 851, 862, 900, 906,
    907, 910, 911, 912, 913, 914, 915, 950, 955, 970, 971, 973, 974, 975, 981, 982, 983, 991, 1002,
];

#[derive(Debug, Clone)]
pub(super) struct State {
    firmware: Firmware,
    /// Where the nozzle is, mm; `None` where only the printer knows.
    at: [Option<f64>; 3],
    /// Where the filament is, mm: of the first tool or of all, and of the second.
    filament: [f64; 2],
    /// The current tool, 0 or 1, and whether A and B count apart.
    tool: usize,
    counts_apart: bool,
    feed: MmPerS,
    /// M220, as a factor.
    feed_factor: f64,
    /// Millimetres in a unit of the file.
    unit: f64,
    relative: bool,
    relative_filament: bool,
    /// What the printer's own retraction has pulled back, mm.
    pulled: f64,
    role: Role,
    width: Option<f64>,
    height: Option<f64>,
    pub(super) summary: Summary,
}

impl Default for State {
    fn default() -> Self {
        Self {
            firmware: Firmware::default(),
            at: [Some(0.0); 3],
            filament: [0.0; 2],
            tool: 0,
            counts_apart: false,
            feed: FIRST_FEED,
            feed_factor: 1.0,
            unit: 1.0,
            relative: false,
            relative_filament: false,
            pulled: 0.0,
            role: Role::Other,
            width: None,
            height: None,
            summary: Summary::default(),
        }
    }
}

/// The words that a move may have.
#[derive(Default)]
struct Target {
    axes: [Option<f64>; 3],
    /// A, B or E, and its number.
    filament: Option<(u8, f64)>,
    /// I, J and R of an arc.
    arc: [Option<f64>; 3],
}

impl State {
    pub(super) fn new(firmware: Firmware) -> Self {
        Self { firmware, ..Self::default() }
    }

    /// Reads the next line of the file.
    pub(super) fn line(&mut self, line: &[u8], sink: &mut dyn FnMut(Event)) {
        self.summary.lines += 1;
        let (code, comment) = words::split(line);
        if !code.is_empty() {
            self.code(code, sink);
        }
        let Some(comment) = comment else { return };
        match mark(comment) {
            Some(Mark::Role(role)) => self.role = role,
            Some(Mark::Width(width)) => self.width = Some(width),
            Some(Mark::Height(height)) => self.height = Some(height),
            Some(Mark::Layer) => sink(Event::Layer { marked: true }),
            Some(Mark::Volumes) => {
                let diameter = self.own().map_or(ULTIMAKER_DIAMETER, |own| own.diameter);
                self.summary.volumes_by = PI * diameter * diameter / 4.0;
            }
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
            sink(Event::Command { letter, number });
        }
        if let Some(heating) = heat::heating(code) {
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
        } else if klipper(code, b"SET_PRESSURE_ADVANCE").is_some() {
            return;
        }
        sink(Event::Unknown(code.to_vec()));
        self.summary.unknown += 1;
        if self.summary.first_unknown == 0 {
            self.summary.first_unknown = self.summary.lines;
        }
    }

    /// Returns whether the command is known.
    fn command(&mut self, code: Code, words: Words<'_>, sink: &mut dyn FnMut(Event)) -> bool {
        match (code.letter, code.number) {
            (b'G', 0 | 1) => self.straight(words, sink),
            (b'G', 2 | 3) => self.arc(words, code.number == 2, sink),
            (b'G', 4) => sink(Event::Dwell(dwell(words))),
            (b'G', 10) if !retracts(words) => {
                if let Some(heating) = heat::of_tool(words) {
                    sink(Event::Heating(heating));
                }
            }
            (b'G', 10 | 11) if self.known_retraction() > 0.0 => {
                self.retract(code.number == 10, sink)
            }
            (b'G', 10 | 11) => {
                self.summary.firmware_retractions += 1;
                sink(Event::FirmwareRetraction { back: code.number == 10 });
            }
            (b'G', 20) => self.unit = INCH,
            (b'G', 21) => self.unit = 1.0,
            (b'G', 28) => self.home(words, Some(0.0), sink),
            (b'G', 161 | 162) => self.home(words, None, sink),
            (b'G', 90 | 91) => {
                self.relative = code.number == 91;
                if self.firmware == Firmware::Marlin {
                    self.relative_filament = self.relative;
                }
            }
            (b'G', 92) => self.set_position(words),
            (b'G', 29 | 34 | 80) => sink(Event::Wait(Wait::Homing)),
            (b'G', 17 | 54 | 130) => {}
            (b'T', tool) => self.tool = (tool as usize).min(1),
            (b'M', 82) => self.relative_filament = false,
            (b'M', 83) => self.relative_filament = true,
            (b'M', 108 | 135) => self.change_tool(words),
            // Only the printer knows where its end stops are.
            (b'M', 132) => self.forget(words, None),
            (b'M', 191 | 303) => sink(Event::Wait(Wait::Heating)),
            (b'M', 0 | 1 | 25 | 226 | 400 | 600 | 601) => sink(Event::Wait(Wait::Moves)),
            (b'M', 201 | 203 | 204 | 205 | 566) => {
                if let Some(change) = Change::of_code(code.number, words) {
                    sink(Event::Change(change));
                }
            }
            (b'M', 220) => self.set_factor(words),
            _ => return is_harmless(code),
        }
        true
    }

    /// What the printer knows of its filament, if it is known here.
    fn own(&self) -> Option<OwnFilament> {
        if let Firmware::Ultimaker(own) = self.firmware { Some(own) } else { None }
    }

    /// How far G10 pulls back, mm; 0 where only the printer knows.
    fn known_retraction(&self) -> f64 {
        let own = self.own().filter(|_| self.summary.volumes_by > 0.0);
        own.map_or(0.0, |own| own.retraction)
    }

    /// A move of the filament alone. A second G10 pulls no further back.
    fn retract(&mut self, back: bool, sink: &mut dyn FnMut(Event)) {
        let pulled = if back { self.known_retraction() } else { 0.0 };
        let filament = std::mem::replace(&mut self.pulled, pulled) - pulled;
        let feed = self.own().map_or(self.feed, |own| own.speed);
        if filament != 0.0 {
            let at = self.at.map(Option::unwrap_or_default);
            let (role, width, height) = (Role::Retraction, self.width, self.height);
            sink(Event::Move(Motion { from: at, to: at, filament, feed, role, width, height }));
        }
    }

    fn straight(&mut self, words: Words<'_>, sink: &mut dyn FnMut(Event)) {
        let target = self.target(words);
        let to = self.to(&target);
        let filament = self.push_filament(target.filament);
        self.go(to, filament, sink);
    }

    fn arc(&mut self, words: Words<'_>, clockwise: bool, sink: &mut dyn FnMut(Event)) {
        let target = self.target(words);
        let from = self.at.map(Option::unwrap_or_default);
        let to = self.to(&target);
        let end = [to[0].unwrap_or_default(), to[1].unwrap_or_default()];
        let filament = self.push_filament(target.filament);
        let start = [from[0], from[1]];
        let arc = match target.arc {
            [None, None, Some(radius)] => Arc::by_radius(start, end, radius, clockwise),
            [None, None, None] => None,
            [i, j, _] => {
                let middle = [from[0] + i.unwrap_or(0.0), from[1] + j.unwrap_or(0.0)];
                Some(Arc { from: start, to: end, middle, clockwise })
            }
        };
        let Some(arc) = arc else { return self.go(to, filament, sink) };
        let count = arc.points().count() as f64;
        let top = to[2].unwrap_or_default();
        for (k, [x, y]) in arc.points().enumerate() {
            let z = from[2] + (top - from[2]) * (k + 1) as f64 / count;
            self.go([Some(x), Some(y), Some(z)], filament / count, sink);
        }
    }

    /// The words of a move; F takes effect at once.
    fn target(&mut self, words: Words<'_>) -> Target {
        let mut target = Target::default();
        for (letter, value) in words {
            let Some(value) = value.map(|value| value * self.unit) else { continue };
            match letter {
                b'X' => target.axes[0] = Some(value),
                b'Y' => target.axes[1] = Some(value),
                b'Z' => target.axes[2] = Some(value),
                b'E' | b'A' | b'B' => target.filament = Some((letter, value)),
                b'I' => target.arc[0] = Some(value),
                b'J' => target.arc[1] = Some(value),
                b'R' => target.arc[2] = Some(value),
                b'F' if value > 0.0 => self.feed = MmPerMin(value).into(),
                _ => {}
            }
        }
        target
    }

    /// Where a move with these words ends.
    fn to(&self, target: &Target) -> [Option<f64>; 3] {
        std::array::from_fn(|axis| match (target.axes[axis], self.at[axis]) {
            (None, at) => at,
            (Some(by), at) if self.relative => at.map(|at| at + by),
            (to, _) => to,
        })
    }

    /// How far the filament is to move, mm.
    fn push_filament(&mut self, to: Option<(u8, f64)>) -> f64 {
        let by = self.push_e(to);
        if self.summary.volumes_by > 0.0 { by / self.summary.volumes_by } else { by }
    }

    /// How far E is to move.
    fn push_e(&mut self, to: Option<(u8, f64)>) -> f64 {
        let Some((letter, value)) = to else { return 0.0 };
        let counter = self.counter(letter);
        let by_axes = self.relative && self.firmware != Firmware::Marlin;
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

    fn change_tool(&mut self, words: Words<'_>) {
        let mut tools = words.filter_map(|(letter, value)| value.filter(|_| letter == b'T'));
        if let Some(tool) = tools.next() {
            self.tool = usize::from(tool >= 1.0);
        }
    }

    fn go(&mut self, to: [Option<f64>; 3], filament: f64, sink: &mut dyn FnMut(Event)) {
        let from = std::mem::replace(&mut self.at, to);
        // From an unknown place the way is unknown, too: none is counted.
        let to = to.map(Option::unwrap_or_default);
        let from: [f64; 3] = std::array::from_fn(|axis| from[axis].unwrap_or(to[axis]));
        let role = match (from != to, filament > 0.0) {
            (true, true) => self.role,
            (true, false) => Role::Travel,
            (false, _) if filament != 0.0 => Role::Retraction,
            (false, _) => return,
        };
        let (width, height) = (self.width, self.height);
        let feed = MmPerS(self.feed.0 * self.feed_factor);
        sink(Event::Move(Motion { from, to, filament, feed, role, width, height }));
    }

    fn home(&mut self, words: Words<'_>, at: Option<f64>, sink: &mut dyn FnMut(Event)) {
        self.forget(words, at);
        sink(Event::Wait(Wait::Homing));
    }

    /// The axes named, or all, are now at `at`.
    fn forget(&mut self, words: Words<'_>, at: Option<f64>) {
        let mut any = false;
        for (letter, _) in words {
            if let Some(axis) = b"XYZ".iter().position(|&axis| axis == letter) {
                self.at[axis] = at;
                any = true;
            }
        }
        if !any {
            self.at = [at; 3];
        }
    }

    fn set_position(&mut self, words: Words<'_>) {
        let mut any = false;
        for (letter, value) in words {
            let value = value.unwrap_or(0.0) * self.unit;
            match letter {
                b'X' => self.at[0] = Some(value),
                b'Y' => self.at[1] = Some(value),
                b'Z' => self.at[2] = Some(value),
                b'E' | b'A' | b'B' => {
                    let counter = self.counter(letter);
                    self.filament[counter] = value;
                }
                _ => continue,
            }
            any = true;
        }
        if !any {
            (self.at, self.filament) = ([Some(0.0); 3], [0.0; 2]);
        }
    }

    fn set_factor(&mut self, words: Words<'_>) {
        for (letter, value) in words {
            if let (b'S', Some(percent)) = (letter, value.filter(|percent| *percent > 0.0)) {
                self.feed_factor = percent / 100.0;
            }
        }
    }
}

/// Whether G10 pulls filament back. RepRapFirmware sets a tool's temperatures (P, R, S) and offsets (an
/// axis) with it, and a workplace with L; Marlin's S of 0 or 1 says how far to pull back.
fn retracts(words: Words<'_>) -> bool {
    let mut words = words.filter(|(letter, _)| b"LPRSXYZUVW".contains(letter));
    let is_length = |(letter, value): (u8, Option<f64>)| {
        letter == b'S' && value.is_some_and(|value| (0.0..=1.0).contains(&value))
    };
    words.next().is_none_or(is_length) && words.next().is_none()
}

/// Seconds that G4 waits: P in milliseconds, S in seconds.
fn dwell(words: Words<'_>) -> f64 {
    let mut seconds = 0.0;
    for (letter, value) in words {
        match (letter, value) {
            (b'P', Some(value)) => seconds = value / 1000.0,
            (b'S', Some(value)) => seconds = value,
            _ => {}
        }
    }
    f64::max(seconds, 0.0)
}

fn is_harmless(code: Code) -> bool {
    code.letter == b'M' && HARMLESS.contains(&code.number)
}

/// What follows the word `name`, in any case.
fn klipper<'a>(code: &'a [u8], name: &[u8]) -> Option<&'a [u8]> {
    let (word, rest) = code.split_at_checked(name.len())?;
    let ends = rest.first().is_none_or(u8::is_ascii_whitespace);
    (ends && word.eq_ignore_ascii_case(name)).then_some(rest)
}
