//! Profile names or files + overrides -> Profile: merges the layers and remembers where each value is from.
//!
//! Words: a *layer* is the text of one profile; *merged* are the dotted keys that have a value
//! so far, each with its origin. Values are merged from the most general to the most special, so
//! that the last one written wins:
//!
//! 1. the defaults of the keys,
//! 2. for each profile asked for: what it inherits, then its own values,
//! 3. the overrides of the command line, in their order.
//!
//! Each value is checked by its key when it is merged, so that a wrong one is reported with its
//! own place even where another would win over it. At the end the keys are nested again and
//! become [`Settings`]; whether they can print together is for `check.rs` to say.

use super::error::{ProfileError, Result};
use super::keys::{self, Kind};
use super::origin::{Override, Profile, ValueOrigin};
use super::shipped::{self, builtin_names};
use super::{Settings, check, parse};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use toml::Value;

/// Bytes of a profile, at most; start and end blocks are the longest part of one. A device has no end.
const MOST_BYTES: u64 = 1 << 20;

/// Loads profiles, each laid over those before it, lays `overrides` over them in their order,
/// and checks the result.
///
/// A name with a path separator or the ending `.toml` is a file, any other the
/// name of a shipped profile. What no profile says is the key's default.
///
/// # Errors
/// [`ProfileError`], one line that starts with the file and line or the flag:
/// unreadable file, unknown profile, cyclic `inherits`, TOML syntax, unknown
/// key, wrong type, out of range, a key without value, values that cannot print
/// together, blocks that cannot be filled in.
pub fn load(
    names: impl IntoIterator<Item = impl AsRef<str>>,
    overrides: &[Override],
) -> Result<Profile> {
    let profile = merge(names, overrides)?;
    check::together(&profile.settings, &profile.origins)?;
    Ok(profile)
}

/// As [`load`], each value checked, but not whether they can print together.
pub(super) fn merge(
    names: impl IntoIterator<Item = impl AsRef<str>>,
    overrides: &[Override],
) -> Result<Profile> {
    let mut merged = defaults();
    let (mut known, mut shown) = (Vec::new(), Vec::new());
    for name in names {
        let layer = Layer::find(name.as_ref(), None)?;
        known.push(layer.name.clone());
        shown.push(layer.shown.clone());
        merge_layer(layer, &mut Vec::new(), &mut merged)?;
    }
    for given in overrides {
        merge_override(given, &mut merged)?;
    }
    let settings = build(&shown.join(" + "), &merged)?;
    let origins = merged.into_iter().map(|(key, (_, origin))| (key, origin)).collect();
    Ok(Profile { settings, origins, name: known.join(" + ") })
}

/// Key -> value and origin.
type Merged = BTreeMap<String, (Value, ValueOrigin)>;

