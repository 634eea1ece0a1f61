//! JSON Schema of the settings -> table of keys: what each key may hold, its unit, default and meaning.
//!
//! The table is read once from the schema, which is derived from `settings/`: there a
//! key is declared. It is what values are checked by, and what every list of keys shows.
//!
//! Words: a *key* is a dotted name such as `speed.wall`; its *kind* is what it may hold. A kind
//! follows from the schema: a number with `minimum` and `maximum` is a number within limits, an
//! enum is a word, `anyOf` is a number or `auto`, a text with a `maxLength` stays on one line and
//! one without is a block of G-code. A key whose type allows `null` may stay unset.

use super::settings::MAX_TEXT;
use super::{schema, sizes};
use serde_json::Value as Json;
use std::sync::LazyLock;
use toml::Value;

/// What a key may hold.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// A number within limits, both included.
    Number {
        /// Lowest value allowed, in the key's unit.
        min: f64,
        /// Highest value allowed, in the key's unit.
        max: f64,
    },
    /// A whole number within limits, both included.
    Count {
        /// Lowest value allowed.
        min: u32,
        /// Highest value allowed.
        max: u32,
    },
    /// One of these words.
    Word(Vec<String>),
    /// Any of these words, in a list.
    Words(Vec<String>),
    /// A number within limits, both included, or `auto`.
    NumberOrAuto {
        /// Lowest value allowed, in the key's unit.
        min: f64,
        /// Highest value allowed, in the key's unit.
        max: f64,
    },
    /// A whole number within limits, both included, or `auto`.
    CountOrAuto {
        /// Lowest value allowed.
        min: u32,
        /// Highest value allowed.
        max: u32,
    },
    /// Sizes of pictures in a list.
    Sizes,
    /// Numbers within limits, both included, in a list that is not empty, or `auto`.
    NumbersOrAuto(Limits),
    /// Lists of so many numbers within limits, both included, in a list.
    Rows {
        /// Numbers in each of them.
        columns: usize,
        /// Of each number, and of the outer list.
        limits: Limits,
    },
    /// `true` or `false`.
    Switch,
    /// One line of text without control characters, at most [`MAX_TEXT`] characters.
    Text,
    /// Lines of G-code with `{placeholders}`.
    Block,
}

/// What a list of numbers may hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Lowest number allowed, in the key's unit.
    pub min: f64,
    /// Highest number allowed, in the key's unit.
    pub max: f64,
    /// Longest list allowed.
    pub most: usize,
}

/// One key of a profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Dotted name, such as `speed.wall`.
    pub name: String,
    /// What it may hold.
    pub kind: Kind,
    /// Unit, empty where there is none.
    pub unit: String,
    /// Its meaning, in one paragraph.
    pub doc: String,
    /// Its value where no profile has one.
    pub default: Option<Value>,
    /// Whether it may stay unset.
    pub optional: bool,
    /// The key that gives its value where nobody sets it.
    pub follows: Option<Follows>,
}

/// A key that another one follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Follows {
    /// Its dotted name; it holds a number.
    pub key: String,
    /// How many times its value.
    pub times: f64,
}

impl Follows {
    /// The value that follows from `number`. A float's last digits would show in files.
    #[must_use]
    pub fn of(&self, number: f64) -> f64 {
        (number * self.times * 1e6).round() / 1e6
    }
}

/// All keys, in the order in which they are declared, shown and written.
pub static KEYS: LazyLock<Vec<Key>> = LazyLock::new(|| {
    let mut keys = Vec::new();
    rows("", &schema::all_keys(), &mut keys);
    keys
});

/// The key of this dotted name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.name == name)
}

/// The names of all keys.
pub fn names() -> impl Iterator<Item = &'static str> {
    KEYS.iter().map(|key| key.name.as_str())
}

/// Reads the keys of one table; `prefix` is the table's name with its dot.
fn rows(prefix: &str, table: &Json, keys: &mut Vec<Key>) {
    for (name, schema) in table["properties"].as_object().into_iter().flatten() {
        let name = format!("{prefix}{name}");
        if schema.get("properties").is_some() {
            rows(&format!("{name}."), schema, keys);
            continue;
        }
        let text = |word: &str| schema::words(schema[word].as_str().unwrap_or_default());
        keys.push(Key {
            name,
            kind: kind(schema),
            unit: text("unit"),
            doc: text("description"),
            default: schema.get("default").and_then(|json| Value::try_from(json).ok()),
            optional: types(schema).any(|one| one == "null"),
            follows: schema.get("follows").map(|key| Follows {
                key: key.as_str().unwrap_or_default().to_owned(),
                times: schema["times"].as_f64().unwrap_or(1.0),
            }),
        });
    }
}

/// The types that a schema allows.
fn types(schema: &Json) -> impl Iterator<Item = &str> {
    let one = schema["type"].as_str();
    one.into_iter().chain(schema["type"].as_array().into_iter().flatten().filter_map(Json::as_str))
}

