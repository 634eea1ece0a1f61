//! Path -> bytes of a G-code file, from a file or from standard input, which ends.

use clap::Args;
use slicer::profile::{DialectName, Settings};
use slicer::reader::{Cause, DEFAULT_MAX_MOVES, Error, Firmware, Limited, OwnFilament};
use slicer::text;
use slicer::units::MmPerS;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{BufRead, BufReader, Read as _};

/// Bytes that are read at once.
pub(super) const BUFFER: usize = 1 << 18;

/// How much of a G-code file is read.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct LimitArgs {
    /// Refuse a file with more moves; all lines count that are no comments
    #[arg(hide_short_help = true, long, value_name = "N", default_value_t = DEFAULT_MAX_MOVES, value_parser = clap::value_parser!(u64).range(1..))]
    max_moves: u64,
}

/// Opens a file, `-` being standard input; gives its name for messages, too.
///
/// # Errors
/// [`Cause::Unreadable`], [`Cause::Device`].
pub(super) fn open(file: &OsStr, limit: LimitArgs) -> Result<(String, Box<dyn BufRead>), Error> {
    if file == "-" {
        let name = "<stdin>".to_owned();
        if is_endless_stdin() {
            return Err(Cause::Device.of(&name));
        }
        let source = BufReader::with_capacity(BUFFER, std::io::stdin());
        return Ok((name, Box::new(Limited::new(source, limit.max_moves))));
    }
    let name = text::name(file);
    let source = File::open(file).map_err(|error| Cause::Unreadable(error).of(&name))?;
    if is_device(&source) {
        return Err(Cause::Device.of(&name));
    }
    let source = BufReader::with_capacity(BUFFER, source);
    Ok((name, Box::new(Limited::new(source, limit.max_moves))))
}

/// Whether a file is a device, such as /dev/zero. Pipes end when their writer does.
#[cfg(unix)]
fn is_device(file: &File) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    let kind = file.metadata().map(|data| data.file_type());
    kind.is_ok_and(|kind| kind.is_char_device() || kind.is_block_device())
}

/// Whether standard input is a device; a terminal ends when its user says so.
#[cfg(unix)]
fn is_endless_stdin() -> bool {
    use std::io::IsTerminal as _;
    use std::os::fd::AsFd as _;
    let stdin = std::io::stdin();
    let copy = stdin.as_fd().try_clone_to_owned().map(File::from);
    !stdin.is_terminal() && copy.is_ok_and(|file| is_device(&file))
}

#[cfg(not(unix))]
fn is_device(_: &File) -> bool {
    false
}

#[cfg(not(unix))]
fn is_endless_stdin() -> bool {
    false
}

/// A whole file and its name for messages.
///
/// # Errors
/// As [`open`], and [`Cause::TooLong`].
pub(super) fn read(file: &OsStr, limit: LimitArgs) -> Result<(String, Vec<u8>), Error> {
    let (name, mut source) = open(file, limit)?;
    let mut bytes = Vec::new();
    source.read_to_end(&mut bytes).map_err(|error| Cause::Unreadable(error).of(&name))?;
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
