//! The bytes of a stream of steps: header, blocks, records; FORMAT.md beside this file has them in words.
//!
//! - The *header* says what a step is: [`Header`].
//! - A *block* has at most [`BLOCK`] bytes: kind, directions, length, number and count, then its payload,
//!   then a CRC-32 of all of it. It is read without any other.
//! - A *record* of the payload is a step of some axes at one time, or tells something between two.
//!
//! All numbers are little-endian. What is written here is read in [`decode`](super::decode).

use super::axis::{AXES, MOST_STEPS, Scale};
use super::machine::Machine;

/// The first bytes of a stream: a transfer as text, or one that cuts the eighth bit, damages them.
pub(super) const MAGIC: [u8; 8] = *b"\x89STEPS\r\n";

/// Version of the format.
pub(super) const VERSION: u16 = 1;

/// Bytes of the header, its checksum included.
pub(super) const HEADER: usize = 216;

/// Bytes of a block at most.
pub const BLOCK: usize = 512;

/// Bytes of a block before its payload.
pub(super) const HEAD: usize = 10;

/// Bytes of a checksum.
pub(super) const SUM: usize = 4;

/// Bytes of a payload at most.
pub(super) const PAYLOAD: usize = BLOCK - HEAD - SUM;

/// A block of records.
pub(super) const OF_STEPS: u8 = 1;

/// The last block.
pub(super) const OF_TOTALS: u8 = 2;

/// High half of a byte whose time follows as a number.
pub(super) const FAR: u8 = 15;

/// High half of a byte whose time is that of the step before.
pub(super) const SAME: i64 = 7;

/// A byte that is followed by directions.
pub(super) const DIRECTIONS: u8 = 0x00;

/// A byte that is followed by a time in which no axis steps.
pub(super) const PAUSE: u8 = 0x10;

/// A byte that is followed by where a move of the file ends, in parts of a step, and its feed.
pub(super) const MARK: u8 = 0x20;

/// Micrometres in a mm: feeds are in µm/s.
pub(super) const UM: f64 = 1000.0;

/// The longest time of a record, µs; what is longer has pauses before it.
pub(super) const LONGEST: i64 = (1 << 31) - 1;

/// What a stream holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Steps.
    Steps,
    /// Patterns of coils; for each axis whether a step is a full step.
    Coils([bool; AXES]),
}

/// The header of a stream.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// What the stream holds.
    pub form: Form,
    /// What it is for.
    pub machine: Machine,
}

/// The last block of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Totals {
    /// Where the axes stand, in steps.
    pub end: [i64; AXES],
    /// Steps of each axis.
    pub steps: [u64; AXES],
    /// Times at which any axis steps.
    pub instants: u64,
    /// How long it takes, µs.
    pub time: u64,
}

impl Header {
    /// Its bytes.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let machine = &self.machine;
        let mut bytes = Vec::with_capacity(HEADER);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((HEADER as u16).to_le_bytes());
        let (form, full) = match self.form {
            Form::Steps => (0, 0),
            Form::Coils(full) => {
                (1, full.iter().rev().fold(0, |mask, full| mask << 1 | u8::from(*full)))
            }
        };
        bytes.extend([form, full]);
        bytes.extend((machine.pulse as u16).to_le_bytes());
        bytes.extend(machine.turn.to_le_bytes());
        for axis in 0..AXES {
            bytes.extend(machine.scale[axis].steps.to_le_bytes());
            bytes.extend(machine.scale[axis].mm.to_le_bytes());
            let interval = machine.interval[axis];
            bytes.extend((1_000_000 / interval.max(1)).to_le_bytes());
            bytes.extend(interval.to_le_bytes());
            bytes.extend(machine.start[axis].to_le_bytes());
            bytes.extend(machine.ends[0][axis].to_le_bytes());
            bytes.extend(machine.ends[1][axis].to_le_bytes());
        }
        seal(&mut bytes);
        bytes
    }

    /// Of the bytes between magic and checksum, which are known to be whole; `None` for what no machine is.
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        let mut bytes = Fields(bytes.get(12..)?);
        let [form, full] = bytes.take()?;
        let form = match form {
            0 => Form::Steps,
            1 => Form::Coils(std::array::from_fn(|axis| full >> axis & 1 == 1)),
            _ => return None,
        };
        let pulse = u32::from(u16::from_le_bytes(bytes.take()?));
        let turn = u32::from_le_bytes(bytes.take()?);
        let mut machine = Machine {
            scale: [Scale { steps: 1, mm: 1 }; AXES],
            interval: [1; AXES],
            turn,
            pulse,
            start: [0; AXES],
            ends: [[0; AXES]; 2],
        };
        for axis in 0..AXES {
            let steps = u64::from_le_bytes(bytes.take()?);
            machine.scale[axis] = Scale::of(steps, u64::from_le_bytes(bytes.take()?))?;
            // The rate is there for people and boards: it says the same as the interval.
            let _rate: [u8; 4] = bytes.take()?;
            machine.interval[axis] = u32::from_le_bytes(bytes.take()?);
            machine.start[axis] = i64::from_le_bytes(bytes.take()?);
            if machine.start[axis].unsigned_abs() > MOST_STEPS as u64 {
                return None;
            }
            machine.ends[0][axis] = i64::from_le_bytes(bytes.take()?);
            machine.ends[1][axis] = i64::from_le_bytes(bytes.take()?);
        }
        Some(Self { form, machine })
    }
}

impl Totals {
    /// The payload of the last block.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let end = self.end.iter().flat_map(|end| end.to_le_bytes());
        let steps = self.steps.iter().flat_map(|steps| steps.to_le_bytes());
        let rest = [self.instants, self.time];
        end.chain(steps).chain(rest.iter().flat_map(|one| one.to_le_bytes())).collect()
    }

    pub(super) fn read(payload: &[u8]) -> Option<Self> {
        let mut fields = Fields(payload);
        let mut totals = Self::default();
        for end in &mut totals.end {
            *end = i64::from_le_bytes(fields.take()?);
        }
        for steps in &mut totals.steps {
            *steps = u64::from_le_bytes(fields.take()?);
        }
        totals.instants = u64::from_le_bytes(fields.take()?);
        totals.time = u64::from_le_bytes(fields.take()?);
        fields.0.is_empty().then_some(totals)
    }
}

/// Bytes that are taken from the front.
pub(super) struct Fields<'a>(pub(super) &'a [u8]);

impl Fields<'_> {
    /// So many bytes; `None` if there are fewer.
    #[inline]
    pub(super) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }

    /// A number in seven bits a byte, the lowest first; none is longer than five bytes, or above [`LONGEST`].
    pub(super) fn number(&mut self) -> Option<i64> {
        let mut number = 0;
        for k in 0..5 {
            let [byte] = self.take()?;
            number |= i64::from(byte & 0x7F) << (7 * k);
            if byte < 0x80 {
                return (number <= LONGEST).then_some(number);
            }
        }
        None
    }
}

/// Adds a checksum of all bytes.
pub(super) fn seal(bytes: &mut Vec<u8>) {
    let sum = crc32fast::hash(bytes);
    bytes.extend(sum.to_le_bytes());
}

/// Writes a number in seven bits a byte, the lowest first.
pub(super) fn push_number(bytes: &mut Vec<u8>, mut number: i64) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}
