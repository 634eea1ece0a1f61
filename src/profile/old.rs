//! Settings of format 1 -> today's: the names and units that profiles and G-code files had at first.
//!
//! The settings at the end of a G-code file carry the number of their format,
//! [`SETTINGS_FORMAT`]. Files of format 1 have no number, speeds in mm/min and some other names.

use super::keys::{self, Kind};

/// The format of the settings in a G-code file; raised when a key changes its name or unit.
pub const SETTINGS_FORMAT: u32 = 2;

/// The key under which the format stands among the settings.
pub(super) const FORMAT_KEY: &str = "settings_format";

/// Names of format 1 and those of today.
const RENAMED: &[(&str, &str)] = &[
    ("top_skin_layers", "top_layers"),
    ("bottom_skin_layers", "bottom_layers"),
    ("support.outset", "support.expansion"),
    ("retraction.feed", "retraction.speed"),
    ("machine.nozzle", "machine.nozzle_diameter"),
    ("machine.max_volumetric_flow", "machine.max_volumetric_speed"),
    ("machine.start", "machine.start_gcode"),
    ("machine.end", "machine.end_gcode"),
    ("limits.feed_x", "limits.speed_x"),
    ("limits.feed_y", "limits.speed_y"),
    ("limits.feed_z", "limits.speed_z"),
    ("limits.feed_e", "limits.speed_e"),
];

/// Today's name of a key of format 1 that has another one now.
pub(super) fn renamed(name: &str) -> Option<&'static str> {
    RENAMED.iter().find(|(old, _)| *old == name).map(|(_, new)| *new)
}

/// Whether this key of today is a speed that was in mm/min in format 1.
pub(super) fn was_per_minute(name: &str) -> bool {
    let other = ["speed.small_loop", "speed.small_loop_length"];
    let first = name.starts_with("speed.first_layer");
    let speed = name.starts_with("speed.") && !first && !other.contains(&name);
    speed || name.starts_with("limits.speed_") || name == "retraction.speed"
}

/// mm/min as mm/s, in thousandths, which is as exact as a profile needs: 1000 mm/min are
/// 16.667 mm/s, and 16.667 mm/s are written as F1000.
pub(super) fn per_second(per_minute: f64) -> f64 {
    (per_minute / 60.0 * 1000.0).round() / 1000.0
}

/// The values that a G-code file holds, with settings of format 1 turned into today's. All
/// others, such as those of another slicer, stay as they are.
#[must_use]
pub fn renewed(values: &[(String, String)]) -> Vec<(String, String)> {
    let has = |name: &str| values.iter().any(|(key, _)| key == name);
    if !is_ours(values) || has(FORMAT_KEY) {
        return values.to_vec();
    }
    let format = (FORMAT_KEY.to_owned(), SETTINGS_FORMAT.to_string());
    std::iter::once(format).chain(values.iter().map(|(key, value)| one(key, value))).collect()
}

/// Whether there are settings of this program among the values: two that no other slicer
/// writes, so that a stray `infill = 20` is not taken for ours.
pub(super) fn is_ours(values: &[(String, String)]) -> bool {
    let has = |name: &str| values.iter().any(|(key, _)| key == name);
    has("machine.dialect") && has("limits.junction")
}

fn one(key: &str, value: &str) -> (String, String) {
    let name = renamed(key).unwrap_or(key);
    let speed = value.parse::<f64>().ok().filter(|_| was_per_minute(name)).map(|speed| {
        let speed = per_second(speed);
        // Format 1 allowed speeds beyond today's limits; a file is read all the same.
        match keys::find(name).map(|key| &key.kind) {
            Some(&Kind::Number { min, max }) => speed.clamp(min, max).to_string(),
            _ => speed.to_string(),
        }
    });
    (name.to_owned(), speed.unwrap_or_else(|| value.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::keys::KEYS;

    fn owned(values: &[(&str, &str)]) -> Vec<(String, String)> {
        values.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn settings_without_a_format_get_todays_names_and_units() {
        let ours = [("machine.dialect", "\"marlin\""), ("limits.junction", "\"jerk\"")];
        let old = [
            ("speed.z", "1000"),
            ("speed.first_layer", "50"),
            ("retraction.feed", "1200"),
            ("limits.feed_x", "200000"),
            ("limits.jerk_x", "8"),
            ("top_skin_layers", "4"),
            ("speed.wall", "fast"),
        ];
        let new = [
            ("speed.z", "16.667"),
            ("speed.first_layer", "50"),
            ("retraction.speed", "20"),
            ("limits.speed_x", "999"),
            ("limits.jerk_x", "8"),
            ("top_layers", "4"),
            ("speed.wall", "fast"),
        ];
        let format = [(FORMAT_KEY, "2")];
        let expected = owned(&[&format[..], &ours, &new].concat());
        let read = renewed(&owned(&[&ours[..], &old].concat()));
        assert_eq!(read, expected);
        // What is of today, or not ours, stays as it is.
        assert_eq!(renewed(&read), read);
        assert_eq!(renewed(&owned(&old)), owned(&old));
    }

    #[test]
    fn old_names_are_no_keys_and_new_ones_are() {
        for (old, new) in RENAMED {
            assert!(keys::find(old).is_none(), "{old}");
            assert!(keys::find(new).is_some(), "{new}");
        }
        assert_eq!(KEYS.iter().filter(|key| was_per_minute(&key.name)).count(), 22);
    }
}
