//! Print + Terms -> findings of single moves: codes, volume, heat, feeds, flow, retractions, heights.
//!
//! One pass over the moves in the file's order, with what is known so far: how hot the nozzle is, how
//! much filament is pulled back, which layer it is. Each move is checked for:
//! - plastic pushed out before the nozzle was set and waited for (once a file);
//! - filament that is still pulled back when a line begins, or pushed out more than was pulled back;
//! - lines outside the machine's volume, other moves beyond the nozzle's reach;
//! - motors that would have to step too fast ([`motors`]);
//! - speeds in x and y beyond the machine's, and more plastic per second than the hot end melts.
//!   Speeds of the filament alone are not judged, and speeds in z only of non-planar skin, of lines that
//!   rise by more than a layer, in files of this program's, or beyond any machine's: firmwares cap them,
//!   and slicers rely on that. A move that rises is as slow as the cap on z makes it;
//! - travels through what stands ([`through`]); in files with lines over slopes all that the head touches,
//!   and the skins there ([`slopes`](super::slopes)); lines on what the start block primed ([`primed`]).
//!
//! Between the moves are commands: those that change the machine ([`changes`]) and its limits
//! ([`limits`]), those for heaters ([`warmth`]) and the fan ([`air`]), and those that a start or end block
//! leaves out ([`blocks`]).
//!
//! Commands are judged once each, by a list of what the firmware knows ([`codes`]).

pub(crate) mod air;
pub(crate) mod blocks;
pub(crate) mod changes;
pub(crate) mod codes;
pub(crate) mod dialect;
pub(crate) mod heat;
pub(crate) mod limits;
pub(crate) mod motors;
pub(crate) mod orders;
pub(crate) mod patches;
pub(crate) mod primed;
pub(crate) mod through;
pub(crate) mod warmth;

use crate::check::beads;
use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::slopes::Slopes;
use crate::check::terms::{Machine, Terms};
use crate::check::window::Page;
use crate::reader::print::{Note, Order, Step, What};
use crate::reader::{Facts, Role};
use air::Air;
use blocks::Blocks;
use changes::Changes;
use codes::Codes;
use heat::Heat;
use motors::{LEAST_LENGTH, SPEED_SLACK};
use patches::Patches;
use primed::Primed;
use through::Through;
use warmth::Warmth;

/// Coordinates are rounded to this or less, mm; a smaller value would report files with two decimals.
pub(crate) const ROUNDING: f64 = 0.01;

/// Factor by which flow may exceed the limit: E has few decimals.
const FLOW_SLACK: f64 = 1.05;

/// Lower lifts are not judged, mm.
const LEAST_LIFT: f64 = 0.05;

/// Filament that may be missing or too much at a restore, mm: room for what slicers add to prime.
const FILAMENT_SLACK: f64 = 0.3;

/// No nozzle goes so far from 0, or so low below the bed where no machine is known, mm.
const FARTHEST: f64 = 10_000.0;
const LOWEST: f64 = -1.0;

/// No machine lifts so fast, mm/s; slicers write the speed of travels, too, where only z moves.
const FASTEST_LIFT: f64 = 500.0;

/// Factors on all plastic that a material may need.
const MULTIPLIERS: std::ops::RangeInclusive<f64> = 0.5..=1.6;

/// Judges the moves one by one, in the file's order, as they come.
pub(crate) struct Moves<'a> {
    walk: Walk<'a>,
    codes: Codes<'a>,
    next: usize,
}

impl<'a> Moves<'a> {
    /// `has_slopes` tells whether lines go over slopes.
    pub(crate) fn new(facts: &'a Facts, terms: &'a Terms, has_slopes: bool) -> Self {
        let walk = Walk::new(facts, terms, has_slopes);
        Self { walk, codes: Codes::new(terms.machine.as_ref()), next: 0 }
    }

    /// The next moves, and the notes before, between and after them.
    pub(crate) fn page(&mut self, page: &Page<'_>, found: &mut Findings) {
        let mut notes = page.notes.iter().peekable();
        for step in page.moves.iter() {
            while let Some(note) = notes.next_if(|note| note.at <= self.next) {
                self.note(note, found);
            }
            self.walk.step(self.next, step, found);
            self.next += 1;
        }
        notes.for_each(|note| self.note(note, found));
        found.bound();
    }

    fn note(&mut self, note: &Note, found: &mut Findings) {
        self.walk.note(note, found);
        self.codes.note(note);
    }

