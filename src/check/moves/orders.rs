//! Command + where in the file -> Blame: what it does to the machine that the commands after it count on.
//!
//! Words used here: a *phase* is the start (before the first line of a layer), the print, or the end
//! (after the last line); a *verdict* is how bad a command is in a phase; a *blame* is a verdict with
//! a reason and a measure.
//!
//! Most commands are judged by a row of [`ROWS`]: one set of numbers, the firmwares that know them so,
//! and a verdict for each phase. A start block may home, level and set up what it likes. In the print
//! the same moves the part, stops it, or drives the nozzle into it. What goes by the command's words
//! (G28, G92, M18, M220 …) has a function. Pauses and changes of filament are warnings: people ask
//! for them.
//!
//! What commands do: marlinfw.org/docs/gcode, docs.duet3d.com (Gcode dictionary), klipper3d.org
//! (G-Codes), and GPX's and Sailfish's sources. Moves, G20, G21, G90, G91, M82 and M83 are not here:
//! the reader does what they say, and the moves show it.

use crate::profile::DialectName;
use crate::reader::print::Order;

/// Where in the file a command stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Before the first line of a layer.
    Start,
    /// Between lines.
    Print,
    /// After the last.
    End,
}

/// How bad a command is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Fine,
    Warning,
    Error,
}
use Verdict::{Error, Fine, Warning};

/// A verdict with its reason.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Blame {
    pub(crate) verdict: Verdict,
    /// What the command does, as the end of a sentence.
    pub(crate) why: &'static str,
    /// How much, in `unit`.
    pub(crate) measure: f64,
    pub(crate) unit: &'static str,
}

impl Blame {
    fn once(verdict: Verdict, why: &'static str) -> Self {
        Self { verdict, why, measure: 1.0, unit: "commands" }
    }
}

/// Commands that are judged by their number alone.
struct Row {
    letter: u8,
    numbers: &'static [u32],
    /// The firmwares of which this is said; none for all, and for files of an unknown one.
    of: &'static [DialectName],
    /// At the start, in the print, at the end.
    verdicts: [Verdict; 3],
    why: &'static str,
}

const fn g(numbers: &'static [u32], verdicts: [Verdict; 3], why: &'static str) -> Row {
    Row { letter: b'G', numbers, of: &[], verdicts, why }
}

const fn m(numbers: &'static [u32], verdicts: [Verdict; 3], why: &'static str) -> Row {
    Row { letter: b'M', numbers, of: &[], verdicts, why }
}

const fn only(of: &'static [DialectName], row: Row) -> Row {
    Row { of, ..row }
}

