//! Settings -> text: the lines that go into a G-code file, and a profile as TOML.

use super::keys::{KEYS, Key, Kind};
use super::{Profile, Settings};
use std::fmt::Write as _;
use toml::Value;

/// Keys that are left out of G-code files: blocks would make lines longer than
/// GPX's limit of 1023 bytes and stand in the file anyway; the description
/// says nothing of the print.
const NOT_DUMPED: &[&str] = &["description", "machine.start", "machine.end"];

/// All settings but the description and the blocks, as dotted key and TOML
/// value on one line of less than 900 bytes, in the order of
/// [`KEYS`](super::keys::KEYS). What a G-code file holds as comments.
#[must_use]
pub fn dump(settings: &Settings) -> Vec<(String, String)> {
    let mut lines = all(settings);
    lines.retain(|(key, _)| !NOT_DUMPED.contains(&key.name));
    lines.into_iter().map(|(key, value)| (key.name.to_owned(), one_line(&value))).collect()
}

/// The whole profile as a TOML file that gives the same settings again, each
/// value with its origin as a comment; with `explain` also with the unit,
/// limits and meaning of each key.
#[must_use]
pub fn document(profile: &Profile, explain: bool) -> String {
    let mut text = String::new();
    let mut table = "";
    for (key, value) in all(&profile.settings) {
        let (prefix, name) = key.name.split_once('.').unwrap_or(("", key.name));
        if prefix != table {
            table = prefix;
            push(&mut text, format_args!("\n[{table}]\n"));
        }
        if explain {
            push(&mut text, format_args!("# {}\n", key.comment()));
        }
        let value = if key.kind == Kind::Block { block(&value) } else { one_line(&value) };
        push(&mut text, format_args!("{name} = {value}"));
        if let Some(origin) = profile.origins.get(key.name) {
            push(&mut text, format_args!("  # {}", printable(&origin.to_string())));
        }
        text.push('\n');
    }
    text
}

/// Every key that has a value, in the order of the table of keys.
fn all(settings: &Settings) -> Vec<(&'static Key, Value)> {
    // A struct of numbers, words and texts always becomes a TOML table.
    let root = Value::try_from(settings).unwrap_or_else(|_| Value::Table(toml::Table::new()));
    KEYS.iter()
        .filter_map(|key| {
            let mut value = &root;
            for part in key.name.split('.') {
                value = value.get(part)?;
            }
            Some((key, value.clone()))
        })
        .collect()
}

fn one_line(value: &Value) -> String {
    match value {
        // Rust's `Display` has no exponents and drops `.0`, which numbers here do without.
        Value::Float(number) => number.to_string(),
        Value::String(text) => quoted(text),
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
