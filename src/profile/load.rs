//! Layers + overrides -> Profile: merges their values and remembers where each one is from.
//!
//! Values are merged from the most general to the most special, so that the last one written wins:
//!
//! 1. the defaults of the keys,
//! 2. the [`layers`](super::layers), one after the other,
//! 3. the overrides of the command line, in their order,
//! 4. keys that nobody set and that follow another one, such as the line's width the nozzle's.
//!
//! Each value is checked by its key when it is merged, so that a wrong one is reported with its
//! own place even where another would win over it. At the end the keys are nested again and
//! become [`Settings`]; whether they can print together is for `check.rs` to say.

use super::error::{ProfileError, Result};
use super::keys::{self, Kind};
use super::layers::{Laid, Layer, Wanted, layers};
use super::origin::{Override, Profile, Source, Sources, ValueOrigin};
use super::shelf::Shelf;
use super::{Settings, check, outdone, parse};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Value;

/// Loads shipped profiles and files, each laid over those before it, lays `overrides` over them in
/// their order, and checks the result.
///
/// # Errors
/// As [`load_from`].
pub fn load(
    names: impl IntoIterator<Item = impl AsRef<str>>,
    overrides: &[Override],
) -> Result<Profile> {
    let wanted: Vec<Wanted> = names.into_iter().map(|name| Wanted::any(name.as_ref())).collect();
    load_from(&Shelf::default(), &wanted, overrides)
}

/// As [`load`], of profiles that are found on `shelf`; none at all is the default printer.
///
/// A name with a path separator or the ending `.toml` is a file, any other the name of a profile
/// on the shelf. What no profile says is the key's default.
///
/// # Errors
/// [`ProfileError`], one line that starts with the file and line or the flag: unreadable file,
/// unknown profile, profile of another kind, cyclic `inherits`, TOML syntax, unknown key, wrong
/// type, out of range, a key without value, values that cannot print together, blocks that cannot
/// be filled in.
pub fn load_from(shelf: &Shelf, wanted: &[Wanted], overrides: &[Override]) -> Result<Profile> {
    let profile = merge(shelf, wanted, &[overrides])?;
    check::together(&profile.settings, &profile.origins)?;
    Ok(profile)
}

/// All that is wrong with profiles, as far as one fault does not hide another: each unknown key and each wrong
/// value in its place; where there is none, the first other fault, if there is any.
#[must_use]
pub fn faults(shelf: &Shelf, wanted: &[Wanted], overrides: &[Override]) -> Vec<ProfileError> {
    let (mut merged, mut found) = (defaults(), Vec::new());
    // Whatever keeps them from being read is told by loading them.
    let layers = layers(wanted, shelf).unwrap_or_default().layers;
    for (key, value, origin) in layers.into_iter().flat_map(Layer::settings) {
        found.extend(insert(&key, value, origin, &mut merged).err());
    }
    for given in overrides {
        found.extend(merge_override(given, &mut merged).err());
    }
    if found.is_empty() {
        found.extend(load_from(shelf, wanted, overrides).err());
    }
    found
}

/// As [`load_from`], of several lists of overrides, each laid over those before it. Each value is checked, but
/// not whether they can print together.
pub(super) fn merge(
    shelf: &Shelf,
    wanted: &[Wanted],
    overrides: &[&[Override]],
) -> Result<Profile> {
    let mut merged = defaults();
    let Laid { layers, asked, printer, is_printer_chosen } = layers(wanted, shelf)?;
    let list: Vec<Source> = layers.iter().map(Layer::source).collect();
    for layer in layers {
        named_head(layer.entries.iter().map(|entry| entry.key.as_str()), &mut merged);
        for (key, value, origin) in layer.settings() {
            insert(&key, value, origin, &mut merged)?;
        }
    }
    for layer in overrides {
        named_head(layer.iter().map(|given| given.key.as_str()), &mut merged);
        for given in *layer {
            merge_override(given, &mut merged)?;
        }
    }
    counts_hold_alone(&mut merged);
    follow(&mut merged);
    let left_cold = cold_bed(&mut merged);
    let last = list.last();
    let last = last.map_or("", |source: &Source| source.file.as_ref().unwrap_or(&source.name));
    let settings = build(last, &merged)?;
    let origins = merged.into_iter().map(|(key, (_, origin))| (key, origin)).collect();
    let outdone = outdone::find(&settings, &origins, &list);
    let sources = Sources { list, asked, printer, is_printer_chosen, left_cold, outdone };
    Ok(Profile { settings, origins, sources })
}

/// Key -> value and origin.
type Merged = BTreeMap<String, (Value, ValueOrigin)>;

/// The key that names a head.
const HEAD_NAME: &str = "head.name";

/// What holds where no profile says otherwise.
fn defaults() -> Merged {
    let row = |key: &'static keys::Key| {
        // A test holds defaults against the limits.
        let value = key.check(key.default.clone()?).ok()?;
        Some((key.name.clone(), (value, ValueOrigin::Default)))
    };
    keys::KEYS.iter().filter_map(row).collect()
}

/// A layer with these `keys` comes next: if it names a head, what was said of the head before is of another one.
/// What the layer itself says stays, wherever it stands in it.
fn named_head<'a>(mut keys: impl Iterator<Item = &'a str>, merged: &mut Merged) {
    if keys.any(|key| key == HEAD_NAME) {
        merged.retain(|key, _| !key.starts_with("head.") || key == HEAD_NAME);
    }
}

