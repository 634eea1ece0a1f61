//! Error -> Details: a stable word for the kind of a failure, the file it is about, and the place.
//!
//! Messages are for people and may change. Programs go by
//! - the *code*, a word of [`CODES`]: kinds that call for another answer have another code;
//! - the *file*: a model, G-code file or profile, as in the message;
//! - the *place*: a line or triangle of the file, a layer, a place on the bed, or a setting.
//!
//! A new kind of error is given its code here: the compiler asks for it.

use super::{Error, Hanging, Refusal};
use crate::gcode;
use crate::mesh::{self, read};
use crate::profile::error::Conflict;
use crate::profile::{BlockError, ProfileError, ValueOrigin};
use crate::{reader, steps};
use schemars::JsonSchema;
use serde::Serialize;

/// All codes, each with the program's exit code and what it means. Codes are added, but do not change
/// their meaning.
pub const CODES: &[(&str, u8, &str)] = &[
    ("usage", 2, "arguments that are wrong or do not go together"),
    ("unknown-profile", 2, "no profile has this name, or it is one of another kind"),
    ("unreadable-profile", 2, "a profile file cannot be read"),
    ("bad-profile", 2, "a profile is no TOML, inherits itself, or lacks a value"),
    ("unknown-setting", 2, "there is no such setting"),
    ("bad-value", 2, "a setting cannot have this value"),
    ("conflict", 2, "settings that do not go together"),
    ("bad-block", 2, "a start or end block that cannot be filled in, or must not be sent"),
    ("unreadable", 3, "a model or G-code file cannot be opened or read, or is a device"),
    ("not-a-model", 3, "a file is no STL"),
    ("not-steps", 3, "a file is no stream of steps, or of an unknown version"),
    (
        "damaged",
        3,
        "a model's file or a stream of steps is cut off, damaged, or contradicts itself",
    ),
    ("too-large", 3, "more triangles or moves than are allowed"),
    ("broken-mesh", 3, "a mesh that cannot be mended, or has faults with --mesh strict"),
    (
        "does-not-fit",
        3,
        "the print, or what lies around it, is larger than the machine, or smaller than it prints",
    ),
    ("in-the-way", 3, "the first layer lies where the start block primes the nozzle"),
    (
        "nothing-to-print",
        3,
        "a model is empty, flat, or too thin for a line; a G-code file prints nothing",
    ),
    ("floats", 3, "the print would begin in the air"),
    ("board-refuses", 3, "a board refuses a stream: another form, resolution, rate or place"),
    (
        "unwritable",
        4,
        "an output cannot be opened or written, a port cannot be opened, or went away",
    ),
    (
        "no-answer",
        4,
        "a board does not answer, or what is sent does not get through; it holds the job",
    ),
    ("board-busy", 4, "a board is in the middle of a job, or has none to resume"),
    (
        "board-failed",
        4,
        "a board restarted, failed or was stopped: the job is over, and the place lost",
    ),
    ("fault", 101, "a fault of the slicer itself"),
    ("interrupted", 130, "the run was interrupted by a signal"),
    ("unfinished", 137, "the run goes on, or was killed"),
];

/// What a program may want to know of a failure.
#[derive(Debug, Clone, PartialEq)]
pub struct Details {
    /// One of [`CODES`].
    pub code: &'static str,
    /// The file that it is about.
    pub file: Option<String>,
    /// Where.
    pub place: Option<Place>,
}

/// Where something is wrong. What is not known is absent.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct Place {
    /// Line of the file, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u64>,
    /// Triangle of a binary file, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangle: Option<u64>,
    /// Name of the setting.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    /// What gave the setting, if no file: `--set`, or a flag.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub given_by: Option<String>,
    /// Layer, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<usize>,
    /// On the bed, x and y, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_mm: Option<[f64; 2]>,
}

impl Details {
    /// Of no file and no place.
    #[must_use]
    pub fn of(code: &'static str) -> Self {
        Self { code, file: None, place: None }
    }

    fn in_file(code: &'static str, file: &str) -> Self {
        Self { code, file: Some(file.to_owned()), place: None }
    }

    fn at(self, place: Place) -> Self {
        Self { place: (place != Place::default()).then_some(place), ..self }
    }

    /// Of what a setting's value was given by.
    fn given(code: &'static str, origin: Option<&ValueOrigin>, key: Option<&str>) -> Self {
        let mut place = Place { key: key.map(str::to_owned), ..Place::default() };
        let mut file = None;
        match origin {
            Some(ValueOrigin::File { name, line }) => {
                file = Some(name.clone());
                place.line = Some(*line as u64);
            }
            Some(origin) => place.given_by = Some(origin.to_string()),
            None => {}
        }
        Self { code, file, place: None }.at(place)
    }
}

