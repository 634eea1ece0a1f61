//! Error -> one line and an exit code: how the program ends when something goes wrong.
//!
//! Within `cli` everything fails with an [`anyhow::Error`]. It holds one of
//! - an error of the library, which knows its exit code and whose line says it all;
//! - [`Usage`]: wrong arguments;
//! - the system's error, with [`Output`] or [`Input`] as context.
//!
//! What is wrong with a job has its models ([`About`]) as context, too.
//!
//! The line is the context, from the outermost on, and then the error itself, with colons
//! between them. It ends with the library's error: its line holds what its causes say.

use super::about::About;
use slicer::error::Error;
use slicer::error::details::Details;
use slicer::profile::ProfileError;
use slicer::{mesh, reader, roughness, steps, text};
use std::error::Error as StdError;
use std::fmt;
use std::path::{Path, PathBuf};

/// Exit code of wrong arguments.
const USAGE: u8 = 2;

/// Exit code of an input that cannot be read or used.
const INPUT: u8 = 3;

/// Exit code of an output that cannot be opened or written.
const OUTPUT: u8 = 4;

/// Arguments that are wrong, or do not go together.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct Usage(String);

/// Arguments that are wrong: says why, and what to do.
pub(super) fn usage(why: impl Into<String>) -> anyhow::Error {
    Usage(why.into()).into()
}

/// Context: the output that could not be opened or written.
#[derive(Debug)]
pub(super) struct Output {
    /// As the user named it.
    pub(super) file: PathBuf,
    /// What was being done, such as `cannot write`; nothing if the error says so.
    pub(super) action: &'static str,
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&shown(&self.file))?;
        if self.action.is_empty() { Ok(()) } else { write!(f, ": {}", self.action) }
    }
}

/// Context of what fails while an output is written.
pub(super) fn writing(name: &Path) -> Output {
    Output { file: name.to_owned(), action: "cannot write" }
}

/// Context: the input that something is wrong with.
#[derive(Debug)]
pub(super) struct Input(pub(super) String);

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Whether this name means standard output.
pub(crate) fn is_stdout(name: &Path) -> bool {
    name.as_os_str() == "-"
}

/// An output's name for people.
fn shown(file: &Path) -> String {
    if is_stdout(file) { "standard output".into() } else { text::name(file) }
}

/// The one line of an error, without `error: `.
pub(super) fn line(error: &anyhow::Error) -> String {
    let mut parts = Vec::new();
    for cause in error.chain() {
        parts.push(cause.to_string());
        if code_of(cause).is_some() {
            break;
        }
    }
    text::line(&parts.join(": ")).into_owned()
}

/// The code, file and place of an error.
pub(super) fn details(error: &anyhow::Error) -> Details {
    if let Some(output) = error.downcast_ref::<Output>() {
        return Details { file: Some(shown(&output.file)), ..Details::of("unwritable") };
    }
    if let Some(Input(file)) = error.downcast_ref() {
        return Details { file: Some(file.clone()), ..Details::of("unreadable") };
    }
    let details = error.chain().find_map(details_of).unwrap_or_else(|| Details::of("usage"));
    let about = || error.downcast_ref::<About>().and_then(|about| about.file.clone());
    Details { file: details.file.clone().or_else(about), ..details }
}

fn details_of(error: &(dyn StdError + 'static)) -> Option<Details> {
    if let Some(error) = error.downcast_ref::<Error>() {
        return Some(error.into());
    }
    if let Some(error) = error.downcast_ref::<ProfileError>() {
        return Some(error.into());
    }
    if let Some(error) = error.downcast_ref::<mesh::Error>() {
        return Some(error.into());
    }
    if let Some(error) = error.downcast_ref::<steps::Error>() {
        return Some(error.into());
    }
    error.downcast_ref::<reader::Error>().map(Details::from)
}

/// The exit code of an error.
pub(super) fn exit_code(error: &anyhow::Error) -> u8 {
    if error.is::<Output>() {
        return OUTPUT;
    }
    if error.is::<Input>() {
        return INPUT;
    }
    error.chain().find_map(code_of).unwrap_or(USAGE)
}

/// The exit code of an error that needs no context.
fn code_of(error: &(dyn StdError + 'static)) -> Option<u8> {
    if error.is::<Usage>() || error.is::<ProfileError>() {
        return Some(USAGE);
    }
    // What is called within a stage fails with the stage's own error.
    if let Some(error) = error.downcast_ref::<mesh::Error>() {
        return Some(if error.is_usage() { USAGE } else { INPUT });
    }
    let reads = error.is::<reader::Error>() || error.is::<roughness::Error>();
    if reads || error.is::<steps::Error>() {
        return Some(INPUT);
    }
    error.downcast_ref().map(Error::exit_code)
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context as _;
    use slicer::error::Refusal;
    use std::io;

    #[test]
    fn a_line_is_context_and_error_and_the_code_is_that_of_the_innermost() {
        let disk = || Err::<(), _>(io::Error::other("no room"));
        let to = |file: &str| Output { file: file.into(), action: "cannot write" };
        let library = || Error::from(Refusal::TooLow { height_mm: 0.1 });
        for (error, text, code) in [
            (disk().context(to("a.gcode")).unwrap_err(), "a.gcode: cannot write: no room", 4),
            (disk().context(to("-")).unwrap_err(), "standard output: cannot write: no room", 4),
            (disk().context(Input("a.stl".into())).unwrap_err(), "a.stl: no room", 3),
            (usage("no output").context("slicer"), "slicer: no output", 2),
            (library().into(), &library().to_string(), 3),
            (anyhow::Error::from(library()).context("a"), &format!("a: {}", library()), 3),
        ] {
            assert_eq!((line(&error).as_str(), exit_code(&error)), (text, code), "{error:?}");
        }
    }
}
