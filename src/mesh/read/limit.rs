//! Number of triangles -> bytes: how much of a file is read, so that none can fill the memory or never end.

/// Bytes that a text may have without a triangle, and a binary file after its last one.
const SLACK: u64 = 16 << 20;

/// Bytes that a triangle of a text takes at most: four times what the longest numbers need.
const FACET: u64 = 1024;

/// Bytes that are read at once.
pub(crate) const CHUNK: u64 = 1 << 18;

/// How much is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Limit {
    /// Triangles of a file.
    pub(crate) triangles: usize,
}

impl Limit {
    /// Bytes that a file with so many `triangles` can need.
    pub(crate) fn most_bytes(self, triangles: usize) -> u64 {
        (triangles as u64).saturating_mul(FACET).saturating_add(SLACK)
    }

    /// Bytes that a file with as many triangles as are allowed can need.
    pub(crate) fn bytes(self) -> u64 {
        self.most_bytes(self.triangles)
    }

    /// Bytes after the last triangle of a binary file.
    pub(crate) fn trailing(self) -> u64 {
        SLACK
    }

    /// Says that there are too many triangles; `found` is a verb and their number.
    pub(crate) fn exceeded(self, found: &str) -> String {
        format!(
            "{found} triangles, and {} are allowed; simplify the model or raise --max-triangles",
            self.triangles
        )
    }
}

/// Says that reading failed.
pub(crate) fn unreadable(error: &std::io::Error) -> String {
    format!("cannot be read: {error}; check the name and the permissions")
}
