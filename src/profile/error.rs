//! What can be wrong with a profile, as types: where, what, and the cause as a source.
//!
//! Every error displays as one line that starts with the place, then says what is wrong and what
//! to do. Words:
//!
//! - *origin*: the place. File and line, `--set`, or the flag that gave the value.
//! - [`ValueError`]: one value does not fit its key.
//! - [`Conflict`]: values that each fit their keys do not go together.
//! - [`BlockError`]: a start or end block cannot be filled in.

pub use super::conflict::Conflict;
use super::foreign::{self, Foreign};
use super::keys::{self, Key};
use super::kind::ProfileKind;
use super::origin::ValueOrigin;
use super::{old, suggest};
use crate::text;
use std::io;

/// A profile or a setting that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ProfileError {
    /// No profile has this name.
    #[error("unknown profile `{}`{}", text::line(name), unknown_profile(name, known, file.as_deref()))]
    UnknownProfile {
        /// The name asked for.
        name: String,
        /// Those that there are.
        known: Vec<String>,
        /// The file that is meant, as it has to be written.
        file: Option<String>,
    },
    /// A profile that describes another thing than asked for.
    #[error("{name} is a {is}, not a {wanted}; `slicer profile list` groups them")]
    OtherKind {
        /// The profile as the user named it.
        name: String,
        /// What it describes.
        is: ProfileKind,
        /// What was asked for.
        wanted: ProfileKind,
    },
    /// A profile file that cannot be read.
    #[error("{file}: cannot read this profile: {source}; check the path")]
    Unreadable {
        /// The file as the user named it.
        file: String,
        /// The system's reason.
        source: io::Error,
    },
    /// A file that is larger than any profile.
    #[error("{file}: is larger than any profile; check the path")]
    TooLarge {
        /// The file as the user named it.
        file: String,
    },
    /// A file that is no TOML.
    #[error("{file}:{line}: this is no valid TOML: {}; {}", one_line(source), mend(source))]
    Syntax {
        /// The file as the user named it.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The parser's reason.
        source: Box<toml::de::Error>,
    },
    /// A file of another slicer.
    #[error(
        "{file}: is no profile of this program, and settings of other slicers are not read; begin with \
         `slicer profile new ender-3 > mine.toml`, or another printer of `slicer profile list`"
    )]
    OtherSlicers {
        /// The file as the user named it.
        file: String,
    },
    /// A text of several lines in quotes for one line.
    #[error(
        "{file}:{line}: a text in single or double quotes ends on its line; put a block of several lines \
         between three quotes, ''' or \"\"\""
    )]
    OneLine {
        /// The file as the user named it.
        file: String,
        /// Line where it begins, from 1.
        line: usize,
    },
    /// `inherits` or a default that is no text.
    #[error("{origin}: {key}: must be the name of a profile or a file, in quotes")]
    NoName {
        /// Where it stands.
        origin: ValueOrigin,
        /// `inherits`, or such as `defaults.material`.
        key: String,
    },
    /// `inherits` or a default with a name that is not known.
    #[error("{origin}: {key}: {source}")]
    Named {
        /// Where it stands.
        origin: ValueOrigin,
        /// `inherits`, or such as `defaults.material`.
        key: String,
        /// What is wrong with the name.
        source: Box<ProfileError>,
    },
    /// Profiles that inherit each other.
    #[error(
        "{origin}: inherits goes round in a circle: {}; remove it from one of them",
        files.join(" -> ")
    )]
    Circle {
        /// Where the circle closes.
        origin: ValueOrigin,
        /// The profiles of the circle; the first is the last, too.
        files: Vec<String>,
    },
    /// A key that there is not.
    #[error("{origin}: {}", unknown_key(key))]
    UnknownKey {
        /// What gave it.
        origin: ValueOrigin,
        /// Its dotted name.
        key: String,
    },
    /// A value that its key cannot have.
    #[error("{origin}: {key} {source}")]
    Value {
        /// What gave it.
        origin: ValueOrigin,
        /// Dotted name of the key.
        key: String,
        /// What is wrong with it.
        source: ValueError,
    },
    /// A key that neither has a default nor is set.
    #[error(
        "{profile}: `{key}` has no value; set it, or begin the file with inherits = \"YOUR PRINTER\", such \
         as \"ender-3\" (slicer profile list)"
    )]
    Missing {
        /// The profile as the user named it.
        profile: String,
        /// Dotted name of the key.
        key: String,
    },
    /// Values that do not make settings, although each fits its key.
    #[error("{profile}: {}", one_line(source))]
    Mismatch {
        /// The profile as the user named it.
        profile: String,
        /// What does not fit.
        source: Box<toml::de::Error>,
    },
    /// Values that are each in range but cannot print together.
    #[error("{}{source}", place(origin.as_ref()))]
    Conflict {
        /// What gave the value that is most likely to blame.
        origin: Option<ValueOrigin>,
        /// What does not go together.
        source: Conflict,
    },
    /// A start or end block that cannot be filled in.
    #[error("{}{source}", place(origin.as_ref()))]
    Block {
        /// What gave it.
        origin: Option<ValueOrigin>,
        /// What is wrong with it.
        source: BlockError,
    },
}

