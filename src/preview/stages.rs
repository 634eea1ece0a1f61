//! Print -> Stages: what one looks at step by step: each layer, and each patch of skin after its layer.
//!
//! A patch of non-planar skin stands in the moves of the layer that it is printed after. It would hide
//! that layer, and is a step of its own. In a print without patches each layer is one stage.

use crate::reader::print::{Layer, Step};
use crate::reader::{Patch, Print};
use std::ops::Range;

/// A layer's own lines, or a patch of skin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stage {
    /// Its layer, or the one that the patch is printed after, counted from 0.
    pub layer: usize,
    /// The patch's number in the file; none for lines of the layer itself.
    pub patch: Option<u32>,
    /// Its part of the file's moves.
    pub moves: Range<usize>,
}

/// All stages, in the order in which they are printed. Together they are the moves of all layers.
///
/// Pieces of a patch between which nothing else is printed are one. Moves that print nothing
/// belong to what is printed before them, at a layer's beginning to what comes after.
#[must_use]
pub fn stages(print: &Print) -> Vec<Stage> {
    let mut all = Vec::with_capacity(print.layers.len());
    for (layer, found) in print.layers.iter().enumerate() {
        let first = all.len();
        let mut at = found.moves.start;
        for patch in patches_of(print, found) {
            let (start, end) = (patch.moves.start.max(at), patch.moves.end.min(found.moves.end));
            add(print, &mut all, first, Stage { layer, patch: None, moves: at..start });
            let patch = Some(patch.number);
            add(print, &mut all, first, Stage { layer, patch, moves: start..end });
            at = end;
        }
        add(print, &mut all, first, Stage { layer, patch: None, moves: at..found.moves.end });
    }
    all
}

/// The lines of a layer without those of patches, in runs, with the travels between them.
#[must_use]
pub fn own<'a>(print: &'a Print, layer: &Layer) -> Vec<&'a [Step]> {
    let mut runs = Vec::new();
    let mut at = layer.moves.start;
    for patch in patches_of(print, layer) {
        runs.push(&print.moves[at..patch.moves.start.max(at)]);
        at = patch.moves.end.clamp(at, layer.moves.end);
    }
    runs.push(&print.moves[at..layer.moves.end]);
    runs
}

/// The numbers of the patches in a layer, each once, in the order in which they are printed.
#[must_use]
pub fn patches_in(print: &Print, layer: &Layer) -> Vec<u32> {
    let mut numbers = Vec::new();
    for patch in patches_of(print, layer) {
        if !numbers.contains(&patch.number) {
            numbers.push(patch.number);
        }
    }
    numbers
}

/// Patches with moves in a layer.
fn patches_of<'a>(print: &'a Print, layer: &Layer) -> impl Iterator<Item = &'a Patch> {
    let Range { start, end } = layer.moves;
    let first = print.patches.partition_point(|patch| patch.moves.end <= start);
    let rest = print.patches[first..].iter();
    rest.take_while(move |patch| patch.moves.start < end).filter(|patch| !patch.moves.is_empty())
}

/// Adds a stage of the layer whose first one has the place `first`, or joins it to the one before.
fn add(print: &Print, all: &mut Vec<Stage>, first: usize, stage: Stage) {
    let prints = |moves: &Range<usize>| print.moves[moves.clone()].iter().any(Step::is_line);
    let is_first = all.len() == first;
    match all.last_mut() {
        Some(before) if !is_first && (before.patch == stage.patch || !prints(&stage.moves)) => {
            before.moves.end = stage.moves.end;
        }
        Some(before) if !is_first && !prints(&before.moves) => {
            *before = Stage { moves: before.moves.start..stage.moves.end, ..stage };
        }
        _ => all.push(stage),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `layers` and patches as the moves `P` of the text: `L` begins a layer, `o` is a line, `t` a
    /// travel, `1` to `9` begin a patch and `e` ends it.
    fn print(text: &str) -> Print {
        let (mut gcode, mut x, mut e, mut z) = (String::new(), 0, 0, 0);
        for letter in text.chars() {
            x += 1;
            gcode += &match letter {
                'L' => {
                    z += 1;
                    format!(";LAYER_CHANGE\nG1 Z{z}\n")
                }
                'o' => {
                    e += 1;
                    format!("G1 X{x} E{e}\n")
                }
                't' => format!("G1 X{x}\n"),
                'e' => ";NONPLANAR_END\n".to_owned(),
                number => format!(";NONPLANAR_START {number}\n"),
            };
        }
        Print::read(&mut gcode.as_bytes(), 1.75).unwrap()
    }

    fn told(text: &str) -> Vec<(usize, Option<u32>, usize)> {
        let print = print(text);
        let all = stages(&print);
        let sum: usize = all.iter().map(|stage| stage.moves.len()).sum();
        assert_eq!(sum, print.layers.iter().map(|layer| layer.moves.len()).sum::<usize>());
        all.into_iter().map(|stage| (stage.layer, stage.patch, stage.moves.len())).collect()
    }

    #[test]
    fn a_patch_is_a_stage_after_its_layer() {
        assert_eq!(told("LooLo"), [(0, None, 3), (1, None, 2)]);
        assert_eq!(told("Loo1tooetLo"), [(0, None, 3), (0, Some(1), 4), (1, None, 2)]);
        // Pieces of one patch are one stage, and what comes after it is the layer's again.
        let found = told("Lo1oet1oe2oeoLo");
        let wanted = [(0, None, 2), (0, Some(1), 3), (0, Some(2), 1), (0, None, 1), (1, None, 2)];
        assert_eq!(found, wanted);
    }

    #[test]
    fn a_layer_s_own_lines_are_those_without_patches() {
        let print = print("Loo1tooetoLo");
        let own = own(&print, &print.layers[0]);
        assert_eq!(own.iter().map(|run| run.len()).collect::<Vec<_>>(), [3, 2]);
        assert_eq!(patches_in(&print, &print.layers[0]), [1]);
        assert!(patches_in(&print, &print.layers[1]).is_empty());
    }
}