fn kind(schema: &Json) -> Kind {
    if let Some(either) = schema["anyOf"].as_array() {
        // A number, or some in a list, or `auto`.
        let number =
            either.iter().find(|one| ["maximum", "items"].iter().any(|of| one.get(of).is_some()));
        return match kind(number.unwrap_or(schema)) {
            Kind::Count { min, max } => Kind::CountOrAuto { min, max },
            Kind::Number { min, max } => Kind::NumberOrAuto { min, max },
            other => other,
        };
    }
    let of_type = |name| types(schema).any(|one| one == name);
    let limit = |name: &str| schema[name].as_f64().unwrap_or_default();
    let words = words(schema);
    if !words.is_empty() {
        Kind::Word(words)
    } else if of_type("number") {
        Kind::Number { min: limit("minimum"), max: limit("maximum") }
    } else if of_type("integer") {
        Kind::Count { min: limit("minimum") as u32, max: limit("maximum") as u32 }
    } else if of_type("boolean") {
        Kind::Switch
    } else if of_type("array") {
        let most = limit("maxItems") as usize;
        match kind(&schema["items"]) {
            Kind::Word(words) => Kind::Words(words),
            Kind::Number { min, max } => Kind::NumbersOrAuto(Limits { min, max, most }),
            // A list of as many numbers as it has to hold.
            Kind::NumbersOrAuto(Limits { min, max, most: columns }) => {
                Kind::Rows { columns, limits: Limits { min, max, most } }
            }
            _ => Kind::Sizes,
        }
    } else if schema.get("maxLength").is_some() {
        Kind::Text
    } else {
        Kind::Block
    }
}

/// The words of an enum.
fn words(schema: &Json) -> Vec<String> {
    let list = |name: &str| schema[name].as_array().into_iter().flatten();
    let constants = list("oneOf").flat_map(|one| {
        let several = one["enum"].as_array().into_iter().flatten();
        one.get("const").into_iter().chain(several)
    });
    constants.chain(list("enum")).filter_map(|word| word.as_str().map(str::to_owned)).collect()
}

impl Key {
    /// Unit, limits and meaning in one line.
    #[must_use]
    pub fn comment(&self) -> String {
        let allowed = match self.kind {
            Kind::Switch => "true | false".to_owned(),
            Kind::Text => "text".to_owned(),
            Kind::Block => "G-code with {placeholders}".to_owned(),
            _ => self.allowed(),
        };
        let unit = if self.unit.is_empty() { String::new() } else { format!("{}, ", self.unit) };
        format!("{unit}{allowed}: {}", self.doc)
    }

    /// What is allowed, in words.
    #[must_use]
    pub fn allowed(&self) -> String {
        match &self.kind {
            Kind::Number { min, max } => format!("{min} to {max}"),
            Kind::Count { min, max } => format!("{min} to {max}"),
            Kind::NumberOrAuto { min, max } => format!("{min} to {max} | auto"),
            Kind::CountOrAuto { min, max } => format!("{min} to {max} | auto"),
            Kind::Word(words) => words.join(" | "),
            Kind::Words(words) => format!("any of {}", words.join(", ")),
            Kind::Sizes => sizes::allowed(),
            Kind::NumbersOrAuto(Limits { min, max, most }) => {
                format!("1 to {most} numbers, {min} to {max} | auto")
            }
            Kind::Rows { columns, limits: Limits { min, max, most } } => {
                format!("at most {most} lists of {columns} numbers, {min} to {max}")
            }
            Kind::Switch => "true or false".to_owned(),
            Kind::Text => format!("one line of at most {MAX_TEXT} characters"),
            Kind::Block => "text".to_owned(),
        }
    }

    /// What a value must be, in words.
    #[must_use]
    pub fn expected(&self) -> String {
        match &self.kind {
            Kind::Number { .. } => {
                format!("a number, {} {}", self.allowed(), self.unit).trim_end().to_owned()
            }
            Kind::Count { .. } => format!("a whole number, {}", self.allowed()),
            Kind::NumberOrAuto { min, max } => format!("a number, {min} to {max}, or auto"),
            Kind::CountOrAuto { min, max } => format!("a whole number, {min} to {max}, or auto"),
            Kind::NumbersOrAuto(Limits { min, max, most }) => {
                format!("a list of 1 to {most} numbers, {min} to {max}, or auto")
            }
            Kind::Words(_) | Kind::Sizes | Kind::Rows { .. } => {
                format!("a list of {}", self.allowed())
            }
            Kind::Word(_) => format!("one of {}", self.allowed()),
            Kind::Switch | Kind::Text | Kind::Block => self.allowed(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_declaration_is_read_as_a_row() {
        let words = |list: &[&str]| list.iter().map(|word| (*word).to_owned()).collect();
        let kinds = [
            ("speed.wall", Kind::Number { min: 0.1, max: 999.0 }),
            ("fan_from_layer", Kind::Count { min: 1, max: 100_000 }),
            ("seam", Kind::Word(words(&["nearest", "rear", "aligned", "random"]))),
            ("dual.parts", Kind::Words(words(&["infill", "support", "inner-walls", "inner-skin"]))),
            ("angle", Kind::NumberOrAuto { min: -360.0, max: 360.0 }),
            ("dual.ratio", Kind::CountOrAuto { min: 2, max: 50 }),
            ("machine.thumbnails", Kind::Sizes),
            (
                "nonplanar.directions",
                Kind::NumbersOrAuto(Limits { min: -360.0, max: 360.0, most: 10 }),
            ),
            (
                "head.boxes",
                Kind::Rows { columns: 5, limits: Limits { min: -500.0, max: 500.0, most: 12 } },
            ),
            ("machine.relative_e", Kind::Switch),
            ("machine.name", Kind::Text),
            ("machine.start_gcode", Kind::Block),
            ("top_layers", Kind::Count { min: 0, max: 10_000 }),
        ];
        for (name, kind) in kinds {
            let key = KEYS.iter().find(|key| key.name.ends_with(name)).unwrap();
            assert_eq!(key.kind, kind, "{name}");
            assert_eq!(key.optional, ["top_layers", "head.boxes"].contains(&name));
        }
        let key = find("speed.wall").unwrap();
        assert_eq!((key.unit.as_str(), key.doc.as_str()), ("mm/s", "Speed of walls."));
        assert_eq!(key.default, Some(Value::Integer(27)));
    }
}
