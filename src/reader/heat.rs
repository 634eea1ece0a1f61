//! Code -> Heating: which heater is set to what temperature, and which is waited for.
//!
//! M109 and M190 wait for the temperature that they name. Where its number is missing nothing is waited
//! for; where they name none, Marlin from 1.1 on and Klipper wait for nothing, and older firmwares for what
//! was set before.

use super::{Firmware, words};

/// The least temperature that a P tells, °C.
const LEAST_BY_P: f64 = 50.0;

/// Something that gets hot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heater {
    /// The nozzle of this tool; `None` is the one in use.
    Nozzle(Option<u32>),
    /// The bed.
    Bed,
    /// All heaters that are on.
    All,
}

/// A command for a heater.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heating {
    /// Which one.
    pub heater: Heater,
    /// How hot it shall be, °C; `None` leaves it as it is.
    pub celsius: Option<f64>,
    /// Whether the print goes on only when it is hot.
    pub waits: bool,
}

/// The command for a heater that `code` is in Marlin, Sailfish or Klipper, if it is one, as this firmware
/// takes it.
pub(super) fn heating(code: &[u8], firmware: Firmware) -> Option<Heating> {
    // Nearly all lines are moves.
    if code[0].eq_ignore_ascii_case(&b'G') {
        return None;
    }
    let Some((command, words)) = words::command(code) else { return klipper(code) };
    if command.letter != b'M' || command.has_part {
        return None;
    }
    let (mut celsius, mut tool, mut names_none) = (None, None, true);
    for (letter, value) in words {
        match letter {
            b'S' | b'R' => (celsius, names_none) = (value, false),
            // Machinekit's and Mach's; a smaller number is no temperature.
            b'P' if celsius.is_none() => celsius = value.filter(|value| *value >= LEAST_BY_P),
            b'T' => tool = value.filter(|value| *value >= 0.0).map(|value| value as u32),
            _ => {}
        }
    }
    let set = |heater, waits| Some(Heating { heater, celsius, waits });
    let waits_bare = !matches!(firmware, Firmware::Marlin | Firmware::Klipper);
    let is_computed = matches!(firmware, Firmware::RepRap);
    let waits = celsius.is_some() || is_computed || names_none && waits_bare;
    // M6, M116, M133 and M134 only wait.
    let wait = |heater| Some(Heating { heater, celsius: None, waits: true });
    match command.number {
        104 => set(Heater::Nozzle(tool), false),
        109 => set(Heater::Nozzle(tool), waits),
        140 => set(Heater::Bed, false),
        190 => set(Heater::Bed, waits),
        133 => wait(Heater::Nozzle(tool)),
        134 => wait(Heater::Bed),
        6 | 116 => wait(Heater::All),
        _ => None,
    }
}

/// The temperature that a G10 of RepRapFirmware with these words sets for a tool, if it does.
pub(super) fn of_tool(words: words::Words<'_>) -> Option<Heating> {
    let (mut celsius, mut tool) = (None, None);
    for (letter, value) in words {
        match letter {
            b'L' => return None,
            b'S' => celsius = value,
            b'P' => tool = value.filter(|value| *value >= 0.0).map(|value| value as u32),
            _ => {}
        }
    }
    let heater = Heater::Nozzle(tool);
    celsius.map(|_| Heating { heater, celsius, waits: false })
}

/// SET_HEATER_TEMPERATURE and TEMPERATURE_WAIT.
fn klipper(code: &[u8]) -> Option<Heating> {
    let mut words = code.split(u8::is_ascii_whitespace);
    let waits = match words.next()?.to_ascii_uppercase().as_slice() {
        b"SET_HEATER_TEMPERATURE" => false,
        b"TEMPERATURE_WAIT" => true,
        _ => return None,
    };
    let (mut heater, mut celsius) = (None, None);
    for word in words {
        let mut halves = word.splitn(2, |&byte| byte == b'=');
        let (Some(name), Some(value)) = (halves.next(), halves.next()) else { continue };
        match name.to_ascii_uppercase().as_slice() {
            b"HEATER" | b"SENSOR" if value == b"heater_bed" => heater = Some(Heater::Bed),
            b"HEATER" | b"SENSOR" if value == b"extruder" => heater = Some(Heater::Nozzle(None)),
            b"TARGET" | b"MINIMUM" => celsius = words::number(value).0,
            _ => {}
        }
    }
    // A wait names a threshold, not a target.
    Some(Heating { heater: heater?, celsius: celsius.filter(|_| !waits), waits })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_firmware_has_its_words() {
        let of = |code: &str| heating(code.as_bytes(), Firmware::Other);
        let nozzle =
            |tool, celsius, waits| Some(Heating { heater: Heater::Nozzle(tool), celsius, waits });
        assert_eq!(of("M104 S200 T1"), nozzle(Some(1), Some(200.0), false));
        assert_eq!(of("M109 R210"), nozzle(None, Some(210.0), true));
        assert_eq!(of("M133 T0"), nozzle(Some(0), None, true));
        assert_eq!(of("M6 T1"), Some(Heating { heater: Heater::All, celsius: None, waits: true }));
        let klipper = "SET_HEATER_TEMPERATURE HEATER=extruder TARGET=205";
        assert_eq!(of(klipper), nozzle(None, Some(205.0), false));
        assert_eq!(of("temperature_wait sensor=extruder minimum=200"), nozzle(None, None, true));
        // What names no number waits for nothing, as some firmwares do where no number is asked for.
        for code in ["M109 S", "M109 S[first_layer_temperature]", "M109 S{temperature}"] {
            assert_eq!(of(code), nozzle(None, None, false), "{code}");
        }
        assert_eq!(of("M109"), nozzle(None, None, true));
        assert_eq!(heating(b"M109", Firmware::Marlin), nozzle(None, None, false));
        let computed = heating(b"M109 S{global.heat}", Firmware::RepRap);
        assert_eq!(computed, nozzle(None, None, true));
        assert_eq!(of("M107"), None);
        assert_eq!(of("START_PRINT EXTRUDER=200"), None);
    }
}
