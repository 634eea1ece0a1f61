//! Key name -> what it may hold: the one table of all settings with unit, limits and meaning.

use super::{old, sizes};
use toml::Value;

/// What a key may hold.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    Word(&'static [&'static str]),
    /// Any of these words, in a list.
    Words(&'static [&'static str]),
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
    /// `true` or `false`.
    Switch,
    /// One line of text without control characters, at most [`MAX_TEXT`] characters.
    Text,
    /// Lines of G-code with `{placeholders}`.
    Block,
}

/// Longest [`Kind::Text`], in characters. Keeps every settings line of a G-code
/// file below GPX's limit of 1023 bytes, even if each character is four bytes.
pub const MAX_TEXT: usize = 200;

/// One key of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Dotted name, such as `speed.wall`.
    pub name: &'static str,
    /// What it may hold.
    pub kind: Kind,
    /// Unit, empty where there is none.
    pub unit: &'static str,
    /// Its meaning in one line.
    pub doc: &'static str,
    /// Whether a profile may leave it out.
    pub optional: bool,
}

const fn number(
    name: &'static str,
    unit: &'static str,
    min: f64,
    max: f64,
    doc: &'static str,
) -> Key {
    Key { name, kind: Kind::Number { min, max }, unit, doc, optional: false }
}

const fn count(
    name: &'static str,
    unit: &'static str,
    min: u32,
    max: u32,
    doc: &'static str,
) -> Key {
    Key { name, kind: Kind::Count { min, max }, unit, doc, optional: false }
}

