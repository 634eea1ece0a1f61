//! Settings -> text: the lines that go into a G-code file, and a profile as TOML.
//!
//! Both show the keys in the order in which they are declared, which is the order of the table
//! of keys. They differ in purpose:
//!
//! - [`dump`] is for machines and for `diff`: one line for each key that has a value, each short
//!   enough for GPX, and without what stands in the file anyway.
//! - [`document`] is for people: a profile that gives the same settings again, with every key
//!   there is and where its value comes from.

use super::Settings;
use super::keys::{KEYS, Key, Kind};
use super::old::{FORMAT_KEY, SETTINGS_FORMAT};
use super::origin::Profile;
use std::fmt::Write as _;
use toml::Value;

/// Keys that are left out of G-code files: blocks would make lines longer than
/// GPX's limit of 1023 bytes and stand in the file anyway; the description
/// says nothing of the print.
pub(super) const NOT_DUMPED: &[&str] = &["description", "machine.start_gcode", "machine.end_gcode"];

/// The format of the settings, then all of them but the description and the blocks, as
/// dotted key and TOML value on one line of less than 900 bytes, in the order of
/// [`KEYS`]. What a G-code file holds as comments.
#[must_use]
pub fn dump(settings: &Settings) -> Vec<(String, String)> {
    let mut lines = values(settings);
    lines.retain(|(key, _)| !NOT_DUMPED.contains(&key.as_str()));
    std::iter::once((FORMAT_KEY.to_owned(), SETTINGS_FORMAT.to_string())).chain(lines).collect()
}

/// Every key that has a value, as dotted key and TOML value on one line.
#[must_use]
pub fn values(settings: &Settings) -> Vec<(String, String)> {
    let root = table_of(settings);
    let line = |key: &Key| Some((key.name.clone(), one_line(value_in(&root, key)?)));
    KEYS.iter().filter_map(line).collect()
}

/// The whole profile as a TOML file that gives the same settings again: every key there is,
/// each value with its origin as a comment, and a key that is unset as a comment, a head's with what
/// the named head has. With
/// `explain` also the unit, limits and meaning of each key.
#[must_use]
pub fn document(profile: &Profile, explain: bool) -> String {
    let mut text = String::new();
    let mut table = "";
    let root = table_of(&profile.settings);
    for key in KEYS.iter() {
        let (prefix, name) = key.name.split_once('.').unwrap_or(("", &key.name));
        if prefix != table {
            table = prefix;
            push(&mut text, format_args!("\n[{table}]\n"));
        }
        if explain {
            push(&mut text, format_args!("# {}\n", key.comment()));
        }
        let Some(value) = value_in(&root, key) else {
            let rest = match of_named_head(&profile.settings, &key.name) {
                Some(value) => format!("{}  # of the named head", one_line(&value)),
                None => " # unset".to_owned(),
            };
            push(&mut text, format_args!("# {name} = {rest}\n"));
            continue;
        };
        let value = if key.kind == Kind::Block { block(value) } else { one_line(value) };
        push(&mut text, format_args!("{name} = {value}"));
        if let Some(origin) = profile.origins.get(&key.name) {
            push(&mut text, format_args!("  # {}", printable(&origin.to_string())));
        }
        text.push('\n');
    }
    text
}

/// What holds for a key of the head that is unset.
fn of_named_head(settings: &Settings, key: &str) -> Option<Value> {
    let head = settings.head.name.head();
    match key {
        "head.flat" => Some(Value::Float(head.flat)),
        "head.cone" => Some(Value::Float(head.cone)),
        "head.cone_length" => Some(Value::Float(head.cone_length)),
        "head.discs" => Value::try_from(head.discs).ok(),
        "head.boxes" => Value::try_from(head.boxes).ok(),
        _ => None,
    }
}

fn table_of(settings: &Settings) -> Value {
    // A struct of numbers, words and texts always becomes a TOML table.
    Value::try_from(settings).unwrap_or_else(|_| Value::Table(toml::Table::new()))
}

fn value_in<'a>(root: &'a Value, key: &Key) -> Option<&'a Value> {
    key.name.split('.').try_fold(root, |table, part| table.get(part))
}

