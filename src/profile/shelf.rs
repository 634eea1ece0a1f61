//! Name -> text: the places where profiles are found, those of the user before the shipped ones.
//!
//! A *shelf* is a list of folders. In a folder, `printers/NAME.toml`, `materials/NAME.toml` and
//! `prints/NAME.toml` are found by `NAME`; the subfolder is the kind. After the last folder come the
//! shipped profiles. A name with a path separator or the ending `.toml` is a file instead.

use super::error::{ProfileError, Result};
use super::kind::ProfileKind;
use super::{parse, shipped};
use crate::text;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Bytes of a profile, at most; start and end blocks are the longest part of one. A device has no end.
const MOST_BYTES: u64 = 1 << 20;

/// File in a folder that stands for the default printer, if it is there.
const DEFAULT_FILE: &str = "default.toml";

/// The subfolder of a kind's profiles.
fn folder_of(kind: ProfileKind) -> &'static str {
    match kind {
        ProfileKind::Printer => "printers",
        ProfileKind::Material => "materials",
        ProfileKind::Print => "prints",
    }
}

/// A profile that was found, before it is read.
#[derive(Debug, Clone)]
pub struct Found {
    /// The built-in name, or the file's name without its folder, so that what quotes it does not
    /// depend on where the file lay.
    pub name: String,
    /// For messages: the path, or the name of a shipped profile.
    pub shown: String,
    /// What it describes; `None` for a file that may hold anything.
    pub kind: Option<ProfileKind>,
    /// `None` for a shipped profile.
    pub path: Option<PathBuf>,
    /// What tells two profiles apart, whatever way they were named.
    identity: PathBuf,
}

impl Found {
    /// A file that the user names by its path.
    pub(super) fn file(path: PathBuf, kind: Option<ProfileKind>) -> Self {
        let name = text::name(path.file_name().unwrap_or(path.as_os_str()));
        let identity = std::fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
        Self { name, shown: text::name(&path), kind, path: Some(path), identity }
    }

    /// A file on a shelf, which goes by its name without the ending.
    fn shelved(path: PathBuf, kind: ProfileKind) -> Self {
        let name = text::name(path.file_stem().unwrap_or_default());
        Self { name, ..Self::file(path, Some(kind)) }
    }

    fn shipped(kind: ProfileKind, name: &str) -> Self {
        let (name, identity) = (name.to_owned(), PathBuf::from(name));
        Self { shown: name.clone(), name, kind: Some(kind), path: None, identity }
    }

    /// Whether both are the same file or the same shipped profile.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        self.identity == other.identity
    }

    /// Its text.
    ///
    /// # Errors
    /// [`ProfileError::Unreadable`], [`ProfileError::TooLarge`].
    pub fn text(&self) -> Result<String> {
        let Some(path) = &self.path else {
            return Ok(shipped::text(&self.name).unwrap_or_default().to_owned());
        };
        let mut text = String::new();
        let read = File::open(path)
            .and_then(|file| file.take(MOST_BYTES + 1).read_to_string(&mut text))
            .map_err(|source| ProfileError::Unreadable { file: self.shown.clone(), source })?;
        if read as u64 > MOST_BYTES {
            return Err(ProfileError::TooLarge { file: self.shown.clone() });
        }
        Ok(text)
    }

    /// What it is for, in one line; empty if it does not say.
    ///
    /// # Errors
    /// As [`Self::text`], and [`ProfileError::Syntax`].
    pub fn description(&self) -> Result<String> {
        let entries = parse::document(&self.shown, &self.text()?)?;
        let said = entries.iter().find(|entry| entry.key == "description");
        Ok(said.and_then(|entry| entry.value.as_str()).unwrap_or_default().to_owned())
    }
}

/// Where profiles are looked for by their names. Empty, it holds the shipped profiles alone.
#[derive(Debug, Clone, Default)]
pub struct Shelf {
    folders: Vec<PathBuf>,
}