impl From<&Error> for Details {
    fn from(error: &Error) -> Self {
        match error {
            Error::Profile(error) => error.into(),
            Error::Mesh(error) => error.into(),
            Error::Reader(error) => error.into(),
            Error::Steps(error) => error.into(),
            Error::Send(error) => error.into(),
            Error::Refused(error) => error.into(),
            Error::Cancelled => Self::of("interrupted"),
            Error::Gcode(gcode::Error::Block(error)) => block(None, error),
            Error::Gcode(gcode::Error::Write(_)) | Error::Thumbnails(_) => Self::of("unwritable"),
        }
    }
}

impl From<&ProfileError> for Details {
    fn from(error: &ProfileError) -> Self {
        use ProfileError as E;
        match error {
            E::UnknownProfile { .. } => Self::of("unknown-profile"),
            E::OtherKind { name, .. } => Self::in_file("unknown-profile", name),
            E::Unreadable { file, .. } | E::TooLarge { file } => {
                Self::in_file("unreadable-profile", file)
            }
            E::Syntax { file, line, .. } | E::OneLine { file, line } => {
                let place = Place { line: Some(*line as u64), ..Place::default() };
                Self::in_file("bad-profile", file).at(place)
            }
            E::NoName { origin, key } => Self::given("bad-profile", Some(origin), Some(key)),
            E::Named { origin, key, source } => {
                Self::given(Self::from(&**source).code, Some(origin), Some(key))
            }
            E::Circle { origin, .. } => Self::given("bad-profile", Some(origin), Some("inherits")),
            E::UnknownKey { origin, key } => {
                Self::given("unknown-setting", Some(origin), Some(key))
            }
            E::Value { origin, key, .. } => Self::given("bad-value", Some(origin), Some(key)),
            E::Missing { profile, key } => {
                let place = Place { key: Some(key.clone()), ..Place::default() };
                Self::in_file("bad-profile", profile).at(place)
            }
            E::OtherSlicers { file } => Self::in_file("bad-profile", file),
            E::Mismatch { profile, .. } => Self::in_file("bad-profile", profile),
            E::Conflict { origin, source } => conflict(origin.as_ref(), source),
            E::Block { origin, source } => block(origin.as_ref(), source),
        }
    }
}

fn conflict(origin: Option<&ValueOrigin>, conflict: &Conflict) -> Details {
    match conflict {
        Conflict::ControlCharacter { block, .. } | Conflict::ForbiddenCode { block, .. } => {
            Details::given("bad-block", origin, Some(block))
        }
        _ => Details::given("conflict", origin, None),
    }
}

fn block(origin: Option<&ValueOrigin>, error: &BlockError) -> Details {
    Details::given("bad-block", origin, Some(&error.block))
}

impl From<&mesh::Error> for Details {
    fn from(error: &mesh::Error) -> Self {
        use mesh::Error as E;
        match error {
            E::Read { file, source } => of_file(source, file),
            E::Flat { file, .. } | E::Sunk { file, .. } => Self::in_file("nothing-to-print", file),
            E::Unmendable { file } | E::Faulty { file, .. } => Self::in_file("broken-mesh", file),
            E::TooLarge { file, .. } => Self::in_file("does-not-fit", file),
            E::OffBed { .. } | E::BedFull { .. } => Self::of("does-not-fit"),
            E::TooManyTriangles { .. } => Self::of("too-large"),
            E::NoModel | E::Scale { .. } | E::NotFinite | E::NoCopies => Self::of("usage"),
        }
    }
}

/// Of a model's file.
fn of_file(error: &read::ReadError, file: &str) -> Details {
    use read::{Damaged, ReadError as E, Truncated};
    let code = match error {
        E::NoName | E::Io(_) | E::Directory => "unreadable",
        E::NotStl(_) => "not-a-model",
        E::Truncated(_) | E::Damaged(_) | E::Coordinate { .. } => "damaged",
        E::Empty | E::NoTriangles | E::OnlyDegenerate { .. } => "nothing-to-print",
        E::TooManyTriangles { .. } | E::TooManyBytes { .. } => "too-large",
    };
    let (line, triangle) = match error {
        E::Coordinate { place: read::Place::Line(line), .. }
        | E::Truncated(Truncated::Text { line })
        | E::Damaged(
            Damaged::Nul { line }
            | Damaged::Text { line, .. }
            | Damaged::Loop { line, .. }
            | Damaged::Word { line, .. }
            | Damaged::DecimalComma { line, .. },
        ) => (Some(*line as u64), None),
        E::Coordinate { place: read::Place::Triangle(number), .. } => (None, Some(*number)),
        _ => (None, None),
    };
    Details::in_file(code, file).at(Place { line, triangle, ..Place::default() })
}

impl From<&reader::Error> for Details {
    fn from(error: &reader::Error) -> Self {
        use reader::Cause;
        let code = match &error.source {
            Cause::Unreadable(_) | Cause::Device => "unreadable",
            Cause::TooLong(_) => "too-large",
            Cause::NoMove | Cause::NoLine | Cause::NothingToDraw => "nothing-to-print",
        };
        Self::in_file(code, &error.file)
    }
}

