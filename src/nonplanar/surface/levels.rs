//! Facets by height -> Levels: which of them reach into a band of heights.
//!
//! Facets are sorted by their lowest corners, so that those above a band are the last ones. A *batch* of
//! them in this order knows its highest corner: one that lies below the band is passed over as a whole.

use crate::units::Coord;

/// Facets in a batch.
const BATCH: usize = 32;

/// Facets in the order of their lowest corners.
#[derive(Debug)]
pub(super) struct Levels {
    order: Vec<u32>,
    /// The highest corner of each batch.
    highest: Vec<Coord>,
}

impl Levels {
    /// Sorts fewer than 2³² facets.
    #[must_use]
    pub(super) fn new(facets: &[[[Coord; 3]; 3]]) -> Self {
        let mut order: Vec<u32> = (0_u32..).take(facets.len()).collect();
        order.sort_unstable_by_key(|&k| (bounds(&facets[k as usize])[0], k));
        let highest = |batch: &[u32]| {
            let tops = batch.iter().map(|&k| bounds(&facets[k as usize])[1]);
            tops.max().unwrap_or(Coord::MIN)
        };
        let highest = order.chunks(BATCH).map(highest).collect();
        Self { order, highest }
    }

    /// Calls `with` for each facet with a place that is not lower than the first height and lower than the
    /// second; `facets` are those that were sorted.
    pub(super) fn each(
        &self,
        facets: &[[[Coord; 3]; 3]],
        [from, below]: [Coord; 2],
        mut with: impl FnMut(usize),
    ) {
        for (batch, &highest) in self.order.chunks(BATCH).zip(&self.highest) {
            if highest < from {
                continue;
            }
            for k in batch.iter().map(|&k| k as usize) {
                let [low, high] = bounds(&facets[k]);
                if low >= below {
                    return;
                }
                if high >= from {
                    with(k);
                }
            }
        }
    }
}

/// The lowest and the highest corner of a facet.
pub(super) fn bounds(facet: &[[Coord; 3]; 3]) -> [Coord; 2] {
    let [[.., a], [.., b], [.., c]] = *facet;
    [a.min(b).min(c), a.max(b).max(c)]
}
