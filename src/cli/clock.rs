//! Profiles and what a file says -> the settings by whose limits it is timed, and where they are from.
//!
//! Asked in this order: profiles that are named (`-p`), the settings at the file's end if it is one of
//! ours, and else the default profile. `--set` changes what answers.

use super::output;
use super::profiles::ProfileArgs;
use super::reading::Opened;
use anyhow::Result;
use serde::Serialize;
use slicer::profile::{self, Profile};
use slicer::reader::Print;
use std::path::Path;

/// Settings of a file, and what they are called.
pub(super) type Own<'a> = (&'a [(String, String)], &'static str);

/// The profile by whose limits files are timed, and where it is from; the first of the files that has
/// settings of ours counts for all.
///
/// # Errors
/// A profile or setting that is wrong.
pub(super) fn of(profiles: &ProfileArgs, files: &[Own<'_>]) -> Result<(Profile, String)> {
    let overrides = profiles.overrides()?;
    let asked = profiles.load([])?;
    let by_profile = format!("profile {}", asked.sources);
    if profiles.any() {
        return Ok((asked, by_profile));
    }
    for (own, file) in files {
        let mut values = profile::renewed(own);
        // A file of another version may hold settings that do not exist any more.
        if !matches!(profile::recorded(&values), Ok(Some(_))) {
            continue;
        }
        values.extend(overrides.iter().map(|set| (set.key.clone(), set.value.clone())));
        if let Some(recorded) = profile::recorded(&values)? {
            return Ok((recorded, (*file).to_owned()));
        }
    }
    Ok((asked, by_profile))
}

/// As [`of`], of a file that is open: its settings stand at its end.
///
/// # Errors
/// As [`of`].
pub(super) fn of_file(profiles: &ProfileArgs, file: &Opened) -> Result<(Profile, String)> {
    let end = Print::read(&mut &file.tail[..], 1.0).map_err(|error| file.unreadable(error))?;
    of(profiles, &[(&end.values, "the file's own settings")])
}

/// A product in JSON, with where the limits are from.
///
/// # Errors
/// It cannot be written in JSON.
pub(super) fn json(product: &impl Serialize, limits: &str) -> Result<String> {
    #[derive(Serialize)]
    struct Timed<'a, T> {
        #[serde(flatten)]
        product: &'a T,
        /// Where the limits are from.
        limits: &'a str,
    }
    output::json(&Timed { product, limits }, Path::new("-"))
}