/// See the file's head.
const ROWS: &[Row] = &[
    g(&[12, 27], [Fine, Warning, Fine], "leaves the print to clean or park the nozzle"),
    g(&[18, 19], [Fine, Warning, Fine], "turns the plane of arcs"),
    g(
        &[29, 30, 32, 33, 34, 35, 38, 80, 425],
        [Fine, Error, Error],
        "probes a bed that the part stands on",
    ),
    g(&[5, 6], [Error; 3], "moves the nozzle along a curve or by steps, which is not followed"),
    m(&[401], [Fine, Error, Warning], "lowers the probe below the nozzle"),
    only(
        &[DialectName::Marlin, DialectName::Klipper, DialectName::Reprapfirmware],
        g(&[55, 56, 57, 58, 59], [Warning, Error, Fine], "chooses another place for 0"),
    ),
    only(&[DialectName::Reprapfirmware], m(&[0, 1, 2], [Error, Error, Fine], "ends the print")),
    m(&[0, 1, 25, 226, 601], [Fine, Warning, Fine], "pauses the print"),
    m(&[125, 600, 602, 701, 702], [Fine, Warning, Fine], "pauses for another filament"),
    m(&[2, 524], [Error, Error, Fine], "ends the print"),
    m(&[23, 26, 28, 30, 32, 928], [Warning, Error, Fine], "goes on with another file or place"),
    m(&[81], [Fine, Error, Fine], "switches the power off"),
    m(&[112], [Error, Error, Error], "is the emergency stop"),
    m(&[410], [Warning, Error, Fine], "drops the moves that are planned"),
    m(&[997, 999], [Warning, Error, Warning], "restarts the firmware"),
    m(&[92], [Warning, Error, Warning], "changes how far motors turn for a millimetre"),
    m(&[350], [Fine, Error, Fine], "changes the steps of motors"),
    m(&[200], [Fine, Error, Fine], "changes what E means"),
    m(&[206, 428], [Warning, Error, Warning], "moves the place of 0"),
    m(&[218], [Fine, Error, Fine], "moves the tool's offset"),
    m(&[290], [Fine, Error, Fine], "shifts the height of the nozzle"),
    m(&[851], [Warning, Error, Warning], "changes the probe's offset"),
    m(&[665, 666], [Warning, Error, Warning], "changes the machine's geometry"),
    m(&[303, 306], [Fine, Error, Fine], "tunes a heater, for minutes"),
    m(&[500, 501], [Warning, Warning, Warning], "stores or reloads the machine's settings"),
    m(&[502], [Warning, Error, Warning], "resets the machine's settings"),
    only(
        &[DialectName::Reprapfirmware],
        m(
            &[208, 557, 558, 563, 569, 574, 584, 667, 669],
            [Warning, Error, Warning],
            "sets the machine up anew",
        ),
    ),
    only(&[DialectName::Reprapfirmware], m(&[561], [Fine, Error, Fine], "drops the bed's mesh")),
    only(
        &[DialectName::Makerbot],
        m(&[131, 132], [Fine, Error, Fine], "changes where the machine believes to be"),
    ),
    only(&[DialectName::Makerbot], m(&[136, 137], [Fine, Error, Fine], "ends or begins a build")),
];

/// Klipper's commands that are words.
const WORDS: &[(&str, [Verdict; 3], &str)] = &[
    ("SET_GCODE_OFFSET", [Warning, Error, Fine], "moves the place of 0"),
    ("SET_KINEMATIC_POSITION", [Warning, Error, Fine], "moves the place of 0"),
    ("FORCE_MOVE", [Warning, Error, Warning], "moves a motor past all limits"),
    ("SET_STEPPER_ENABLE", [Fine, Error, Fine], "switches a motor off or on"),
    ("TURN_OFF_HEATERS", [Fine, Error, Fine], "switches all heaters off"),
    ("BED_MESH_CLEAR", [Fine, Error, Fine], "drops the bed's mesh"),
    ("BED_MESH_CALIBRATE", [Fine, Error, Error], "probes a bed that the part stands on"),
    ("PROBE", [Fine, Error, Error], "probes a bed that the part stands on"),
    ("SDCARD_RESET_FILE", [Warning, Error, Fine], "ends the print"),
    ("CANCEL_PRINT", [Error, Error, Fine], "ends the print"),
    ("RESTART", [Error, Error, Warning], "restarts the firmware"),
    ("FIRMWARE_RESTART", [Error, Error, Warning], "restarts the firmware"),
    ("SAVE_CONFIG", [Error, Error, Warning], "restarts the firmware"),
    ("PAUSE", [Fine, Warning, Fine], "pauses the print"),
];

/// Percents of flow that a start block may set, and percents of speed: of what users trim.
const FLOWS: std::ops::RangeInclusive<f64> = 75.0..=130.0;
const FEEDS: std::ops::RangeInclusive<f64> = 30.0..=200.0;

/// Cold extrusion is forbidden below this, °C, or nothing forbids it.
const LEAST_FORBIDDEN: f64 = 100.0;

fn of_phase(verdicts: [Verdict; 3], phase: Phase) -> Verdict {
    verdicts[phase as usize]
}

