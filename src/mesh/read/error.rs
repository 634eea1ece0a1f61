//! What is in a file -> ReadError: why a file is no usable model, in one line that says where and what to do.
//!
//! The readers do not know the name of the file; `mesh::Error::Read` adds it.
//!
//! [`ReadError`] has a variant for each cause that a program may treat differently:
//! - `NoName`, `Io`, `Directory`: there is nothing to read.
//! - `Empty`, `NotStl`: the file is something else.
//! - `Truncated`: it ends too early, such as after a broken download.
//! - `Damaged`: it contradicts itself.
//! - `Coordinate`: a number is NaN, infinite or absurdly large.
//! - `NoTriangles`, `OnlyDegenerate`: it is sound, but empty.
//! - `TooManyTriangles`, `TooManyBytes`: it is larger than the caller allows.
//!
//! [`NotStl`], [`Truncated`] and [`Damaged`] have the details.

use std::fmt;
use std::io;

/// Why a file cannot be read as a model. [`Error::Read`](crate::mesh::Error::Read) adds the
/// file's name.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The name of the file is empty.
    #[error("is no file name; name a model")]
    NoName,

    /// The system cannot open or read the file.
    #[error("cannot be read: {0}; check the name and the permissions")]
    Io(#[from] io::Error),

    /// The name is that of a directory.
    #[error("is a directory; name a file in it")]
    Directory,

    /// The file has no bytes.
    #[error("is empty; export the model again")]
    Empty,

    /// The file is no STL.
    #[error(transparent)]
    NotStl(#[from] NotStl),

    /// The file ends before its last triangle does.
    #[error(transparent)]
    Truncated(#[from] Truncated),

    /// The file contradicts itself.
    #[error(transparent)]
    Damaged(#[from] Damaged),

    /// A coordinate is not finite, or larger than [`MAX_NUMBER`](super::MAX_NUMBER).
    #[error("{place}: {}; mend or export the model again", complaint(*number))]
    Coordinate {
        /// The line or the triangle that it stands in.
        place: Place,
        /// The number.
        number: f32,
    },

    /// The file is sound, but has no triangles.
    #[error("holds no triangles; export the model again")]
    NoTriangles,

    /// No triangle has three different corners.
    #[error("none of its {triangles} triangles has three different corners; export it again")]
    OnlyDegenerate {
        /// Triangles of the file.
        triangles: usize,
    },

    /// More triangles than are allowed.
    #[error("{} triangles, and {most} are allowed; simplify the model or raise --max-triangles", count(*announced, *most))]
    TooManyTriangles {
        /// How many the file announces, if it does; text does not.
        announced: Option<u64>,
        /// How many are allowed.
        most: usize,
    },

    /// More bytes than the allowed triangles can need.
    #[error(
        "has {bytes} bytes, more than the {most} triangles that are allowed can need; simplify \
         the model or raise --max-triangles"
    )]
    TooManyBytes {
        /// Length of the file.
        bytes: u64,
        /// Triangles that are allowed.
        most: usize,
    },
}

/// Why a file is no STL.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotStl {
    /// Another format that is known.
    #[error("is no STL but seems to be {0}")]
    Foreign(&'static str),

    /// Some text.
    #[error("is no STL but text that begins with {0}; export it as STL")]
    Text(String),

    /// Bytes, but fewer than the head of a binary STL has.
    #[error("has only {bytes} bytes, too few for an STL; export or download it again")]
    TooShort {
        /// Length of the file.
        bytes: usize,
    },
}

/// How a file ends too early.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Truncated {
    /// A binary file holds fewer triangles than it announces.
    #[error(
        "announces {announced} triangles, but its {bytes} bytes hold only {held}; it is cut off, \
         damaged or no STL: export or download it again"
    )]
    Binary {
        /// Triangles that the file announces.
        announced: u64,
        /// Length of the file.
        bytes: u64,
        /// Whole triangles in it.
        held: u64,
    },

    /// A text ends within a facet.
    #[error(
        "line {line}: the file ends within a facet; it is cut off: export or download it again"
    )]
    Text {
        /// The last line, counted from 1.
        line: usize,
    },
}

/// How a file contradicts itself. Lines count from 1.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Damaged {
    /// A binary file announces no triangles, but goes on after its head.
    #[error("announces 0 triangles, but {}", go_on(*bytes))]
    NoneAnnounced {
        /// Bytes after the head, if the length of the file is known.
        bytes: Option<u64>,
    },

    /// More whole triangles follow than a binary file announces. Nobody can tell which of the
    /// two numbers is right.
    #[error(
        "announces {announced} triangles, but {more} more follow; it is damaged: export or \
         download it again"
    )]
    MoreTriangles {
        /// Triangles that the file announces.
        announced: u64,
        /// Triangles after these.
        more: u64,
    },

    /// Too many bytes follow after the triangles of a binary file.
    #[error(
        "announces {announced} triangles, but more than {most} bytes follow after them; it is \
         damaged: export or download it again"
    )]
    MoreBytes {
        /// Triangles that the file announces.
        announced: u64,
        /// Bytes that may follow.
        most: u64,
    },

    /// The numbers of a binary file have their highest byte first.
    #[error("is a big-endian binary STL; export it as a usual (little-endian) one")]
    BigEndian,

    /// NUL bytes stand in a text.
    #[error("line {line}: NUL bytes within the text; the file is damaged: export it again")]
    Nul {
        /// The line.
        line: usize,
    },

    /// A text has too few triangles for its length.
    #[error(
        "line {line}: {bytes} bytes of text and only {triangles} triangles until here; it is \
         damaged or no STL: export it again"
    )]
    Text {
        /// The line.
        line: usize,
        /// Bytes until here.
        bytes: u64,
        /// Triangles until here.
        triangles: usize,
    },

    /// A facet of a text is no triangle.
    #[error(
        "line {line}: a loop of {corners} corners; STL knows triangles only: triangulate the \
         model and export it again"
    )]
    Loop {
        /// The line.
        line: usize,
        /// Corners of the facet.
        corners: usize,
    },

    /// A word of a text stands where another one belongs.
    #[error(
        "line {line}: {word} stands where {expected} is expected; mend or export the file again"
    )]
    Word {
        /// The line.
        line: usize,
        /// The start of the word, in quotes.
        word: String,
        /// What belongs there.
        expected: &'static str,
    },

    /// A number of a text has a decimal comma.
    #[error("line {line}: {word} has a decimal comma; export it again with decimal points")]
    DecimalComma {
        /// The line.
        line: usize,
        /// The start of the number, in quotes.
        word: String,
    },
}

/// Where in a file something is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line of a text, counted from 1.
    Line(usize),
    /// A triangle of a binary file, counted from 1.
    Triangle(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Triangle(number) => write!(f, "triangle {number}"),
        }
    }
}

/// Why a number is no coordinate.
fn complaint(number: f32) -> String {
    if number.is_finite() {
        format!("the coordinate {number:e} is absurdly large")
    } else {
        format!("a coordinate is {number}, which is no finite number")
    }
}

/// How many triangles a file says that it has, or that it has more than are allowed.
fn count(announced: Option<u64>, most: usize) -> String {
    announced.map_or_else(|| format!("has more than {most}"), |count| format!("announces {count}"))
}

/// What follows after the head of a file that announces no triangles.
fn go_on(bytes: Option<u64>) -> String {
    bytes.map_or_else(
        || "more bytes follow; it is damaged or no STL: export it again".to_owned(),
        |bytes| format!("{bytes} more bytes follow; export it again"),
    )
}
