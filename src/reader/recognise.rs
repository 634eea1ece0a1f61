//! A file's beginning and end -> which firmware it is for, and whether its E is a volume.
//!
//! Asked in this order; the first that answers counts:
//! - our own settings, `; machine.dialect = "klipper"`;
//! - Cura's `;FLAVOR:RepRap`;
//! - `; gcode_flavor = marlin2`, of PrusaSlicer and those made from it or from Slic3r;
//! - who made it, where that is for one firmware only;
//! - commands that only one firmware has.
//!
//! Klipper's own commands win over a flavour of Marlin: people slice for Klipper by it. Where nobody
//! answers, nothing is known of the firmware.
//!
//! Settings stand at the end of most files, so that whoever reads a stream has to look there first.

use super::firmware::{Firmware, OwnFilament};
use super::words;

/// How a file is to be read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reading {
    /// Whose rules.
    pub firmware: Firmware,
    /// Diameter of the filament by which E is a volume from the first line, mm, 0 being any usual one;
    /// `None` where E is a length until the file says otherwise.
    pub volumes: Option<f64>,
}

impl From<Firmware> for Reading {
    fn from(firmware: Firmware) -> Self {
        Self { firmware, volumes: None }
    }
}

/// Diameters that a filament may have, mm.
const DIAMETERS: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// What a file says, each by the first or last line that does.
#[derive(Default)]
struct Said {
    own: Option<Firmware>,
    flavour: Option<Firmware>,
    key: Option<Firmware>,
    maker: Option<Firmware>,
    /// By commands of Klipper, Sailfish and RepRapFirmware.
    commands: [bool; 3],
    volumes: bool,
    diameter: Option<f64>,
}

impl Reading {
    /// Bytes at a file's beginning that are looked at.
    pub const HEAD: usize = 1 << 18;

    /// Bytes at its end.
    pub const TAIL: usize = 1 << 17;

    /// What a whole file says of itself.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        let head = bytes.len().min(Self::HEAD);
        let tail = bytes.len().saturating_sub(Self::TAIL);
        Self::of_parts(&bytes[..head], &bytes[tail..])
    }

    /// What a file says of itself at its beginning and at its end; lines may be cut, and be in both.
    #[must_use]
    pub fn of_parts(head: &[u8], tail: &[u8]) -> Self {
        let mut said = Said::default();
        for part in [head, tail] {
            part.split(|&byte| byte == b'\n' || byte == b'\r').for_each(|line| said.line(line));
        }
        Self { firmware: said.firmware(), volumes: said.volumes() }
    }
}

impl Said {
    fn line(&mut self, line: &[u8]) {
        let line = line.trim_ascii_start();
        match line.first() {
            Some(b';') => self.comment(line[1..].trim_ascii()),
            Some(_) => self.code(words::split(line).0),
            None => {}
        }
    }

    fn comment(&mut self, text: &[u8]) {
        if let Some(flavour) = text.strip_prefix(b"FLAVOR:") {
            self.volumes |= flavour == b"Marlin(Volumetric)";
            self.flavour = self.flavour.or_else(|| of_flavour(flavour));
        } else if let Some(place) = text.windows(3).take(60).position(|three| three == b" = ") {
            let value = text[place + 3..].trim_ascii();
            let value = value.strip_prefix(b"\"").unwrap_or(value);
            let value = value.strip_suffix(b"\"").unwrap_or(value);
            match &text[..place] {
                b"machine.dialect" => {
                    self.own = std::str::from_utf8(value).ok().and_then(Firmware::named);
                }
                b"gcode_flavor" => self.key = of_key(value),
                b"use_volumetric_e" => self.volumes = value == b"1",
                b"filament_diameter" => self.diameter = words::number(value).0,
                _ => {}
            }
        } else if [&b"ReplicatorG"[..], b"MakerWare", b"Makerware"]
            .iter()
            .any(|maker| text.windows(maker.len()).take(200).any(|part| part == *maker))
        {
            self.maker = Some(Firmware::Sailfish);
        }
    }

    fn code(&mut self, code: &[u8]) {
        let [klipper, sailfish, rrf] = &mut self.commands;
        let Some((command, mut words)) = words::command(code) else {
            let word = code.split(u8::is_ascii_whitespace).next().unwrap_or_default();
            *klipper |= is_of_klipper(word);
            *rrf |= [&b"if"[..], b"while", b"var", b"global", b"echo"].contains(&word);
            return;
        };
        match (command.letter, command.number) {
            // Nearly all lines.
            (b'G', 0..=3) => {}
            (b'G', 130 | 161 | 162) | (b'M', 132 | 133 | 135 | 136 | 137) => *sailfish = true,
            (b'G', 10) => *rrf |= words.any(|(letter, _)| letter == b'P'),
            (b'M', 98 | 563 | 566 | 568 | 572) => *rrf = true,
            _ => {}
        }
    }

    fn firmware(&self) -> Firmware {
        let [klipper, sailfish, rrf] = self.commands;
        let by_commands =
            [(klipper, Firmware::Klipper), (sailfish, Firmware::Sailfish), (rrf, Firmware::RepRap)];
        let by_commands = by_commands.into_iter().find(|(has, _)| *has).map(|(_, one)| one);
        let said = self.flavour.or(self.key);
        let is_marlin = matches!(said, Some(Firmware::Marlin | Firmware::Marlin1));
        let said = said.filter(|_| !(is_marlin && klipper));
        self.own.or(said).or(self.maker).or(by_commands).unwrap_or_default()
    }

    fn volumes(&self) -> Option<f64> {
        let diameter = self.diameter.filter(|one| DIAMETERS.contains(one));
        self.volumes.then(|| diameter.unwrap_or_default())
    }
}

/// Cura's names. UltiMaker's S line (Griffin) is made from Marlin 1.
fn of_flavour(name: &[u8]) -> Option<Firmware> {
    Some(match name {
        b"Marlin" => Firmware::Marlin,
        b"Marlin(Volumetric)" | b"Griffin" => Firmware::Marlin1,
        b"UltiGCode" => Firmware::Ultimaker(OwnFilament::UNTOLD),
        b"RepRap" => Firmware::RepRap,
        b"Repetier" => Firmware::Repetier,
        b"Makerbot" => Firmware::Sailfish,
        b"Smoothie" => Firmware::Smoothie,
        b"Klipper" => Firmware::Klipper,
        _ => return None,
    })
}

/// PrusaSlicer's, OrcaSlicer's and Slic3r's names; `marlin` is Marlin before 2 to them, `reprap` what
/// was before it.
fn of_key(name: &[u8]) -> Option<Firmware> {
    Some(match name {
        b"marlin2" => Firmware::Marlin,
        b"marlin" | b"reprap" => Firmware::Marlin1,
        b"klipper" => Firmware::Klipper,
        b"reprapfirmware" => Firmware::RepRap,
        b"sailfish" | b"makerware" => Firmware::Sailfish,
        b"repetier" => Firmware::Repetier,
        b"smoothie" => Firmware::Smoothie,
        _ => return None,
    })
}

/// Whether it is a command of Klipper or a macro of its users: `START_PRINT`, `BED_MESH_CALIBRATE`.
fn is_of_klipper(word: &[u8]) -> bool {
    word.len() > 4
        && word.contains(&b'_')
        && !word[0].is_ascii_digit()
        && word.iter().all(|byte| byte.is_ascii_alphanumeric() || *byte == b'_')
}
