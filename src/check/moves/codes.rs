//! Commands -> findings of those that the firmware does not know, and of words without their number.
//!
//! Commands are judged once each, by a list of what the firmware knows ([`dialect`]). Klipper's macros
//! cannot be judged, and are listed as such; but a placeholder among their words that no slicer has filled
//! in is a finding as is a missing number.

use super::dialect;
use crate::check::finding::{Code, Finding, Findings, Place};
use crate::check::terms::Machine;
use crate::profile::{self, DialectName};
use crate::reader::Facts;
use crate::reader::print::{Note, What};

/// Digits of a command's number.
const MOST_DIGITS: usize = 6;

/// Commands that the machine does not know.
pub(crate) struct Codes<'a> {
    machine: Option<&'a Machine>,
    unknown: Vec<Finding>,
    /// Words that a module or a macro of Klipper's may know.
    words: Vec<String>,
}

impl<'a> Codes<'a> {
    pub(crate) fn new(machine: Option<&'a Machine>) -> Self {
        Self { machine, unknown: Vec::new(), words: Vec::new() }
    }

    pub(crate) fn note(&mut self, note: &Note) {
        let (What::Unknown(code), Some(machine)) = (&note.what, self.machine) else { return };
        let first: String = code.split_whitespace().next().unwrap_or_default().to_owned();
        let is_word = first.starts_with(|c: char| c.is_ascii_alphabetic())
            && first.chars().nth(1).is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
        if machine.dialect == DialectName::Klipper && is_word {
            // A module's command or a macro of the machine's own.
            if !self.words.contains(&first) {
                self.words.push(first);
            }
        } else if !is_numbered(&first) {
            let shown: String = code.chars().take(40).collect();
            self.unknown.push(unknown(machine, note.line, &format!("`{shown}`")));
        }
    }

    pub(crate) fn finish(self, facts: &Facts, found: &mut Findings, notes: &mut Vec<String>) {
        let Some(machine) = self.machine else { return };
        for (&(letter, number), &line) in &facts.commands {
            if !dialect::knows(machine.dialect, letter, number) {
                found.add(unknown(machine, line, &format!("{}{number}", char::from(letter))));
            }
        }
        found.extend(self.unknown);
        if !self.words.is_empty() {
            notes.push(format!("what Klipper makes of {}", self.words.join(", ")));
        }
    }
}

fn unknown(machine: &Machine, line: u64, what: &str) -> Finding {
    let firmware = match machine.dialect {
        DialectName::Makerbot => "GPX",
        DialectName::Marlin => "Marlin",
        DialectName::Klipper => "Klipper",
        DialectName::Reprapfirmware => "RepRapFirmware",
        DialectName::Ultigcode => "the Ultimaker 2",
    };
    let place = Place { line: Some(line), ..Place::default() };
    let text = format!("{firmware} does not know {what}");
    Finding::of(Code::UnknownCode, 1.0, "lines", text).at(place)
}

/// A word that has no number where it needs one, or a placeholder among a macro's words.
pub(crate) fn numberless(note: &Note, place: Place, found: &mut Findings) {
    let shown = |code: &str| code.chars().take(60).collect::<String>();
    let text = match &note.what {
        What::NoNumber { letter, code } => {
            format!(
                "`{}`: {} has no number, so that it sets nothing",
                shown(code),
                char::from(*letter)
            )
        }
        What::Unknown(code) => match profile::left_in(code) {
            Some(left) => format!("`{}`: no slicer has filled in {}", shown(code), shown(left)),
            None => return,
        },
        _ => return,
    };
    found.add(Finding::of(Code::MissingNumber, 1.0, "lines", text).at(place));
}

/// Whether the word is a letter and a number of at most [`MOST_DIGITS`]: those are judged as commands.
fn is_numbered(word: &str) -> bool {
    let Some(number) = word.strip_prefix(|c: char| c.is_ascii_alphabetic()) else { return false };
    let digits = number.chars().take_while(char::is_ascii_digit).count();
    (1..=MOST_DIGITS).contains(&digits)
}