impl Shelf {
    /// A shelf of these folders, the first one searched first. They need not exist.
    #[must_use]
    pub fn new(folders: Vec<PathBuf>) -> Self {
        Self { folders }
    }

    /// The profile called `wanted`; relative files are looked for in `folder`. Those that `skip`
    /// refuses are passed over: a profile may inherit the one that it stands in front of.
    ///
    /// # Errors
    /// [`ProfileError::UnknownProfile`], [`ProfileError::OtherSlicers`].
    pub fn find(
        &self,
        wanted: &str,
        folder: Option<&Path>,
        skip: impl Fn(&Found) -> bool,
    ) -> Result<Found> {
        if is_file_name(wanted) {
            let path = folder.map_or_else(|| PathBuf::from(wanted), |dir| dir.join(wanted));
            return Ok(Found::file(path, None));
        }
        let file = format!("{wanted}.toml");
        let place = |dir: &PathBuf, kind: ProfileKind| dir.join(folder_of(kind)).join(&file);
        let kinds = |dir| ProfileKind::ALL.map(|kind| (place(dir, kind), kind));
        let own = self.folders.iter().flat_map(kinds).filter(|(path, _)| path.is_file());
        let own = own.map(|(path, kind)| Found::shelved(path, kind));
        let shipped = shipped::kind(wanted).map(|kind| Found::shipped(kind, wanted));
        own.chain(shipped).find(|found| !skip(found)).ok_or_else(|| self.unknown(wanted, folder))
    }

    /// That nothing is called so; a file that lies there is probably meant.
    fn unknown(&self, wanted: &str, folder: Option<&Path>) -> ProfileError {
        let there = |file: &str| folder.unwrap_or(Path::new("")).join(file).is_file();
        if parse::has_others_ending(wanted) && there(wanted) {
            return ProfileError::OtherSlicers { file: wanted.to_owned() };
        }
        let bare = there(wanted).then(|| format!("./{wanted}"));
        let file = Some(format!("{wanted}.toml")).filter(|file| there(file)).or(bare);
        let known = self.all().into_iter().map(|found| found.name).collect();
        ProfileError::UnknownProfile { name: wanted.to_owned(), known, file }
    }

    /// The printer of a job that names none: `default.toml` in the first folder that has one, or
    /// else the shipped [`DEFAULT`](shipped::DEFAULT).
    #[must_use]
    pub fn default_printer(&self) -> Found {
        let mut files = self.folders.iter().map(|dir| dir.join(DEFAULT_FILE));
        files.find(|path| path.is_file()).map_or_else(
            || Found::shipped(ProfileKind::Printer, shipped::DEFAULT),
            |path| Found::file(path, Some(ProfileKind::Printer)),
        )
    }

    /// Every profile that a name finds, by kind and name; the shipped ones in their own order
    /// after those of the user.
    #[must_use]
    pub fn all(&self) -> Vec<Found> {
        let mut all: Vec<Found> = Vec::new();
        for kind in ProfileKind::ALL {
            let mut own: Vec<Found> = Vec::new();
            for folder in &self.folders {
                let entries = std::fs::read_dir(folder.join(folder_of(kind))).into_iter().flatten();
                let files = entries.flatten().map(|entry| entry.path());
                let toml = files.filter(|path| path.extension().is_some_and(|end| end == "toml"));
                own.extend(toml.map(|path| Found::shelved(path, kind)));
            }
            // The first folder wins.
            own.sort_by(|a, b| a.name.cmp(&b.name));
            own.dedup_by(|later, first| later.name == first.name);
            let shipped = shipped::names(kind).map(|name| Found::shipped(kind, name));
            let shipped = shipped.filter(|one| own.iter().all(|mine| mine.name != one.name));
            all.extend(own.iter().cloned().chain(shipped));
        }
        all
    }
}

fn is_file_name(name: &str) -> bool {
    name.contains(['/', std::path::MAIN_SEPARATOR])
        || Path::new(name).extension().is_some_and(|ending| ending == "toml")
}
