//! Flags and environment -> profile: which profiles a run asks for, and where they are looked for.
//!
//! - *Wanted* are the profiles that `-p`, `--material` and `--print` name, in this order; later ones win.
//! - The *shelf* is where names are found: the folders of the environment, then the user's own.
//! - *Overrides* lie over all profiles: first those of `--set`, then those of flags.
//!
//! All commands that take profiles take them by [`ProfileArgs`]. Those that only look for names take
//! [`ShelfArgs`].

use super::words;
use anyhow::Result;
use clap::Args;
use slicer::profile::{
    self, Found, Override, Profile, ProfileError, ProfileKind, Shelf, Wanted, keys,
};
use slicer::text;
use std::env;
use std::ffi::{OsStr, OsString};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Folders of profiles of one's own, with the system's separator between them.
const FOLDERS: &str = "SLICER_PROFILES";

/// Set to anything but nothing and 0, it has the same effect as `--no-user-config`.
const NO_USER_CONFIG: &str = "SLICER_NO_USER_CONFIG";

/// Which profiles are asked for.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Settings")]
pub(crate) struct ProfileArgs {
    /// Printer or other profile; a file if it has a `/` or ends in .toml (repeatable, later ones win)
    #[arg(short, long, value_name = "NAME")]
    pub(crate) profile: Vec<OsString>,
    /// Material [default: the printer's]
    #[arg(long, value_name = "NAME")]
    material: Option<OsString>,
    /// Print, such as fine [default: the printer's]
    #[arg(long, value_name = "NAME")]
    print: Option<OsString>,
    /// Change any setting, such as speed.wall=25 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    pub(crate) shelf: ShelfArgs,
}

/// Where profiles are looked for.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Settings")]
pub(crate) struct ShelfArgs {
    /// Leave out profiles of your own that are found by name, and your default printer
    #[arg(hide_short_help = true, long)]
    no_user_config: bool,
}

impl ProfileArgs {
    /// Whether any profile is asked for.
    pub(crate) fn any(&self) -> bool {
        !self.wanted().is_empty()
    }

    /// The files among them, as they are named. A bare name is looked for on the shelf, and never here.
    pub(crate) fn files(&self) -> impl Iterator<Item = &OsStr> {
        let all = self.profile.iter().chain(&self.material).chain(&self.print);
        let is_file = |name: &&OsString| {
            name.to_str().is_none_or(|name| {
                name.contains(['/', std::path::MAIN_SEPARATOR]) || name.ends_with(".toml")
            })
        };
        all.filter(is_file).map(OsString::as_os_str)
    }

    /// The overrides that `--set` gives.
    ///
    /// # Errors
    /// [`Usage`](super::failure::Usage) for a word without `=`.
    pub(crate) fn overrides(&self) -> Result<Vec<Override>> {
        words::set_overrides(&self.set)
    }

    /// As `load`, with these profiles first.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub(crate) fn load_after(&self, names: &[OsString]) -> Result<Profile> {
        self.lay(names.iter().map(|name| Wanted::word(None, name)).chain(self.wanted()), [])
    }

    /// All that is wrong with these profiles and those asked for after them.
    ///
    /// # Errors
    /// As [`Self::overrides`].
    pub(crate) fn faults_after(&self, names: &[OsString]) -> Result<Vec<ProfileError>> {
        let names = names.iter().map(|name| Wanted::word(None, name));
        let wanted: Vec<Wanted> = names.chain(self.wanted()).collect();
        Ok(profile::faults(&self.shelf.shelf(), &wanted, &self.overrides()?))
    }

    /// The name as it is loaded by: a bare one that finds no profile but is a file is meant as that.
    pub(crate) fn meant(&self, name: &OsStr) -> OsString {
        let find = |name: &str| self.shelf.shelf().find(name, None, |_| false).is_ok();
        let known = name.to_str().is_none_or(find);
        if !known && Path::new(name).is_file() {
            return Path::new(".").join(name).into_os_string();
        }
        name.to_owned()
    }

    /// Loads what is asked for, and lays `more` over it.
    ///
    /// # Errors
    /// What is wrong with a profile or a value.
    pub(crate) fn load(&self, more: impl IntoIterator<Item = Override>) -> Result<Profile> {
        self.lay(self.wanted(), more)
    }

    /// Loads `wanted`, and lays `--set` and then `more` over it.
    fn lay(
        &self,
        wanted: impl IntoIterator<Item = Wanted>,
        more: impl IntoIterator<Item = Override>,
    ) -> Result<Profile> {
        let wanted: Vec<Wanted> = wanted.into_iter().collect();
        let mut overrides = self.overrides()?;
        overrides.extend(more);
        Ok(profile::load_from(&self.shelf.shelf(), &wanted, &overrides)?)
    }

    fn wanted(&self) -> Vec<Wanted> {
        let of = |name: &Option<OsString>, kind| {
            name.as_deref().map(|name| Wanted::word(Some(kind), name))
        };
        let any = self.profile.iter().map(|name| Wanted::word(None, name));
        any.chain(of(&self.material, ProfileKind::Material))
            .chain(of(&self.print, ProfileKind::Print))
            .collect()
    }
}

