//! Bytes of a G-code file -> Codes: commands besides moves, layer by layer.
//!
//! Words used here: a *code* is a command besides moves; *orders* are the codes of a layer, those for
//! heaters and all others; commands that moves and times already show, or that only inform, are left
//! out ([`SHOWN_ELSEWHERE`]).
//!
//! Files write the same command in different ways: with a line number and checksum, in lower case,
//! with zeros. Each code is brought to one form: no comment, letters in upper case, numbers in their
//! shortest form; commands for heaters as the reader understands them.
//!
//! Slicers do not agree on where the first layer begins and the last ends, so what comes before the
//! first line of all and after the last one are places of their own. Within a layer the order of
//! codes matters, their place between the lines does not. What stands between the last line of one
//! layer and the first of the next belongs to the next.

use super::sums::Both;
use crate::reader::print::{Note, What};
use crate::reader::{self, Heater, Heating};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{self, BufRead};

/// Commands that moves and their times already show (positions, units, dwells, retractions, limits)
/// or that only inform (progress, reports, messages).
const SHOWN_ELSEWHERE: &[&str] = &[
    "G0",
    "G1",
    "G2",
    "G3",
    "G4",
    "G10",
    "G11",
    "G20",
    "G21",
    "G90",
    "G91",
    "G92",
    "M73",
    "M82",
    "M83",
    "M105",
    "M110",
    "M117",
    "M118",
    "M201",
    "M203",
    "M204",
    "M205",
    "M220",
    "M566",
    "SET_VELOCITY_LIMIT",
];

/// A command besides moves.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Code {
    /// Line of the file, from 1.
    line: u64,
    /// In the same form for all files.
    text: String,
    /// Whether it is for a heater.
    heats: bool,
}

/// Commands in a layer of one file but not of the other.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct CodeDifference {
    /// Those of only one file, in its order.
    pub only: Both<Vec<String>>,
    /// The first line of the file where that is, from 1.
    pub line: Both<Option<u64>>,
}

/// A setting in the comments that differs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Setting {
    /// Its name.
    pub key: String,
    /// Its values; `None` where a file does not have it.
    pub value: Both<Option<String>>,
}

/// Commands that differ in one place of both files.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, JsonSchema)]
pub struct Orders {
    /// For heaters.
    pub heaters: Option<CodeDifference>,
    /// All others.
    pub commands: Option<CodeDifference>,
}

/// Codes of a file that are kept: more than any slicer writes.
const MOST_CODES: usize = 50_000;

/// Longest code that is kept, bytes.
const LONGEST: usize = 512;

/// The codes of a file by place.
#[derive(Debug, Default)]
pub(super) struct Codes {
    /// First those before the first line of all, then those of each layer, last those after the last.
    layers: Vec<Vec<Code>>,
    /// How many there are beyond [`MOST_CODES`], and a sum of all their letters, which is another
    /// where they differ.
    more: u64,
    sum: u64,
}

/// A command for a heater.
#[derive(Debug, Clone)]
pub(super) struct Heat {
    line: u64,
    text: String,
}

impl Code {
    /// One that is not for a heater.
    pub(super) fn new(line: u64, text: String) -> Self {
        Self { line, text, heats: false }
    }
}

impl Heat {
    /// The command of a note, if it is for a heater.
    pub(super) fn of(note: &Note) -> Option<Self> {
        let What::Heating(heating) = note.what else { return None };
        Some(Self { line: note.line, text: heater(heating) })
    }
}

/// Where codes belong: the file's lines, from 1, at which places begin.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// For each layer the last line before it that extrudes.
    pub(super) before: Vec<u32>,
    /// The first line and the last line that extrude in a layer; `None` without one.
    pub(super) lines: Option<[u32; 2]>,
}

impl Places {
    /// The place of a code: 0 before the first line, else the layer, and one more after the last.
    fn of(&self, line: u64) -> usize {
        match self.lines {
            Some([first, last]) if line > u64::from(first) => {
                let layer = self.before.partition_point(|before| u64::from(*before) < line);
                if line > u64::from(last) { self.before.len() + 1 } else { layer }
            }
            _ => 0,
        }
    }
}