impl From<BlockError> for ProfileError {
    fn from(source: BlockError) -> Self {
        Self::Block { origin: None, source }
    }
}

/// The result of everything that can fail with a [`ProfileError`].
pub type Result<T, E = ProfileError> = std::result::Result<T, E>;

/// A value that its key cannot have. Displays without the key's name.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ValueError {
    /// A number beyond the key's limits.
    #[error("= {value} {}", out_of_range(value, key))]
    OutOfRange {
        /// The number.
        value: String,
        /// The key.
        key: &'static Key,
    },
    /// A word that the key does not know.
    #[error("= `{}` is unknown{}; it must be {}", text::line(word), near(word, words), key.allowed())]
    UnknownWord {
        /// The word.
        word: String,
        /// The words there are.
        words: Vec<String>,
        /// The key.
        key: &'static Key,
    },
    /// A value of another type than the key's.
    #[error("is {found}; it must be {}", key.expected())]
    WrongType {
        /// The value, described.
        found: String,
        /// The key.
        key: &'static Key,
    },
    /// A list with something in it that does not belong there.
    #[error("holds {found}; it must be {}", key.expected())]
    WrongItem {
        /// What it holds.
        found: String,
        /// The key.
        key: &'static Key,
    },
    /// A text that is too long or has line breaks.
    #[error("must be {}", key.allowed())]
    NotOneLine {
        /// The key.
        key: &'static Key,
    },
}

/// Faults of a block that are told at once.
const MOST_TOLD: usize = 5;

/// A start or end block that cannot be filled in.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{block}, {}", told(faults))]
pub struct BlockError {
    /// The block's key.
    pub block: String,
    /// What is wrong, and in which lines of the block, from 1.
    pub faults: Vec<(usize, PlaceholderError)>,
}

/// The first faults, and how many more there are.
fn told(faults: &[(usize, PlaceholderError)]) -> String {
    let one = |(k, (line, fault)): (usize, &(usize, PlaceholderError))| {
        let of_it = if k == 0 { " of it" } else { "" };
        format!("line {line}{of_it}: {fault}")
    };
    let mut parts: Vec<String> = faults.iter().take(MOST_TOLD).enumerate().map(one).collect();
    if faults.len() > MOST_TOLD {
        parts.push(format!("and {} more", faults.len() - MOST_TOLD));
    }
    parts.join("; ")
}