impl ShelfArgs {
    /// Folders of `$SLICER_PROFILES`, then the user's own by the platform's convention, such as
    /// `~/.config/slicer`.
    pub(crate) fn shelf(&self) -> Shelf {
        let off = env::var_os(NO_USER_CONFIG).is_some_and(|set| !set.is_empty() && set != "0");
        if self.no_user_config || off {
            return Shelf::default();
        }
        let given = env::var_os(FOLDERS).unwrap_or_default();
        let given = env::split_paths(&given).filter(|folder| !folder.as_os_str().is_empty());
        let own = dirs::config_dir().map(|folder| folder.join("slicer"));
        Shelf::new(given.chain(own).collect::<Vec<PathBuf>>())
    }
}

/// The keys that a profile of one's own is most likely to change.
const fn usual(kind: Option<ProfileKind>) -> &'static [&'static str] {
    match kind {
        Some(ProfileKind::Material) => &[
            "filament.name",
            "filament.temperature",
            "filament.bed_temperature",
            "filament.fan",
            "filament.max_volumetric_speed",
            "filament.density",
            "filament.cost",
        ],
        Some(ProfileKind::Print) => {
            &["layer_height", "walls", "skin_layers", "infill", "speed.wall", "speed.infill"]
        }
        Some(ProfileKind::Printer) | None => &[
            "machine.name",
            "machine.bed_width",
            "machine.bed_depth",
            "machine.bed_height",
            "machine.nozzle_diameter",
            "machine.max_volumetric_speed",
            "retraction.length",
            "retraction.speed",
        ],
    }
}

/// A short profile that inherits the one of this name, with what people change most in comments.
///
/// # Errors
/// What is wrong with the profile.
pub(crate) fn new(shelf: &Shelf, name: &str) -> Result<String> {
    let found: Found = shelf.find(name, None, |_| false)?;
    let shown = text::line(name);
    let profile = profile::load_from(shelf, &[Wanted::any(name)], &[])?;
    let mut text = format!(
        "# Whatever is not said here is as in {shown}. Remove the # before what you change.\n\
         # `slicer profile show -v {shown}` lists all keys with their meaning.\n\
         inherits = {name:?}\n\
         description = {:?}\n",
        format!("{name}, with changes of my own"),
    );
    let values = profile::values(&profile.settings);
    let mut table = "";
    for name in usual(found.kind) {
        let (prefix, short) = name.split_once('.').unwrap_or(("", name));
        if prefix != table {
            table = prefix;
            let _ = writeln!(text, "\n[{table}]");
        }
        let value = values.iter().find(|(key, _)| key == name).map_or("", |(_, value)| value);
        let unit = keys::find(name).map_or("", |key| key.unit.as_str());
        let unit = if unit.is_empty() { String::new() } else { format!("  # {unit}") };
        let _ = writeln!(text, "# {short} = {value}{unit}");
    }
    Ok(text)
}
