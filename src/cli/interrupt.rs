//! Signals and faults of the program -> exit: a run that is cut short leaves no unfinished file behind.

use slicer::report::failure::Failure;
use slicer::text;
use std::any::Any;
use std::panic::Location;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

/// Exit code of an interrupted run, as shells count it: 128 + SIGINT.
pub(crate) const INTERRUPTED: u8 = 130;

/// Exit code of a run that meets a fault of the program itself, as Rust has it.
pub(crate) const FAULT: u8 = 101;

/// What a signal has to know of a run. These are the globals of the program: a signal reaches no value
/// of a running function.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Reports the failure of this run; nothing if nobody asked for a report, or if the run is done.
static REPORT: Mutex<Option<Reporter>> = Mutex::new(None);

/// Writes the report of a failure.
pub(crate) type Reporter = Box<dyn FnOnce(&Failure) + Send>;

/// Held while files are put in place, which a signal must not cut in two.
static PUBLISHING: Mutex<()> = Mutex::new(());

/// From now on SIGINT, SIGTERM and SIGHUP remove unfinished files and end the program.
pub(crate) fn watch() {
    // The handler needs a thread. Without one, or without a handler, the signals still end the
    // program; what it leaves is swept by the next.
    if thread::Builder::new().spawn(|| {}).is_err() {
        return;
    }
    let _ = ctrlc::set_handler(|| {
        let _guard = locked(&PUBLISHING);
        clear();
        report(&Failure::interrupted(INTERRUPTED));
        std::process::exit(i32::from(INTERRUPTED));
    });
}

/// Does what no signal may cut in two. Afterwards the run is no failure any more.
pub(crate) fn undisturbed<T, E>(work: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    let _guard = locked(&PUBLISHING);
    let done = work();
    if done.is_ok() {
        locked(&REPORT).take();
    }
    done
}

/// From now on a run that is interrupted, or meets a fault, is reported by this.
pub(crate) fn report_by(reporter: Reporter) {
    *locked(&REPORT) = Some(reporter);
}

fn report(failure: &Failure) {
    let reporter = locked(&REPORT).take();
    if let Some(write) = reporter {
        write(failure);
    }
}

/// From now on a panic, which only a mistake in the program can cause, is one line of error, and
/// ends the program after its unfinished files are removed.
pub(crate) fn watch_faults() {
    std::panic::set_hook(Box::new(|panic| {
        let line = fault_line(panic.payload(), panic.location());
        super::say_line("error", &line);
        clear();
        report(&Failure::fault(FAULT, line));
        std::process::exit(i32::from(FAULT));
    }));
}

/// A panic in one line.
fn fault_line(payload: &dyn Any, location: Option<&Location>) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    let text = text::line(text.unwrap_or("no more is known"));
    let place = location.map_or_else(String::new, |at| format!(" at {}:{}", at.file(), at.line()));
    format!("a fault of the slicer itself{place}: {text}; please report it with the model")
}

/// Removes what is unfinished.
fn clear() {
    for path in locked(&UNFINISHED).drain(..) {
        let _ = std::fs::remove_file(path);
    }
}

/// Remembers `path` as unfinished.
pub(crate) fn begun(path: &Path) {
    locked(&UNFINISHED).push(path.to_owned());
}

/// Forgets `path`: it is finished, or gone.
pub(crate) fn done(path: &Path) {
    locked(&UNFINISHED).retain(|p| p != path);
}

fn locked<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_is_reported_in_one_line_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("unfinished");
        std::fs::write(&path, "half").unwrap();
        begun(&path);
        clear();
        assert!(!path.exists());
        let payloads: [Box<dyn Any>; 3] =
            [Box::new("one\ntwo"), Box::new("one\ntwo".to_owned()), Box::new(7)];
        for payload in payloads {
            let line = fault_line(&*payload, Some(Location::caller()));
            assert_eq!(line.lines().count(), 1, "{line}");
            assert!(line.contains("interrupt.rs:"), "{line}");
            assert!(line.contains("one\\ntwo") || line.contains("no more is known"), "{line}");
        }
    }
}
