//! Commands in the file's order -> findings of those that change what the rest of the print relies on.
//!
//! What a command does to the print goes by where it stands ([`Phase`]), and that is known only at the
//! next line: commands wait until a line of a layer comes, or the file's end. G92 is judged at once: it
//! moves all that follows by the difference between where the nozzle is and where it is said to be.
//!
//! Tools: a machine has the one that its profile prints with, and as many as the file says that it was
//! made for; Sailfish has two.

use super::orders::{self, Blame, Phase, Verdict};
use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::terms::Terms;
use crate::profile::DialectName;
use crate::reader::print::{Note, Order, What};

/// Tools that a machine has, at most, where nobody says how many.
const MOST_TOOLS: u32 = 16;

/// G92 after homing that moves more than this, mm, tells where the end stop is: those of deltas are at the top.
const MOST_TRIMMED: f64 = 5.0;

/// Positions are rounded to this or less, mm.
const ROUNDING: f64 = 0.01;

/// Tools of Sailfish.
const SAILFISH_TOOLS: u32 = 2;

/// A command that waits to be judged.
struct Waiting {
    place: Place,
    what: What,
    /// How often the nozzle had been sent to the end stops.
    homed: usize,
}

/// Judges commands in the file's order.
pub(crate) struct Changes {
    dialect: Option<DialectName>,
    /// The machine's own tool, and how many others are known.
    tool: Option<u32>,
    tools: Option<u32>,
    waiting: Vec<Waiting>,
    /// Whether a line of a layer has been printed.
    has_begun: bool,
    /// How often all or some axes were sent to end stops, and before which moves each last was.
    homed: usize,
    homed_at: [Option<usize>; 3],
    /// Whether an axis has been sent to an end stop whose place only the printer knows, the last time.
    is_untold: [bool; 3],
}

impl Changes {
    pub(crate) fn new(terms: &Terms) -> Self {
        let machine = terms.machine.as_ref();
        let dialect = machine.map(|machine| machine.dialect);
        let is_sailfish = dialect == Some(DialectName::Makerbot);
        Self {
            dialect,
            tool: machine.map(|machine| machine.tool),
            tools: terms.tools.max(is_sailfish.then_some(SAILFISH_TOOLS)),
            waiting: Vec::new(),
            has_begun: false,
            homed: 0,
            homed_at: [None; 3],
            is_untold: [false; 3],
        }
    }

    /// A command; the nozzle is at `at`, on the layer `layer`, from 1.
    pub(crate) fn note(
        &mut self,
        note: &Note,
        (at, layer): ([f64; 3], Option<usize>),
        found: &mut Findings,
    ) {
        let place = Place { line: Some(note.line), layer, ..Place::default() };
        match &note.what {
            What::Command(order) if (order.letter, order.number) == (b'G', 92) => {
                self.moved(order, (note.at, at, place), found);
            }
            What::Command(order) => {
                if order.letter == b'G' && matches!(order.number, 28 | 161 | 162) {
                    self.home(order, note.at);
                }
                self.wait(note, place);
            }
            What::Unknown(_) if self.dialect.is_none_or(|one| one == DialectName::Klipper) => {
                self.wait(note, place);
            }
            _ => {}
        }
    }

    fn wait(&mut self, note: &Note, place: Place) {
        let (what, homed) = (note.what.clone(), self.homed);
        self.waiting.push(Waiting { place, what, homed });
    }

    fn home(&mut self, order: &Order, at: usize) {
        self.homed += 1;
        let all = !b"XYZ".iter().any(|&axis| order.has(axis));
        for (axis, letter) in b"XYZ".iter().enumerate() {
            if all || order.has(*letter) {
                self.homed_at[axis] = Some(at);
                self.is_untold[axis] = order.number != 28;
            }
        }
    }

    /// A line of a layer comes next.
    pub(crate) fn line(&mut self, found: &mut Findings) {
        if !self.waiting.is_empty() {
            let phase = if self.has_begun { Phase::Print } else { Phase::Start };
            self.judge(phase, found);
        }
        self.has_begun = true;
    }

