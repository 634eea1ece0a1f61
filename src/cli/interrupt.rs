//! Signals and faults of the program -> exit: a run that is cut short leaves no unfinished file behind.

use std::any::Any;
use std::panic::Location;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Exit code of an interrupted run, as shells count it: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Exit code of a run that meets a fault of the program itself, as Rust has it.
const FAULT: i32 = 101;

/// The unfinished files of this run. The one global of the program: a signal
/// reaches no value of a running function.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// From now on SIGINT, SIGTERM and SIGHUP remove unfinished files and end the program.
pub(crate) fn watch() {
    // Without a handler the signals still end the program: nothing to report.
    let _ = ctrlc::set_handler(|| {
        clear();
        std::process::exit(INTERRUPTED);
    });
}

/// From now on a panic, which only a mistake in the program can cause, is one line of error, and
/// ends the program after its unfinished files are removed.
pub(crate) fn watch_faults() {
    std::panic::set_hook(Box::new(|panic| {
        super::say(&fault_line(panic.payload(), panic.location()));
        clear();
        std::process::exit(FAULT);
    }));
}

/// A panic in one line.
fn fault_line(payload: &dyn Any, location: Option<&Location>) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    let text = text.unwrap_or("no more is known").replace('\n', " ");
    let place = location.map_or_else(String::new, |at| format!(" at {}:{}", at.file(), at.line()));
    format!("error: a fault of the slicer itself{place}: {text}; please report it with the model\n")
}

/// Removes what is unfinished.
fn clear() {
    for path in unfinished().drain(..) {
        let _ = std::fs::remove_file(path);
    }
}

/// Remembers `path` as unfinished.
pub(crate) fn begun(path: &Path) {
    unfinished().push(path.to_owned());
}

/// Forgets `path`: it is finished, or gone.
pub(crate) fn done(path: &Path) {
    unfinished().retain(|p| p != path);
}

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
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
            assert!(line.ends_with('\n') && line.lines().count() == 1, "{line}");
            assert!(line.contains("interrupt.rs:"), "{line}");
            assert!(line.contains("one two") || line.contains("no more is known"), "{line}");
        }
    }
}