impl Codes {
    /// Gathers the codes of a file. `heats` are those for heaters, in the file's order.
    ///
    /// # Errors
    /// What reading gives.
    pub(super) fn read(
        source: &mut dyn BufRead,
        heats: &[Heat],
        places: &Places,
    ) -> io::Result<Self> {
        let layers = vec![Vec::new(); places.before.len() + 2];
        let mut codes = Self { layers, ..Self::default() };
        let (mut line, mut kept) = (0, 0);
        let mut heats = heats.iter().peekable();
        reader::lines(source, &mut |bytes| {
            line += 1;
            let heat = heats.next_if(|heat| heat.line == line);
            // Nearly all lines are moves.
            if matches!(bytes, [b'G', b'0'..=b'3', b' ', ..] | [b';', ..] | []) {
                return;
            }
            let text = match heat {
                Some(heat) => Some(heat.text.clone()),
                None => plain(&bytes[..bytes.len().min(LONGEST)]).filter(|text| {
                    !SHOWN_ELSEWHERE.contains(&text.split(' ').next().unwrap_or_default())
                }),
            };
            let Some(text) = text else { return };
            kept += 1;
            if kept > MOST_CODES {
                return codes.add_more(&text);
            }
            codes.layers[places.of(line)].push(Code { line, text, heats: heat.is_some() });
        })?;
        Ok(codes)
    }

    /// Those of a place: 0 is before the first line.
    pub(super) fn of(&self, place: Option<usize>) -> &[Code] {
        place.and_then(|place| self.layers.get(place)).map_or(&[], Vec::as_slice)
    }

    /// Those after the last line.
    pub(super) fn last(&self) -> &[Code] {
        self.layers.last().map_or(&[], Vec::as_slice)
    }

