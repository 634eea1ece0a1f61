//! Signals -> exit: a run that is interrupted leaves no unfinished file behind.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Exit code of an interrupted run, as shells count it: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// The unfinished files of this run. The one global of the program: a signal
/// reaches no value of a running function.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// From now on SIGINT, SIGTERM and SIGHUP remove unfinished files and end the program.
pub(crate) fn watch() {
    // Without a handler the signals still end the program: nothing to report.
    let _ = ctrlc::set_handler(|| {
        for path in unfinished().drain(..) {
            let _ = std::fs::remove_file(path);
        }
        std::process::exit(INTERRUPTED);
    });
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
