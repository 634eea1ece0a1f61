//! Profiles and what a file says -> the settings by whose limits it is timed, and where they are from.
//!
//! Asked in this order: profiles that are named (`-p`), the settings at the file's end if it is one of
//! ours, and else the default profile. `--set` changes what answers.

use super::output;
use super::profiles::ProfileArgs;
use super::reading::{Opened, ReadingArgs};
use anyhow::Result;
use serde::Serialize;
use slicer::estimate::{Estimate, Options};
use slicer::motion::Limits;
use slicer::profile::{self, Profile, Settings};
use slicer::reader::Reading;
use slicer::steps::axis::Axes;
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

/// By whose word limits hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum LimitsBy {
    /// A profile is named.
    Profile,
    /// The file has settings of ours.
    File,
    /// Nobody says for which printer the file is.
    Default,
}

/// What the file's own settings are called.
const OWN: &str = "the file's own settings";

/// A file that is timed.
pub(super) struct Timed {
    pub(super) estimate: Estimate,
    /// By whose rules it was read.
    pub(super) reading: Reading,
    /// Diameter of the filament by the settings that time it, mm.
    pub(super) diameter: f64,
    /// Where the limits are from.
    pub(super) limits: String,
    /// By whose word.
    pub(super) by: LimitsBy,
    /// The settings themselves.
    pub(super) settings: Box<Settings>,
}

/// Times a file by the limits that [`of`] gives. `fixed_limits` leaves out what it sets itself.
///
/// # Errors
/// As [`of`], a file that cannot be read or holds no move.
pub(super) fn estimate(
    file: &Opened,
    profiles: &ProfileArgs,
    args: &ReadingArgs,
    fixed_limits: bool,
) -> Result<Timed> {
    let own = file.values().map_err(|error| file.unreadable(error))?;
    let (clock, limits) = of(profiles, &[(&own, OWN)])?;
    let by = match limits.as_str() {
        _ if profiles.any() => LimitsBy::Profile,
        OWN => LimitsBy::File,
        _ => LimitsBy::Default,
    };
    let settings = &clock.settings;
    let reading = args.of(profiles.any().then_some(settings), file.says);
    let diameter = settings.filament.diameter;
    let options = Options {
        filament_diameter: diameter,
        fixed_limits,
        firmware: reading.firmware,
        volumes: reading.volumes,
    };
    let mut source = file.source.reader();
    let estimate =
        slicer::estimate::estimate(&mut source, &file.name, &Limits::new(settings), options)?;
    Ok(Timed { estimate, reading, diameter, limits, by, settings: Box::new(clock.settings) })
}

/// A product in JSON, of one of several files on a line with its name, with where the limits are from, and the highest rates of motors, if they are known.
///
/// # Errors
/// It cannot be written in JSON.
pub(super) fn json(
    file: Option<&str>,
    product: &impl Serialize,
    limits: &str,
    limits_by: Option<LimitsBy>,
    highest_rate: Option<Axes<f64>>,
) -> Result<String> {
    #[derive(Serialize)]
    struct Timed<'a, T> {
        /// The file, where there are several.
        #[serde(skip_serializing_if = "Option::is_none")]
        file: Option<&'a str>,
        #[serde(flatten)]
        product: &'a T,
        /// Where the limits are from.
        limits: &'a str,
        /// By whose word they hold.
        #[serde(skip_serializing_if = "Option::is_none")]
        limits_by: Option<LimitsBy>,
        /// Steps a second.
        #[serde(skip_serializing_if = "Option::is_none")]
        highest_rate: Option<Axes<f64>>,
    }
    let timed = Timed { file, product, limits, limits_by, highest_rate };
    let written = if file.is_some() { output::json_line } else { output::json };
    written(&timed, Path::new("-"))
}
