//! Job -> any Write: the whole G-code at once, for outputs that cannot seek.

use crate::error::Result;
use crate::gcode;
use crate::job::Job;
use crate::progress::Progress;
use crate::report::Report;
use std::io::{self, Seek as _, Write};

/// Bytes that wait in memory; more wait in a temporary file. The text of a large print is some
/// hundred MB, of most it is less than this.
const MOST_IN_MEMORY: usize = 64 << 20;

/// Slices `job` and writes the G-code to any output. The text waits until all of it is there,
/// since the progress in it is only known then: an output that can seek is served without the
/// wait by [`slice()`](crate::slice()).
///
/// # Errors
/// As [`slice()`](crate::slice()). Nothing is written to `out` then, unless it is `out` itself
/// that fails.
pub fn slice_to(job: &Job, out: &mut dyn Write, progress: &Progress) -> Result<Report> {
    let mut spool = tempfile::spooled_tempfile(MOST_IN_MEMORY);
    let report = crate::slice(job, &mut spool, progress)?;
    let copied = spool.rewind().and_then(|()| io::copy(&mut spool, out));
    copied.and_then(|_| out.flush()).map_err(gcode::Error::Write)?;
    Ok(report)
}