/// What a command does; `None` if it harms nothing. Tools and G92 are judged elsewhere.
pub(crate) fn blame(order: &Order, dialect: Option<DialectName>, phase: Phase) -> Option<Blame> {
    // G5.1 is a curve as well, and G38.2 probes.
    let is_move = order.letter == b'G' && matches!(order.number, 5 | 38);
    if order.has_part && !is_move {
        return None;
    }
    let blame = match (order.letter, order.number) {
        (b'G', 10) => offset(phase),
        (b'G', 28 | 161 | 162) => home(order, dialect, phase),
        (b'M', 18 | 84) => motors_off(order, phase),
        (b'M', 211) => soft_ends(order, phase),
        (b'M', 220) => percent(order, phase, (FEEDS, Warning), "changes the speed of all moves"),
        (b'M', 221) => percent(order, phase, (FLOWS, Error), "changes how much is pushed out"),
        (b'M', 302) => cold(order, phase),
        (b'M', 420) => mesh(order, phase),
        _ => by_row(order, dialect, phase)?,
    };
    (blame.verdict != Fine).then_some(blame)
}

fn by_row(order: &Order, dialect: Option<DialectName>, phase: Phase) -> Option<Blame> {
    let is_it = |row: &&Row| {
        row.letter == order.letter
            && row.numbers.contains(&order.number)
            && (row.of.is_empty() || dialect.is_some_and(|dialect| row.of.contains(&dialect)))
    };
    let row = ROWS.iter().find(is_it)?;
    let largest = order.words.iter().filter(|(letter, _)| b"XYZE".contains(letter));
    let largest = largest.filter_map(|(_, value)| value.map(f64::abs)).fold(0.0, f64::max);
    let verdict = of_phase(row.verdicts, phase);
    let unit = match order.number {
        92 => "steps/mm",
        206 | 218 | 290 | 851 => "mm",
        _ => return Some(Blame::once(verdict, row.why)),
    };
    Some(Blame { verdict, why: row.why, measure: largest, unit })
}

/// What a line of Klipper's own words does.
pub(crate) fn blame_word(code: &str, phase: Phase) -> Option<(&str, Blame)> {
    let word = code.split_whitespace().next()?;
    let known = |(name, ..): &&(&str, [Verdict; 3], &str)| name.eq_ignore_ascii_case(word);
    let &(name, verdicts, why) = WORDS.iter().find(known)?;
    let verdict = of_phase(verdicts, phase);
    (verdict != Fine).then(|| (name, Blame::once(verdict, why)))
}

/// G10 that is neither a retraction nor heats.
fn offset(phase: Phase) -> Blame {
    Blame::once(of_phase([Warning, Error, Fine], phase), "moves the place of 0")
}

/// G28, and Sailfish's G161 and G162. An end stop of z may lie below the part: but for G162, and on an
/// Ultimaker 2, where the bed goes down to it.
fn home(order: &Order, dialect: Option<DialectName>, phase: Phase) -> Blame {
    let named = |axis: &u8| order.has(*axis);
    let lowers = (order.has(b'Z') || !b"XYZ".iter().any(named))
        && order.number != 162
        && dialect != Some(DialectName::Ultigcode);
    let (verdicts, why) = if lowers {
        ([Fine, Error, Warning], "looks for the end stop of z with the part on the bed")
    } else {
        ([Fine, Warning, Fine], "looks for end stops in the print")
    };
    Blame::once(of_phase(verdicts, phase), why)
}

/// M18 and M84: without an axis all motors; with S alone they go off later, when nothing moves.
fn motors_off(order: &Order, phase: Phase) -> Blame {
    let moves = |axis: &u8| order.has(*axis);
    let is_timeout = order.has(b'S') && order.words.len() == 1;
    let none = order.words.iter().all(|(letter, _)| !b"XYZEABUVW".contains(letter));
    let verdicts = if is_timeout {
        [Fine; 3]
    } else if none || b"XYZ".iter().any(moves) {
        [Error, Error, Fine]
    } else {
        [Fine, Warning, Fine]
    };
    Blame::once(of_phase(verdicts, phase), "switches motors off: where the nozzle is gets lost")
}

