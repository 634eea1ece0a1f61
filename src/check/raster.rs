//! Grid and Bits: an area of the bed as rows of bits, one a pixel, for booleans, growing and shrinking.
//!
//! Words used here: a *pixel* is a square of the bed; a *stretch* is set pixels side by side in a row;
//! to *grow* an area is to set all pixels near a set one, to *shrink* it is to keep those whose
//! surroundings are all set, to *open* it is both: what is narrower disappears.
//!
//! A row is an array of 64-bit words, so that booleans take one instruction for 64 pixels. Growing by
//! a disc works by stretches: the disc's rows are stretches that get wider towards its middle, and a
//! row shifted and joined with itself doubles its reach with each step. A disc of radius r costs
//! about 2 r row operations instead of r². Squares, for which rows and columns separate, cost
//! log r.
//!
//! Pixels cover what their middles cover. Beyond the edge nothing is set.

use crate::geom::segment;

/// Where the pixels lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    /// Lowest x and y, mm.
    pub(super) low: [f64; 2],
    /// Side of a pixel, mm.
    pub(super) pitch: f64,
    /// Pixels in x and y.
    pub(super) size: [usize; 2],
}

impl Grid {
    /// One that covers a rectangle and `margin` mm more, with pixels of `pitch` mm, or larger
    /// ones if these were more than `most`.
    pub(super) fn over(low: [f64; 2], high: [f64; 2], margin: f64, pitch: f64, most: f64) -> Self {
        let sides = segment::way(low, high).map(|side| side.max(0.0) + 2.0 * margin);
        let pitch = pitch.max((sides[0] * sides[1] / most).sqrt());
        Self {
            low: low.map(|low| low - margin),
            pitch,
            size: sides.map(|side| (side / pitch).ceil().max(1.0) as usize),
        }
    }

    /// Middle of a pixel, mm.
    pub(super) fn middle(&self, x: usize, y: usize) -> [f64; 2] {
        segment::along(self.low, self.pitch, [x as f64 + 0.5, y as f64 + 0.5])
    }

    /// The pixel that a place lies in.
    pub(super) fn pixel(&self, at: [f64; 2]) -> Option<[usize; 2]> {
        let x = (at[0] - self.low[0]) / self.pitch;
        let y = (at[1] - self.low[1]) / self.pitch;
        let is_in = x >= 0.0 && y >= 0.0 && x < self.size[0] as f64 && y < self.size[1] as f64;
        is_in.then_some([x as usize, y as usize])
    }

    /// The pixels of a side whose middles lie in `from..to`, mm along the axis.
    pub(super) fn span(&self, axis: usize, from: f64, to: f64) -> std::ops::Range<usize> {
        let first = |at: f64| {
            let pixel = (at - self.low[axis]) / self.pitch - 0.5;
            let pixel = pixel.clamp(0.0, self.size[axis] as f64);
            // Rounded up, without the call that `ceil` is on old processors.
            let whole = pixel as usize;
            whole + usize::from((whole as f64) < pixel)
        };
        first(from)..first(to)
    }

    /// Pixels in `mm`, rounded.
    pub(super) fn pixels(&self, mm: f64) -> usize {
        (mm / self.pitch).round().max(0.0) as usize
    }

    /// Area of a pixel, mm².
    pub(super) fn area(&self) -> f64 {
        self.pitch * self.pitch
    }
}

/// Bits in a word.
const WORD: usize = 64;

/// A set of pixels.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bits {
    size: [usize; 2],
    /// Words in a row. The bits beyond the last pixel are 0.
    words: usize,
    bits: Vec<u64>,
}

impl Bits {
    pub(super) fn new(size: [usize; 2]) -> Self {
        let words = size[0].div_ceil(WORD);
        Self { size, words, bits: vec![0; words * size[1]] }
    }

    fn row(&self, y: usize) -> &[u64] {
        &self.bits[y * self.words..(y + 1) * self.words]
    }

    /// Sets the pixels `span` of row `y`.
    pub(super) fn set(&mut self, y: usize, span: std::ops::Range<usize>) {
        if span.is_empty() || y >= self.size[1] {
            return;
        }
        let (first, last) = (span.start / WORD, (span.end - 1) / WORD);
        let from = u64::MAX << (span.start % WORD);
        let to = u64::MAX >> (WORD - 1 - (span.end - 1) % WORD);
        let row = &mut self.bits[y * self.words..(y + 1) * self.words];
        if first == last {
            row[first] |= from & to;
            return;
        }
        row[first] |= from;
        row[first + 1..last].fill(u64::MAX);
        row[last] |= to;
    }

    /// Whether a pixel is set.
    pub(super) fn has(&self, x: usize, y: usize) -> bool {
        x < self.size[0] && y < self.size[1] && self.row(y)[x / WORD] >> (x % WORD) & 1 == 1
    }

