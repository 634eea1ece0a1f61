//! TOML text -> entries: each value under its dotted key, with the line it stands on.

use super::error::{ProfileError, Result};
use super::{keys, quotes};
use toml::Value;
use toml::de::{DeTable, DeValue};

/// One `key = value` of a profile.
#[derive(Debug)]
pub(super) struct Entry {
    /// Dotted key.
    pub(super) key: String,
    /// The value.
    pub(super) value: Value,
    /// Line of the key, from 1.
    pub(super) line: usize,
}

impl Entry {
    /// Whether this is the head of a known table without any value in it.
    pub(super) fn is_empty_table(&self) -> bool {
        let table = format!("{}.", self.key);
        self.value.is_table() && keys::names().any(|name| name.starts_with(&table))
    }
}

/// Entries of one file in the order of their lines.
///
/// # Errors
/// TOML syntax, as `FILE:LINE: …`.
pub(super) fn document(file: &str, text: &str) -> Result<Vec<Entry>> {
    let (table, errors) = DeTable::parse_recoverable(text);
    // What follows the first is mostly its echo.
    let place = |error: &toml::de::Error| error.span().map_or(0, |span| span.start);
    if let Some(source) = errors.into_iter().min_by_key(place) {
        let line = Lines::new(text).of(place(&source));
        let file = file.to_owned();
        return Err(match quotes::unclosed(text).filter(|unclosed| *unclosed <= line) {
            Some(line) => ProfileError::OneLine { file, line },
            None => ProfileError::Syntax { file, line, source: Box::new(source) },
        });
    }
    let mut entries = Vec::new();
    flatten(table.get_ref(), "", &Lines::new(text), &mut entries);
    // The table is sorted by name; the first error to report is the first in the file.
    entries.sort_by(|a, b| a.line.cmp(&b.line).then_with(|| a.key.cmp(&b.key)));
    Ok(entries)
}

/// One value as `--set` has it: TOML, or else the text itself.
pub(super) fn value(text: &str) -> Value {
    DeValue::parse(text)
        .map_or_else(|_| Value::String(text.to_owned()), |value| scalar(value.get_ref()))
}

/// The number that a value is.
pub(super) fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

fn flatten(table: &DeTable<'_>, prefix: &str, lines: &Lines, entries: &mut Vec<Entry>) {
    for (name, value) in table {
        let key = format!("{prefix}{}", name.get_ref());
        if let DeValue::Table(inner) = value.get_ref() {
            // An empty table of an unknown name must not pass unseen.
            if inner.is_empty() {
                let line = lines.of(name.span().start);
                entries.push(Entry { key, value: Value::Table(toml::Table::new()), line });
            } else {
                flatten(inner, &format!("{key}."), lines, entries);
            }
        } else {
            let line = lines.of(name.span().start);
            entries.push(Entry { key, value: scalar(value.get_ref()), line });
        }
    }
}

fn scalar(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Boolean(on) => Value::Boolean(*on),
        DeValue::Datetime(date) => Value::Datetime(*date),
        DeValue::Array(list) => {
            Value::Array(list.iter().map(|value| scalar(value.get_ref())).collect())
        }
        DeValue::Table(_) => Value::Table(toml::Table::new()),
        // A whole number beyond 64 bits is out of every range; as a float it is refused as such.
        DeValue::Integer(whole) => i64::from_str_radix(whole.as_str(), whole.radix())
            .map_or(Value::Float(f64::NAN), Value::Integer),
        DeValue::Float(number) => Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
    }
}

/// Where the lines of a text end.
struct Lines(Vec<usize>);

impl Lines {
    fn new(text: &str) -> Self {
        Self(text.match_indices('\n').map(|(at, _)| at).collect())
    }

    /// The line of a place in the text, from 1.
    fn of(&self, offset: usize) -> usize {
        self.0.partition_point(|end| *end < offset) + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_dotted_and_know_their_lines() {
        let text = "walls = 2\n\n[speed]\n# comment\nwall = 1_200\n[support]\nenabled = true\n";
        let entries = document("f", text).unwrap();
        let found: Vec<_> = entries.iter().map(|e| (e.key.as_str(), e.line)).collect();
        assert_eq!(found, [("walls", 1), ("speed.wall", 5), ("support.enabled", 7)]);
        assert_eq!(entries[1].value, Value::Integer(1200));
    }

    #[test]
    fn syntax_errors_name_file_and_line_in_one_line() {
        let error = document("a.toml", "walls = 2\nskin_layers = \n").unwrap_err().to_string();
        assert!(error.starts_with("a.toml:2: "), "{error}");
        assert!(!error.contains('\n'));
    }

    #[test]
    fn blocks_in_wrong_quotes_are_answered_with_the_right_ones() {
        let told = |text: &str| document("a.toml", text).unwrap_err().to_string();
        for (line, text) in [
            (2, "walls = 2\nmachine.start_gcode = \"G28\nM104 S200\""),
            (2, "walls = 2\nmachine.start_gcode = 'G28\nG1 X1'\nwalls = 3"),
            (3, "a = '''x\n'''\nb = \"G28 ; \\\" \nG29"),
        ] {
            let error = told(text);
            assert!(error.starts_with(&format!("a.toml:{line}: ")), "{error}");
            assert!(error.contains("between three quotes"), "{error}");
        }
        let error = told("# \"\nmachine.start_gcode = \"\"\"\nG28\nM117 \\o/\n\"\"\"\n");
        assert!(error.starts_with("a.toml:4: ") && error.contains("backslash"), "{error}");
        assert!(!error.contains('\n') && error.contains("'''"), "{error}");
        // An apostrophe is no quote, and quotes may be part of a text.
        for text in ["description = Bob's printer\n", "a = '''b''''\nwall: 30\n"] {
            assert!(!told(text).contains("three"), "{text}");
        }
        // The first of several is told.
        let error = told("inherits = ender-3\nwall: 30\n");
        assert!(error.starts_with("a.toml:1: "), "{error}");
    }

    #[test]
    fn bare_words_are_texts() {
        assert_eq!(value("pair"), Value::String("pair".into()));
        assert_eq!(value("\"pair\""), Value::String("pair".into()));
        assert_eq!(value("0.25"), Value::Float(0.25));
        assert_eq!(value("0x10"), Value::Integer(16));
        assert_eq!(value("true"), Value::Boolean(true));
        assert_eq!(value(""), Value::String(String::new()));
    }
}
