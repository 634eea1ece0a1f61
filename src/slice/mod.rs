//! Mesh -> Layers: where the planes of a print cut the mesh.
//!
//! Every layer is cut at half its height. A vertex on the plane counts as above
//! it: then each triangle either crosses a plane or does not, each closed mesh
//! gives closed contours, and no case is special. Guaranteed to the next stage:
//! contours are closed, do not cross, run counter-clockwise around solid and
//! clockwise around holes, and keep within the stated tolerance of the mesh.

mod chain;
mod simplify;
pub mod volume;

pub use chain::Slicer;

use crate::geom::{Contour, double_area};
use crate::units::{Coord, UNITS_PER_MM};

/// The heights of a print's layers, grid units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Heights {
    /// Height of the first layer.
    pub first: Coord,
    /// Height of every other layer.
    pub other: Coord,
    /// Number of layers.
    pub count: usize,
}

impl Heights {
    /// The layers of a mesh `top` high: as many as have their middle inside it.
    #[must_use]
    pub fn new(first: Coord, other: Coord, top: Coord) -> Self {
        // Layer k > 0 has its middle at first + (k − ½)·other.
        let above = i64::from(top) - i64::from(first) + i64::from(other / 2);
        let more = (above - 1).div_euclid(i64::from(other)).max(0);
        let count = if top > first / 2 { 1 + usize::try_from(more).unwrap_or(0) } else { 0 };
        Self { first, other, count }
    }

    /// Height of layer `k`.
    #[must_use]
    pub fn height(&self, k: usize) -> Coord {
        if k == 0 { self.first } else { self.other }
    }

    /// Top of layer `k` above the bed.
    #[must_use]
    pub fn top(&self, k: usize) -> Coord {
        self.first + Coord::try_from(k).unwrap_or(Coord::MAX / 2) * self.other
    }

    /// The plane that layer `k` is cut at: the middle of its height.
    #[must_use]
    pub fn plane(&self, k: usize) -> Coord {
        self.top(k) - self.height(k) / 2
    }

    /// How many planes lie at or below `z`. A triangle from `low` to `high` crosses those of
    /// layers `planes_up_to(low)..planes_up_to(high)`.
    #[must_use]
    pub fn planes_up_to(&self, z: Coord) -> usize {
        if self.count == 0 || z < self.plane(0) {
            return 0;
        }
        let above = i64::from(z) - i64::from(self.first) + i64::from(self.other / 2);
        let more = above.div_euclid(i64::from(self.other)).max(0);
        (1 + usize::try_from(more).unwrap_or(0)).min(self.count)
    }
}

/// One layer of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Counted from 0 at the bed.
    pub index: usize,
    /// Top of the layer above the bed, grid units.
    pub z: Coord,
    /// Height, grid units.
    pub height: Coord,
    /// What the plane cuts out of the mesh.
    pub contours: Vec<Contour>,
    /// The longest gap that had to be closed by a straight line, grid units; 0 if none.
    pub closed_gap: Coord,
}

impl Layer {
    /// What the contours enclose over the layer's height, mm³.
    #[must_use]
    pub fn volume_mm3(&self) -> f64 {
        let area: i128 = self.contours.iter().map(|contour| double_area(contour)).sum();
        area as f64 / 2.0 * f64::from(self.height) / UNITS_PER_MM.powi(3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_those_with_their_middle_inside() {
        assert_eq!(Heights::new(2000, 2000, 403_200).count, 202);
        assert_eq!(Heights::new(2000, 2000, 200_000).count, 100);
        assert_eq!(Heights::new(2000, 2000, 1001).count, 1);
        assert_eq!(Heights::new(2000, 2000, 1000).count, 0);
        assert_eq!(Heights::new(3000, 2000, 5000).count, 2);
        assert_eq!(Heights::new(3000, 2000, 4000).count, 1);
    }

    #[test]
    fn a_range_of_heights_crosses_the_planes_within_it() {
        for (first, other) in [(2000, 2000), (3000, 2000), (1001, 1501)] {
            let heights = Heights::new(first, other, 50_000);
            for (low, high) in [(0, 50_000), (999, 1000), (1000, 4000), (7000, 7000), (-5, 2500)] {
                let expected: Vec<usize> = (0..heights.count)
                    .filter(|&k| low < heights.plane(k) && heights.plane(k) <= high)
                    .collect();
                let found = heights.planes_up_to(low)..heights.planes_up_to(high);
                assert_eq!(found.collect::<Vec<_>>(), expected);
            }
        }
    }
}