impl From<&steps::Error> for Details {
    fn from(error: &steps::Error) -> Self {
        use steps::Cause;
        let place = |line| Place { line: Some(line), ..Place::default() };
        match &error.source {
            Cause::Unreadable(_) => Self::in_file("unreadable", &error.file),
            Cause::NotSteps | Cause::Version(_) => Self::in_file("not-steps", &error.file),
            Cause::Header | Cause::Damaged { .. } => Self::in_file("damaged", &error.file),
            Cause::TooLong => Self::in_file("too-large", &error.file),
            Cause::TooFar { line, .. } => {
                Self::in_file("does-not-fit", &error.file).at(place(*line))
            }
            Cause::NotMade { line, .. } => {
                Self::in_file("unreadable", &error.file).at(place(*line))
            }
        }
    }
}

impl From<&steps::send::Error> for Details {
    fn from(error: &steps::send::Error) -> Self {
        use steps::send::Cause;
        let code = match &error.source {
            Cause::File(error) => return error.into(),
            Cause::Open(_) | Cause::NotPort | Cause::NoPorts | Cause::Gone(_) => "unwritable",
            Cause::NoAnswer { .. } | Cause::NotTaken { .. } => "no-answer",
            Cause::Busy(_) | Cause::NothingHeld => "board-busy",
            Cause::Refused { .. } => "board-refuses",
            Cause::Protocol(_)
            | Cause::Unstopped
            | Cause::Failed { .. }
            | Cause::Restarted { .. }
            | Cause::StoppedThere { .. }
            | Cause::Stuck { .. }
            | Cause::Nonsense(_) => "board-failed",
        };
        Self::in_file(code, &error.port)
    }
}

impl From<&Refusal> for Details {
    fn from(error: &Refusal) -> Self {
        match error {
            Refusal::TooLow { .. } | Refusal::TooThin { .. } => Self::of("nothing-to-print"),
            Refusal::TooSmall { file, .. } => Self::in_file("does-not-fit", file),
            Refusal::TooTall { .. } | Refusal::BesideBed { .. } => Self::of("does-not-fit"),
            Refusal::Open { models, layer, .. } => {
                let place = Place { layer: Some(*layer), ..Place::default() };
                let file = match models.as_slice() {
                    [one] => Some(one.clone()),
                    _ => None,
                };
                Self { code: "broken-mesh", file, place: None }.at(place)
            }
            Refusal::Primed { at_mm } => {
                Self::of("in-the-way").at(Place { at_mm: Some(*at_mm), ..Place::default() })
            }
            Refusal::Hanging(hanging) => Self::of("floats").at(hangs_at(hanging)),
        }
    }
}

fn hangs_at(hanging: &Hanging) -> Place {
    let (layer, at_mm) = match hanging {
        Hanging::EmptyLayers { from, .. } => (*from, None),
        Hanging::Body { layer, at_mm, .. } | Hanging::Places { layer, at_mm, .. } => {
            (*layer, Some(*at_mm))
        }
    };
    Place { layer: Some(layer), at_mm, ..Place::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn errors_have_listed_codes_with_the_exit_code_of_the_list() {
        let names: BTreeSet<_> = CODES.iter().map(|(code, _, _)| code).collect();
        assert_eq!(names.len(), CODES.len());
        let kebab = |code: &&str| code.chars().all(|c| c.is_ascii_lowercase() || c == '-');
        assert!(names.iter().all(|code| kebab(code)));
        let unreadable = || std::io::Error::other("x");
        let errors: Vec<Error> = vec![
            Refusal::TooThin { line_width_mm: 0.4 }.into(),
            Refusal::Primed { at_mm: [1.0, 2.0] }.into(),
            mesh::Error::NoModel.into(),
            mesh::Error::Unmendable { file: "a".into() }.into(),
            reader::Cause::Unreadable(unreadable()).of("a").into(),
            reader::Cause::NoMove.of("a").into(),
            steps::Cause::NotSteps.of("a").into(),
            steps::Cause::Header.of("a").into(),
            steps::send::Cause::NotPort.at("a").into(),
            steps::send::Cause::NothingHeld.at("a").into(),
            steps::send::Cause::Nonsense(7).at("a").into(),
            steps::send::Cause::Refused { reason: 2, axis: None }.at("a").into(),
            steps::send::Cause::File(steps::Cause::Header.of("a")).at("b").into(),
            ProfileError::TooLarge { file: "a".into() }.into(),
            gcode::Error::Write(unreadable()).into(),
            Error::Cancelled,
        ];
        for error in errors {
            let details = Details::from(&error);
            let listed = CODES.iter().find(|(code, _, _)| *code == details.code);
            assert_eq!(listed.map(|(_, exit, _)| *exit), Some(error.exit_code()), "{error}");
        }
    }
}
