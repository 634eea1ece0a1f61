//! `slicer profile` -> lists of profiles, their settings, and what is wrong with them.
//!
//! `profile check` takes each file it is given by itself, as a shell's `*.toml` means it: the profiles of `-p`,
//! `--material` and `--print` and the values of `--set` are laid over each of them. Without a file these are
//! checked as they would be laid for a print, as one pile.

use super::args::ProfileCommand;
use super::profiles::{self, ProfileArgs};
use super::{Outcome, output, pretty, say_line};
use anyhow::Result;
use serde::Serialize;
use slicer::error::details::Details;
use slicer::profile::{self, Found, Profile, ProfileError, ProfileKind, Shelf};
use slicer::report::{doubtful, motion};
use slicer::text;
use slicer::warning::plural;
use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::Path;

/// Exit code where a profile is wrong.
const WRONG: u8 = 2;

/// What standard output gets, and the exit code.
///
/// # Errors
/// A profile that is wrong, or cannot be read.
pub(super) fn run(command: &ProfileCommand) -> Result<Outcome> {
    let text = match command {
        ProfileCommand::List { json, shelf } => list(&shelf.shelf(), *json)?,
        ProfileCommand::New { name, shelf } => profiles::new(&shelf.shelf(), name)?,
        ProfileCommand::Schema => pretty(&profile::schema())?,
        ProfileCommand::Show { names, profiles, verbose } => {
            profile::document(&profiles.load_after(names)?, *verbose)
        }
        ProfileCommand::Check { names, profiles } => return check(names, profiles),
    };
    Ok(text.into())
}

/// A profile that a name finds.
#[derive(Debug, Serialize)]
struct Listed {
    name: String,
    /// `printer`, `material` or `print`.
    kind: &'static str,
    description: String,
    /// The printer of a job that names none.
    is_default: bool,
    /// The file; absent for a profile that comes with the program.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
}

/// All profiles by kind, each with what it is for, and those of one's own with their file. The default
/// printer comes first if it is a file of one's own, which no name finds.
///
/// # Errors
/// A file that cannot be read or is no TOML.
fn list(shelf: &Shelf, json: bool) -> Result<String> {
    let default = shelf.default_printer();
    let own = default.path.is_some().then(|| default.clone());
    let all = own.into_iter().chain(shelf.all());
    let listed = |found: Found| -> Result<Listed> {
        Ok(Listed {
            kind: found.kind.map_or("", ProfileKind::name),
            description: found.description()?,
            is_default: found.is_same(&default),
            file: found.path.is_some().then_some(found.shown),
            name: found.name,
        })
    };
    let all: Vec<Listed> = all.map(listed).collect::<Result<_>>()?;
    if json {
        return output::json(&all, Path::new("-"));
    }
    let mut text = String::new();
    for kind in ProfileKind::ALL {
        let _ = writeln!(text, "{kind}s");
        for one in all.iter().filter(|one| one.kind == kind.name()) {
            let _ = write!(text, "  {:<23} {}", one.name, text::line(&one.description));
            if one.is_default {
                text += if one.description.is_empty() { "the default" } else { "; the default" };
            }
            if let Some(file) = &one.file {
                let _ = write!(text, " ({file})");
            }
            text.push('\n');
        }
    }
    Ok(text)
}

/// Checks each file by itself, or without any what the flags lay on one pile.
///
/// # Errors
/// [`Usage`](super::failure::Usage) for a word of `--set` without `=`.
fn check(names: &[OsString], profiles: &ProfileArgs) -> Result<Outcome> {
    let mut outcome = Outcome { text: String::new(), code: 0 };
    if names.is_empty() {
        one(None, profiles, false, &mut outcome)?;
    }
    for name in names {
        one(Some(name), profiles, names.len() > 1, &mut outcome)?;
    }
    Ok(outcome)
}

/// Checks one file, or the pile. Of several files each has a line.
fn one(
    name: Option<&OsString>,
    profiles: &ProfileArgs,
    is_one_of_many: bool,
    outcome: &mut Outcome,
) -> Result<()> {
    let given: Vec<OsString> = name.map(|name| profiles.meant(name)).into_iter().collect();
    let faults = profiles.faults_after(&given)?;
    if faults.is_empty() {
        let profile = profiles.load_after(&given)?;
        let shown = name.map_or_else(|| profile.sources.to_string(), text::name);
        warn(&shown, &profile);
        outcome.text += &format!("{shown}: good\n");
        return Ok(());
    }
    for fault in &faults {
        say_line("error", told(name, fault));
    }
    outcome.code = WRONG;
    if is_one_of_many {
        let shown = name.map(text::name).unwrap_or_default();
        outcome.text += &format!("{shown}: {}\n", plural(faults.len() as u64, "fault"));
    }
    Ok(())
}

/// What is allowed and hardly meant.
fn warn(shown: &str, profile: &Profile) {
    let doubtful = doubtful::warnings(&profile.settings);
    let cold = doubtful::cold_bed(&profile.settings, &profile.sources);
    let outdone = doubtful::outdone(&profile.sources);
    let of_profile = doubtful.into_iter().chain(cold).chain(outdone);
    for warning in of_profile.chain(motion::warnings(&profile.settings)) {
        say_line("warning", format!("{shown}: {warning}"));
    }
}

/// A fault, with the file that was checked if it names none.
fn told(name: Option<&OsString>, fault: &ProfileError) -> String {
    match (name, Details::from(fault)) {
        (Some(name), Details { file: None, code, .. }) if code != "unknown-profile" => {
            format!("{}: {fault}", text::name(name))
        }
        _ => fault.to_string(),
    }
}