    /// Ends the file. What cannot be judged goes to `notes`.
    pub(crate) fn finish(self, found: &mut Findings, notes: &mut Vec<String>) {
        let mut walk = self.walk;
        self.codes.finish(walk.facts, found, notes);
        multiplier(walk.terms, found);
        let printing = walk.begun.unwrap_or(usize::MAX)..walk.facts.last_line;
        limits::judge((walk.facts, walk.terms), &printing, found);
        walk.changes.finish(found);
        walk.warmth.finish(found);
        walk.blocks.finish(found);
        walk.primed.finish(found);
        walk.patches.finish((walk.facts, walk.terms), found);
        if let Some(slopes) = walk.slopes {
            slopes.finish(found);
        }
        let summary = &walk.facts.summary;
        if summary.coarse_arcs > 0 {
            let (arcs, line) = (summary.coarse_arcs, summary.first_coarse_arc);
            notes.push(format!(
                "where {arcs} arcs go exactly (the first in line {line}): so short a file may not ask \
                 for that many pieces"
            ));
        }
        if let Some(macros) = walk.heated_by_macro {
            notes.push(format!("whether the nozzle is hot: that is left to `{macros}`"));
        }
    }
}

/// Settings of the file's own that push out far too much or too little.
fn multiplier(terms: &Terms, found: &mut Findings) {
    if MULTIPLIERS.contains(&terms.multiplier) {
        return;
    }
    let (times, is_more) = (terms.multiplier, terms.multiplier > 1.0);
    let code = if is_more { Code::Overfilled } else { Code::Underfilled };
    let text =
        format!("the file's settings push out {} times the plastic of all lines", short(times));
    found.add(Finding::of(code, times, "times", text));
}

/// Whether the printer heats before it reads the file: an Ultimaker 2, which takes E for volumes, by its
/// menu, an Ultimaker 3 by the file's head.
fn heats_by_itself(facts: &Facts) -> bool {
    facts.summary.volumes_by > 0.0 || facts.head.iter().any(|text| text == "FLAVOR:Griffin")
}

/// What is known after the moves so far.
struct Walk<'a> {
    facts: &'a Facts,
    terms: &'a Terms,
    machine: Option<&'a Machine>,
    filament_area: f64,
    changes: Changes,
    warmth: Warmth,
    blocks: Blocks,
    air: Air,
    through: Through,
    primed: Primed,
    /// In files with lines over slopes.
    slopes: Option<Slopes<'a>>,
    patches: Patches,
    /// Where the nozzle is.
    at: [f64; 3],
    /// Layer of the next move; `None` before the first.
    layer: Option<usize>,
    /// The moves from the first layer's to the last line.
    printing: std::ops::Range<usize>,
    /// Place of the first line of a layer.
    begun: Option<usize>,
    heat: Heat,
    /// The first command that the reader does not know: a macro that may heat the nozzle.
    stranger: Option<String>,
    /// That command, once plastic is pushed out without any other that heats.
    heated_by_macro: Option<String>,
    is_cold_reported: bool,
    /// Filament that is pulled back, mm.
    pulled: f64,
    /// Whether the firmware has it pulled back.
    pulled_by_firmware: bool,
}

impl<'a> Walk<'a> {
    fn new(facts: &'a Facts, terms: &'a Terms, has_slopes: bool) -> Self {
        let by_printer = heats_by_itself(facts);
        Self {
            facts,
            terms,
            machine: terms.machine.as_ref(),
            filament_area: terms.filament_area,
            changes: Changes::new(terms),
            warmth: Warmth::new(terms),
            blocks: Blocks::new(facts, terms, by_printer),
            air: Air::new(terms),
            through: Through::new(terms, has_slopes),
            primed: Primed::default(),
            slopes: has_slopes.then(|| Slopes::new(facts, terms)),
            patches: Patches::default(),
            at: [0.0; 3],
            layer: None,
            printing: facts.start.end..facts.last_line.max(facts.start.end),
            begun: None,
            heat: if by_printer { Heat::by_printer() } else { Heat::default() },
            stranger: None,
            heated_by_macro: None,
            is_cold_reported: false,
            pulled: 0.0,
            pulled_by_firmware: false,
        }
    }

