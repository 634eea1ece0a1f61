//! Profile: settings with where each value comes from, and values that the command line gives.

use super::Settings;
use std::collections::BTreeMap;
use std::fmt;

/// Settings and where they come from.
#[derive(Debug, Clone)]
pub struct Profile {
    /// All effective settings, checked.
    pub settings: Settings,
    /// For each dotted key that is set, what set it last.
    pub origins: BTreeMap<String, ValueOrigin>,
    /// Built-in name, or name of the file without its folder, so that an
    /// output that quotes it does not depend on where the file lay. Of several
    /// profiles all names, with ` + ` between them.
    pub name: String,
}

/// What gave a setting its value. Displays as the start of an error message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ValueOrigin {
    /// The key's default.
    Default,
    /// A line of a profile.
    File {
        /// The file as the user named it, or the name of a built-in profile.
        name: String,
        /// Line, from 1.
        line: usize,
    },
    /// `--set`.
    Set,
    /// A flag of its own, such as `--layer-height`.
    Flag(&'static str),
    /// The comments of a G-code file.
    Recorded,
    /// The program that embeds the library.
    Program,
}

impl fmt::Display for ValueOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { name, line } => write!(f, "{name}:{line}"),
            Self::Default => f.write_str("default"),
            Self::Set => f.write_str("--set"),
            Self::Flag(flag) => f.write_str(flag),
            Self::Recorded => f.write_str("the file's own settings"),
            Self::Program => f.write_str("the program"),
        }
    }
}

/// A value given on the command line.
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    /// Dotted key.
    pub key: String,
    /// TOML value, or bare text where it is none.
    pub value: String,
    /// For messages.
    pub origin: ValueOrigin,
}
