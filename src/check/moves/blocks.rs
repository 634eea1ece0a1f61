//! Commands in the file's order -> findings of what start and end blocks leave out: homing, and heaters off.
//!
//! - *Homed* is an axis that was sent to its end stop, or whose place was told (G92, M132), before the first
//!   line of a layer. Without it the machine does not know where the bed is.
//! - *Left on* is a heater that is set to a temperature when the file ends: its plastic chars in the nozzle, and
//!   nobody may be there.
//!
//! Some files leave that to others, and are not blamed: an Ultimaker 2 homes and heats by itself;
//! RepRapFirmware runs files of its own before and after a print, refuses moves of axes that are not
//! homed (a warning tells of that), and switches heaters off; and a macro, which is any command that the reader
//! does not know, may do all of it.

use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::terms::Terms;
use crate::profile::DialectName;
use crate::reader::print::{Note, Order, What};
use crate::reader::{Facts, Firmware, Heater, Heating};

/// Words of Klipper that neither home nor heat, by how they begin.
const NO_MACROS: &[&str] = &[
    "BED_MESH_",
    "EXCLUDE_OBJECT",
    "RESPOND",
    "RESTORE_GCODE_STATE",
    "SAVE_GCODE_STATE",
    "SET_",
    "SKEW_PROFILE",
    "TIMELAPSE_",
];

/// What the blocks have done so far.
#[derive(Default)]
pub(crate) struct Blocks {
    /// Whether the printer homes and heats by itself, and whether it has files of its own for that.
    by_printer: bool,
    has_own_files: bool,
    homed: [bool; 3],
    /// Whether a macro came before the first line of a layer, or since the last.
    has_macro: bool,
    has_begun: bool,
    /// The tool in use, if it is known.
    tool: Option<u32>,
    /// Whether some command says whose nozzle it heats. Where none does, all tools share one.
    names_tools: bool,
    /// What nozzles, by their tools, and the bed are set to, °C, and where.
    nozzles: Vec<(Option<u32>, f64, Place)>,
    bed: Option<(f64, Place)>,
}

impl Blocks {
    /// `by_printer` tells whether the printer homes and heats by itself.
    pub(crate) fn new(facts: &Facts, terms: &Terms, by_printer: bool) -> Self {
        let dialect = terms.machine.as_ref().map(|machine| machine.dialect);
        let is_rrf = dialect == Some(DialectName::Reprapfirmware)
            || matches!(facts.summary.firmware, Firmware::RepRap);
        let by_printer = by_printer || dialect == Some(DialectName::Ultigcode);
        Self { by_printer, has_own_files: is_rrf, ..Self::default() }
    }

    /// A command at a place.
    pub(crate) fn note(&mut self, note: &Note, place: Place) {
        match &note.what {
            What::Heating(heating) => self.heat(heating, place),
            What::Unknown(code) => self.has_macro |= may_be_macro(code),
            What::Command(order) => self.command(order),
            What::FirmwareRetraction { .. } | What::NoNumber { .. } => {}
        }
    }

    /// Another tool is in use from here on.
    pub(crate) fn tool(&mut self, tool: u32) {
        self.tool = Some(tool);
    }

    fn heat(&mut self, heating: &Heating, place: Place) {
        let Some(celsius) = heating.celsius else { return };
        match heating.heater {
            Heater::Bed => self.bed = Some((celsius, place)),
            Heater::Nozzle(named) => {
                self.names_tools |= named.is_some();
                let tool = named.or(self.tool);
                // Whose tool nobody tells is any.
                let is_it = |other: Option<u32>| tool.is_none() || other.is_none() || tool == other;
                self.nozzles.retain(|(other, ..)| !is_it(*other));
                self.nozzles.push((tool, celsius, place));
            }
            Heater::All => {}
        }
    }

    fn command(&mut self, order: &Order) {
        match (order.letter, order.number) {
            (b'G', 28 | 92 | 161 | 162) | (b'M', 132) => {
                let all = !b"XYZEAB".iter().any(|&axis| order.has(axis));
                for (axis, homed) in b"XYZ".iter().zip(&mut self.homed) {
                    *homed |= all || order.has(*axis);
                }
            }
            // Deltas and probes.
            (b'G', 30) => self.homed[2] = true,
            // A file of RepRapFirmware's user; the power goes off; the build ends.
            (b'M', 98) => self.has_macro = true,
            (b'M', 81 | 112 | 137) => (self.nozzles, self.bed) = (Vec::new(), None),
            _ => {}
        }
    }

    /// A line of a layer comes next, at this place.
    pub(crate) fn line(&mut self, place: impl FnOnce() -> Place, found: &mut Findings) {
        if !self.has_begun && !self.by_printer && !self.has_macro {
            found.extend(self.not_homed().map(|one| one.at(place())));
        }
        (self.has_begun, self.has_macro) = (true, false);
    }

    fn not_homed(&self) -> Option<Finding> {
        let missing: Vec<&str> = (["x", "y", "z"].into_iter().zip(self.homed))
            .filter_map(|(axis, homed)| (!homed).then_some(axis))
            .collect();
        let count = missing.len();
        let text = format!(
            "the print begins without homing {}: no G28 and no macro stands before it",
            missing.join(", ")
        );
        let one = if self.has_own_files { Finding::warning } else { Finding::of };
        (count > 0).then(|| one(Code::NotHomed, count as f64, "axes", text))
    }

    /// The file ends.
    pub(crate) fn finish(self, found: &mut Findings) {
        if self.by_printer || self.has_own_files || self.has_macro || !self.has_begun {
            return;
        }
        let text = |what: &str, celsius: f64, off: &str| {
            let celsius = short(celsius);
            format!(
                "the {what} is still set to {celsius} °C when the file ends; {off} switches it off"
            )
        };
        let count = if self.names_tools { self.nozzles.len() } else { 1 };
        let last = self.nozzles.into_iter().rev().take(count);
        for (_, celsius, place) in last.filter(|(_, celsius, _)| *celsius > 0.0) {
            let text = text("nozzle", celsius, "M104 S0");
            found.add(Finding::of(Code::LeftOn, celsius, "°C", text).at(place));
        }
        if let Some((celsius, place)) = self.bed.filter(|(celsius, _)| *celsius > 0.0) {
            let text = text("bed", celsius, "M140 S0");
            found.add(Finding::warning(Code::LeftOn, celsius, "°C", text).at(place));
        }
    }
}

/// Whether code that the reader does not know may be a macro, which homes and heats.
pub(crate) fn may_be_macro(code: &str) -> bool {
    let word = code.split_whitespace().next().unwrap_or_default().to_ascii_uppercase();
    let is_named = word.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    is_named && !NO_MACROS.iter().any(|begin| word.starts_with(begin))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_unknown_word_may_be_a_macro() {
        for (code, expected) in [
            ("PRINT_START BED=60", true),
            ("G9111 bedTemp=60", true),
            ("END_PRINT", true),
            ("TURN_OFF_HEATERS", true),
            ("SET_GCODE_OFFSET Z=0.1", false),
            ("exclude_object_define NAME=a", false),
            ("T[initial_tool]", false),
        ] {
            assert_eq!(may_be_macro(code), expected, "{code}");
        }
    }
}
