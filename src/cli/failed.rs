//! Error of a run -> the report of its failure, where the report of its success would have been.

use super::output::{self, Sink};
use super::{failure, interrupt, say};
use anyhow::{Context as _, Result};
use slicer::report::failure::Failure;
use std::io::Write as _;
use std::path::Path;

/// From now on, whatever ends this run is reported at `path`: see [`tell`] for what ends it in the
/// usual way.
pub(super) fn promise(path: &Path) {
    let path = path.to_owned();
    // The program ends with another message already.
    interrupt::report_by(Box::new(move |failure| drop(write(&path, failure))));
}

/// Reports that the run failed, in place of what an earlier run reported.
pub(super) fn tell(path: &Path, error: &anyhow::Error) {
    let code = failure::exit_code(error);
    let failed = Failure::new(code, failure::line(error), failure::details(error));
    if let Err(second) = write(path, &failed) {
        let line = failure::line(&second);
        // What keeps the report from being written may be why the run failed.
        if line != failure::line(error) {
            say(&format!("error: the report of this failure: {line}\n"));
        }
    }
}

/// # Errors
/// [`failure::Output`].
fn write(path: &Path, failed: &Failure) -> Result<()> {
    let text = output::json(failed, path)?;
    let mut sink = Sink::open(path)?;
    let written = sink.write_all(text.as_bytes()).and_then(|()| sink.flush());
    written.with_context(|| failure::writing(path))?;
    sink.commit_at_last()
}
