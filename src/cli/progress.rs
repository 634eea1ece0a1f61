//! Progress -> a bar on standard error, drawn by a thread of its own while the work runs.

use slicer::progress::Progress;
use std::io::{IsTerminal as _, Write as _};
use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often the bar is drawn.
const INTERVAL: Duration = Duration::from_millis(100);

/// Cells of the bar: with the count it fits on a line of 80.
const CELLS: usize = 40;

/// A running bar; it goes away when this is dropped.
#[derive(Debug)]
pub(crate) struct Meter {
    /// Hanging up tells the thread to stop.
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Meter {
    /// Starts drawing `progress` in layers, if standard error is a terminal and `wanted`.
    pub(crate) fn start(progress: &Arc<Progress>, wanted: bool) -> Self {
        Self::of("layers", progress, wanted)
    }

    /// As [`start`](Self::start), in other units.
    pub(crate) fn of(unit: &'static str, progress: &Arc<Progress>, wanted: bool) -> Self {
        if !wanted || !std::io::stderr().is_terminal() {
            return Self { stop: None, thread: None };
        }
        let (stop, stopped) = mpsc::channel::<()>();
        let progress = Arc::clone(progress);
        let draw = move || {
            let mut shown = 0;
            while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                let (done, total) = progress.get();
                if total > 0 {
                    let bar = bar(done, total, unit);
                    shown = shown.max(bar.len());
                    write(&format!("\r{bar:shown$}"));
                }
            }
            write(&format!("\r{:shown$}\r", ""));
        };
        // Where there is no thread for it, nothing is drawn.
        Self { stop: Some(stop), thread: std::thread::Builder::new().spawn(draw).ok() }
    }
}

impl Drop for Meter {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // A bar that failed to draw is no reason to fail the work.
            let _ = thread.join();
        }
    }
}

/// A bar of [`CELLS`] cells and the count. No colours at all, so that NO_COLOR needs no thought,
/// and no escape codes, so that any terminal shows it.
fn bar(done: usize, total: usize, unit: &str) -> String {
    let full = CELLS * done.min(total) / total;
    format!("{:#<full$}{:-<rest$} {done}/{total} {unit}", "", "", rest = CELLS - full)
}

/// A bar that cannot be drawn is no reason to fail the work.
fn write(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::bar;

    #[test]
    fn the_bar_is_as_long_from_first_to_last() {
        assert_eq!(bar(0, 7, "layers"), format!("{} 0/7 layers", "-".repeat(40)));
        assert_eq!(bar(3, 7, "layers"), format!("{}{} 3/7 layers", "#".repeat(17), "-".repeat(23)));
        assert_eq!(bar(7, 7, "layers"), format!("{} 7/7 layers", "#".repeat(40)));
    }
}
