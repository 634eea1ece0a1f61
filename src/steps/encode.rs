//! Steps with their times -> blocks of a stream, written as they are full.
//!
//! Words used here: an *interval* is the time from one step to the next; a *mark* tells where a move of the
//! file ends; *room* is what a block has left.
//!
//! - A step takes a byte where its interval differs little from the one before, as it does on a move and
//!   on ramps.
//! - Other directions and long pauses come before the step that they are for, in the same block.
//! - Each block begins without anything known: its first step has its interval in full.
//! - Totals are summed up on the way, for the last block.

use super::axis::{AXES, nearest};
use super::coils;
use super::format::{
    DIRECTIONS, FAR, Form, HEAD, Header, LONGEST, MARK, OF_STEPS, OF_TOTALS, PAUSE, PAYLOAD, SAME,
    Totals, UM, push_number, seal,
};
use std::io::{self, Write};

/// Bytes that the longest records take that belong together: directions, pauses apart, a step.
const MOST: usize = 2 + 1 + 5;

/// Bytes of a mark.
const MARKED: usize = 1 + 2 * AXES + 4;

/// Writes a stream.
#[derive(Debug)]
pub struct Encoder<W> {
    out: W,
    form: Form,
    /// The block that is being filled, with room for its head.
    block: Vec<u8>,
    number: u32,
    /// Records of steps in it.
    count: u16,
    /// Directions of the last step, a bit for each axis that goes to lower numbers.
    backwards: u8,
    /// Time of the last record, µs, and how long that took; the latter is 0 at a block's beginning.
    at: i64,
    interval: i64,
    /// What the coils show.
    patterns: u16,
    totals: Totals,
}

impl<W: Write> Encoder<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// What writing gives.
    pub fn new(mut out: W, header: &Header) -> io::Result<Self> {
        out.write_all(&header.bytes())?;
        let totals = Totals { end: header.machine.start, ..Totals::default() };
        let (form, block) = (header.form, Vec::with_capacity(HEAD + PAYLOAD + 4));
        let mut encoder = Self {
            out,
            form,
            block,
            number: 0,
            count: 0,
            backwards: 0,
            at: 0,
            interval: 0,
            patterns: match header.form {
                Form::Steps => 0,
                Form::Coils(full) => coils::patterns(header.machine.start, full),
            },
            totals,
        };
        encoder.begin();
        Ok(encoder)
    }

    /// The axes of `mask` step at this time, µs, which is not before that of the step before.
    ///
    /// # Errors
    /// What writing gives.
    #[inline]
    pub fn step(&mut self, at: i64, mask: u8, backwards: u8) -> io::Result<()> {
        let totals = &mut self.totals;
        for axis in 0..AXES {
            let by = i64::from(mask >> axis & 1);
            totals.steps[axis] += by as u64;
            totals.end[axis] += by * (1 - 2 * i64::from(backwards >> axis & 1));
        }
        totals.instants += 1;
        if let Form::Coils(full) = self.form {
            return self.pattern(at, full);
        }
        self.room(MOST)?;
        let interval = at - self.at;
        let turns = mask & (backwards ^ self.backwards);
        if turns != 0 || interval > LONGEST {
            self.before(at, turns)?;
        }
        let interval = at - self.at;
        let code = interval - self.interval + SAME;
        if (0..i64::from(FAR)).contains(&code) && self.interval > 0 {
            self.block.push((code as u8) << 4 | mask);
        } else {
            self.block.push(FAR << 4 | mask);
            push_number(&mut self.block, interval);
        }
        (self.at, self.interval) = (at, interval);
        self.count += 1;
        Ok(())
    }

    /// What comes between two steps: other directions, and the time that is too long for a record.
    fn before(&mut self, at: i64, turns: u8) -> io::Result<()> {
        while at - self.at > LONGEST {
            self.room(MOST)?;
            self.block.push(PAUSE);
            push_number(&mut self.block, LONGEST);
            self.at += LONGEST;
        }
        self.room(MOST)?;
        self.backwards ^= turns;
        self.block.extend([DIRECTIONS, self.backwards]);
        Ok(())
    }

    fn pattern(&mut self, at: i64, full: [bool; AXES]) -> io::Result<()> {
        let longest = i64::from(u16::MAX);
        while at - self.at > longest {
            self.room(4)?;
            self.block.extend(self.patterns.to_le_bytes());
            self.block.extend(u16::MAX.to_le_bytes());
            self.at += longest;
            self.count += 1;
        }
        self.room(4)?;
        self.patterns = coils::patterns(self.totals.end, full);
        self.block.extend(self.patterns.to_le_bytes());
        self.block.extend(((at - self.at) as u16).to_le_bytes());
        self.at = at;
        self.count += 1;
        Ok(())
    }

    /// A move of the file ends at these places; it had this feed, mm/s.
    ///
    /// # Errors
    /// What writing gives.
    pub fn mark(&mut self, places: [i64; AXES], feed: f64) -> io::Result<()> {
        if matches!(self.form, Form::Coils(_)) {
            return Ok(());
        }
        self.room(MARKED)?;
        self.block.push(MARK);
        for place in places {
            let part = (place - (nearest(place) << 32)) >> 16;
            self.block.extend((part as i16).to_le_bytes());
        }
        self.block.extend(((feed * UM).round() as u32).to_le_bytes());
        Ok(())
    }

    /// Writes the last block; `time` is that of all, µs. Gives the totals and the number of blocks.
    ///
    /// # Errors
    /// What writing gives.
    pub fn finish(mut self, time: i64) -> io::Result<(Totals, u32, W)> {
        self.end(OF_STEPS)?;
        self.totals.time = time as u64;
        let totals = self.totals.bytes();
        self.block.extend(totals);
        self.count = 0;
        self.write(OF_TOTALS)?;
        self.out.flush()?;
        Ok((self.totals, self.number, self.out))
    }

    /// Makes room for so many bytes.
    #[inline]
    fn room(&mut self, bytes: usize) -> io::Result<()> {
        if self.block.len() + bytes > HEAD + PAYLOAD { self.end(OF_STEPS) } else { Ok(()) }
    }

    fn end(&mut self, kind: u8) -> io::Result<()> {
        if self.block.len() > HEAD { self.write(kind) } else { Ok(()) }
    }

    fn begin(&mut self) {
        self.block.clear();
        self.block.extend([0; HEAD]);
        // Directions at the block's beginning.
        self.block[1] = self.backwards;
        self.count = 0;
        self.interval = 0;
    }

    fn write(&mut self, kind: u8) -> io::Result<()> {
        let length = (self.block.len() - HEAD) as u16;
        self.block[0] = kind;
        self.block[2..4].copy_from_slice(&length.to_le_bytes());
        self.block[4..8].copy_from_slice(&self.number.to_le_bytes());
        self.block[8..10].copy_from_slice(&self.count.to_le_bytes());
        seal(&mut self.block);
        self.out.write_all(&self.block)?;
        self.number = self.number.checked_add(1).ok_or_else(|| {
            io::Error::other("the stream has more blocks than their numbers can count")
        })?;
        self.begin();
        Ok(())
    }
}
