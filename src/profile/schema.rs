//! Settings -> JSON Schema: what editors complete and check a profile by, and what the table of keys is read from.

use super::Settings;
use super::kind::ProfileKind;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

/// The JSON Schema of a profile file: every key with its type, limits, unit, default and
/// meaning. A profile may leave out any key, and may inherit other profiles.
#[must_use]
pub fn schema() -> Value {
    let mut schema = all_keys();
    for_people(&mut schema);
    let own = json!({
        "title": "Profile of slicer",
        "description": "Settings of a print: printer, material and quality.",
    });
    let name = json!({ "type": "string" });
    let inherits = json!({
        "anyOf": [name, { "type": "array", "items": name }],
        "description": "Profile that gives every value that this one leaves out, or a list of \
                        them, later ones laid over earlier: the name of a profile, or a file, \
                        seen from this one's folder.",
    });
    let kinds = ProfileKind::ALL.map(|kind| (kind.name().to_owned(), name.clone()));
    let defaults = json!({
        "type": "object",
        "properties": Map::from_iter(kinds),
        "additionalProperties": false,
        "description": "Profiles that are laid below this one where a job names none of their \
                        kind: a printer names its usual material and print.",
    });
    if let Value::Object(root) = &mut schema {
        root.extend(own.as_object().cloned().unwrap_or_default());
        if let Some(Value::Object(keys)) = root.get_mut("properties") {
            keys.shift_insert(0, "inherits".to_owned(), inherits);
            keys.shift_insert(1, "defaults".to_owned(), defaults);
        }
    }
    schema
}

/// The schema as the types give it: every key that must have a value is `required`. Draft 7
/// without references is what editors' TOML plug-ins understand best.
pub(super) fn all_keys() -> Value {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<Settings>().to_value()
}

/// Says the unit in the description too, since editors show no property that they do not
/// know, and drops what only makes sense for a whole set of settings.
fn for_people(schema: &mut Value) {
    match schema {
        Value::Object(object) => {
            object.remove("required");
            object.remove("format");
            one_paragraph(object);
            object.values_mut().for_each(for_people);
        }
        Value::Array(list) => {
            // TOML has no null: a key that may be unset is left out.
            list.retain(|one| one != "null");
            list.iter_mut().for_each(for_people);
        }
        _ => {}
    }
}

fn one_paragraph(object: &mut Map<String, Value>) {
    let Some(text) = object.get("description").and_then(Value::as_str) else { return };
    let mut text = words(text);
    if let Some(unit) = object.get("unit").and_then(Value::as_str) {
        text.push_str(&format!(" Unit: {unit}."));
    }
    object.insert("description".to_owned(), text.into());
}

/// A doc comment's lines as one.
pub(super) fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_has_type_limits_unit_default_and_meaning() {
        let schema = schema();
        let keys = &schema["properties"];
        assert_eq!(
            keys["speed"]["properties"]["wall"],
            json!({
                "description": "Speed of walls. Unit: mm/s.",
                "type": "number",
                "minimum": 0.1,
                "maximum": 999,
                "unit": "mm/s",
                "default": 27,
            })
        );
        assert_eq!(keys["top_layers"]["type"], json!(["integer"]));
        assert!(schema.get("required").is_none() && keys["inherits"].is_object());
        assert_eq!(schema["additionalProperties"], false);
    }
}
