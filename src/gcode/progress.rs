//! Times + text -> `M73`: progress lines of fixed length, filled in once the total time is known.

use super::dialect::Dialect;
use super::error::Result;
use super::output::Places;
use super::times::Schedule;
use super::write::LayerText;
use crate::profile::DialectName;

/// Longest time between two progress lines, s, where a path ends in time. `M73` counts whole
/// minutes: more lines would repeat the same number, fewer would let the display stand still.
const INTERVAL: f64 = 60.0;

/// The progress lines written so far.
pub(super) struct Progress {
    dialect: Dialect,
    /// Where each line begins, bytes, and when the printer reaches it, s.
    lines: Vec<(u64, f64)>,
}

impl Progress {
    pub(super) fn new(dialect: DialectName) -> Self {
        Self { dialect: Dialect::new(dialect), lines: Vec::new() }
    }

    /// Writes a layer with placeholder lines: one at its beginning, and one before each path
    /// that would end more than [`INTERVAL`] after the last line.
    pub(super) fn layer(
        &mut self,
        layer: &LayerText,
        times: &Schedule,
        out: &mut Places<'_>,
    ) -> Result<()> {
        let mut done = 0;
        let begins = std::iter::once(&times.start).chain(&times.paths);
        let ends = times.paths.iter().chain(std::iter::once(&times.end));
        for (index, ((&cut, &begin), &end)) in layer.cuts.iter().zip(begins).zip(ends).enumerate() {
            let last = self.lines.last().map_or(f64::NEG_INFINITY, |&(_, last)| last);
            if index == 0 || (begin > last && end - last > INTERVAL) {
                out.put(&layer.text[done..cut])?;
                self.lines.push((out.written, begin));
                out.put(self.line(0, 0).as_bytes())?;
                done = cut;
            }
        }
        out.put(&layer.text[done..])
    }

    /// The line for 100 %, unless the end block has it.
    pub(super) fn done(&self) -> String {
        if self.dialect.reports_done() { self.line(100, 0) } else { String::new() }
    }

    /// Overwrites all placeholder lines, for a print that takes `total` seconds.
    pub(super) fn fill_in(&self, total: f64, out: &mut Places<'_>) -> Result<()> {
        for &(place, at) in &self.lines {
            let percent = if total > 0.0 { 100.0 * at / total } else { 0.0 };
            // 100 is for the end only: it makes GPX end the build.
            let percent = (percent as u64).min(99);
            let minutes = ((total - at) / 60.0).round().max(0.0) as u64;
            out.put_at(place, self.line(percent, minutes).as_bytes())?;
        }
        Ok(())
    }

    fn line(&self, percent: u64, minutes: u64) -> String {
        self.dialect.progress(percent, minutes)
    }
}
