//! What can be wrong with a profile, as types: where, what, and the cause as a source.
//!
//! Every error displays as one line that starts with the place, then says what is wrong and what
//! to do. Words:
//!
//! - *origin*: the place. File and line, `--set`, or the flag that gave the value.
//! - [`ValueError`]: one value does not fit its key.
//! - [`Conflict`]: values that each fit their keys do not go together.
//! - [`BlockError`]: a start or end block cannot be filled in.

use super::foreign::{self, Foreign};
use super::keys::{self, Key};
use super::kind::ProfileKind;
use super::origin::ValueOrigin;
use super::shipped::DEFAULT;
use super::{old, suggest};
use crate::text;
use std::io;

/// A profile or a setting that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ProfileError {
    /// No profile has this name.
    #[error("unknown profile `{}`{}", text::line(name), known_profiles(name, known))]
    UnknownProfile {
        /// The name asked for.
        name: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// A profile that describes another thing than asked for.
    #[error("{name} is a {is}, not a {wanted}; `slicer profile list` groups them")]
    OtherKind {
        /// The profile as the user named it.
        name: String,
        /// What it describes.
        is: ProfileKind,
        /// What was asked for.
        wanted: ProfileKind,
    },
    /// A profile file that cannot be read.
    #[error("{file}: cannot read this profile: {source}; check the path")]
    Unreadable {
        /// The file as the user named it.
        file: String,
        /// The system's reason.
        source: io::Error,
    },
    /// A file that is larger than any profile.
    #[error("{file}: is larger than any profile; check the path")]
    TooLarge {
        /// The file as the user named it.
        file: String,
    },
    /// A file that is no TOML.
    #[error("{file}:{line}: this is no valid TOML: {}; mend the line", one_line(source))]
    Syntax {
        /// The file as the user named it.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The parser's reason.
        source: Box<toml::de::Error>,
    },
    /// `inherits` or a default that is no text.
    #[error("{origin}: {key}: must be the name of a profile or a file, in quotes")]
    NoName {
        /// Where it stands.
        origin: ValueOrigin,
        /// `inherits`, or such as `defaults.material`.
        key: String,
    },
    /// `inherits` or a default with a name that is not known.
    #[error("{origin}: {key}: {source}")]
    Named {
        /// Where it stands.
        origin: ValueOrigin,
        /// `inherits`, or such as `defaults.material`.
        key: String,
        /// What is wrong with the name.
        source: Box<ProfileError>,
    },
    /// Profiles that inherit each other.
    #[error(
        "{origin}: inherits goes round in a circle: {}; remove it from one of them",
        files.join(" -> ")
    )]
    Circle {
        /// Where the circle closes.
        origin: ValueOrigin,
        /// The profiles of the circle; the first is the last, too.
        files: Vec<String>,
    },
    /// A key that there is not.
    #[error("{origin}: {}", unknown_key(key))]
    UnknownKey {
        /// What gave it.
        origin: ValueOrigin,
        /// Its dotted name.
        key: String,
    },
    /// A value that its key cannot have.
    #[error("{origin}: {key} {source}")]
    Value {
        /// What gave it.
        origin: ValueOrigin,
        /// Dotted name of the key.
        key: String,
        /// What is wrong with it.
        source: ValueError,
    },
    /// A key that neither has a default nor is set.
    #[error(
        "{profile}: `{key}` has no value; set it, or begin the file with inherits = \"{}\"",
        DEFAULT
    )]
    Missing {
        /// The profile as the user named it.
        profile: String,
        /// Dotted name of the key.
        key: String,
    },
    /// Values that do not make settings, although each fits its key.
    #[error("{profile}: {}", one_line(source))]
    Mismatch {
        /// The profile as the user named it.
        profile: String,
        /// What does not fit.
        source: Box<toml::de::Error>,
    },
    /// Values that are each in range but cannot print together.
    #[error("{}{source}", place(origin.as_ref()))]
    Conflict {
        /// What gave the value that is most likely to blame.
        origin: Option<ValueOrigin>,
        /// What does not go together.
        source: Conflict,
    },
    /// A start or end block that cannot be filled in.
    #[error("{}{source}", place(origin.as_ref()))]
    Block {
        /// What gave it.
        origin: Option<ValueOrigin>,
        /// What is wrong with it.
        source: BlockError,
    },
}

impl From<BlockError> for ProfileError {
    fn from(source: BlockError) -> Self {
        Self::Block { origin: None, source }
    }
}

/// The result of everything that can fail with a [`ProfileError`].
pub type Result<T, E = ProfileError> = std::result::Result<T, E>;

