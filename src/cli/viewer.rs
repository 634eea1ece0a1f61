//! G-code file -> a page to look through all its layers, as `slicer preview` writes it.

use super::failure::writing;
use super::input;
use super::output::Sink;
use anyhow::{Context as _, Result};
use slicer::estimate::{self, Options};
use slicer::motion::Limits;
use slicer::preview::html;
use slicer::profile::Settings;
use slicer::reader::{Cause, Print};
use slicer::warning::plural;
use std::ffi::OsStr;
use std::io::Write as _;
use std::path::Path;

/// Writes the page of `file` to `out`; returns a line on what is in it.
///
/// # Errors
/// A file that cannot be read or holds no move, an output that cannot be written.
pub(super) fn write(
    file: &OsStr,
    limit: input::LimitArgs,
    out: &Path,
    settings: &Settings,
) -> Result<String> {
    let mut sink = Sink::open(out)?;
    let (name, bytes) = input::read(file, limit)?;
    let diameter = settings.filament.diameter;
    let options = Options { filament_diameter: diameter, ..Options::default() };
    let estimate = estimate::estimate(&mut &bytes[..], &name, &Limits::new(settings), options)?;
    let print = Print::read(&mut &bytes[..], diameter)
        .map_err(|error| Cause::Unreadable(error).of(&name))?;
    // The file is not needed any more, and may be large.
    drop(bytes);
    let base = Path::new(&name).file_name().map_or(name.as_str().into(), OsStr::to_string_lossy);
    html::write(&print, &estimate, &base, diameter, &mut sink)
        .and_then(|()| sink.flush())
        .with_context(|| writing(out))?;
    sink.commit()?;
    let layers = plural(print.layers.len() as u64, "layer");
    Ok(format!("{layers}, {}\n", plural(print.moves.len() as u64, "move")))
}
