//! Bytes read so far -> how many pieces an arc may have, so that a short file is no long work.

/// Pieces that any file may have: what a hundred full circles of 50 mm need.
const ANY: u64 = 20_000;

/// Pieces for each byte of the file. A line with a full circle has some 40 bytes, and 320 pieces are what
/// one of 100 mm needs: only files of larger circles alone are read coarser.
const PER_BYTE: u64 = 8;

/// What has been used of it.
#[derive(Debug, Clone, Default)]
pub(super) struct Pieces {
    bytes: u64,
    used: u64,
}

impl Pieces {
    /// So many bytes more are read.
    pub(super) fn read(&mut self, bytes: usize) {
        self.bytes += bytes as u64;
    }

    /// Of so many pieces wanted those that an arc gets, at least one.
    pub(super) fn take(&mut self, wanted: u32) -> u32 {
        let left = (ANY + PER_BYTE * self.bytes).saturating_sub(self.used);
        let given = u64::from(wanted).min(left).max(1);
        self.used += given;
        given as u32
    }
}