/// A value that its key cannot have. Displays without the key's name.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ValueError {
    /// A number beyond the key's limits.
    #[error("= {value} {}", out_of_range(value, key))]
    OutOfRange {
        /// The number.
        value: String,
        /// The key.
        key: &'static Key,
    },
    /// A word that the key does not know.
    #[error("= `{}` is unknown{}; it must be {}", text::line(word), near(word, words), key.allowed())]
    UnknownWord {
        /// The word.
        word: String,
        /// The words there are.
        words: Vec<String>,
        /// The key.
        key: &'static Key,
    },
    /// A value of another type than the key's.
    #[error("is {found}; it must be {}", key.expected())]
    WrongType {
        /// The value, described.
        found: String,
        /// The key.
        key: &'static Key,
    },
    /// A list with something in it that does not belong there.
    #[error("holds {found}; it must be {}", key.expected())]
    WrongItem {
        /// What it holds.
        found: String,
        /// The key.
        key: &'static Key,
    },
    /// A text that is too long or has line breaks.
    #[error("must be {}", key.allowed())]
    NotOneLine {
        /// The key.
        key: &'static Key,
    },
}

/// Values that are each in range but cannot print together. Lengths in mm.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Conflict {
    /// Layers that are higher than the nozzle is wide.
    #[error(
        "{key} = {height} mm is more than machine.nozzle_diameter = {nozzle} mm; use thinner \
         layers or a larger nozzle"
    )]
    HigherThanNozzle {
        /// Which height.
        key: &'static str,
        /// The height.
        height: f64,
        /// The nozzle's diameter.
        nozzle: f64,
    },
    /// Lines that would stand instead of lie.
    #[error(
        "{lines} = {width} mm is too little for {key} = {height} mm; use at least {least} times \
         the height"
    )]
    NarrowLines {
        /// Which width.
        lines: &'static str,
        /// The lines' width.
        width: f64,
        /// Which height.
        key: &'static str,
        /// The height.
        height: f64,
        /// Least width for each mm of height.
        least: f64,
    },
    /// Lines wider than a nozzle lays them.
    #[error(
        "{lines} = {width} mm is more than {most} times machine.nozzle_diameter = {nozzle} mm; no \
         nozzle lays such lines"
    )]
    WideLines {
        /// Which width.
        lines: &'static str,
        /// The lines' width.
        width: f64,
        /// The nozzle's diameter.
        nozzle: f64,
        /// Greatest width for each mm of nozzle.
        most: f64,
    },
    /// Support whose first beads cannot fill the gap above the raft.
    #[error(
        "support stands on the raft: its first lines would have to be {height:.2} mm high, raft.gap \
         and first_layer_height together, for machine.nozzle_diameter = {nozzle} mm; make one of the \
         two smaller"
    )]
    TallFirstSupport {
        /// Height of those lines, mm.
        height: f64,
        /// The nozzle's diameter.
        nozzle: f64,
    },
    /// Ironing without a top.
    #[error(
        "ironing goes over tops, and there are none without a skin at the top; leave it out, or set \
         top_layers = 1"
    )]
    NothingToIron,
    /// Wide lines for a first layer without a skin.
    #[error(
        "first_layer_width widens the skin at the bottom, and there is none; leave it out, or set \
         bottom_layers = 1"
    )]
    NoFirstSkin,
    /// A nozzle that does not get to every place of the print volume.
    #[error(
        "{key} = {reach} mm lies inside the print volume, which ends at {volume} mm; let the nozzle \
         reach all of it, or make machine.bed_width, bed_depth or bed_height smaller"
    )]
    ReachInsideVolume {
        /// Which end of the reach.
        key: &'static str,
        /// Where it is, mm.
        reach: f64,
        /// Where the print volume ends, mm.
        volume: f64,
    },
    /// Steps are asked for of a machine that takes none.
    #[error(
        "{key} is not set: for this printer no steps can be made; set steps.x, y, z and e (steps for \
         a mm), or choose a printer that has [steps] with -p"
    )]
    NoSteps {
        /// The key that is missing.
        key: &'static str,
    },
    /// A brim is asked for by its flag, and a raft.
    #[error("has no effect with a raft, which takes the place of a brim; leave one of them out")]
    BrimAndRaft,
    /// A flag of dual injection without dual injection.
    #[error("has no effect while dual.mode is off; add --dual")]
    DualIsOff {
        /// The key that has no effect.
        key: &'static str,
    },
    /// Thick lines that are higher than allowed.
    #[error(
        "{layers} layers of layer_height = {height} mm make thick lines taller than the {most} mm \
         that dual.max_bead_height and machine.nozzle_diameter allow; use thinner layers, a lower \
         dual.ratio, or dual.mode = \"off\""
    )]
    ThickLinesTooTall {
        /// Layers printed at once.
        layers: u32,
        /// The layers' height.
        height: f64,
        /// Height of a thick line, at most.
        most: f64,
    },
    /// A temperature that the printer does not bear, or does not print at.
    #[error(
        "{key} = {celsius} °C, but this printer takes {least} to {most} °C; set another, or {limit} if \
         it takes more or less"
    )]
    NotBorne {
        /// The key of the temperature.
        key: &'static str,
        /// The temperature.
        celsius: f64,
        /// The key of the limit that it passes.
        limit: &'static str,
        /// The coldest that the printer takes, °C.
        least: f64,
        /// The hottest that it takes, °C.
        most: f64,
    },
    /// A bed temperature that nothing asks the printer for.
    #[error(
        "filament.bed_temperature = {celsius} °C would have no effect: machine.start_gcode does \
         not contain {{bed_temperature}}; put it there, or set 0"
    )]
    BedStaysCold {
        /// The temperature.
        celsius: f64,
    },
    /// A start block that pushes filament without saying how E counts.
    #[error(
        "machine.relative_e = true, but machine.start_gcode moves E and contains neither M83 nor \
         {{e_mode}}; put {{e_mode}} on a line of its own before that"
    )]
    RelativeEUnsaid,
    /// Arcs for printers that have none, or bad ones.
    #[error("machine.arcs = true, but {why}; set machine.arcs = false")]
    NoArcs {
        /// What would become of them.
        why: &'static str,
    },
    /// A character that printers may take for anything, and terminals obey.
    #[error("{block}, line {line} of it: there is a control character ({character:?}); remove it")]
    ControlCharacter {
        /// The block's key.
        block: &'static str,
        /// Line, from 1.
        line: usize,
        /// The character.
        character: char,
    },
    /// A command that the dialect cannot have in this block.
    #[error("{block}, line {line} of it: {code} must not be in {why}; remove the line")]
    ForbiddenCode {
        /// The block's key.
        block: &'static str,
        /// Line, from 1.
        line: usize,
        /// The command.
        code: String,
        /// In what, and what it would do there.
        why: &'static str,
    },
}