    /// How many are set.
    pub(super) fn count(&self) -> u64 {
        self.bits.iter().map(|word| u64::from(word.count_ones())).sum()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bits.iter().all(|word| *word == 0)
    }

    fn zip(mut self, other: &Self, with: impl Fn(u64, u64) -> u64) -> Self {
        self.bits.iter_mut().zip(&other.bits).for_each(|(a, b)| *a = with(*a, *b));
        self
    }

    pub(super) fn and(self, other: &Self) -> Self {
        self.zip(other, |a, b| a & b)
    }

    pub(super) fn or(self, other: &Self) -> Self {
        self.zip(other, |a, b| a | b)
    }

    pub(super) fn minus(self, other: &Self) -> Self {
        self.zip(other, |a, b| a & !b)
    }

    /// Pixels within `radius` pixels of one that is set: a disc.
    pub(super) fn grown(&self, radius: usize) -> Self {
        self.with_disc(radius, false)
    }

    /// Pixels whose surroundings within `radius` pixels are all set. Beyond the edge nothing is.
    pub(super) fn shrunk(&self, radius: usize) -> Self {
        self.with_disc(radius, true)
    }

    /// What a disc of `radius` pixels reaches that stays within: takes off what is narrower.
    pub(super) fn opened(&self, radius: usize) -> Self {
        self.shrunk(radius).grown(radius)
    }

    /// What a square of `2 × half + 1` pixels reaches that stays within, shrunk by `less`; quick for
    /// large ones.
    pub(super) fn squares(&self, half: usize, less: usize) -> Self {
        let shrunk = self.along_rows(half, true).along_columns(half, true);
        let grown = half.saturating_sub(less);
        shrunk.along_rows(grown, false).along_columns(grown, false)
    }

    /// Joins each pixel's disc: all of it (`every`) or any.
    fn with_disc(&self, radius: usize, every: bool) -> Self {
        if radius == 0 || self.is_empty() {
            return self.clone();
        }
        let mut out = Self::new(self.size);
        if every {
            out.bits.fill(u64::MAX);
        }
        // The disc as stretches, from its top and bottom to its middle: they only get wider.
        let (mut rows, mut known) = (self.clone(), 0);
        for away in (0..=radius).rev() {
            let reach = ((radius * radius - away * away) as f64 + 0.5 * radius as f64).sqrt();
            let reach = (reach as usize).min(radius);
            // A stretch joined with itself a little aside is a longer one.
            rows = rows.along_rows(reach - known, every);
            known = reach;
            for side in [-1_isize, 1].iter().take(if away == 0 { 1 } else { 2 }) {
                out.join_rows(&rows, side * away as isize, every);
            }
        }
        out.trim();
        out
    }

    /// Joins each row with that of `other` which lies `shift` rows further.
    fn join_rows(&mut self, other: &Self, shift: isize, every: bool) {
        for y in 0..self.size[1] {
            let from = y.checked_add_signed(shift).filter(|from| *from < self.size[1]);
            let target = &mut self.bits[y * self.words..(y + 1) * self.words];
            match from {
                Some(from) if every => {
                    target.iter_mut().zip(other.row(from)).for_each(|(a, b)| *a &= b);
                }
                Some(from) => target.iter_mut().zip(other.row(from)).for_each(|(a, b)| *a |= b),
                None if every => target.fill(0),
                None => {}
            }
        }
    }

    /// Each pixel joined with its neighbours to `reach` on both sides of its row.
    fn along_rows(&self, reach: usize, every: bool) -> Self {
        let mut out = self.clone();
        // Steps that double: a stretch of 2^k joined with itself, shifted.
        let mut left = reach;
        let mut step = 1;
        while left > 0 {
            let by = step.min(left);
            out.spread(by, every);
            left -= by;
            step = (2 * step).min(WORD / 2);
        }
        out
    }

    /// As [`Self::along_rows`], up and down.
    fn along_columns(&self, reach: usize, every: bool) -> Self {
        let mut out = self.clone();
        let (mut left, mut step) = (reach, 1);
        while left > 0 {
            let by = step.min(left);
            let before = out.clone();
            out.join_rows(&before, by as isize, every);
            out.join_rows(&before, -(by as isize), every);
            left -= by;
            step *= 2;
        }
        out
    }

    /// Joins each pixel with those `by` before and after it, less than a word away.
    fn spread(&mut self, by: usize, every: bool) {
        for row in self.bits.chunks_exact_mut(self.words) {
            if row.iter().all(|word| *word == 0) {
                continue;
            }
            let mut before = 0;
            for k in 0..row.len() {
                let (here, after) = (row[k], row.get(k + 1).copied().unwrap_or(0));
                let up = here << by | before >> (WORD - by);
                let down = here >> by | after << (WORD - by);
                row[k] = if every { here & up & down } else { here | up | down };
                before = here;
            }
        }
        self.trim();
    }

