//! Bytes -> output: appends to a G-code file, and overwrites bytes at a known place.

use super::error::Result;
use std::io::{Seek, SeekFrom, Write};

/// What a G-code file is written to, at its beginning.
///
/// - [`Seek`], since `M73` tells the printer which share of the print is done: the time of the
///   whole print is known at its end only, and the lines are filled in then.
/// - [`Send`], since a batch of layers is written by another thread than the one that plans the
///   next.
///
/// Any other output: [`slice_to`](crate::slice_to).
pub trait Output: Write + Seek + Send {}

impl<T: Write + Seek + Send> Output for T {}

/// An output that knows where it is.
pub(super) struct Places<'a> {
    pub(super) out: &'a mut dyn Output,
    /// Bytes so far.
    pub(super) written: u64,
    /// These bytes, until something is extruded: a job that extrudes nothing is refused, and
    /// must not have written anything by then.
    pub(super) held: Option<Vec<u8>>,
}

impl Places<'_> {
    pub(super) fn put(&mut self, bytes: &[u8]) -> Result<()> {
        self.written += bytes.len() as u64;
        match &mut self.held {
            Some(held) => held.extend_from_slice(bytes),
            None => self.out.write_all(bytes)?,
        }
        Ok(())
    }

    /// From now on all bytes are written, those that were held first.
    pub(super) fn release(&mut self) -> Result<()> {
        if let Some(held) = self.held.take() {
            self.out.write_all(&held)?;
        }
        Ok(())
    }

    /// Writes over what stands at this byte.
    pub(super) fn put_at(&mut self, place: u64, bytes: &[u8]) -> Result<()> {
        self.out.seek(SeekFrom::Start(place))?;
        Ok(self.out.write_all(bytes)?)
    }
}
