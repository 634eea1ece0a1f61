//! Print -> packed bytes: all moves of a G-code file, layer by layer, in few bytes and quick to unpack.
//!
//! The bytes are one block for the moves before the first layer (of no moves without a start) and
//! one for each layer, from the bed up, and for each patch of non-planar skin after its layer (each
//! [stage](super::stages)), with nothing before, between or after them. They are meant to
//! be deflated.
//!
//! An unsigned number is written as LEB128: seven bits a byte, the lowest first, the top bit set on all
//! bytes but the last. A signed number `n` is written as the unsigned one `2 n` if it is not below 0,
//! else as `-2 n - 1`. All are integers in the units below, within ±10⁹.
//!
//! | part of a block | written as | unit |
//! |---|---|---|
//! | bytes that follow in this block | unsigned | |
//! | number of moves, n | unsigned | |
//! | number of starts | unsigned | |
//! | each start: moves since the start before (since the block's begin for the first) | unsigned | |
//! | … and the place that move begins at: x, y, z | 3 signed | µm |
//! | roles: place in [`Role::ALL`], plus [`THICK`] for a line of several layers | n bytes | |
//! | ends: x less that of where the move begins | n signed | µm |
//! | ends: y, likewise | n signed | µm |
//! | ends: z, likewise | n signed | µm |
//! | filament pushed out, below 0 pulled back | n signed | 10 nm |
//! | feed less that of the move before | n signed | mm/min |
//! | width of the line less that of the move before | n signed | µm |
//! | height of the line less that of the move before | n signed | µm |
//! | line of the file less that of the move before | n signed | |
//!
//! A move begins where the one before ended, unless a start says otherwise. A block that is not empty
//! has a start at its first move. Before the first move of a block feed, width, height and line are 0.
//!
//! [`Role::ALL`]: crate::reader::Role::ALL

use super::colours::is_thick;
use super::stages::stages;
use crate::reader::print::{Layer, Print, Step};
use crate::units::{MmPerMin, MmPerS};
use std::io::{self, Write};

/// Added to a role for a line that is printed for more layers than its own.
pub const THICK: u8 = 0x80;

/// Numbers farther from 0 are written as this.
const FARTHEST: f64 = 1e9;

/// Writes all blocks.
///
/// # Errors
/// What `out` gives.
pub fn write(print: &Print, out: &mut dyn Write) -> io::Result<()> {
    let start = (&print.moves[print.start.clone()], None);
    let stages = stages(print);
    let layers =
        stages.iter().map(|one| (&print.moves[one.moves.clone()], print.layers.get(one.layer)));
    for (moves, layer) in std::iter::once(start).chain(layers) {
        let block = block(moves, layer);
        let mut length = Vec::new();
        put(&mut length, block.len() as u64);
        out.write_all(&length)?;
        out.write_all(&block)?;
    }
    Ok(())
}

/// Where a move begins and ends, µm.
type Way = [[i64; 3]; 2];

fn block(moves: &[Step], layer: Option<&Layer>) -> Vec<u8> {
    let ways: Vec<Way> = moves.iter().map(|step| [step.from, step.to].map(micrometres)).collect();
    let mut block = Vec::with_capacity(16 * moves.len() + 16);
    put(&mut block, moves.len() as u64);
    put_starts(&mut block, &ways);
    for step in moves {
        let thick = layer.is_some_and(|layer| is_thick(step, layer));
        block.push(step.role as u8 | if thick { THICK } else { 0 });
    }
    for axis in 0..3 {
        ways.iter().for_each(|[from, to]| put_signed(&mut block, to[axis] - from[axis]));
    }
    for step in moves {
        put_signed(&mut block, whole(f64::from(step.filament) * 1e5));
    }
    put_changes(&mut block, moves, |step| whole(MmPerMin::from(MmPerS(f64::from(step.feed))).0));
    put_changes(&mut block, moves, |step| whole(f64::from(step.width) * 1e3));
    put_changes(&mut block, moves, |step| whole(f64::from(step.height) * 1e3));
    put_changes(&mut block, moves, |step| i64::from(step.line));
    block
}

/// Where the nozzle is before the first move, and wherever it is not where it was.
fn put_starts(block: &mut Vec<u8>, ways: &[Way]) {
    let is_start = |&at: &usize| at == 0 || ways[at - 1][1] != ways[at][0];
    let starts: Vec<usize> = (0..ways.len()).filter(is_start).collect();
    put(block, starts.len() as u64);
    let mut before = 0;
    for at in starts {
        put(block, (at - before) as u64);
        ways[at][0].into_iter().for_each(|place| put_signed(block, place));
        before = at;
    }
}

/// What `value` gives for each move, as the difference to the move before.
fn put_changes(block: &mut Vec<u8>, moves: &[Step], value: impl Fn(&Step) -> i64) {
    let mut before = 0;
    for step in moves {
        let value = value(step);
        put_signed(block, value - before);
        before = value;
    }
}

fn micrometres(place: [f32; 3]) -> [i64; 3] {
    place.map(|at| whole(f64::from(at) * 1e3))
}

/// The nearest whole number within the limits; 0 for what is no number.
fn whole(value: f64) -> i64 {
    value.round().clamp(-FARTHEST, FARTHEST) as i64
}

fn put_signed(block: &mut Vec<u8>, value: i64) {
    put(block, ((value << 1) ^ (value >> 63)) as u64);
}

fn put(block: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        block.push(value as u8 | 0x80);
        value >>= 7;
    }
    block.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_in_seven_bits_a_byte() {
        let mut bytes = Vec::new();
        for value in [0, -1, 1, 63, -64, 64, 2_000_000_000] {
            put_signed(&mut bytes, value);
        }
        assert_eq!(bytes, [0, 1, 2, 126, 127, 128, 1, 0x80, 0xd0, 0xac, 0xf3, 0x0e]);
        assert_eq!(whole(f64::NAN), 0);
        assert_eq!(whole(f64::NEG_INFINITY), -1_000_000_000);
    }

    #[test]
    fn a_print_without_moves_is_one_empty_block() {
        let mut bytes = Vec::new();
        write(&Print::default(), &mut bytes).unwrap();
        assert_eq!(bytes, [2, 0, 0]);
    }
}