/// A placeholder that cannot be filled in.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PlaceholderError {
    /// One that there is not.
    #[error("unknown placeholder {}; {}", text::line(written), placeholder_hint(written, known))]
    Unknown {
        /// As it stands in the block, with its brackets.
        written: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// One of another slicer.
    #[error("unknown placeholder {}; {}", text::line(written), here_it_is(ours.as_deref()))]
    Foreign {
        /// As it stands in the block, with its brackets.
        written: String,
        /// Ours for it, with braces, if there is one.
        ours: Option<String>,
    },
    /// A condition, which other slicers decide.
    #[error(
        "{} is a condition of another slicer, and nothing is computed here; write {}",
        text::line(written),
        if *lifts { "G1 Z{park_z} F600 in its place" } else { "the line as it shall be" }
    )]
    Condition {
        /// As it stands in the block, with its brackets.
        written: String,
        /// Whether its line moves z.
        lifts: bool,
    },
    /// A sum, which other slicers compute.
    #[error(
        "{} is a sum of another slicer, and nothing is computed here; {}",
        text::line(written),
        if *of_height {
            "{park_z} is 10 mm above the print, or the highest that the machine goes"
        } else {
            "write the number that it gives"
        }
    )]
    Sum {
        /// As it stands in the block, with its brackets.
        written: String,
        /// Whether it is one of the print's height.
        of_height: bool,
    },
    /// A closing brace without an opening one.
    #[error("a single `}}`; write `}}}}` for a brace")]
    SingleBrace,
    /// An opening brace without a closing one.
    #[error("a `{{` is not closed; write `{{{{` for a brace")]
    OpenBrace,
}

fn place(origin: Option<&ValueOrigin>) -> String {
    origin.map_or_else(String::new, |origin| format!("{origin}: "))
}

fn one_line(error: &toml::de::Error) -> String {
    error.message().replace('\n', ", ")
}

/// What to do about bad TOML.
fn mend(error: &toml::de::Error) -> &'static str {
    if error.message().contains("escape") {
        "a backslash stays as it is between ''' and '''; between other quotes write two"
    } else {
        "mend the line"
    }
}

/// What to do about a name of no profile. The names are too many to be listed.
fn unknown_profile(name: &str, known: &[String], file: Option<&str>) -> String {
    let shown = text::line(name);
    if let Some(file) = file {
        return format!("; there is such a file: write {}", text::line(file));
    }
    let mut hint = near(name, known);
    if hint.is_empty() {
        hint = suggest::containing(name, known.iter().map(String::as_str));
    }
    format!(
        "{hint}; `slicer profile list` names all, and a file ends in .toml or is given as ./{shown}"
    )
}

fn unknown_key(key: &str) -> String {
    let table = format!("{key}.");
    let inside: Vec<_> = keys::names().filter(|name| name.starts_with(&table)).collect();
    if !inside.is_empty() {
        return format!("`{key}` is a table, not a value; set one of {}", inside.join(", "));
    }
    if let Some(name) = old::renamed(key) {
        return format!("`{key}` is called `{name}` now");
    }
    let shown = text::line(key);
    match foreign::meaning(key) {
        Some(Foreign::Key(ours)) => return format!("unknown key `{shown}`; here it is `{ours}`"),
        Some(Foreign::NotSupported(what)) => {
            return format!("unknown key `{shown}`; {what} is not supported yet");
        }
        None => {}
    }
    if let Some((_, inner)) = key.rsplit_once('.')
        && keys::names().any(|name| name.starts_with(&format!("{inner}.")))
    {
        return format!(
            "unknown key `{shown}`; [{inner}] is a table of its own, not part of another"
        );
    }
    let hint = suggest::did_you_mean(key, keys::names());
    let more = if hint.is_empty() { "; `slicer profile show` lists all keys" } else { "" };
    format!("unknown key `{shown}`{hint}{more}")
}

fn out_of_range(value: &str, key: &Key) -> String {
    let text = format!("is out of range; it must be {} {}", key.allowed(), key.unit);
    match value.parse() {
        Ok(per_minute) if per_minute > 1.0 && old::was_per_minute(&key.name) => format!(
            "{text}; speeds are in mm/s, {value} mm/min would be {}",
            old::per_second(per_minute)
        ),
        _ => text.trim_end().to_owned(),
    }
}

fn near(word: &str, words: &[String]) -> String {
    suggest::did_you_mean(word, words.iter().map(String::as_str))
}

fn here_it_is(ours: Option<&str>) -> String {
    let none = "there is none for it here: write its value, or leave it out";
    ours.map_or_else(|| none.to_owned(), |ours| format!("here it is {ours}"))
}

fn placeholder_hint(written: &str, known: &[String]) -> String {
    let name = written.trim_matches(['{', '}', '[', ']', ' ']);
    suggest::nearest(name, known.iter().map(String::as_str)).map_or_else(
        || format!("known are {}", known.join(", ")),
        |near| format!("did you mean {{{near}}}?"),
    )
}