fn one_line(value: &Value) -> String {
    match value {
        // Rust's `Display` has no exponents and drops `.0`, which numbers here do without.
        Value::Float(number) => number.to_string(),
        Value::String(text) => quoted(text),
        Value::Array(list) => {
            format!("[{}]", list.iter().map(one_line).collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}

/// A JSON string is a TOML basic string too, but for U+007F, which TOML wants escaped.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string().replace('\u{7f}', "\\u007f")
}

/// A block on lines of its own where TOML can hold it literally.
fn block(value: &Value) -> String {
    match value.as_str() {
        Some(text)
            if text.ends_with('\n')
                && !text.contains("'''")
                && !text.chars().any(|c| c.is_control() && c != '\n') =>
        {
            format!("'''\n{text}'''")
        }
        _ => one_line(value),
    }
}

/// A comment must not end its line early: control characters of a file name are replaced.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}

fn push(text: &mut String, part: std::fmt::Arguments<'_>) {
    // Writing into a String cannot fail.
    let _ = text.write_fmt(part);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{builtin_names, keys, load};
    use serde::Deserialize as _;
    use std::collections::BTreeSet;

    fn leaves(prefix: &str, value: &Value, found: &mut BTreeSet<String>) {
        let Value::Table(table) = value else {
            found.insert(prefix.to_owned());
            return;
        };
        for (name, value) in table {
            let dot = if prefix.is_empty() { "" } else { "." };
            leaves(&format!("{prefix}{dot}{name}"), value, found);
        }
    }

    fn set(table: &mut Value, key: &str, value: Value) {
        let (name, rest) = key.split_once('.').unwrap_or((key, ""));
        match table {
            Value::Table(table) if rest.is_empty() => {
                table.insert(name.to_owned(), value);
            }
            _ => set(table.get_mut(name).unwrap(), rest, value),
        }
    }

    #[test]
    fn the_table_of_keys_and_the_type_agree() {
        let settings = load(["zcube-dual"], &[]).unwrap().settings;
        let mut root = Value::try_from(&settings).unwrap();
        // What may stay unset shows in the type's value only once it is set.
        for key in KEYS.iter().filter(|key| key.optional) {
            let most = match key.kind {
                Kind::Number { max, .. } => Value::Float(max),
                Kind::Count { max, .. } => Value::Integer(i64::from(max)),
                Kind::Rows { .. } => Value::Array(Vec::new()),
                _ => panic!("{}: give it a value here", key.name),
            };
            set(&mut root, &key.name, most);
        }
        let settings = Settings::deserialize(root).unwrap();
        let mut typed = BTreeSet::new();
        leaves("", &Value::try_from(&settings).unwrap(), &mut typed);
        let listed: BTreeSet<_> = keys::names().map(str::to_owned).collect();
        assert_eq!(typed, listed);
    }

    #[test]
    fn words_in_the_table_are_those_of_the_types() {
        for key in KEYS.iter() {
            let Kind::Word(words) = &key.kind else {
                continue;
            };
            for word in words {
                let set = |key: &str, value: &str| crate::profile::Override {
                    key: key.to_owned(),
                    value: value.to_owned(),
                    origin: crate::profile::ValueOrigin::Set,
                };
                // No dialect refuses anything in blocks without a line.
                let given = [
                    set(&key.name, word),
                    set("machine.start_gcode", ""),
                    set("machine.end_gcode", ""),
                ];
                let settings = load(["zcube-dual"], &given).unwrap().settings;
                let shown = dump(&settings).into_iter().find(|(name, _)| *name == key.name);
                assert_eq!(shown.unwrap().1, format!("\"{word}\""));
            }
        }
    }

    #[test]
    fn a_shown_profile_gives_the_same_settings_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shown.toml");
        for name in builtin_names() {
            for explain in [false, true] {
                let profile = load([name], &[]).unwrap();
                std::fs::write(&path, document(&profile, explain)).unwrap();
                let again = load([path.to_str().unwrap()], &[]).unwrap();
                assert_eq!(again.settings, profile.settings, "{name}");
            }
        }
    }

    #[test]
    fn every_key_is_shown_even_if_it_is_unset() {
        let mut profile = load(["zcube-dual"], &[]).unwrap();
        let text = document(&profile, false);
        assert!(text.contains("\n# top_layers =  # unset\n"), "{text}");
        for key in KEYS.iter() {
            let name = key.name.rsplit('.').next().unwrap();
            assert!(text.contains(&format!("{name} = ")), "{name}");
        }
        profile.settings.top_layers = Some(4);
        assert!(document(&profile, false).contains("\ntop_layers = 4\n"));
    }

    #[test]
    fn of_the_head_all_is_shown_that_holds() {
        let mut profile = load(["zcube-dual"], &[]).unwrap();
        profile.settings.head.name = crate::profile::HeadName::V6;
        profile.settings.head.cone = Some(40.0);
        let text = document(&profile, false);
        for line in [
            "# flat = 1  # of the named head",
            "cone = 40",
            "# discs = [[4.04, 2]]  # of the named head",
            "# boxes = [[-15, -8, 8, 8, 5]]  # of the named head",
        ] {
            assert!(text.lines().any(|shown| shown == line), "{line}: {text}");
        }
    }

    #[test]
    fn dumped_lines_are_short_whatever_the_names_hold() {
        let mut settings = load(["zcube-dual"], &[]).unwrap().settings;
        settings.filament.name = "\"".repeat(crate::profile::MAX_TEXT);
        settings.machine.name = "\u{1f600}".repeat(crate::profile::MAX_TEXT);
        let lines = dump(&settings);
        assert!(lines.iter().all(|(key, value)| key.len() + value.len() < 900));
        assert!(lines.iter().all(|(_, value)| !value.contains('\n')));
        assert!(!lines.iter().any(|(key, _)| NOT_DUMPED.contains(&key.as_str())));
    }

    #[test]
    fn texts_are_quoted_as_toml_wants_it() {
        let text = "a\"b\\c\u{7f}\té";
        let line = format!("x = {}", quoted(text));
        let table: toml::Table = toml::from_str(&line).unwrap();
        assert_eq!(table["x"].as_str(), Some(text));
    }
}
