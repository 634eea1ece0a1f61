//! Path -> bytes of a G-code file, from a file or from standard input.

use slicer::profile::{DialectName, Settings};
use slicer::reader::{Cause, Error, Firmware, OwnFilament, Source};
use slicer::units::MmPerS;
use std::fs::File;
use std::io::{BufRead, BufReader, Read as _};

/// Bytes that are read at once.
pub(super) const BUFFER: usize = 1 << 18;

/// Opens a file, `-` being standard input; gives its name for messages, too.
///
/// # Errors
/// [`Cause::Unreadable`].
pub(super) fn open(file: &str) -> Result<(&str, Box<dyn BufRead>), Error> {
    if file == "-" {
        let source = BufReader::with_capacity(BUFFER, std::io::stdin());
        return Ok(("<stdin>", Box::new(source)));
    }
    let source = File::open(file).map_err(|error| Cause::Unreadable(error).of(file))?;
    Ok((file, Box::new(BufReader::with_capacity(BUFFER, source))))
}

/// Opens a file that is read more than once, `-` being standard input; gives its name for messages,
/// too.
///
/// # Errors
/// [`Cause::Unreadable`].
pub(super) fn again(file: &str) -> Result<(&str, Source), Error> {
    let (name, source) = if file == "-" {
        ("<stdin>", Source::spooled(&mut std::io::stdin().lock()))
    } else {
        (file, File::open(file).and_then(Source::of_file))
    };
    Ok((name, source.map_err(|error| Cause::Unreadable(error).of(name))?))
}

/// A whole file and its name for messages.
///
/// # Errors
/// [`Cause::Unreadable`].
pub(super) fn read(file: &str) -> Result<(&str, Vec<u8>), Error> {
    let (name, mut source) = open(file)?;
    let mut bytes = Vec::new();
    source.read_to_end(&mut bytes).map_err(|error| Cause::Unreadable(error).of(name))?;
    Ok((name, bytes))
}

/// The firmware by whose rules files for a machine are read.
pub(super) fn firmware(settings: &Settings) -> Firmware {
    match settings.machine.dialect {
        DialectName::Marlin => Firmware::Marlin,
        DialectName::Klipper | DialectName::Makerbot | DialectName::Reprapfirmware => {
            Firmware::Other
        }
        DialectName::Ultigcode => Firmware::Ultimaker(OwnFilament {
            diameter: settings.filament.diameter,
            retraction: settings.retraction.length,
            speed: MmPerS(settings.retraction.speed),
        }),
    }
}
