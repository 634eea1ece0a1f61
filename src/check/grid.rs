//! Grid: pixels of the bed, for maps that hold a number at each place.
//!
//! A *pixel* is a square of the bed. Pixels cover what their middles cover.

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
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
