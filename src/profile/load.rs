//! Profile name or file + overrides -> Profile: merges the layers and remembers where each value is from.

use super::keys::{self, Kind};
use super::{Settings, check, old, parse, suggest};
use crate::error::{Error, Result};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use toml::Value;

/// Name of the profile that is used where none is asked for.
pub const DEFAULT: &str = "zcube-dual";

/// Bytes of a profile, at most; start and end blocks are the longest part of one. A device has no end.
const MOST_BYTES: u64 = 1 << 20;

/// The shipped profiles: name and text.
const BUILTIN: &[(&str, &str)] = &[
    ("zcube-dual", include_str!("../../profiles/zcube-dual.toml")),
    ("replicator", include_str!("../../profiles/replicator.toml")),
    ("thesis", include_str!("../../profiles/thesis.toml")),
    ("generic-marlin", include_str!("../../profiles/generic-marlin.toml")),
    ("generic-klipper", include_str!("../../profiles/generic-klipper.toml")),
    ("witbox-1", include_str!("../../profiles/witbox-1.toml")),
];

/// Settings and where they come from.
#[derive(Debug, Clone)]
pub struct Profile {
    /// All effective settings, checked.
    pub settings: Settings,
    /// For each dotted key that is set, what set it last.
    pub origins: BTreeMap<String, ValueOrigin>,
    /// Built-in name, or name of the file without its folder, so that an
    /// output that quotes it does not depend on where the file lay.
    pub name: String,
}

/// What gave a setting its value. Displays as the start of an error message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ValueOrigin {
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

/// Names of the shipped profiles, [`DEFAULT`] first.
pub fn builtin_names() -> impl Iterator<Item = &'static str> {
    BUILTIN.iter().map(|(name, _)| *name)
}

/// Loads a profile, lays `overrides` over it in their order, and checks the result.
///
/// A name with a path separator or the ending `.toml` is a file, any other the
/// name of a shipped profile.
///
/// # Errors
/// [`Error::Config`] in one line that starts with the file and line or the flag:
/// unreadable file, unknown profile, cyclic `inherits`, TOML syntax, unknown
/// key, wrong type, out of range, a key without value, values that cannot print
/// together, blocks that cannot be filled in.
pub fn load(name_or_path: &str, overrides: &[Override]) -> Result<Profile> {
    let profile = merge(name_or_path, overrides)?;
    check::together(&profile.settings, &profile.origins)?;
    Ok(profile)
}

/// As [`load`], each value checked, but not whether they can print together.
pub(super) fn merge(name_or_path: &str, overrides: &[Override]) -> Result<Profile> {
    let mut merged = Merged::new();
    let layer = Layer::find(name_or_path, None).map_err(Error::Config)?;
    let name = layer.name.clone();
    merge_layer(layer, &mut Vec::new(), &mut merged)?;
    for given in overrides {
        merge_override(given, &mut merged)?;
    }
    let settings = build(name_or_path, &merged)?;
    let origins = merged.into_iter().map(|(key, (_, origin))| (key, origin)).collect();
    Ok(Profile { settings, origins, name })
}

/// Key -> value and origin.
type Merged = BTreeMap<String, (Value, ValueOrigin)>;

/// One profile text before it is read.
struct Layer {
    /// See [`Profile::name`].
    name: String,
    /// For messages: the path as the user wrote it.
    shown: String,
    /// `None` for a shipped profile.
    path: Option<PathBuf>,
    /// What tells two layers apart, whatever way they were named.
    identity: PathBuf,
}

impl Layer {
    /// The profile called `wanted`; relative files are looked for in `folder`.
    fn find(wanted: &str, folder: Option<&Path>) -> std::result::Result<Self, String> {
        if is_file_name(wanted) {
            let path = folder.map_or_else(|| PathBuf::from(wanted), |dir| dir.join(wanted));
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
            let identity = std::fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
            return Ok(Self {
                name: name.unwrap_or_else(|| wanted.to_owned()),
                shown: path.display().to_string(),
                path: Some(path),
                identity,
            });
        }
        if builtin_names().any(|name| name == wanted) {
            let name = wanted.to_owned();
            return Ok(Self { shown: name.clone(), path: None, identity: wanted.into(), name });
        }
        let names: Vec<_> = builtin_names().collect();
        Err(format!(
            "unknown profile `{}`{} Known are {}; a file ends in .toml or is given as ./{}",
            wanted.escape_debug(),
            match suggest::did_you_mean(wanted, builtin_names()) {
                hint if hint.is_empty() => ".".to_owned(),
                hint => hint,
            },
            names.join(", "),
            wanted.escape_debug()
        ))
    }