/// Sets the keys that nobody set and that follow another key.
fn follow(merged: &mut Merged) {
    for key in keys::KEYS.iter() {
        let Some(follows) = &key.follows else { continue };
        let is_open = matches!(merged.get(&key.name), None | Some((_, ValueOrigin::Default)));
        let led = merged.get(&follows.key).filter(|(_, origin)| *origin != ValueOrigin::Default);
        let Some(number) = led.filter(|_| is_open).and_then(|(value, _)| parse::number(value))
        else {
            continue;
        };
        // In range wherever the other is, which a test holds.
        if let Ok(value) = key.check(Value::Float(follows.of(number))) {
            merged.insert(key.name.clone(), (value, ValueOrigin::Follows(follows.key.clone())));
        }
    }
}

/// Keeps the bed cold that cannot be heated, whatever the material asks for. Returns what it asks for, °C, if it
/// asks for more than 0.
fn cold_bed(merged: &mut Merged) -> Option<u32> {
    const SWITCH: &str = "machine.heated_bed";
    if merged.get(SWITCH).is_none_or(|(value, _)| value.as_bool() != Some(false)) {
        return None;
    }
    let mut asked = 0.0_f64;
    for key in ["filament.bed_temperature", "filament.first_layer_bed_temperature"] {
        let cold = (Value::Float(0.0), ValueOrigin::Follows(SWITCH.to_owned()));
        let before = merged.insert(key.to_owned(), cold);
        asked = asked.max(before.and_then(|(value, _)| parse::number(&value)).unwrap_or(0.0));
    }
    (asked > 0.0).then_some(asked.round() as u32)
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

/// Numbers of skin layers, and the thickness that a number given for this run switches off.
const COUNTED: &[([&str; 2], &str)] = &[
    (["skin_layers", "top_layers"], "top_thickness"),
    (["skin_layers", "bottom_layers"], "bottom_thickness"),
];

/// Whoever asks for 2 layers gets 2, whatever thickness a profile has; unless he gave both.
fn counts_hold_alone(merged: &mut Merged) {
    for (counts, thickness) in COUNTED {
        let given = |key: &str| merged.get(key).map(|(_, at)| at).filter(|at| at.is_given());
        let count = counts.iter().rev().find_map(|key| given(key)).cloned();
        if let Some(origin) = count.filter(|_| given(thickness).is_none()) {
            merged.insert((*thickness).to_owned(), (Value::Float(0.0), origin));
        }
    }
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
    // In the order of the keys, so that a table of keys that are all unset is there as well.
    for key in keys::KEYS.iter() {
        nest(&mut root, &key.name, merged.get(&key.name).map(|(value, _)| value.clone()));
    }
    // Every value has been checked against the table of keys, which a test
    // holds against the type: this can only fail if the two have parted.
    Settings::deserialize(root).map_err(|source| {
        let profile = shown.to_owned();
        ProfileError::Mismatch { profile, source: Box::new(source) }
    })
}

/// Puts a value, if there is one, in the table that its dotted key names.
fn nest(table: &mut toml::Table, key: &str, value: Option<Value>) {
    let Some((name, rest)) = key.split_once('.') else {
        table.extend(value.map(|value| (key.to_owned(), value)));
        return;
    };
    let inner = table.entry(name).or_insert_with(|| Value::Table(toml::Table::new()));
    if let Value::Table(inner) = inner {
        nest(inner, rest, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{DEFAULT, DualMode, RetractWhen, builtin_names};
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
            assert_eq!(profile.sources.to_string(), name);
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
        assert!(thesis.origins["walls"].to_string().starts_with("one-wall:"));
        assert!(thesis.origins["retraction.length"].to_string().starts_with("zcube-dual:"));
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
            (
                "infill",
                "0.2",
                "--set: infill = 0.2 % is next to nothing: it counts in %, where 20 is a fifth; write 20 for",
            ),
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
            ("brim_width", "5", "--set: unknown key `brim_width`; here it is `brim.width`"),
            (
                "spiral_vase",
                "1",
                "--set: unknown key `spiral_vase`; a spiral vase is not supported yet",
            ),
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
    fn a_number_of_skin_layers_given_for_the_run_holds_alone() {
        let thickness = |given: &[Override]| {
            let settings = load(["generic-marlin"], given).unwrap().settings;
            [settings.top_thickness, settings.bottom_thickness]
        };
        assert_eq!(thickness(&[]), [0.8, 0.8]);
        assert_eq!(thickness(&[set("skin_layers", "2")]), [0.0, 0.0]);
        assert_eq!(thickness(&[set("bottom_layers", "2")]), [0.8, 0.0]);
        let both = [set("top_thickness", "1.2"), set("skin_layers", "2")];
        assert_eq!(thickness(&both), [1.2, 0.0]);
        // A profile's own number stands beside its thickness.
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.toml");
        fs::write(&file, "inherits = \"generic-marlin\"\nskin_layers = 2\n").unwrap();
        let profile = load([file.to_str().unwrap()], &[]).unwrap();
        assert_eq!(profile.settings.top_thickness, 0.8);
    }

    #[test]
    fn a_later_profile_is_laid_over_the_earlier() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("petg.toml");
        fs::write(&file, "[filament]\nname = \"PETG\"\n").unwrap();
        let profile = load(["witbox-1", file.to_str().unwrap()], &[]).unwrap();
        assert_eq!(profile.settings.filament.name, "PETG");
        assert_eq!(profile.settings.machine.name, "bq Witbox 1");
        assert_eq!(profile.sources.to_string(), "witbox-1 + petg.toml");
        // Not over what a printer names as its usual material, which lies below all of them.
        let profile = load([file.to_str().unwrap(), "witbox-1"], &[]).unwrap();
        assert_eq!(profile.settings.filament.name, "PETG");
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
        assert_eq!(
            message,
            "unknown profile `zcube`; did you mean `zcube-dual`?; `slicer profile list` names all, and a \
             file ends in .toml or is given as ./zcube"
        );
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
        assert_eq!(profile.sources.to_string(), "a.toml");

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