    fn note(&mut self, note: &Note, found: &mut Findings) {
        let layer = self.layer.map(|layer| layer + 1);
        let place = Place { line: Some(note.line), layer, ..Place::default() };
        self.changes.note(note, (self.at, layer), found);
        self.blocks.note(note, place);
        codes::numberless(note, place, found);
        match &note.what {
            What::Heating(heating) => {
                self.warmth.set(heating, place, found);
                self.heat.set(heating);
            }
            What::FirmwareRetraction { back } => self.pulled_by_firmware = *back,
            What::Unknown(code) if blocks::may_be_macro(code) => {
                let word = code.split_whitespace().next().map(str::to_owned);
                self.stranger = self.stranger.take().or(word);
            }
            What::Unknown(_) | What::NoNumber { .. } => {}
            What::Command(order) => {
                self.air.set(order, place);
                if matches!((order.letter, order.number), (b'G', 161 | 162) | (b'M', 132)) {
                    self.through.lose();
                    self.slopes.iter_mut().for_each(Slopes::lose);
                }
                if let Some(tool) = tool_of(order) {
                    self.warmth.tool(tool);
                    self.blocks.tool(tool);
                }
            }
        }
    }

    fn step(&mut self, index: usize, step: &Step, found: &mut Findings) {
        let next = self.layer.map_or(0, |layer| layer + 1);
        if self.facts.layers.get(next).is_some_and(|layer| layer.moves.start <= index) {
            self.layer = Some(next);
        }
        let printing = self.printing.contains(&index);
        let is_of_layer = printing && step.is_line();
        match self.layer {
            Some(layer) if is_of_layer => {
                self.begun = self.begun.or(Some(index));
                self.changes.line(found);
                self.blocks.line(|| beads::place(layer, step), found);
                self.warmth.line(found);
                self.air.line(step, layer, found);
                self.primed.line(step, layer);
            }
            None => self.primed.start(step),
            Some(_) => {}
        }
        if step.role == Role::NonPlanar && step.is_line() {
            self.patches.line((self.facts, self.terms), step, self.layer);
        }
        let before = found.len();
        self.retraction(index, step, found);
        self.cold(step, found);
        self.place(step, printing, found);
        self.lift(step, printing, found);
        if step.is_line() || printing {
            self.speed(step, printing, found);
        }
        motors::too_many_steps(step, self.machine).into_iter().for_each(|one| found.add(one));
        if self.layer.is_some() && index >= self.printing.end {
            self.through.after(step, found);
        }
        self.through.step(step, is_of_layer, found);
        if let Some(slopes) = &mut self.slopes {
            slopes.step(step, (self.layer, is_of_layer), found);
        }
        self.at = step.to.map(f64::from);
        // All of them lie where the move ends.
        let place = Place {
            line: Some(u64::from(step.line)),
            layer: self.layer.map(|layer| layer + 1),
            z_mm: Some(short(f64::from(step.to[2]))),
            at_mm: Some([step.to[0], step.to[1]].map(|at| short(f64::from(at)))),
        };
        found.fill_in(before, place);
    }

    fn retraction(&mut self, index: usize, step: &Step, found: &mut Findings) {
        let filament = f64::from(step.filament);
        if filament < 0.0 {
            self.pulled -= filament;
            return;
        }
        if filament == 0.0 {
            return;
        }
        let printing = self.printing.contains(&index);
        if !step.is_line() {
            let extra = filament - self.pulled;
            self.pulled = (self.pulled - filament).max(0.0);
            if printing && extra > FILAMENT_SLACK {
                let text = format!(
                    "{} mm of filament are pushed out more than was pulled back",
                    short(extra)
                );
                found.add(Finding::of(Code::UnpairedRetraction, extra, "mm", text));
            }
            return;
        }
        if self.pulled > FILAMENT_SLACK && printing {
            let text = format!("{} mm of filament are still pulled back", short(self.pulled));
            found.add(Finding::of(Code::UnpairedRetraction, self.pulled, "mm", text));
        } else if self.pulled_by_firmware {
            let text = "the filament is still pulled back by G10".to_owned();
            found.add(Finding::of(Code::UnpairedRetraction, 1.0, "retractions", text));
        }
        (self.pulled, self.pulled_by_firmware) = (0.0, false);
    }

    fn cold(&mut self, step: &Step, found: &mut Findings) {
        if step.filament <= 0.0 || self.heat.is_hot() || self.is_cold_reported {
            return;
        }
        // Once is enough: everything after it is as cold.
        self.is_cold_reported = true;
        if let Some(word) = self.stranger.clone().filter(|_| !self.heat.is_wanted()) {
            self.heated_by_macro = Some(word);
            return;
        }
        let text = if self.heat.is_wanted() {
            "filament is pushed before anything waits for the nozzle to be hot"
        } else {
            "filament is pushed with the nozzle cold"
        };
        let pushed = f64::from(step.filament);
        found.add(Finding::of(Code::ColdExtrusion, pushed, "mm", text.to_owned()));
    }

