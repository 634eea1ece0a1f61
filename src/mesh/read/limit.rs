//! Number of triangles -> bytes: how much of a file is read, so that no file can fill the memory and no pipe can keep the reader busy for ever.

/// Bytes that a text may have without any triangle, and a binary file after its last one.
///
/// Real files have a comment, a name or a colour table there, some kilobytes at most. Smaller
/// values would refuse such files; larger ones only read more of a file that is no model.
const SLACK: u64 = 16 << 20;

/// Bytes of text that one triangle takes at most.
///
/// Twelve numbers of 20 characters with all keywords and indents make about 250 bytes; this is
/// four times as many. A smaller value would refuse texts with wide indents.
const FACET: u64 = 1024;

/// Bytes of text that are read at a time: large enough that the calls to the system cost
/// nothing, small enough to stay in the processor's cache while the words are parsed.
pub(super) const CHUNK: u64 = 1 << 18;

/// How much is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Limit {
    /// Most triangles of a file.
    pub(super) triangles: usize,
}

impl Limit {
    /// Most bytes that a file with this many `triangles` can need.
    pub(super) fn most_bytes(self, triangles: usize) -> u64 {
        (triangles as u64).saturating_mul(FACET).saturating_add(SLACK)
    }

    /// Most bytes that a file with the allowed number of triangles can need.
    pub(super) fn bytes(self) -> u64 {
        self.most_bytes(self.triangles)
    }

    /// Most bytes after the last triangle of a binary file.
    pub(super) fn trailing(self) -> u64 {
        SLACK
    }
}
