//! Layer heights -> Heights: lists the top and the cutting plane of each layer.

use crate::units::Coord;

/// The layers of a print from the bed upwards. Each stands on the one before; all heights may
/// differ.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Heights {
    /// Top of each layer above the bed, grid units.
    tops: Vec<Coord>,
    /// The plane that each layer is cut at: the middle of its height.
    planes: Vec<Coord>,
}

impl Heights {
    /// Layers of the given heights, grid units, all > 0.
    #[must_use]
    pub fn new(heights: impl IntoIterator<Item = Coord>) -> Self {
        let mut out = Self::default();
        let mut top: Coord = 0;
        for height in heights {
            top = top.saturating_add(height);
            out.tops.push(top);
            out.planes.push(top - height / 2);
        }
        out
    }

    /// Layers of height `other` on one of height `first`, for a mesh of height `top`. A layer is
    /// counted if its middle is inside the mesh.
    #[must_use]
    pub fn even(first: Coord, other: Coord, top: Coord) -> Self {
        // Layer k > 0 has its middle at first + (k − ½)·other.
        let above = i64::from(top) - i64::from(first) + i64::from(other / 2);
        let more = usize::try_from((above - 1).div_euclid(i64::from(other))).unwrap_or(0);
        let first = (top > first / 2).then_some(first);
        let more = if first.is_some() { more } else { 0 };
        Self::new(first.into_iter().chain(std::iter::repeat_n(other, more)))
    }

    /// The lowest `count` of these layers.
    #[must_use]
    pub fn lowest(mut self, count: usize) -> Self {
        self.tops.truncate(count);
        self.planes.truncate(count);
        self
    }

    /// Number of layers.
    #[must_use]
    pub fn count(&self) -> usize {
        self.tops.len()
    }

    /// Height of layer `k`.
    #[must_use]
    pub fn height(&self, k: usize) -> Coord {
        self.stack(k, 1)
    }

    /// Total height of `count` layers, of which layer `k` is the highest.
    #[must_use]
    pub fn stack(&self, k: usize, count: u32) -> Coord {
        let below = (k + 1).checked_sub(count as usize + 1).map_or(0, |below| self.tops[below]);
        self.tops[k] - below
    }

    /// The number of successive layers that are together as thick as `thickness`, wherever they lie;
    /// all layers if they are thinner.
    #[must_use]
    pub fn layers_of(&self, thickness: Coord) -> usize {
        let below = |(k, top): (usize, &Coord)| {
            let bottom = top.checked_sub(thickness).filter(|&bottom| bottom >= 0)?;
            Some(k + 1 - self.tops[..k + 1].partition_point(|&other| other <= bottom))
        };
        if thickness <= 0 {
            return 0;
        }
        // At the bed, whatever the first layer's height.
        let first = self.tops.partition_point(|&top| top < thickness) + 1;
        let above = self.tops.iter().enumerate().filter_map(below).max().unwrap_or_default();
        first.min(self.count()).max(above)
    }

    /// Top of layer `k` above the bed.
    #[must_use]
    pub fn top(&self, k: usize) -> Coord {
        self.tops[k]
    }

    /// The plane that layer `k` is cut at: the middle of its height.
    #[must_use]
    pub fn plane(&self, k: usize) -> Coord {
        self.planes[k]
    }

    /// The number of planes at or below `z`. A triangle from `low` to `high` crosses the planes of
    /// layers `planes_up_to(low)..planes_up_to(high)`.
    #[must_use]
    pub fn planes_up_to(&self, z: Coord) -> usize {
        self.planes.partition_point(|&plane| plane <= z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_counted_if_their_middle_is_inside() {
        let count = |first, other, top| Heights::even(first, other, top).count();
        assert_eq!(count(2000, 2000, 403_200), 202);
        assert_eq!(count(2000, 2000, 200_000), 100);
        assert_eq!(count(2000, 2000, 1001), 1);
        assert_eq!(count(2000, 2000, 1000), 0);
        assert_eq!(count(3000, 2000, 5000), 2);
        assert_eq!(count(3000, 2000, 4000), 1);
    }

    #[test]
    fn the_last_layer_ends_within_half_a_layer_of_the_top() {
        for (first, other) in [(6_000, 10_000), (3_000, 2_000), (2_000, 3_001)] {
            for top in (first..80_000).step_by(37) {
                let heights = Heights::even(first, other, top);
                let rest = heights.top(heights.count() - 1) - top;
                assert!(2 * rest.abs() <= other + 1, "{first} {other} {top}: {rest}");
            }
        }
    }

    #[test]
    fn layers_stand_on_each_other_whatever_their_heights() {
        let heights = Heights::new([3000, 1000, 2500, 500]);
        assert_eq!([0, 1, 2, 3].map(|k| heights.top(k)), [3000, 4000, 6500, 7000]);
        assert_eq!([0, 1, 2, 3].map(|k| heights.plane(k)), [1500, 3500, 5250, 6750]);
        assert_eq!([0, 1, 2, 3].map(|k| heights.height(k)), [3000, 1000, 2500, 500]);
        assert_eq!((heights.stack(3, 2), heights.stack(3, 4)), (3000, 7000));
    }

    #[test]
    fn as_many_layers_as_a_thickness_takes() {
        let even = Heights::even(2_000, 2_000, 100_000);
        assert_eq!([0, 1, 2_000, 2_001, 8_000].map(|t| even.layers_of(t)), [0, 1, 1, 2, 4]);
        assert_eq!(Heights::even(2_000, 1_200, 100_000).layers_of(8_000), 7);
        // A thick first layer helps only at the bed, a thin one asks for one more there.
        assert_eq!(Heights::even(3_000, 2_000, 100_000).layers_of(8_000), 4);
        assert_eq!(Heights::even(1_000, 2_000, 100_000).layers_of(8_000), 5);
        assert_eq!(Heights::even(2_000, 2_000, 6_000).layers_of(8_000), 3);
        assert_eq!(Heights::default().layers_of(8_000), 0);
    }

    #[test]
    fn a_range_of_z_crosses_the_planes_within_it() {
        let lists = [
            Heights::even(2000, 2000, 50_000),
            Heights::even(3000, 2000, 50_000),
            Heights::even(1001, 1501, 50_000),
            Heights::new([2000, 999, 1500, 3000, 1000]),
        ];
        for heights in lists {
            for (low, high) in [(0, 50_000), (999, 1000), (1000, 4000), (7000, 7000), (-5, 2500)] {
                let expected: Vec<usize> = (0..heights.count())
                    .filter(|&k| low < heights.plane(k) && heights.plane(k) <= high)
                    .collect();
                let found = heights.planes_up_to(low)..heights.planes_up_to(high);
                assert_eq!(found.collect::<Vec<_>>(), expected);
            }
        }
    }
}
