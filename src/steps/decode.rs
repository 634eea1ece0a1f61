//! Bytes of a stream -> steps with their times, block by block; anything but what was written is refused.
//!
//! Words used here: an *item* is a step of some axes at one time, or the end of a move of the file; the
//! *form* is whether a stream holds steps or patterns of coils.
//!
//! 1. The header is read, and refused where it is another's or damaged.
//! 2. A block is read by the length in it, then judged: its checksum, its number, every record, and of the
//!    last one the totals. Only then its items are handed out, so that nothing of a damaged block is
//!    played. What a board does with a block is the same.
//! 3. After the last block nothing may follow.

use super::axis::AXES;
use super::coils;
use super::error::{Cause, Damage};
use super::format::{
    DIRECTIONS, FAR, Fields, Form, HEAD, HEADER, Header, LONGEST, MAGIC, MARK, OF_STEPS, OF_TOTALS,
    PAUSE, PAYLOAD, SAME, SUM, Totals, VERSION,
};
use std::io::{self, Read};

/// A bit for each axis.
const ALL: u8 = (1 << AXES) - 1;

/// What a block holds, in its order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Item {
    /// Axes step.
    Step {
        /// When, µs from the beginning.
        at: i64,
        /// Which, a bit for each.
        mask: u8,
        /// Which of all axes go towards lower numbers.
        backwards: u8,
    },
    /// A move of the file ends here.
    Mark {
        /// How far its true end lies beside each axis's step, in parts of 2⁻¹⁶ step.
        parts: [i16; AXES],
        /// Its feed, µm/s.
        feed: u32,
    },
}

/// Reads a stream.
#[derive(Debug)]
pub struct Decoder<R> {
    source: R,
    header: Header,
    /// Blocks that were read.
    blocks: u64,
    at: i64,
    /// What the steps add up to.
    totals: Totals,
    items: Vec<Item>,
    /// The last block was read.
    ended: bool,
}