    /// The file ends.
    pub(crate) fn finish(&mut self, found: &mut Findings) {
        self.judge(Phase::End, found);
    }

    fn judge(&mut self, phase: Phase, found: &mut Findings) {
        for one in std::mem::take(&mut self.waiting) {
            let judged = match &one.what {
                What::Command(order) if matches!(order.letter, b'T') => {
                    self.of_tool(order, phase).map(|blame| (name(order), blame))
                }
                // Motors may be off until the axes are homed.
                What::Command(order)
                    if matches!(order.number, 18 | 84)
                        && phase == Phase::Start
                        && one.homed < self.homed =>
                {
                    None
                }
                What::Command(order) => {
                    orders::blame(order, self.dialect, phase).map(|blame| (name(order), blame))
                }
                What::Unknown(code) => {
                    orders::blame_word(code, phase).map(|(word, blame)| (word.to_owned(), blame))
                }
                _ => None,
            };
            if let Some((name, blame)) = judged {
                found.add(finding(&name, &blame).at(one.place));
            }
        }
    }

    fn of_tool(&self, order: &Order, phase: Phase) -> Option<Blame> {
        // Nobody tells: as many as there may be.
        let known = self.tools.or(self.tool.map(|_| 1)).unwrap_or(MOST_TOOLS);
        if order.number < known || self.tool == Some(order.number) {
            return None;
        }
        let verdict = if phase == Phase::End { Verdict::Warning } else { Verdict::Error };
        let why = "takes a tool that the machine does not have";
        Some(Blame { verdict, why, measure: f64::from(order.number), unit: "tool" })
    }

    /// G92 of x, y or z: what follows lies elsewhere than it says. After homing an axis whose end stop
    /// only the printer knows (G161, G162), before all moves and all homing, or where an axis is homed far from 0,
    /// it says where that is. Else the firmware knows after G28: such as G92 Z0.2 then lowers the whole print.
    fn moved(
        &mut self,
        order: &Order,
        (index, at, place): (usize, [f64; 3], Place),
        found: &mut Findings,
    ) {
        let all = order.words.is_empty();
        let by = |axis: usize| {
            let letter = b"XYZ"[axis];
            let says = order.has(letter).then(|| order.value(letter).unwrap_or(0.0));
            let says = says.or(all.then_some(0.0))?;
            // Homing is no move of the file: `at` is the place before it, and G28 leaves the axis at 0.
            let is_homed = self.homed_at[axis] == Some(index);
            let by = if is_homed { says } else { says - at[axis] };
            let is_told = is_homed && (self.is_untold[axis] || by.abs() > MOST_TRIMMED);
            let is_free = is_told || index == 0 && self.homed_at[axis].is_none();
            (!is_free).then_some(by)
        };
        let largest = (0..3)
            .filter_map(|axis| Some((axis, by(axis)?)))
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let Some((axis, by)) = largest.filter(|(_, by)| by.abs() > ROUNDING) else { return };
        let verdict = if self.has_begun { Verdict::Error } else { Verdict::Warning };
        let axis = ["x", "y", "z"][axis];
        let text = format!("G92 moves all that follows by {} mm in {axis}", short(-by));
        let one = if verdict == Verdict::Error { Finding::of } else { Finding::warning };
        found.add(one(Code::ChangesTheMachine, by.abs(), "mm", text).at(place));
    }
}

fn name(order: &Order) -> String {
    format!("{}{}", char::from(order.letter), order.number)
}

fn finding(name: &str, blame: &Blame) -> Finding {
    let one = if blame.verdict == Verdict::Error { Finding::of } else { Finding::warning };
    let much = match blame.unit {
        "commands" | "tool" => String::new(),
        unit => format!(" ({} {unit})", short(blame.measure)),
    };
    let text = format!("{name} {}{much}", blame.why);
    one(Code::ChangesTheMachine, blame.measure, blame.unit, text)
}
