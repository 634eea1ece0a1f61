//! What is wrong with a model -> Error: every way in which reading, mending and placing models can fail.
//!
//! A program that embeds the library matches on the variants; each carries the numbers that its
//! message is made of. The message is one line that names the file or the flag, the cause and
//! what to do.
//!
//! Four groups of variants:
//! - `Read`: a file is no usable model. [`ReadError`] says in which way: not there, empty, of
//!   another format, cut off, contradicting itself, with numbers that are none, too large.
//! - `Flat`, `Sunk`, `Unmendable`, `Faulty`: the file was read, but its mesh is not good enough.
//! - `TooLarge`, `OffBed`, `BedFull`, `TooManyTriangles`: the models do not fit.
//! - `NoModel`, `Scale`, `NotFinite`, `NoCopies`: the request makes no sense, whatever the
//!   models; [`Error::is_usage`] tells these from the others.

use super::faults::{Counted, Fault, place_text};
use super::read::ReadError;

/// The result of everything in this stage that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// Why models cannot be read or placed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read, or is no usable model.
    #[error("{file}: {source}")]
    Read {
        /// The file as the user named it, `<stdin>` for standard input.
        file: String,
        /// What is wrong with it.
        source: ReadError,
    },

    /// A model is flat or has too few triangles, and so encloses nothing.
    #[error(
        "{file}: {what} ({} mm), nothing to print; check the model, --unit and --scale",
        sides(size_mm)
    )]
    Flat {
        /// The model's file.
        file: String,
        /// In which way it is flat.
        what: Flat,
        /// Its size as placed.
        size_mm: [f64; 3],
    },

    /// A model of which nothing is left above what is cut off its bottom.
    #[error(
        "{file}: --sink {sink_mm} cuts off all of the model, which is {} mm high; use less",
        number(*height_mm)
    )]
    Sunk {
        /// The model's file.
        file: String,
        /// How much is cut off.
        sink_mm: f64,
        /// How high it is before.
        height_mm: f64,
    },

    /// More of a mesh would have to be dropped than would be left.
    #[error(
        "{file}: the mesh cannot be mended: more of its faces meet no others than enclose a \
         body; mend the model, or slice it as it is with --mesh warn"
    )]
    Unmendable {
        /// The model's file.
        file: String,
    },

    /// A mesh has faults, and [`Policy::Strict`](super::Policy::Strict) allows none.
    #[error(
        "{file}: the mesh has faults: {}; mend the model, as `slicer mesh` does, or slice \
         without --mesh strict",
        all(found)
    )]
    Faulty {
        /// The model's file.
        file: String,
        /// All of its faults, at least one.
        found: Vec<Counted<Fault>>,
    },

    /// A model is larger than the print volume.
    #[error(
        "{file}: the model is {} mm and so {} than the print volume of {} mm; {}",
        sides(size_mm),
        if *is_only_too_high { "higher" } else { "larger" },
        sides(space_mm),
        shrink(*scale)
    )]
    TooLarge {
        /// The model's file.
        file: String,
        /// Its size as placed.
        size_mm: [f64; 3],
        /// The size of the print volume.
        space_mm: [f64; 3],
        /// Whether its width and depth would fit.
        is_only_too_high: bool,
        /// A factor by which it would fit, in place of the one given; none if there is no
        /// reasonable one.
        scale: Option<f64>,
    },

    /// The models stick out of the bed where they are to lie.
    #[error(
        "--at {},{}: models of {} mm stick out of the bed by {}; the bed is x {} to {}, y {} to {} mm",
        at[0],
        at[1],
        sides(size_mm),
        beyond(over_mm),
        number(bed_mm[0][0]),
        number(bed_mm[0][1]),
        number(bed_mm[1][0]),
        number(bed_mm[1][1])
    )]
    OffBed {
        /// Where their middle was to be, in the machine's coordinates, mm.
        at: [f64; 2],
        /// Width and depth of all of them.
        size_mm: [f64; 2],
        /// How far they stick out at the left and right, then at the front and back; 0 or
        /// less where they do not.
        over_mm: [[f64; 2]; 2],
        /// Lowest and highest x, then y of the bed.
        bed_mm: [[f64; 2]; 2],
    },

    /// The models do not fit the bed side by side.
    #[error(
        "{models} models with gaps of {gap_mm} mm do not fit the bed of {} mm; {}",
        sides(bed_mm),
        fewer(*copies_fit, *models_fit)
    )]
    BedFull {
        /// Models, with their copies.
        models: usize,
        /// The gaps between them, mm.
        gap_mm: f64,
        /// Width and depth of the bed.
        bed_mm: [f64; 2],
        /// How many copies of each fit; 0 if not all models do.
        copies_fit: usize,
        /// How many of the models fit, from the first on, each once.
        models_fit: usize,
    },

    /// All models and copies together have more triangles than are allowed.
    #[error(
        "{models} models have {triangles} triangles, and {most} are allowed; print fewer at once \
         or raise --max-triangles"
    )]
    TooManyTriangles {
        /// Models, with their copies.
        models: usize,
        /// Their triangles.
        triangles: usize,
        /// How many are allowed.
        most: usize,
    },

    /// No model was given.
    #[error("no model is given")]
    NoModel,

    /// The factor on every length is not above 0, or is too large.
    #[error("--scale {scale}: must be above 0 and at most {most:e}")]
    Scale {
        /// The factor.
        scale: f64,
        /// The largest that is allowed.
        most: f64,
    },

    /// An angle or a position is not finite.
    #[error("--rotate and --at take finite numbers")]
    NotFinite,

    /// Each model is to be printed zero times.
    #[error("--copies 0: must be at least 1")]
    NoCopies,
}