    /// Counts a code that is not kept, by the sum of Fowler, Noll and Vo (FNV-1a).
    fn add_more(&mut self, text: &str) {
        self.more += 1;
        for byte in text.bytes().chain([b'\n']) {
            self.sum = (self.sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// The commands that differ after the last line; beside them those beyond what is kept, if they do.
pub(super) fn end(codes: Both<&Codes>) -> Orders {
    let mut orders = orders(codes.map(Codes::last));
    if (codes.a.more, codes.a.sum) != (codes.b.more, codes.b.sum) {
        let more = codes.map(|codes| vec![format!("{} more that are not listed", codes.more)]);
        let none = CodeDifference { only: Both::default(), line: Both::default() };
        let commands = orders.commands.get_or_insert(none);
        commands.only.a.extend(more.a);
        commands.only.b.extend(more.b);
    }
    orders
}

/// The code of a line without its number, comment and checksum, numbers in their shortest form.
fn plain(line: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(line);
    let code = text.split(';').next().unwrap_or_default();
    let mut words = code.split_whitespace().peekable();
    let number =
        |word: &&str| word.strip_prefix(['N', 'n']).is_some_and(|rest| rest.parse::<u64>().is_ok());
    let numbered = words.next_if(number).is_some();
    let mut text = String::new();
    for word in words {
        let word = if numbered { word.split('*').next().unwrap_or_default() } else { word };
        if !text.is_empty() {
            text.push(' ');
        }
        text.push_str(&shortest(word));
    }
    (!text.is_empty() && !text.starts_with(['(', '%'])).then_some(text)
}

/// `M106` for `m0106`, `S255` for `S255.0`; anything else as it is.
fn shortest(word: &str) -> String {
    let mut rest = word.chars();
    let letter = rest.next().filter(char::is_ascii_alphabetic);
    let is_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+');
    let number = Some(rest.as_str()).filter(|rest| rest.chars().all(is_number));
    match (letter, number.and_then(|number| number.parse::<f64>().ok())) {
        (Some(letter), Some(number)) => format!("{}{number}", letter.to_ascii_uppercase()),
        _ => word.to_owned(),
    }
}

fn heater(Heating { heater, celsius, waits }: Heating) -> String {
    let name = match heater {
        Heater::Nozzle(None) => "nozzle".to_owned(),
        Heater::Nozzle(Some(tool)) => format!("nozzle {tool}"),
        Heater::Bed => "bed".to_owned(),
        Heater::All => "all heaters".to_owned(),
    };
    let wait = if waits { " waited for" } else { "" };
    celsius.map_or_else(|| format!("{name}{wait}"), |celsius| format!("{name} {celsius} °C{wait}"))
}

/// The commands that differ in one place of both files.
pub(super) fn orders(codes: Both<&[Code]>) -> Orders {
    Orders { heaters: difference(codes, true), commands: difference(codes, false) }
}

/// The codes of a layer that differ: for heaters, or all others. The same codes in another order
/// differ, too: then all are listed.
fn difference(codes: Both<&[Code]>, heats: bool) -> Option<CodeDifference> {
    let codes = codes.map(|codes| codes.iter().filter(|code| code.heats == heats));
    let codes = codes.map(Iterator::collect::<Vec<&Code>>);
    if codes.a.iter().map(|code| &code.text).eq(codes.b.iter().map(|code| &code.text)) {
        return None;
    }
    let mut only = Both { a: rest(&codes.a, &codes.b), b: rest(&codes.b, &codes.a) };
    if only.a.is_empty() && only.b.is_empty() {
        only = codes;
    }
    Some(named(&only))
}

/// The codes that only one of the files has, in whatever order.
pub(super) fn only_in(codes: Both<&[Code]>) -> Option<CodeDifference> {
    let codes = codes.map(|codes| codes.iter().collect::<Vec<&Code>>());
    let only = Both { a: rest(&codes.a, &codes.b), b: rest(&codes.b, &codes.a) };
    (!only.a.is_empty() || !only.b.is_empty()).then(|| named(&only))
}

fn named(only: &Both<Vec<&Code>>) -> CodeDifference {
    let only = only.as_ref();
    CodeDifference {
        line: only.map(|codes| codes.first().map(|code| code.line)),
        only: only.map(|codes| codes.iter().map(|code| code.text.clone()).collect()),
    }
}

/// The first codes without as many of the same as there are among the others.
fn rest<'a>(codes: &[&'a Code], others: &[&Code]) -> Vec<&'a Code> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    others.iter().for_each(|code| *counts.entry(&code.text).or_default() += 1);
    let is_left = |code: &&&Code| match counts.get_mut(code.text.as_str()) {
        Some(count) if *count > 0 => {
            *count -= 1;
            false
        }
        _ => true,
    };
    codes.iter().filter(is_left).copied().collect()
}

/// The settings in the comments that differ, by name. Of several with a name the last holds.
pub(super) fn settings(a: &[(String, String)], b: &[(String, String)]) -> Vec<Setting> {
    let all = |values: &[(String, String)]| -> BTreeMap<String, String> {
        values.iter().cloned().collect()
    };
    let (a, b) = (all(a), all(b));
    let keys: std::collections::BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    let differs = keys.into_iter().filter(|key| a.get(*key) != b.get(*key));
    let setting = |key: &String| Setting {
        key: key.clone(),
        value: Both { a: a.get(key).cloned(), b: b.get(key).cloned() },
    };
    differs.map(setting).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_brought_to_one_form() {
        for (line, expected) in [
            ("M106 S255.0 ; fan", Some("M106 S255")),
            ("N7 m0106  S127.5*33", Some("M106 S127.5")),
            ("EXCLUDE_OBJECT NAME=a*b", Some("EXCLUDE_OBJECT NAME=a*b")),
            ("  ; talk", None),
            ("(talk)", None),
        ] {
            assert_eq!(plain(line.as_bytes()).as_deref(), expected, "{line}");
        }
    }
}