const fn word(name: &'static str, words: &'static [&'static str], doc: &'static str) -> Key {
    Key { name, kind: Kind::Word(words), unit: "", doc, optional: false }
}

const fn plain(name: &'static str, kind: Kind, doc: &'static str) -> Key {
    Key { name, kind, unit: "", doc, optional: false }
}

const fn optional(key: Key) -> Key {
    Key { optional: true, ..key }
}

/// All keys, in the order in which they are shown and written.
#[rustfmt::skip]
pub const KEYS: &[Key] = &[
    plain("description", Kind::Text, "what the profile is for"),
    number("layer_height", "mm", 0.02, 2.0, "height of a layer"),
    number("first_layer_height", "mm", 0.02, 2.0, "height of the first layer"),
    number("line_width", "mm", 0.05, 4.0, "width of a line and distance between solid lines"),
    number("tolerance", "mm", 0.0, 0.5, "how far contours may be simplified"),
    count("walls", "walls", 0, 100, "number of walls"),
    number("outer_wall_inset", "line widths", 0.0, 1.0, "middle of the outer wall from the contour; 0.5 measures right"),
    word("wall_order", &["outer-first", "inner-first"], "which wall is printed first"),
    word("seam", &["nearest", "rear"], "where a wall begins"),
    count("skin_layers", "layers", 0, 10_000, "solid layers at the top and at the bottom"),
    optional(count("top_layers", "layers", 0, 10_000, "solid layers at the top, if not skin_layers")),
    optional(count("bottom_layers", "layers", 0, 10_000, "solid layers at the bottom, if not skin_layers")),
    number("skin_reach", "mm", 0.0, 20.0, "how far a skin reaches sideways into the infill"),
    number("infill", "%", 0.0, 100.0, "density of the sparse infill"),
    word("pattern", &["rectilinear", "aligned", "grid", "triangles"], "pattern of the sparse infill"),
    Key { unit: "degrees", ..plain("angle", Kind::NumberOrAuto { min: -360.0, max: 360.0 }, "direction of the lines on even layers, from the x axis; auto has least turns") },
    number("infill_overlap", "line widths", 0.0, 1.0, "how far lines reach into the innermost wall"),
    number("corner_radius", "mm", 0.0, 10.0, "radius of the turns of infill, support and skins; 0 leaves them sharp"),
    word("dual.mode", &["off", "pair", "interlaced"], "thick lines: none, on the top layer of each group, or shared out evenly among its layers"),
    plain("dual.ratio", Kind::CountOrAuto { min: 2, max: 50 }, "layers whose lines are printed at once; auto is as many as pay"),
    number("dual.max_bead_height", "% of the nozzle", 10.0, 200.0, "thick lines are never taller"),
    plain("dual.parts", Kind::Words(&["infill", "support", "inner-walls", "inner-skin"]), "what is printed thick"),
    word("dual.direction", &["cross", "shorter"], "direction of thick lines: crossing, or the one with less length"),
    word("dual.remainder", &["thin", "drop"], "infill that one layer of a group lacks: printed thin, or left out"),
    plain("support.enabled", Kind::Switch, "whether support is printed"),
    number("support.threshold_angle", "degrees", 0.0, 90.0, "overhangs flatter than this are supported; 90 is every one"),
    number("support.spacing", "mm", 0.1, 50.0, "distance between support lines"),
    number("support.expansion", "mm", 0.0, 20.0, "how far support reaches beyond the overhang"),
    number("support.xy_distance", "mm", 0.0, 20.0, "distance to the part, sideways"),
    number("support.z_distance", "mm", 0.0, 5.0, "distance to the part above and below, in whole layers"),
    word("support.stands_on", &["everywhere", "bed"], "where support may stand"),
    number("speed.wall", "mm/s", 0.1, 999.0, "walls"),
    number("speed.skin", "mm/s", 0.1, 999.0, "skins"),
    number("speed.infill", "mm/s", 0.1, 999.0, "sparse infill of one layer's height"),
    number("speed.thick_infill", "mm/s", 0.1, 999.0, "sparse infill of a pair's height"),
    number("speed.support", "mm/s", 0.1, 999.0, "support"),
    number("speed.travel", "mm/s", 0.1, 999.0, "moves without extrusion"),
    number("speed.z", "mm/s", 0.1, 100.0, "moves in z"),
    number("speed.first_layer", "%", 1.0, 200.0, "feeds of the first layer, travel and z excepted"),
    word("extrusion.model", &["area", "factor"], "width x height, or the factors below"),
    number("extrusion.multiplier", "times", 0.05, 5.0, "factor on every amount of filament"),
    number("extrusion.factor_height", "mm", 0.02, 2.0, "layer height at which the factors hold"),
    number("extrusion.factor_width", "mm", 0.05, 4.0, "line width at which the factors hold"),
    number("extrusion.wall_factor", "mm/mm", 0.0, 2.0, "filament per length of wall"),
    number("extrusion.skin_factor", "mm/mm", 0.0, 2.0, "filament per length of skin"),
    number("extrusion.infill_factor", "mm/mm", 0.0, 2.0, "filament per length of infill; thick infill takes twice that"),
    number("extrusion.support_factor", "mm/mm", 0.0, 2.0, "filament per length of support"),
    number("retraction.length", "mm", 0.0, 20.0, "filament pulled back; 0 is none"),
    number("retraction.speed", "mm/s", 0.1, 200.0, "speed of the filament, back and forth"),
    word("retraction.when", &["always", "crossing"], "on every travel, or on those that cross an outer wall"),
    number("retraction.min_travel", "mm", 0.0, 1_000.0, "shorter travels never retract"),
    number("retraction.z_hop", "mm", 0.0, 10.0, "how far the nozzle is lifted while retracted"),
    plain("filament.name", Kind::Text, "name of the material"),
    number("filament.diameter", "mm", 0.5, 5.0, "diameter of the filament"),
    number("filament.density", "g/cm³", 0.1, 20.0, "density of the material"),
    number("filament.temperature", "°C", 0.0, 500.0, "temperature of the nozzle"),
    number("filament.bed_temperature", "°C", 0.0, 200.0, "temperature of the bed; 0 is cold"),
    number("filament.fan", "%", 0.0, 100.0, "part cooling fan"),
    count("filament.fan_from_layer", "layer", 1, 100_000, "first layer, counted from 1, with the fan on"),
    number("filament.cost", "money/kg", 0.0, 1_000_000.0, "price of the material; 0 is unknown"),
    plain("machine.name", Kind::Text, "name of the printer"),
    word("machine.dialect", &["makerbot", "marlin", "klipper"], "the G-code it understands"),
    number("machine.bed_width", "mm", 1.0, 5_000.0, "print volume in x"),
    number("machine.bed_depth", "mm", 1.0, 5_000.0, "print volume in y"),
    number("machine.bed_height", "mm", 1.0, 5_000.0, "print volume in z"),
    word("machine.origin", &["centre", "front-left"], "where x = 0, y = 0 is"),
    number("machine.nozzle_diameter", "mm", 0.05, 2.0, "diameter of the nozzle"),
    count("machine.tool", "number", 0, 1, "tool that prints"),
    number("machine.acceleration", "mm/s²", 1.0, 100_000.0, "acceleration that {acceleration} stands for"),
    plain("machine.relative_e", Kind::Switch, "E counts from the last move, not from the start"),
    number("machine.max_volumetric_speed", "mm³/s", 0.1, 1_000.0, "plastic that the hot end can melt"),
    Key { unit: "pixels", ..plain("machine.thumbnails", Kind::Sizes, "pictures of the models at the head of the file, for hosts") },
    plain("machine.start_gcode", Kind::Block, "G-code before the print"),
    plain("machine.end_gcode", Kind::Block, "G-code after the print"),
    number("limits.speed_x", "mm/s", 0.1, 999.0, "highest speed in x"),
    number("limits.speed_y", "mm/s", 0.1, 999.0, "highest speed in y"),
    number("limits.speed_z", "mm/s", 0.1, 100.0, "highest speed in z"),
    number("limits.speed_e", "mm/s", 0.1, 200.0, "highest speed of the filament"),
    number("limits.acceleration_x", "mm/s²", 1.0, 1_000_000.0, "highest acceleration in x"),
    number("limits.acceleration_y", "mm/s²", 1.0, 1_000_000.0, "highest acceleration in y"),
    number("limits.acceleration_z", "mm/s²", 1.0, 1_000_000.0, "highest acceleration in z"),
    number("limits.acceleration_e", "mm/s²", 1.0, 1_000_000.0, "highest acceleration of the filament"),
    number("limits.travel_acceleration", "mm/s²", 1.0, 1_000_000.0, "acceleration of moves without extrusion"),
    number("limits.retract_acceleration", "mm/s²", 1.0, 1_000_000.0, "acceleration of the filament alone"),
    word("limits.junction", &["jerk", "vector-jerk", "speed-change", "deviation", "square-corner"], "rule for corners: Marlin's jerk, that before 1.1, Sailfish's, Marlin's deviation, Klipper's"),
    number("limits.jerk_x", "mm/s", 0.0, 1_000.0, "sudden change of speed in x, for the jerks and speed-change"),
    number("limits.jerk_y", "mm/s", 0.0, 1_000.0, "sudden change of speed in y, for the jerks and speed-change"),
    number("limits.jerk_z", "mm/s", 0.0, 1_000.0, "sudden change of speed in z, for the jerks and speed-change"),
    number("limits.jerk_e", "mm/s", 0.0, 1_000.0, "sudden change of the filament's speed, for the jerks and speed-change"),
    number("limits.junction_deviation", "mm", 0.0, 10.0, "how far an arc would pass from the corner, for deviation"),
    number("limits.square_corner_velocity", "mm/s", 0.0, 1_000.0, "speed through a corner of 90 degrees, for square-corner"),
    number("limits.minimum_cruise_ratio", "times", 0.0, 0.99, "part of a move left for cruising, for square-corner"),
    number("limits.extruder_corner_velocity", "mm/s", 0.0, 1_000.0, "sudden change of the filament's speed, for square-corner"),
    count("limits.look_ahead", "blocks", 0, 100_000, "moves that the planner knows of at a time; 0 is the whole file"),
    number("limits.minimum_speed", "mm/s", 0.0, 1_000.0, "no corner need be slower than this"),
];

/// The key of this dotted name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.name == name)
}