    /// Lines of the print must lie in the print volume. Travels, and all that start and end blocks do,
    /// must stay where the nozzle may go.
    fn place(&self, step: &Step, printing: bool, found: &mut Findings) {
        let lies = printing && step.is_line();
        let [low, high] = match self.machine {
            Some(machine) if lies => machine.volume,
            Some(machine) => machine.reach,
            None => [[-FARTHEST, -FARTHEST, LOWEST], [FARTHEST; 3]],
        };
        let beyond = |axis: usize| {
            let at = f64::from(step.to[axis]);
            (low[axis] - at).max(at - high[axis])
        };
        let (axis, out) = (0..3)
            .map(|axis| (axis, beyond(axis)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or_default();
        if out > ROUNDING {
            let (low, high, out) = (low[axis], high[axis], short(out));
            let axis = ["x", "y", "z"][axis];
            let whose = match self.machine {
                Some(_) if lies => "the machine's",
                Some(_) => "the nozzle's",
                None => "any machine's",
            };
            let text = format!("{out} mm beyond {whose} {axis} of {low} to {high}");
            found.add(Finding::of(Code::OutsideVolume, out, "mm", text));
        }
    }

    /// A move in z alone that no machine follows, or, in a file of this program's, not this one.
    fn lift(&self, step: &Step, printing: bool, found: &mut Findings) {
        let rise = (f64::from(step.to[2]) - f64::from(step.from[2])).abs();
        if rise < LEAST_LIFT || step.from[..2] != step.to[..2] {
            return;
        }
        let own = self.machine.filter(|_| printing && self.terms.is_own);
        let most = own.map_or(FASTEST_LIFT, |machine| machine.speed[2]);
        let feed = f64::from(step.feed);
        if feed > most * SPEED_SLACK {
            let (speed, most) = (short(feed), short(most));
            let text = format!("{speed} mm/s in z, where the machine does {most}");
            found.add(Finding::of(Code::TooFast, feed, "mm/s", text));
        }
    }

    /// From which rise on a move's speed in z is judged, mm. Others' files leave ramps, spirals and
    /// bends within a layer to the firmware's cap, and all travels.
    fn least_rise(&self, step: &Step) -> f64 {
        let layer = self.layer.and_then(|layer| self.facts.layers.get(layer));
        match step.role {
            Role::NonPlanar => LEAST_LIFT,
            _ if self.terms.is_own => LEAST_LIFT,
            _ if step.is_line() => layer.map_or(f64::INFINITY, |layer| layer.height + ROUNDING),
            _ => f64::INFINITY,
        }
    }

    fn speed(&self, step: &Step, printing: bool, found: &mut Findings) {
        let Some(machine) = self.machine else { return };
        let length = step.length();
        let rise = (f64::from(step.to[2]) - f64::from(step.from[2])).abs();
        // Moves in z alone are judged apart.
        if length < LEAST_LENGTH || step.plan_length() == 0.0 {
            return;
        }
        let feed = f64::from(step.feed).min(machine.speed[2] * length / rise);
        let in_z = rise / length * f64::from(step.feed);
        if printing && rise >= self.least_rise(step) && in_z > machine.speed[2] * SPEED_SLACK {
            let (speed, most) = (short(in_z), short(machine.speed[2]));
            let text = format!("{speed} mm/s in z, where the machine does {most}");
            found.add(Finding::of(Code::TooFast, in_z, "mm/s", text));
        }
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let way = f64::from(step.to[axis]) - f64::from(step.from[axis]);
            let speed = way.abs() / length * feed;
            if speed > machine.speed[axis] * SPEED_SLACK {
                let (told, most) = (short(speed), short(machine.speed[axis]));
                let text = format!("{told} mm/s in {name}, where the machine does {most}");
                found.add(Finding::of(Code::TooFast, speed, "mm/s", text));
                return;
            }
        }
        let flow = f64::from(step.filament) * self.filament_area / length * feed;
        if step.is_line() && flow > machine.flow * FLOW_SLACK {
            let text =
                format!("{} mm³/s, where the hot end melts {}", short(flow), short(machine.flow));
            found.add(Finding::of(Code::TooMuchFlow, flow, "mm³/s", text));
        }
    }
}

/// The tool that a command takes, if it takes one.
fn tool_of(order: &Order) -> Option<u32> {
    match (order.letter, order.number) {
        (b'T', tool) => Some(tool),
        (b'M', 108 | 135) => order.value(b'T').filter(|tool| *tool >= 0.0).map(|tool| tool as u32),
        _ => None,
    }
}
