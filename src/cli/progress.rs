//! Progress -> a bar on standard error, drawn by a thread of its own while the work runs.

use indicatif::{ProgressBar, ProgressStyle};
use slicer::progress::Progress;
use std::io::IsTerminal as _;
use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often the bar is drawn.
const INTERVAL: Duration = Duration::from_millis(100);

/// A running bar; it goes away when this is dropped.
#[derive(Debug)]
pub(crate) struct Meter {
    /// Hanging up tells the thread to stop.
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Meter {
    /// Starts drawing `progress`, if standard error is a terminal and `wanted`.
    pub(crate) fn start(progress: &Arc<Progress>, wanted: bool) -> Self {
        if !wanted || !std::io::stderr().is_terminal() {
            return Self { stop: None, thread: None };
        }
        let (stop, stopped) = mpsc::channel::<()>();
        let progress = Arc::clone(progress);
        let thread = std::thread::spawn(move || {
            let bar = ProgressBar::no_length();
            // No colours at all, so that NO_COLOR needs no thought.
            if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} layers") {
                bar.set_style(style);
            }
            while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                let (done, total) = progress.get();
                if total > 0 {
                    bar.set_length(total as u64);
                    bar.set_position(done as u64);
                }
            }
            bar.finish_and_clear();
        });
        Self { stop: Some(stop), thread: Some(thread) }
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
