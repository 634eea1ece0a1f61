//! Key + value as written -> value of the key's type, or what is wrong with it.

use super::error::ValueError;
use super::keys::{Key, Kind};
use super::lists::described;
use super::settings::MAX_TEXT;
use super::{lists, sizes};
use toml::Value;

impl Key {
    /// The value as this key's type.
    ///
    /// # Errors
    /// Wrong type, out of range, or none of the words.
    pub fn check(&'static self, value: Value) -> Result<Value, ValueError> {
        match (&self.kind, value) {
            (
                &(Kind::Number { min, max } | Kind::NumberOrAuto { min, max }),
                Value::Integer(whole),
            ) => {
                #[expect(
                    clippy::cast_precision_loss,
                    reason = "far beyond any limit where it is lost"
                )]
                let number = whole as f64;
                self.within(number, min, max)
            }
            (
                &(Kind::Number { min, max } | Kind::NumberOrAuto { min, max }),
                Value::Float(number),
            ) => self.within(number, min, max),
            (Kind::NumberOrAuto { .. } | Kind::CountOrAuto { .. }, Value::String(word)) => {
                self.one_of(&["auto".to_owned()], word)
            }
            (Kind::NumbersOrAuto(limits), value) => lists::numbers(self, limits, value),
            (Kind::Rows { columns, limits }, Value::Array(rows)) => {
                lists::rows(self, *columns, limits, rows)
            }
            (
                &(Kind::Count { min, max } | Kind::CountOrAuto { min, max }),
                Value::Integer(whole),
            ) => {
                if (i64::from(min)..=i64::from(max)).contains(&whole) {
                    Ok(Value::Integer(whole))
                } else {
                    Err(ValueError::OutOfRange { value: whole.to_string(), key: self })
                }
            }
            (Kind::Word(words), Value::String(word)) => self.one_of(words, word),
            (Kind::Words(words), Value::Array(list)) => self.some_of(words, list),
            // `--set dual.parts=infill,support` needs neither brackets nor quotes.
            (Kind::Words(words), Value::String(text)) => self.some_of(words, listed(&text)),
            (Kind::Sizes, Value::Array(list)) => self.sizes(&list),
            // Without brackets and quotes, too.
            (Kind::Sizes, Value::String(text)) => self.sizes(&listed(&text)),
            (Kind::Text, Value::String(text)) => self.one_line(text),
            (Kind::Switch, Value::Boolean(on)) => Ok(Value::Boolean(on)),
            (Kind::Block, Value::String(text)) => Ok(Value::String(text)),
            (_, other) => Err(ValueError::WrongType { found: described(&other), key: self }),
        }
    }

    pub(super) fn within(
        &'static self,
        number: f64,
        min: f64,
        max: f64,
    ) -> Result<Value, ValueError> {
        // NaN is in no range, so it is refused here too.
        if (min..=max).contains(&number) {
            Ok(Value::Float(number))
        } else {
            Err(ValueError::OutOfRange { value: number.to_string(), key: self })
        }
    }

    pub(super) fn one_of(
        &'static self,
        words: &[String],
        word: String,
    ) -> Result<Value, ValueError> {
        if words.contains(&word) {
            return Ok(Value::String(word));
        }
        Err(ValueError::UnknownWord { word, words: words.to_vec(), key: self })
    }

    /// A list of these words, each once and in the order of the table of keys.
    fn some_of(&'static self, words: &[String], list: Vec<Value>) -> Result<Value, ValueError> {
        let mut found = Vec::new();
        for value in list {
            let Value::String(word) = value else {
                return Err(ValueError::WrongItem { found: described(&value), key: self });
            };
            found.push(self.one_of(words, word)?);
        }
        let given = |word: &&String| found.iter().any(|one| one.as_str() == Some(word.as_str()));
        let words = words.iter().filter(given);
        Ok(Value::Array(words.cloned().map(Value::String).collect()))
    }

    fn sizes(&'static self, list: &[Value]) -> Result<Value, ValueError> {
        sizes::check(list).map_err(|found| ValueError::WrongItem { found, key: self })
    }

    fn one_line(&'static self, text: String) -> Result<Value, ValueError> {
        if text.chars().count() > MAX_TEXT || text.chars().any(char::is_control) {
            return Err(ValueError::NotOneLine { key: self });
        }
        Ok(Value::String(text))
    }
}

/// The words of a text with commas between them.
fn listed(text: &str) -> Vec<Value> {
    let words = text.split(',').map(str::trim).filter(|word| !word.is_empty());
    words.map(|word| Value::String(word.to_owned())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::keys::{KEYS, find};

    #[test]
    fn defaults_may_be_set() {
        for key in KEYS.iter() {
            let Some(default) = &key.default else { continue };
            assert!(!key.optional, "{}", key.name);
            assert!(key.check(default.clone()).is_ok(), "{}", key.name);
        }
    }

    #[test]
    fn limits_are_included_and_nan_is_refused() {
        let key = find("infill").unwrap();
        assert_eq!(key.check(Value::Integer(0)), Ok(Value::Float(0.0)));
        assert_eq!(key.check(Value::Float(100.0)), Ok(Value::Float(100.0)));
        assert!(key.check(Value::Float(100.1)).unwrap_err().to_string().contains("0 to 100 %"));
        assert!(key.check(Value::Float(f64::NAN)).is_err());
    }

    #[test]
    fn a_count_takes_no_fraction() {
        let error = find("walls").unwrap().check(Value::Float(1.5)).unwrap_err();
        assert_eq!(error.to_string(), "is the number 1.5; it must be a whole number, 0 to 100");
    }

    #[test]
    fn an_unknown_word_gets_a_suggestion() {
        let error = find("seam").unwrap().check(Value::String("reer".into())).unwrap_err();
        assert!(error.to_string().contains("did you mean `rear`?"), "{error}");
    }

    #[test]
    fn text_stays_on_one_line() {
        let key = find("filament.name").unwrap();
        assert!(key.check(Value::String("a\nb".into())).is_err());
        assert!(key.check(Value::String("x".repeat(MAX_TEXT + 1))).is_err());
        assert!(key.check(Value::String("x".repeat(MAX_TEXT))).is_ok());
    }
}
