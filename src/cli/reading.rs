//! G-code file and `--firmware`, `--max-moves`, `-p` -> the file, open, and by whose rules it is read.

use super::input;
use clap::Args;
use clap::builder::PossibleValuesParser;
use slicer::profile::{self, Settings};
use slicer::reader::{Cause, DEFAULT_MAX_MOVES, Error, Firmware, Print, Reading, Source};
use std::ffi::OsStr;
use std::io;

/// How a G-code file is read.
#[derive(Debug, Args)]
#[command(next_help_heading = "Reading")]
pub(crate) struct ReadingArgs {
    /// Read G-code by this firmware's rules [default: the profile's, else what the file says it is for]
    #[arg(hide_short_help = true, long, value_name = "NAME", value_parser = PossibleValuesParser::new(Firmware::NAMES))]
    firmware: Option<String>,
    /// Refuse a file with more moves; all lines count that are no comments
    #[arg(hide_short_help = true, long, value_name = "N", default_value_t = DEFAULT_MAX_MOVES, value_parser = clap::value_parser!(u64).range(1..))]
    max_moves: u64,
}

/// A G-code file that is open.
pub(super) struct Opened {
    /// For messages.
    pub(super) name: String,
    pub(super) source: Source,
    /// What it says of how it is to be read.
    pub(super) says: Reading,
    /// Its end, where settings stand.
    tail: Vec<u8>,
}

impl Opened {
    /// The settings at its end.
    ///
    /// # Errors
    /// What reading bytes in memory gives, which is nothing.
    pub(super) fn values(&self) -> io::Result<Vec<(String, String)>> {
        values(&self.tail)
    }

    /// The error of a file that cannot be read on.
    pub(super) fn unreadable(&self, error: io::Error) -> Error {
        Cause::Unreadable(error).of(&self.name)
    }
}

impl ReadingArgs {
    /// Opens a file, `-` being standard input.
    ///
    /// # Errors
    /// [`Cause::Unreadable`], [`Cause::Device`], [`Cause::TooLong`] of standard input.
    pub(super) fn open(&self, file: &OsStr) -> Result<Opened, Error> {
        let (name, source) = input::open(file, self.max_moves)?;
        let [head, tail] = source.ends().map_err(|error| Cause::Unreadable(error).of(&name))?;
        let says = Reading::of_parts(&head, &tail);
        let says = told(says, &tail);
        Ok(Opened { name, source, says, tail })
    }

    /// By whose rules a file is read: those of the flag, else those of the machine that `-p` names, else
    /// what the file `says`.
    pub(super) fn of(&self, machine: Option<&Settings>, says: Reading) -> Reading {
        let own = machine.map(input::firmware);
        let told = self.firmware.as_deref().and_then(Firmware::named).map(|told| match own {
            // The profile knows more of the same firmware.
            Some(own) if own.name() == told.name() => own,
            _ => told,
        });
        let by_machine = machine.map_or(0.0, |settings| settings.filament.diameter);
        let volumes = says.volumes.map(|says| if says > 0.0 { says } else { by_machine });
        Reading { firmware: told.or(own).unwrap_or(says.firmware), volumes }
    }
}

/// The settings in comments at a file's end.
fn values(tail: &[u8]) -> io::Result<Vec<(String, String)>> {
    Print::read(&mut &tail[..], 1.0).map(|end| end.facts.values)
}

/// What a file `says`, with what its own settings at its end know of its firmware: how far and how fast
/// an Ultimaker 2 retracts.
fn told(says: Reading, tail: &[u8]) -> Reading {
    if !matches!(says.firmware, Firmware::Ultimaker(_)) {
        return says;
    }
    let values = values(tail).map(|values| profile::renewed(&values));
    let own = values.ok().and_then(|values| profile::recorded(&values).ok().flatten());
    let own = own.map(|own| input::firmware(&own.settings));
    let own = own.filter(|own| own.name() == says.firmware.name());
    Reading { firmware: own.unwrap_or(says.firmware), ..says }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn settings_are_whole_wherever_in_the_file_they_begin() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gcode");
        let settings = "; settings_format = 2\n; machine.dialect = \"klipper\"\n; speed.z = 5\n";
        let args = ReadingArgs { firmware: None, max_moves: 1_000_000 };
        for around in [100, Reading::HEAD, Reading::TAIL, Reading::HEAD + Reading::TAIL] {
            for before in [0, 10, 23, 30, 50, settings.len()] {
                let fill = around - before;
                let text = "G1 X1\n".repeat(fill / 6) + &"\n".repeat(fill % 6) + settings;
                fs::write(&path, text).unwrap();
                let opened = args.open(path.as_os_str()).unwrap();
                assert_eq!(opened.says.firmware, Firmware::Klipper, "{around} {before}");
                assert_eq!(opened.values().unwrap().len(), 3, "{around} {before}");
            }
        }
    }
}