    fn text(&self) -> Result<String> {
        let Some(path) = &self.path else {
            let text = BUILTIN.iter().find(|(name, _)| *name == self.name);
            return Ok(text.map_or_else(String::new, |(_, text)| (*text).to_owned()));
        };
        let shown = &self.shown;
        let mut text = String::new();
        let read = File::open(path)
            .and_then(|file| file.take(MOST_BYTES + 1).read_to_string(&mut text))
            .map_err(|error| {
                Error::Config(format!("{shown}: cannot read this profile: {error}; check the path"))
            })?;
        if read as u64 > MOST_BYTES {
            let why = "is larger than any profile; check the path";
            return Err(Error::Config(format!("{shown}: {why}")));
        }
        Ok(text)
    }
}

fn is_file_name(name: &str) -> bool {
    name.contains(['/', std::path::MAIN_SEPARATOR])
        || Path::new(name).extension().is_some_and(|ending| ending == "toml")
}

/// Merges what `layer` inherits, then its own values. `chain` holds the layers being read.
fn merge_layer(layer: Layer, chain: &mut Vec<Layer>, merged: &mut Merged) -> Result<()> {
    let text = layer.text()?;
    let entries = parse::document(&layer.shown, &text)?;
    let shown = layer.shown.clone();
    let folder = layer.path.as_ref().and_then(|path| path.parent()).map(Path::to_owned);
    chain.push(layer);
    if let Some(entry) = entries.iter().find(|entry| entry.key == "inherits") {
        let place = format!("{shown}:{}", entry.line);
        let parent = inherited(entry, folder.as_deref())
            .map_err(|why| Error::Config(format!("{place}: inherits: {why}")))?;
        if let Some(start) = chain.iter().position(|one| one.identity == parent.identity) {
            let names = chain[start..].iter().chain([&parent]).map(|one| one.shown.as_str());
            let names: Vec<_> = names.collect();
            return Err(Error::Config(format!(
                "{place}: inherits goes round in a circle: {}; remove it from one of them",
                names.join(" -> ")
            )));
        }
        merge_layer(parent, chain, merged)?;
    }
    chain.pop();
    for entry in entries.into_iter().filter(|entry| entry.key != "inherits") {
        if entry.is_empty_table() {
            continue;
        }
        let origin = ValueOrigin::File { name: shown.clone(), line: entry.line };
        insert(&entry.key, entry.value, origin, merged)?;
    }
    Ok(())
}

fn inherited(entry: &parse::Entry, folder: Option<&Path>) -> std::result::Result<Layer, String> {
    let Value::String(wanted) = &entry.value else {
        return Err("must be the name of a profile or a file, in quotes".to_owned());
    };
    Layer::find(wanted, folder)
}

fn merge_override(given: &Override, merged: &mut Merged) -> Result<()> {
    let takes_text = keys::find(&given.key)
        .is_some_and(|key| matches!(key.kind, Kind::Text | Kind::Block | Kind::Word(_)));
    let value = match parse::value(&given.value) {
        // `--set filament.name=2024` means the text, whatever else TOML makes of it.
        value if takes_text && !value.is_str() => Value::String(given.value.clone()),
        value => value,
    };
    insert(&given.key, value, given.origin.clone(), merged)
}

fn insert(key: &str, value: Value, origin: ValueOrigin, merged: &mut Merged) -> Result<()> {
    let Some(known) = keys::find(key) else {
        return Err(Error::Config(format!("{origin}: {}", unknown_key(key))));
    };
    let value = known
        .check(value)
        .map_err(|why| Error::Config(format!("{origin}: {} {}", known.name, why.trim_end())))?;
    merged.insert(key.to_owned(), (value, origin));
    Ok(())
}

fn unknown_key(key: &str) -> String {
    let table = format!("{key}.");
    let inside: Vec<_> =
        keys::KEYS.iter().map(|one| one.name).filter(|name| name.starts_with(&table)).collect();
    if !inside.is_empty() {
        return format!("`{key}` is a table, not a value; set one of {}", inside.join(", "));
    }
    if let Some(name) = old::renamed(key) {
        return format!("`{key}` is called `{name}` now");
    }
    let names = keys::KEYS.iter().map(|one| one.name);
    let hint = suggest::did_you_mean(key, names);
    let more = if hint.is_empty() { "; `slicer profile show` lists all keys" } else { "" };
    format!("unknown key `{}`{hint}{more}", key.escape_debug())
}