impl Key {
    /// Unit, limits and meaning in one line, as they stand in the shipped profiles.
    #[must_use]
    pub fn comment(&self) -> String {
        let mut facts = Vec::new();
        if !self.unit.is_empty() {
            facts.push(self.unit.to_owned());
        }
        match self.kind {
            Kind::Number { .. }
            | Kind::NumberOrAuto { .. }
            | Kind::Count { .. }
            | Kind::CountOrAuto { .. }
            | Kind::Word(_)
            | Kind::Words(_)
            | Kind::Sizes => facts.push(self.allowed()),
            Kind::Switch => facts.push("true | false".to_owned()),
            Kind::Text => facts.push("text".to_owned()),
            Kind::Block => facts.push("G-code with {placeholders}".to_owned()),
        }
        format!("{}: {}", facts.join(", "), self.doc)
    }

    /// What is allowed, in words.
    #[must_use]
    pub fn allowed(&self) -> String {
        match self.kind {
            Kind::Number { min, max } => format!("{min} to {max}"),
            Kind::Count { min, max } => format!("{min} to {max}"),
            Kind::NumberOrAuto { min, max } => format!("{min} to {max} | auto"),
            Kind::CountOrAuto { min, max } => format!("{min} to {max} | auto"),
            Kind::Word(words) => words.join(" | "),
            Kind::Words(words) => format!("any of {}", words.join(", ")),
            Kind::Sizes => sizes::allowed(),
            Kind::Switch => "true or false".to_owned(),
            Kind::Text => format!("one line of at most {MAX_TEXT} characters"),
            Kind::Block => "text".to_owned(),
        }
    }

