//! Error of a run -> the report of its failure, where the report of its success would have been.
//!
//! Whatever ends a run, no report of an earlier one is left that could be taken for its own: one that is
//! there is replaced as the run begins, since a killed run cannot do it any more.

use super::output::{self, Sink};
use super::{failure, interrupt, say, usage};
use anyhow::{Context as _, Result};
use slicer::error::details::Details;
use slicer::report::failure::Failure;
use slicer::text;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Exit code, as shells have it, of a program that the system kills: 128 + SIGKILL.
const KILLED: u8 = 137;

/// From now on, whatever ends this run is reported at `path`: see [`tell`] for what ends it in the
/// usual way. A report that is there says from now on that the run has not ended.
pub(super) fn promise(path: &Path) {
    if fs::metadata(path).is_ok_and(|data| data.is_file()) && !path.starts_with("/dev") {
        // If it cannot be written, that is told as soon as it is opened for the report itself.
        let _ = write(path, None, &Failure::unfinished(KILLED));
    }
    let path = path.to_owned();
    // The program ends with another message already.
    interrupt::report_by(Box::new(move |failed| drop(write(&path, None, failed))));
}

/// Reports that the run failed, in place of what an earlier run reported. `sink` is that of its report,
/// if nothing was written to it.
pub(super) fn tell(path: &Path, sink: Option<Sink>, error: &anyhow::Error) {
    let code = failure::exit_code(error);
    let failed = Failure::new(code, failure::line(error), failure::details(error));
    if let Err(second) = write(path, sink, &failed) {
        let line = failure::line(&second);
        // What keeps the report from being written may be why the run failed.
        if line != failure::line(error) {
            say(&format!("error: the report of this failure: {line}\n"));
        }
    }
}

/// Reports that the command line was not understood, where it names a report. What it names may be
/// meant otherwise: a file that is there is replaced only if it is a report.
pub(super) fn refused(words: &[OsString], code: u8, line: &str) {
    let Some(path) = named(words) else { return };
    let is_free = match fs::read(&path) {
        Ok(there) => is_report(&there),
        Err(_) => !path.exists(),
    };
    let mut others = words.iter().skip(1).filter(|word| path.as_os_str() != word.as_os_str());
    if is_free && !others.any(|word| usage::is_same_file(&path, Path::new(word))) {
        let details = Details::of("usage");
        // The program ends with another message already.
        let _ = write(&path, None, &Failure::new(code, line.to_owned(), details));
    }
}

/// JSON of one of several files that cannot be judged, on a line.
///
/// # Errors
/// It cannot be written in JSON.
pub(super) fn row(file: &OsStr, code: u8, line: String, error: &anyhow::Error) -> Result<String> {
    let failed = Failure::new(code, line, failure::details(error));
    let row = serde_json::json!({
        "file": text::name(file), "exit_code": code, "error": failed.error,
    });
    output::json_line(&row, Path::new("-"))
}

/// The last file that the words name for the report.
fn named(words: &[OsString]) -> Option<PathBuf> {
    let mut path = None;
    for (k, word) in words.iter().enumerate() {
        if word == "--report" {
            path = words.get(k + 1).cloned();
        } else if let Some(value) = word.to_str().and_then(|word| word.strip_prefix("--report=")) {
            path = Some(OsString::from(value));
        }
    }
    path.filter(|path| path != "-" && !path.is_empty()).map(PathBuf::from)
}

fn is_report(text: &[u8]) -> bool {
    let start = &text[..text.len().min(64)];
    start.starts_with(b"{") && start.windows(8).any(|word| word == b"\"schema\"")
}

/// # Errors
/// [`failure::Output`].
fn write(path: &Path, sink: Option<Sink>, failed: &Failure) -> Result<()> {
    let text = output::json(failed, path)?;
    let mut sink = match sink {
        Some(sink) => sink,
        // Its reader was there once, and may be gone: to open it again might wait for ever.
        None if is_pipe(path) => return Ok(()),
        None => Sink::open(path)?,
    };
    let written = sink.write_all(text.as_bytes()).and_then(|()| sink.flush());
    written.with_context(|| failure::writing(path))?;
    sink.commit_at_last()
}

#[cfg(unix)]
fn is_pipe(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    fs::metadata(path).is_ok_and(|data| data.file_type().is_fifo())
}

#[cfg(not(unix))]
fn is_pipe(_: &Path) -> bool {
    false
}