/// Nests the dotted keys again and makes the typed value of them.
fn build(shown: &str, merged: &Merged) -> Result<Settings> {
    if let Some(key) = keys::KEYS.iter().find(|k| !k.optional && !merged.contains_key(k.name)) {
        return Err(Error::Config(format!(
            "{shown}: `{}` has no value; set it, or begin the file with inherits = \"{DEFAULT}\"",
            key.name
        )));
    }
    let mut root = toml::Table::new();
    for (key, (value, _)) in merged {
        match key.split_once('.') {
            None => {
                root.insert(key.clone(), value.clone());
            }
            Some((table, name)) => {
                let inner = root.entry(table).or_insert_with(|| Value::Table(toml::Table::new()));
                if let Value::Table(inner) = inner {
                    inner.insert(name.to_owned(), value.clone());
                }
            }
        }
    }
    // Every value has been checked against the table of keys, which a test
    // holds against the type: this can only fail if the two have parted.
    Settings::deserialize(root)
        .map_err(|error| Error::Config(format!("{shown}: {}", error.message().replace('\n', ", "))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{DualMode, RetractWhen};
    use std::fs;

    fn set(key: &str, value: &str) -> Override {
        Override { key: key.to_owned(), value: value.to_owned(), origin: ValueOrigin::Set }
    }

    fn refused(overrides: &[Override]) -> String {
        load(DEFAULT, overrides).unwrap_err().to_string()
    }

    #[test]
    fn every_shipped_profile_loads() {
        for name in builtin_names() {
            let profile = load(name, &[]).unwrap();
            assert_eq!(profile.name, name);
            assert!(!profile.settings.description.is_empty());
        }
        assert_eq!(builtin_names().next(), Some(DEFAULT));
    }

    #[test]
    fn shipped_profiles_say_unit_and_limits_of_each_key() {
        for (name, text) in BUILTIN {
            let lines: Vec<_> = text.lines().collect();
            for entry in parse::document(name, text).unwrap() {
                let Some(key) = keys::find(&entry.key) else {
                    continue;
                };
                // A block's comment stands above it.
                let back = if key.kind == Kind::Block { 2 } else { 1 };
                let line = lines[entry.line - back];
                let comment = line.rsplit_once("# ").map(|(_, comment)| comment);
                assert_eq!(comment, Some(key.comment().as_str()), "{name}:{}", entry.line);
            }
        }
    }

    #[test]
    fn the_thesis_profile_is_the_thesis() {
        let thesis = load("thesis", &[]).unwrap();
        let settings = &thesis.settings;
        assert_eq!(settings.dual.mode, DualMode::Pair);
        assert_eq!(settings.retraction.when, RetractWhen::Always);
        let end = 1.0 + settings.outer_wall_inset - settings.infill_overlap;
        assert!((end * settings.line_width - 0.3).abs() < 1e-9);
        // Inherited values keep the place they are written at.
        assert!(thesis.origins["speed.wall"].to_string().starts_with("zcube-dual:"));
        assert!(thesis.origins["dual.mode"].to_string().starts_with("thesis:"));
    }

    #[test]
    fn later_layers_win_and_are_remembered() {
        let flag = Override {
            key: "walls".to_owned(),
            value: "5".to_owned(),
            origin: ValueOrigin::Flag("--walls"),
        };
        let given = [set("walls", "4"), flag, set("dual.mode", "pair"), set("machine.name", "7")];
        let profile = load(DEFAULT, &given).unwrap();
        assert_eq!(profile.settings.walls, 5);
        assert_eq!(profile.settings.machine.name, "7");
        assert_eq!(profile.origins["walls"], ValueOrigin::Flag("--walls"));
        assert_eq!(profile.origins["dual.mode"], ValueOrigin::Set);
    }

    #[test]
    fn wrong_settings_are_refused_with_a_hint() {
        for (key, value, start) in [
            (
                "layer_heigth",
                "1",
                "--set: unknown key `layer_heigth`; did you mean `layer_height`?",
            ),
            ("speed", "1", "--set: `speed` is a table, not a value; set one of speed.wall,"),
            ("walls", "101", "--set: walls = 101 is out of range; it must be 0 to 100 walls"),
            ("retraction.feed", "20", "--set: `retraction.feed` is called `retraction.speed` now"),
            (
                "speed.travel",
                "1000",
                "--set: speed.travel = 1000 is out of range; it must be 0.1 to 999 mm/s; \
                 speeds are in mm/s, 1000 mm/min would be 16.667",
            ),
            ("limits.speed_y", "1000", "--set: limits.speed_y = 1000 is out of range"),
            ("speed.z", "100.1", "--set: speed.z = 100.1 is out of range; it must be 0.1 to 100"),
            ("retraction.speed", "201", "--set: retraction.speed = 201 is out of range"),
            ("infill", "x", "--set: infill is the text `x`; it must be a number, 0 to 100 %"),
            ("seam", "reer", "--set: seam = `reer` is unknown; did you mean `rear`?"),
            (
                "layer_height",
                "0.41",
                "--set: layer_height = 0.41 mm is more than machine.nozzle_diameter",
            ),
            ("line_width", "0.15", "--set: line_width = 0.15 mm is too little"),
            (
                "machine.end_gcode",
                "M104 S{temp}",
                "--set: machine.end_gcode, line 1 of it: unknown placeholder",
            ),
            ("machine.end_gcode", "M105", "--set: machine.end_gcode, line 1 of it: M105 must not"),
            ("machine.start_gcode", "G21", ""),
            ("machine.relative_e", "true", "--set: machine.relative_e = true, but"),
        ] {
            if start.is_empty() {
                assert!(load(DEFAULT, &[set(key, value)]).is_ok());
                continue;
            }
            let message = refused(&[set(key, value)]);
            assert!(message.starts_with(start), "{message}");
            assert!(!message.contains('\n'), "{message}");
        }
    }

    #[test]
    fn combinations_that_cannot_print_blame_the_command_line_first() {
        let message = refused(&[set("dual.mode", "pair"), set("layer_height", "0.3")]);
        assert!(message.starts_with("--set: 2 layers of layer_height = 0.3 mm"), "{message}");
        let message = refused(&[set("machine.nozzle_diameter", "0.1")]);
        assert!(message.starts_with("--set: layer_height = 0.2 mm is more"), "{message}");
        let message =
            refused(&[set("machine.start_gcode", "G21"), set("filament.bed_temperature", "60")]);
        assert!(message.contains("would have no effect"), "{message}");
    }

    #[test]
    fn unknown_profiles_get_a_suggestion_and_the_list() {
        let message = load("zcube", &[]).unwrap_err().to_string();
        assert!(message.contains("did you mean `zcube-dual`? Known are zcube-dual,"), "{message}");
        let message = load("./no.toml", &[]).unwrap_err().to_string();
        assert!(message.starts_with("./no.toml: cannot read this profile: "), "{message}");
    }

    #[test]
    fn files_inherit_from_names_and_files_beside_them() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        fs::write(at("a.toml"), "inherits = \"b.toml\"\nwalls = 3\n").unwrap();
        fs::write(at("b.toml"), "inherits = \"witbox-1\"\nwalls = 4\ninfill = 7\n").unwrap();
        let profile = load(&at("a.toml"), &[]).unwrap();
        assert_eq!((profile.settings.walls, profile.settings.infill), (3, 7.0));
        assert_eq!(profile.settings.machine.name, "bq Witbox 1");
        assert_eq!(profile.name, "a.toml");

        fs::write(at("b.toml"), "walls = 4\ninherits = \"./a.toml\"\n").unwrap();
        let message = load(&at("a.toml"), &[]).unwrap_err().to_string();
        assert!(message.contains("b.toml:2: inherits goes round in a circle: "), "{message}");

        // A table whose lines are all commented out is no mistake, unless nobody knows it.
        fs::write(at("b.toml"), "inherits = \"thesis\"\n[dual]\n# mode = 1\n").unwrap();
        assert!(load(&at("a.toml"), &[]).is_ok());
        fs::write(at("b.toml"), "inherits = \"thesis\"\n[duel]\n").unwrap();
        let message = load(&at("a.toml"), &[]).unwrap_err().to_string();
        assert!(message.contains("b.toml:2: unknown key `duel`"), "{message}");

        fs::write(at("b.toml"), "walls = 4\n").unwrap();
        let message = load(&at("a.toml"), &[]).unwrap_err().to_string();
        assert!(message.contains("`description` has no value"), "{message}");
    }
}