/// M211: the firmware's own limits of where the nozzle may go.
fn soft_ends(order: &Order, phase: Phase) -> Blame {
    let off =
        order.words.iter().any(|(letter, value)| b"SXYZ".contains(letter) && *value == Some(0.0));
    let verdicts = if off { [Warning, Error, Warning] } else { [Fine; 3] };
    Blame::once(of_phase(verdicts, phase), "switches off the limits of where the nozzle may go")
}

/// M220 and M221: a factor in percent, 100 to go back to normal.
fn percent(
    order: &Order,
    phase: Phase,
    (range, at_start): (std::ops::RangeInclusive<f64>, Verdict),
    why: &'static str,
) -> Blame {
    // Without S a factor is kept for later, or taken back, or told.
    let percent = order.value(b'S').unwrap_or(100.0);
    let verdict = match phase {
        _ if percent == 100.0 => Fine,
        Phase::Start if range.contains(&percent) => Fine,
        Phase::Start => at_start,
        Phase::Print if range.contains(&percent) => Warning,
        Phase::Print => Error,
        Phase::End => Fine,
    };
    Blame { verdict, why, measure: percent, unit: "%" }
}

/// M302: allows to push a cold filament.
fn cold(order: &Order, phase: Phase) -> Blame {
    let forbids = order.value(b'P') == Some(0.0)
        || order.value(b'S').is_some_and(|celsius| celsius >= LEAST_FORBIDDEN);
    let verdicts = if forbids { [Fine; 3] } else { [Warning, Error, Warning] };
    Blame::once(of_phase(verdicts, phase), "allows to push cold filament")
}

/// M420: the mesh of the bed.
fn mesh(order: &Order, phase: Phase) -> Blame {
    let verdicts = if order.value(b'S') == Some(0.0) { [Fine, Error, Fine] } else { [Fine; 3] };
    Blame::once(of_phase(verdicts, phase), "drops the bed's mesh")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdicts(letter: u8, number: u32, words: &[(u8, Option<f64>)]) -> [Verdict; 3] {
        let order = Order { letter, number, has_part: false, words: words.to_vec() };
        [Phase::Start, Phase::Print, Phase::End].map(|phase| {
            let blame = blame(&order, Some(DialectName::Marlin), phase);
            blame.map_or(Fine, |blame| blame.verdict)
        })
    }

    #[test]
    fn what_a_start_block_may_the_print_may_not() {
        for (letter, number, words, expected) in [
            (b'G', 28, &[][..], [Fine, Error, Warning]),
            (b'G', 28, &[(b'X', Some(0.0))], [Fine, Warning, Fine]),
            (b'M', 84, &[], [Error, Error, Fine]),
            (b'M', 84, &[(b'S', Some(60.0))], [Fine; 3]),
            (b'M', 18, &[(b'A', None), (b'B', None)], [Fine, Warning, Fine]),
            (b'M', 221, &[(b'S', Some(95.0))], [Fine, Warning, Fine]),
            (b'M', 221, &[(b'S', Some(500.0))], [Error, Error, Fine]),
            (b'M', 221, &[(b'S', Some(100.0))], [Fine; 3]),
            (b'M', 220, &[(b'B', None)], [Fine; 3]),
            (b'M', 302, &[(b'S', Some(170.0))], [Fine; 3]),
            (b'M', 302, &[], [Warning, Error, Warning]),
            (b'M', 600, &[], [Fine, Warning, Fine]),
            (b'M', 112, &[], [Error; 3]),
            (b'M', 208, &[(b'S', Some(1.0))], [Fine; 3]),
        ] {
            let found = verdicts(letter, number, words);
            assert_eq!(found, expected, "{}{number} {words:?}", letter as char);
        }
    }
}
