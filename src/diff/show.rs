//! Two halves -> Strands: what a picture shows of them, in the order of painting.

use super::apart::{Mark, marks};
use super::finding::File;
use super::half::Half;
use super::is_plastic;
use super::sums::Both;
use crate::reader::Role;

/// A straight piece of a line or of a travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strand {
    /// Where it begins, x and y, mm.
    pub from: [f64; 2],
    /// Where it ends.
    pub to: [f64; 2],
    /// Width of the line, mm; 0 for a travel.
    pub width: f64,
    /// The file that alone has it, or has it in another width; `None` if both have it.
    pub file: Option<File>,
}

/// How halves are compared for a picture.
pub(super) struct Rules {
    pub(super) by_role: bool,
    /// For places, mm.
    pub(super) reach: f64,
    /// For filament of each mm of line.
    pub(super) share: f64,
    /// Whether travels are shown.
    pub(super) travels: bool,
}

/// The lines of both halves: first those of the first file as if both had them, over them what only
/// the first has, and then what only the second has; last travels, only those that differ.
pub(super) fn strands(halves: Both<&Half<'_>>, rules: &Rules) -> Vec<Strand> {
    let Rules { by_role, reach, share, travels } = *rules;
    let mut common = Vec::new();
    let mut own: [Vec<Strand>; 2] = Default::default();
    let strand = |from: [f64; 3], to: [f64; 3], width, file| Strand {
        from: [from[0], from[1]],
        to: [to[0], to[1]],
        width,
        file,
    };
    let marked = |mark: Mark, file| strand(mark.from, mark.to, mark.width, Some(file));
    for role in Role::ALL.into_iter().filter(|role| is_plastic(*role)) {
        let lines = halves.map(|half| half.lines(role, by_role));
        let all = lines.a.iter().map(|line| strand(line.from, line.to, line.section[0], None));
        common.extend(all);
        let only = marks(&lines.a, &lines.b, reach, share).into_iter();
        own[0].extend(only.map(|mark| marked(mark, File::A)));
        let only = marks(&lines.b, &lines.a, reach, share).into_iter();
        own[1].extend(only.map(|mark| marked(mark, File::B)));
    }
    if travels {
        let ways = halves.map(Half::travels);
        let only = marks(&ways.a, &ways.b, reach, share).into_iter();
        own[1].extend(only.map(|mark| marked(mark, File::A)));
        let only = marks(&ways.b, &ways.a, reach, share).into_iter();
        own[1].extend(only.map(|mark| marked(mark, File::B)));
    }
    common.into_iter().chain(own.into_iter().flatten()).collect()
}