/// What holds where no profile says otherwise.
fn defaults() -> Merged {
    let row = |key: &'static keys::Key| {
        // A test holds defaults against the limits.
        let value = key.check(key.default.clone()?).ok()?;
        Some((key.name.clone(), (value, ValueOrigin::Default)))
    };
    keys::KEYS.iter().filter_map(row).collect()
}

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
    fn find(wanted: &str, folder: Option<&Path>) -> Result<Self> {
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
        Err(ProfileError::UnknownProfile { name: wanted.to_owned() })
    }

    fn text(&self) -> Result<String> {
        let Some(path) = &self.path else {
            return Ok(shipped::text(&self.name).unwrap_or_default().to_owned());
        };
        let shown = &self.shown;
        let mut text = String::new();
        let read = File::open(path)
            .and_then(|file| file.take(MOST_BYTES + 1).read_to_string(&mut text))
            .map_err(|source| ProfileError::Unreadable { file: shown.clone(), source })?;
        if read as u64 > MOST_BYTES {
            return Err(ProfileError::TooLarge { file: shown.clone() });
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
        let origin = ValueOrigin::File { name: shown.clone(), line: entry.line };
        let parent = inherited(entry, &origin, folder.as_deref())?;
        if let Some(start) = chain.iter().position(|one| one.identity == parent.identity) {
            let files = chain[start..].iter().chain([&parent]).map(|one| one.shown.clone());
            return Err(ProfileError::Circle { origin, files: files.collect() });
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

fn inherited(entry: &parse::Entry, origin: &ValueOrigin, folder: Option<&Path>) -> Result<Layer> {
    let Value::String(wanted) = &entry.value else {
        return Err(ProfileError::InheritsNoName { origin: origin.clone() });
    };
    Layer::find(wanted, folder).map_err(|source| {
        let origin = origin.clone();
        ProfileError::Inherits { origin, source: Box::new(source) }
    })
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
        return Err(ProfileError::UnknownKey { origin, key: key.to_owned() });
    };
    let value = match known.check(value) {
        Ok(value) => value,
        Err(source) => return Err(ProfileError::Value { origin, key: key.to_owned(), source }),
    };
    merged.insert(key.to_owned(), (value, origin));
    Ok(())
}

/// Nests the dotted keys again and makes the typed value of them.
fn build(shown: &str, merged: &Merged) -> Result<Settings> {
    if let Some(key) = keys::KEYS.iter().find(|k| !k.optional && !merged.contains_key(&k.name)) {
        return Err(ProfileError::Missing { profile: shown.to_owned(), key: key.name.clone() });
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
    Settings::deserialize(root).map_err(|source| {
        let profile = shown.to_owned();
        ProfileError::Mismatch { profile, source: Box::new(source) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::DEFAULT;
    use crate::profile::{DualMode, RetractWhen};
    use std::fs;

    fn set(key: &str, value: &str) -> Override {
        Override { key: key.to_owned(), value: value.to_owned(), origin: ValueOrigin::Set }
    }

    fn refused(overrides: &[Override]) -> String {
        load([DEFAULT], overrides).unwrap_err().to_string()
    }

    #[test]
    fn every_shipped_profile_loads() {
        for name in builtin_names() {
            let profile = load([name], &[]).unwrap();
            assert_eq!(profile.name, name);
            assert!(!profile.settings.description.is_empty());
        }
        assert_eq!(builtin_names().next(), Some(DEFAULT));
    }

    #[test]
    fn the_thesis_profile_is_the_thesis() {
        let thesis = load(["thesis"], &[]).unwrap();
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
        let profile = load([DEFAULT], &given).unwrap();
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
            (
                "machine.end_gcode",
                "G21\n\u{1b}[2J",
                "--set: machine.end_gcode, line 2 of it: there is a control character",
            ),
            ("machine.start_gcode", "G21", ""),
            ("machine.relative_e", "true", "--set: machine.relative_e = true, but"),
        ] {
            if start.is_empty() {
                assert!(load([DEFAULT], &[set(key, value)]).is_ok());
                continue;
            }
            let message = refused(&[set(key, value)]);
            assert!(message.starts_with(start), "{message}");
            assert!(!message.contains('\n'), "{message}");
        }
    }

    #[test]
    fn names_of_other_slicers_and_old_ones_are_answered_by_ours() {
        for (key, value, text) in [
            ("retraction.feed", "20", "--set: `retraction.feed` is called `retraction.speed` now"),
            ("perimeters", "2", "--set: unknown key `perimeters`; here it is `walls`"),
            (
                "nozzle_diameter",
                "0.4",
                "--set: unknown key `nozzle_diameter`; here it is `machine.nozzle_diameter`",
            ),
            (
                "perimeter_speed",
                "50",
                "--set: unknown key `perimeter_speed`; here it is `speed.wall`",
            ),
            (
                "retract_lift",
                "1",
                "--set: unknown key `retract_lift`; here it is `retraction.z_hop`",
            ),
            ("brim_width", "5", "--set: unknown key `brim_width`; a brim is not supported yet"),
        ] {
            assert_eq!(refused(&[set(key, value)]), text);
        }
    }

    #[test]
    fn speeds_that_look_like_mm_per_minute_are_refused() {
        for (key, value, start) in [
            (
                "speed.travel",
                "1000",
                "--set: speed.travel = 1000 is out of range; it must be 0.1 to 999 mm/s; \
                 speeds are in mm/s, 1000 mm/min would be 16.667",
            ),
            ("limits.speed_y", "1000", "--set: limits.speed_y = 1000 is out of range"),
            ("speed.z", "100.1", "--set: speed.z = 100.1 is out of range; it must be 0.1 to 100"),
            ("retraction.speed", "201", "--set: retraction.speed = 201 is out of range"),
        ] {
            let message = refused(&[set(key, value)]);
            assert!(message.starts_with(start), "{message}");
        }
        for (key, value) in
            [("speed.travel", "999"), ("speed.z", "100"), ("retraction.speed", "200")]
        {
            assert!(load([DEFAULT], &[set(key, value)]).is_ok(), "{key}");
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
    fn a_later_profile_is_laid_over_the_earlier() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("petg.toml");
        fs::write(&file, "[filament]\nname = \"PETG\"\n").unwrap();
        let profile = load(["witbox-1", file.to_str().unwrap()], &[]).unwrap();
        assert_eq!(profile.settings.filament.name, "PETG");
        assert_eq!(profile.settings.machine.name, "bq Witbox 1");
        assert_eq!(profile.name, "witbox-1 + petg.toml");
        let profile = load([file.to_str().unwrap(), "witbox-1"], &[]).unwrap();
        assert_eq!(profile.settings.filament.name, "PLA");
    }

    #[test]
    fn what_no_profile_says_is_the_default() {
        let profile = load(["generic-marlin"], &[]).unwrap();
        assert_eq!(profile.settings.dual.mode, DualMode::Off);
        assert_eq!(profile.origins["dual.mode"], ValueOrigin::Default);
        assert!(!profile.origins.contains_key("top_layers"));
    }

    #[test]
    fn errors_can_be_matched_on_and_have_their_causes() {
        use crate::profile::error::{Conflict, ProfileError, ValueError};
        use std::error::Error as _;
        let error = load([DEFAULT], &[set("walls", "101")]).unwrap_err();
        let ProfileError::Value { origin: ValueOrigin::Set, key, source } = &error else {
            panic!("{error:?}");
        };
        assert!(key == "walls" && matches!(source, ValueError::OutOfRange { .. }), "{error:?}");
        assert!(error.source().unwrap().is::<ValueError>());
        let error = load(["./no.toml"], &[]).unwrap_err();
        assert!(error.source().unwrap().is::<std::io::Error>(), "{error:?}");
        let error = load([DEFAULT], &[set("layer_height", "0.5")]).unwrap_err();
        assert!(
            matches!(
                error,
                ProfileError::Conflict { source: Conflict::HigherThanNozzle { height, .. }, .. }
                    if height == 0.5
            ),
            "{error:?}"
        );
    }

    #[test]
    fn unknown_profiles_get_a_suggestion_and_the_list() {
        let message = load(["zcube"], &[]).unwrap_err().to_string();
        assert!(message.contains("did you mean `zcube-dual`? Known are zcube-dual,"), "{message}");
        let message = load(["./no.toml"], &[]).unwrap_err().to_string();
        assert!(message.starts_with("./no.toml: cannot read this profile: "), "{message}");
    }

    #[test]
    fn files_inherit_from_names_and_files_beside_them() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        fs::write(at("a.toml"), "inherits = \"b.toml\"\nwalls = 3\n").unwrap();
        fs::write(at("b.toml"), "inherits = \"witbox-1\"\nwalls = 4\ninfill = 7\n").unwrap();
        let profile = load([&at("a.toml")], &[]).unwrap();
        assert_eq!((profile.settings.walls, profile.settings.infill), (3, 7.0));
        assert_eq!(profile.settings.machine.name, "bq Witbox 1");
        assert_eq!(profile.name, "a.toml");

        fs::write(at("b.toml"), "walls = 4\ninherits = \"./a.toml\"\n").unwrap();
        let message = load([&at("a.toml")], &[]).unwrap_err().to_string();
        assert!(message.contains("b.toml:2: inherits goes round in a circle: "), "{message}");

        // A table whose lines are all commented out is no mistake, unless nobody knows it.
        fs::write(at("b.toml"), "inherits = \"thesis\"\n[dual]\n# mode = 1\n").unwrap();
        assert!(load([&at("a.toml")], &[]).is_ok());
        fs::write(at("b.toml"), "inherits = \"thesis\"\n[duel]\n").unwrap();
        let message = load([&at("a.toml")], &[]).unwrap_err().to_string();
        assert!(message.contains("b.toml:2: unknown key `duel`"), "{message}");

        fs::write(at("b.toml"), "walls = 4\n").unwrap();
        let message = load([&at("a.toml")], &[]).unwrap_err().to_string();
        assert!(message.contains("`description` has no value"), "{message}");
    }
}