/// A start or end block that cannot be filled in.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{block}, line {line} of it: {source}")]
pub struct BlockError {
    /// The block's key.
    pub block: String,
    /// Line of the block, from 1.
    pub line: usize,
    /// What is wrong in this line.
    pub source: PlaceholderError,
}

/// A placeholder that cannot be filled in.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PlaceholderError {
    /// One that there is not.
    #[error("unknown placeholder {{{name}}}; {}", placeholder_hint(name, known))]
    Unknown {
        /// Its name.
        name: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// A closing brace without an opening one.
    #[error("a single `}}`; write `}}}}` for a brace")]
    SingleBrace,
    /// An opening brace without a closing one.
    #[error("a `{{` is not closed; write `{{{{` for a brace")]
    OpenBrace,
}

fn place(origin: Option<&ValueOrigin>) -> String {
    origin.map_or_else(String::new, |origin| format!("{origin}: "))
}

fn one_line(error: &toml::de::Error) -> String {
    error.message().replace('\n', ", ")
}

fn known_profiles(name: &str, known: &[String]) -> String {
    let hint = near(name, known);
    let hint = if hint.is_empty() { ".".to_owned() } else { hint };
    format!(
        "{hint} Known are {}; a file ends in .toml or is given as ./{}",
        known.join(", "),
        text::line(name)
    )
}

fn unknown_key(key: &str) -> String {
    let table = format!("{key}.");
    let inside: Vec<_> = keys::names().filter(|name| name.starts_with(&table)).collect();
    if !inside.is_empty() {
        return format!("`{key}` is a table, not a value; set one of {}", inside.join(", "));
    }
    if let Some(name) = old::renamed(key) {
        return format!("`{key}` is called `{name}` now");
    }
    let shown = text::line(key);
    match foreign::meaning(key) {
        Some(Foreign::Key(ours)) => return format!("unknown key `{shown}`; here it is `{ours}`"),
        Some(Foreign::NotSupported(what)) => {
            return format!("unknown key `{shown}`; {what} is not supported yet");
        }
        None => {}
    }
    let hint = suggest::did_you_mean(key, keys::names());
    let more = if hint.is_empty() { "; `slicer profile show` lists all keys" } else { "" };
    format!("unknown key `{shown}`{hint}{more}")
}

fn out_of_range(value: &str, key: &Key) -> String {
    let text = format!("is out of range; it must be {} {}", key.allowed(), key.unit);
    match value.parse() {
        Ok(per_minute) if per_minute > 1.0 && old::was_per_minute(&key.name) => format!(
            "{text}; speeds are in mm/s, {value} mm/min would be {}",
            old::per_second(per_minute)
        ),
        _ => text.trim_end().to_owned(),
    }
}

fn near(word: &str, words: &[String]) -> String {
    suggest::did_you_mean(word, words.iter().map(String::as_str))
}

fn placeholder_hint(name: &str, known: &[String]) -> String {
    suggest::nearest(name, known.iter().map(String::as_str)).map_or_else(
        || format!("known are {}", known.join(", ")),
        |near| format!("did you mean {{{near}}}?"),
    )
}
