//! Beads -> bitmap: counts how often each pixel of a layer is covered.

use super::gcode::Move;

/// Counts of beads over square pixels.
pub(crate) struct Bitmap {
    low: [f64; 2],
    pixel: f64,
    width: usize,
    counts: Vec<u16>,
}

impl Bitmap {
    /// Pixels of side `pixel` over the box from `low` to `high`, all empty.
    pub(crate) fn new(low: [f64; 2], high: [f64; 2], pixel: f64) -> Self {
        let side = |axis: usize| ((high[axis] - low[axis]) / pixel).ceil() as usize;
        Self { low, pixel, width: side(0), counts: vec![0; side(0) * side(1)] }
    }

    /// Counts the pixels whose middle lies under `bead`. Its ends and its sides are
    /// round, which makes it a little wider than a bar of the same volume.
    pub(crate) fn lay(&mut self, bead: &Move) {
        let round = bead.height * (1.0 - std::f64::consts::FRAC_PI_4);
        let (a, b, half) = (bead.a(), bead.b(), (bead.width + round) / 2.0);
        let index = |at: f64, axis: usize| ((at - self.low[axis]) / self.pixel).max(0.0) as usize;
        let rows = index(a[1].min(b[1]) - half, 1)..=index(a[1].max(b[1]) + half, 1);
        let columns = index(a[0].min(b[0]) - half, 0)..=index(a[0].max(b[0]) + half, 0);
        let height = self.counts.len() / self.width;
        for row in rows.take_while(|&row| row < height) {
            for column in columns.clone().take_while(|&column| column < self.width) {
                let at = self.middle(row, column);
                if super::section::distance(at, a, b) <= half {
                    self.counts[row * self.width + column] += 1;
                }
            }
        }
    }

    fn middle(&self, row: usize, column: usize) -> [f64; 2] {
        let at = |k: usize, axis: usize| self.low[axis] + (k as f64 + 0.5) * self.pixel;
        [at(column, 0), at(row, 1)]
    }

    /// The number of pixels that `within` accepts, and how many of them are covered.
    pub(crate) fn covered(&self, within: impl Fn([f64; 2]) -> bool) -> (usize, usize) {
        let mut counted = (0, 0);
        for (k, &count) in self.counts.iter().enumerate() {
            if within(self.middle(k / self.width, k % self.width)) {
                counted.0 += 1;
                counted.1 += usize::from(count > 0);
            }
        }
        counted
    }
}
