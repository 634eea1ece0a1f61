//! Profile: settings with where each value comes from, and values that the command line gives.

use super::Settings;
use super::kind::ProfileKind;
use std::collections::BTreeMap;
use std::fmt;

/// Settings and where they come from.
#[derive(Debug, Clone)]
pub struct Profile {
    /// All effective settings, checked.
    pub settings: Settings,
    /// For each dotted key that is set, what set it last.
    pub origins: BTreeMap<String, ValueOrigin>,
    /// The profiles that had a say.
    pub sources: Sources,
}

/// The profiles that had a say, the most general first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sources {
    /// Each of them once for every time that it was laid.
    pub list: Vec<Source>,
    /// The names of those that were asked for, of a file without its folder, so that an output
    /// that quotes them does not depend on where it lay. If none was, all are defaults.
    pub asked: Vec<String>,
    /// The printer: the last profile asked for that is one or inherits one, or else the default.
    pub printer: String,
    /// Whether somebody chose it, here or as a default of his own; otherwise it is the shipped default.
    pub is_printer_chosen: bool,
    /// What the material asks of the bed, whole °C, where machine.heated_bed says that it cannot be heated.
    pub left_cold: Option<u32>,
    /// Numbers of skin layers that a thickness outdoes.
    pub outdone: Vec<Outdone>,
}

/// A number of layers that is not what is printed.
#[derive(Debug, Clone, PartialEq)]
pub struct Outdone {
    /// Its key.
    pub key: &'static str,
    /// The thickness that asks for more.
    pub by: &'static str,
    /// That thickness, mm.
    pub thickness_mm: f64,
    /// The layers that it takes.
    pub layers: u32,
}

/// A profile that had a say.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The built-in name, or the file's name without its folder.
    pub name: String,
    /// What it describes; `None` for a file that may hold anything.
    pub kind: Option<ProfileKind>,
    /// The file as it was named or found; `None` for a shipped profile.
    pub file: Option<String>,
}

impl Sources {
    /// The name of the last profile of this kind.
    #[must_use]
    pub fn of(&self, kind: ProfileKind) -> Option<&str> {
        let last = self.list.iter().rev().find(|source| source.kind == Some(kind));
        last.map(|source| source.name.as_str())
    }
}

impl fmt::Display for Sources {
    /// The names that were asked for, with ` + ` between them, or that of the default printer.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.asked.is_empty() {
            return f.write_str(self.of(ProfileKind::Printer).unwrap_or_default());
        }
        f.write_str(&self.asked.join(" + "))
    }
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
    /// Another key, which this one follows where nobody sets it.
    Follows(String),
    /// `--set`.
    Set,
    /// A flag of its own, such as `--layer-height`.
    Flag(&'static str),
    /// The comments of a G-code file.
    Recorded,
    /// The program that embeds the library.
    Program,
}

impl ValueOrigin {
    /// Whether it was given for this run alone: by a flag, `--set`, or the program that embeds the library.
    #[must_use]
    pub fn is_given(&self) -> bool {
        matches!(self, Self::Set | Self::Flag(_) | Self::Program)
    }
}

impl fmt::Display for ValueOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { name, line } => write!(f, "{name}:{line}"),
            Self::Default => f.write_str("default"),
            Self::Follows(key) => write!(f, "follows {key}"),
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
