//! `--firmware`, profile and what a file says of itself -> by whose rules the file is read.

use super::input;
use clap::Args;
use clap::builder::PossibleValuesParser;
use slicer::profile::Settings;
use slicer::reader::{Cause, Error, Firmware, Reading};
use std::fs::File;
use std::io::{self, BufRead, Cursor, Read as _, Seek as _, SeekFrom};

/// How a G-code file is read.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Reading")]
pub(crate) struct ReadingArgs {
    /// Read G-code by this firmware's rules [default: the profile's, else what the file says it is for]
    #[arg(hide_short_help = true, long, value_name = "NAME", value_parser = PossibleValuesParser::new(Firmware::NAMES))]
    firmware: Option<String>,
}

impl ReadingArgs {
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

    /// As [`input::open`], with how the file is read.
    ///
    /// # Errors
    /// [`Cause::Unreadable`].
    pub(super) fn open<'a>(
        &self,
        file: &'a str,
        machine: Option<&Settings>,
    ) -> Result<(&'a str, Box<dyn BufRead>, Reading), Error> {
        let (name, mut source) = input::open(file)?;
        let mut head = Vec::new();
        source
            .by_ref()
            .take(Reading::HEAD as u64)
            .read_to_end(&mut head)
            .map_err(|error| Cause::Unreadable(error).of(name))?;
        let is_whole = file == "-" || head.len() < Reading::HEAD;
        // Standard input cannot be looked at from its end, nor a file that is gone by now.
        let tail = if is_whole { Vec::new() } else { tail(file).unwrap_or_default() };
        let says = Reading::of_parts(&head, &tail);
        Ok((name, Box::new(Cursor::new(head).chain(source)), self.of(machine, says)))
    }
}

/// What stands at the file's end, but not within its first [`Reading::HEAD`] bytes.
fn tail(file: &str) -> io::Result<Vec<u8>> {
    let mut file = File::open(file)?;
    let about = file.metadata()?;
    let mut bytes = Vec::new();
    if about.is_file() {
        let begin = about.len().saturating_sub(Reading::TAIL as u64).max(Reading::HEAD as u64);
        file.seek(SeekFrom::Start(begin))?;
        file.take(Reading::TAIL as u64).read_to_end(&mut bytes)?;
    }
    Ok(bytes)
}