    /// Clears the bits beyond the last pixel.
    fn trim(&mut self) {
        let used = self.size[0] % WORD;
        if used > 0 {
            let mask = u64::MAX >> (WORD - used);
            self.bits.chunks_exact_mut(self.words).for_each(|row| row[self.words - 1] &= mask);
        }
    }

    /// The stretches of set pixels of row `y`.
    pub(super) fn stretches(&self, y: usize) -> Vec<std::ops::Range<usize>> {
        let row = self.row(y);
        let mut found: Vec<std::ops::Range<usize>> = Vec::new();
        for (k, &word) in row.iter().enumerate() {
            let (mut rest, mut base) = (word, k * WORD);
            while rest != 0 {
                let skip = rest.trailing_zeros() as usize;
                rest >>= skip;
                base += skip;
                let run = rest.trailing_ones() as usize;
                match found.last_mut() {
                    Some(last) if last.end == base => last.end += run,
                    _ => found.push(base..base + run),
                }
                rest = rest.checked_shr(run as u32).unwrap_or(0);
                base += run;
            }
        }
        found
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.size[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(size: [usize; 2], set: &[(usize, usize)]) -> Bits {
        let mut bits = Bits::new(size);
        set.iter().for_each(|&(x, y)| bits.set(y, x..x + 1));
        bits
    }

    #[test]
    fn spans_cover_the_pixels_whose_middles_they_hold() {
        let grid = Grid::over([0.0, 0.0], [1.0, 1.0], 0.5, 0.1, 1e9);
        assert_eq!(grid.size, [20, 20]);
        assert_eq!(grid.span(0, -0.5, -0.4), 0..1);
        assert_eq!(grid.span(0, -0.44, 0.06), 1..6);
        assert_eq!(grid.span(0, -9.0, 9.0), 0..20);
        assert_eq!(grid.pixel([0.01, 1.49]), Some([5, 19]));
        assert_eq!(grid.pixel([-0.6, 0.0]), None);
        let coarse = Grid::over([0.0, 0.0], [100.0, 100.0], 0.0, 0.01, 1e4);
        assert!((coarse.pitch - 1.0).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn growing_and_shrinking_are_what_a_disc_does(
            set in prop::collection::vec((0..150_usize, 0..12_usize), 0..40),
            radius in 1..6_usize,
        ) {
            let size = [150, 12];
            let bits = of(size, &set);
            let reach = |away: usize| {
                ((((radius * radius - away * away) as f64) + 0.5 * radius as f64).sqrt() as usize).min(radius)
            };
            let near = |x: usize, y: usize| {
                let mut near = Vec::new();
                for ny in y.saturating_sub(radius)..=y + radius {
                    let reach = reach(ny.abs_diff(y));
                    near.extend((x as isize - reach as isize..=(x + reach) as isize).map(|nx| (nx, ny)));
                }
                near
            };
            let has = |(x, y): &(isize, usize)| usize::try_from(*x).is_ok_and(|x| bits.has(x, *y));
            // Rows below 0 are unset.
            let whole = |x: usize, y: usize| y >= radius && near(x, y).iter().all(has);
            let (grown, shrunk) = (bits.grown(radius), bits.shrunk(radius));
            for y in 0..size[1] {
                for x in 0..size[0] {
                    prop_assert_eq!(grown.has(x, y), near(x, y).iter().any(has));
                    prop_assert_eq!(shrunk.has(x, y), whole(x, y));
                }
            }
        }

        #[test]
        fn squares_reach_what_is_wide_enough(
            (x, y, w, h) in (0..60_usize, 0..20_usize, 1..80_usize, 1..20_usize),
            half in 1..8_usize,
            less in 0..3_usize,
        ) {
            let mut bits = Bits::new([150, 42]);
            (y..y + h).for_each(|y| bits.set(y, x..x + w));
            let less = less.min(half);
            let side = 2 * half + 1;
            let found = bits.squares(half, less).count() as usize;
            // What lies at the edge has nothing beyond it.
            let expected =
                if w < side || h < side { 0 } else { (w - 2 * less) * (h - 2 * less) };
            prop_assert_eq!(found, expected);
        }

        #[test]
        fn stretches_are_what_was_set(spans in prop::collection::vec((0..200_usize, 1..90_usize), 0..6)) {
            let mut bits = Bits::new([300, 1]);
            spans.iter().for_each(|&(from, length)| bits.set(0, from..from + length));
            let stretches = bits.stretches(0);
            let sum: usize = stretches.iter().map(ExactSizeIterator::len).sum();
            prop_assert_eq!(sum as u64, bits.count());
            for x in 0..300 {
                let inside = spans.iter().any(|&(from, length)| (from..from + length).contains(&x));
                prop_assert_eq!(bits.has(x, 0), inside);
                prop_assert_eq!(stretches.iter().any(|one| one.contains(&x)), inside);
            }
            prop_assert!(stretches.windows(2).all(|two| two[0].end < two[1].start));
        }
    }
}
