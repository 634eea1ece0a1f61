//! The built program in a folder of its own, as the modules beside this one run it.

use assert_cmd::Command;
use std::fs;
use tempfile::TempDir;

/// The program, run in this folder.
pub(crate) fn slicer(folder: &TempDir) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    command.current_dir(folder.path());
    command
}

/// The program with these words, run where the tests run.
pub(crate) fn with(words: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    command.args(words);
    command
}

/// A folder with a cube in it that is sliced in no time.
#[allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
pub(crate) fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::copy("fixtures/cube_20.stl", folder.path().join("cube.stl")).unwrap();
    folder
}
