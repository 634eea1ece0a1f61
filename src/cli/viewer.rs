//! G-code file -> a page to look through all its layers, as `slicer preview` writes it.

use super::input;
use super::output::{self, Sink};
use anyhow::{Context as _, Result};
use slicer::estimate::{self, Options};
use slicer::motion::Limits;
use slicer::preview::html;
use slicer::profile::Settings;
use slicer::reader::{Cause, Print, Reading};
use slicer::warning::plural;
use std::io::Write as _;
use std::path::Path;

/// Writes the page of `file` to `out`; returns a line on what is in it. `reading` tells how it is read,
/// from what it says of itself.
///
/// # Errors
/// A file that cannot be read or holds no move, an output that cannot be written.
pub(super) fn write(
    file: &str,
    out: &Path,
    settings: &Settings,
    reading: &dyn Fn(Reading) -> Reading,
) -> Result<String> {
    let mut sink = Sink::open(out)?;
    let (name, bytes) = input::read(file)?;
    let diameter = settings.filament.diameter;
    let reading = reading(Reading::of(&bytes));
    let (firmware, volumes) = (reading.firmware, reading.volumes);
    let options = Options { filament_diameter: diameter, firmware, volumes, ..Options::default() };
    let estimate = estimate::estimate(&mut &bytes[..], name, &Limits::new(settings), options)?;
    let print = Print::read_as(&mut &bytes[..], reading, diameter)
        .map_err(|error| Cause::Unreadable(error).of(name))?;
    // The file is not needed any more, and may be large.
    drop(bytes);
    let base = Path::new(name).file_name().map_or(name.into(), |base| base.to_string_lossy());
    html::write(&print, &estimate, &base, diameter, &mut sink)
        .and_then(|()| sink.flush())
        .with_context(|| output::writing(out))?;
    sink.commit()?;
    let layers = plural(print.layers.len() as u64, "layer");
    Ok(format!("{layers}, {}\n", plural(print.moves.len() as u64, "move")))
}
