//! Bits -> Blobs: the connected patches of an area, each with its size and a place in it.

use super::raster::Bits;
use std::ops::Range;

/// A patch of pixels that touch one another, corners included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Blob {
    /// How many.
    pub(super) pixels: usize,
    /// One of them: the middle of its longest stretch.
    pub(super) at: [usize; 2],
    /// Length of its longest stretch.
    longest: usize,
}

/// The patches, in the order of their first rows.
pub(super) fn blobs(bits: &Bits) -> Vec<Blob> {
    if bits.is_empty() {
        return Vec::new();
    }
    let mut union = Union::default();
    let mut above: Vec<(Range<usize>, usize)> = Vec::new();
    for y in 0..bits.rows() {
        let mut row: Vec<(Range<usize>, usize)> = Vec::new();
        for stretch in bits.stretches(y) {
            let at = [usize::midpoint(stretch.start, stretch.end - 1), y];
            let blob = union.add(Blob { pixels: stretch.len(), at, longest: stretch.len() });
            for (other, root) in &above {
                // Corners touch, too.
                if other.start <= stretch.end && stretch.start <= other.end {
                    union.join(*root, blob);
                }
            }
            row.push((stretch, blob));
        }
        above = row;
    }
    union.blobs()
}

/// Patches that grow together.
#[derive(Default)]
struct Union {
    blobs: Vec<Blob>,
    /// The patch that each has become a part of; itself if none.
    parents: Vec<usize>,
}

impl Union {
    fn add(&mut self, blob: Blob) -> usize {
        self.blobs.push(blob);
        self.parents.push(self.parents.len());
        self.parents.len() - 1
    }

    fn root(&mut self, mut one: usize) -> usize {
        while self.parents[one] != one {
            self.parents[one] = self.parents[self.parents[one]];
            one = self.parents[one];
        }
        one
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if a == b {
            return;
        }
        // The older one stays, so that the order is that of the rows.
        let (old, young) = (a.min(b), a.max(b));
        self.parents[young] = old;
        let part = self.blobs[young];
        let whole = &mut self.blobs[old];
        whole.pixels += part.pixels;
        if part.longest > whole.longest {
            (whole.longest, whole.at) = (part.longest, part.at);
        }
    }

    fn blobs(self) -> Vec<Blob> {
        let roots = self.parents.iter().enumerate().filter(|(k, parent)| k == *parent);
        roots.map(|(k, _)| self.blobs[k]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_are_separated() {
        let mut bits = Bits::new([40, 4]);
        // A U, and a dot beside it that touches nothing.
        bits.set(0, 0..3);
        bits.set(0, 9..11);
        bits.set(1, 3..10);
        bits.set(1, 20..21);
        let found = blobs(&bits);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].pixels, found[0].at), (12, [6, 1]));
        assert_eq!((found[1].pixels, found[1].at), (1, [20, 1]));
        assert!(blobs(&Bits::new([5, 5])).is_empty());
    }
}
