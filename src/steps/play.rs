//! A stream of steps -> totals, highest rates, and what its machine would not do.

use super::axis::{AXES, LETTERS};
use super::decode::{Decoder, Item};
use super::error::{Cause, Error};
use super::format::{Header, Totals};
use super::machine::beyond_text;
use serde::Serialize;
use std::io::Read;

/// What a stream does.
#[derive(Debug, Clone, PartialEq)]
pub struct Played {
    /// What it is for.
    pub header: Header,
    /// What the steps add up to.
    pub totals: Totals,
    /// Blocks, the last one among them.
    pub blocks: u64,
    /// Shortest time between two steps of each axis, µs; `None` where it has not two.
    pub shortest: [Option<i64>; AXES],
    /// What the machine would not do, in the stream's order, one of each kind for each axis.
    pub findings: Vec<Finding>,
}

/// Something that the machine would not do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Its kind: `beyond-switch`, `too-fast` or `turns-too-soon`.
    pub code: &'static str,
    /// The axis.
    pub axis: &'static str,
    /// Number of the block in which it occurs first, from 0.
    pub block: u64,
    /// Time of the first, s.
    pub seconds: f64,
    /// How often it occurs.
    pub times: u64,
    /// What is wrong, in words.
    pub message: String,
}

impl Played {
    /// How long it takes, s.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.totals.time as f64 / 1e6
    }

    /// Where the axes stand at the end, mm.
    #[must_use]
    pub fn end_mm(&self) -> [f64; AXES] {
        self.header.machine.mm(self.totals.end)
    }

    /// Most steps a second of each axis, by the shortest time between two of them; 0 where it has not
    /// two.
    #[must_use]
    pub fn highest_rate(&self) -> [f64; AXES] {
        self.shortest.map(|shortest| shortest.map_or(0.0, |time| 1e6 / time.max(1) as f64))
    }
}

/// Plays a stream, called `file` in messages, and hands each item to `sink` with its block.
///
/// # Errors
/// [`Error`]: anything but a whole stream.
pub fn play(
    source: &mut dyn Read,
    file: &str,
    mut begin: impl FnMut(&Header),
    mut sink: impl FnMut(u64, &Item),
) -> Result<Played, Error> {
    let of_file = |cause: Cause| cause.of(file);
    let mut decoder = Decoder::new(source).map_err(of_file)?;
    let header = decoder.header().clone();
    begin(&header);
    let mut player = Player::new(&header);
    while let Some((block, items)) = decoder.block().map_err(of_file)? {
        for item in items {
            if let Item::Step { at, mask, backwards } = *item {
                player.step(block, at, mask, backwards);
            }
            sink(block, item);
        }
    }
    Ok(Played {
        totals: decoder.totals(),
        blocks: decoder.blocks(),
        shortest: player.shortest,
        findings: player.findings(),
        header,
    })
}

/// A kind of finding of an axis: its first block and time, how often it occurs, and the worst.
type Found = Option<(u64, i64, u64, f64)>;

/// Watches the axes.
struct Player<'a> {
    header: &'a Header,
    at: [i64; AXES],
    last: [Option<i64>; AXES],
    backwards: u8,
    shortest: [Option<i64>; AXES],
    /// Beyond the ends, too fast, turns too soon.
    found: [[Found; AXES]; 3],
}

impl<'a> Player<'a> {
    fn new(header: &'a Header) -> Self {
        Self {
            header,
            at: header.machine.start,
            last: [None; AXES],
            backwards: 0,
            shortest: [None; AXES],
            found: [[None; AXES]; 3],
        }
    }

    fn step(&mut self, block: u64, at: i64, mask: u8, backwards: u8) {
        let machine = &self.header.machine;
        for axis in (0..AXES).filter(|axis| mask >> axis & 1 == 1) {
            let (back, was) = (backwards >> axis & 1 == 1, self.backwards >> axis & 1 == 1);
            self.at[axis] += if back { -1 } else { 1 };
            if let Some(mm) = machine.beyond(axis, self.at[axis]) {
                note(&mut self.found[0][axis], block, at, mm);
            }
            if let Some(last) = self.last[axis] {
                let apart = at - last;
                let shortest = self.shortest[axis].get_or_insert(apart);
                *shortest = (*shortest).min(apart);
                if apart < i64::from(machine.interval[axis]) {
                    note(&mut self.found[1][axis], block, at, 1e6 / apart.max(1) as f64);
                }
                if back != was && apart < i64::from(machine.turn) {
                    note(&mut self.found[2][axis], block, at, -(apart as f64));
                }
            }
            self.last[axis] = Some(at);
            self.backwards = self.backwards & !(1 << axis) | u8::from(back) << axis;
        }
    }

    fn findings(&self) -> Vec<Finding> {
        let codes = ["beyond-switch", "too-fast", "turns-too-soon"];
        let mut findings = Vec::new();
        for (kind, code) in codes.into_iter().enumerate() {
            for axis in 0..AXES {
                let Some((block, at, times, worst)) = self.found[kind][axis] else { continue };
                let machine = &self.header.machine;
                let letter = LETTERS[axis];
                let message = match kind {
                    0 => beyond_text(axis, worst),
                    1 => format!(
                        "{letter} makes {worst:.0} steps/s, where its motor makes {:.0}",
                        1e6 / f64::from(machine.interval[axis])
                    ),
                    _ => format!(
                        "{letter} turns round after {:.0} µs, where it needs {}",
                        -worst, machine.turn
                    ),
                };
                let (axis, seconds) = (["x", "y", "z", "e"][axis], at as f64 / 1e6);
                findings.push(Finding { code, axis, block, seconds, times, message });
            }
        }
        findings.sort_by_key(|finding| finding.block);
        findings
    }
}

fn note(found: &mut Found, block: u64, at: i64, size: f64) {
    let (_, _, times, worst) = found.get_or_insert((block, at, 0, size));
    *times += 1;
    *worst = worst.max(size);
}
