//! G-code file -> a page to look through all its layers, as `slicer preview` writes it.

use super::clock;
use super::failure::writing;
use super::output::Sink;
use super::profiles::ProfileArgs;
use super::reading::ReadingArgs;
use anyhow::{Context as _, Result};
use slicer::preview::html;
use slicer::reader::Print;
use slicer::warning::plural;
use std::ffi::OsStr;
use std::io::Write as _;
use std::path::Path;

/// Writes the page of `file` to `out`; returns a line on what is in it. `reading` tells how it is read,
/// from what it says of itself.
///
/// # Errors
/// A file that cannot be read or holds no move, an output that cannot be written.
pub(super) fn write(
    file: &OsStr,
    out: &Path,
    profiles: &ProfileArgs,
    reading: &ReadingArgs,
) -> Result<String> {
    let mut sink = Sink::open(out)?;
    let opened = reading.open(file)?;
    let timed = clock::estimate(&opened, profiles, reading, false)?;
    let (estimate, diameter, limits) = (&timed.estimate, timed.diameter, &timed.limits);
    let print = Print::read_as(&mut opened.source.reader(), timed.reading, diameter)
        .map_err(|error| opened.unreadable(error))?;
    let name = opened.name.as_str();
    let base = Path::new(name).file_name().map_or(name.into(), OsStr::to_string_lossy);
    html::write(&print, estimate, &base, diameter, &mut sink)
        .and_then(|()| sink.flush())
        .with_context(|| writing(out))?;
    sink.commit()?;
    let layers = plural(print.layers.len() as u64, "layer");
    let moves = plural(print.moves.len() as u64, "move");
    Ok(format!("{layers}, {moves}, timed by the limits of {limits}\n"))
}
