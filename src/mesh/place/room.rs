//! Boxes + bed + what is taken of it -> where they lie, and how many would fit.
//!
//! What the start block primes is *taken*: nothing may lie there. Bodies lie in the middle of the bed as long as
//! that keeps clear; else in the middle of the *rest*, the rectangle that is left when each taken box is cut off by
//! the side that costs least. Where they do not fit into that, either, they lie as if nothing were taken: a box
//! is larger than what is printed in it, so that they may be clear all the same.

use super::shelves::{Layout, shelves};
use crate::mesh::Bed;
use crate::units::{MAX_COORDINATE_MM, to_mm, to_units};

/// Boxes that lie, and the space in whose middle they lie.
pub(super) struct Laid {
    pub(super) layout: Layout,
    pub(super) within: Bed,
    /// Whether nothing lies in a taken box.
    is_clear: bool,
}

/// The bed, and what is taken of it.
pub(super) struct Room<'a> {
    pub(super) bed: &'a Bed,
    pub(super) taken: &'a [[[f64; 2]; 2]],
    /// Distance between boxes, grid units.
    pub(super) gap: i64,
}

impl Room<'_> {
    /// Lays boxes on the bed, if they fit.
    pub(super) fn lay(&self, boxes: &[[i64; 2]]) -> Option<Laid> {
        let whole = self.within(*self.bed, boxes)?;
        // A model by itself lies in the middle, where people look for it.
        if whole.is_clear || boxes.len() == 1 {
            return Some(whole);
        }
        let rest = self.within(self.rest(), boxes);
        Some(rest.unwrap_or(whole))
    }

    /// Whether boxes fit, and keep clear.
    fn fits(&self, boxes: &[[i64; 2]]) -> bool {
        self.lay(boxes).is_some_and(|laid| laid.is_clear || boxes.len() == 1)
    }

    /// The most copies of these boxes that fit, below `copies`.
    pub(super) fn copies(&self, each: &[[i64; 2]], copies: usize) -> usize {
        let room =
            |[width, depth]: [i64; 2]| i128::from(width + self.gap) * i128::from(depth + self.gap);
        let all: i128 = each.iter().map(|&size| room(size)).sum();
        // No more than their areas let.
        let most = usize::try_from(room(sides(self.bed)) / all.max(1)).unwrap_or(usize::MAX);
        let of = |copies: usize| -> Vec<[i64; 2]> {
            each.iter().flat_map(|&size| std::iter::repeat_n(size, copies)).collect()
        };
        // `low` fit, `high` do not.
        let (mut low, mut high) = (0, copies.min(most.saturating_add(1)).max(1));
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if self.fits(&of(middle)) { low = middle } else { high = middle }
        }
        low
    }

    /// How many of these boxes fit, from the first on.
    pub(super) fn first(&self, each: &[[i64; 2]]) -> usize {
        (1..=each.len()).rev().find(|&count| self.fits(&each[..count])).unwrap_or(0)
    }

    fn within(&self, within: Bed, boxes: &[[i64; 2]]) -> Option<Laid> {
        let layout = shelves(boxes, sides(&within), self.gap)?;
        let middle = [0, 1].map(|axis| f64::midpoint(within.min[axis], within.max[axis]));
        let lies_clear = |(at, size): (&[i32; 2], &[i64; 2])| {
            let corner = |axis: usize, side: f64| {
                middle[axis] + to_mm(at[axis]) + side * size[axis] as f64 * to_mm(1) / 2.0
            };
            self.taken.iter().all(|[low, high]| {
                (0..2)
                    .any(|axis| corner(axis, 1.0) <= low[axis] || corner(axis, -1.0) >= high[axis])
            })
        };
        let is_clear = layout.middles.iter().zip(boxes).all(lies_clear);
        Some(Laid { layout, within, is_clear })
    }

    /// The bed without what is taken.
    fn rest(&self) -> Bed {
        self.taken.iter().fold(*self.bed, |bed, [low, high]| {
            if (0..2).any(|axis| high[axis] <= bed.min[axis] || low[axis] >= bed.max[axis]) {
                return bed;
            }
            let cut = |axis: usize, from: bool| {
                let mut rest = bed;
                if from {
                    rest.min[axis] = high[axis].min(bed.max[axis]);
                } else {
                    rest.max[axis] = low[axis].max(bed.min[axis]);
                }
                rest
            };
            let area = |bed: &Bed| bed.size()[0] * bed.size()[1];
            let cuts = [cut(0, true), cut(0, false), cut(1, true), cut(1, false)];
            cuts.into_iter().max_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or(bed)
        })
    }
}

/// One unit more, since boxes were rounded up to even sizes.
fn sides(bed: &Bed) -> [i64; 2] {
    bed.size().map(|side| i64::from(to_units(side.min(MAX_COORDINATE_MM))) + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BED: Bed = Bed { min: [0.0; 2], max: [220.0; 2], height: 250.0 };

    /// What an Ender-3 primes.
    const TAKEN: [[[f64; 2]; 2]; 1] = [[[1.5, 19.5], [3.0, 120.5]]];

    #[test]
    fn several_boxes_keep_clear_of_what_is_taken() {
        let room = Room { bed: &BED, taken: &TAKEN, gap: 50_000 };
        // As long as they do they lie in the middle.
        let laid = room.lay(&[[200_000, 200_000]; 64]).unwrap();
        assert!(laid.is_clear && laid.within == BED);
        let full = room.lay(&[[200_000, 200_000]; 81]).unwrap();
        assert!(!full.is_clear, "there are 81 without that line alone");
        let most = room.copies(&[[200_000, 200_000]], 9999);
        assert_eq!(most, 72);
        assert!(room.lay(&vec![[200_000, 200_000]; most]).unwrap().is_clear);
        // Beside it there is as much room as they need.
        let laid = room.lay(&[[2_160_000, 900_000]; 2]).unwrap();
        assert!(laid.is_clear && laid.within.min == [3.0, 0.0]);
        assert_eq!(room.copies(&[[200_000, 200_000]], 60), 59);
        assert_eq!(room.copies(&[[2_300_000, 200_000]], 9), 0);
        assert_eq!(room.first(&[[1_000_000, 2_000_000]; 3]), 2);
        // What is taken beside the bed takes nothing.
        let beside = [[[-5.0, 0.0], [-1.0, 220.0]]];
        let room = Room { bed: &BED, taken: &beside, gap: 50_000 };
        assert_eq!(room.copies(&[[200_000, 200_000]], 9999), 81);
    }
}
