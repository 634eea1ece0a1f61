//! A stream's file -> its blocks, one after the other, once all of it was found to be right.

use super::super::axis::AXES;
use super::super::decode::{Decoder, Item};
use super::super::error::{self as stream, Damage};
use super::super::format::{HEAD, HEADER, PAYLOAD, SUM};
use super::event::Ms;
use super::frame::Job;
use std::collections::VecDeque;
use std::io::{Read, Seek, SeekFrom};

/// Microseconds in a millisecond.
const MS: u64 = 1000;

/// Blocks of a file that was read once, whole: nothing is sent of one that is damaged. It is read a second
/// time as it is sent; of that, memory holds what a board may ask for again.
#[derive(Debug)]
pub struct Feed<R> {
    source: R,
    /// For messages.
    name: String,
    header: Vec<u8>,
    job: Job,
    longest: Ms,
    seconds: f64,
    steps: [u64; AXES],
    /// Blocks that may be asked for; the first has number `first`.
    kept: VecDeque<Vec<u8>>,
    first: u32,
}

/// A source whose bytes are summed up.
struct Summed<R> {
    source: R,
    sum: crc32fast::Hasher,
}

impl<R: Read> Read for Summed<R> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let count = self.source.read(bytes)?;
        self.sum.update(&bytes[..count]);
        Ok(count)
    }
}

impl<R: Read + Seek> Feed<R> {
    /// Reads a stream whole, and goes back to its first block. `go_on` is asked after each block.
    ///
    /// # Errors
    /// As the decoder's; `Ok(None)` if `go_on` said no.
    pub fn new(
        mut source: R,
        name: &str,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<Option<Self>, stream::Error> {
        let of = |cause: stream::Cause| cause.of(name);
        let mut summed = Summed { source: &mut source, sum: crc32fast::Hasher::new() };
        let mut decoder = Decoder::new(&mut summed).map_err(of)?;
        let header = decoder.header().bytes();
        let (mut longest, mut last) = (0, 0);
        while let Some((_, items)) = decoder.block().map_err(of)? {
            let at = items.iter().rev().find_map(|item| match item {
                Item::Step { at, .. } => Some(*at as u64),
                Item::Mark { .. } => None,
            });
            if let Some(at) = at {
                longest = longest.max(at.saturating_sub(last));
                last = at;
            }
            if !go_on() {
                return Ok(None);
            }
        }
        let (totals, blocks) = (decoder.totals(), decoder.blocks() as u32);
        let longest = longest.max(totals.time.saturating_sub(last)).div_ceil(MS);
        let job = Job { sum: summed.sum.finalize(), blocks };
        let back = source.seek(SeekFrom::Start(HEADER as u64));
        back.map_err(|error| stream::Cause::Unreadable(error).of(name))?;
        Ok(Some(Self {
            source,
            name: name.to_owned(),
            header,
            job,
            longest,
            seconds: totals.time as f64 / 1e6,
            steps: totals.steps,
            kept: VecDeque::new(),
            first: 0,
        }))
    }

    /// The header's bytes.
    pub fn header(&self) -> &[u8] {
        &self.header
    }

    /// Which stream it is.
    pub fn job(&self) -> Job {
        self.job
    }

    /// How long its longest block takes, ms.
    pub fn longest(&self) -> Ms {
        self.longest
    }

    /// How long all of it takes, s.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Steps of each axis.
    pub fn steps(&self) -> [u64; AXES] {
        self.steps
    }

    /// A block. Those before `next` are not asked for any more.
    ///
    /// # Errors
    /// [`stream::Cause::Damaged`] if the file is another than it was, [`stream::Cause::Unreadable`].
    pub fn block(&mut self, number: u32, next: u32) -> Result<&[u8], stream::Error> {
        loop {
            while self.first < next && self.kept.pop_front().is_some() {
                self.first += 1;
            }
            let at = number.checked_sub(self.first).map(|at| at as usize);
            let number = u64::from(number);
            let lost = || stream::Cause::Damaged { block: number, what: Damage::Cut };
            match at {
                None => return Err(lost().of(&self.name)),
                Some(at) if at < self.kept.len() => return Ok(&self.kept[at]),
                Some(_) => {
                    let block = self.read().map_err(|cause| cause.of(&self.name))?;
                    self.kept.push_back(block);
                }
            }
        }
    }

    /// The next block of the file, which has to be as it was.
    fn read(&mut self) -> Result<Vec<u8>, stream::Cause> {
        let number = self.first + self.kept.len() as u32;
        let damaged = |what| stream::Cause::Damaged { block: u64::from(number), what };
        let mut block = vec![0; HEAD];
        self.source.read_exact(&mut block).map_err(|_| damaged(Damage::Cut))?;
        let length = usize::from(u16::from_le_bytes([block[2], block[3]]));
        if length > PAYLOAD {
            return Err(damaged(Damage::Sum));
        }
        block.resize(HEAD + length + SUM, 0);
        self.source.read_exact(&mut block[HEAD..]).map_err(|_| damaged(Damage::Cut))?;
        let (rest, sum) = block.split_at(HEAD + length);
        if crc32fast::hash(rest).to_le_bytes() != *sum {
            return Err(damaged(Damage::Sum));
        }
        let told = u32::from_le_bytes([block[4], block[5], block[6], block[7]]);
        if told != number {
            return Err(damaged(Damage::Order(told)));
        }
        Ok(block)
    }
}
