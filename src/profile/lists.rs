//! Lists of numbers, and lists of such lists -> values of their keys.
//!
//! Numbers are kept to [`DIGITS`] decimals, so that the line that a G-code file has for them is not
//! longer than its firmware reads.

use super::error::ValueError;
use super::keys::{Key, Limits};
use super::parse;
use toml::Value;

/// Numbers in lists are whole multiples of 1 over this: a tenth of a micrometre.
const DIGITS: f64 = 1e4;

/// A list of numbers, one number, numbers with commas between them, or `auto`.
///
/// # Errors
/// Wrong type, out of range, too many, none, or another word.
pub(super) fn numbers(
    key: &'static Key,
    limits: &Limits,
    value: Value,
) -> Result<Value, ValueError> {
    match value {
        Value::Array(list) if list.is_empty() || list.len() > limits.most => {
            Err(wrong_item(key, &format!("{} numbers", list.len())))
        }
        Value::Array(list) => row(key, limits, list),
        Value::Integer(_) | Value::Float(_) => row(key, limits, vec![value]),
        // `--set nonplanar.directions=0,90` needs no brackets.
        Value::String(text) => {
            let list: Vec<Value> = text.split(',').map(|part| parse::value(part.trim())).collect();
            if list.iter().all(|value| parse::number(value).is_some()) {
                return numbers(key, limits, Value::Array(list));
            }
            key.one_of(&["auto".to_owned()], text)
        }
        other => Err(ValueError::WrongType { found: described(&other), key }),
    }
}

/// A list of lists of `columns` numbers.
///
/// # Errors
/// Wrong type, out of range, too many, or a list of another length.
pub(super) fn rows(
    key: &'static Key,
    columns: usize,
    limits: &Limits,
    list: Vec<Value>,
) -> Result<Value, ValueError> {
    if list.len() > limits.most {
        return Err(wrong_item(key, &format!("{} lists", list.len())));
    }
    let one = |value| match value {
        Value::Array(numbers) if numbers.len() == columns => row(key, limits, numbers),
        Value::Array(numbers) => Err(wrong_item(key, &format!("a list of {}", numbers.len()))),
        other => Err(wrong_item(key, &described(&other))),
    };
    list.into_iter().map(one).collect::<Result<_, _>>().map(Value::Array)
}

fn row(key: &'static Key, limits: &Limits, list: Vec<Value>) -> Result<Value, ValueError> {
    let one = |value: Value| {
        let number = parse::number(&value).ok_or_else(|| wrong_item(key, &described(&value)))?;
        let near = (number * DIGITS).round() / DIGITS;
        key.within(near, limits.min, limits.max)
    };
    list.into_iter().map(one).collect::<Result<_, _>>().map(Value::Array)
}

fn wrong_item(key: &'static Key, found: &str) -> ValueError {
    ValueError::WrongItem { found: found.to_owned(), key }
}

/// What a value is, in words.
pub(super) fn described(value: &Value) -> String {
    match value {
        Value::String(text) => format!("the text `{}`", crate::text::line(text)),
        Value::Integer(number) => format!("the number {number}"),
        // With its point, so that 2.0 is not told to be no whole number as "2".
        Value::Float(number) => format!("the number {number:?}"),
        Value::Boolean(on) => on.to_string(),
        Value::Datetime(_) => "a date".to_owned(),
        Value::Array(_) => "a list".to_owned(),
        Value::Table(_) => "a table".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use crate::profile::{DEFAULT, Override, Settings, ValueOrigin, dump, load, recorded};

    fn set(key: &str, value: &str) -> Result<Settings, String> {
        let (key, value) = (key.to_owned(), value.to_owned());
        let given = Override { key, value, origin: ValueOrigin::Set };
        load([DEFAULT], &[given]).map(|made| made.settings).map_err(|error| error.to_string())
    }

    #[test]
    fn lists_come_back_from_a_file_as_they_were_given() {
        for (key, given, shown) in [
            ("head.discs", "[[4.04, 2]]", "[[4.04, 2]]"),
            ("head.discs", "[]", "[]"),
            (
                "head.boxes",
                "[[-15,-8,8,8,5],[1,2.123456,3,4,0.5]]",
                "[[-15, -8, 8, 8, 5], [1, 2.1235, 3, 4, 0.5]]",
            ),
            ("nonplanar.directions", "[45, 135.5]", "[45, 135.5]"),
            ("nonplanar.directions", "45,135", "[45, 135]"),
            ("nonplanar.directions", "-30", "[-30]"),
            ("nonplanar.directions", "auto", "\"auto\""),
        ] {
            let made = set(key, given).unwrap();
            let lines = dump(&made);
            let line = lines.iter().find(|(name, _)| name == key).unwrap();
            assert_eq!(line.1, shown, "{key}");
            assert_eq!(recorded(&lines).unwrap().unwrap().settings, made);
        }
    }

    #[test]
    fn wrong_lists_are_refused_in_one_line() {
        let many = format!("[{}]", "[1,2],".repeat(13));
        for (key, given, text) in [
            (
                "head.discs",
                "4.04",
                "head.discs is the number 4.04; it must be a list of at most 12 lists of 2 numbers, 0 to 500",
            ),
            ("head.discs", "[4.04, 2]", "head.discs holds the number 4.04"),
            ("head.discs", "[[4.04, 2, 1]]", "head.discs holds a list of 3;"),
            ("head.discs", "[[4.04, -1]]", "head.discs = -1 is out of range"),
            ("head.discs", "[[4.04, \"x\"]]", "head.discs holds the text `x`"),
            ("head.discs", &many, "head.discs holds 13 lists"),
            (
                "nonplanar.directions",
                "[]",
                "nonplanar.directions holds 0 numbers; it must be a list of 1 to 10 numbers, -360 to 360, or auto",
            ),
            ("nonplanar.directions", "0,400", "nonplanar.directions = 400 is out of range"),
            ("nonplanar.directions", "along", "nonplanar.directions = `along` is unknown"),
            ("nonplanar.directions", "true", "nonplanar.directions is true"),
        ] {
            let error = set(key, given).unwrap_err();
            assert!(error.starts_with(&format!("--set: {text}")), "{error}");
            assert!(!error.contains('\n'));
        }
    }

    #[test]
    fn the_longest_lists_fit_the_line_of_a_file() {
        let row = "[-499.1234,-499.1234,-498.1234,-498.1234,499.1234],";
        let made = set("head.boxes", &format!("[{}]", row.repeat(12))).unwrap();
        assert!(dump(&made).iter().all(|(key, value)| key.len() + value.len() < 900));
    }
}
