//! Two files -> windows: the moves of some pairs at a time, in the file's order.
//!
//! Words used here: a *window* is the pairs whose moves are held at once. It ends with the pair that
//! makes it full, so that memory does not grow with the file but by its largest layers, and what is
//! found does not depend on how many threads compare it.

use super::align::Pair;
use super::side::Side;
use super::sums::Both;
use crate::reader::Error;
use crate::reader::print::Step;
use std::collections::BTreeMap;

/// Moves of both files in a window, about: 48 bytes each, and twice as much while they are compared.
const MOST_MOVES: usize = 60_000;

/// Pairs in a window at most.
const MOST_PAIRS: usize = 256;

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    /// What comes before the first layer.
    Start,
    /// Two layers, or one that the other file has not.
    Layers(Pair),
    /// What comes after the last line.
    End,
}

/// The moves of both files for a pair.
pub(super) struct Moves {
    pub(super) pair: Of,
    pub(super) moves: Both<Vec<Step>>,
}

/// Moves by the number of their layer; 0 is the start.
pub(super) type Kept = BTreeMap<usize, Vec<Step>>;

/// Hands all pairs to `sink`, a window at a time, with the place of its first one: the start, the
/// layers, the end.
///
/// # Errors
/// What reading gives.
pub(super) fn each(
    a: &Side,
    b: &Side,
    layers: &[Pair],
    sink: &mut dyn FnMut(usize, &[Moves]),
) -> Result<(), Error> {
    let layers = layers.iter().map(|pair| Of::Layers(*pair));
    let all = std::iter::once(Of::Start).chain(layers).chain([Of::End]);
    let (mut moves_a, mut moves_b) = (a.moves(), b.moves());
    let mut window: Vec<Moves> = Vec::new();
    let (mut done, mut count) = (0, 0);
    for pair in all {
        let takes = match pair {
            Of::Layers(pair) => Both { a: pair.a.is_some(), b: pair.b.is_some() },
            Of::Start | Of::End => Both { a: true, b: true },
        };
        let one = if takes.a { moves_a.next() } else { None };
        let other = if takes.b { moves_b.next() } else { None };
        let moves = Both {
            a: one.transpose().map_err(|error| a.unreadable(error))?.unwrap_or_default(),
            b: other.transpose().map_err(|error| b.unreadable(error))?.unwrap_or_default(),
        };
        count += moves.a.len() + moves.b.len();
        window.push(Moves { pair, moves });
        if count >= MOST_MOVES || window.len() >= MOST_PAIRS {
            sink(done, &window);
            done += window.len();
            (window, count) = (Vec::new(), 0);
        }
    }
    sink(done, &window);
    Ok(())
}

/// The moves of these layers, counted from 1, of the start and of the end.
///
/// # Errors
/// What reading gives.
pub(super) fn some(side: &Side, wanted: impl Iterator<Item = usize>) -> Result<Kept, Error> {
    let mut kept: Kept =
        wanted.chain([0, side.floors.len() + 1]).map(|k| (k, Vec::new())).collect();
    for (number, moves) in side.moves().enumerate() {
        let moves = moves.map_err(|error| side.unreadable(error))?;
        if let Some(own) = kept.get_mut(&number) {
            *own = moves;
        }
    }
    Ok(kept)
}