    /// The value as this key's type, or what is wrong with it (without the key's name).
    ///
    /// # Errors
    /// Wrong type, out of range, or none of the words.
    pub fn check(&self, value: Value) -> Result<Value, String> {
        match (self.kind, value) {
            (
                Kind::Number { min, max } | Kind::NumberOrAuto { min, max },
                Value::Integer(whole),
            ) => {
                #[expect(
                    clippy::cast_precision_loss,
                    reason = "far beyond any limit where it is lost"
                )]
                let number = whole as f64;
                self.within(number, min, max)
            }
            (Kind::Number { min, max } | Kind::NumberOrAuto { min, max }, Value::Float(number)) => {
                self.within(number, min, max)
            }
            (Kind::NumberOrAuto { .. } | Kind::CountOrAuto { .. }, Value::String(word)) => {
                self.one_of(&["auto"], word)
            }
            (Kind::Count { min, max } | Kind::CountOrAuto { min, max }, Value::Integer(whole)) => {
                if (i64::from(min)..=i64::from(max)).contains(&whole) {
                    Ok(Value::Integer(whole))
                } else {
                    Err(self.out_of_range(&whole.to_string()))
                }
            }
            (Kind::Word(words), Value::String(word)) => self.one_of(words, word),
            (Kind::Words(words), Value::Array(list)) => self.some_of(words, list),
            // `--set dual.parts=infill,support` needs neither brackets nor quotes.
            (Kind::Words(words), Value::String(text)) => self.some_of(words, listed(&text)),
            (Kind::Sizes, Value::Array(list)) => sizes::check(&list),
            // Without brackets and quotes, too.
            (Kind::Sizes, Value::String(text)) => sizes::check(&listed(&text)),
            (Kind::Text, Value::String(text)) => self.one_line(text),
            (Kind::Switch, Value::Boolean(on)) => Ok(Value::Boolean(on)),
            (Kind::Block, Value::String(text)) => Ok(Value::String(text)),
            (_, other) => Err(format!("is {}; it must be {}", described(&other), self.expected())),
        }
    }

    fn within(&self, number: f64, min: f64, max: f64) -> Result<Value, String> {
        // NaN is in no range, so it is refused here too.
        if (min..=max).contains(&number) {
            Ok(Value::Float(number))
        } else {
            Err(self.out_of_range(&number.to_string()))
        }
    }

    fn out_of_range(&self, value: &str) -> String {
        let text =
            format!("= {value} is out of range; it must be {} {}", self.allowed(), self.unit);
        match value.parse() {
            Ok(per_minute) if per_minute > 1.0 && old::was_per_minute(self.name) => format!(
                "{text}; speeds are in mm/s, {value} mm/min would be {}",
                old::per_second(per_minute)
            ),
            _ => text,
        }
    }

    fn one_of(&self, words: &[&'static str], word: String) -> Result<Value, String> {
        if words.contains(&word.as_str()) {
            return Ok(Value::String(word));
        }
        let hint = super::suggest::did_you_mean(&word, words.iter().copied());
        Err(format!("= `{}` is unknown{hint}; it must be {}", word.escape_debug(), self.allowed()))
    }

    /// A list of these words, each once and in the order of the table of keys.
    fn some_of(&self, words: &[&'static str], list: Vec<Value>) -> Result<Value, String> {
        let mut found = Vec::new();
        for value in list {
            let Value::String(word) = value else {
                return Err(format!("holds {}; it must be {}", described(&value), self.expected()));
            };
            found.push(self.one_of(words, word)?);
        }
        let given = |word: &&str| found.iter().any(|one| one.as_str() == Some(word));
        let words = words.iter().copied().filter(given);
        Ok(Value::Array(words.map(Value::from).collect()))
    }

    fn one_line(&self, text: String) -> Result<Value, String> {
        if text.chars().count() > MAX_TEXT || text.chars().any(char::is_control) {
            return Err(format!("must be {}", self.allowed()));
        }
        Ok(Value::String(text))
    }

    fn expected(&self) -> String {
        match self.kind {
            Kind::Number { .. } => format!("a number, {} {}", self.allowed(), self.unit),
            Kind::Count { .. } => format!("a whole number, {}", self.allowed()),
            Kind::NumberOrAuto { min, max } => format!("a number, {min} to {max}, or auto"),
            Kind::CountOrAuto { min, max } => format!("a whole number, {min} to {max}, or auto"),
            Kind::Words(_) | Kind::Sizes => format!("a list of {}", self.allowed()),
            Kind::Word(_) => format!("one of {}", self.allowed()),
            Kind::Switch | Kind::Text | Kind::Block => self.allowed(),
        }
    }
}

/// The words of a text with commas between them.
fn listed(text: &str) -> Vec<Value> {
    let words = text.split(',').map(str::trim).filter(|word| !word.is_empty());
    words.map(|word| Value::String(word.to_owned())).collect()
}

fn described(value: &Value) -> String {
    match value {
        Value::String(text) => format!("the text `{}`", text.escape_debug()),
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
    use super::*;

    #[test]
    fn names_are_unique() {
        for (i, key) in KEYS.iter().enumerate() {
            assert!(KEYS[..i].iter().all(|other| other.name != key.name), "{}", key.name);
        }
    }

    #[test]
    fn limits_are_included_and_nan_is_refused() {
        let key = find("infill").unwrap();
        assert_eq!(key.check(Value::Integer(0)), Ok(Value::Float(0.0)));
        assert_eq!(key.check(Value::Float(100.0)), Ok(Value::Float(100.0)));
        assert!(key.check(Value::Float(100.1)).unwrap_err().contains("0 to 100 %"));
        assert!(key.check(Value::Float(f64::NAN)).is_err());
    }

    #[test]
    fn a_count_takes_no_fraction() {
        let error = find("walls").unwrap().check(Value::Float(1.5)).unwrap_err();
        assert_eq!(error, "is the number 1.5; it must be a whole number, 0 to 100");
    }

    #[test]
    fn an_unknown_word_gets_a_suggestion() {
        let error = find("seam").unwrap().check(Value::String("reer".into())).unwrap_err();
        assert!(error.contains("did you mean `rear`?"), "{error}");
    }

    #[test]
    fn text_stays_on_one_line() {
        let key = find("filament.name").unwrap();
        assert!(key.check(Value::String("a\nb".into())).is_err());
        assert!(key.check(Value::String("x".repeat(MAX_TEXT + 1))).is_err());
        assert!(key.check(Value::String("x".repeat(MAX_TEXT))).is_ok());
    }
}