impl Error {
    /// Whether it is about what was asked for, and not about a model.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::NoModel | Self::Scale { .. } | Self::NotFinite | Self::NoCopies)
    }
}

/// In which way a model encloses nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Flat {
    /// Fewer than four triangles.
    #[error("fewer than four triangles enclose no body")]
    FewTriangles,
    /// No height.
    #[error("the model has no height")]
    NoHeight,
    /// No width, no depth, or no triangle with area.
    #[error("the model is flat and has no area in any layer")]
    NoArea,
}

/// Sizes for a message.
fn sides(mm: &[f64]) -> String {
    let text: Vec<String> = mm.iter().map(|&mm| number(mm)).collect();
    text.join(" × ")
}

/// A length for a message: at most two decimals, and powers of ten for numbers
/// that only a damaged model or a wrong unit has.
fn number(mm: f64) -> String {
    if mm.abs() >= 1e6 { format!("{mm:.1e}") } else { format!("{}", (mm * 100.0).round() / 100.0) }
}

/// What to do about a model that is too large.
fn shrink(scale: Option<f64>) -> String {
    scale.map_or_else(
        || "check the model and --scale".to_owned(),
        |scale| format!("use --scale {scale} or less, or turn it with --rotate"),
    )
}

/// What to do about models that do not fit side by side: how many do.
fn fewer(copies: usize, models: usize) -> String {
    match (copies, models) {
        (0, models) => format!("the first {models} of them do; print fewer at once"),
        (1, 2..) => "without --copies they fit; print fewer at once".to_owned(),
        (copies, _) => format!("--copies {copies} fits; print fewer at once"),
    }
}

/// By how much, and at which sides of the bed, models stick out.
fn beyond(over_mm: &[[f64; 2]; 2]) -> String {
    let names = ["left", "right", "front", "back"];
    let over = over_mm.as_flattened().iter().zip(names).filter(|(over, _)| **over > 0.0);
    // Rounded up, but not for the noise of the subtraction.
    let up = |over: f64| (over * 100.0 - 1e-6).ceil() / 100.0;
    let text: Vec<String> =
        over.map(|(&over, name)| format!("{} mm at the {name}", number(up(over)))).collect();
    text.join(" and ")
}

/// All faults of a mesh, and where the first is.
fn all(found: &[Counted<Fault>]) -> String {
    let all: Vec<String> = found.iter().map(ToString::to_string).collect();
    let first = found.first().and_then(|first| Some((first.kind.one(), *first.places.first()?)));
    let place = first.map_or_else(String::new, |(name, place)| {
        format!(" (the first {name} at {})", place_text(place))
    });
    all.join(", ") + &place
}