impl<R: Read> Decoder<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// [`Cause::NotSteps`], [`Cause::Version`], [`Cause::Header`], [`Cause::Unreadable`].
    pub fn new(mut source: R) -> Result<Self, Cause> {
        let mut bytes = [0; HEADER];
        let read = fill(&mut source, &mut bytes)?;
        if read < 10 || bytes[..8] != MAGIC {
            return Err(Cause::NotSteps);
        }
        let version = u16::from_le_bytes([bytes[8], bytes[9]]);
        if version != VERSION {
            return Err(Cause::Version(version));
        }
        let (rest, sum) = bytes.split_at(HEADER - SUM);
        let is_whole = read == HEADER && crc32fast::hash(rest).to_le_bytes() == *sum;
        let is_known = is_whole && rest[10..12] == (HEADER as u16).to_le_bytes();
        let header = Header::read(rest).filter(|_| is_known).ok_or(Cause::Header)?;
        let totals = Totals { end: header.machine.start, ..Totals::default() };
        let items = Vec::with_capacity(PAYLOAD);
        Ok(Self { source, header, blocks: 0, at: 0, totals, items, ended: false })
    }

    /// What the stream is for.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The next block's number and what it holds; `None` after the last one, of which all was right.
    ///
    /// # Errors
    /// [`Cause::Damaged`], [`Cause::Unreadable`].
    pub fn block(&mut self) -> Result<Option<(u64, &[Item])>, Cause> {
        if self.ended {
            return Ok(None);
        }
        let mut bytes = [0; HEAD + PAYLOAD + SUM];
        if fill(&mut self.source, &mut bytes[..HEAD])? < HEAD {
            return Err(self.damaged(Damage::Cut));
        }
        let length = usize::from(u16::from_le_bytes([bytes[2], bytes[3]]));
        if length > PAYLOAD {
            return Err(self.damaged(Damage::Sum));
        }
        let whole = HEAD + length + SUM;
        if fill(&mut self.source, &mut bytes[HEAD..whole])? < whole - HEAD {
            return Err(self.damaged(Damage::Cut));
        }
        let (rest, sum) = bytes[..whole].split_at(HEAD + length);
        if crc32fast::hash(rest).to_le_bytes() != *sum {
            return Err(self.damaged(Damage::Sum));
        }
        let number = u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]);
        if u64::from(number) != self.blocks {
            return Err(self.damaged(Damage::Order(number)));
        }
        let count = u16::from_le_bytes([bytes[8], bytes[9]]);
        let payload = &bytes[HEAD..HEAD + length];
        self.items.clear();
        match (bytes[0], self.header.form) {
            (OF_TOTALS, _) => self.last(payload, count)?,
            (OF_STEPS, form) => {
                let read = match form {
                    Form::Steps => self.steps(payload, bytes[1]),
                    Form::Coils(full) => self.patterns(payload, full),
                };
                if read != Some(count) {
                    return Err(self.damaged(Damage::Content));
                }
            }
            _ => return Err(self.damaged(Damage::Content)),
        }
        self.blocks += 1;
        Ok(Some((self.blocks - 1, &self.items)))
    }

    /// Blocks that were read, the last one among them.
    pub fn blocks(&self) -> u64 {
        self.blocks
    }

    /// What the steps so far add up to.
    pub fn totals(&self) -> Totals {
        self.totals
    }

    fn damaged(&self, what: Damage) -> Cause {
        Cause::Damaged { block: self.blocks, what }
    }

    fn last(&mut self, payload: &[u8], count: u16) -> Result<(), Cause> {
        let told = Totals::read(payload).ok_or_else(|| self.damaged(Damage::Content))?;
        let sums = Totals { time: told.time, ..self.totals };
        let is_over = i64::try_from(told.time).is_ok_and(|time| time >= self.at);
        if told != sums || count != 0 || !is_over {
            return Err(self.damaged(Damage::Totals));
        }
        self.totals = told;
        self.ended = true;
        if fill(&mut self.source, &mut [0])? > 0 {
            return Err(self.damaged(Damage::Trailing));
        }
        Ok(())
    }

    /// Reads records; gives how many of them are steps.
    fn steps(&mut self, payload: &[u8], mut backwards: u8) -> Option<u16> {
        let mut fields = Fields(payload);
        let (mut before, mut count) = (None, 0_u16);
        if backwards > ALL {
            return None;
        }
        while let Some([byte]) = fields.take() {
            let mask = byte & 15;
            if mask != 0 {
                let interval = match byte >> 4 {
                    FAR => fields.number()?,
                    code => before? + i64::from(code) - SAME,
                };
                if !(0..=LONGEST).contains(&interval) {
                    return None;
                }
                before = Some(interval);
                self.at = self.at.checked_add(interval)?;
                self.step(mask, backwards);
                count += 1;
                continue;
            }
            match byte {
                DIRECTIONS => [backwards] = fields.take()?,
                PAUSE => self.at = self.at.checked_add(fields.number()?)?,
                MARK => {
                    let mut parts = [0; AXES];
                    for part in &mut parts {
                        *part = i16::from_le_bytes(fields.take()?);
                    }
                    let feed = u32::from_le_bytes(fields.take()?);
                    self.items.push(Item::Mark { parts, feed });
                }
                _ => return None,
            }
            if backwards > ALL {
                return None;
            }
        }
        Some(count)
    }

    fn patterns(&mut self, payload: &[u8], full: [bool; AXES]) -> Option<u16> {
        let mut fields = Fields(payload);
        let mut count = 0;
        while !fields.0.is_empty() {
            let patterns = u16::from_le_bytes(fields.take()?);
            self.at = self.at.checked_add(i64::from(u16::from_le_bytes(fields.take()?)))?;
            let (mut mask, mut backwards) = (0, 0);
            for (axis, full) in full.into_iter().enumerate() {
                let pattern = (patterns >> (4 * axis) & 15) as u8;
                let by = coils::went(self.totals.end[axis], pattern, full)?;
                mask |= u8::from(by != 0) << axis;
                backwards |= u8::from(by < 0) << axis;
            }
            if mask != 0 {
                self.step(mask, backwards);
            }
            count += 1;
        }
        Some(count)
    }

    #[inline]
    fn step(&mut self, mask: u8, backwards: u8) {
        for axis in 0..AXES {
            let by = i64::from(mask >> axis & 1);
            self.totals.steps[axis] += by as u64;
            self.totals.end[axis] += by * (1 - 2 * i64::from(backwards >> axis & 1));
        }
        self.totals.instants += 1;
        self.items.push(Item::Step { at: self.at, mask, backwards });
    }
}

/// Reads until `bytes` are full or the source ends; gives how many there were.
fn fill(source: &mut impl Read, bytes: &mut [u8]) -> Result<usize, Cause> {
    let mut read = 0;
    while read < bytes.len() {
        match source.read(&mut bytes[read..]) {
            Ok(0) => break,
            Ok(count) => read += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(Cause::Unreadable(error)),
        }
    }
    Ok(read)
}
