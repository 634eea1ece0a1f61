//! Path -> source of a G-code file, from a file or from standard input, which ends.

use slicer::profile::{DialectName, Settings};
use slicer::reader::{Cause, Error, Firmware, OwnFilament, Source};
use slicer::text;
use slicer::units::MmPerS;
use std::ffi::OsStr;
use std::fs::File;

/// Opens a file with at most so many moves, `-` being standard input; gives its name for messages, too.
///
/// # Errors
/// [`Cause::Unreadable`], [`Cause::Device`], [`Cause::TooLong`] of what comes from a pipe.
pub(super) fn open(file: &OsStr, most_moves: u64) -> Result<(String, Source), Error> {
    if file == "-" {
        let name = "<stdin>".to_owned();
        if is_endless_stdin() {
            return Err(Cause::Device.of(&name));
        }
        let source = Source::spooled(&mut std::io::stdin(), most_moves);
        let source = source.map_err(|error| Cause::Unreadable(error).of(&name))?;
        return Ok((name, source));
    }
    let name = text::name(file);
    let unreadable = |error| Cause::Unreadable(error).of(&name);
    let opened = File::open(file).map_err(unreadable)?;
    if is_device(&opened) {
        return Err(Cause::Device.of(&name));
    }
    let source = Source::of_file(opened, most_moves).map_err(unreadable)?;
    Ok((name, source))
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

/// The firmware by whose rules files for a machine are read.
pub(super) fn firmware(settings: &Settings) -> Firmware {
    match settings.machine.dialect {
        DialectName::Marlin => Firmware::Marlin,
        DialectName::Klipper => Firmware::Klipper,
        DialectName::Makerbot => Firmware::Sailfish,
        DialectName::Reprapfirmware => Firmware::RepRap,
        DialectName::Ultigcode => Firmware::Ultimaker(OwnFilament {
            diameter: settings.filament.diameter,
            retraction: settings.retraction.length,
            speed: MmPerS(settings.retraction.speed),
        }),
    }
}
